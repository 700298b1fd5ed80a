// SPDX-License-Identifier: MIT
// contactspline list, contactspline show: what ships.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/system.hpp"
#include "generator/material/material_reader.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/nearest_name.hpp"

namespace contactspline {
namespace {

// What the files say, without designing a spline: the list is there at once.
std::string materials() {
  std::string table =
      fmt::format("{:<20} {:>14} {:>9} {:>9}  {}\n", "name", "k [N/m^a]", "exponent", "segments", "description");
  for (const std::string& name : shipped_names(Shipped::kMaterials)) {
    const EmbeddedFile& file = *find_embedded(Shipped::kMaterials, name + ".json");
    const Material material = parse_material(file.content, file.name, shipped_file);
    const PowerLaw* law = material.contact.power_law();
    const std::string stiffness =
        law == nullptr ? std::string(name_of_law(material)) : fmt::format("{:.4g}", law->stiffness);
    const std::string exponent = law == nullptr ? "-" : fmt::format("{:.4g}", law->exponent);
    table += fmt::format("{:<20} {:>14} {:>9} {:>9}  {}\n", name, stiffness, exponent, material.spline.segments,
                         material.description);
  }
  return table;
}

std::string frictions() {
  std::string table =
      fmt::format("{:<20} {:>16} {:>6} {:>6}  {}\n", "name", "bristles [1/m]", "cold", "hot", "description");
  for (const std::string& name : shipped_names(Shipped::kFrictions)) {
    const RubbingSurfaces surfaces = friction_argument(name).value();
    const auto& [bristles, heat] = surfaces.friction;
    table += fmt::format("{:<20} {:>16.4g} {:>6.4g} {:>6.4g}  {}\n", name, bristles.stiffness_per_m,
                         heat.cold_coefficient, heat.hot_coefficient, surfaces.description);
  }
  return table;
}

std::string resonators() {
  constexpr double kMaxFrequency = 22050;
  std::string table = fmt::format("{:<20} {:<9} {:>16}  {}\n", "name", "body", "first mode [Hz]", "description");
  for (const std::string& name : shipped_names(Shipped::kResonators)) {
    const Resonator resonator = resonator_argument(name).value();
    const double lowest = modes_of(resonator, kMaxFrequency).modes.front().mode.angular_frequency_rad_per_s;
    table += fmt::format("{:<20} {:<9} {:>16.5g}  {}\n", name, name_of(resonator.body),
                         lowest / (2 * std::numbers::pi), resonator.description);
  }
  return table;
}

std::string keyboards() {
  std::string table = fmt::format("{:<20} {:>9} {:>9}  {}\n", "name", "first key", "last key", "description");
  for (const std::string& name : shipped_names(Shipped::kKeyboards)) {
    const Keyboard keyboard = parse_keyboard(find_embedded(Shipped::kKeyboards, name + ".json")->content, name);
    table +=
        fmt::format("{:<20} {:>9} {:>9}  {}\n", name, keyboard.first_key, keyboard.last_key, keyboard.description);
  }
  return table;
}

// The first and the last key of MIDI that an instrument plays, or that it has none.
std::string keys_of(const InstrumentModel& model) {
  const auto& ranges = model.keys.ranges;
  if (ranges.empty()) return "-";
  return fmt::format("{}-{}", std::ranges::min(ranges, {}, &KeyRange::first).first,
                     std::ranges::max(ranges, {}, &KeyRange::last).last);
}

std::string instruments() {
  std::string table = fmt::format("{:<20} {:>6} {:>12} {:>9} {:>7}  {}\n", "name", "bodies", "connections",
                                  "controls", "keys", "description");
  for (const std::string& name : shipped_names(Shipped::kInstruments)) {
    const InstrumentModel model = instrument_argument(name).value().model;
    std::size_t connections = 0;
    for (const ConnectionGroup& group : model.connections) connections += group.gaps_m.size();
    table += fmt::format("{:<20} {:>6} {:>12} {:>9} {:>7}  {}\n", name, model.bodies.size(), connections,
                         model.controls.size(), keys_of(model), model.description);
  }
  return table;
}

std::string scores() {
  std::string table = fmt::format("{:<20} {:<16} {:>12}  {}\n", "name", "instrument", "duration [s]", "description");
  for (const std::string& name : shipped_names(Shipped::kScores)) {
    const EmbeddedFile* midi = find_embedded(Shipped::kScores, name + ".mid");
    const EmbeddedFile* file = midi != nullptr ? midi : find_embedded(Shipped::kScores, name + ".json");
    const ScoreHeading score =
        midi != nullptr ? midi_score_heading(file->content, file->name) : score_heading(file->content, file->name);
    table +=
        fmt::format("{:<20} {:<16} {:>12.4g}  {}\n", name, score.instrument, score.duration_s, score.description);
  }
  return table;
}

struct ShippedKind {
  const char* name;
  Shipped folder;
  std::string (*table)();
};

constexpr std::array kShippedKinds = {ShippedKind{"materials", Shipped::kMaterials, materials},
                                      ShippedKind{"frictions", Shipped::kFrictions, frictions},
                                      ShippedKind{"resonators", Shipped::kResonators, resonators},
                                      ShippedKind{"keyboards", Shipped::kKeyboards, keyboards},
                                      ShippedKind{"instruments", Shipped::kInstruments, instruments},
                                      ShippedKind{"scores", Shipped::kScores, scores}};

// The file of that name, with or without its ending.
const EmbeddedFile* file_that_ships(const std::string& name) {
  for (const ShippedKind& kind : kShippedKinds)
    for (const char* ending : {"", ".json", ".mid"})
      if (const auto* file = find_embedded(kind.folder, name + ending)) return file;
  return nullptr;
}

}  // namespace

std::vector<std::string> kinds_that_ship() {
  std::vector<std::string> names;
  for (const ShippedKind& kind : kShippedKinds) names.emplace_back(kind.name);
  return names;
}

void list(const std::string& only) {
  std::string text;
  for (const ShippedKind& kind : kShippedKinds) {
    if (only.empty()) text += fmt::format("{}{}\n\n", text.empty() ? "" : "\n", kind.name);
    if (only.empty() || only == kind.name) text += kind.table();
  }
  write_stdout(text);
}

void show(const std::string& name, const std::string& own_name) {
  const EmbeddedFile* file = file_that_ships(name);
  if (file == nullptr) {
    std::vector<std::string> names;
    for (const ShippedKind& kind : kShippedKinds)
      for (std::string& shipped : shipped_names(kind.folder)) names.push_back(std::move(shipped));
    refuse(name, "NAME", "nothing of this name ships", names_in_short(std::move(names), name, "contactspline list"));
  }
  if (file->name.ends_with(".mid") && is_terminal(stdout))
    refuse(name, "NAME", "is a MIDI file, which a terminal cannot show", "to a file, with > FILE");
  if (own_name.empty()) return write_stdout(file->content);
  const auto named = fmt::format("{{\"name\": {}}}", json_string(own_name));
  (void)read_name(parse_json(named, "--name", "name", {"name"}), {});
  std::string text(file->content);
  const std::string key = fmt::format("\"name\": \"{}\"", file->name.substr(0, file->name.rfind('.')));
  const std::size_t at = text.find(key);
  if (at == std::string::npos)
    refuse(name, "--name", "the file has no name of its own", "with a material, resonator, keyboard or instrument");
  write_stdout(text.replace(at, key.size(), fmt::format("\"name\": \"{}\"", own_name)));
}

}  // namespace contactspline
