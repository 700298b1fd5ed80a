// SPDX-License-Identifier: MIT
// The Faust programs of random instruments against the runtime's class on the same arrays.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "contactspline/instrument/instrument.hpp"
#include "contactspline/modal/mode.hpp"
#include "faust_command.hpp"
#include "generator/emit/emit_instrument.hpp"
#include "generator/emit/emit_instrument_faust.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"
#include "native_program.hpp"
#include "random_instrument.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kMaxFrequency = 22050;
constexpr std::size_t kSamples = 1500;

/// A slider or a button that is moved at a sample.
struct Move {
  std::size_t sample;
  std::string label;
  double value;
};

struct Case {
  std::string file;
  InstrumentModel model;
  InstrumentArrays arrays;
  std::vector<Move> moves;
  int sample_rate_hz;
  std::size_t samples = kSamples;
};

// When a control moves: forces and speeds of friction jump seven times.
std::vector<std::size_t> samples_of_moves(ControlQuantity quantity) {
  if (quantity != ControlQuantity::kNormalForce && quantity != ControlQuantity::kSurfaceSpeed) return {0, 37 * 22};
  return {0, 37 * 4, 37 * 8, 37 * 13, 37 * 19, 37 * 26, 37 * 34};
}

// The strike of every mass, and what each control is before and after sample 800.
std::vector<Move> moves_of(const InstrumentModel& model, RandomInstruments& random) {
  std::vector<Move> moves;
  for (std::size_t s = 0; s < model.strikes.size(); ++s) {
    const std::size_t sample = 37 * (1 + 5 * s);
    const ModelEvent& strike = model.events[s];
    moves.push_back({sample, model.parameters[strike.parameter].name, random.number(0.01, 10, 0.01, 10)});
    moves.push_back({sample, strike.name, 1});
  }
  for (std::size_t c = 0; c < model.controls.size(); ++c)
    for (const std::size_t sample : samples_of_moves(model.controls[c].quantity)) {
      if (sample != 0 && random.integer(0, 1) == 0) continue;
      double value = 0;
      switch (model.controls[c].quantity) {
        case ControlQuantity::kForce:
          value = random.uniform(-2, 2);
          break;
        case ControlQuantity::kDamping:
          value = random.number(1, 1e4, 0, model.parameters[c].slider.max);
          break;
        case ControlQuantity::kStiffnessRatio:
          value = random.number(0.1, 10, 0.01, 100);
          break;
        case ControlQuantity::kLoss:
          value = random.number(0.01, 10, 0, 100);
          break;
        case ControlQuantity::kGapShift:
          value = random.uniform(-1e-3, 1e-3);
          break;
        case ControlQuantity::kStiffness:
          value = random.number(1, 1e6, 0, model.parameters[c].slider.max);
          break;
        case ControlQuantity::kResistance:
          value = random.number(1e-3, 100, 0, model.parameters[c].slider.max);
          break;
        case ControlQuantity::kNormalForce:
          value = random.number(0.01, 10, 0, 1000);
          break;
        case ControlQuantity::kSurfaceSpeed:
          value = random.uniform(-1, 1);
          break;
        case ControlQuantity::kPlace:
        case ControlQuantity::kMass:
          ADD_FAILURE() << "no Faust program has such a control";
          break;
      }
      moves.push_back({sample, model.parameters[c].name, value});
    }
  return moves;
}

// Does each connection join places of which one moves? Modes that are silent at the sample rate do not.
bool all_connections_move(const Case& drawn) {
  const InstrumentArrays& arrays = drawn.arrays;
  std::vector<double> receptances = {};
  for (std::size_t p = 0, shape = 0; p < arrays.place_bodies.size(); ++p) {
    const std::size_t body = arrays.place_bodies[p];
    double sum = 0;
    for (std::size_t i = body == 0 ? 0 : arrays.body_ends[body - 1]; i < arrays.body_ends[body]; ++i, ++shape) {
      const Mode mode{arrays.angular_frequencies[i], arrays.decays[i], arrays.masses[i]};
      if (mode.angular_frequency_rad_per_s < std::numbers::pi * drawn.sample_rate_hz)
        sum += detail::mode_constants(mode, double(drawn.sample_rate_hz)).receptance * arrays.shapes[shape] *
               arrays.shapes[shape];
    }
    receptances.push_back(sum);
  }
  const auto at = [&](std::size_t place) { return place == kGround ? 0 : receptances[place]; };
  return std::ranges::all_of(arrays.connections, [&](const InstrumentConnection& connection) {
    return at(connection.first) + at(connection.second) > 1e-16;
  });
}

std::string read_material(const std::string& path) {
  if (path != "two_memories.json") return shipped_file(path);
  return R"({
    "name": "two_memories",
    "contact": {
      "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5,
      "memory": [{ "weight": 0.5, "relaxation_time_s": 2e-3 }, { "weight": 0.3, "relaxation_time_s": 1e-4 }]
    },
    "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6 },
    "spline": { "knots": "uniform", "segments": 12 }
  })";
}

Case next_case(RandomInstruments& random) {
  constexpr int kRates[] = {8000, 22050, 44100, 96000, 192000, 768000};
  for (;;) {
    std::string file = random.next();
    try {
      InstrumentModel model = parse_instrument(file, "random.json", read_material);
      InstrumentArrays arrays = arrays_of(model, kMaxFrequency);
      if (faust_obstacle(model, arrays)) continue;
      std::vector<Move> moves = moves_of(model, random);
      Case drawn{std::move(file), std::move(model), std::move(arrays), std::move(moves),
                 kRates[random.integer(0, 5)]};
      if (all_connections_move(drawn) || random.integer(0, 4) == 0) return drawn;
    } catch (const BadInput&) {
      continue;  // a link that closes a circle, for instance
    }
  }
}

// The outputs of the class over their full scales, [output][sample]. All speeds and controls are multiplied by
// `factor`.
Signals<double> sound_of_class(const Case& drawn, double factor) {
  BySample<double> instrument(drawn.arrays.view(), drawn.sample_rate_hz);
  const double glide = -std::expm1(-1 / (0.005 * drawn.sample_rate_hz));
  const auto& controls = drawn.model.controls;
  const auto& parameters = drawn.model.parameters;
  std::vector<double> targets, values, speeds(drawn.model.strikes.size(), 2.5);
  for (std::size_t c = 0; c < controls.size(); ++c) targets.push_back(parameters[c].initial);
  Signals<double> sound(drawn.arrays.outputs.size());
  for (std::size_t n = 0; n < drawn.samples; ++n) {
    for (const Move& move : drawn.moves) {
      if (move.sample != n) continue;
      for (std::size_t c = 0; c < controls.size(); ++c)
        if (parameters[c].name == move.label) targets[c] = factor * move.value;
      for (std::size_t s = 0; s < speeds.size(); ++s) {
        const ModelEvent& strike = drawn.model.events[s];
        if (parameters[strike.parameter].name == move.label) speeds[s] = factor * move.value;
        if (strike.name == move.label) instrument.strike(s, speeds[s]);
      }
    }
    if (n == 0) values = targets;
    for (std::size_t c = 0; c < controls.size(); ++c) {
      values[c] = parameters[c].glide_s > 0 ? values[c] + glide * (targets[c] - values[c]) : targets[c];
      instrument.set(c, values[c]);
    }
    instrument.tick();
    for (std::size_t o = 0; o < sound.size(); ++o)
      sound[o].push_back(instrument.output(o) / drawn.arrays.outputs[o].full_scale);
  }
  return sound;
}

// A control that no output hears is not there: Faust leaves it out.
void set_if_heard(CProgram<double>& program, const Move& move) {
  try {
    program.set(move.label, move.value);
  } catch (const std::out_of_range&) {
  }
}

// The outputs of the program, from the second sample on.
Signals<double> sound_of_program(const Case& drawn, CProgram<double> program) {
  Signals<double> sound(drawn.arrays.outputs.size());
  for (std::size_t n = 0; n < drawn.samples + 37; n += 37) {
    for (const Move& move : drawn.moves)
      if (move.sample == n) set_if_heard(program, move);
    const Signals<double> block = program.run({}, 37);
    for (std::size_t o = 0; o < sound.size(); ++o) sound[o].insert(sound[o].end(), block[o].begin(), block[o].end());
  }
  for (auto& channel : sound) {
    channel.erase(channel.begin());
    channel.resize(drawn.samples);
  }
  return sound;
}

const Emitter& faust_emitter() {
  return *std::ranges::find(emitters(), "faust", &Emitter::name);
}

// The programs of all cases, as one shared library of classes random_0, random_1, ...
Library compiled(const std::vector<Case>& cases, const std::filesystem::path& folder) {
  std::ostringstream compile;
  compile << kCCompiler << " -O0 -w -shared -fPIC -DFAUSTFLOAT=double -include " << kFaustTests << "/c_glue.h -o "
          << folder / "programs.so";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const std::string name = "random_" + std::to_string(i);
    const auto program = folder / (name + ".lib"), source = folder / (name + ".c");
    std::ofstream(program) << emit(faust_emitter(), cases[i].model, kMaxFrequency, "test");
    const Outcome outcome = run_faust_compiler("-t 900 -lang c -double -cn " + name, program, source);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output << cases[i].file;
    compile << ' ' << source;
  }
  compile << " -lm";
  const Outcome outcome = run(compile.str());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
  return Library(folder / "programs.so");
}

double peak(const std::vector<double>& sound) {
  double peak = 0;
  for (const double x : sound) peak = std::max(peak, std::abs(x));
  return peak;
}

/// How far a program is from the class in an output, and how far the class itself from one whose speeds and controls
/// are larger by some roundings: a contact that rattles amplifies them with each bounce.
struct Agreement {
  double error = 0;  // of the peak
  bool rattles = false;
  bool holds = true;  // within 1e-9, or within what rattling explains
};

Agreement agreement(const std::vector<double>& found, const std::vector<double>& expected,
                    const std::vector<double>& moved) {
  Agreement result;
  const double largest = std::max(peak(expected), std::numeric_limits<double>::min());
  double sensitivity = 0;
  for (std::size_t n = 0; n < expected.size(); ++n) {
    const double error = std::abs(found[n] - expected[n]) / largest;
    sensitivity = std::max(sensitivity, std::abs(moved[n] - expected[n]) / largest);
    if (!(error <= std::max(1e-9, 30 * sensitivity))) result.holds = false;
    result.error = std::max(result.error, error);
  }
  result.rattles = 30 * sensitivity > 1e-9;
  return result;
}

/// What became of all cases.
struct Summary {
  std::size_t compared = 0, rattling = 0, unfinished = 0;
  double largest_error = 0;  // of those that do not rattle
};

// Where surfaces rub, also with other shapes by as many roundings, up and down: larger forces alone scale a motion
// that sticks, and do not show what rounding does to it.
Case by_roundings(Case drawn) {
  if (std::ranges::count(drawn.arrays.connections, ConnectionKind::kFriction, &InstrumentConnection::kind) == 0)
    return drawn;
  double part = 64 * std::numeric_limits<double>::epsilon();
  for (double& shape : drawn.arrays.shapes) shape *= 1 + (part = -part);
  return drawn;
}

void compare(const Case& drawn, const Signals<double>& found, Summary& summary) {
  const auto expected = sound_of_class(drawn, 1);
  const auto moved = sound_of_class(by_roundings(drawn), 1 + 64 * std::numeric_limits<double>::epsilon());
  const bool is_coupled =
      std::ranges::count(drawn.arrays.connections, ConnectionKind::kContact, &InstrumentConnection::kind) > 1;
  bool rattles = false, finished = true;
  for (std::size_t o = 0; o < expected.size(); ++o) {
    const Agreement result = agreement(found[o], expected[o], moved[o]);
    // The program's steps are counted (docs/reference/instruments.md): a light mass between two stiff
    // contacts may want more.
    EXPECT_TRUE(result.holds || (is_coupled && result.error <= 1e-6))
        << drawn.model.outputs[o].name << " is wrong by " << result.error;
    finished &= result.holds;
    if (!result.rattles) summary.largest_error = std::max(summary.largest_error, result.error);
    rattles |= result.rattles;
  }
  ++summary.compared;
  summary.rattling += rattles;
  summary.unfinished += !finished;
}

std::string text_of(const Case& drawn) {
  std::ostringstream text;
  text << drawn.sample_rate_hz << " Hz\n";
  for (const Move& move : drawn.moves) text << move.sample << ' ' << move.label << ' ' << move.value << '\n';
  return text.str() + drawn.file;
}

// Compares the programs of cases 0 to count - 1, and of those in `more`.
void expect_agreement(RandomInstruments random, std::size_t count, const std::vector<std::size_t>& more,
                      const std::string& folder) {
  std::vector<Case> cases;
  for (std::size_t n = 0; cases.size() < count + more.size(); ++n) {
    Case drawn = next_case(random);
    if (n < count || std::ranges::count(more, n) != 0) cases.push_back(std::move(drawn));
  }
  const Library library = compiled(cases, empty_folder(folder));
  Summary summary;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Case& drawn = cases[i];
    SCOPED_TRACE(text_of(drawn));
    const auto found = sound_of_program(drawn, {library, "random_" + std::to_string(i), drawn.sample_rate_hz});
    for (const auto& channel : found) EXPECT_TRUE(all_finite(channel));
    if (all_connections_move(drawn)) compare(drawn, found, summary);
  }
  EXPECT_GE(4 * summary.compared, 3 * cases.size());
  EXPECT_LE(100 * summary.unfinished, summary.compared);
  EXPECT_LE(3 * summary.rattling, summary.compared);
  Measured() << summary.compared << " compared, of which " << summary.rattling << " rattle; largest error "
             << summary.largest_error;
}

bool is_full() {
  return std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr;
}

// In number 95 a mass is struck while a string presses it.
TEST(RandomInstruments, SoundInFaustAsInTheClass) {
  const std::vector<std::size_t> more(is_full() ? 0 : 1, 95);
  expect_agreement(RandomInstruments(1), is_full() ? 200 : 8, more, "random_instruments");
}

// Felt with one memory, with two of other times, and without. In these cases contacts with memory touch.
TEST(RandomInstruments, RememberInFaustAsInTheClass) {
  const RandomInstruments random(2, {"felt_stulov_c4", "two_memories.json", "two_memories.json", "felt_c4"});
  const std::vector<std::size_t> touching = {15, 16, 19, 35};
  expect_agreement(random, is_full() ? 100 : 0, is_full() ? std::vector<std::size_t>{} : touching,
                   "random_instruments_with_memory");
}

TEST(RandomInstruments, RubInFaustAsInTheClass) {
  const RandomInstruments random(4, {"felt_c4", "mb1", "rubber_on_wood", "steel_on_steel"}, false, true);
  expect_agreement(random, is_full() ? 200 : 8, {}, "random_instruments_that_rub");
}

// Of the first cases: how many sound otherwise if nothing stretches.
std::size_t stretched_cases(RandomInstruments random, std::size_t count) {
  std::size_t stretched = 0;
  for (std::size_t n = 0; n < count; ++n) {
    Case drawn = next_case(random);
    const auto sound = sound_of_class(drawn, 1);
    for (InstrumentForm& form : drawn.arrays.stretch_forms) form.stiffness_j = 0;
    const auto stiff = sound_of_class(drawn, 1);
    bool differs = false;
    for (std::size_t o = 0; o < sound.size(); ++o) differs |= !sequences_within<double>(stiff[o], sound[o], 1e-6);
    stretched += differs;
  }
  return stretched;
}

// Strings and drum heads that stretch: all forces act over two samples.
TEST(RandomInstruments, StretchInFaustAsInTheClass) {
  const RandomInstruments random(3, {"felt_c4", "mb1", "rubber_on_wood", "steel_on_steel"}, true);
  EXPECT_GE(stretched_cases(random, 8), 3u);
  expect_agreement(random, is_full() ? 200 : 8, {}, "random_instruments_that_stretch");
}

// Half a second of an example whose last output is the force of its friction, without control of a place: pressed
// harder, turned, lifted.
void expect_rubbed_agreement(const std::string& name, const std::string& label, double force_n,
                             double speed_m_per_s) {
  const std::string path = EXAMPLES_FOLDER "/";
  auto file = nlohmann::json::parse(read_input(path + name + ".json"), nullptr, true, true);
  std::erase_if(file["controls"].get_ref<nlohmann::json::array_t&>(),
                [](const auto& c) { return c.contains("place_m"); });
  file.erase("presets");
  const InstrumentModel model = parse_instrument(file.dump(), name);
  const std::string force = label + "_normal_force_n", speed = label + "_surface_speed_m_per_s";
  const std::vector<Move> moves = {{0, force, force_n},
                                   {0, speed, speed_m_per_s},
                                   {37 * 200, force, 8 / 3.0 * force_n},
                                   {37 * 300, speed, -4 / 3.0 * speed_m_per_s},
                                   {37 * 400, force, 4 / 3.0 * force_n},
                                   {37 * 500, force, 0}};
  const Case drawn{file.dump(), model, arrays_of(model, kMaxFrequency), moves, static_cast<int>(2 * kMaxFrequency),
                   22050};
  const Library library = compiled({drawn}, empty_folder(name));
  const auto found = sound_of_program(drawn, {library, "random_0", drawn.sample_rate_hz});
  for (const auto& channel : found) EXPECT_GT(peak(channel), 1e-4);
  EXPECT_LT(std::abs(found.back().back()), 1e-6 * peak(found.back())) << "it is lifted";
  const auto expected = sound_of_class(drawn, 1);
  for (std::size_t o = 0; o < expected.size(); ++o) {
    const Agreement result =
        agreement(found[o], expected[o], expected[o]);  // within 1e-9, whatever amplifies rounding
    EXPECT_TRUE(result.holds) << drawn.model.outputs[o].name << " is wrong by " << result.error;
    Measured() << result.error;
  }
}

TEST(Bow, SoundsInFaustAsInTheClass) {
  expect_rubbed_agreement("violin_d4", "bow", 0.3, 0.15);
  expect_rubbed_agreement("bowed_vibraphone", "bow", 4, 0.2);
}

// The program of a plate and a drum head before two ears, at the sample rate of its taps: a mass bounces between the
// two, a force pushes at both.
TEST(Pressure, SoundsInFaustAsInTheClass) {
  const std::string file = R"({
    "name": "room",
    "bodies": [
      { "name": "head", "max_modes": 12, "membrane": { "radius_m": 0.2, "mass_per_area_kg_m2": 0.4,
        "tension_n_per_m": 1500, "constant_loss_per_s": 6, "quadratic_loss_m2_per_s": 0.02 } },
      { "name": "lid", "max_modes": 12, "plate": { "length_m": 0.5, "width_m": 0.3, "thickness_m": 0.003,
        "density_kg_m3": 450, "youngs_modulus_pa": 1e10, "poisson_ratio": 0.3, "constant_loss_per_s": 8,
        "quadratic_loss_m2_per_s": 0.02 } },
      { "name": "ball", "mass_kg": 0.01 }
    ],
    "places": [ { "name": "on_head", "body": "head", "position_m": 0.07 },
                { "name": "on_lid", "body": "lid", "position_m": 0.2, "across_m": 0.1 } ],
    "contacts": [
      { "name": "below", "between": ["ball", "on_head"], "material": "felt_c4", "gap_m": 0.0001 },
      { "name": "above", "between": ["on_lid", "ball"], "material": "felt_c4", "gap_m": 0.0001 }
    ],
    "controls": [ { "name": "push", "force_n": "on_head" }, { "name": "press", "force_n": "on_lid" } ],
    "strikes": ["ball"],
    "outputs": [
      { "name": "left", "pressure_pa": "head", "distance_m": 0.9, "angle_rad": 0.7, "around_rad": 1, "side_m": -0.09 },
      { "name": "right", "pressure_pa": "head", "distance_m": 0.9, "angle_rad": 0.7, "around_rad": 1, "side_m": 0.09 },
      { "name": "lid", "pressure_pa": "lid", "distance_m": 1.3, "angle_rad": -0.4 }
    ]
  })";
  const InstrumentModel model = parse_instrument(file, "room.json");
  const std::vector<Move> moves = {{37, "ball_speed_m_per_s", 1},
                                   {37, "strike_ball", 1},
                                   {370, "push_force_n", 0.5},
                                   {740, "press_force_n", -0.5}};
  const Case drawn{file, model, arrays_of(model, kMaxFrequency), moves, static_cast<int>(2 * kMaxFrequency)};
  const Library library = compiled({drawn}, empty_folder("pressure"));
  const auto found = sound_of_program(drawn, {library, "random_0", drawn.sample_rate_hz});
  for (const auto& channel : found) EXPECT_GT(peak(channel), 1e-4);
  EXPECT_FALSE(agreement(found[0], found[1], found[1]).holds) << "two ears are not one";
  Summary summary;
  compare(drawn, found, summary);
  EXPECT_EQ(summary.unfinished, 0u);
}

// A throw takes the last increment, from which the loss is predicted, from all contacts: also from a felt that
// something else presses meanwhile.
TEST(Throw, SoundsInFaustAsInTheClass) {
  const std::string file = R"({
    "name": "thrown",
    "bodies": [ { "name": "weight", "mass_kg": 0.01 }, { "name": "ball", "mass_kg": 0.003 } ],
    "contacts": [
      { "name": "below", "between": ["weight", "ground"], "material": "felt_c4", "gap_m": -0.0003 },
      { "name": "wall", "between": ["ball", "ground"], "material": "felt_c4", "gap_m": 0.0005 }
    ],
    "controls": [ { "name": "load", "force_n": "weight" }, { "name": "below", "loss_s_per_m": "below" },
                  { "name": "wall", "loss_s_per_m": "wall" } ],
    "strikes": ["ball"],
    "outputs": [ { "name": "weight", "velocity_m_per_s": "weight" }, { "name": "wall", "force_n": "wall" } ]
  })";
  const InstrumentModel model = parse_instrument(file, "thrown.json");
  const std::vector<Move> moves = {{0, "below_loss_s_per_m", 0.5},
                                   {0, "wall_loss_s_per_m", 0.2},
                                   {0, "load_force_n", 20},
                                   {37, "ball_speed_m_per_s", 2},
                                   {37, "strike_ball", 1}};
  const Case drawn{file, model, arrays_of(model, kMaxFrequency), moves, static_cast<int>(2 * kMaxFrequency)};
  const Library library = compiled({drawn}, empty_folder("thrown"));
  const auto found = sound_of_program(drawn, {library, "random_0", drawn.sample_rate_hz});
  for (const auto& channel : found) EXPECT_GT(peak(channel), 1e-4);
  Summary summary;
  compare(drawn, found, summary);
  EXPECT_EQ(summary.unfinished, 0u);
  Measured() << summary.largest_error;
}

// What felts that remember, springs and forces press at rest is silent, until controls move.
TEST(StaticEquilibrium, SoundsInFaustAsInTheClass) {
  const std::string file = R"({
    "name": "pressed",
    "bodies": [ { "name": "weight", "mass_kg": 0.01 }, { "name": "plate", "mass_kg": 1 },
                { "name": "string", "resonator": "guitar_a2", "max_modes": 20 } ],
    "places": [ { "name": "middle", "body": "string", "position_m": 0.3 } ],
    "contacts": [
      { "name": "below", "between": ["weight", "ground"], "material": "felt_stulov_c4", "gap_m": 0.001 },
      { "name": "damper", "between": ["middle", "ground"], "material": "felt_stulov_c4", "gap_m": -0.0005 }
    ],
    "springs": [ { "name": "coil", "between": ["weight", "plate"], "stiffness_n_per_m": 50, "gap_m": -0.002 },
                 { "name": "leg", "between": ["plate", "ground"], "stiffness_n_per_m": 200 } ],
    "controls": [ { "name": "load", "force_n": "weight", "initial": 3 },
                  { "name": "finger", "force_n": "middle", "initial": 1.5 },
                  { "name": "damper", "gap_shift_m": "damper", "initial": 0.0002 } ],
    "outputs": [ { "name": "below", "force_n": "below" }, { "name": "string", "displacement_m": "middle" },
                 { "name": "end", "end_force_n": "string" }, { "name": "weight", "velocity_m_per_s": "weight" } ]
  })";
  constexpr std::size_t kMoved = 740;
  const InstrumentModel model = parse_instrument(file, "pressed.json");
  const std::vector<Move> moves = {{kMoved, "load_force_n", 4}, {kMoved, "damper_gap_shift_m", 0}};
  const Case drawn{file, model, arrays_of(model, kMaxFrequency), moves, static_cast<int>(2 * kMaxFrequency)};
  const Library library = compiled({drawn}, empty_folder("pressed"));
  const auto found = sound_of_program(drawn, {library, "random_0", drawn.sample_rate_hz});
  for (const auto& channel : found) {
    for (std::size_t n = 0; n < kMoved; ++n) ASSERT_LE(std::abs(channel[n]), 1e-9) << n;
    EXPECT_GT(peak(channel), 1e-4);
  }
  Summary summary;
  compare(drawn, found, summary);
  EXPECT_EQ(summary.unfinished, 0u);
}

}  // namespace
}  // namespace contactspline::testing
