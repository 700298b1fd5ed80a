// SPDX-License-Identifier: MIT
// Damaged material, curve, resonator, keyboard, score, instrument and MIDI files: each gives either output or one
// readable line that names the file. scripts/fuzz does the same guided by coverage.
#include <string>
#include <utility>
#include <vector>

#include "damage.hpp"
#include "fuzz/paths.hpp"
#include "generator/support/embedded_files.hpp"
#include "support/expressions.hpp"

namespace contactspline::testing {
namespace {

std::vector<std::string> shipped_texts(Shipped folder, std::string_view suffix = ".json") {
  return texts_of(embedded_files(folder), suffix);
}

std::vector<std::string> with(std::vector<std::string> texts, std::string text) {
  texts.push_back(std::move(text));
  return texts;
}

TEST(DamagedMaterial, GivesOutputOrOneReadableLine) {
  const Path& path = path_of("material");
  damage_files(shipped_texts(Shipped::kMaterials), path.file,
               "\"name\" \"description\" \"contact\" \"impact\" \"spline\" \"knots\" \"segments\" \"exponent\" "
               "\"max_compression_m\" \"max_compression_m\":1e-3, \"uniform\" \"graded\" \"optimal\" "
               "\"loss_s_per_m\":0.1, \"hertz\" "
               "\"sum\" \"curve\" \"offset_m\":1e-4, \"sphere\" \"monotone\"",
               15'000, path.play);
}

TEST(DamagedCurve, GivesOutputOrOneReadableLine) {
  const Path& path = path_of("curve");
  damage_files(with(shipped_texts(Shipped::kMaterials, ".csv"),
                    "compression_mm,force_n\n0.1,1\n0.2,3\n0.4,8\n0.6,20\n0.8,40\n1.2,80\n1.4,140\n1.6,190\n"),
               path.file, "compression_m,force_n compression_um force_kn # \n \r\n ; , 0.5,50 -0.1,0", 4'000,
               path.play, 100);
}

TEST(DamagedFriction, GivesOutputOrOneReadableLine) {
  const Path& path = path_of("friction");
  damage_files(shipped_texts(Shipped::kFrictions), path.file,
               "\"name\" \"bristles\" \"heat\" \"coefficient\":0.5, \"width_m\":1, \"softening_k\":0.1, "
               "\"hot_coefficient\" \"capacity_j_per_n_k\":1e-12, \"conduction_w_per_n_k\":0",
               5'000, path.play);
}

TEST(DamagedResonator, GivesOutputOrOneReadableLine) {
  const Path& path = path_of("resonator");
  damage_files(with(shipped_texts(Shipped::kResonators), R"({ "name": "bell", "max_modes": 3, "modes": [
    { "frequency_hz": 440, "decay_per_s": 1, "mass_kg": 0.01, "strike_shape": 1, "pickup_shape": -0.5 },
    { "frequency_hz": 1230, "decay_per_s": 3, "mass_kg": 0.01, "strike_shape": 0.4, "pickup_shape": 1 } ] })"),
               path.file,
               "\"name\" \"string\" \"bar\" \"membrane\" \"plate\" \"modes\" \"strike\" \"pickup\" \"max_modes\":2, "
               "\"detuning_cents\":[1,2], \"angle_rad\":0, \"position_m\"",
               10'000, path.play);
}

TEST(DamagedKeyboard, GivesOutputOrOneReadableLine) {
  const Path& path = path_of("keyboard");
  damage_files(shipped_texts(Shipped::kKeyboards), path.file,
               "\"name\" \"keyboard\" \"notes\" \"key\":60, \"first_key\":21, \"last_key\":108, \"segments\":2, "
               "\"exponent\":3, \"length_m\":1, \"hammer_mass_kg\"",
               1'300, path.play, 25);  // more damage to a longer file is fatal
}

TEST(DamagedScore, PlaysOrGivesOneReadableLine) {
  const Path& path = path_of("score");
  damage_files(shipped_texts(Shipped::kScores), path.file,
               "\"instrument\" \"piano\" \"lap_steel\" \"duration_s\":1, \"voices\" "
               "\"events\" \"time_s\":1, \"over_s\":1, \"hold_s\":1, \"sustain\":1, \"key\":60, \"voice\":\"g3\", "
               "\"bar_place_m\":0.1, \"tuning_cents\":5, \"pan\":1, \"speed_m_per_s\":2, \"pick_release_n\":2,",
               4'000, path.play, 40);  // most damage to a large file is fatal
}

// The instruments that ship, with a material that is designed at once.
TEST(DamagedInstrument, GivesOutputOrOneReadableLine) {
  const Path& path = path_of("instrument");
  std::vector<std::string> texts;
  for (const std::string& text : shipped_texts(Shipped::kInstruments))
    texts.push_back(replaced(text, "\"material\": \"[a-z0-9_]+\"", "\"material\": \"felt.json\""));
  damage_files(
      texts, path.file,
      "\"name\" \"bodies\" \"places\" \"contacts\" \"springs\" \"links\" \"controls\" \"strikes\" \"outputs\" "
      "\"mass_kg\":1, \"ground\" \"gap_m\":1e-4, \"gaps_m\" \"weight\":2, \"initial\":1, \"tuning_cents\":9, "
      "\"max_modes\":2, \"position_m\":0.1, \"shapes\" \"string\" \"modes\" \"force_n\"",
      2'000, path.play);
}

TEST(DamagedMidi, PlaysOrGivesOneReadableLine) {
  const Path& path = path_of("midi");
  damage_files(shipped_texts(Shipped::kScores, ".mid"), path.file,
               "MTrk MThd \xff\x2f \xff\x51\x03 \xf0\x7f \xff\x20\x81", 20'000, path.read, 20,
               10);  // most damage is left out, with a line
}

}  // namespace
}  // namespace contactspline::testing
