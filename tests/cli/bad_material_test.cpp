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

const std::vector<NumberKey> kNumbers = {
    {"contact.", "stiffness_n_per_m_alpha", "4.5e9", "a number from 0.001 to 1e+18", {"0", "-1", "9e-4", "1.1e18"}},
    {"contact.", "exponent", "2.5", "a number from 0.1 to 10", {"0", "-1", "0.09", "10.1", "1e308"}},
    {"impact.", "mass_kg", "0.003", "a number from 1e-09 to 10000", {"0", "-1", "9e-10", "10001", "1e-320"}},
    {"impact.", "max_speed_m_per_s", "6.0", "a number from 1e-06 to 1000", {"0", "-1", "9e-7", "1001"}},
    {"impact.", "min_speed_m_per_s", "0.1", "a number from 1e-06 to 1000", {"0", "-1", "9e-7", "1001"}},
    {"spline.",
     "segments",
     "8",
     "an integer from 1 to 65536",
     {"0", "-1", "65537", "4294967304", "18446744073709551615", "-9223372036854775808"},
     true},
    {"spline.", "max_compression_m", "1e-3", "a number from 1e-09 to 1", {"0", "-1", "9e-10", "1.1"}}};

std::vector<BadFile> all_number_cases() {
  std::vector<BadFile> cases;
  for (const NumberKey& number : kNumbers) {
    const std::string object = number.path.substr(0, number.path.size() - 1);
    std::ranges::move(number_cases(object, kGood, number), std::back_inserter(cases));
  }
  return cases;
}

std::vector<BadFile> missing_cases() {
  const std::string impact =
      R"(  "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },)";
  std::string bare = changed(impact, "");
  bare.erase(bare.find(R"(, "max_compression_m": 1e-3)"), 27);
  return {{"name_missing", changed(R"("name": "probe",)", ""), "name", "missing; allowed: a-z, 0-9 and single _"},
          {"contact_missing", changed(R"("contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },)", ""),
           "contact", "missing; allowed: stiffness_n_per_m_alpha, exponent"},
          {"spline_missing",
           changed(R"(,
  "spline": { "knots": "uniform", "segments": 8, "max_compression_m": 1e-3 })",
                   ""),
           "spline", "missing; allowed: knots, segments, max_compression_m, minimise, tolerance, tolerance_db"},
          {"stiffness_missing", changed(R"("stiffness_n_per_m_alpha": 4.5e9, )", ""),
           "contact.stiffness_n_per_m_alpha", "missing; allowed: a number from 0.001 to 1e+18"},
          {"exponent_missing", changed(R"(, "exponent": 2.5)", ""), "contact.exponent",
           "missing; allowed: a number from 0.1 to 10"},
          {"mass_missing", changed(R"("mass_kg": 0.003, )", ""), "impact.mass_kg",
           "missing; allowed: a number from 1e-09 to 10000"},
          {"max_speed_missing", changed(R"("max_speed_m_per_s": 6.0, )", ""), "impact.max_speed_m_per_s",
           "missing; allowed: a number from 1e-06 to 1000"},
          {"min_speed_missing", changed(R"(, "min_speed_m_per_s": 0.1)", ""), "impact.min_speed_m_per_s",
           "missing; allowed: a number from 1e-06 to 1000"},
          {"knots_missing", changed(R"("knots": "uniform", )", ""), "spline.knots",
           "missing; allowed: uniform, graded, optimal"},
          {"segments_missing", changed(R"("segments": 8, )", ""), "spline.segments",
           "missing; allowed: an integer from 1 to 65536"},
          {"max_compression_and_impact_missing", bare, "spline.max_compression_m",
           "missing; allowed: a number, or an impact to compute it from"},
          {"everything_missing", "{}", "contact", "missing; allowed: stiffness_n_per_m_alpha, exponent"}};
}

std::vector<BadFile> key_cases() {
  const std::string root = "name, description, contact, impact, spline, compensation, live_exponent";
  return {
      {"unknown_at_root", changed(R"("name")", R"("colour": 1, "name")"), "colour", "unknown key; allowed: " + root},
      {"unknown_in_contact", changed(R"("exponent")", R"("loss": 1, "exponent")"), "contact.loss",
       "unknown key; allowed: stiffness_n_per_m_alpha, exponent"},
      {"unknown_in_impact", changed(R"("mass_kg")", R"("mass_g": 1, "mass_kg")"), "impact.mass_g",
       "unknown key; allowed: mass_kg, max_speed_m_per_s, min_speed_m_per_s"},
      {"unknown_in_spline", changed(R"("knots")", R"("order": 2, "knots")"), "spline.order",
       "unknown key; allowed: knots, segments, max_compression_m, minimise, tolerance, tolerance_db"},
      {"unknown_by_case", changed(R"("name")", R"("Name")"), "Name", "unknown key; allowed: " + root},
      {"unknown_and_empty", changed(R"("name")", R"("": 1, "name")"), "", "unknown key; allowed: " + root},
      {"unknown_with_line_ends", changed(R"("name")", R"("a\nb\u001b[31m": 1, "name")"), "a?b?[31m", "unknown key"},
      {"unknown_and_long", changed(R"("name")", '"' + std::string(100'000, 'k') + R"(": 1, "name")"), "kkkk",
       "k...: unknown key; allowed: " + root},
      {"name_twice", changed(R"("name": "probe",)", R"("name": "probe", "name": "other",)"), "name",
       "duplicate key; allowed: once"},
      {"contact_twice", changed(R"("contact")", R"("contact": {}, "contact")"), "contact",
       "duplicate key; allowed: once"},
      {"knots_twice", changed(R"("knots")", R"("knots": "uniform", "knots")"), "spline.knots",
       "duplicate key; allowed: once"},
      {"twice_by_escape", changed(R"("knots")", R"("\u006bnots": "uniform", "knots")"), "spline.knots",
       "duplicate key; allowed: once"},
      {"contact_is_number",
       changed(R"("contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 })", R"("contact": 1)"), "contact",
       "is not an object; allowed: stiffness_n_per_m_alpha, exponent"},
      {"impact_is_null",
       changed(R"("impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 })",
               R"("impact": null)"),
       "impact", "is not an object; allowed: mass_kg"},
      {"spline_is_array", changed(R"({ "knots": "uniform", "segments": 8, "max_compression_m": 1e-3 })", "[]"),
       "spline", "is not an object; allowed: knots"}};
}

std::vector<BadFile> design_cases() {
  const std::string tolerance = "a number from 1e-07 to 0.5";
  std::vector<BadFile> cases = {
      {"graded_without_impact", with_spline(R"("knots": "graded", "segments": 8)", false), "spline.knots",
       "'graded' needs a range of impacts; allowed: with an impact, or uniform"},
      {"optimal_without_impact", with_spline(R"("knots": "optimal", "tolerance": 0.01)", false), "spline.knots",
       "'optimal' needs a range of impacts; allowed: with an impact, or uniform"},
      {"tolerance_without_impact",
       with_spline(R"("knots": "uniform", "tolerance": 0.01, "max_compression_m": 1e-3)", false), "spline.tolerance",
       "needs a range of impacts; allowed: with an impact, or segments instead"},
      {"graded_with_max_compression", with_spline(R"("knots": "graded", "segments": 8, "max_compression_m": 1e-3)"),
       "spline.max_compression_m",
       "graded knots take it from impact; allowed: without this key, or with uniform knots"},
      {"tolerance_and_segments", with_spline(R"("knots": "graded", "segments": 8, "tolerance": 0.01)"),
       "spline.tolerance", "is given together with segments; allowed: one of the two"},
      {"minimise_with_graded", with_spline(R"("knots": "graded", "segments": 8, "minimise": "force")"),
       "spline.minimise", "cannot be used with graded knots; allowed: with optimal knots only"},
      {"minimise_is_unknown", with_spline(R"("knots": "optimal", "segments": 8, "minimise": "energy")"),
       "spline.minimise", "'energy' is unknown; allowed: contact_duration, force, spectrum"},
      {"minimise_is_number", with_spline(R"("knots": "optimal", "segments": 8, "minimise": 1)"), "spline.minimise",
       "is not a string; allowed: contact_duration, force, spectrum"},
      {"spectrum_with_uniform", with_spline(R"("knots": "uniform", "segments": 8, "minimise": "spectrum")"),
       "spline.minimise", "cannot be used with uniform knots; allowed: with optimal knots only"},
      {"spectrum_without_impact", with_spline(R"("knots": "optimal", "segments": 8, "minimise": "spectrum")", false),
       "spline.knots", "'optimal' needs a range of impacts; allowed: with an impact, or uniform"},
      {"spectrum_without_segments", with_spline(R"("knots": "optimal", "minimise": "spectrum")"), "spline.segments",
       "missing; allowed: an integer from 1 to 128"},
      {"spectrum_of_relative_tolerance",
       with_spline(R"("knots": "optimal", "minimise": "spectrum", "tolerance": 0.01)"), "spline.tolerance",
       "cannot bound the spectrum; allowed: tolerance_db instead"},
      {"decibels_of_the_duration", with_spline(R"("knots": "optimal", "tolerance_db": 1)"), "spline.tolerance_db",
       "cannot bound the contact_duration; allowed: tolerance instead, or minimise spectrum"},
      {"decibels_of_graded", with_spline(R"("knots": "graded", "tolerance_db": 1, "tolerance": 0.1)"),
       "spline.tolerance_db", "cannot bound the contact_duration; allowed: tolerance instead, or minimise spectrum"},
      {"decibels_and_segments",
       with_spline(R"("knots": "optimal", "minimise": "spectrum", "tolerance_db": 1, "segments": 8)"),
       "spline.tolerance_db", "is given together with segments; allowed: one of the two"},
      {"decibels_are_text", with_spline(R"("knots": "optimal", "minimise": "spectrum", "tolerance_db": "1 dB")"),
       "spline.tolerance_db", "is not a number; allowed: a number from 0.1 to 20"},
      {"decibels_not_kept", with_spline(R"("knots": "optimal", "minimise": "spectrum", "tolerance_db": 0.1)"),
       "spline.tolerance_db", "0.1 is not met by 128 optimal segments; allowed: at least "},
      {"optimal_of_many", with_spline(R"("knots": "optimal", "segments": 129)"), "spline.segments",
       "129 is out of range; allowed: an integer from 1 to 128"},
      {"tolerance_not_kept", with_spline(R"("knots": "optimal", "tolerance": 1e-7)"), "spline.tolerance",
       "1e-07 is not met by 128 optimal segments; allowed: at least "},
      {"tolerance_not_kept_by_uniform", with_spline(R"("knots": "uniform", "tolerance": 1e-7)"), "spline.tolerance",
       "1e-07 is not met by 1024 uniform segments; allowed: at least "},
      {"tolerance_is_text", with_spline(R"("knots": "graded", "tolerance": "1 %")"), "spline.tolerance",
       "is not a number; allowed: " + tolerance},
      {"tolerance_is_twice", with_spline(R"("knots": "graded", "tolerance": 0.1, "tolerance": 0.2)"),
       "spline.tolerance", "duplicate key; allowed: once"},
      {"tolerance_overflows", with_spline(R"("knots": "graded", "tolerance": 1e999)"), "spline.tolerance",
       "is too large"}};
  const auto compensated = [](const std::string& compensation,
                              const std::string& knots = R"("graded", "segments": 8)") {
    std::string text = with_spline(R"("knots": )" + knots);
    return text.insert(text.rfind('}'), R"(, "compensation": )" + compensation);
  };
  const std::string good = R"({ "sample_rate_hz": 44100, "mass_kg": 0.003 })";
  const std::vector<BadFile> compensations = {
      {"compensation_is_number", compensated("1"), "compensation",
       "is not an object; allowed: sample_rate_hz, mass_kg"},
      {"compensation_unknown", compensated(R"({ "rate": 1 })"), "compensation.rate",
       "unknown key; allowed: sample_rate_hz, mass_kg"},
      {"compensation_without_rate", compensated(R"({ "mass_kg": 0.003 })"), "compensation.sample_rate_hz",
       "missing; allowed: a number from 1000 to 100000000"},
      {"compensation_without_mass", compensated(R"({ "sample_rate_hz": 44100 })"), "compensation.mass_kg",
       "missing; allowed: a number from 1e-09 to 10000"},
      {"compensation_of_low_rate", compensated(R"({ "sample_rate_hz": 999, "mass_kg": 0.003 })"),
       "compensation.sample_rate_hz", "999 is out of range; allowed: a number from 1000 to 100000000"},
      {"compensation_of_text_mass", compensated(R"({ "sample_rate_hz": 44100, "mass_kg": "3 g" })"),
       "compensation.mass_kg", "is not a number; allowed: a number from 1e-09 to 10000"},
      {"compensation_of_uniform", compensated(good, R"("uniform", "segments": 8)"), "compensation",
       "does not work with uniform knots; allowed: with graded or optimal knots"},
      {"compensation_of_force", compensated(good, R"("optimal", "segments": 8, "minimise": "force")"), "compensation",
       "corrects the contact duration, not the force; allowed: with minimise contact_duration"},
      {"compensation_of_spectrum", compensated(good, R"("optimal", "segments": 8, "minimise": "spectrum")"),
       "compensation", "corrects the contact duration, not the spectrum; allowed: with minimise contact_duration"},
      {"compensation_of_coarse_steps", compensated(R"({ "sample_rate_hz": 1000, "mass_kg": 0.003 })"),
       "compensation.sample_rate_hz", "1000 is too low for the fastest impact of 0.003 kg; allowed: at least "},
      {"compensation_of_fine_steps", compensated(R"({ "sample_rate_hz": 1e8, "mass_kg": 0.003 })"),
       "compensation.sample_rate_hz", "100000000 makes the slowest impact of 0.003 kg last"}};
  cases.insert(cases.end(), compensations.begin(), compensations.end());
  for (const std::string value : {"0", "-0.1", "9e-8", "0.6"})
    cases.push_back({"tolerance_is_out_of_range_" + std::to_string(cases.size()),
                     with_spline(R"("knots": "graded", "tolerance": )" + value), "spline.tolerance",
                     "is out of range; allowed: " + tolerance});
  for (const std::string value : {"0", "-1", "0.009", "20.1"})
    cases.push_back({"decibels_are_out_of_range_" + std::to_string(cases.size()),
                     with_spline(R"("knots": "optimal", "minimise": "spectrum", "tolerance_db": )" + value),
                     "spline.tolerance_db", "is out of range; allowed: a number from 0.1 to 20"});
  return cases;
}

std::vector<BadFile> live_cases() {
  const auto live = [](const std::string& object, const std::string& segments = "8") {
    std::string text = changed("\"segments\": 8", "\"segments\": " + segments);
    return text.insert(text.rfind('}'), R"(, "live_exponent": )" + object);
  };
  const std::string number = "is not a number; allowed: a number from 1 to 10";
  const std::string good = R"({ "min": 1.2, "max": 3.2, "members": 21 })";
  return {
      {"live_is_number", live("2"), "live_exponent", "is not an object; allowed: min, max, members"},
      {"live_unknown", live(R"({ "steps": 3 })"), "live_exponent.steps", "unknown key; allowed: min, max, members"},
      {"live_without_min", live(R"({ "max": 3, "members": 3 })"), "live_exponent.min",
       "missing; allowed: a number from 1 to 10"},
      {"live_min_is_text", live(R"({ "min": "1", "max": 3, "members": 3 })"), "live_exponent.min", number},
      {"live_min_is_low", live(R"({ "min": 0.9, "max": 3, "members": 3 })"), "live_exponent.min",
       "is out of range; allowed: a number from 1 to 10"},
      {"live_max_is_high", live(R"({ "min": 1, "max": 11, "members": 3 })"), "live_exponent.max",
       "is out of range; allowed: a number from 1 to 10"},
      {"live_falls", live(R"({ "min": 2, "max": 2, "members": 3 })"), "live_exponent.max",
       "2 is not above min; allowed: more than 2"},
      {"live_members_alone", live(R"({ "min": 1, "max": 3, "members": 1 })"), "live_exponent.members",
       "1 is out of range; allowed: an integer from 2 to 64"},
      {"live_and_compensated",
       [&] {
         std::string text = live(good);
         text.replace(text.find("uniform"), 7, "graded");
         text.replace(text.find(R"(, "max_compression_m": 1e-3)"), 28, "");
         return text.insert(text.rfind('}'), R"(, "compensation": { "sample_rate_hz": 44100, "mass_kg": 0.003 })");
       }(),
       "live_exponent", "cannot be compensated for a time step; allowed: without compensation"},
      {"live_and_tolerance",
       [&] {
         std::string text = live(good);
         return text.replace(text.find(R"("segments": 8)"), 13, R"("tolerance": 0.01)");
       }(),
       "live_exponent", "needs a number of segments, not a tolerance; allowed: with segments"},
      {"live_of_many_segments", live(good, "257"), "live_exponent",
       "has 257 segments; allowed: at most 256 segments"}};
}

std::vector<BadFile> text_cases() {
  const std::string name_rule = "is not a usable identifier; allowed: a-z, 0-9 and single _, a letter first";
  const std::string description_rule =
      "allowed: one line of at most 200 printable characters, no quote, no backslash";
  std::vector<BadFile> cases = {
      {"name_is_number", changed(R"("probe")", "1"), "name", "is not a string; allowed: a-z"},
      {"description_is_number", changed(R"("a probe")", "1"), "description", "is not a string; " + description_rule},
      {"description_is_long", changed("a probe", std::string(201, 'x')), "description", description_rule},
      {"knots_is_number", changed(R"("uniform")", "1"), "spline.knots",
       "is not a string; allowed: uniform, graded, optimal"},
      {"knots_is_unknown", changed("uniform", "chebyshev"), "spline.knots",
       "'chebyshev' is unknown; allowed: uniform, graded, optimal"},
      {"knots_is_upper_case", changed("uniform", "Uniform"), "spline.knots", "allowed: uniform, graded, optimal"},
      {"min_speed_is_above_max_speed", changed(R"("min_speed_m_per_s": 0.1)", R"("min_speed_m_per_s": 7)"),
       "impact.min_speed_m_per_s", "7 is above max_speed_m_per_s; allowed: at most 6"},
      {"exponent_is_not_convex", changed("2.5", "0.5"), "contact.exponent", "allowed: an exponent >= 1"}};
  const std::vector<std::pair<std::string, std::string>> names = {{"empty", ""},
                                                                  {"upper_case", "Probe"},
                                                                  {"keyword", "while"},
                                                                  {"space", "a b"},
                                                                  {"double_underscore", "a__b"},
                                                                  {"path", "../x"},
                                                                  {"absolute", "/tmp/x"},
                                                                  {"hyphen", "a-b"},
                                                                  {"dot", "a.b"},
                                                                  {"digit", "1a"},
                                                                  {"underscore", "_a"},
                                                                  {"umlaut", "\xc3\xa4"},
                                                                  {"null", "a\\u0000b"},
                                                                  {"line_end", "a\\nb"},
                                                                  {"long", std::string(65, 'a')},
                                                                  {"std", "std"},
                                                                  {"member", "segments"},
                                                                  {"own_library", "contactspline_modal"},
                                                                  {"macro", "linux"},
                                                                  {"macro_of_windows", "near"},
                                                                  {"own_namespace", "contactspline"},
                                                                  {"faust_keyword", "process"},
                                                                  {"faust_library", "maths"},
                                                                  {"megabyte", std::string(1'000'000, 'a')}};
  for (const auto& [kind, name] : names)
    cases.push_back({"name_has_" + kind, changed(R"("probe")", '"' + name + '"'), "name", name_rule});
  const std::vector<std::pair<std::string, std::string>> descriptions = {{"line_end", "a\\nb"},
                                                                         {"quote", "a\\\"b"},
                                                                         {"backslash", "a\\\\b"},
                                                                         {"null", "a\\u0000b"},
                                                                         {"tab", "a\\tb"},
                                                                         {"delete",
                                                                          "a\x7f"
                                                                          "b"},
                                                                         {"direction", "a\\u202eb"},
                                                                         {"isolate", "a\\u2066b"},
                                                                         {"line_separator", "a\\u2028b"},
                                                                         {"c1_control", "a\\u0085b"},
                                                                         {"escape", "\\u001b[31m"}};
  for (const auto& [kind, text] : descriptions)
    cases.push_back({"description_has_" + kind, changed("a probe", text), "description", description_rule});
  return cases;
}

class BadMaterialFile : public ::testing::TestWithParam<BadFile> {};

TEST_P(BadMaterialFile, IsRefusedInOneLineAndNothingIsWritten) {
  expect_refused_without_a_trace(GetParam());
}

CONTACTSPLINE_CASES(Number, BadMaterialFile, all_number_cases());
CONTACTSPLINE_CASES(Missing, BadMaterialFile, missing_cases());
CONTACTSPLINE_CASES(Key, BadMaterialFile, key_cases());
CONTACTSPLINE_CASES(Design, BadMaterialFile, design_cases());
CONTACTSPLINE_CASES(Text, BadMaterialFile, text_cases());
CONTACTSPLINE_CASES(Live, BadMaterialFile, live_cases());

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
