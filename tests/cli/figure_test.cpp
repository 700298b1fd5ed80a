// SPDX-License-Identifier: MIT
// Figures, read back: what they show, how they name it, and which one replaces which.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "generator/cli/error_panel.hpp"
#include "generator/cli/plot.hpp"
#include "generator/instrument/label_places.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"
#include "support/expressions.hpp"
#include "svg.hpp"

namespace contactspline::testing {
namespace {

std::string printed(const Sandbox& box, const Words& arguments) {
  return succeed({.arguments = arguments, .folder = box.path()});
}

/// A command that draws a figure of one kind into a file, and the kind in words.
struct Drawing {
  std::string kind;
  Words command;
};

std::vector<Drawing> drawings_into(const std::string& file) {
  return {{"figure of a spline", {"inspect", "probe.json", "--figure", file}},
          {"figure of knots", {"inspect", "probe.json", "--compare", "--figure", file}},
          {"figure of impacts", {"impact", "probe.json", "--speeds", "1", "2", "3", "--figure", file}},
          {"figure of a resonator", {"inspect", "marimba_c4", "--figure", file}},
          {"figure of an instrument", {"inspect", "tom", "--figure", file}},
          {"figure of a sound",
           {"render", "mass-barrier", "--material", "probe.json", "--duration", "0.02", "-o", "a.wav", "--figure",
            file}}};
}

void expect_only_its_kind_replaces(const Drawing& first, const Drawing& second, const std::string& file) {
  const Sandbox box;
  write_file(box / "probe.json", kProbeMaterial);
  printed(box, first.command);
  printed(box, first.command);
  const auto before = box.listing();
  expect_refused(run({.arguments = second.command, .folder = box.path()}), file + ": file: is a " + first.kind,
                 fmt::format("would become a {}; allowed: another name, or --force", second.kind));
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  printed(box, followed_by(second.command, {"--force"}));
}

TEST(Figure, ReplacesOnlyOneOfItsKind) {
  const auto drawings = drawings_into("a.svg");
  for (std::size_t i = 0; i < drawings.size(); ++i)
    expect_only_its_kind_replaces(drawings[i], drawings[(i + 1) % drawings.size()], "a.svg");
}

TEST(Figure, ReplacesOnlyOneOfItsKindInEveryFormat) {
  for (const std::string file : {"a.png", "a.pdf"})
    expect_only_its_kind_replaces(drawings_into(file)[0], drawings_into(file)[4], file);
}

std::vector<std::string> labels_in(const Sandbox& box, const std::string& file) {
  return read_svg(box / file).labels;
}

bool has(const std::vector<std::string>& labels, const std::string& label) {
  return std::ranges::find(labels, label) != labels.end();
}

/// What an axis of a script states: its range, and its tics with their labels.
struct Axis {
  double low, high;
  std::vector<std::pair<std::string, double>> tics;
};

Axis read_axis(const std::string& script) {
  const auto range = first_match(script, R"(set [xy]range \[([^:]+):([^\]]+)\])");
  if (!range) throw std::runtime_error("no range in " + script);
  Axis axis{std::stod((*range)[1]), std::stod((*range)[2]), {}};
  for (const Groups& tic : matches_of(script, R"('([^']*)' ([-+.\de]+))"))
    axis.tics.emplace_back(tic[1], std::stod(tic[2]));
  return axis;
}

// The power of ten before the unit of the label.
double factor_in(const std::string& script) {
  const auto power = first_match(script, R"(\[10\^\{(-?\d+)\} N\])");
  return power ? std::pow(10, std::stoi((*power)[1])) : 1;
}

// Decimals with a factor in the label of the axis; the largest label has at most 5 digits before its point.
TEST(FigureAxis, LabelsEveryTicInOneNotation) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> power(-12, 12), part(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const double scale = std::pow(10, power(random));
    const double a = scale * part(random), b = scale * part(random);
    const Interval range{std::min(a, b), std::max(a, b)};
    const std::string script = linear_axis('y', range, "force [N]");
    const Axis axis = read_axis(script);
    EXPECT_LE(axis.low, range.low + 1e-9 * scale);
    EXPECT_GE(axis.high, range.high - 1e-9 * scale);
    ASSERT_GE(axis.tics.size(), 2u) << script;
    EXPECT_LE(axis.tics.size(), 9u) << script;
    for (const auto& [label, at] : axis.tics) {
      EXPECT_EQ(label.find('e'), label.npos) << script;
      EXPECT_LE(label.size(), 8u) << script;
      EXPECT_TRUE(within(std::stod(label) * factor_in(script), at, 1e-6 * scale)) << script;
    }
  }
}

TEST(FigureAxis, LabelsLogarithmsAsDecimalsOrAsPowers) {
  EXPECT_EQ(read_axis(logarithmic_axis('y', {1e-3, 1}, "")).tics.front().first, "0.001");
  const auto tics = read_axis(logarithmic_axis('y', {1e-5, 1}, "")).tics;
  ASSERT_EQ(tics.size(), 6u);
  for (std::size_t i = 0; i < tics.size(); ++i)
    EXPECT_EQ(tics[i].first, fmt::format("10^{{{}}}", static_cast<int>(i) - 5));
  EXPECT_EQ(read_axis(logarithmic_axis('x', {1.5e-5, 6e-5}, "")).tics.front().first, "2·10^{-5}");
}

TEST(FigureAxis, LabelsEveryLogarithmInOneNotation) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> power(-9, 9);
  for (int i = 0; i < 2000; ++i) {
    const double a = std::pow(10, power(random)), b = std::pow(10, power(random));
    const Axis axis = read_axis(logarithmic_axis('x', {std::min(a, b), std::max(a, b)}, ""));
    ASSERT_GE(axis.tics.size(), 2u);
    const bool is_decimal = axis.tics.front().first.find('^') == std::string::npos;
    for (const auto& [label, at] : axis.tics) {
      EXPECT_EQ(label.find('e'), label.npos) << label;
      EXPECT_EQ(label.find('^') == label.npos, is_decimal) << label;
      if (is_decimal) {
        EXPECT_TRUE(relatively_within(std::stod(label), at, 1e-3)) << label;
      }
    }
  }
}

TEST(FigureAxis, OfAConstantHasTwoTics) {
  for (const double constant : {0.0, 1.0, -3.7e-9, 8e12})
    EXPECT_GE(read_axis(linear_axis('y', {constant, constant}, "force [N]")).tics.size(), 2u) << constant;
}

// Lobes between zeros 1/400 of the axis apart: every point of the envelope is the top of one, within what 1500
// samples see of it, and the largest of all is among them.
TEST(FigureEnvelope, TouchesTheTopsOfTheLobes) {
  ErrorCurve curve{"lobes", "", {}, {}};
  for (int i = 0; i <= 1500; ++i) {
    const double t = i / 1500.0;
    curve.at.push_back(std::pow(60, t));
    curve.error.push_back((1 + t) * std::sin(400 * std::numbers::pi * t));
  }
  const ErrorCurve envelope = envelope_of(curve);
  EXPECT_LE(envelope.at.size(), 42u);
  EXPECT_EQ(envelope.at.front(), curve.at.front());
  EXPECT_EQ(envelope.at.back(), curve.at.back());
  for (std::size_t i = 0; i < envelope.at.size(); ++i) {
    const double t = std::log(envelope.at[i]) / std::log(60);
    EXPECT_GT(std::abs(envelope.error[i]), 0.85 * (1 + t))
        << t;  // sin(pi/2 - half a sample) = 0.91, tops rise by 1/40
    EXPECT_LE(std::abs(envelope.error[i]), 1.03 * (1 + t)) << t;
  }
  const auto magnitude = [](double error) { return std::abs(error); };
  EXPECT_EQ(std::abs(*std::ranges::max_element(envelope.error, {}, magnitude)),
            std::abs(*std::ranges::max_element(curve.error, {}, magnitude)));
}

// The key states the largest error, as the table does.
TEST(FigureOfKnots, StatesTheLargestErrors) {
  const Sandbox box;
  write_file(box / "probe.json", kProbeMaterial);
  printed(box, {"inspect", "probe.json", "--compare", "--figure", "a.svg"});
  const auto table = nlohmann::json::parse(printed(box, {"inspect", "probe.json", "--compare", "--json"}));
  const std::string text = read_svg(box / "a.svg").text;
  for (const auto& family : table.at("families")) {
    const auto& errors = family.at("errors");
    for (const double error :
         {errors.at("contact_duration").get<double>(), errors.at("max_compression").get<double>(),
          errors.at("force").at("worst").get<double>()}) {
      const std::string entry =
          fmt::format("{}, 8 segments: {:.2g} %", family.at("knots").get<std::string>(), 100 * error);
      EXPECT_NE(text.find(entry), text.npos) << entry << text;
    }
  }
}

// Left three values by four models, right three errors of three models, each with its largest.
TEST(FigureOfImpacts, ShowsValuesAndErrorsOfOneMaterialOverSpeed) {
  const Sandbox box;
  const std::string text = printed(box, {"impact", "felt_c4", "--speeds", "0.1", "6", "100", "--rate", "44100",
                                         "--rate", "96000", "--figure", "a.svg"});
  EXPECT_TRUE(text.ends_with("\nfigure: a.svg\n")) << text;
  expect_drawn(box / "a.svg", 3 * 4 + 3 * 3 * 2);
  EXPECT_EQ(columns_of(box / "a.svg").size(), 2u);
  const auto labels = labels_in(box, "a.svg");
  for (const auto* label :
       {"contact duration [ms]", "largest force [N]", "restitution [1]", "contact duration error [%]",
        "max compression error [%]", "max force error [%]", "impact speed [m/s]", "largest error", "exact",
        "piano hammer felt, note C4: impacts of 2.97 g on a rigid barrier"})
    EXPECT_TRUE(has(labels, label)) << label;
  const auto json = nlohmann::json::parse(printed(
      box, {"impact", "felt_c4", "--speeds", "0.1", "6", "100", "--rate", "44100", "--rate", "96000", "--json"}));
  double largest = 0;
  for (const auto& impact : json)
    largest = std::max(largest, std::abs(impact["motions"][2]["contact_duration_error"].get<double>()));
  EXPECT_TRUE(has(labels, fmt::format("44.1 kHz: {:.2g} %", 100 * largest)));
}

TEST(FigureOfImpacts, ComparesMaterials) {
  const Sandbox box;
  printed(box, {"impact", "felt_c4", "felt_synthetic", "mb1", "--speeds", "0.3", "4", "20", "--rate", "44100",
                "--figure", "a.svg"});
  expect_drawn(box / "a.svg", 3 * 3 * 3);
  EXPECT_EQ(columns_of(box / "a.svg").size(), 1u);
  const auto labels = labels_in(box, "a.svg");
  for (const auto* label : {"felt_c4, 2.97 g", "felt_synthetic, 4.9 g", "mb1, 10 g", "exact", "spline", "44.1 kHz"})
    EXPECT_TRUE(has(labels, label)) << label;
}

TEST(FigureOfImpacts, ShowsErrorsOverTheSampleRate) {
  const Sandbox box;
  printed(box, {"impact", "felt_c4", "mb1", "--speed", "0.5", "--speed", "2", "--rate", "96000", "--rate", "48000",
                "--figure", "a.svg"});
  expect_drawn(box / "a.svg", 3 * 4 * 3);  // simulated, its largest, the spline alone
  const auto json = nlohmann::json::parse(
      printed(box, {"impact", "mb1", "--speed", "0.5", "--rate", "96000", "--rate", "48000", "--json"}));
  const auto labels = labels_in(box, "a.svg");
  double error = 0;
  for (const std::size_t rate : {2u, 3u})
    error = std::max(error, std::abs(json[0]["motions"][rate]["max_force_error"].get<double>()));
  EXPECT_TRUE(has(labels, fmt::format("mb1, 10 g, 0.5 m/s: {:.2g} %", 100 * error)));
  for (const auto* label : {"sample rate [kHz]; pale: the spline alone", "48", "96"})
    EXPECT_TRUE(has(labels, label)) << label;
}

// The branches of a measured impact lie on its samples: loss 0 would lie between them.
TEST(FigureOfASpline, ShowsTheBranchesOfAMeasuredImpact) {
  const Sandbox box;
  std::string curve = "compression_mm,force_n\n";
  for (const auto* sample :
       {"0.152,0.3", "0.304,1.6", "0.454,4.0", "0.599,7.4", "0.736,11.6", "0.862,16.2", "0.969,20.6", "1.05,24.0",
        "1.1,25.0", "1.07,21.5", "0.95,14.6", "0.845,10.3", "0.739,7.4", "0.624,4.9", "0.504,3.0", "0.380,1.5"})
    curve += std::string(sample) + "\n";
  write_file(box / "felt.csv", curve);
  write_file(box / "probe.json", R"({"name": "probe",
    "contact": {"curve": {"file": "felt.csv", "shape": "hardening", "impact_speed_m_per_s": 2.0}},
    "impact": {"mass_kg": 0.0049, "max_speed_m_per_s": 1.5, "min_speed_m_per_s": 0.2},
    "spline": {"knots": "uniform", "segments": 8}})");
  printed(box, {"inspect", "probe.json", "--figure", "a.svg"});
  expect_drawn(box / "a.svg", 12);
  const std::string text = read_svg(box / "a.svg").text;
  EXPECT_NE(text.find("with loss 0.1"), text.npos) << text;
  // Samples at the turning point lie beyond the range: the branches are two lines. The third is that of the key.
  const std::string svg = read_file(box / "a.svg");
  const auto branches = first_match(svg, R"(stroke='rgb\(  0, 158, 115\)'\s+d='([^']*)')");
  ASSERT_TRUE(branches);
  EXPECT_EQ(std::ranges::count((*branches)[1], 'M'), 3) << (*branches)[1];
}

// Each knot is a vertex of its curve, so that kinks are drawn where they are; those of the two keys are of no curve.
TEST(FigureOfASpline, DrawsKinksAtTheKnots) {
  const Sandbox box;
  printed(box, {"inspect", "felt_c4", "--figure", "a.svg"});
  std::set<std::string> vertices;
  std::vector<std::string> knots;
  for (const std::string& numbers : read_svg(box / "a.svg").numbers) {
    for (const Groups& vertex : matches_of(numbers, R"([ML](\d+\.\d+,\d+\.\d+))")) vertices.insert(vertex[1]);
    if (const auto knot = whole_match(numbers, R"(translate\((\d+\.\d+,\d+\.\d+)\) scale.*)"))
      knots.push_back((*knot)[1]);
  }
  EXPECT_EQ(knots.size(), 4 * 48 + 2u);
  EXPECT_EQ(std::ranges::count_if(knots, [&](const std::string& at) { return !vertices.contains(at); }), 2);
}

constexpr auto kTwoStrings = R"({
  "instrument": "fret_guitar", "duration_s": 0.05, "voices": [ { "name": "a" }, { "name": "b" } ],
  "events": [ { "time_s": 0, "voice": "a", "finger_release_n": 2 } ] })";

TEST(FigureOfASound, SaysWhoseForceItShows) {
  const Sandbox box;
  write_file(box / "two_strings.json", kTwoStrings);
  printed(box, {"render", "--score", "two_strings.json", "-o", "a.wav"});
  const auto labels = labels_in(box, "a.svg");
  EXPECT_TRUE(has(labels, "largest of 2 voices"));
  EXPECT_TRUE(has(labels, "two_strings (fret_guitar)"));
}

TEST(FigureOfASound, SaysHowManyContactsAForceSums) {
  const Sandbox box;
  write_file(box / "short.json", R"({"instrument": "tanpura", "duration_s": 0.05,
    "events": [ { "time_s": 0, "finger_release_n": 1 } ] })");
  printed(box, {"render", "--score", "short.json", "-o", "a.wav"});
  EXPECT_TRUE(has(labels_in(box, "a.svg"), "sum of 24 contacts"));
  EXPECT_TRUE(has(labels_in(box, "a.svg"), "short (tanpura)"));
}

TEST(FigureOfASound, HasNoPanelOfAForceThatIsNone) {
  const Sandbox box;
  printed(box, {"render", "mass-barrier", "--gravity", "0", "--speed", "0", "--duration", "0.02", "-o", "a.wav"});
  expect_drawn(box / "a.svg", 1);
  write_file(box / "still.json", R"({"instrument": "classical_guitar", "duration_s": 0.05,
    "events": [ { "time_s": 0, "finger_d3_release_n": 1 } ] })");
  const std::string said = printed(box, {"render", "--score", "still.json", "-o", "b.wav"});
  EXPECT_TRUE(said.starts_with("full scale of the sound: ")) << said;  // nothing of contacts
  expect_drawn(box / "b.svg", 2);
  EXPECT_EQ(read_svg(box / "b.svg").text.find("contact force"), std::string::npos);
}

// Three panels: points, and twice impulses with points. Every shipped resonator can be drawn.
TEST(FigureOfAResonator, ShowsItsModes) {
  for (const EmbeddedFile& file : embedded_files(Shipped::kResonators)) {
    const Sandbox box;
    const std::string name(file.name.substr(0, file.name.rfind('.')));
    const std::string page = printed(box, {"inspect", name, "--rate", "48000", "--figure", "a.svg"});
    EXPECT_TRUE(page.ends_with("figure: a.svg\n")) << page;
    expect_drawn(box / "a.svg", 5);
    EXPECT_EQ(columns_of(box / "a.svg").size(), 1u);
    const auto labels = labels_in(box, "a.svg");
    for (const auto* label : {"frequency [Hz]", "decay [1/s]", "shape at the strike [1]", "shape at the pickup [1]"})
      EXPECT_TRUE(has(labels, label)) << name << label;
    const auto modes = nlohmann::json::parse(printed(box, {"inspect", name, "--rate", "48000", "--json"}));
    const std::string count = fmt::format(": {} modes below 24000 Hz", modes.at("modes").size());
    EXPECT_TRUE(std::ranges::any_of(labels, [&](const auto& label) { return label.ends_with(count); })) << count;
  }
}

// One mode without decay, whose shape is 0 at the pickup.
TEST(FigureOfAResonator, ShowsASingleMode) {
  const Sandbox box;
  write_file(box / "one.json", R"({"name": "one", "modes": [
    {"frequency_hz": 100, "decay_per_s": 0, "mass_kg": 1, "strike_shape": 1, "pickup_shape": 0} ]})");
  printed(box, {"inspect", "one.json", "--figure", "a.svg"});
  expect_drawn(box / "a.svg", 5);
  EXPECT_TRUE(has(labels_in(box, "a.svg"), "one: 1 mode below 22050 Hz"));
}

/// A label of a drawing, with less room than the letters take.
struct DrawnLabel {
  std::string text;
  ScreenBox box;
};

std::vector<DrawnLabel> drawn_labels(const std::string& svg) {
  const char* expression =
      R"rx(translate\(([\d.]+),([\d.]+)\)"[^>]*font-size="12.00"  text-anchor="(\w+)">\s*<text>([^<]+)</text>)rx";
  std::vector<DrawnLabel> labels;
  for (const Groups& label : matches_of(svg, expression)) {
    const double x = std::stod(label[1]), y = std::stod(label[2]), width = 5.5 * static_cast<double>(label[4].size());
    const double left = label[3] == "start" ? x : x - width / 2;
    labels.push_back({label[4], {left, y - 8, left + width, y}});
  }
  return labels;
}

std::vector<std::pair<ScreenPoint, ScreenPoint>> drawn_lines(const std::string& svg) {
  std::vector<std::pair<ScreenPoint, ScreenPoint>> lines;
  for (const Groups& line : matches_of(svg, R"(M([\d.]+),([\d.]+) L([\d.]+),([\d.]+))"))
    lines.push_back({{std::stod(line[1]), std::stod(line[2])}, {std::stod(line[3]), std::stod(line[4])}});
  return lines;
}

TEST(FigureOfAnInstrument, KeepsEveryLabelFreeInThoseThatShip) {
  for (const EmbeddedFile& file : embedded_files(Shipped::kInstruments)) {
    const Sandbox box;
    const std::string name(file.name.substr(0, file.name.rfind('.')));
    printed(box, {"inspect", name, "--figure", "a.svg"});
    const std::string svg = read_file(box / "a.svg");
    const auto labels = drawn_labels(svg);
    const auto lines = drawn_lines(svg);
    EXPECT_GE(labels.size(), 4u) << name;  // gong: a plate, a beater, a place, a contact
    EXPECT_GE(lines.size(), 3u) << name;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_FALSE(labels[i].box.overlaps(labels[j].box))
            << name << ": " << labels[i].text << ", " << labels[j].text;
      for (const auto& [from, to] : lines)
        EXPECT_FALSE(labels[i].box.is_crossed_by(from, to)) << name << ": a line crosses " << labels[i].text;
    }
  }
}

TEST(LabelBox, IsCrossedByWhatTouchesItsInside) {
  const ScreenBox box{0, 0, 4, 2};
  EXPECT_TRUE(box.is_crossed_by({-1, 1}, {5, 1}));
  EXPECT_TRUE(box.is_crossed_by({-1, -1}, {5, 3}));
  EXPECT_TRUE(box.is_crossed_by({1, 1}, {2, 1}));
  EXPECT_FALSE(box.is_crossed_by({-1, 1}, {-0.1, 1}));
  EXPECT_FALSE(box.is_crossed_by({-1, 2}, {5, 2}));
  EXPECT_FALSE(box.is_crossed_by({3, -2}, {6, 1}));
  EXPECT_FALSE(box.is_crossed_by({5, -1}, {5, 3}));
}

TEST(LabelPlaces, TakesTheFirstFreePlace) {
  LabelPlaces places({0, 0, 500, 300});
  places.add_line({0, 100}, {500, 100});
  EXPECT_EQ(places.choose("abc", {{5, 50}, {100, 100}, {100, 120}, {200, 120}}).x, 100);  // off the page, on a line
  EXPECT_EQ(places.choose("abc", {{100, 120}, {200, 120}}).x, 200);                       // the other is taken
  EXPECT_EQ(places.choose("abc", {{100, 120}, {300, 100}}).x, 300);  // rather a line than a label
}

// Pixels have two decimals, of at least 100 in a panel: tics and points are within 2e-4 of the range of an axis.
void expect_extremes(const DrawnCurve& curve, double low, double high) {
  const double bound = 1e-3 * (high - low);
  ASSERT_FALSE(curve.y.empty());
  EXPECT_TRUE(within(std::ranges::min(curve.y), low, bound)) << std::ranges::min(curve.y) << " for " << low;
  EXPECT_TRUE(within(std::ranges::max(curve.y), high, bound)) << std::ranges::max(curve.y) << " for " << high;
}

// A number after some words of a text.
double number_after(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  if (at == text.npos) throw std::runtime_error("no '" + words + "' in " + text);
  return std::stod(text.substr(at + words.size()));
}

// What is drawn is the mean of what is in the file: two strings, one on each side.
TEST(FigureOfASound, ShowsTheMeanOfBothChannelsInTheUnitOfItsAxis) {
  const Sandbox box;
  std::string score = kTwoStrings;
  score.replace(score.find("\"a\" }"), 5, "\"a\", \"pan\": -0.8 }");
  score.replace(score.find("0.05"), 4, "0.1");
  write_file(box / "left.json", score);
  const std::string report = printed(box, {"render", "left.json"});
  const double full_scale = number_after(report, "full scale of the sound: ");
  const Sound sound = read_sound(box / "left.wav");
  ASSERT_EQ(sound.channels, 2);
  double low = 0, high = 0;
  for (std::size_t i = 0; i + 1 < sound.samples.size(); i += 2) {
    const double mean = full_scale * (sound.samples[i] + sound.samples[i + 1]) / 2;
    low = std::min(low, mean);
    high = std::max(high, mean);
  }
  const auto curves = drawn_curves(box / "left.svg");
  ASSERT_GE(curves.size(), 2u);
  expect_extremes(curves[0], low, high);
  expect_extremes(curves[1], 0, number_after(report, "largest contact force "));
  const auto labels = labels_in(box, "left.svg");
  EXPECT_TRUE(has(labels, "amplifier velocity [m/s],"));
  EXPECT_TRUE(has(labels, "mean of both channels"));
}

TEST(FigureOfASound, SaysThatAPianosVelocityIsWeighted) {
  const Sandbox box;
  write_file(box / "note.json", R"({"instrument": "piano", "duration_s": 0.05,
    "events": [ { "time_s": 0, "key": 60, "speed_m_per_s": 2 } ] })");
  const std::string report = printed(box, {"render", "note.json"});
  EXPECT_NE(report.find("m/s (weighted body velocity)"), report.npos) << report;
  EXPECT_TRUE(has(labels_in(box, "note.svg"), "weighted body velocity [m/s],"));
  EXPECT_TRUE(has(labels_in(box, "note.svg"), "note (piano)"));
}

TEST(FigureOfASound, ShowsABouncingMassInTheUnitsOfItsAxes) {
  const Sandbox box;
  const std::string report =
      printed(box, {"render", "mass-barrier", "--speed", "2", "--gravity", "9.81", "--duration", "0.3", "--signal",
                    "displacement", "-o", "a.wav"});  // it has turned before the program fades the end
  const double full_scale = number_after(report, "full scale of the sound: ");
  double low = 0, high = 0;
  for (const double sample : read_sound(box / "a.wav").samples) {
    low = std::min(low, -1e3 * full_scale * sample);
    high = std::max(high, -1e3 * full_scale * sample);
  }
  const auto curves = drawn_curves(box / "a.svg");
  ASSERT_GE(curves.size(), 3u);
  expect_extremes(curves[0], low, high);
  for (const std::size_t force : {1u, 2u}) expect_extremes(curves[force], 0, number_after(report, "contact force "));
}

// Force, speed and energies against the numbers of --json: exact and simulated.
TEST(FigureOfImpacts, ShowsForceSpeedAndEnergyOverTime) {
  for (const std::string material : {"felt_c4", "rubber_on_wood"}) {  // without and with loss
    const Sandbox box;
    const Words call = {"impact", material, "--speed", "2", "--rate", "192000"};
    printed(box, followed_by(call, {"--figure", "a.svg"}));
    const auto json = nlohmann::json::parse(printed(box, followed_by(call, {"--json"})))[0];
    const double mass = json.at("mass_kg").get<double>(), kinetic = mass * 2 * 2 / 2;
    const auto curves = drawn_curves(box / "a.svg");
    ASSERT_EQ(curves.size(), 3 + 3 + 2 * 3u);
    for (std::size_t m = 0; m < 3; ++m) {
      const auto& motion = json.at("motions")[m];
      const double exit_speed = motion.at("exit_speed_m_per_s").get<double>();
      expect_extremes(curves[m], 0, motion.at("max_force_n").get<double>());
      expect_extremes(curves[3 + m], -exit_speed, 2);
      expect_extremes(curves[6 + 2 * m], 0, kinetic);
      const DrawnCurve& total = curves[7 + 2 * m];
      EXPECT_TRUE(within(total.y.front(), kinetic, 2e-3 * kinetic)) << material << m;
      EXPECT_TRUE(within(total.y.back(), mass * exit_speed * exit_speed / 2, 2e-3 * kinetic)) << material << m;
      EXPECT_TRUE(relatively_within(curves[m].x.back(), 1e3 * motion.at("contact_duration_s").get<double>(), 0.02));
    }
  }
}

// Where a place is drawn on its string: the ends of the line are 0 and the length.
TEST(FigureOfAnInstrument, DrawsPlacesToScale) {
  const Sandbox box;
  write_file(box / "bar.json", R"({"name": "bar",
    "bodies": [ { "name": "string", "string": { "length_m": 0.8, "mass_kg": 0.005, "tension_n": 700,
      "bending_stiffness_n_m2": 0, "constant_loss_per_s": 1, "quadratic_loss_m2_per_s": 1e-5 } }, { "name": "hammer", "mass_kg": 0.01 } ],
    "places": [ { "name": "struck", "body": "string", "position_m": 0.2 },
                { "name": "end", "body": "string", "position_m": 0.8 } ],
    "contacts": [ { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4" } ],
    "strikes": ["hammer"], "outputs": [ { "name": "end", "velocity_m_per_s": "end" } ] })");
  printed(box, {"inspect", "bar.json", "--figure", "a.svg"});
  const std::string svg = read_file(box / "a.svg");
  double left = 0, right = 0;
  for (const auto& [from, to] : drawn_lines(svg))
    if (from.y == to.y && to.x - from.x > right - left) left = from.x, right = to.x;
  std::vector<double> parts;
  for (const Groups& dot : matches_of(svg, R"(translate\(([\d.]+),[\d.]+\) scale)"))
    parts.push_back((std::stod(dot[1]) - left) / (right - left));
  for (const double part : {0.25, 1.0})
    EXPECT_TRUE(std::ranges::any_of(parts, [=](double drawn) { return within(drawn, part, 1e-3); })) << part;
}

}  // namespace
}  // namespace contactspline::testing
