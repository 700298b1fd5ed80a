// SPDX-License-Identifier: MIT
// contactspline render hammer-string, slide-string, fret-string: the sound is the models' motion under the score.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <map>
#include <numbers>
#include <sndfile.hh>
#include <sstream>
#include <string>
#include <vector>

#include "contactspline/fret_string.hpp"
#include "contactspline/hammer_string.hpp"
#include "contactspline/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/slide_string.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"
#include "svg.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

constexpr double kRate = 44100;

/// File names and contents, beside the score.
using Files = std::map<std::string, std::string>;

Sound sound_of(const std::string& instrument, const std::string& score, const Words& options = {}) {
  const Sandbox box;
  write_file(box / "probe.json", score);
  succeed({.arguments = followed_by({"render", instrument, "--score", "probe.json", "-o", "a.wav"}, options),
           .folder = box.path()});
  expect_drawn(box / "a.svg", 3);
  return read_sound(box / "a.wav");
}

/// The same without a figure, which takes longer than a short sound.
Sound sound_alone(const std::string& instrument, const std::string& score, const Files& beside,
                  const Words& options = {}) {
  const Sandbox box;
  write_file(box / "probe.json", score);
  for (const auto& [name, text] : beside) write_file(box / name, text);
  const Words words = {"render", instrument, "--score", "probe.json", "-o", "a.wav", "--no-figure"};
  succeed({.arguments = followed_by(words, options), .folder = box.path()});
  return read_sound(box / "a.wav");
}

// 24 bits, and a sum of voices kept in single precision.
void expect_is(const Sound& sound, std::vector<double> motion, double bound = 2 * kLevel) {
  const auto channels = static_cast<std::size_t>(sound.channels), frames = motion.size() / channels;
  for (std::size_t i = 0; i < motion.size(); ++i) {  // the last 10 ms fade to 0 by a raised cosine
    const double from_end = static_cast<double>(frames - 1 - i / channels) / (0.01 * sound.rate);
    if (from_end < 1) motion[i] *= std::pow(std::sin(pi / 2 * from_end), 2);
  }
  double largest = 0;
  for (const double value : motion) largest = std::max(largest, std::abs(value));
  ASSERT_GT(largest, 0);
  std::vector<double> expected;
  for (const double value : motion) expected.push_back(value * kPeak / largest);
  EXPECT_TRUE(within(sound.peak(), kPeak, kLevel));
  EXPECT_TRUE(sequences_within<double>(sound.samples, expected, bound));
}

std::string shipped(std::span<const EmbeddedFile> texts, const std::string& name) {
  return std::string(std::ranges::find(texts, name + ".json", &EmbeddedFile::name)->content);
}

Design shipped_material(const std::string& name) {
  return design_material(shipped(embedded_files(Shipped::kMaterials), name), name);
}

/// A shipped resonator and a material as the models take them.
struct Parts {
  Parts(const std::string& resonator_name, const Design& design)
      : resonator(parse_resonator(shipped(embedded_files(Shipped::kResonators), resonator_name), resonator_name)),
        set(modes_of(resonator, kRate / 2)),
        table(segment_table(design.spline)) {
    for (const auto& mode : set.modes) {
      modes.push_back(mode.mode);
      wavenumbers.push_back(mode.wavenumber_per_m);
    }
  }
  Parts(const std::string& resonator_name, const std::string& material_name)
      : Parts(resonator_name, shipped_material(material_name)) {}

  [[nodiscard]] ModeShapes<double> at(double place_m) const {
    ModeShapes<double> shapes(modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i) shapes[i] = std::sin(wavenumbers[i] * place_m);
    return shapes;
  }

  Resonator resonator;
  ModeSet set;
  std::vector<Segment<double>> table;
  std::vector<Mode> modes;
  std::vector<double> wavenumbers;
};

// From one value to another between two samples, as scores glide.
double glide(double from, double to, int n, int begin, int end) {
  if (n <= begin) return from;
  if (n >= end) return to;
  const double part = static_cast<double>(n - begin) / (end - begin);
  return from + (to - from) * part * part * (3 - 2 * part);
}

const std::string kHammerScore = R"({
  "instrument": "hammer-string", "duration_s": 0.4,
  "voices": [ { "name": "c4", "resonator": "string_c4", "material": "felt_c4", "damper_per_s": 30 } ],
  "events": [
    { "time_s": 0.3, "speed_m_per_s": 1.5, "strike_m": 0.2, "stiffness_ratio": 4, "hammer_mass_kg": 0.004, "loss_s_per_m": 0.2 },
    { "time_s": 0.01, "speed_m_per_s": 2.5, "hold_s": 0.15 },
    { "time_s": 0.1, "speed_m_per_s": 3.5, "hold_s": 0.1 },
    { "time_s": 0.31, "over_s": 0.05, "damping_per_s": 20 }
  ]
})";

/// A damper that covers a constant fraction of its remaining distance with each sample, held for 16 samples at its
/// mean.
class SinkingDamper {
 public:
  explicit SinkingDamper(double full_per_s) : full_per_s_(full_per_s) {}

  /// Damping over the next sample [1/s].
  double next() {
    if (sample_++ % 16 == 0) {
      mean_ = 0;
      for (int i = 0; i < 16; ++i) mean_ += (value_ += kFraction * (full_per_s_ - value_)) / 16;
    }
    return mean_;
  }

 private:
  const double kFraction = 1 - std::exp(-1 / (0.005 * kRate));

  double full_per_s_, value_ = 0, mean_ = 0;
  int sample_ = 0;
};

// Two throws at once held, a damper between, a third throw elsewhere with another hammer, a damping that glides in.
std::vector<double> hammer_motion(Parts& parts, double (*output)(const HammerString<double>&, const Parts&)) {
  HammerString<double> model(parts.table, parts.modes, parts.at(parts.resonator.strike.position_m), kRate);
  SinkingDamper damper(30);
  std::vector<double> motion;
  for (int n = 0; n < 17640; ++n) {
    if (n == 441) model.strike(2.5, 1e-4);
    if (n == 4410) model.strike(3.5, 1e-4);
    if (n == 13230) {
      model.strike_at(parts.at(0.2));
      model.strike(1.5, 1e-4);
    }
    const bool is_damped = n >= 8820 && n < 13230;
    HammerStringControls<double> controls{.hammer_mass_kg = 0.00297, .damping_per_s = is_damped ? damper.next() : 0};
    if (n >= 13230) controls = {.hammer_mass_kg = 0.004, .felt = {4, 0.2}, .damping_per_s = 0};
    controls.damping_per_s += glide(0, 20, n, 13671, 13671 + 2205);
    model.tick(controls);
    motion.push_back(output(model, parts));
  }
  return motion;
}

TEST(RenderScore, PlaysTheHammerString) {
  Parts parts("string_c4", "felt_c4");
  const auto bridge = [](const HammerString<double>& model, const Parts& p) {
    ModeShapes<double> shapes(p.modes.size());
    for (std::size_t i = 0; i < p.modes.size(); ++i)
      shapes[i] = bridge_shape(std::get<StiffString>(p.resonator.body), StringMode{p.modes[i], p.wavenumbers[i]});
    return model.string().displacement(model.string().sound_pickup(shapes));
  };
  const auto velocity = [](const HammerString<double>& model, const Parts& p) {
    return model.string().velocity(model.string().sound_pickup(p.at(0.248)));
  };
  const auto displacement = [](const HammerString<double>& model, const Parts& p) {
    return model.string().displacement(model.string().sound_pickup(p.at(0.248)));
  };
  const auto force = [](const HammerString<double>& model, const Parts&) { return model.force(); };
  expect_is(sound_of("hammer-string", kHammerScore), hammer_motion(parts, bridge));
  expect_is(sound_of("hammer-string", kHammerScore, {"--signal", "velocity"}), hammer_motion(parts, velocity));
  expect_is(sound_of("hammer-string", kHammerScore, {"--signal", "displacement"}),
            hammer_motion(parts, displacement));
  expect_is(sound_of("hammer-string", kHammerScore, {"--signal", "force"}), hammer_motion(parts, force));
}

TEST(RenderScore, PlaysTheSlideString) {
  Parts parts("guitar_g3", "steel_on_steel");
  SlideString<double> model(parts.table, parts.modes, StringShapes<double>(parts.wavenumbers), 0.5, kRate);
  model.place(0.2, 1e-3);
  const auto pickup = model.string().sound_pickup(parts.at(0.6));
  std::vector<double> motion;
  for (int n = 0; n < 13230; ++n) {
    // 0.05 s: a pluck of 4 ms; from 0.1 s on the slide glides, from 0.2 s on it trembles.
    const double pluck = n < 2205 + 176 ? glide(0, 4, n, 2205, 2205 + 176) : 0.0;
    const double vibrato_m = 0.002 * std::sin(2 * pi * 6 * (n - 8820 + 1) / kRate);
    model.tick({.place_m = glide(0.2, 0.3, n, 4410, 8820) + (n >= 8820 ? vibrato_m : 0.0),
                .slide_mass_kg = 0.04,
                .hand_force_n = 2,
                .hand_stiffness_n_per_m = 200,
                .hand_resistance_n_s_per_m = 2,
                .rest_resistance_n_s_per_m = 1,
                .pluck_force_n = pluck,
                .contact = {0.5, 0.1}});
    motion.push_back(model.string().velocity(pickup));
  }
  // rattling contacts amplify what vibrato's phase, summed up sample by sample, is rounded by
  expect_is(sound_of("slide-string", R"({
    "instrument": "slide-string", "duration_s": 0.3,
    "voices": [ { "name": "g", "resonator": "guitar_g3", "material": "steel_on_steel", "pluck_m": 0.5, "pickup_m": 0.6, "height_m": 0.001 } ],
    "events": [
      { "time_s": 0, "place_m": 0.2, "slide_mass_kg": 0.04, "hand_force_n": 2, "hand_stiffness_n_per_m": 200,
        "hand_resistance_n_s_per_m": 2, "rest_resistance_n_s_per_m": 1, "stiffness_ratio": 0.5, "loss_s_per_m": 0.1 },
      { "time_s": 0.05, "pluck_n": 4 },
      { "time_s": 0.1, "over_s": 0.1, "place_m": 0.3 },
      { "time_s": 0.2, "vibrato_m": 0.002, "vibrato_hz": 6 }
    ] })"),
            motion, 1e-5);
}

// A stiffness that jumps by twelve orders of magnitude in every sample does at most 1 W of work on a pressed slide:
// no force is far beyond those of the hand and of the pluck.
TEST(RenderScore, StaysCalmWhileAStiffnessJumps) {
  std::string events = R"({ "time_s": 0, "place_m": 0.2, "slide_mass_kg": 0.04, "hand_force_n": 2,
    "hand_stiffness_n_per_m": 200, "hand_resistance_n_s_per_m": 2, "rest_resistance_n_s_per_m": 1,
    "stiffness_ratio": 0.5, "loss_s_per_m": 0.1 }, { "time_s": 0.02, "pluck_n": 4 })";
  for (int n = 0; n < 4000; ++n)
    events += fmt::format(R"(, {{ "time_s": {}, "stiffness_ratio": {} }})", 0.01 + n / 44100.0, n % 2 ? 1e6 : 1e-6);
  const Sandbox box;
  write_file(box / "jumps.json", R"({ "instrument": "slide-string", "duration_s": 0.2, "voices": [ { "name": "g",
    "resonator": "guitar_g3", "material": "steel_on_steel", "pluck_m": 0.5, "pickup_m": 0.6, "height_m": 0.001 } ], "events": [ )" +
                                     events + " ] }");
  const std::string report =
      succeed({.arguments = {"render", "slide-string", "--score", "jumps.json", "--no-figure", "-o", "jumps.wav"},
               .folder = box.path()});
  const std::string before = "largest contact force ";
  ASSERT_NE(report.find(before), std::string::npos) << report;
  EXPECT_LT(std::stod(report.substr(report.find(before) + before.size())), 1000) << report;
}

TEST(RenderScore, PlaysTheFretString) {
  Parts parts("guitar_d3", "steel_on_steel");
  FretString<double> model(parts.table, parts.modes, StringShapes<double>(parts.wavenumbers), 0.3, kRate);
  model.place(0.6, 1e-3);
  const auto pickup = model.string().sound_pickup(parts.at(0.05));
  std::vector<double> motion;
  for (int n = 0; n < 8820; ++n) {
    model.tick({.place_m = 0.6,
                .gap_m = glide(1e-3, 1e-4, n, 4410, 6615),
                .pluck_force_n = n < 2205 + 176 ? glide(0, 3, n, 2205, 2205 + 176) : 0.0,
                .damping_per_s = 3,
                .contact = {2, 0.3}});
    motion.push_back(model.string().velocity(pickup));
  }
  expect_is(sound_of("fret-string", R"({
    "instrument": "fret-string", "duration_s": 0.2,
    "voices": [ { "name": "d", "resonator": "guitar_d3", "material": "steel_on_steel", "pluck_m": 0.3, "pickup_m": 0.05 } ],
    "events": [
      { "time_s": 0, "place_m": 0.6, "gap_m": 0.001, "stiffness_ratio": 2, "loss_s_per_m": 0.3, "damping_per_s": 3 },
      { "time_s": 0.05, "pluck_n": 3 },
      { "time_s": 0.1, "over_s": 0.05, "gap_m": 0.0001 }
    ] })"),
            motion);
}

/// A material that a score plays: a file beside the score, or a name that ships.
struct MaterialCase {
  std::string test;
  std::string key;  ///< what the score calls it
  Files files = {};

  [[nodiscard]] Design design() const {
    if (files.empty()) return shipped_material(key);
    return design_material(files.at(key), key, [this](const std::string& path) { return files.at(path); });
  }
};

void PrintTo(const MaterialCase& one, std::ostream* stream) {
  *stream << one.test;
}

MaterialCase felt_with(const std::string& test, const std::string& spline, const std::string& more = "") {
  return {test,
          "felt.json",
          {{"felt.json", R"({ "name": "probe", "contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
              "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },
              "spline": { )" +
                             spline + " }" + more + " }"}}};
}

MaterialCase law_with(const std::string& test, const std::string& contact) {
  MaterialCase one = {
      test,
      "law.json",
      {{"law.json", R"({ "name": "probe", "contact": )" + contact +
                        R"(, "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 4.0, "min_speed_m_per_s": 0.1 },
              "spline": { "knots": "graded", "segments": 12 } })"}}};
  if (test == "measured_curve")
    one.files["felt.csv"] =
        "compression_mm,force_n\n0.1,1\n0.2,3\n0.4,8\n0.6,20\n0.8,40\n1.2,80\n1.4,140\n1.6,190\n3,1000\n";
  return one;
}

const std::string kUniform = R"("knots": "uniform", "segments": 8)";
const std::string kGraded = R"("knots": "graded", "segments": 8)";
const std::string kCompensation = R"(, "compensation": { "sample_rate_hz": 44100, "mass_kg": 0.003 })";

// Every kind of material that `generate` accepts, and every one that ships.
std::vector<MaterialCase> material_cases() {
  std::vector<MaterialCase> cases = {
      felt_with("uniform", kUniform),
      felt_with("uniform_by_tolerance", R"("knots": "uniform", "tolerance": 0.01)"),
      felt_with("graded", kGraded),
      felt_with("graded_by_tolerance", R"("knots": "graded", "tolerance": 0.01)"),
      felt_with("optimal", R"("knots": "optimal", "segments": 8)"),
      felt_with("optimal_by_tolerance", R"("knots": "optimal", "tolerance": 0.01)"),
      felt_with("optimal_in_force", R"("knots": "optimal", "segments": 8, "minimise": "force")"),
      felt_with("optimal_in_spectrum", R"("knots": "optimal", "segments": 8, "minimise": "spectrum")"),
      felt_with("spectrum_by_tolerance", R"("knots": "optimal", "minimise": "spectrum", "tolerance_db": 10)"),
      felt_with("compensated", kGraded, kCompensation),
      felt_with("live_exponent", kUniform, R"(, "live_exponent": { "min": 2.0, "max": 3.0, "members": 5 })"),
      law_with("lossy", R"({ "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5, "loss_s_per_m": 0.1 })"),
      law_with("sum", R"({ "sum": [ { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
                         { "stiffness_n_per_m_alpha": 1e8, "exponent": 1.5, "offset_m": 2e-4 } ] })"),
      law_with("series", R"({ "series": [ { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
                            { "stiffness_n_per_m_alpha": 3e6, "exponent": 1.4 } ] })"),
      law_with("hertz", R"({ "hertz": { "bodies": [
          { "shape": "sphere", "radius_m": 0.01, "youngs_modulus_pa": 1e9, "poisson_ratio": 0.3 },
          { "shape": "plane", "youngs_modulus_pa": 1e9, "poisson_ratio": 0.3 } ] } })"),
      law_with("measured_curve", R"({ "curve": { "file": "felt.csv", "shape": "monotone" } })")};
  for (const auto& [file, text] : embedded_files(Shipped::kMaterials)) {
    const std::string name(file.substr(0, file.rfind('.')));
    if (file.ends_with(".json")) cases.push_back({"shipped_" + name, name});
  }
  return cases;
}

class ScoreMaterial : public ::testing::TestWithParam<MaterialCase> {};

// A single stroke: the contact force is that of the model on the table that the library designs.
TEST_P(ScoreMaterial, PlaysOnAHammerWithItsOwnSpline) {
  const Design design = GetParam().design();
  Parts parts("string_c4", design);
  HammerString<double> model(parts.table, parts.modes, parts.at(parts.resonator.strike.position_m), kRate);
  std::vector<double> force;
  for (int n = 0; n < 1764; ++n) {
    if (n == 441) model.strike(2.5, 1e-4);
    model.tick({.hammer_mass_kg = design.material.impact->mass_kg, .felt = {1, design.material.loss_s_per_m}});
    force.push_back(model.force());
  }
  expect_is(sound_alone("hammer-string",
                        fmt::format(R"({{ "instrument": "hammer-string", "duration_s": 0.04,
                       "voices": [ {{ "name": "c4", "resonator": "string_c4", "material": "{}" }} ],
                       "events": [ {{ "time_s": 0.01, "speed_m_per_s": 2.5 }} ] }})",
                                    GetParam().key),
                        GetParam().files, {"--signal", "force"}),
            force);
}

// The slide falls on a string at rest.
TEST_P(ScoreMaterial, PlaysUnderASlideWithItsOwnSpline) {
  const Design design = GetParam().design();
  Parts parts("guitar_g3", design);
  SlideString<double> model(parts.table, parts.modes, StringShapes<double>(parts.wavenumbers), 0.5, kRate);
  model.place(0.2, 1e-3);
  std::vector<double> force;
  for (int n = 0; n < 1764; ++n) {
    model.tick({.place_m = 0.2,
                .slide_mass_kg = 0.04,
                .hand_force_n = 2,
                .hand_stiffness_n_per_m = 200,
                .hand_resistance_n_s_per_m = 2,
                .rest_resistance_n_s_per_m = 1,
                .contact = {1, design.material.loss_s_per_m}});
    force.push_back(model.force());
  }
  expect_is(sound_alone("slide-string",
                        fmt::format(R"({{ "instrument": "slide-string", "duration_s": 0.04,
                       "voices": [ {{ "name": "g", "resonator": "guitar_g3", "material": "{}", "pluck_m": 0.5,
                                      "pickup_m": 0.6, "height_m": 0.001 }} ],
                       "events": [ {{ "time_s": 0, "place_m": 0.2, "slide_mass_kg": 0.04, "hand_force_n": 2,
                                      "hand_stiffness_n_per_m": 200, "hand_resistance_n_s_per_m": 2,
                                      "rest_resistance_n_s_per_m": 1 }} ] }})",
                                    GetParam().key),
                        GetParam().files, {"--signal", "force"}),
            force, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Each, ScoreMaterial, ::testing::ValuesIn(material_cases()),
                         ::testing::PrintToStringParamName());

// Materials that differ in their splines only must not sound the same.
TEST(RenderScore, SoundsAsTheSplineOfItsMaterial) {
  std::vector<std::vector<double>> sounds;
  for (const auto& felt : {felt_with("uniform", kUniform), felt_with("graded", kGraded),
                           felt_with("optimal", R"("knots": "optimal", "segments": 8)"),
                           felt_with("in_force", R"("knots": "optimal", "segments": 8, "minimise": "force")"),
                           felt_with("in_spectrum", R"("knots": "optimal", "segments": 8, "minimise": "spectrum")"),
                           felt_with("tolerance", R"("knots": "uniform", "tolerance": 0.01)"),
                           felt_with("compensated", kGraded, kCompensation)})
    sounds.push_back(sound_alone("hammer-string", R"({ "instrument": "hammer-string", "duration_s": 0.04,
        "voices": [ { "name": "c4", "resonator": "string_c4", "material": "felt.json" } ],
        "events": [ { "time_s": 0.01, "speed_m_per_s": 2.5 } ] })",
                                 felt.files, {"--signal", "force"})
                         .samples);
  for (std::size_t i = 0; i < sounds.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_FALSE(sequences_within<double>(sounds[i], sounds[j], 100 * kLevel)) << i << " and " << j;
}

constexpr auto kTwoSlides = R"({ "instrument": "slide-string", "duration_s": 0.3,
    "voices": [ { "name": "g", "resonator": "guitar_g3", "material": "steel_on_steel", "pluck_m": 0.5,
                  "pickup_m": 0.6, "height_m": 0, "pan": -0.3 },
                { "name": "SECOND", "resonator": "guitar_b3", "material": "steel_on_steel", "pluck_m": 0.5,
                  "pickup_m": 0.6, "height_m": 0 } ],
    "events": [ { "time_s": 0, "place_m": 0.2, "slide_mass_kg": 0.04, "hand_force_n": 6,
                  "hand_stiffness_n_per_m": 200, "hand_resistance_n_s_per_m": 2, "rest_resistance_n_s_per_m": 1 },
                { "time_s": 0.05, "voice": "g", "pluck_n": 4 }, { "time_s": 0.1, "voice": "SECOND", "pluck_n": 3 } ] })";

std::string two_slides(const std::string& second_name) {
  std::string score = kTwoSlides;
  for (auto at = score.find("SECOND"); at != std::string::npos; at = score.find("SECOND"))
    score.replace(at, 6, second_name);
  return score;
}

// A centred voice alone has the two channels of the mix. Each file rounds to 24 bits; voices are summed in single
// precision.
TEST(RenderScore, WritesStemsThatAddUpToTheMix) {
  const Sandbox box;
  write_file(box / "probe.json", two_slides("b 2"));
  for (const Words& gain : {Words{}, Words{"--gain", "-40"}}) {
    const std::string report =
        succeed({.arguments = followed_by({"render", "slide-string", "--score", "probe.json", "-o", "mix.wav",
                                           "--no-figure", "--stems", "parts/of/it"},
                                          gain),
                 .folder = box.path()});
    EXPECT_TRUE(report.ends_with("sound:  mix.wav\nstems:  2 in parts/of/it\n")) << report;
    const Sound mix = read_sound(box / "mix.wav"), g = read_sound(box / "parts/of/it/g.wav"),
                b = read_sound(box / "parts/of/it/b 2.wav");
    ASSERT_EQ(mix.channels, 2);
    ASSERT_EQ(g.samples.size(), mix.samples.size());
    ASSERT_EQ(b.samples.size(), mix.samples.size());
    EXPECT_GT(g.peak(), 0.1 * mix.peak());
    EXPECT_GT(b.peak(), 0.1 * mix.peak());
    double worst = 0;
    for (std::size_t i = 0; i < mix.samples.size(); ++i)
      worst = std::max(worst, std::abs(g.samples[i] + b.samples[i] - mix.samples[i]));
    EXPECT_LE(worst, 3 * kLevel);
  }
}

TEST(RenderScore, RefusesStemsThatCannotBeWritten) {
  const auto refused = [](const std::string& name, const Words& more, const std::string& begins,
                          const std::string& says) {
    const Sandbox box;
    write_file(box / "probe.json", two_slides(name));
    fs::create_directories(box / "mine");
    write_file(box / "mine/g.wav", "my own file");
    const auto before = box.listing();
    expect_refused(run({.arguments = followed_by({"render", "slide-string", "--score", "probe.json", "-o", "mix.wav",
                                                  "--no-figure", "--stems"},
                                                 more),
                        .folder = box.path()}),
                   begins, says);
    EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  };
  refused("../b", {"parts"}, "probe.json: --stems: the name of voice '../b' cannot name a file",
          "allowed: names without / and control characters");
  refused("b", {"mine"}, "mine/g.wav: file: ", "allowed: ");
  refused("mix", {"."}, "./mix.wav: file: is already an input or another output",
          "allowed: another folder or file name");
  refused("b", {""}, "--stems: '' is refused", "allowed: a folder");
}

// Left and right of two keys of the piano are the sums of both, by the law of equal power.
TEST(RenderScore, SumsAndPansVoices) {
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  std::vector<double> expected(2 * 4410);
  for (const int key : {40, 88}) {
    KeyboardNote note = note_of(keyboard, key);
    const auto set = modes_of(note, kRate / 2);
    std::vector<Mode> modes;
    ModeShapes<double> strike(set.size()), bridge(set.size());
    for (std::size_t i = 0; i < set.size(); ++i) {
      modes.push_back(set[i].mode);
      strike[i] = set[i].strike_shape;
      bridge[i] = set[i].pickup_shape;
    }
    const auto felt = segment_table(design_spline(note.felt, "felt"));
    HammerString<double> model(felt, modes, strike, kRate);
    bridge = model.string().sound_pickup(bridge);
    const double angle = (0.6 * ((key - 21) / 43.5 - 1) + 1) * pi / 4;
    for (int n = 0; n < 4410; ++n) {
      if (n == 441) model.strike(key == 40 ? 2.0 : 3.0, 1e-4);
      model.tick({.hammer_mass_kg = note.hammer_mass_kg, .felt = {1, 0.1}, .damping_per_s = n < 441 ? 60.0 : 0.0});
      const double output = note.strings * model.string().displacement(bridge);
      expected[static_cast<std::size_t>(2 * n)] += std::cos(angle) * output;
      expected[static_cast<std::size_t>(2 * n + 1)] += std::sin(angle) * output;
    }
  }
  const Sound sound = sound_of("hammer-string", R"({
    "instrument": "hammer-string", "duration_s": 0.1, "keyboard": "piano",
    "events": [ { "time_s": 0.01, "key": 88, "speed_m_per_s": 3 }, { "time_s": 0.01, "key": 40, "speed_m_per_s": 2 } ] })",
                               {"--signal", "bridge"});
  EXPECT_EQ(sound.channels, 2);
  expect_is(sound, expected, 3 * kLevel);  // each voice and their sum are rounded to single precision
}

// The phase of a decaying partial advances from one window to the next, half a second later: by exactly w/2 whatever
// its decay. Other partials, 260 Hz away and more, leak by the side lobes of the window (Blackman-Harris, 4 terms,
// below -92 dB and falling); the widest angle that makes is given by the check on sines of known frequency.
double frequency_near(const std::vector<double>& samples, double guess_hz) {
  const int window = 22050, shift = 22050, begin = 8820;
  std::complex<double> views[2];
  for (int view = 0; view < 2; ++view)
    for (int n = 0; n < window; ++n) {
      const double angle = 2 * pi * (n + 0.5) / window;
      const double weight =
          0.35875 - 0.48829 * std::cos(angle) + 0.14128 * std::cos(2 * angle) - 0.01168 * std::cos(3 * angle);
      const double phase = -2 * pi * guess_hz * n / kRate;
      views[view] += weight * samples[static_cast<std::size_t>(begin + view * shift + n)] * std::polar(1.0, phase);
    }
  const double advance = std::arg(views[1] / views[0] * std::polar(1.0, -2 * pi * guess_hz * shift / kRate));
  return guess_hz + advance / (2 * pi) * kRate / shift;
}

/// One track, 96 ticks a quarter of 0.5 s.
std::string midi_file(const std::string& events) {
  const std::string track = events + std::string("\0\xff\x2f\0", 4);
  return std::string("MThd\0\0\0\6\0\0\0\1\0\x60MTrk\0\0\0", 21) + static_cast<char>(track.size()) + track;
}

Sound sound_of_midi(const std::string& events, const Words& options = {}) {
  const Sandbox box;
  write_file(box / "probe.mid", midi_file(events));
  const Words words = {"render", "hammer-string", "--score", "probe.mid", "-o", "a.wav", "--no-figure"};
  succeed({.arguments = followed_by(words, options), .folder = box.path()});
  return read_sound(box / "a.wav");
}

using Piano = KeyboardInstrument<keyboards::piano, double>;

/// The piano of the runtime in stereo, played to a sample before something happens.
struct PlayedPiano {
  void play_to(std::size_t sample) {
    std::vector<double> left(sample - sound.size() / 2), right(left.size());
    piano.process(left, right);
    for (std::size_t n = 0; n < left.size(); ++n) sound.insert(sound.end(), {left[n], right[n]});
  }

  Piano piano{kRate, 4096};
  std::vector<double> sound = {};
};

// A score and a MIDI file on the piano's soundboard are what the piano of the runtime, as plug-ins play it, makes of
// the same events: every pedal, a half pedal, a string that is bent. The header holds the numbers of the board to 13
// digits.
TEST(RenderScore, PlaysTheKeyboardInstrument) {
  const auto at = [](double time_s) { return static_cast<std::size_t>(std::llround(time_s * kRate)); };
  const auto played = [&](const std::vector<std::pair<double, std::function<void(Piano&)>>>& events, double end_s) {
    PlayedPiano one;
    for (const auto& [time_s, act] : events) one.play_to(at(time_s)), act(one.piano);
    one.play_to(at(end_s));
    return one.sound;
  };
  const double tick_s = 0.5 / 96;
  std::vector<std::pair<double, std::function<void(Piano&)>>> events = {
      {0, [](Piano& p) { p.una_corda(1), p.note_on(60, 64 / 127.0); }},
      {10 * tick_s, [](Piano& p) { p.una_corda(40 / 127.0), p.note_on(36, 90 / 127.0); }},
      {20 * tick_s, [](Piano& p) { p.sustain(100 / 127.0), p.note_off(60); }},
      {30 * tick_s, [](Piano& p) { p.sostenuto(true), p.note_on(60, 1); }},
      {40 * tick_s, [](Piano& p) { p.note_off(36); }},
      {60 * tick_s, [](Piano& p) { p.sustain(0); }}};
  for (double step_s = 0; step_s < 0.01; step_s += 16 / kRate)  // of the 10 ms in which the string follows the wheel
    events.emplace_back(70 * tick_s + step_s, [=](Piano& p) {
      const double part = step_s * kRate / 441;
      for (const unsigned key : {15u, 39u}) p.bend(key, 100 * part * part * (3 - 2 * part));
    });
  events.emplace_back((static_cast<double>(at(70 * tick_s)) + 448) / kRate,
                      [](Piano& p) { p.bend(15, 100), p.bend(39, 100); });
  events.emplace_back(120 * tick_s, [](Piano& p) { p.sostenuto(false), p.note_off(60); });
  const auto midi = played(events, 120 * tick_s + 1);
  const std::string bytes(
      "\0\xb0\x43\x7f\0\x90\x3c\x40\x0a\xb0\x43\x28\0\x90\x24\x5a\x0a\xb0\x40\x64\0\x80\x3c\0\x0a\xb0\x42\x7f\0"
      "\x90\x3c\x7f\x0a\x80\x24\0\x14\xb0\x40\0\x0a\xe0\0\x60\x32\xb0\x42\0\0\x80\x3c\0",
      52);
  expect_is(sound_of_midi(bytes), midi);
  const auto score = played({{0.01, [](Piano& p) { p.una_corda(0.5); }},
                             {0.02,
                              [](Piano& p) {
                                p.strike_at(67, 0.004);
                                p.set_hammers(2, {0.5, 0.2});
                                p.strike(67, 3);
                                p.set_hammers(1, {1, 0.1});
                                p.press(12);
                                p.strike(19, 2);
                              }},
                             {0.1, [](Piano& p) { p.release(67), p.damp(19, 30); }},
                             {0.2, [](Piano& p) { p.sostenuto(true), p.release(12); }}},
                            0.3);
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  const std::string text = fmt::format(
      R"({{ "instrument": "hammer-string", "duration_s": 0.3, "keyboard": "piano", "events": [
    {{ "time_s": 0.1, "key": 40, "damping_per_s": 30 }}, {{ "time_s": 0.02, "key": 40, "speed_m_per_s": 2 }},
    {{ "time_s": 0.02, "key": 88, "speed_m_per_s": 3, "hold_s": 0.08, "strike_m": 0.004, "hammer_mass_kg": {},
      "stiffness_ratio": 0.5, "loss_s_per_m": 0.2 }},
    {{ "time_s": 0.01, "una_corda": 0.5 }}, {{ "time_s": 0.02, "key": 33, "hold_s": 0.18 }},
    {{ "time_s": 0.2, "sostenuto": 1 }} ] }})",
      2 * note_of(keyboard, 88).hammer_mass_kg);
  const Sound sound = sound_of("hammer-string", text);
  EXPECT_EQ(sound.channels, 2);
  expect_is(sound, score);
  expect_is(sound_of("hammer-string", text, {"--precision", "single"}), score, 1e-3);
}

// Energy of the left channel from one time to another.
double energy_of(const Sound& sound, double from_s, double to_s) {
  double energy = 0;
  for (auto n = static_cast<std::size_t>(from_s * kRate); n < static_cast<std::size_t>(to_s * kRate); ++n)
    energy += std::pow(sound.samples[2 * n], 2);
  return energy;
}

// C4 for 2.4 s, with the soft pedal up and down.
TEST(RenderScore, PlaysUnaCorda) {
  const auto sound = [](char soft) {
    std::string events("\0\xb0\x43\0\0\x90\x3c\x40\x83\x60\x80\x3c\0", 13);
    events[3] = soft;
    return sound_of_midi(events, {"--gain", "20"});
  };
  const Sound up = sound(0), half = sound(64), down = sound(127);
  const auto pitch_hz = [](const Sound& of) {
    std::vector<double> left;
    for (std::size_t i = 0; i < of.samples.size(); i += 2) left.push_back(of.samples[i]);
    return frequency_near(left, 261.8);
  };
  // The strings are within 0.9 cents of each other; the two that are struck beside the one that is not, too.
  EXPECT_TRUE(within(1200 * std::log2(pitch_hz(down) / pitch_hz(up)), 0, 0.9));
  const auto level_db = [&](const Sound& of) {
    return 10 * std::log10(energy_of(of, 0, 0.3) / energy_of(up, 0, 0.3));
  };
  std::cout << "half down " << level_db(half) << " dB, down " << level_db(down) << " dB\n";
  EXPECT_LT(level_db(down), level_db(half) - 1);
  EXPECT_LT(level_db(half), -0.2);
  EXPECT_GT(level_db(down), -6);
}

// C3 is held down without a sound while C4 is struck and damped: its second partial rings on. Half down, the sustain
// pedal lets C4 decay in between.
TEST(RenderScore, RingsInSympathyAndByHalfPedal) {
  const auto energy = [](const std::string& first_event) {
    return energy_of(
        sound_alone("hammer-string",
                    R"({ "instrument": "hammer-string", "duration_s": 1.1, "keyboard": "piano", "events": [
      { "time_s": 0.01, "key": 60, "speed_m_per_s": 3, "hold_s": 0.1 }, )" +
                        first_event + " ] }",
                    {}, {"--gain", "20"}),
        0.6, 1);
  };
  const double damped = energy(R"({ "time_s": 0, "key": 48, "damping_per_s": 0 })"),
               sympathetic = energy(R"({ "time_s": 0, "key": 48, "hold_s": 1 })"),
               half = energy(R"({ "time_s": 0, "sustain": 0.9 })"), held = energy(R"({ "time_s": 0, "sustain": 1 })");
  std::cout << "damped " << 10 * std::log10(damped / held) << " dB, C3 in sympathy "
            << 10 * std::log10(sympathetic / held) << " dB, half pedal " << 10 * std::log10(half / held) << " dB\n";
  EXPECT_GT(sympathetic, 1000 * damped);
  EXPECT_LT(sympathetic, 0.5 * held);
  // The mean of exp(-2 (1 - 0.9) 60/s t) from 0.5 to 0.9 s after the release; the dampers take some ms to fall, and
  // what rings undamped above the last damper stays.
  EXPECT_TRUE(within(10 * std::log10(half / held), 10 * std::log10((std::exp(-6.0) - std::exp(-10.8)) / 4.8), 2));
}

// Beside the body there are no pedals but the sustain pedal of MIDI files, which holds notes.
TEST(RenderScore, SaysWhichPedalsAreLeftOut) {
  const Sandbox box;
  const std::string note("\0\x90\x3c\x40\x60\x80\x3c\0", 8);
  write_file(box / "soft.mid", midi_file(std::string("\0\xb0\x43\x7f", 4) + note));
  write_file(box / "half.mid", midi_file(std::string("\0\xb0\x40\x41", 4) + note));
  write_file(box / "held.mid", midi_file(std::string("\0\xb0\x40\x7f", 4) + note));
  write_file(box / "score.json", R"({ "instrument": "hammer-string", "duration_s": 0.1, "keyboard": "piano",
    "events": [ { "time_s": 0, "sustain": 1 }, { "time_s": 0, "key": 60, "speed_m_per_s": 1 } ] })");
  const std::string why = ": left out, because only the keys on their body have them: ";
  for (const auto& [file, says] : {std::pair{"soft.mid", "half pedal, sostenuto and soft pedal"},
                                   {"half.mid", "half pedal, sostenuto and soft pedal"},
                                   {"held.mid", ""},
                                   {"score.json", "pedals"}})
    for (const std::string signal : {"body", "bridge"}) {
      const auto outcome = run({.arguments = {"render", "hammer-string", "--score", file, "--signal", signal,
                                              "--no-figure", "-o", "a.wav"},
                                .folder = box.path()});
      EXPECT_EQ(outcome.exit_code, 0);
      EXPECT_EQ(outcome.err, signal == "body" || *says == 0 ? "" : "contactspline: " + (file + why) + says + "\n");
    }
}

// A body that is silent at this rate is named. Of a keyboard beside the score.
TEST(RenderScore, RefusesABodyThatCannotSound) {
  const Sandbox box;
  std::string keyboard = shipped(embedded_files(Shipped::kKeyboards), "piano");
  keyboard.replace(keyboard.find("\"soundboard\""), 12, "\"board.json\"");
  write_file(box / "piano.json", keyboard);
  write_file(box / "board.json", R"({ "name": "board", "modes": [
    { "frequency_hz": 30000, "decay_per_s": 5, "mass_kg": 1, "strike_shape": 1, "pickup_shape": 1 } ] })");
  write_file(box / "probe.json", R"({ "instrument": "hammer-string", "duration_s": 0.1, "keyboard": "piano.json",
    "events": [ { "time_s": 0.01, "key": 60, "speed_m_per_s": 3 } ] })");
  const auto before = box.listing();
  expect_refused(
      run({.arguments = {"render", "hammer-string", "--score", "probe.json", "-o", "a.wav"}, .folder = box.path()}),
      "--rate: no mode of board lies below 22050 Hz", "allowed: a higher rate");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
  for (const auto& [name, wrong] :
       {std::pair{"felt_c4", "'felt_c4' is a material"}, {"bord", "'bord' does not ship"}}) {
    std::string other = keyboard;
    other.replace(other.find("board.json"), 10, name);
    write_file(box / "piano.json", other);
    expect_refused(
        run({.arguments = {"render", "hammer-string", "--score", "probe.json", "-o", "a.wav"}, .folder = box.path()}),
        std::string("piano.json: keyboard.body.resonator: ") + wrong, "allowed: a .json file, drum_head");
  }
}

// Stems of a keyboard on its body: the dampers of all keys move as in the whole, so that their sum lacks only what
// one hammer's contact changes in another. Keys 60 and 48 share a board; every partial of C3 that C4 has rings with
// it.
TEST(RenderScore, StemsOfABodyAddUp) {
  const Sandbox box;
  write_file(box / "probe.json", R"({ "instrument": "hammer-string", "duration_s": 1, "keyboard": "piano",
    "events": [ { "time_s": 0.01, "key": 60, "speed_m_per_s": 3, "hold_s": 0.5 },
                { "time_s": 0.01, "key": 48, "speed_m_per_s": 2, "hold_s": 0.8 } ] })");
  succeed({.arguments = {"render", "hammer-string", "--score", "probe.json", "-o", "mix.wav", "--no-figure", "--gain",
                         "0", "--stems", "stems"},
           .folder = box.path()});
  const Sound mix = read_sound(box / "mix.wav"), low = read_sound(box / "stems/48.wav"),
              high = read_sound(box / "stems/60.wav");
  double rest = 0, whole = 0, of_one = 0;
  for (std::size_t i = 0; i < mix.samples.size(); ++i) {
    rest += std::pow(mix.samples[i] - low.samples[i] - high.samples[i], 2);
    whole += mix.samples[i] * mix.samples[i];
    of_one += low.samples[i] * low.samples[i];
  }
  const double level = 10 * std::log10(rest / whole);
  std::cout << "mix less stems: " << level << " dB\n";
  EXPECT_GT(of_one, 0.01 * whole);
  EXPECT_LT(level, -50);
}

TEST(RenderScore, FindsFilesBesideTheScore) {
  const Sandbox box;
  fs::create_directories(box / "music");
  write_file(box / "music/string.json", shipped(embedded_files(Shipped::kResonators), "string_c4"));
  write_file(box / "music/felt.json", shipped(embedded_files(Shipped::kMaterials), "felt_c4"));
  std::string score = kHammerScore;
  score.replace(score.find("\"string_c4\""), 11, "\"string.json\"");
  score.replace(score.find("\"felt_c4\""), 9, "\"./felt.json\"");
  write_file(box / "music/probe.json", score);
  succeed(
      {.arguments = {"render", "hammer-string", "--score", "music/probe.json", "-o", "a.wav"}, .folder = box.path()});
  EXPECT_EQ(read_sound(box / "a.wav").samples, sound_of("hammer-string", kHammerScore).samples);
}

TEST(RenderScore, HasTheRateAskedFor) {
  for (const int rate : {8000, 48000, 192000}) {
    const Sound sound = sound_of("hammer-string", kHammerScore, {"--rate", fmt::format("{}", rate)});
    EXPECT_EQ(sound.rate, rate);
    EXPECT_EQ(sound.samples.size(), static_cast<std::size_t>(0.4 * rate));
  }
}

Words words_of(const std::string& line) {
  std::istringstream stream(line);
  return {std::istream_iterator<std::string>(stream), {}};
}

// Every shipped score: about ten seconds of sound, in stereo if its voices are panned, never silent for half a second
// before the last two, no sample at full scale, all of it gone at the end.
class ShippedScore : public ::testing::TestWithParam<EmbeddedFile> {};

TEST_P(ShippedScore, Plays) {
  const Sandbox box;
  const auto& [file, text] = GetParam();
  const std::string list = succeed({.arguments = {"list", "scores"}});
  const std::string name(file.substr(0, file.rfind('.')));
  const bool is_midi = file.ends_with(".mid");
  const auto line = list.substr(list.find("\n" + name + " ") + 1);
  const std::string instrument = words_of(line).at(1);
  succeed({.arguments = {"render", instrument, "--score", name, "-o", name + ".wav"}, .folder = box.path()});
  expect_drawn(box / (name + ".svg"), 3);
  const Sound sound = read_sound(box / (name + ".wav"));
  const bool is_panned = text.find("\"pan\"") != text.npos || text.find("\"keyboard\"") != text.npos || is_midi;
  EXPECT_EQ(sound.channels, is_panned ? 2 : 1);
  EXPECT_TRUE(within(sound.peak(), kPeak, kLevel));
  const std::ptrdiff_t half_second = 22050 * sound.channels;
  const std::ptrdiff_t stretches = std::ssize(sound.samples) / half_second;
  EXPECT_TRUE(within(static_cast<double>(stretches), 24, 5));
  for (std::ptrdiff_t i = 0; i < stretches; ++i) {
    const auto begin = sound.samples.begin() + i * half_second;
    double loudest = 0;
    for (auto at = begin; at != begin + half_second; ++at) loudest = std::max(loudest, std::abs(*at));
    EXPECT_TRUE(loudest > 0.01 || i + 4 >= stretches) << "at " << 0.5 * static_cast<double>(i) << " s";
  }
  double last = 0;
  for (auto at = sound.samples.end() - 4410; at != sound.samples.end(); ++at) last = std::max(last, std::abs(*at));
  EXPECT_LT(last, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Each, ShippedScore, ::testing::ValuesIn(embedded_files(Shipped::kScores)),
                         [](const auto& score) {
                           return std::string(score.param.name.substr(0, score.param.name.rfind('.')));
                         });

TEST(RenderScore, HasFiveScoresThatShip) {
  EXPECT_GE(embedded_files(Shipped::kScores).size(), 5u);
}

TEST(RenderScore, PlaysTheExamplesOfTheDocs) {
  const std::string page = read_file(fs::path(SOURCE_FOLDER) / "docs/scores.md"), fence = "```json\n";
  int examples = 0;
  for (auto at = page.find(fence); at != std::string::npos; at = page.find(fence, at + 1), ++examples) {
    const auto begin = at + fence.size();
    const std::string score = page.substr(begin, page.find("```", begin) - begin);
    const bool slides = score.find("slide-string") != std::string::npos;
    EXPECT_TRUE(within(sound_of(slides ? "slide-string" : "hammer-string", score).peak(), kPeak, kLevel)) << score;
  }
  EXPECT_EQ(examples, 3);
}

// C4 with the wheel a quarter of its range up, and E4 of the second channel with it all the way down.
TEST(RenderScore, BendsThePitchOfMidiNotes) {
  const std::string events("\0\xe0\0\x50\0\xe1\0\0\0\x90\x3c\x40\0\x91\x40\x40\x83\x60\x80\x3c\0\0\x81\x40\0", 25);
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  for (const auto& [channel, key, bend] : {std::tuple{"1", 60, 50.0}, std::tuple{"2", 64, -200.0}}) {
    const Sound sound = sound_of_midi(events, {"--channel", channel, "--signal", "bridge"});
    std::vector<double> left;
    for (std::size_t i = 0; i < sound.samples.size(); i += 2) left.push_back(sound.samples[i]);
    StiffString string = note_of(keyboard, key).string;
    string.tension_n *= std::exp2(bend / 600);  // frequency is proportional to its square root
    const Mode lowest = undamped_mode(string, 1, string.detuning_cents.front()).with(string.losses).value();
    const double expected = lowest.angular_frequency_rad_per_s / (2 * pi);
    EXPECT_TRUE(within(1200 * std::log2(frequency_near(left, expected + 0.2) / expected), 0, 0.1)) << key;
  }
}

// An octave up and down every millisecond: the blow stays the loudest. Bends that did any work would drown it.
TEST(RenderScore, IsNotPumpedByBends) {
  std::string events = R"({ "time_s": 0, "speed_m_per_s": 5 })";
  for (int n = 0; n < 400; ++n)
    events += fmt::format(R"(, {{ "time_s": {}, "bend_cents": {} }})", 0.05 + 0.001 * n, n % 2 == 0 ? -1200 : 1200);
  const Sound sound = sound_of("hammer-string", R"({ "instrument": "hammer-string", "duration_s": 0.5, "voices": [ {
    "name": "a", "resonator": "string_c4", "material": "felt_c4" } ], "events": [ )" +
                                                    events + " ] }");
  double blow = 0;
  for (std::size_t n = 0; n < 2205; ++n) blow = std::max(blow, std::abs(sound.samples[n]));
  EXPECT_GT(blow, 0.5 * kPeak);
}

// In the middle of a note, by the pitch wheel of a MIDI file, and by a score: the string sounds at the pitch of its
// new tension, to which it glides.
TEST(RenderScore, BendsASoundingString) {
  const Sandbox box;
  // C4 for 1.8 s of 96 ticks a quarter of 0.5 s; the wheel goes up by 2 semitones after 52 ms.
  write_file(box / "bend.mid", midi_file(std::string("\0\x90\x3c\x40\x0a\xe0\x7f\x7f\x82\x5a\x80\x3c\0", 13)));
  write_file(box / "bend.json",
             R"({ "instrument": "hammer-string", "duration_s": 2.5, "keyboard": "piano", "events": [
      { "time_s": 0, "key": 60, "speed_m_per_s": 2.5, "hold_s": 1.8 },
      { "time_s": 0.05, "over_s": 0.1, "key": 60, "bend_cents": -1200 } ] })");
  const auto keyboard = parse_keyboard(shipped(embedded_files(Shipped::kKeyboards), "piano"), "piano");
  // At rest the bridge shifts no partial. The soundboard shifts it by at most 5 cents (docs/keyboard.md), and strings
  // of one key are 0.9 cents apart.
  for (const auto& [signal, bound] : {std::pair{"bridge", 0.1}, {"body", 5.9}})
    for (const auto& [file, bend] : {std::pair{"bend.mid", 200.0 * 8191 / 8192}, std::pair{"bend.json", -1200.0}}) {
      succeed({.arguments = {"render", "hammer-string", "--score", file, "--signal", signal, "--no-figure", "-o",
                             "a.wav"},
               .folder = box.path()});
      const Sound sound = read_sound(box / "a.wav");
      std::vector<double> left;
      for (std::size_t i = 0; i < sound.samples.size(); i += 2) left.push_back(sound.samples[i]);
      StiffString string = note_of(keyboard, 60).string;
      string.tension_n *= std::exp2(bend / 600);
      const Mode lowest = undamped_mode(string, 1, string.detuning_cents.front()).with(string.losses).value();
      const double expected = lowest.angular_frequency_rad_per_s / (2 * pi);
      EXPECT_TRUE(within(1200 * std::log2(frequency_near(left, expected + 0.2) / expected), 0, bound))
          << file << signal;
    }
}

// C4's partials up to the 24th as written by the program, both precisions, against the formula of the stiff string.
TEST(RenderScore, IsInTune) {
  const double length = 0.62, mass = 0.00393, tension = 670, bending = 0.00983833;
  std::vector<double> frequencies, decays;
  for (int i = 1; i <= 24; ++i) {
    const double beta = i * pi / length;
    const double square = beta * beta * (tension + bending * beta * beta) * length / mass;
    decays.push_back(0.5 + 1e-4 * beta * beta);
    frequencies.push_back(std::sqrt(square - decays.back() * decays.back()) / (2 * pi));
  }
  std::vector<double> known(66150);
  for (std::size_t n = 0; n < known.size(); ++n)
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      known[n] += std::exp(-decays[i] * static_cast<double>(n) / kRate) / static_cast<double>(1 + i) *
                  std::cos(2 * pi * frequencies[i] * static_cast<double>(n) / kRate);
  const auto cents = [](double found, double expected) { return 1200 * std::log2(found / expected); };
  for (std::size_t i = 0; i < frequencies.size(); ++i)
    EXPECT_TRUE(within(cents(frequency_near(known, frequencies[i] + 0.2), frequencies[i]), 0, 1e-3)) << i + 1;
  for (const std::string precision : {"double", "single"}) {
    const Sound sound = sound_of("hammer-string", R"({
      "instrument": "hammer-string", "duration_s": 1.5,
      "voices": [ { "name": "c4", "resonator": "string_c4", "material": "felt_c4" } ],
      "events": [ { "time_s": 0, "speed_m_per_s": 2.5 } ] })",
                                 {"--precision", precision});
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      EXPECT_TRUE(within(cents(frequency_near(sound.samples, frequencies[i] + 0.2), frequencies[i]), 0, 0.1))
          << precision << ", partial " << i + 1;
  }
}

}  // namespace
}  // namespace contactspline::testing
