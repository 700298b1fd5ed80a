// SPDX-License-Identifier: MIT
// All the errors that a force-compression curve can have: one line that names file, line and what is allowed, and
// nothing written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cases.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

std::string material(const std::string& file = "probe.csv", const std::string& shape = "hardening",
                     const std::string& more = "") {
  return fmt::format(R"({{ "name": "probe",
  "contact": {{ "curve": {{ "file": "{}", "shape": "{}" }}{} }},
  "impact": {{ "mass_kg": 0.003, "max_speed_m_per_s": 2.0, "min_speed_m_per_s": 0.1 }},
  "spline": {{ "knots": "uniform", "segments": 16 }} }})",
                     file, shape, more);
}

// F = 1e5 y up to 1 mm in 20 samples: 2 m/s reach 0.35 mm. Lines 2 to 21.
constexpr auto kHeader = "compression_mm,force_n\n";

std::string good(const std::string& header = kHeader, int samples = 20) {
  std::string text = header;
  for (int i = 1; i <= samples; ++i) text += fmt::format("{},{}\n", 0.05 * i, 5 * i);
  return text;
}

// good() with its one `from` replaced.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = good();
  const auto at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos)
    throw std::logic_error(from + " does not occur just once");
  return text.replace(at, from.size(), to);
}

struct BadCurve {
  std::string test;
  std::string text;  ///< text of the CSV file
  std::string says;  ///< how the message begins, after the file's name
  std::string allowed;
};

void PrintTo(const BadCurve& bad, std::ostream* stream) {
  *stream << bad.test;
}

const std::string kHeaders = "allowed: a header compression_UNIT,force_UNIT (m, mm, um; n, mn, kn)";
const std::string kNumbers = "allowed: finite numbers such as 1.5e-4";
const std::string kTenth = "0.5,50\n";  // line 11

std::vector<BadCurve> cases() {
  std::string loop = good();
  for (int i = 19; i >= 0; --i) loop += fmt::format("{},{}\n", 0.05 * i, 4 * i);
  std::string falls = kHeader;
  for (int i = 1; i <= 20; ++i) falls += fmt::format("{},{}\n", 0.05 * i, 105 - 5 * i);
  std::string pulls = kHeader;
  for (int i = 1; i <= 20; ++i) pulls += fmt::format("{},{}\n", 0.05 * i, -5 * i);
  std::string many = kHeader;
  for (int i = 1; i <= 10001; ++i) many += fmt::format("{},{}\n", 1e-4 * i, i);
  std::string softens = kHeader;
  for (int i = 1; i <= 50; ++i) softens += fmt::format("{},{}\n", 0.02 * i, 100 * std::tanh(i / 5.0));
  std::string noise = kHeader;  // pulls by a tenth all along, and once pushes
  for (int i = 1; i <= 600; ++i) noise += fmt::format("{},{}\n", 0.002 * i, i == 600 ? 100.0 : -9.5);
  return {
      {"empty", "", "header: missing", kHeaders},
      {"blank", "\n \r\n\t\n", "header: missing", kHeaders},
      {"comments_only", "# a\n# b\n", "header: missing", kHeaders},
      {"no_header", good(""), "line 1: the first column of the header is unknown", kHeaders},
      {"unknown_unit", good("compression_inch,force_n\n"), "line 1: the first column of the header is unknown",
       kHeaders},
      {"no_unit", good("compression,force\n"), "line 1: the first column of the header", kHeaders},
      {"columns_swapped", good("force_n,compression_mm\n"), "line 1: the first column", kHeaders},
      {"unknown_force", good("compression_mm,force_lb\n"), "line 1: the second column of the header is unknown",
       kHeaders},
      {"three_columns", good("compression_mm,force_n,time_s\n"), "line 1: the header does not have two columns",
       kHeaders},
      {"semicolons", "compression_mm;force_n\n0,05;5\n", "line 1: the header does not have two columns", kHeaders},
      {"header_only", kHeader, "samples: has 0", "allowed: 8 to 10000"},
      {"too_few", good(kHeader, 7), "samples: has 7", "allowed: 8 to 10000"},
      {"too_many", many, "samples: has 10001", "allowed: 8 to 10000"},
      {"one_column", changed(kTenth, "0.5\n"), "line 11: '0.5' does not have two columns", kHeaders},
      {"extra_column", changed(kTenth, "0.5,50,1\n"), "line 11: '0.5,50,1' does not have two columns", kHeaders},
      {"decimal_comma", changed(kTenth, "0,5,50\n"), "line 11: '0,5,50' does not have two columns", kHeaders},
      {"empty_field", changed(kTenth, "0.5,\n"), "line 11: '' is not a number", kNumbers},
      {"text", changed(kTenth, "0.5,fifty\n"), "line 11: 'fifty' is not a number", kNumbers},
      {"quotes", changed(kTenth, "\"0.5\",50\n"), "line 11: '\"0.5\"' is not a number", kNumbers},
      {"unit_in_field", changed(kTenth, "0.5,50 N\n"), "line 11: '50 N' is not a number", kNumbers},
      {"hexadecimal", changed(kTenth, "0.5,0x32\n"), "line 11: '0x32' is not a number", kNumbers},
      {"nan", changed(kTenth, "0.5,NaN\n"), "line 11: 'NaN' is not a number", kNumbers},
      {"infinite", changed(kTenth, "0.5,inf\n"), "line 11: 'inf' is not a number", kNumbers},
      {"overflow", changed(kTenth, "0.5,1e999\n"), "line 11: '1e999' is not a number", kNumbers},
      {"plus", changed(kTenth, "0.5,+50\n"), "line 11: '+50' is not a number", kNumbers},
      {"null_byte", changed(kTenth, std::string("0.5,5\0000\n", 9)), "line 11: '5?0' is not a number", kNumbers},
      {"escape", changed(kTenth, "0.5,\033[31m\n"), "line 11: '?[31m' is not a number", kNumbers},
      {"negative_compression", good().insert(std::string(kHeader).size(), "-0.01,0\n"),
       "line 2: compression -1e-05 m is negative", "allowed: 0 or more"},
      {"compression_twice", changed(kTenth, "0.45,50\n"), "line 11: compression 0.00045",
       "allowed: rising compressions"},
      {"loading_and_unloading", loop, "line 22: compression 0.00095",
       "m does not rise; allowed: rising compressions: the loading branch only, or both branches and the key "
       "impact_speed_m_per_s (contact.curve.impact_speed_m_per_s of a material)"},
      {"rounds", changed(kTenth, "0.1006,50\n"), "line 11: compression 0.0001006 m does not rise", "allowed: rising"},
      {"falls", falls, "line 7: force falls from 100 to 75 N", "allowed: forces that rise"},
      {"one_fall", changed(kTenth, "0.5,10\n"), "line 11: force falls from 45 to 10 N", "allowed: forces that rise"},
      {"all_pull", pulls, "force: no force is positive", "allowed: positive forces"},
      {"one_pulls", changed("0.05,5\n", "0.05,-40\n"), "line 2: force -40 N is negative", "allowed: positive forces"},
      {"millimetres_called_metres", good("compression_m,force_n\n"),
       "compression: reaches 1 m: a wrong unit in the header?", "allowed: a largest value from 1e-08 to 0.1 m"},
      {"metres_called_micrometres", changed(kHeader, "compression_um,force_n\n"),
       "contact.curve: measured up to 1e-06 m", "a wrong unit in its header"},
      {"newtons_called_kilonewtons_and_more", "compression_mm,force_kn\n" + good("").insert(0, "") + "1.1,1e9\n",
       "force: reaches 1e+12 N: a wrong unit in the header?", "allowed: a largest value from 0.001 to 1000000 N"},
      {"kilonewtons_called_millinewtons", changed(kHeader, "compression_mm,force_mn\n"),
       "contact.curve: measured up to 0.001 m, and", "are needed"},
      {"newtons_called_kilonewtons", changed(kHeader, "compression_um,force_mn\n"),
       "contact.curve: measured up to 1e-06", "are needed"},
      {"softens", softens, "contact.curve.shape: the samples scatter by ",
       "of the largest force around the fitted curve; allowed: at most 10 %: another shape"},
      {"only_noise", noise, "contact.curve.shape: the samples scatter by 1", "allowed: at most 10 %"},
      {"binary",
       std::string("\x7f"
                   "ELF\2\1\1\0\0",
                   9),
       "line 1: the header does not have two columns", kHeaders},
      {"long_line", good() + std::string(100'000, '1') + "\n", "line 22: '1111", "...' does not have two columns"},
      {"large", good() + std::string(1 << 20, ' '), "contact.curve.file: in/probe.csv: file: is larger than 1 MiB",
       "allowed: a file of at most 1 MiB"}};
}

class BadCurveFile : public ::testing::TestWithParam<BadCurve> {};

TEST_P(BadCurveFile, IsRefusedInOneLineAndNothingIsWritten) {
  const auto& [test, text, says, allowed] = GetParam();
  const Sandbox box;
  fs::create_directories(box / "in");
  write_file(box / "in/probe.json", material());
  write_file(box / "in/probe.csv", text);
  const auto before = box.listing();
  const auto outcome = run(
      {.arguments = {"generate", "in/probe.json", "-o", "out", "--depfile", "out/probe.d"}, .folder = box.path()});
  const std::string file = says.starts_with("contact") ? "in/probe.json: " : "in/probe.csv: ";
  expect_refused(outcome, file + says, allowed);
  EXPECT_TRUE(box.listing() == before);
}

CONTACTSPLINE_CASES(Curve, BadCurveFile, cases());

struct BadContact {
  std::string test, contact, key, says;
};

void PrintTo(const BadContact& bad, std::ostream* stream) {
  *stream << bad.test;
}

constexpr auto kSteel = R"("youngs_modulus_pa": 210e9, "poisson_ratio": 0.3)";
constexpr auto kLaws = "allowed: one of stiffness_n_per_m_alpha with exponent, hertz, curve, sum, series";

std::string bodies(const std::string& one, const std::string& other) {
  return R"("hertz": { "bodies": [)" + one + ", " + other + "] }";
}
std::string ball(const std::string& radius = R"("radius_m": 0.01)") {
  return fmt::format(R"({{ "shape": "sphere", {}, {} }})", radius, kSteel);
}
std::string plane(const std::string& more = "") {
  return fmt::format(R"({{ "shape": "plane", {}{} }})", kSteel, more);
}
std::string rod() {
  return fmt::format(R"({{ "shape": "cylinder", "radius_m": 0.01, {} }})", kSteel);
}
std::string power(const std::string& more = "") {
  return R"("stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5)" + more;
}

std::vector<BadContact> contact_cases() {
  const std::string term = R"({ "stiffness_n_per_m_alpha": 4e8, "exponent": 2.3)";
  return {
      {"no_law", "", "contact", std::string("has no law; ") + kLaws},
      {"loss_only", R"("loss_s_per_m": 0.1)", "contact", std::string("has no law; ") + kLaws},
      {"two_laws", power(", ") + bodies(ball(), plane()), "contact", std::string("has more than one law; ") + kLaws},
      {"exponent_of_hertz", R"("exponent": 1.5, )" + bodies(ball(), plane()), "contact", "has more than one law"},
      {"exponent_only", R"("exponent": 1.5)", "contact.stiffness_n_per_m_alpha", "missing; allowed: a number"},
      {"hertz_is_number", R"("hertz": 1)", "contact.hertz", "is not an object; allowed: bodies"},
      {"one_body", R"("hertz": { "bodies": [)" + ball() + "] }", "contact.hertz.bodies", "allowed: two bodies"},
      {"three_bodies", R"("hertz": { "bodies": [)" + ball() + "," + ball() + "," + ball() + "] }",
       "contact.hertz.bodies", "has 3 entries"},
      {"two_planes", bodies(plane(), plane()), "contact.hertz.bodies", "allowed: a sphere with any body"},
      {"line_contact", bodies(rod(), plane()), "contact.hertz.bodies", "or two cylinders, crossed at right angles"},
      {"shape_is_cone", bodies(R"({ "shape": "cone" })", plane()), "contact.hertz.bodies[0].shape",
       "'cone' is unknown; allowed: sphere, cylinder, plane"},
      {"shape_missing", bodies("{}", plane()), "contact.hertz.bodies[0].shape", "missing; allowed: sphere"},
      {"radius_missing", bodies(plane(), fmt::format(R"({{ "shape": "sphere", {} }})", kSteel)),
       "contact.hertz.bodies[1].radius_m", "missing; allowed: a number from 1e-05 to 100"},
      {"radius_of_plane", bodies(ball(), plane(R"(, "radius_m": 1)")), "contact.hertz.bodies[1].radius_m",
       "a plane has no radius"},
      {"radius_in_mm", bodies(ball(R"("radius_m": 101)"), plane()), "contact.hertz.bodies[0].radius_m",
       "101 is out of range; allowed: a number from 1e-05 to 100"},
      {"modulus_in_gpa", bodies(ball(), R"({ "shape": "plane", "youngs_modulus_pa": 210, "poisson_ratio": 0.3 })"),
       "contact.hertz.bodies[1].youngs_modulus_pa",
       "210 is out of range; allowed: a number from 1000 to 2000000000000"},
      {"poisson_of_one", bodies(ball(), R"({ "shape": "plane", "youngs_modulus_pa": 2e11, "poisson_ratio": 0.6 })"),
       "contact.hertz.bodies[1].poisson_ratio", "0.6 is out of range; allowed: a number from -1 to 0.5"},
      {"unknown_in_body", bodies(ball(), plane(R"(, "density": 1)")), "contact.hertz.bodies[1].density",
       "unknown key"},
      {"sum_is_empty", R"("sum": [])", "contact.sum", "has 0 entries; allowed: an array of 1 to 8 objects"},
      {"sum_of_numbers", R"("sum": [1])", "contact.sum[0]", "is not an object"},
      {"sum_begins_late", R"("sum": [)" + term + R"(, "offset_m": 1e-4 }])", "contact.sum", "no term has offset 0"},
      {"offset_is_negative", R"("sum": [)" + term + R"(, "offset_m": -1e-4 }])", "contact.sum[0].offset_m",
       "is out of range; allowed: a number from 0 to 0.1"},
      {"series_is_empty", R"("series": [])", "contact.series", "has 0 entries; allowed: an array of 1 to 8 objects"},
      {"offset_in_series", R"("series": [)" + term + R"(, "offset_m": 1e-4 }])", "contact.series[0].offset_m",
       "unknown key; allowed: stiffness_n_per_m_alpha, exponent"},
      {"sum_and_series", R"("sum": [)" + term + R"( }], "series": [)" + term + " }]", "contact",
       "has more than one law"},
      {"term_without_exponent", R"("sum": [{ "stiffness_n_per_m_alpha": 4e8 }])", "contact.sum[0].exponent",
       "missing"},
      {"curve_without_shape", R"("curve": { "file": "probe.csv" })", "contact.curve.shape",
       "missing; allowed: hardening, monotone"},
      {"curve_of_unknown_shape", R"("curve": { "file": "probe.csv", "shape": "nice" })", "contact.curve.shape",
       "'nice' is unknown; allowed: hardening, monotone"},
      {"curve_without_file", R"("curve": { "shape": "hardening" })", "contact.curve.file",
       "missing; allowed: the name"},
      {"curve_of_no_name", R"("curve": { "file": "", "shape": "hardening" })", "contact.curve.file", "is not usable"},
      {"curve_of_absolute_path", R"("curve": { "file": "/tmp/a.csv", "shape": "hardening" })", "contact.curve.file",
       "relative to the material file"},
      {"loss_is_negative", power(R"(, "loss_s_per_m": -0.1)"), "contact.loss_s_per_m",
       "allowed: a number from 0 to 1000"},
      {"two_losses", power(R"(, "loss_s_per_m": 0.1, "restitution": {})"), "contact.restitution",
       "allowed: one of the two"},
      {"restitution_is_number", power(R"(, "restitution": 0.5)"), "contact.restitution",
       "is not an object; allowed: coefficient, speed_m_per_s"},
      {"restitution_of_nothing", power(R"(, "restitution": { "coefficient": 0, "speed_m_per_s": 1 })"),
       "contact.restitution.coefficient", "0 is out of range; allowed: a number from 0.05 to 1"},
      {"restitution_above_one", power(R"(, "restitution": { "coefficient": 1.1, "speed_m_per_s": 1 })"),
       "contact.restitution.coefficient", "1.1 is out of range"},
      {"restitution_without_speed", power(R"(, "restitution": { "coefficient": 0.5 })"),
       "contact.restitution.speed_m_per_s", "missing"},
      {"restitution_at_no_speed", power(R"(, "restitution": { "coefficient": 0.5, "speed_m_per_s": 1e-5 })"),
       "contact.restitution", "allowed: a loss of at most 1000 s/m"},
      {"memory_is_object", power(R"(, "memory": { "weight": 0.5, "relaxation_time_s": 1e-5 })"), "contact.memory",
       "allowed: an array of 1 to 4 objects"},
      {"memory_of_none", power(R"(, "memory": [])"), "contact.memory", "has 0 entries"},
      {"memory_without_time", power(R"(, "memory": [{ "weight": 0.5 }])"), "contact.memory[0].relaxation_time_s",
       "missing; allowed: a number from 1e-07 to 10"},
      {"memory_without_weight", power(R"(, "memory": [{ "relaxation_time_s": 1e-5 }])"), "contact.memory[0].weight",
       "missing; allowed: a number from 1e-06 to 0.999"},
      {"memory_in_microseconds", power(R"(, "memory": [{ "weight": 0.5, "relaxation_time_s": 20 }])"),
       "contact.memory[0].relaxation_time_s", "20 is out of range"},
      {"memory_of_all", power(R"(, "memory": [{ "weight": 1, "relaxation_time_s": 1e-5 }])"),
       "contact.memory[0].weight", "1 is out of range"},
      {"memories_of_more_than_all", power(R"(, "memory": [{ "weight": 0.5, "relaxation_time_s": 1e-5 },
         { "weight": 0.6, "relaxation_time_s": 1e-4 }])"),
       "contact.memory", "has weights with the sum 1.1; allowed: a sum of at most 0.999"}};
}

class BadContactObject : public ::testing::TestWithParam<BadContact> {};

TEST_P(BadContactObject, IsRefusedInOneLine) {
  const auto& [test, contact, key, says] = GetParam();
  const Sandbox box;
  write_file(box / "probe.csv", good());
  write_file(box / "probe.json", R"({ "name": "probe", "contact": { )" + contact + R"( },
    "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 2.0, "min_speed_m_per_s": 0.1 },
    "spline": { "knots": "uniform", "segments": 16 } })");
  expect_refused(run({.arguments = {"inspect", "probe.json"}, .folder = box.path()}), "probe.json: " + key + ": ",
                 says);
}

CONTACTSPLINE_CASES(Contact, BadContactObject, contact_cases());

// Both branches of an impact: F = 1e5 y in loading, less in unloading.
std::string branches(double unloading, int samples = 20) {
  std::string text = good();
  for (int i = 1; i <= samples; ++i) text += fmt::format("{},{}\n", 1 - 0.05 * i, unloading * (100 - 5 * i));
  return text;
}

struct BadImpactCurve {
  std::string test, text, speed, loss, says, allowed;
};

void PrintTo(const BadImpactCurve& bad, std::ostream* stream) {
  *stream << bad.test;
}

std::vector<BadImpactCurve> impact_cases() {
  const std::string loop = branches(0.8), speed_is = "probe.json: contact.curve.impact_speed_m_per_s: ";
  const std::string turns_again = loop + "0.2,1\n";
  return {
      {"loading_only", good(), "2.0", "", "probe.csv: samples: has 20 of loading and 0 of unloading",
       "allowed: 4 or more of each, for the key impact_speed_m_per_s (contact.curve.impact_speed_m_per_s of"},
      {"three_of_unloading", branches(0.8, 3), "2.0", "", "probe.csv: samples: has 20 of loading and 3 of unloading",
       "allowed: 4 or more of each"},
      {"turns_twice", turns_again, "2.0", "", "probe.csv: line 42: compression 0.0002 m does not fall",
       "allowed: compressions that rise to the largest, then fall"},
      {"stands_still", loop + "0,0\n", "2.0", "", "probe.csv: line 42: compression 0 m does not fall", "then fall"},
      {"below_0", loop + "-0.1,0\n", "2.0", "", "probe.csv: line 42: compression -0.0001 m is negative",
       "allowed: 0 or more"},
      {"pulls", good() + "0.9,60\n0.7,40\n0.5,20\n0.3,-30\n0.1,0\n", "2.0", "",
       "probe.csv: line 25: force -30 N is negative", "allowed: positive forces"},
      {"dips_in_loading", changed(kTenth, "0.5,10\n") + branches(0.8).substr(good().size()), "2.0", "",
       "probe.csv: line 11: force falls from 45 to 10 N", "allowed: forces with one peak"},
      {"rises_in_unloading", good() + "0.9,20\n0.8,70\n0.7,50\n0.5,30\n0.3,10\n", "2.0", "",
       "probe.csv: line 22: force falls from 70 to 20 N", "allowed: forces with one peak"},
      {"gives_back_more", branches(1.1), "2.0", "", "probe.csv: force: gives back 0.05",
       "of 0.05 J; allowed: an unloading"},
      {"no_speed", loop, "0", "", speed_is + "0 is out of range", "allowed: a number from 1e-06 to 1000"},
      {"asks_for_too_much_loss", branches(0.2), "1e-4", "", speed_is + "asks for a loss beyond all allowed ones",
       "allowed: a loss of at most 1000 s/m: a higher speed"},
      {"speed_is_text", loop, R"("fast")", "", speed_is + "is not a number", "allowed: a number from 1e-06 to 1000"},
      {"loss", loop, "2.0", R"(, "loss_s_per_m": 0.1)", "probe.json: contact.loss_s_per_m: is given together with",
       "allowed: one of the two: the loss is fitted"},
      {"restitution", loop, "2.0", R"(, "restitution": { "coefficient": 0.5, "speed_m_per_s": 1 })",
       "probe.json: contact.restitution: is given together with curve.impact_speed_m_per_s",
       "allowed: one of the two"}};
}

class BadImpactCurveFile : public ::testing::TestWithParam<BadImpactCurve> {};

TEST_P(BadImpactCurveFile, IsRefusedInOneLine) {
  const auto& [test, text, speed, loss, says, allowed] = GetParam();
  const Sandbox box;
  write_file(box / "probe.csv", text);
  write_file(box / "probe.json", fmt::format(R"({{ "name": "probe", "contact": {{
    "curve": {{ "file": "probe.csv", "shape": "hardening", "impact_speed_m_per_s": {} }}{} }},
    "impact": {{ "mass_kg": 0.003, "max_speed_m_per_s": 2.0, "min_speed_m_per_s": 0.1 }},
    "spline": {{ "knots": "uniform", "segments": 16 }} }})",
                                             speed, loss));
  expect_refused(run({.arguments = {"inspect", "probe.json"}, .folder = box.path()}), says, allowed);
}

CONTACTSPLINE_CASES(Impact, BadImpactCurveFile, impact_cases());

// The spline of an impact reaches as far as a blow without loss, further than the measured one.
TEST(BadImpactCurve, IsTooShortForItsOwnSpeed) {
  const Sandbox box;
  write_file(box / "probe.csv", branches(0.8));
  write_file(box / "probe.json", R"({ "name": "probe",
    "contact": { "curve": { "file": "probe.csv", "shape": "hardening", "impact_speed_m_per_s": 2.0 } },
    "impact": { "mass_kg": 0.1, "max_speed_m_per_s": 2.0, "min_speed_m_per_s": 0.1 },
    "spline": { "knots": "uniform", "segments": 16 } })");
  expect_refused(run({.arguments = {"inspect", "probe.json"}, .folder = box.path()}),
                 "probe.json: contact.curve: measured up to 0.001 m",
                 "allowed: impact.max_speed_m_per_s of at most 0.9474, with which a blow without loss ends within");
}

// A loss is called fitted only where an impact was measured.
TEST(GoodImpactCurve, HasAFittedLoss) {
  const Sandbox box;
  const auto inspected = [&](const std::string& text, const std::string& curve, const std::string& loss) {
    write_file(box / "probe.csv", text);
    write_file(box / "probe.json", fmt::format(R"({{ "name": "probe", "contact": {{
      "curve": {{ "file": "probe.csv", "shape": "hardening"{} }}{} }},
      "impact": {{ "mass_kg": 0.003, "max_speed_m_per_s": 1.5, "min_speed_m_per_s": 0.1 }},
      "spline": {{ "knots": "uniform", "segments": 16 }} }})",
                                               curve, loss));
    return succeed({.arguments = {"inspect", "probe.json"}, .folder = box.path()});
  };
  const std::string fitted = ", fitted to loading and unloading\n";
  const std::string impact = inspected(branches(0.8), R"(, "impact_speed_m_per_s": 2.0)", "");
  EXPECT_NE(impact.find(fitted), std::string::npos) << impact;
  const std::string fewest = inspected(branches(0.8, 4), R"(, "impact_speed_m_per_s": 2.0)", "");
  EXPECT_NE(fewest.find(fitted), std::string::npos) << fewest;
  const std::string slow = inspected(good(), "", R"(, "loss_s_per_m": 0.1)");
  EXPECT_NE(slow.find("\nloss 0.1 s/m\n"), std::string::npos) << slow;
}

TEST(BadCurveFile, CannotBeOpened) {
  const Sandbox box;
  const auto refused = [&](const std::string& curve, const std::string& begins, const std::string& says) {
    write_file(box / "probe.json", material(curve));
    expect_refused(run({.arguments = {"inspect", "./probe.json"}, .folder = box.path()}), begins, says);
  };
  fs::create_directories(box / "folder.csv");
  refused("nowhere.csv", "./probe.json: contact.curve.file: ./nowhere.csv: file: does not exist",
          "allowed: a file of at most 1 MiB");
  refused("folder.csv", "./probe.json: contact.curve.file: ./folder.csv: file: is not a regular file",
          "allowed: a file of at most 1 MiB");
#ifdef __linux__
  expect_refused(run({.arguments = {"inspect", "/proc/self/mem"}, .folder = box.path()}),
                 "/proc/self/mem: file: Input/output error", "allowed: a file of at most 1 MiB");
#endif
}

TEST(BadCurveFile, IsNotReplacedByAnOutput) {
  const Sandbox box;
  write_file(box / "probe.json", material("probe.hpp"));
  write_file(box / "probe.hpp", good());
  expect_refused(run({.arguments = {"generate", "probe.json"}, .folder = box.path()}),
                 "./probe.hpp: file: is already an input or another output", "allowed: another folder or file name");
  write_file(box / "probe.json", material("probe.svg"));
  write_file(box / "probe.svg", good());
  expect_refused(run({.arguments = {"inspect", "probe.json", "--figure", "probe.svg"}, .folder = box.path()}),
                 "probe.svg: file: is already an input or another output", "allowed: another folder or file name");
}

struct GoodCurve {
  std::string test, text;
};

void PrintTo(const GoodCurve& good_one, std::ostream* stream) {
  *stream << good_one.test;
}

std::vector<GoodCurve> good_cases() {
  std::string noisy = kHeader;
  for (int i = 0; i <= 20; ++i) noisy += fmt::format("{},{}\n", 0.05 * i, 5 * i + (i % 2 == 0 ? 9 : -9));
  std::string spaced = "  compression_mm\t, force_n \r\n\r\n# note\r\n";
  for (int i = 1; i <= 20; ++i) spaced += fmt::format(" {} ,\t{}  \r\n", 0.05 * i, 5 * i);
  std::string metres = "compression_m,force_kn\n", micrometres = "compression_um,force_mn\n";
  for (int i = 1; i <= 20; ++i) {
    metres += fmt::format("{}e-5,{}e-3\n", 5 * i, 5 * i);
    micrometres += fmt::format("{},{}\n", 50 * i, 5000 * i);
  }
  std::string no_line_end = good();
  no_line_end.pop_back();
  return {{"as_it_is", good()},         {"eight_samples", good(kHeader, 8)},
          {"noise_of_a_fifth", noisy},  {"blanks_and_comments", spaced},
          {"metres", metres},           {"micrometres", micrometres},
          {"no_line_end", no_line_end}, {"byte_order_mark", "\xef\xbb\xbf" + good()}};
}

class GoodCurveFile : public ::testing::TestWithParam<GoodCurve> {};

// The same curve in other words is the same curve, but for the rounding of its units; noise and fewer samples leave
// the straight line they stand for to a tenth.
TEST_P(GoodCurveFile, IsAccepted) {
  const Sandbox box;
  for (const char* shape : {"hardening", "monotone"}) {
    write_file(box / "probe.json", material("probe.csv", shape));
    write_file(box / "probe.csv", GetParam().text);
    const std::string found =
        succeed({.arguments = {"generate", "probe.json", "--emit", "json", "-o", "-"}, .folder = box.path()});
    const double bound = GetParam().test == "noise_of_a_fifth" ? 0.1 : 1e-12;
    EXPECT_TRUE(
        relatively_within(nlohmann::json::parse(found).at("max_compression_m"), std::sqrt(0.012 / 1e5), bound));
  }
}

CONTACTSPLINE_CASES(Curve, GoodCurveFile, good_cases());

// The curve is part of what the outputs follow from.
TEST(Curve, IsNamedInTheDepfile) {
  const Sandbox box;
  fs::create_directories(box / "in/data");
  write_file(box / "in/probe.json", material("data/probe.csv"));
  write_file(box / "in/data/probe.csv", good());
  succeed({.arguments = {"generate", "in/probe.json", "--emit", "cpp", "-o", "out", "--depfile", "d"},
           .folder = box.path()});
  EXPECT_EQ(read_file(box / "d"), "out/probe.hpp: in/probe.json in/data/probe.csv\n");
}

}  // namespace
}  // namespace contactspline::testing
