// SPDX-License-Identifier: MIT
#include "fuzz/paths.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "generator/emit/emit_instrument.hpp"
#include "generator/emit/emit_instrument_faust.hpp"
#include "generator/emit/emit_keyboard.hpp"
#include "generator/emit/emit_material.hpp"
#include "generator/emit/emit_resonator.hpp"
#include "generator/emit/emitter.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/material/friction_reader.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/player/score_player.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/error.hpp"
#include "support/by_sample.hpp"

namespace contactspline::testing {
namespace {

constexpr auto kCommand = "contactspline generate fuzz.json";
constexpr auto kJson = "fuzz.json", kCurve = "fuzz.csv", kMidi = "fuzz.mid";
constexpr double kHz = 44100;
constexpr int kMaxSegments = 16, kMaxModes = 20, kMaxKeys = 4, kSamples = 64;
constexpr std::size_t kMaxAiryFunctions = 8;
constexpr double kMinTolerance = 0.02;

// Whatever its name, a short curve.
constexpr auto kShortCurve =
    "compression_mm,force_n\n0.1,1\n0.2,3\n0.4,8\n0.6,20\n0.8,40\n1.2,80\n1.4,140\n1.6,190\n";

void demand(bool holds, std::string_view what) {
  if (!holds) throw std::logic_error(std::string(what));
}

void demand_text(const Emitter& emitter, const std::string& text) {
  demand(!text.empty(), "nothing was emitted");
  demand(emitter.name != "json" || nlohmann::json::accept(text), "emitted JSON cannot be read");
  for (const std::string_view word : {"nan", "inf"})
    for (auto at = text.find(word); emitter.name == "cpp" && at != std::string::npos; at = text.find(word, at + 1)) {
      const auto is_letter = [&](std::size_t i) {
        return i < text.size() && (std::isalnum(text[i]) || text[i] == '_');
      };
      demand(is_letter(at - 1) || is_letter(at + word.size()), "a number in emitted C++ is not finite");
    }
}

template <typename T>
void bounce(const Design& design) {
  std::vector<Segment<T>> table;
  for (const auto& s : segment_table(design.spline))
    table.push_back({static_cast<T>(s.knot), static_cast<T>(s.energy), static_cast<T>(s.force),
                     static_cast<T>(s.half_curvature)});
  const auto mass = static_cast<T>(design.material.impact ? design.material.impact->mass_kg : 0.003);
  const auto speed = static_cast<T>(design.material.impact ? design.material.impact->max_speed_m_per_s : 2.0);
  MassBarrier<T> model(table, static_cast<T>(kHz));
  model.throw_from(T(-1e-5), speed);
  for (int n = 0; n < kSamples; ++n) {
    model.tick({.mass_kg = mass, .contact = {T(1), static_cast<T>(design.material.loss_s_per_m)}});
    demand(std::isfinite(model.force()) && std::isfinite(model.displacement()), "a collision is not finite");
    demand(model.force() >= 0, "a contact pulls");
  }
}

bool fits_single(const Spline& spline) {  // tables of single precision: docs/reference/materials.md
  return std::ranges::all_of(spline.segments, [](const Segment<double>& s) {
    return std::max({s.energy, s.force, s.half_curvature}) < 1e30;
  });
}

void emit_and_bounce(const Design& design) {
  for (const Emitter& emitter : emitters()) demand_text(emitter, emit(emitter, design, kCommand));
  bounce<double>(design);
  if (fits_single(design.spline)) bounce<float>(design);
}

Material small(Material material) {
  material.spline.segments = std::min(material.spline.segments, kMaxSegments);
  if (material.spline.tolerance > 0) {
    material.spline.tolerance = std::max(material.spline.tolerance, kMinTolerance);
    // a search of seconds
    if (material.spline.minimise == ErrorOf::spectrum) material.spline.segments = 4, material.spline.tolerance = 0;
  }
  if (material.live_exponent) material.live_exponent->members = std::min(material.live_exponent->members, 3);
  return material;
}

Material read_material(std::string_view text) {
  return parse_material(text, kJson, [](const std::string&) { return kShortCurve; });
}

void play_material(std::string_view text) {
  Material material = small(read_material(text));
  const Spline spline = design_spline(material, kJson);
  emit_and_bounce({material, spline, measure_quality(spline, material), {}});
}

void read_curve(std::string_view text) {
  const auto samples = parse_curve(text, kCurve);
  demand(samples.size() >= 8, "a curve of fewer than 8 samples");
}

// Under a material that reaches a part of the curve only, so that what is cut off at the end may do. Both have the
// same file, whichever is to blame.
void play_curve(std::string_view text) {
  for (const char* shape : {"hardening", "monotone"}) {
    const nlohmann::json material = {
        {"name", "fuzz"},
        {"contact", {{"curve", {{"file", kCurve}, {"shape", shape}}}}},
        {"spline", {{"knots", "uniform"}, {"segments", 64}, {"max_compression_m", 1e-4}}}};
    emit_and_bounce(design_material(material.dump(), kCurve, [&](const std::string&) { return std::string(text); }));
  }
}

// Rubs at a few speeds and forces, and slides for ten samples.
void play_friction(std::string_view text) {
  const RubbingSurfaces surfaces = parse_friction(text, kJson);
  Friction<double> friction(surfaces.friction.bristles, kHz);
  FrictionTemperature<double> temperature(surfaces.friction.heat, surfaces.width_m, kHz);
  for (const double force : {0.0, 0.1, 100.0})
    for (const double speed : {1e-3, 1.0, 1000.0}) {
      if (force > 0) {
        const double coefficient = steady_sliding(surfaces, speed, force).coefficient;
        demand(coefficient >= 0 && coefficient <= 10, "a wrong coefficient");
      }
      const auto step = friction.tick({force, temperature.coefficient()}, speed / kHz, 1e-5);
      temperature.advance(force, step.increment, friction.slip_heat());
      demand(std::isfinite(step.force) && std::isfinite(temperature.temperature()), "friction is not finite");
    }
}

void play_resonator(std::string_view text) {
  Resonator resonator = parse_resonator(text, kJson);
  resonator.max_modes = std::min(resonator.max_modes, kMaxModes);
  const auto modes = modes_of(resonator, kHz / 2).modes;
  if (modes.empty()) return;
  for (const Emitter& emitter : emitters()) demand_text(emitter, emit(emitter, resonator, kHz / 2, kCommand));
  std::vector<Mode> bare;
  std::vector<double> strike, pickup;
  for (const auto& mode : modes)
    bare.push_back(mode.mode), strike.push_back(mode.strike_shape), pickup.push_back(mode.pickup_shape);
  const std::vector<Segment<double>> felt = {{0, 0, 0, 0}, {0, 0, 0, 1e5}, {1e-3, 0.1, 200, 1e6}};
  HammerVoice<double> voice({.felt = felt,
                             .modes = bare,
                             .strike = ModeShapes<double>(strike),
                             .output = ModeShapes<double>(pickup),
                             .controls = {.hammer_mass_kg = 0.003, .felt = {1, 0.1}}},
                            kHz);
  voice.strike(2);
  std::array<double, kSamples> out, forces;
  voice.process(out, forces.data());
  for (std::size_t n = 0; n < kSamples; ++n)
    demand(std::isfinite(out[n]) && std::isfinite(forces[n]) && forces[n] >= 0, "a struck resonator is not finite");
}

// A hundredth of a second of the first two voices.
void play_a_little(Score score) {
  score.duration_s = 0.01;
  if (score.voices.size() > 2) score.voices.resize(2);
  for (Voice& voice : score.voices) voice.resonator.max_modes = std::min(voice.resonator.max_modes, kMaxModes / 2);
  PlayOptions options{kHz};
  choose_best_output(score, options);
  const Performance played = play(score, options, [](double) {});
  demand(played.samples.size() == 441u * static_cast<std::size_t>(played.channels), "a score of a wrong length");
  demand(std::ranges::all_of(played.samples, [](float sample) { return std::isfinite(sample); }),
         "a score is not finite");
}

// A score that strikes a key of the keyboard once.
void strike_key(std::string_view keyboard, int key) {
  const nlohmann::json event = {{"time_s", 0}, {"key", key}, {"speed_m_per_s", 2}};
  const nlohmann::json text = {{"instrument", kJson}, {"duration_s", 0.1}, {"events", {event}}};
  Score score = parse_score(text.dump(), kJson, [&](const std::string& path) {
    return path == kJson ? std::string(keyboard) : shipped_file(path);
  });
  score.keys.resize(std::min(score.keys.size(), std::size_t{kMaxKeys}));
  play_a_little(score);
}

void play_keyboard(std::string_view text) {
  Keyboard keyboard = parse_keyboard(text, kJson);
  keyboard.segments = std::min(keyboard.segments, 4);
  keyboard.last_key = std::min(keyboard.last_key, keyboard.first_key + kMaxKeys);
  const auto resonators = resonators_of(keyboard, {std::string(text), kJson, true}, shipped_file);
  for (const Emitter& emitter : emitters())
    demand_text(emitter, emit(emitter, keyboard, resonators, kHz / 2, kCommand));
  strike_key(text, keyboard.first_key);
}

// The files that a score or an instrument may name: other ones do not exist.
std::string beside(const std::string& path) {
  if (path.ends_with("felt.json"))
    return R"({"name": "felt", "contact": {"stiffness_n_per_m_alpha": 4e9, "exponent": 2.5}, "spline": {"knots":
      "uniform", "segments": 4, "max_compression_m": 1e-3}, "impact": {"mass_kg": 0.003, "max_speed_m_per_s": 6,
      "min_speed_m_per_s": 0.1}})";
  if (path.ends_with("string.json"))
    return R"({"name": "string", "max_modes": 10, "string": {"length_m": 0.6, "mass_kg": 0.004, "tension_n": 670,
      "bending_stiffness_n_m2": 0.01, "constant_loss_per_s": 0.5, "quadratic_loss_m2_per_s": 1e-4},
      "strike": {"position_m": 0.07}, "pickup": {"position_m": 0.2}})";
  if (path.ends_with("keyed_instrument.json"))
    return R"({"name": "zither", "bodies": [{"name": "a", "mass_kg": 0.1}, {"name": "b", "resonator": "string.json"}],
      "places": [{"name": "p", "body": "b", "position_m": 0.1}],
      "contacts": [{"name": "c", "between": ["a", "p"], "material": "felt.json"}], "strikes": ["a"],
      "keys": [{"first": 50, "last": 70, "event": "strike_a", "tuned_key": 60}], "polyphony": 2,
      "damper": {"bodies": "b", "damping_per_s": 60}, "outputs": [{"name": "o", "force_n": "c"}]})";
  if (path.ends_with("instrument.json"))
    return R"({"name": "instrument", "bodies": [{"name": "a", "mass_kg": 0.1}, {"name": "b", "resonator": "string.json"}],
      "places": [{"name": "p", "body": "b", "position_m": 0.1}],
      "contacts": [{"name": "c", "between": ["a", "p"], "material": "felt.json", "gap_m": 1e-4}],
      "controls": [{"name": "ratio", "stiffness_ratio": "c"}], "strikes": ["a"],
      "outputs": [{"name": "o", "force_n": "c"}]})";
  refuse(kJson, shown(path), "does not exist", "a file");
}

Score read_score(std::string_view text) {
  return parse_score(text, kJson, beside);
}

InstrumentModel read_instrument(std::string_view text) {
  return parse_instrument(text, kJson, beside);
}

// Energy never grows by more than the work that is done, but for rounding.
template <typename T>
void play_instrument_in(const InstrumentArrays& arrays, const InstrumentData& data) {
  BySample<T> instrument(Engine<T>::network(data), kHz);
  const double begin = instrument.energy();
  double work = 0, reached = std::abs(begin);
  for (int n = 0; n < kSamples; ++n) {
    for (std::size_t i = 0; i < arrays.controls.size(); ++i)
      if (n % 8 == 0) instrument.set(i, n % 16 == 0 ? 1 : arrays.parameters[i].initial);
    for (std::size_t i = 0; i < arrays.strikes.size(); ++i)
      if (n % 32 == 0) instrument.strike(i, T(2));
    for (const KeyRange& keys : arrays.model->keys.ranges) {
      if (n % 16 == 3) instrument.handle().note_on(n % 32 == 3 ? keys.first : keys.last, 0.9);
      if (n % 16 == 11) instrument.handle().note_off(keys.first);
    }
    instrument.tick();
    work += instrument.work();
    reached += std::abs(instrument.work()) + std::abs(instrument.energy());
    for (std::size_t i = 0; i < arrays.outputs.size(); ++i)
      demand(std::isfinite(instrument.output(i)), "an output of an instrument is not finite");
    demand(std::isfinite(work) && std::isfinite(reached), "the energy of an instrument is not finite");
    if constexpr (std::same_as<T, double>)
      demand(instrument.energy() <= begin + work + 1e-9 * reached, "an instrument gains energy");
  }
}

void play_instrument(std::string_view text) {
  InstrumentModel model = read_instrument(text);
  for (InstrumentBody& body : model.bodies) {
    body.resonator.max_modes = std::min(body.resonator.max_modes, kMaxModes);
    body.airy_functions = std::min<std::size_t>(body.airy_functions, kMaxAiryFunctions);
  }
  if (silent_body(model, kHz / 2)) return;
  const InstrumentArrays arrays = arrays_of(model, kHz / 2);
  for (const Emitter& emitter : emitters())
    if (emitter.name != "faust" || !faust_obstacle(model, arrays))
      demand_text(emitter, emit(emitter, model, kHz / 2, kCommand));
  play_instrument_in<double>(arrays, without_keys(arrays.view()));
  play_instrument_in<float>(arrays, without_keys(arrays.view()));
  if (model.keys.ranges.empty()) return;
  play_instrument_in<double>(arrays, arrays.view());
  play_instrument_in<float>(arrays, arrays.view());
}

void demand_notes(const MidiSong& song) {
  double last_s = 0;
  for (const MidiNote& note : song.notes) {
    demand(std::isfinite(note.time_s) && note.time_s >= last_s && note.hold_s >= 0, "a note at a wrong time");
    demand(note.key_hold_s >= 0 && note.key_hold_s <= note.hold_s, "a key is down longer than its note");
    demand(note.key >= 0 && note.key < 128 && note.velocity > 0 && note.velocity <= 1, "a wrong note");
    last_s = note.time_s;
  }
  for (const MidiPedal& pedal : song.pedals)
    demand(std::isfinite(pedal.time_s) && pedal.position >= 0 && pedal.position <= 1, "a wrong pedal");
  for (const MidiBend& bend : song.bends)
    demand(std::isfinite(bend.time_s) && bend.channel >= 0 && bend.channel < 16 && std::isfinite(bend.cents),
           "a wrong bend");
}

constexpr std::array kPaths = {
    Path{"material", kJson, [](std::string_view text) { read_material(text); }, play_material},
    Path{"curve", kCurve, read_curve, play_curve},
    Path{"friction", kJson, [](std::string_view text) { (void)parse_friction(text, kJson); }, play_friction},
    Path{"resonator", kJson, [](std::string_view text) { (void)parse_resonator(text, kJson); }, play_resonator},
    Path{"keyboard", kJson, [](std::string_view text) { (void)parse_keyboard(text, kJson); }, play_keyboard},
    Path{"score", kJson, [](std::string_view text) { (void)read_score(text); },
         [](std::string_view text) { play_a_little(read_score(text)); }},
    Path{"instrument", kJson, [](std::string_view text) { (void)read_instrument(text); }, play_instrument},
    Path{"midi", kMidi, [](std::string_view bytes) { demand_notes(parse_midi(bytes, kMidi)); },
         [](std::string_view bytes) { play_a_little(parse_midi_score(bytes, kMidi)); }}};

}  // namespace

std::span<const Path> paths() {
  return kPaths;
}

const Path& path_of(std::string_view name) {
  const auto found = std::ranges::find(kPaths, name, &Path::name);
  if (found == kPaths.end()) throw std::out_of_range("no path of the name " + std::string(name));
  return *found;
}

std::string_view fault_of_message(std::string_view message, std::string_view file) {
  const auto is_printable = [](unsigned char c) { return c >= 0x20 && c < 0x7f; };
  // An option may be to blame: a sample rate below which nothing sounds.
  if (!message.starts_with(std::string(file) + ": ") && !message.starts_with("--rate: "))
    return "does not begin with the file";
  const auto says = [&](std::string_view words) { return message.find(words) != std::string_view::npos; };
  if (!says("; allowed: ") && !says("; use an") && !says("; energies and stiffnesses must"))
    return "does not say what is allowed";
  if (!std::ranges::all_of(message, is_printable)) return "has characters that cannot be printed";
  if (message.size() >= 700) return "is too long";
  return {};
}

}  // namespace contactspline::testing
