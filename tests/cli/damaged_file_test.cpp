// SPDX-License-Identifier: MIT
// Damaged material, curve, resonator, keyboard, score and MIDI files: each gives either output or one readable line
// that names the file.
#include <string>

#include "damage.hpp"
#include "generator/emit/emit_keyboard.hpp"
#include "generator/emit/emit_material.hpp"
#include "generator/emit/emit_resonator.hpp"
#include "generator/emit/emitter.hpp"
#include "generator/material/material_reader.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/player/score_player.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/design.hpp"
#include "generator/spline/spline_error.hpp"
#include "generator/support/embedded_files.hpp"

namespace contactspline::testing {
namespace {

constexpr int kMaxSegments = 16;  // larger tables are slow, not different

const Emitter& emitter_of(int round) {
  return emitters()[static_cast<std::size_t>(round) % emitters().size()];
}

void expect_source(const std::string& source, const Emitter& emitter, const std::string& text) {
  EXPECT_TRUE(!source.empty() && (emitter.name != "json" || nlohmann::json::accept(source))) << text << source;
}

// Whatever its name, a short curve: a long one takes longer to smooth, and is not different.
constexpr auto kShortCurve =
    "compression_mm,force_n\n0.1,1\n0.2,3\n0.4,8\n0.6,20\n0.8,40\n1.2,80\n1.4,140\n1.6,190\n";

bool design_and_emit_material(const std::string& text, int round) {
  Material material = parse_material(text, "fuzz.json", [](const std::string&) { return kShortCurve; });
  material.spline.segments = std::min(material.spline.segments, kMaxSegments);
  const Spline spline = design_spline(material, "fuzz.json");
  expect_source(emit(emitter_of(round), {material, spline, measure_quality(spline, material)},
                     "contactspline generate fuzz.json"),
                emitter_of(round), text);
  return true;
}

TEST(DamagedMaterial, GivesOutputOrOneReadableLine) {
  damage_files(texts_of(embedded_files(Shipped::kMaterials), ".json"), "fuzz.json",
               "\"name\" \"description\" \"contact\" \"impact\" \"spline\" \"knots\" \"segments\" \"exponent\" "
               "\"max_compression_m\" \"max_compression_m\":1e-3, \"uniform\" \"graded\" \"optimal\" "
               "\"loss_s_per_m\":0.1, \"hertz\" "
               "\"sum\" \"curve\" \"offset_m\":1e-4, \"sphere\" \"monotone\"",
               20'000, design_and_emit_material);
}

// Under a material that reaches a part of the curve only, so that what is cut off at the end may do. The material is
// called like the curve: whichever is to blame, the message begins with the same name.
bool design_and_emit_curve(const std::string& text, int round) {
  for (const char* shape : {"hardening", "monotone"}) {
    const nlohmann::json material = {
        {"name", "fuzz"},
        {"contact", {{"curve", {{"file", "fuzz.csv"}, {"shape", shape}}}}},
        {"spline", {{"knots", "uniform"}, {"segments", 64}, {"max_compression_m", 1e-4}}}};
    const Design design = design_material(material.dump(), "fuzz.csv", [&](const std::string&) { return text; });
    expect_source(emit(emitter_of(round), design, "contactspline generate fuzz.json"), emitter_of(round), text);
  }
  return true;
}

TEST(DamagedCurve, GivesOutputOrOneReadableLine) {
  auto texts = texts_of(embedded_files(Shipped::kMaterials), ".csv");
  texts.push_back(kShortCurve);
  damage_files(texts, "fuzz.csv", "compression_m,force_n compression_um force_kn # \n \r\n ; , 0.5,50 -0.1,0", 4'000,
               design_and_emit_curve, 100);
}

// The lowest modes only: all of them are slow, not different.
bool emit_resonator(const std::string& text, int round) {
  Resonator resonator = parse_resonator(text, "fuzz.json");
  resonator.max_modes = std::min(resonator.max_modes, 20);
  if (modes_of(resonator, 22050).modes.empty()) return true;
  expect_source(emit(emitter_of(round), resonator, 22050, "contactspline generate fuzz.json"), emitter_of(round),
                text);
  return true;
}

TEST(DamagedResonator, GivesOutputOrOneReadableLine) {
  auto texts = texts_of(embedded_files(Shipped::kResonators), ".json");
  texts.push_back(R"({ "name": "bell", "max_modes": 3, "modes": [
    { "frequency_hz": 440, "decay_per_s": 1, "mass_kg": 0.01, "strike_shape": 1, "pickup_shape": -0.5 },
    { "frequency_hz": 1230, "decay_per_s": 3, "mass_kg": 0.01, "strike_shape": 0.4, "pickup_shape": 1 } ] })");
  damage_files(texts, "fuzz.json",
               "\"name\" \"string\" \"bar\" \"membrane\" \"plate\" \"modes\" \"strike\" \"pickup\" \"max_modes\":2, "
               "\"detuning_cents\":[1,2], \"angle_rad\":0, \"position_m\"",
               10'000, emit_resonator);
}

TEST(DamagedKeyboard, GivesOutputOrOneReadableLine) {
  damage_files(texts_of(embedded_files(Shipped::kKeyboards), ".json"), "fuzz.json",
               "\"name\" \"keyboard\" \"notes\" \"key\":60, \"first_key\":21, \"last_key\":108, \"segments\":2, "
               "\"exponent\":3, \"length_m\":1, \"hammer_mass_kg\"",
               4'000, [](const std::string& text, int round) {
                 Keyboard keyboard = parse_keyboard(text, "fuzz.json");
                 // more segments and more keys are slow, not different
                 keyboard.segments = std::min(keyboard.segments, 4);
                 keyboard.last_key = std::min(keyboard.last_key, keyboard.first_key + 4);
                 expect_source(emit(emitter_of(round), keyboard, "contactspline generate fuzz.json"),
                               emitter_of(round), text);
                 return true;
               });
}

// A hundredth of a second of what is left of it.
void play_a_little(Score score) {
  score.duration_s = 0.01;
  if (score.voices.size() > 2) score.voices.resize(2);
  for (Voice& voice : score.voices) voice.resonator.max_modes = std::min(voice.resonator.max_modes, 10);
  const Performance played = play(score, {.sample_rate_hz = 44100, .signal = best_signal(score)}, [](double) {});
  EXPECT_EQ(played.samples.size(), 441u * static_cast<std::size_t>(played.channels));
  EXPECT_TRUE(std::ranges::all_of(played.samples, [](float sample) { return std::isfinite(sample); }));
}

TEST(DamagedScore, PlaysOrGivesOneReadableLine) {
  const auto no_file = [](const std::string& path) -> std::string {
    throw BadInput("fuzz.json: " + shown(path) + ": does not exist; allowed: a file");
  };
  damage_files(
      texts_of(embedded_files(Shipped::kScores), ".json"), "fuzz.json",
      "\"instrument\" \"hammer-string\" \"slide-string\" \"duration_s\":1, \"keyboard\":\"piano\", \"voices\" "
      "\"events\" \"time_s\":1, \"over_s\":1, \"hold_s\":1, \"key\":60, \"voice\":\"g3\", \"place_m\":0.1, "
      "\"tuning_cents\":5, \"pan\":1, \"speed_m_per_s\":2, \"pluck_n\":2,",
      4'000,
      [&](const std::string& text, int) {
        play_a_little(parse_score(text, "fuzz.json", no_file));
        return true;
      },
      40);  // most damage to a large file is fatal
}

TEST(DamagedMidi, PlaysOrGivesOneReadableLine) {
  damage_files(texts_of(embedded_files(Shipped::kScores), ".mid"), "fuzz.mid",
               "MTrk MThd \xff\x2f \xff\x51\x03 \xf0\x7f \xff\x20\x81", 20'000, [](const std::string& text, int) {
                 for (const MidiNote& note : parse_midi(text, "fuzz.mid").notes) {
                   EXPECT_TRUE(note.time_s >= 0 && std::isfinite(note.time_s) && note.hold_s >= 0) << note.time_s;
                   EXPECT_TRUE(note.key >= 0 && note.key < 128 && note.velocity > 0 && note.velocity < 128);
                 }
                 return true;
               });
}

}  // namespace
}  // namespace contactspline::testing
