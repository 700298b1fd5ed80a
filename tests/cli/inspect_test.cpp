// SPDX-License-Identifier: MIT
// contactspline inspect: the tables are the numbers of the library.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "generator/emit/emitter.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/compare.hpp"
#include "svg.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;

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

INSTANTIATE_TEST_SUITE_P(Segments, Inspect, ::testing::Values(1, 2, 3, 64, 1024, 65536));

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
  write_file(box / "law.json", R"({"name": "law", "contact": {"stiffness_n_per_m_alpha": 4e8, "exponent": 2.3},
    "spline": {"knots": "uniform", "segments": 16, "max_compression_m": 1e-3}})");
  printed(box, {"inspect", "law.json", "--figure", "b.svg"});
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
  expect_drawn(box / "families.svg", 24);
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

TEST(InspectFamilies, NeedARangeOfImpacts) {
  const Sandbox box;
  write_file(box / "bare.json", R"({"name": "bare", "contact": {"stiffness_n_per_m_alpha": 1e9, "exponent": 1.5},
    "spline": {"knots": "uniform", "segments": 4, "max_compression_m": 1e-3}})");
  const auto before = box.listing();
  expect_refused(run({.arguments = {"inspect", "bare.json", "--compare", "--figure", "a.svg"}, .folder = box.path()}),
                 "bare.json: impact: missing", "allowed: an object, because --compare measures impacts");
  EXPECT_TRUE(box.listing() == before);
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

// Of any kind, in the order of the arguments; as JSON an array.
// The felt C4 that ships has an error of 2.8 dB; 24 such segments have one of 9.4, 16 one of 14 dB, graded ones of 29
// dB.
TEST(Inspect, SaysThatATableIsPoorForSound) {
  const Sandbox box;
  const auto advice = [&](const std::string& spline) {
    write_file(box / "probe.json",
               R"({"name": "probe", "contact": {"stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5}, "impact": )"
               R"({"mass_kg": 0.00297, "min_speed_m_per_s": 0.1, "max_speed_m_per_s": 6}, "spline": )" +
                   spline + "}");
    const std::string text = printed(box, {"inspect", "probe.json"});
    const auto at = text.find("poor for sound");
    return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
  };
  const std::string graded = advice(R"({"knots": "graded", "tolerance": 0.001})");
  const std::string better = R"("knots": "optimal", "minimise": "spectrum", "segments": 48)";
  EXPECT_EQ(graded, "poor for sound: more than 10 dB. Try " + better);
  EXPECT_EQ(advice("{" + better + "}"), "");
  EXPECT_EQ(advice(R"({"knots": "optimal", "minimise": "spectrum", "segments": 24})"), "");
  EXPECT_EQ(advice(R"({"knots": "optimal", "minimise": "spectrum", "segments": 16})"),
            R"(poor for sound: more than 10 dB. Try "segments": 48, or "tolerance_db": 3)");
}

TEST(Inspect, PrintsSeveralFiles) {
  const Sandbox box;
  write_file(box / "probe.json", material(16));
  const Words files{"probe.json", "string_c4", "tom", "piano"};
  std::string pages;
  Json array = Json::array();
  for (const std::string& file : files) {
    pages += (pages.empty() ? "" : "\n") + printed(box, {"inspect", file});
    array.push_back(Json::parse(printed(box, {"inspect", file, "--json"})));
  }
  for (const std::string jobs : {"1", "3"}) {
    EXPECT_EQ(printed(box, followed_by({"inspect", "--jobs", jobs}, files)), pages);
    EXPECT_EQ(Json::parse(printed(box, followed_by({"inspect", "--json", "--jobs", jobs}, files))), array);
  }
}

// Nothing is printed, and the first bad file is named, whichever is refused first.
TEST(Inspect, RefusesSeveralFilesForTheFirstBadOne) {
  const Sandbox box;
  write_file(box / "slow.json", R"({"name": "slow", "contact": {"stiffness_n_per_m_alpha": 1e9, "exponent": 1.5},
    "impact": {"mass_kg": 0.01, "max_speed_m_per_s": 2, "min_speed_m_per_s": 0.1},
    "spline": {"knots": "uniform", "tolerance": 1e-12}})");
  for (const std::string jobs : {"1", "2"}) {
    const Words words{"inspect", "--jobs", jobs, "felt_c4", "slow.json", "gone.json", "nothing"};
    expect_refused(run({.arguments = words, .folder = box.path()}), "slow.json: spline.tolerance", "allowed");
  }
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

// How much of the energy the Airy functions of a plate hold: all of it between fixed edges, where enough are kept. A
// square plate keeps no half of a pair.
TEST(InspectInstrument, ShowsHowPlatesStretch) {
  const Sandbox box;
  for (const auto& [width, edges, count, kept] :
       {std::tuple{"0.3", "fixed", "64", "64 Airy functions, which hold 100 "},
        {"0.3", "fixed", "3", "3 Airy functions, which hold 69.5 "},
        {"0.3", "free", "20", "20 Airy functions, which hold 77.1 "},
        {"0.4", "free", "3", "3 Airy functions, which hold 2.42 "},
        {"0.4", "free", "2", "1 Airy functions, which hold 2.42 "}}) {
    write_file(box / "probe.json", fmt::format(R"({{
      "name": "probe",
      "bodies": [
        {{ "name": "lid", "max_modes": 10, "stretch": {{ "airy_functions": {}, "edges": "{}" }},
           "plate": {{ "length_m": 0.4, "width_m": {}, "thickness_m": 0.001, "density_kg_m3": 7800,
                       "youngs_modulus_pa": 2e11, "poisson_ratio": 0.3, "constant_loss_per_s": 1,
                       "quadratic_loss_m2_per_s": 0.0002 }} }} ],
      "places": [ {{ "name": "spot", "body": "lid", "position_m": 0.1, "across_m": 0.13 }} ],
      "outputs": [ {{ "name": "spot", "displacement_m": "spot" }} ]
    }})",
                                               count, edges, width));
    const std::string table = printed(box, {"inspect", "probe.json"});
    const std::string row = fmt::format("stretches by {}", kept);
    EXPECT_NE(table.find(row), std::string::npos) << row << " is not in\n" << table;
  }
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
        "  strike_hammer            strike    hammer_speed_m_per_s", "  bridge_end_force_n                 N",
        "figure: a.svg"})
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

// Pitches are equal-tempered, to the six digits of a rounded tension. B follows from the first two partials of the
// formula f_n = n f_0 sqrt(1 + B n^2), which the modes of the emitted note must have, too.
TEST(InspectKeyboard, ShowsPitchAndInharmonicityOfItsKeys) {
  const Sandbox box;
  const auto json = Json::parse(printed(box, {"inspect", "piano", "--json", "--rate", "48000"}));
  const std::string file(find_embedded(Shipped::kKeyboards, "piano.json")->content);
  const auto keyboard = parse_keyboard(file, "piano");
  std::vector<int> notes, keys;
  const Json source = Json::parse(file, nullptr, true, true);  // with comments
  for (const Json& note : source["keyboard"]["notes"]) notes.push_back(note["key"]);
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
  EXPECT_EQ(keys, notes);
  const std::string table = printed(box, {"inspect", "piano"});
  EXPECT_NE(table.find("88 keys, 21 to 108"), std::string::npos) << table;
  EXPECT_NE(table.find("  60   261.626     0.0002915       3     59"), std::string::npos) << table;
}

// The same peak clips where full scale is below it.
TEST(InspectInstrument, PrintsThePeakBesideFullScale) {
  const Sandbox box;
  const std::string page = printed(box, {"inspect", "tom"});
  EXPECT_NE(page.find("batter_velocity_m_per_s            m/s, full scale 3, peak 0."), page.npos) << page;
  std::string loud(find_embedded(Shipped::kInstruments, "tom.json")->content);
  const std::size_t at = loud.find("\"full_scale\": 3");
  ASSERT_NE(at, loud.npos);
  write_file(box / "loud.json", loud.replace(at, 15, "\"full_scale\": 0.1"));
  const std::string clips = printed(box, {"inspect", "loud.json"});
  EXPECT_NE(clips.find("(key 41): clips at "), clips.npos) << clips;
}

}  // namespace
}  // namespace contactspline::testing
