// SPDX-License-Identifier: MIT
// All the errors that a material file can have: one line that names file, key and what is allowed, and nothing
// written.
#include "bad_material.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bad_input.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

const std::string kWithImpact =
    R"(  "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },)";

// kGood with one more object at its end.
std::string with_object(std::string text, const std::string& object) {
  return text.insert(text.rfind('}'), ", " + object);
}

Bases bases() {
  const std::string graded = with_spline(R"("knots": "graded", "segments": 8)");
  return {{"", kGood},
          {"no_impact", changed(kWithImpact, "")},
          {"graded", graded},
          {"tolerance", with_spline(R"("knots": "graded", "tolerance": 0.1)")},
          {"optimal", with_spline(R"("knots": "optimal", "segments": 8, "minimise": "spectrum")")},
          {"decibels", with_spline(R"("knots": "optimal", "minimise": "spectrum", "tolerance_db": 1)")},
          {"compensated", with_object(graded, R"("compensation": { "sample_rate_hz": 44100, "mass_kg": 0.003 })")},
          {"live", with_object(kGood, R"("live_exponent": { "min": 1.2, "max": 3.2, "members": 21 })")}};
}

std::vector<BadFile> long_cases() {
  return {{"name_has_megabyte", changed(R"("probe")", '"' + std::string(1'000'000, 'a') + '"'), "name",
           "is not a usable identifier; allowed: a-z, 0-9 and single _, a letter first"},
          {"unknown_and_long", changed(R"("name")", '"' + std::string(100'000, 'k') + R"(": 1, "name")"), "kkkk",
           "k...: unknown key; allowed: name, description, contact, impact, spline, compensation, live_exponent"}};
}

class BadMaterialFile : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadMaterialFile, IsRefusedInOneLineAndNothingIsWritten) {
  expect_refused_without_a_trace(GetParam());
}

CONTACTSPLINE_CASES(Number, BadMaterialFile, bad_numbers("material", "Number", bases()));
CONTACTSPLINE_CASES(Missing, BadMaterialFile, bad_files("material", "Missing", bases()));
CONTACTSPLINE_CASES(Key, BadMaterialFile, bad_files("material", "Key", bases()));
CONTACTSPLINE_CASES(Design, BadMaterialFile, bad_files("material", "Design", bases()));
CONTACTSPLINE_CASES(Text, BadMaterialFile, bad_files("material", "Text", bases()));
CONTACTSPLINE_CASES(Live, BadMaterialFile, bad_files("material", "Live", bases()));
CONTACTSPLINE_CASES(Long, BadMaterialFile, long_cases());

// The limits that depend on the material, as they are told, are kept.
TEST(BadMaterialFile, IsAcceptedWithWhatIsAllowed) {
  const auto told = [](const std::string& text, const std::string& after) {
    const Sandbox box;
    write_file(box / "probe.json", text);
    const std::string err = run({.arguments = {"inspect", "probe.json"}, .folder = box.path()}).err;
    const auto at = err.find(after);
    EXPECT_NE(at, std::string::npos) << err;
    return at == std::string::npos ? std::string("1")
                                   : err.substr(at + after.size(), err.find('\n') - at - after.size());
  };
  const auto accepted = [](const std::string& text) {
    const Sandbox box;
    write_file(box / "probe.json", text);
    succeed({.arguments = {"inspect", "probe.json"}, .folder = box.path()});
  };
  const auto probe = [](const std::string& stiffness, const std::string& rate) {
    return R"({ "name": "probe", "contact": { "stiffness_n_per_m_alpha": )" + stiffness + R"(, "exponent": 2.5 },
      "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },
      "spline": { "knots": "graded", "segments": 4 },
      "compensation": { "mass_kg": 0.003, "sample_rate_hz": )" +
           rate + " } }";
  };
  for (const std::string stiffness : {"1e9", "2e9", "3e9", "4e9", "5e9", "6e9", "7e9", "8e9"})
    accepted(probe(stiffness, told(probe(stiffness, "1000"), "allowed: at least ")));
  const auto tolerance = [](const std::string& value) {
    return with_spline(R"("knots": "uniform", "tolerance": )" + value);
  };
  accepted(tolerance(told(tolerance("1e-7"), "allowed: at least ")));
}

TEST(BadMaterialFile, IsRefusedByEveryCommand) {
  const Sandbox box;
  write_file(box / "probe.json", changed("uniform", "chebyshev"));
  const auto before = box.listing();
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"generate", "felt_c4", "probe.json", "-o", "out"},
           {"generate", "felt_c4", "probe.json", "-o", "out", "--check"},
           {"generate", "probe.json", "--emit", "json", "-o", "-"},
           {"inspect", "probe.json"},
           {"inspect", "probe.json", "--figure", "probe.svg"},
           {"impact", "felt_c4", "probe.json"},
           {"render", "mass-barrier", "--material", "probe.json", "-o", "probe.wav"}})
    expect_refused(run({.arguments = arguments, .folder = box.path()}), "probe.json: spline.knots: 'chebyshev'",
                   "allowed: uniform, graded, optimal");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

}  // namespace
}  // namespace contactspline::testing
