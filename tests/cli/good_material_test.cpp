// SPDX-License-Identifier: MIT
// Material files just inside the limits that bad_material_test finds, so that neither limit moves unseen.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "bad_input.hpp"
#include "bad_material.hpp"
#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

struct GoodMaterial {
  std::string test, text;
};

void PrintTo(const GoodMaterial& good, std::ostream* stream) {
  *stream << good.test;
}

std::string with_line_ends(std::string text, const std::string& line_end) {
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += line_end.size())
    text.replace(at, 1, line_end);
  return text;
}

// As what PowerShell writes by `>`.
std::string in_utf_16(const std::string& ascii) {
  std::string text = "\xff\xfe";
  for (const char c : ascii) (text += c) += '\0';
  return text;
}

std::vector<GoodMaterial> good_cases() {
  const std::string good = kGood;
  std::string umlauts;
  for (int i = 0; i < 200; ++i) umlauts += "\xc3\xa4";
  std::vector<GoodMaterial> cases = {
      {"as_it_is", good},
      {"byte_order_mark", "\xef\xbb\xbf" + good},
      {"utf_16", in_utf_16(good)},
      {"comments", "// one\n/* two */" + changed("\"contact\"", "// three\n\"contact\"")},
      {"windows_line_ends", with_line_ends(good, "\r\n")},
      {"one_line", with_line_ends(good, " ")},
      {"no_line_end_but_space_up_to_1_mib", good + std::string((1 << 20) - good.size(), ' ')},
      {"no_description", changed("\"description\": \"a probe\",", "")},
      {"empty_description", changed("a probe", "")},
      {"description_of_200_umlauts", changed("a probe", umlauts)},
      {"description_of_markup", changed("a probe", "<b>&amp; 'x' {/Symbol a} @NAME@ %s ]]> --> */")},
      {"name_of_64", changed("\"probe\"", '"' + std::string(64, 'a') + '"')},
      {"name_of_one", changed("\"probe\"", "\"a\"")},
      {"equal_speeds", changed("\"min_speed_m_per_s\": 0.1", "\"min_speed_m_per_s\": 6")},
      {"compression_from_impact", changed(", \"max_compression_m\": 1e-3", "")},
      {"exponent_1", changed("2.5", "1")},
      {"one_segment", changed("\"segments\": 8", "\"segments\": 1")},
      {"graded", with_spline(R"("knots": "graded", "segments": 8)")},
      {"graded_of_one_speed",
       [] {
         std::string text = with_spline(R"("knots": "graded", "segments": 8)");
         return text.replace(text.find(R"("min_speed_m_per_s": 0.1)"), 24, R"("min_speed_m_per_s": 6.0)");
       }()},
      {"optimal_of_128", with_spline(R"("knots": "optimal", "segments": 128)")},
      {"optimal_in_force", with_spline(R"("knots": "optimal", "segments": 8, "minimise": "force")")},
      {"graded_by_tolerance", with_spline(R"("knots": "graded", "tolerance": 0.5)")},
      {"optimal_in_spectrum", with_spline(R"("knots": "optimal", "segments": 8, "minimise": "spectrum")")},
      {"spectrum_by_tolerance", with_spline(R"("knots": "optimal", "minimise": "spectrum", "tolerance_db": 20)")},
      {"uniform_by_tolerance", with_spline(R"("knots": "uniform", "tolerance": 0.01, "max_compression_m": 1e-3)")}};
  const std::vector<std::pair<std::string, std::vector<std::string>>> ends = {
      {"\"stiffness_n_per_m_alpha\": 4.5e9", {"0.001", "1e18"}},
      {"\"exponent\": 2.5", {"10"}},
      {"\"mass_kg\": 0.003", {"1e-9", "1e4"}},
      {"\"max_speed_m_per_s\": 6.0", {"1000"}},
      {"\"min_speed_m_per_s\": 0.1", {"1e-6"}},
      {"\"segments\": 8", {"65536"}},
      {"\"max_compression_m\": 1e-3", {"1e-9", "1"}}};
  for (const auto& [member, values] : ends)
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto key = member.substr(1, member.find('"', 1) - 1);
      cases.push_back({key + "_at_end_" + std::to_string(i),
                       changed(member, member.substr(0, member.find(':') + 1) + values[i])});
    }
  return cases;
}

class GoodMaterialFile : public ::testing::TestWithParam<GoodMaterial> {};

TEST_P(GoodMaterialFile, IsAccepted) {
  const Sandbox box;
  write_file(box / "probe.json", GetParam().text);
  succeed({.arguments = {"generate", "probe.json", "-o", "out"}, .folder = box.path()});
  EXPECT_EQ(std::distance(fs::directory_iterator(box / "out"), {}), 3);
}

CONTACTSPLINE_CASES(Good, GoodMaterialFile, good_cases());

}  // namespace
}  // namespace contactspline::testing
