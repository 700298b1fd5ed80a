// SPDX-License-Identifier: MIT
// All the errors that a force-compression curve can have: one line that names file, line and what is allowed, and
// nothing written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bad_input.hpp"
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

const std::string kTenth = "0.5,50\n";  // line 11

std::vector<BadFile> computed_cases() {
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
      {"too_few", good(kHeader, 7), "samples: has 7", "allowed: 8 to 10000"},
      {"too_many", many, "samples: has 10001", "allowed: 8 to 10000"},
      {"loading_and_unloading", loop, "line 22: compression 0.00095",
       "m does not rise; allowed: rising compressions: the loading branch only, or both branches and the key "
       "impact_speed_m_per_s (contact.curve.impact_speed_m_per_s of a material)"},
      {"falls", falls, "line 7: force falls from 100 to 75 N", "allowed: forces that rise"},
      {"all_pull", pulls, "force: no force is positive", "allowed: positive forces"},
      {"softens", softens, "contact.curve.shape: the samples scatter by ",
       "of the largest force around the fitted curve; allowed: at most 10 %: another shape"},
      {"only_noise", noise, "contact.curve.shape: the samples scatter by 1", "allowed: at most 10 %"},
      {"long_line", good() + std::string(100'000, '1') + "\n", "line 22: '1111", "...' does not have two columns"},
      {"large", good() + std::string(1 << 20, ' '), "contact.curve.file: in/probe.csv: file: is larger than 1 MiB",
       "allowed: a file of at most 1 MiB"}};
}

class BadCurveFile : public ::testing::TestWithParam<BadFile> {};

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

CONTACTSPLINE_CASES(Curve, BadCurveFile, bad_files("curve", "Curve", {{"", good()}}));
CONTACTSPLINE_CASES(Computed, BadCurveFile, computed_cases());

// Laws of contact; the texts of cases are what stands between the braces of "contact".
Bases contacts() {
  const std::string power = R"("stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5)";
  const std::string term = R"([{ "stiffness_n_per_m_alpha": 4e8, "exponent": 2.3 }])";
  return {
      {"power", power},
      {"restitution", power + R"(, "restitution": { "coefficient": 0.5, "speed_m_per_s": 1 })"},
      {"memory", power + R"(, "memory": [{ "weight": 0.5, "relaxation_time_s": 1e-5 }])"},
      {"sum", R"("sum": )" + term},
      {"series", R"("series": )" + term},
      {"curve", R"("curve": { "file": "probe.csv", "shape": "hardening" })"},
      {"hertz",
       R"("hertz": { "bodies": [{ "shape": "sphere", "radius_m": 0.01, "youngs_modulus_pa": 210e9, "poisson_ratio": 0.3 }, )"
       R"({ "shape": "plane", "youngs_modulus_pa": 210e9, "poisson_ratio": 0.3 }] })"}};
}

class BadContactObject : public ::testing::TestWithParam<BadFile> {};

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

CONTACTSPLINE_CASES(Contact, BadContactObject, bad_files("curve", "Contact", contacts()));

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
      {"dips_in_loading", changed(good(), kTenth, "0.5,10\n") + branches(0.8).substr(good().size()), "2.0", "",
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
  std::string utf_16 = "\xff\xfe";
  for (const char c : good()) (utf_16 += c) += '\0';
  return {{"as_it_is", good()},
          {"eight_samples", good(kHeader, 8)},
          {"noise_of_a_fifth", noisy},
          {"blanks_and_comments", spaced},
          {"metres", metres},
          {"micrometres", micrometres},
          {"no_line_end", no_line_end},
          {"byte_order_mark", "\xef\xbb\xbf" + good()},
          {"utf_16", utf_16}};
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
