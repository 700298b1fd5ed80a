// SPDX-License-Identifier: MIT
#include "generator/cli/inspect_json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

std::string errors_of(const Quality& quality, const std::optional<SpectrumError>& spectrum) {
  const auto curve = [](const CurveError& error) {
    return fmt::format("{{\"worst\": {}, \"rms\": {}}}", error.worst, error.rms);
  };
  std::string text = fmt::format("{{\"force\": {}, \"energy\": {}", curve(quality.force), curve(quality.energy));
  if (quality.impact)
    text += fmt::format(", \"contact_duration\": {}, \"max_compression\": {}", quality.impact->contact_duration,
                        quality.impact->max_compression);
  if (spectrum)
    text += fmt::format(", \"spectrum_db\": {{\"worst\": {}, \"mean\": {}}}", spectrum->worst_db, spectrum->mean_db);
  return text + "}";
}

// A line of its own, if the material has a memory.
std::string memory_member(const Material& material) {
  return material.memories.empty() ? "" : fmt::format("  \"memory\": {},\n", json_of(material.memories));
}

}  // namespace

std::string json_of(const Design& design) {
  const auto& [material, spline, quality, spectrum] = design;
  std::vector<std::string> segments;
  for (const auto& s : spline.segments)
    segments.push_back(
        fmt::format("    {{\"knot_m\": {}, \"energy_j\": {}, \"force_n\": {}, \"half_curvature_n_per_m\": {}}}",
                    s.knot, s.energy, s.force, s.half_curvature));
  return fmt::format(
      "{{\n  \"name\": \"{}\",\n  \"description\": {},\n  \"law\": {},\n  \"loss_s_per_m\": {},\n{}  \"knots\": "
      "\"{}\",\n"
      "  \"end_m\": {},\n  \"errors\": {},\n  \"segments\": [\n{}\n  ]\n}}\n",
      material.name, json_string(material.description), json_string(law_text(material)), material.loss_s_per_m,
      memory_member(material), name_of(material.spline.knots),
      material.compensation ? spline.end_m : material.spline.max_compression_m, errors_of(quality, spectrum),
      fmt::join(segments, ",\n"));
}

std::string json_of(const Material& material, std::span<const ComparedFamily> families) {
  const auto or_null = [](std::optional<std::size_t> number) { return number ? fmt::format("{}", *number) : "null"; };
  std::vector<std::string> rows;
  for (const ComparedFamily& family : families)
    rows.push_back(
        fmt::format("    {{\"knots\": \"{}\", \"segments\": {}, \"errors\": {},\n     \"segments_for_0.01\": {}, "
                    "\"segments_for_0.001\": {}}}",
                    family.name, family.segments, errors_of(family.quality, family.spectrum),
                    or_null(family.segments_for_1_percent), or_null(family.segments_for_01_percent)));
  const auto& [mass_kg, fastest, slowest] = *material.impact;
  return fmt::format(
      "{{\n  \"name\": \"{}\",\n  \"mass_kg\": {},\n  \"min_speed_m_per_s\": {},\n  \"max_speed_m_per_s\": {},\n"
      "  \"families\": [\n{}\n  ]\n}}\n",
      material.name, mass_kg, slowest, fastest, fmt::join(rows, ",\n"));
}

std::string json_of(const RubbingSurfaces& surfaces) {
  const auto& [bristles, heat] = surfaces.friction;
  std::string text = fmt::format(
      "{{\n  \"name\": \"{}\",\n  \"description\": {},\n  \"stiffness_per_m\": {},\n  \"damping_s_per_m\": {},\n",
      surfaces.name, json_string(surfaces.description), bristles.stiffness_per_m, bristles.damping_s_per_m);
  if (!surfaces.warms()) return text + fmt::format("  \"coefficient\": {}\n}}\n", heat.cold_coefficient);
  return text + fmt::format(
                    "  \"cold_coefficient\": {},\n  \"hot_coefficient\": {},\n  \"softening_k\": {},\n"
                    "  \"capacity_j_per_n_k\": {},\n  \"conduction_w_per_n_k\": {},\n"
                    "  \"renewal_w_per_m_k2\": {},\n  \"width_m\": {}\n}}\n",
                    heat.cold_coefficient, heat.hot_coefficient, heat.softening_k, heat.capacity_j_per_n_k,
                    heat.conduction_w_per_n_k, heat.renewal_w_per_m_k2, surfaces.width_m);
}

std::string json_of(const Resonator& resonator, double sample_rate_hz) {
  const ModeSet set = modes_of(resonator, sample_rate_hz / 2);
  std::vector<std::string> modes;
  for (const ResonatorMode& mode : set.modes)
    modes.push_back(fmt::format("    {{\"frequency_hz\": {}, \"decay_per_s\": {}, \"mass_kg\": {}}}",
                                mode.mode.angular_frequency_rad_per_s / (2 * std::numbers::pi), mode.mode.decay_per_s,
                                mode.mode.mass_kg));
  return fmt::format(
      "{{\n  \"name\": \"{}\",\n  \"description\": {},\n  \"sample_rate_hz\": {},\n"
      "  \"modes_left_out\": {},\n  \"modes\": [\n{}\n  ]\n}}\n",
      resonator.name, json_string(resonator.description), sample_rate_hz, set.cut, fmt::join(modes, ",\n"));
}

KeyRow key_row(const Keyboard& keyboard, int key, double sample_rate_hz) {
  const KeyboardNote note = note_of(keyboard, key);
  const StiffString& string = note.string;
  return {key, note, note.pitch_hz,
          std::pow(std::numbers::pi / string.length_m, 2) * string.bending_stiffness_n_m2 / string.tension_n,
          modes_of(note, sample_rate_hz / 2).size()};
}

std::string json_of(const Keyboard& keyboard, std::span<const KeyRow> rows, double sample_rate_hz) {
  std::vector<std::string> keys;
  for (const auto& [key, note, pitch_hz, inharmonicity, modes] : rows) {
    const PowerLaw& felt = *note.felt.contact.power_law();
    keys.push_back(fmt::format(
        "    {{\"key\": {}, \"pitch_hz\": {}, \"inharmonicity\": {}, \"strings\": {}, \"modes\": {}, "
        "\"length_m\": {}, \"mass_kg\": {},\n     \"tension_n\": {}, \"hammer_mass_kg\": {}, "
        "\"stiffness_n_per_m_alpha\": {}, "
        "\"exponent\": {}}}",
        key, pitch_hz, inharmonicity, note.strings, modes, note.string.length_m, note.string.mass_kg,
        note.string.tension_n, note.strings * note.hammer_mass_kg, note.strings * felt.stiffness, felt.exponent));
  }
  return fmt::format(
      "{{\n  \"name\": \"{}\",\n  \"description\": {},\n  \"sample_rate_hz\": {},\n  \"first_key\": {},\n  "
      "\"last_key\": {},\n  \"keys\": [\n{}\n  ]\n}}\n",
      keyboard.name, json_string(keyboard.description), sample_rate_hz, keyboard.first_key, keyboard.last_key,
      fmt::join(keys, ",\n"));
}

}  // namespace contactspline
