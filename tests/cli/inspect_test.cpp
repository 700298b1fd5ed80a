// SPDX-License-Identifier: MIT
// contactspline inspect, list, show and impact: the tables are the library's numbers, the figure can be drawn.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "generator/contact/barrier_impact.hpp"
#include "generator/emit/emitter.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/spline/simulated_impact.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/compare.hpp"
#include "svg.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;

std::string material(int segments, const std::string& description = "a probe") {
  return fmt::format(R"({{"name": "probe", "description": "{}",
    "contact": {{"stiffness_n_per_m_alpha": 1e9, "exponent": 1.5}},
    "impact": {{"mass_kg": 0.01, "max_speed_m_per_s": 2, "min_speed_m_per_s": 0.1}},
    "spline": {{"knots": "uniform", "segments": {}}}}})",
                     description, segments);
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// The first number after each place where `label` stands in a line.
double number_after(const std::string& text, const std::string& label) {
  const auto at = text.find(label);
  if (at == std::string::npos) throw std::runtime_error("no " + label + " in\n" + text);
  return std::stod(text.substr(at + label.size()));
}

std::string printed(const Sandbox& box, const Words& arguments) {
  return succeed({.arguments = arguments, .folder = box.path()});
}

class Inspect : public ::testing::TestWithParam<int> {};

TEST_P(Inspect, PrintsWhatGenerateWrites) {
  const Sandbox box;
  write_file(box / "probe.json", material(GetParam()));
  const Json json = Json::parse(printed(box, {"generate", "probe.json", "--emit", "json", "-o", "-"}));
  const std::string text = printed(box, {"inspect", "probe.json"});
  const auto lines = lines_of(text);
  const auto segments = static_cast<std::size_t>(GetParam());
  ASSERT_GE(lines.size(), segments + 5);
  EXPECT_EQ(lines[0], "probe: a probe");
  EXPECT_NE(lines[1].find(fmt::format("a = 1.5, {} uniform segments", segments)), std::string::npos) << lines[1];

  std::size_t wrong = 0;
  for (std::size_t j = 0; j < segments; ++j) {
    std::istringstream row(lines[5 + j]);
    std::size_t index = 0;
    double knot = NAN, energy = NAN, force = NAN, half_curvature = NAN;
    row >> index >> knot >> energy >> force >> half_curvature;
    wrong += !(index == j + 1 && row.eof() && relatively_within(knot, json["knots_m"][j], 1e-9) &&
               relatively_within(energy, json["energy_j"][j], 1e-9) &&
               relatively_within(force, json["force_n"][j], 1e-9) &&
               relatively_within(half_curvature, json["half_curvature_n_per_m"][j], 1e-9));
  }
  EXPECT_EQ(wrong, 0u) << "rows";

  const auto agrees = [&](const std::string& label, const std::string& key) {
    const double expected = 100 * json.at("quality").at(key).get<double>();  // written as 0 below 1e-12
    EXPECT_TRUE(within(number_after(text, label), expected, 2e-3 * expected + 1.01e-10)) << label;
  };
  agrees("force, of the largest force", "worst_force_error");
  agrees("energy, of the largest energy", "worst_energy_error");
  agrees("contact duration", "worst_contact_duration_error");
  agrees("max compression", "worst_max_compression_error");
}

TEST_P(Inspect, DrawsAFigure) {
  const Sandbox box;
  write_file(box / "probe.json", material(GetParam()));
  const std::string report = printed(box, {"inspect", "probe.json", "--figure", "figures/probe.svg"});
  EXPECT_TRUE(report.ends_with("\nfigure: figures/probe.svg\n"));
  expect_drawn(box / "figures/probe.svg", 10);
  EXPECT_NE(read_svg(box / "figures/probe.svg").text.find(fmt::format("a probe: {} segments", GetParam())),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Segments, Inspect, ::testing::Values(1, 2, 3, 64, 1024, 65536));

TEST(InspectFigure, ShowsADescriptionAsItIs) {
  for (const std::string description :
       {"a < b & c > d ]]>", "don't", "it''s 'x'", "\xc3\xa4\xe2\x82\xac", "{/Symbol a}_{b}^2 @x %s", "-->",
        "$0 `date`", "&#x41; &#x1; &amp; &", "TITLE-OF-THE-FIGURE"}) {
    const Sandbox box;
    write_file(box / "probe.json", material(4, description));
    printed(box, {"inspect", "probe.json", "--figure", "a.svg"});
    EXPECT_NE(read_svg(box / "a.svg").text.find(description + ": 4 segments"), std::string::npos) << description;
  }
}

TEST(InspectFigure, AlignsItsPanels) {
  const Sandbox box;
  for (const std::string name : {"felt_c4", "felt_synthetic", "mb1"}) {
    printed(box, {"inspect", name, "--figure", name + ".svg"});
    EXPECT_EQ(columns_of(box / (name + ".svg")).size(), 2u) << name;
  }
  printed(box, {"inspect", "felt_c4", "--compare", "--figure", "families.svg"});
  EXPECT_EQ(columns_of(box / "families.svg").size(), 1u);
  printed(box, {"render", "mass-barrier", "--duration", "1", "-o", "bounce.wav"});
  EXPECT_EQ(columns_of(box / "bounce.svg").size(), 1u);
}

// The members lie below the other curves, the measured samples above: the names stand in the order of drawing.
TEST(InspectFigure, ShowsTheFamilyOfALiveExponentAndTheMeasuredSamples) {
  const Sandbox box;
  const auto names = [&](const std::string& material) {
    const std::string file = material + ".svg";
    printed(box, {"inspect", material, "--figure", file});
    expect_drawn(box / file, 11);
    return read_svg(box / file).text;
  };
  const std::string live = names("felt_live"), measured = names("felt_synthetic");
  EXPECT_LT(live.rfind("exponents 1.2 to 3.2"), live.rfind("power law"));
  ASSERT_NE(measured.rfind("measured"), std::string::npos);
  EXPECT_GT(measured.rfind("measured"), measured.rfind("smoothed curve"));
}

TEST(InspectFigure, OfTheDocsCutsNoLabelOff) {
  std::size_t figures = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(SOURCE_FOLDER) / "docs/figures")) {
    if (entry.path().extension() != ".svg" || entry.path().stem().string().ends_with("_blocks")) continue;
    expect_labels_whole(entry.path());
    ++figures;
  }
  EXPECT_GE(figures, 4u);
}

TEST(InspectFigure, DoesNotDependOnTheUserOrTheLocale) {
  const Sandbox box;
  const std::string folder = "it's \"a\" folder";
  fs::create_directories(box / folder);
  write_file(box / folder / ".gnuplot", "set logscale xy\nset title 'mine'\nset decimalsign ','\n");
  run({.arguments = {"-i", "de_DE", "-f", "UTF-8", "./de_DE.UTF-8"}, .folder = box.path(), .program = "localedef"});
  printed(box, {"inspect", "mb1", "--figure", "a.svg"});
  succeed({.arguments = {"inspect", "mb1", "--figure", "b.svg"},
           .folder = box.path(),
           .environment = {{"HOME", (box / folder).string()},
                           {"TMPDIR", (box / folder).string()},
                           {"LOCPATH", box.path().string()},
                           {"LC_ALL", "de_DE.UTF-8"}}});
  EXPECT_TRUE(read_file(box / "a.svg") == read_file(box / "b.svg"));
}

TEST(InspectFigure, IsUntouchedWhereNothingChanged) {
  const Sandbox box;
  printed(box, {"inspect", "mb1", "--figure", "a.svg"});
  const auto before = box.listing();
  printed(box, {"inspect", "mb1", "--figure", "a.svg"});
  EXPECT_TRUE(box.listing() == before);
}

TEST(InspectFigure, IsRefusedWhereItCannotBeDrawn) {
  const Sandbox box;
  fs::create_directories(box / "bin");
  write_file(box / "probe.json", material(1024));  // more than a pipe holds
  const auto refused = [&](const std::string& says) {
    const auto before = box.listing();
    const auto outcome = run({.arguments = {"inspect", "probe.json", "--figure", "a.svg"},
                              .folder = box.path(),
                              .environment = {{"PATH", (box / "bin").string()}}});
    expect_refused(outcome, "figure: ", says);
    EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  };
  const auto fake_gnuplot = [&](const std::string& script) {
    write_file(box / "bin/gnuplot", "#!/bin/sh\n" + script + "\n");
    fs::permissions(box / "bin/gnuplot", fs::perms(0755));
  };
  refused("gnuplot is not installed; install the package gnuplot-nox");
  fake_gnuplot("exit 1");
  refused("gnuplot failed");
  fake_gnuplot("kill -9 $$");
  refused("gnuplot failed");
  fake_gnuplot("exec /bin/cat >/dev/null");
  refused("gnuplot drew nothing");
  fake_gnuplot("/bin/cat >/dev/null; echo '<svg>'");
  refused("gnuplot drew nothing");
}

TEST(Inspect, WithoutAnImpactHasNoImpactErrors) {
  const Sandbox box;
  write_file(box / "bare.json", R"({"name": "bare", "contact": {"stiffness_n_per_m_alpha": 1e9, "exponent": 1.5},
                                    "spline": {"knots": "uniform", "segments": 4, "max_compression_m": 1e-3}})");
  const std::string table = printed(box, {"inspect", "bare.json"});
  EXPECT_TRUE(table.starts_with("bare\nV(y) = "));
  EXPECT_NE(table.find("force, of the largest force"), std::string::npos);
  EXPECT_EQ(table.find("contact duration"), std::string::npos);
}

// 1200 samples of a felt without noise, in a file beside the material: named, drawn, and told what law it is near.
TEST(Inspect, OfAMeasuredCurveShowsIt) {
  const Sandbox box;
  std::string curve = "compression_mm,force_n\n";
  for (int i = 1; i <= 1200; ++i) curve += fmt::format("{},{}\n", 1e-3 * i, 4e8 * std::pow(1e-6 * i, 2.3));
  fs::create_directories(box / "in");
  write_file(box / "in/felt.csv", curve);
  write_file(box / "in/probe.json", R"({"name": "probe",
    "contact": {"curve": {"file": "felt.csv", "shape": "hardening"}, "loss_s_per_m": 0.25},
    "spline": {"knots": "uniform", "segments": 16, "max_compression_m": 1e-3}})");
  const std::string text = printed(box, {"inspect", "in/probe.json", "--figure", "a.svg"});
  EXPECT_NE(
      text.find(
          "F(y) smoothed from 1200 samples of felt.csv up to 0.0012 m, 16 uniform segments over 0 to 0.001 m\n"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("loss 0.25 s/m\n"), std::string::npos);
  EXPECT_TRUE(relatively_within(number_after(text, "nearest power law k = "), 4e8, 1e-3));
  EXPECT_TRUE(within(number_after(text, "N/m^a, a = "), 2.3, 1e-3));
  EXPECT_TRUE(within(number_after(text, "scatter "), 0, 0.05));
  expect_drawn(box / "a.svg", 11);
  const Svg figure = read_svg(box / "a.svg");
  EXPECT_NE(figure.text.find("measured"), std::string::npos);
  EXPECT_NE(figure.text.find("smoothed curve"), std::string::npos);
  // Samples beyond the spline are left out; each of the 1000 others is drawn by a line of its own.
  printed(box, {"inspect", "felt_c4", "--figure", "b.svg"});
  EXPECT_GE(read_file(box / "a.svg").size(), read_file(box / "b.svg").size() + 1000 * 30);
}

TEST(Inspect, OfASumNamesItsTerms) {
  const Sandbox box;
  EXPECT_NE(printed(box, {"inspect", "felt_over_wood"})
                .find("F(y) = 4500000000 y^2.5 + 103000000 (y - 0.0005)^1.5, in parallel, 64 uniform segments"),
            std::string::npos);
}

// Each row is what `generate` makes of that family.
TEST(InspectFamilies, StandSideBySide) {
  const Sandbox box;
  write_file(box / "probe.json", material(16));
  const auto lines = lines_of(printed(box, {"inspect", "probe.json", "--compare", "--figure", "families.svg"}));
  ASSERT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines[0], "probe");
  EXPECT_EQ(lines[9], "figure: families.svg");
  std::size_t line = 4;
  for (const std::string family : {"uniform", "graded", "optimal", "spectrum"}) {
    const bool is_spectrum = family == "spectrum";
    std::string text = material(16);
    text.replace(text.find("uniform"), 7, is_spectrum ? R"(optimal", "minimise": "spectrum)" : family);
    write_file(box / "family.json", text);
    const Json json = Json::parse(printed(box, {"generate", "family.json", "--emit", "json", "-o", "-"}));
    std::istringstream row(lines[line++]);
    std::string name, percent;
    int segments = 0, for_one_percent = 0, for_tenth = 0;
    double duration = NAN, compression = NAN, force = NAN, worst_db = NAN, mean_db = NAN;
    row >> name >> segments >> duration >> percent >> compression >> percent >> force >> percent >> worst_db >>
        percent >> mean_db >> percent;
    if (!is_spectrum) row >> for_one_percent >> for_tenth;
    EXPECT_TRUE(row && name == family && segments == 16) << lines[line - 1];
    const auto expect = [&](double shown, const char* key) {
      EXPECT_TRUE(relatively_within(shown, 100 * json.at("quality").at(key).get<double>(), 2e-3)) << family << key;
    };
    expect(duration, "worst_contact_duration_error");
    expect(compression, "worst_max_compression_error");
    expect(force, "worst_force_error");
    expect(100 * worst_db, "worst_spectrum_error_db");
    expect(100 * mean_db, "mean_spectrum_error_db");
    if (is_spectrum) continue;
    for (const auto& [tolerance, shown] : {std::pair{"0.01", for_one_percent}, std::pair{"0.001", for_tenth}}) {
      std::string by_tolerance = text;
      by_tolerance.replace(by_tolerance.find(R"("segments": 16)"), 14, std::string(R"("tolerance": )") + tolerance);
      write_file(box / "family.json", by_tolerance);
      const Json found = Json::parse(printed(box, {"generate", "family.json", "--emit", "json", "-o", "-"}));
      EXPECT_EQ(static_cast<int>(found.at("knots_m").size()), shown) << family << " " << tolerance;
    }
  }
  expect_drawn(box / "families.svg", 12);
  EXPECT_NE(read_svg(box / "families.svg").text.find("optimal, 16 segments"), std::string::npos);
}

// The numbers of the table, in SI units.
TEST(InspectFamilies, PrintJson) {
  const Sandbox box;
  write_file(box / "probe.json", material(16));
  const Json json = Json::parse(printed(box, {"inspect", "probe.json", "--compare", "--json"}));
  const auto lines = lines_of(printed(box, {"inspect", "probe.json", "--compare"}));
  EXPECT_EQ(json.at("name"), "probe");
  EXPECT_EQ(json.at("max_speed_m_per_s"), 2);
  EXPECT_EQ(json.at("min_speed_m_per_s"), 0.1);
  EXPECT_EQ(json.at("mass_kg"), 0.01);
  ASSERT_EQ(json.at("families").size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const Json& family = json["families"][i];
    const Json& errors = family.at("errors");
    const auto or_dash = [&](const char* key) {
      return family.at(key).is_null() ? "-" : std::to_string(family.at(key).get<int>());
    };
    std::istringstream row(lines.at(4 + i));
    std::string name, unit, for_1, for_01;
    std::size_t segments = 0;
    double duration = NAN, compression = NAN, force = NAN, worst_db = NAN, mean_db = NAN;
    row >> name >> segments >> duration >> unit >> compression >> unit >> force >> unit >> worst_db >> unit >>
        mean_db >> unit >> for_1 >> for_01;
    EXPECT_EQ(family.at("knots"), name);
    EXPECT_EQ(family.at("segments"), segments);
    EXPECT_EQ(or_dash("segments_for_0.01"), for_1);
    EXPECT_EQ(or_dash("segments_for_0.001"), for_01);
    EXPECT_TRUE(relatively_within(duration, 100 * errors.at("contact_duration").get<double>(), 1e-3));
    EXPECT_TRUE(relatively_within(compression, 100 * errors.at("max_compression").get<double>(), 1e-3));
    EXPECT_TRUE(relatively_within(force, 100 * errors.at("force").at("worst").get<double>(), 1e-3));
    EXPECT_TRUE(relatively_within(worst_db, errors.at("spectrum_db").at("worst").get<double>(), 1e-3));
    EXPECT_TRUE(relatively_within(mean_db, errors.at("spectrum_db").at("mean").get<double>(), 1e-3));
  }
}

// The figures of the family are those emitted with it.
TEST(Inspect, ShowsTheFiguresOfALiveExponent) {
  const Sandbox box;
  const std::string text = printed(box, {"inspect", "felt_live"});
  const auto at = text.find("live exponent 1.2 to 3.2, 21 members");
  ASSERT_NE(at, std::string::npos) << text;
  const Json live = Json::parse(printed(box, {"generate", "felt_live", "--emit", "json", "-o", "-"})).at("live");
  const auto expect = [&](const char* label, double emitted) {
    EXPECT_TRUE(relatively_within(number_after(text.substr(at), label), emitted, 1e-3)) << label;
  };
  expect("over 0 to", live.at("max_compression_m").get<double>());
  expect("contact duration", 100 * live.at("quality").at("worst_contact_duration_error").get<double>());
  expect("max compression", 100 * live.at("quality").at("worst_max_compression_error").get<double>());
}

TEST(InspectResonator, CountsTheModesThatAreEmitted) {
  const Sandbox box;
  for (const std::string rate : {"44100", "96000"}) {
    const Json modes =
        Json::parse(printed(box, {"generate", "string_c4", "--rate", rate, "--emit", "json", "-o", "-"}));
    const auto w = modes.at("angular_frequency_rad_per_s").get<std::vector<double>>();
    const std::string text = printed(box, {"inspect", "string_c4", "--rate", rate});
    EXPECT_TRUE(text.starts_with("string_c4: ")) << text;
    EXPECT_NE(text.find(std::to_string(w.size()) + " modes from "), std::string::npos) << text;
  }
  EXPECT_EQ(printed(box, {"inspect", "string_c4"}), printed(box, {"inspect", "string_c4", "--rate", "44100"}));
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// Speeds from 0.1 to 6 m/s on two axes, compressions from 0.104 to 1.085 mm on the third.
TEST(InspectFamilies, LabelEveryAxisOfTheFigure) {
  const Sandbox box;
  printed(box, {"inspect", "felt_c4", "--compare", "--figure", "families.svg"});
  const std::string text = read_svg(box / "families.svg").text;
  const std::string third = text.substr(text.rfind("max compression error"));
  EXPECT_EQ(count_of(text, "0.2"), 3u);
  EXPECT_EQ(count_of(text, "0.5"), 3u);
  for (const auto label : {"0.2", "0.5"}) EXPECT_NE(third.find(label), std::string::npos) << label;
}

TEST(InspectFamilies, LabelTheEndsOfAnAxisTooShortForMore) {
  const Sandbox box;
  std::string text = material(4);
  text.replace(text.find("\"max_speed_m_per_s\": 2, \"min_speed_m_per_s\": 0.1"), 47,
               R"("max_speed_m_per_s": 4.9, "min_speed_m_per_s": 2.1)");
  write_file(box / "probe.json", text);
  printed(box, {"inspect", "probe.json", "--compare", "--figure", "families.svg"});
  const std::string labels = read_svg(box / "families.svg").text;
  EXPECT_EQ(count_of(labels, "2.1"), 2u);
  EXPECT_EQ(count_of(labels, "4.9"), 2u);
}

TEST(InspectFamilies, NeedARangeOfImpacts) {
  const Sandbox box;
  write_file(box / "bare.json", R"({"name": "bare", "contact": {"stiffness_n_per_m_alpha": 1e9, "exponent": 1.5},
    "spline": {"knots": "uniform", "segments": 4, "max_compression_m": 1e-3}})");
  const auto before = box.listing();
  expect_refused(run({.arguments = {"inspect", "bare.json", "--compare", "--figure", "a.svg"}, .folder = box.path()}),
                 "bare.json: impact: missing", "allowed: an object, because --compare measures impacts");
  EXPECT_TRUE(box.listing() == before);
}

TEST(Materials, ListsEveryOneThatShips) {
  const Sandbox box;
  const auto lines = lines_of(printed(box, {"list", "materials"}));
  std::vector<std::string> names;
  for (const auto& line : lines) names.push_back(line.substr(0, line.find(' ')));
  EXPECT_EQ(names, (std::vector<std::string>{"name", "felt_c2", "felt_c4", "felt_c7", "felt_live", "felt_over_wood",
                                             "felt_synthetic", "mb1", "rubber_on_wood", "steel_ball_on_plate",
                                             "steel_on_steel"}));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Json json = Json::parse(printed(box, {"generate", names[i], "--emit", "json", "-o", "-"}));
    std::istringstream row(lines[i]);
    std::string name, stiffness, exponent, percent;
    double error = NAN;
    std::size_t segments = 0;
    row >> name >> stiffness >> exponent >> segments >> error >> percent;
    if (json.contains("law")) {
      EXPECT_EQ(stiffness, names[i] == "felt_over_wood" ? "sum" : "measured");
      EXPECT_EQ(exponent, "-");
    } else {
      EXPECT_TRUE(relatively_within(std::stod(stiffness), json.at("stiffness_n_per_m_alpha"), 5e-4));
      EXPECT_TRUE(relatively_within(std::stod(exponent), json.at("exponent"), 5e-4));
    }
    EXPECT_EQ(segments, json.at("knots_m").size());
    EXPECT_TRUE(relatively_within(error, 100 * json["quality"]["worst_contact_duration_error"].get<double>(), 0.05));
    EXPECT_EQ(percent, "%");
    EXPECT_TRUE(lines[i].ends_with("  " + json.at("title").get<std::string>()));
  }
}

// The numbers of the emitted JSON, and of the resonator's table.
TEST(Inspect, PrintsJson) {
  const Sandbox box;
  for (const std::string name : {"felt_c4", "felt_over_wood", "felt_synthetic"}) {
    const Json json = Json::parse(printed(box, {"inspect", name, "--json"}));
    const Json emitted = Json::parse(printed(box, {"generate", name, "--emit", "json", "-o", "-"}));
    ASSERT_EQ(json.at("segments").size(), emitted.at("knots_m").size());
    for (std::size_t i = 0; i < json.at("segments").size(); ++i) {
      const Json& segment = json["segments"][i];
      EXPECT_EQ(segment.at("knot_m"), emitted["knots_m"][i]);
      EXPECT_EQ(segment.at("energy_j"), emitted["energy_j"][i]);
      EXPECT_EQ(segment.at("force_n"), emitted["force_n"][i]);
      EXPECT_EQ(segment.at("half_curvature_n_per_m"), emitted["half_curvature_n_per_m"][i]);
    }
    EXPECT_EQ(json.at("loss_s_per_m"), emitted.at("loss_s_per_m"));
    EXPECT_TRUE(relatively_within(json.at("errors").at("contact_duration").get<double>(),
                                  emitted.at("quality").at("worst_contact_duration_error").get<double>(), 0.01));
    EXPECT_TRUE(relatively_within(json["errors"].at("spectrum_db").at("worst").get<double>(),
                                  emitted["quality"].at("worst_spectrum_error_db").get<double>(), 0.01));
  }
  const Json string = Json::parse(printed(box, {"inspect", "string_c4", "--rate", "48000", "--json"}));
  const std::string table = printed(box, {"inspect", "string_c4", "--rate", "48000"});
  EXPECT_NE(table.find(std::to_string(string.at("modes").size()) + " modes from "), std::string::npos) << table;
  EXPECT_TRUE(relatively_within(string["modes"][0].at("frequency_hz").get<double>(),
                                number_after(table, " modes from "), 1e-5));
}

TEST(Inspect, SaysWhatAToleranceMeans) {
  const Sandbox box;
  std::string text = material(16);
  const auto at = text.find("\"uniform\", \"segments\": 16");
  ASSERT_NE(at, std::string::npos);
  write_file(box / "probe.json", text.replace(at, 25, R"("graded", "tolerance": 0.1)"));
  EXPECT_NE(printed(box, {"inspect", "probe.json"})
                .find("\ntolerance 0.1, relative: at most 10 % error of the contact duration\n"),
            std::string::npos);
}

// Where a place is on a body of two dimensions.
TEST(InspectInstrument, ShowsBothCoordinatesOfAPlace) {
  const Sandbox box;
  write_file(box / "probe.json", R"({
    "name": "probe",
    "bodies": [
      { "name": "head", "resonator": "drum_head", "max_modes": 12 },
      { "name": "lid", "max_modes": 12,
        "plate": { "length_m": 0.4, "width_m": 0.3, "thickness_m": 0.003, "density_kg_m3": 450,
                   "youngs_modulus_pa": 1e10, "poisson_ratio": 0.37, "constant_loss_per_s": 8,
                   "quadratic_loss_m2_per_s": 0.02 } } ],
    "places": [ { "name": "spot", "body": "head", "position_m": 0.05, "angle_rad": 0.4 },
                { "name": "other_side", "body": "head", "position_m": -0.05, "angle_rad": 0.4 },
                { "name": "line", "body": "lid", "positions_m": [0.1, 0.2], "across_m": 0.13 } ],
    "outputs": [ { "name": "spot", "displacement_m": "spot" } ]
  })");
  const std::string table = printed(box, {"inspect", "probe.json"});
  for (const std::string line :
       {"  head                     membrane  12 modes", "  lid                      plate     12 modes",
        "  spot                               head: 0.05 m, 0.4 rad\n",
        "  other_side                         head: -0.05 m, 0.4 rad\n",
        "  line                               lid: 0.1 to 0.2 m, 0.13 m across, 2 points\n"})
    EXPECT_NE(table.find("\n" + line), std::string::npos) << line << " is not in\n" << table;
}

// Every part of an instrument, in the table, in the drawing and as JSON.
TEST(InspectInstrument, ShowsAllItsParts) {
  const Sandbox box;
  const std::string table = printed(box, {"inspect", "prepared_piano", "--figure", "a.svg"});
  EXPECT_TRUE(table.starts_with("prepared_piano: two strings with a rattling bolt and a screw between them\n"));
  for (const std::string line :
       {"  second                   string    120 modes from 53.1", "  bolt                     mass      0.005 kg",
        "  under_bolt                         first: 0.71 m",
        "  bolt_below               contact   under_bolt and bolt, gap 0.00015 m, steel_on_steel times 1",
        "  thread_first             spring    first_at_screw and screw, gap 0 m, 40000 N/m, 0.05 N s/m",
        "  screw_stiffness_n_per_m            100 to 1e+07, at the beginning 40000",
        "  hammer_speed_m_per_s     strike", "  bridge_end_force_n                 N", "figure: a.svg"})
    EXPECT_NE(table.find("\n" + line), std::string::npos) << line << " is not in\n" << table;
  const std::string text = read_svg(box / "a.svg").text;
  for (const std::string name :
       {"first, string", "second, string", "hammer, mass", "bolt, mass", "screw, mass", "first_struck",
        "second_struck", "under_bolt", "first_at_screw", "second_at_screw", "felt_first", "felt_second", "bolt_above",
        "bolt_below", "thread_first", "thread_second", "two strings with a rattling bolt"})
    EXPECT_NE(text.find(name), std::string::npos) << name;
  const auto json = nlohmann::json::parse(printed(box, {"inspect", "prepared_piano", "--json", "--rate", "8000"}));
  EXPECT_EQ(json.at("bodies").size(), 5u);
  EXPECT_EQ(json.at("body_ends").back(), json.at("mass_kg").size());
  EXPECT_EQ(json.at("max_frequency_hz"), 4000);
  EXPECT_EQ(json.at("controls")[3].at("name"), "screw_stiffness_n_per_m");
  expect_refused(run({.arguments = {"inspect", "tanpura", "--compare"}, .folder = box.path()}),
                 "tanpura: --compare: cannot be used with an instrument", "allowed: with a material");
}

TEST(List, HasATableForEachKind) {
  const std::string all = succeed({.arguments = {"list"}});
  for (const auto& [kind, folder] :
       std::vector<std::pair<std::string, Shipped>>{{"materials", Shipped::kMaterials},
                                                    {"resonators", Shipped::kResonators},
                                                    {"keyboards", Shipped::kKeyboards},
                                                    {"instruments", Shipped::kInstruments},
                                                    {"scores", Shipped::kScores}}) {
    const std::string table = succeed({.arguments = {"list", kind}});
    EXPECT_NE(all.find(fmt::format("{}\n\n{}", kind, table)), std::string::npos) << kind;
    std::vector<std::string> names;
    for (const auto& line : lines_of(table)) names.push_back(line.substr(0, line.find(' ')));
    EXPECT_EQ(names.front(), "name");
    EXPECT_EQ(std::vector(names.begin() + 1, names.end()), shipped_names(folder));
  }
}

TEST(List, PrintsTheLowestModeOfAResonator) {
  for (const auto& line : lines_of(succeed({.arguments = {"list", "resonators"}}))) {
    std::istringstream row(line);
    std::string name, body;
    double frequency = NAN;
    if (!(row >> name >> body >> frequency)) continue;  // the heading
    const Json modes = Json::parse(run({.arguments = {"generate", name, "--emit", "json", "-o", "-"}}).out);
    const double lowest = modes.at("angular_frequency_rad_per_s").at(0).get<double>() / (2 * std::numbers::pi);
    EXPECT_TRUE(relatively_within(frequency, lowest, 1e-4)) << line;
  }
}

TEST(Show, PrintsEveryFileThatShips) {
  for (const Shipped folder : {Shipped::kMaterials, Shipped::kResonators, Shipped::kKeyboards, Shipped::kScores}) {
    for (const EmbeddedFile& file : embedded_files(folder))
      EXPECT_TRUE(succeed({.arguments = {"show", std::string(file.name)}}) == file.content) << file.name;
    for (const std::string& name : shipped_names(folder))
      EXPECT_TRUE(succeed({.arguments = {"show", name}}) ==
                  find_embedded(folder, name + (name == "bach_prelude" ? ".mid" : ".json"))->content)
          << name;
  }
}

// A name stands for one thing only.
TEST(Show, FindsNoNameTwice) {
  std::map<std::string, int> names;
  for (const Shipped folder : {Shipped::kMaterials, Shipped::kResonators, Shipped::kKeyboards, Shipped::kScores})
    for (const std::string& name : shipped_names(folder)) EXPECT_EQ(++names[name], 1) << name;
}

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
TEST(Impact, SaysWhereASpeedIsOutOfTheRange) {
  const Sandbox box;
  write_file(box / "probe.json", material(16));
  const auto lines_at = [&](const std::string& speed) {
    return lines_of(printed(box, {"impact", "probe.json", "--rate", "44100", "--speed", speed}));
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
  ASSERT_EQ(table.size(), 20u);
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
    std::istringstream row(table[2 + i]);
    double shown_speed = NAN, duration_us = NAN, compression_um = NAN, duration_error = NAN, compression_error = NAN,
           at_44 = NAN, at_96 = NAN;
    row >> shown_speed >> duration_us >> compression_um >> duration_error >> compression_error >> at_44 >> at_96;
    EXPECT_TRUE(relatively_within(shown_speed, speed, 1e-4));
    EXPECT_TRUE(within(duration_us, 1e6 * duration, 6e-4));
    EXPECT_TRUE(within(duration_error, 100 * motions[1].at("contact_duration_error").get<double>(), 6e-4));
    EXPECT_TRUE(within(compression_error, 100 * motions[1].at("max_compression_error").get<double>(), 6e-4));
    EXPECT_TRUE(within(at_44, 100 * motions[2].at("contact_duration_error").get<double>(), 6e-4));
    EXPECT_TRUE(within(at_96, 100 * motions[3].at("contact_duration_error").get<double>(), 6e-4));
    EXPECT_EQ(table[2 + i].find("out of the material's range") == std::string::npos, i > 0 && i < 6) << table[2 + i];
  }
}

// Three panels, each with the spline and two rates.
TEST(Impact, DrawsTheErrorsOverARangeOfSpeeds) {
  const Sandbox box;
  const std::string text = printed(box, {"impact", "felt_c4", "--speeds", "0.1", "6", "20", "--rate", "44100",
                                         "--rate", "96000", "--figure", "a.svg"});
  EXPECT_TRUE(text.ends_with("\nfigure: a.svg\n")) << text;
  expect_drawn(box / "a.svg", 9);
  EXPECT_EQ(columns_of(box / "a.svg").size(), 1u);
  const std::string shown = read_svg(box / "a.svg").text;
  for (const auto* label : {"contact duration error [%]", "max compression error [%]", "max force error [%]",
                            "impact speed [m/s]", "spline, 32 segments", "44.1 kHz", "96 kHz"})
    EXPECT_NE(shown.find(label), std::string::npos) << label;
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

// Pitches are equal-tempered, to the six digits of a rounded tension. B follows from the first two partials of the
// formula f_n = n f_0 sqrt(1 + B n^2), which the modes of the emitted note must have, too.
TEST(InspectKeyboard, ShowsPitchAndInharmonicityOfItsKeys) {
  const Sandbox box;
  const auto json = Json::parse(printed(box, {"inspect", "piano", "--json", "--rate", "48000"}));
  const auto keyboard = parse_keyboard(find_embedded(Shipped::kKeyboards, "piano.json")->content, "piano");
  std::vector<int> keys;
  for (const Json& row : json["keys"]) {
    const int key = row["key"];
    keys.push_back(key);
    EXPECT_TRUE(relatively_within(row["pitch_hz"].get<double>(), 440 * std::exp2((key - 69) / 12.0), 1e-6)) << key;
    const StiffString string = note_of(keyboard, key).string;
    const double ratio =
        undamped_mode(string, 2).angular_frequency_rad_per_s / undamped_mode(string, 1).angular_frequency_rad_per_s;
    const double inharmonicity = (ratio * ratio - 4) / (16 - ratio * ratio);
    EXPECT_TRUE(relatively_within(row["inharmonicity"].get<double>(), inharmonicity, 1e-8)) << key;
    EXPECT_EQ(row["modes"], modes_of(note_of(keyboard, key), 24000).size()) << key;
    EXPECT_EQ(row["strings"], key < 32 ? 1 : key < 44 ? 2 : 3) << key;
  }
  EXPECT_EQ(keys, (std::vector{21, 36, 48, 60, 72, 84, 96, 108}));
  const std::string table = printed(box, {"inspect", "piano"});
  EXPECT_NE(table.find("88 keys, 21 to 108"), std::string::npos) << table;
  EXPECT_NE(table.find("  60   261.626     0.0003112       3     58"), std::string::npos) << table;
}

TEST(Show, MayStateAnotherName) {
  const Sandbox box;
  std::string expected = printed(box, {"show", "felt_c4"});
  const std::size_t at = expected.find("\"felt_c4\"");
  ASSERT_NE(at, std::string::npos);
  expected.replace(at, 9, "\"my_felt\"");
  EXPECT_EQ(printed(box, {"show", "felt_c4", "--name", "my_felt"}), expected);
  expect_refused(run({.arguments = {"show", "felt_c4", "--name", "My Felt"}, .folder = box.path()}),
                 "--name: name: 'My Felt' is not a usable identifier", "allowed: a-z");
  expect_refused(run({.arguments = {"show", "dulcimer", "--name", "mine"}, .folder = box.path()}),
                 "dulcimer: --name: the file has no name of its own", "allowed: with a material");
}

}  // namespace
}  // namespace contactspline::testing
