// SPDX-License-Identifier: MIT
// contactspline impact: the numbers of the library as table, JSON, CSV and figure.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "generator/contact/barrier_impact.hpp"
#include "generator/spline/design.hpp"
#include "generator/spline/simulated_impact.hpp"
#include "generator/support/embedded_files.hpp"
#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/compare.hpp"
#include "svg.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;

struct ImpactRow {
  double duration_us, duration_error, compression_um, compression_error, exit_error, samples;
};

ImpactRow parse_row(const std::string& line, const std::string& label) {
  std::istringstream row(line.substr(label.size()));
  std::string unit, percent;
  ImpactRow found{};
  row >> found.duration_us >> unit >> found.duration_error >> percent >> found.compression_um >> unit >>
      found.compression_error >> percent;
  EXPECT_TRUE(line.starts_with(label) && row && unit == "um" && percent == "%") << line;
  row >> found.exit_error >> percent >> found.samples;
  found.exit_error /= 100;
  return found;
}

TEST(Impact, PrintsTheNumbersOfTheLibrary) {
  const Sandbox box;
  write_file(box / "probe.json", material(16));
  const auto design = design_material(material(16), "probe.json");
  const auto lines = lines_of(printed(
      box, {"impact", "probe.json", "--speed", "1.5", "--speed", "0.25", "--rate", "44100", "--rate", "1e6"}));
  ASSERT_EQ(lines.size(), 12u);
  std::size_t line = 0;
  for (const double speed : {1.5, 0.25}) {
    const double duration = contact_duration(design.material.contact, 0.01, speed);
    const double compression = max_compression(design.material.contact, 0.01, speed);
    EXPECT_EQ(lines[line], fmt::format("probe, 0.01 kg at {} m/s", speed));
    EXPECT_TRUE(within(number_after(lines[line + 2], "exact"), 1e6 * duration, 6e-4));
    EXPECT_TRUE(within(number_after(lines[line + 2], " us"), 1e6 * compression, 6e-5));
    const auto exact = impact_on_spline(design.spline, 0.01, speed);
    const auto spline = parse_row(lines[line + 3], "  spline  16");
    EXPECT_TRUE(within(spline.duration_us, 1e6 * exact.contact_duration_s, 6e-4));
    EXPECT_TRUE(within(spline.duration_error, 100 * (exact.contact_duration_s / duration - 1), 6e-4));
    EXPECT_TRUE(within(spline.compression_um, 1e6 * exact.max_compression_m, 6e-5));
    EXPECT_TRUE(within(spline.compression_error, 100 * (exact.max_compression_m / compression - 1), 6e-4));
    line += 4;
    for (const auto& [label, rate] : {std::pair{"    44.1 kHz", 44100.0}, std::pair{"  1000.0 kHz", 1e6}}) {
      const auto simulated = simulate_impact(segment_table(design.spline), 0.01, speed, rate);
      const auto row = parse_row(lines[line++], label);
      EXPECT_TRUE(within(row.duration_us, 1e6 * simulated.contact_duration_s, 6e-4));
      EXPECT_TRUE(within(row.duration_error, 100 * (simulated.contact_duration_s / duration - 1), 6e-4));
      EXPECT_TRUE(within(row.compression_um, 1e6 * simulated.max_compression_m, 6e-5));
      EXPECT_TRUE(within(row.compression_error, 100 * (simulated.max_compression_m / compression - 1), 6e-4));
      EXPECT_TRUE(within(row.exit_error, simulated.exit_speed_m_per_s / speed - 1, 1e-12));
      EXPECT_TRUE(within(row.samples, duration * rate, 6e-3));
    }
  }
}

// Without loss by closed form or quadrature, with loss by quadrature through law and spline; simulated at 100 MHz.
class ImpactOf : public ::testing::TestWithParam<std::string> {};

TEST_P(ImpactOf, AMaterialThatShipsConvergesToTheExactMotion) {
  const Sandbox box;
  const auto texts = embedded_files(Shipped::kMaterials);
  const auto file = std::ranges::find(texts, GetParam() + ".json", &EmbeddedFile::name);
  const auto material = design_material(file->content, file->name).material;
  const double mass = material.impact->mass_kg, loss = material.loss_s_per_m;
  const BarrierImpact exact = barrier_impact(law_view(material.contact), mass, 1.0, loss);
  const auto lines = lines_of(printed(box, {"impact", GetParam(), "--speed", "1", "--rate", "1e7"}));
  ASSERT_EQ(lines.size(), 5u);
  const std::string left = fmt::format(", loss {:.4g} s/m: restitution {:.4g}", loss, exact.exit_speed_m_per_s);
  EXPECT_EQ(lines[0], fmt::format("{}, {} kg at 1 m/s{}", GetParam(), mass, loss > 0 ? left : ""));
  EXPECT_TRUE(relatively_within(number_after(lines[2], "exact"), 1e6 * exact.contact_duration_s, 2e-5));
  EXPECT_TRUE(relatively_within(number_after(lines[2], " us"), 1e6 * exact.max_compression_m, 2e-4));
  const auto spline = parse_row(lines[3], fmt::format("  spline {:>3}", material.spline.segments));
  const auto simulated = parse_row(lines[4], "  10000.0 kHz");
  EXPECT_LE(std::abs(spline.duration_error), 0.3);  // per cent
  EXPECT_LE(std::abs(spline.compression_error), 0.1);
  EXPECT_TRUE(within(simulated.duration_error, spline.duration_error, 0.02));
  EXPECT_TRUE(within(simulated.compression_error, spline.compression_error, 0.02));
  EXPECT_TRUE(within(simulated.exit_error, 0, loss > 0 ? 1e-4 : 1e-10));
}

INSTANTIATE_TEST_SUITE_P(Kinds, ImpactOf,
                         ::testing::Values("felt_c4", "felt_over_wood", "felt_synthetic", "steel_ball_on_plate"),
                         [](const auto& test) { return test.param; });

// Within the range to its ends no word; beyond it a line before the numbers.
TEST(Impact, SaysWhereAContactIsTooShortForTheRate) {
  const Sandbox box;
  const std::string line = "lasts 30.1 us, 1.3 samples at 44.1 kHz, too few to follow it: 332 kHz has 10\n";
  EXPECT_TRUE(printed(box, {"impact", "steel_on_steel"}).ends_with("  the contact " + line));
  EXPECT_TRUE(printed(box, {"inspect", "steel_on_steel"}).find("\n  a contact at 2 m/s " + line) !=
              std::string::npos);
  const auto written = printed(box, {"generate", "steel_on_steel", "felt_c4"});
  EXPECT_TRUE(written.ends_with("\nsteel_on_steel: a contact at 2 m/s " + line)) << written;
  const Words render = {"render", "mass-barrier", "--material", "steel_on_steel", "--duration", "0.1"};
  EXPECT_TRUE(printed(box, render).find("\na contact " + line) != std::string::npos);
  write_file(box / "score.json", hammer_score("guitar_d3", "steel_on_steel", 0.1, 5e-5));
  write_file(box / "fine.json", hammer_score("guitar_d3", "steel_on_steel", 0.1, 5e-5, R"("oversample": 8, )"));
  const auto rendered = printed(box, {"render", "--score", "score.json", "-o", "score.wav"});
  EXPECT_TRUE(rendered.find("\na contact, on average, lasts 45.9 us, 2 samples at 44.1 kHz, too few") !=
              std::string::npos)
      << rendered;
  EXPECT_EQ(printed(box, {"render", "--score", "fine.json", "-o", "fine.wav"}).find("too few"), std::string::npos);
  const auto coarse = printed(box, {"render", "--score", "fine.json", "--oversample", "1", "-o", "coarse.wav"});
  EXPECT_TRUE(coarse.find("too few") != std::string::npos) << "the option comes before the score: " << coarse;
  printed(box, {"render", "--score", "score.json", "--oversample", "8", "-o", "option.wav"});
  EXPECT_EQ(read_file(box / "fine.wav"), read_file(box / "option.wav"));
  for (const char* command : {"impact", "inspect", "generate"})
    EXPECT_EQ(printed(box, {command, "felt_c4"}).find("too few"), std::string::npos) << command;
}

// At eight times the rate the force is within 2 % of the exact one, and no line says that the contact is too short.
TEST(Impact, IsFollowedByARenderThatRunsFiner) {
  const Sandbox box;
  const auto material =
      design_material(find_embedded(Shipped::kMaterials, "steel_on_steel.json")->content, "steel_on_steel.json")
          .material;
  const double exact_n = material.contact.force(max_compression(material.contact, 0.00411, 2));
  const Words render = {"render",     "mass-barrier", "--material", "steel_on_steel",
                        "--duration", "0.01",         "-o",         "x.wav"};
  for (const std::string factor : {"1", "8"}) {
    Words arguments = render;
    arguments.insert(arguments.end(), {"--oversample", factor, "--force"});
    const auto text = printed(box, arguments);
    const double error = std::abs(number_after(text, "largest contact force") / exact_n - 1);
    EXPECT_TRUE(factor == "8" ? error < 0.02 : error > 0.3) << text;
    EXPECT_EQ(text.find("too few") == std::string::npos, factor == "8") << text;
  }
}

// The rate that the line names does what the page on the command line says of it, and where the line ends it is
// needed.
TEST(Impact, ErrsByAFewPercentWhereAContactHasEnoughSamples) {
  const Sandbox box;
  for (const auto& [rate, least, most] : {std::tuple{"332434", 0.8, 2.0}, std::tuple{"149600", 4.0, 8.0}}) {
    const auto lines = lines_of(printed(box, {"impact", "steel_on_steel", "--rate", rate}));
    ASSERT_EQ(lines.size(), 5u);
    const double error = parse_row(lines[4], lines[4].substr(0, 13)).duration_error;
    EXPECT_TRUE(error >= least && error <= most) << lines[4];
  }
}

TEST(Impact, SaysWhereASpeedIsOutOfTheRange) {
  const Sandbox box;
  write_file(box / "probe.json", material(16));
  const auto lines_at = [&](const std::string& speed) {
    return lines_of(printed(box, {"impact", "probe.json", "--rate", "441000", "--speed", speed}));
  };
  for (const std::string speed : {"0.1", "2"}) EXPECT_EQ(lines_at(speed).size(), 5u) << speed;
  for (const std::string speed : {"0.099", "2.001", "100"}) {
    const auto lines = lines_at(speed);
    ASSERT_EQ(lines.size(), 6u) << speed;
    EXPECT_EQ(lines[1], "  out of the material's range, 0.1 to 2 m/s: the spline is not designed for this speed");
  }
}

// JSON and CSV carry the same numbers, those of the library; the table rounds them.
TEST(Impact, PrintsARangeOfSpeedsInThreeForms) {
  const Sandbox box;
  write_file(box / "probe.json", material(16));
  const auto design = design_material(material(16), "probe.json");
  const Words range = {"impact", "probe.json", "mb1",   "--speeds", "0.05", "3.2",
                       "7",      "--rate",     "44100", "--rate",   "96000"};
  const Json json = Json::parse(printed(box, followed_by(range, {"--json"})));
  ASSERT_EQ(json.size(), 14u);
  std::vector<std::string> rows;
  for (const Json& one : json)
    for (const Json& motion : one.at("motions")) {
      const auto number = [&](const char* key) { return fmt::format(",{}", motion.at(key).get<double>()); };
      rows.push_back(fmt::format("{},{},{},{},{},{}", one.at("material").get<std::string>(),
                                 one.at("mass_kg").get<double>(), one.at("loss_s_per_m").get<double>(),
                                 one.at("speed_m_per_s").get<double>(), one.at("in_range").get<bool>() ? 1 : 0,
                                 motion.at("model").get<std::string>()));
      for (const auto* key :
           {"sample_rate_hz", "contact_duration_s", "max_compression_m", "exit_speed_m_per_s", "max_force_n",
            "contact_duration_error", "max_compression_error", "exit_speed_error", "max_force_error", "samples"})
        rows.back() += number(key);
    }
  auto csv = lines_of(printed(box, followed_by(range, {"--csv"})));
  EXPECT_TRUE(csv.front().starts_with("material,mass_kg,")) << csv.front();
  EXPECT_EQ(std::vector(csv.begin() + 1, csv.end()), rows);
  const auto table = lines_of(printed(box, range));
  ASSERT_EQ(table.size(), 24u);
  EXPECT_EQ(table[11], "* out of the material's range, 0.1 to 2 m/s");
  for (std::size_t i = 0; i < 7; ++i) {
    const double speed = 0.05 * std::pow(2.0, static_cast<double>(i));
    const Json& one = json.at(i);
    const double duration = contact_duration(design.material.contact, 0.01, speed);
    EXPECT_TRUE(relatively_within(one.at("speed_m_per_s").get<double>(), speed, 1e-12));
    EXPECT_EQ(one.at("in_range").get<bool>(), i > 0 && i < 6);
    const Json& motions = one.at("motions");
    ASSERT_EQ(motions.size(), 4u);
    EXPECT_TRUE(relatively_within(motions[0].at("contact_duration_s").get<double>(), duration, 1e-9));
    const auto spline = impact_on_spline(design.spline, 0.01, one.at("speed_m_per_s").get<double>());
    EXPECT_TRUE(within(motions[1].at("contact_duration_error").get<double>(),
                       spline.contact_duration_s / duration - 1, 1e-9));
    const auto table_of_spline = segment_table(design.spline);
    EXPECT_EQ(motions[1].at("max_force_n").get<double>(),
              force<double>(std::span(table_of_spline), spline.max_compression_m));
    const auto simulated =
        simulate_impact(segment_table(design.spline), 0.01, one.at("speed_m_per_s").get<double>(), 96000);
    EXPECT_EQ(motions[3].at("max_compression_m").get<double>(), simulated.max_compression_m);
    EXPECT_EQ(motions[3].at("max_force_n").get<double>(), simulated.max_force_n);
    const double compression = motions[0].at("max_compression_m").get<double>();
    EXPECT_TRUE(relatively_within(motions[0].at("max_force_n").get<double>(),
                                  design.material.contact.force(compression), 1e-12));
    std::string text = table[4 + i];
    const std::size_t star = text.find('*');
    EXPECT_EQ(star == std::string::npos, i > 0 && i < 6) << text;
    if (star != std::string::npos) text[star] = ' ';
    std::istringstream row(text);
    double shown_speed = NAN, duration_us = NAN, compression_um = NAN, duration_error = NAN, compression_error = NAN,
           at_44 = NAN, at_96 = NAN;
    row >> shown_speed >> duration_us >> compression_um >> duration_error >> compression_error >> at_44 >> at_96;
    EXPECT_TRUE(relatively_within(shown_speed, speed, 1e-4));
    EXPECT_TRUE(within(duration_us, 1e6 * duration, 6e-4));
    EXPECT_TRUE(within(duration_error, 100 * motions[1].at("contact_duration_error").get<double>(), 6e-4));
    EXPECT_TRUE(within(compression_error, 100 * motions[1].at("max_compression_error").get<double>(), 6e-4));
    EXPECT_TRUE(within(at_44, 100 * motions[2].at("contact_duration_error").get<double>(), 6e-4));
    EXPECT_TRUE(within(at_96, 100 * motions[3].at("contact_duration_error").get<double>(), 6e-4));
  }
}

TEST(Impact, TakesTheLargestSpeedAndFourRatesByDefault) {
  const Sandbox box;
  write_file(box / "probe.json", material(16));
  EXPECT_EQ(printed(box, {"impact", "probe.json"}),
            printed(box, {"impact", "probe.json", "--speed", "2", "--rate", "44100", "--rate", "88200", "--rate",
                          "176400", "--rate", "352800"}));
  EXPECT_EQ(printed(box, {"impact", "probe.json", "mb1"}),
            printed(box, {"impact", "probe.json"}) + printed(box, {"impact", "mb1"}));
}

/// A row of --trace.
struct TraceRow {
  std::string material, model;
  double speed, rate, time_s, compression_m, force_n;
};

std::vector<TraceRow> trace_rows(const std::string& csv) {
  const auto lines = lines_of(csv);
  EXPECT_EQ(lines.at(0), "# Written by contactspline " VERSION);
  EXPECT_EQ(lines.at(1), "material,speed_m_per_s,model,sample_rate_hz,time_s,compression_m,force_n");
  std::vector<TraceRow> rows;
  for (std::size_t i = 2; i < lines.size(); ++i) {
    std::istringstream line(lines[i]);
    std::array<std::string, 7> cells;
    for (std::string& cell : cells) std::getline(line, cell, ',');
    const auto number = [&](std::size_t at) { return std::stod(cells[at]); };
    rows.push_back({cells[0], cells[2], number(1), number(3), number(4), number(5), number(6)});
  }
  return rows;
}

// A linear spring, whose spline is exact: a sine, of the law and of the spline. The simulation's force is constant
// over a sample and turns the mass around.
TEST(ImpactTrace, IsForceAndCompressionOverTime) {
  const Sandbox box;
  const double mass = 0.01, k = 1e6, w = std::sqrt(k / mass);
  for (const std::string name : {"spring", "other"})
    write_file(box / (name + ".json"), R"({"name": ")" + name + R"(",
      "contact": {"stiffness_n_per_m_alpha": 1e6, "exponent": 1},
      "impact": {"mass_kg": 0.01, "max_speed_m_per_s": 2, "min_speed_m_per_s": 0.1},
      "spline": {"knots": "uniform", "segments": 1}})");
  const Words words{"impact", "spring.json", "other.json", "--speed", "1.5",   "--speed", "0.5",
                    "--rate", "44100",       "--rate",     "96000",   "--csv", "--trace", "a.csv"};
  const auto summary = lines_of(printed(box, words));
  const auto rows = trace_rows(read_file(box / "a.csv"));
  std::map<std::string, double> impulses, sizes;
  for (const TraceRow& row : rows) {
    const std::string motion = fmt::format("{},{},{},{}", row.material, row.speed, row.model, row.rate);
    ++sizes[motion];
    if (row.model == "simulated") impulses[motion] += row.force_n / row.rate;
    if (row.model == "simulated") continue;
    EXPECT_TRUE(within(row.compression_m, row.speed / w * std::sin(w * row.time_s), 1e-10 * row.speed / w));
    EXPECT_TRUE(within(row.force_n, k * row.compression_m, 1e-10 * k * row.speed / w));
  }
  EXPECT_EQ(sizes.size(), 16u);  // two materials, two speeds; exact, spline, two rates
  EXPECT_EQ(sizes.at("spring,1.5,exact,0"), 257);
  EXPECT_EQ(sizes.at("other,0.5,spline,0"), 257);
  ASSERT_EQ(impulses.size(), 8u);
  for (const auto& [motion, impulse] : impulses) {
    const double speed = std::stod(motion.substr(motion.find(',') + 1));
    EXPECT_TRUE(relatively_within(impulse, 2 * mass * speed, 1e-12)) << motion;
    EXPECT_GT(sizes.at(motion), std::floor(std::numbers::pi / w * 44100)) << motion;
  }
  EXPECT_EQ(summary.size(), 17u);
}

TEST(ImpactTrace, ReplacesNoFileOfAnother) {
  const Sandbox box;
  write_file(box / "a.csv", "mine");
  expect_refused(run({.arguments = {"impact", "mb1", "--trace", "a.csv"}, .folder = box.path()}),
                 "a.csv: file: exists", "--force");
  EXPECT_EQ(read_file(box / "a.csv"), "mine");
  EXPECT_NE(printed(box, {"impact", "mb1", "--trace", "a.csv", "--force"}).find("\ntrace: a.csv\n"),
            std::string::npos);
  printed(box, {"impact", "felt_c4", "--trace", "a.csv"});  // its own
  EXPECT_EQ(trace_rows(read_file(box / "a.csv")).front().material, "felt_c4");
}

TEST(ImpactTrace, IsRefusedWhereItWouldBeEndless) {
  const Sandbox box;
  expect_refused(run({.arguments = {"impact", "felt_c4", "--rate", "1e8", "--speed", "1e-6", "--trace", "a.csv"},
                      .folder = box.path()}),
                 "felt_c4: --rate: at 1e-06 m/s and 100000000 Hz the contact lasts", "allowed: at most 100000");
  expect_refused(run({.arguments = {"impact", "felt_c4", "--trace", "a.txt"}, .folder = box.path()}),
                 "a.txt: --trace: its ending is not that of a table", "allowed: .csv");
  EXPECT_FALSE(fs::exists(box / "a.csv"));
}

}  // namespace
}  // namespace contactspline::testing
