// SPDX-License-Identifier: MIT
#include "hosts/python/makers.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "generator/player/score_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"
#include "generator/support/json_reader.hpp"
#include "hosts/named_instruments.hpp"

namespace contactspline::python {
namespace {

using Json = nlohmann::json;

// A voice of a score: its reader knows the keys, their units and ranges.
InstrumentMaker model_maker(Model model, Json parts) {
  // A score has an event at least: a note, which nobody plays.
  const auto& [name, parameters, events, pluck_force, voice_keys] = rules_of(model);
  Json first = {{"time_s", 0}, {parameters[events.front().parameter].name, 1}};
  for (const Parameter& parameter : parameters) {
    if (!parts.contains(parameter.name)) continue;
    if (std::ranges::find(voice_keys, std::string_view(parameter.name)) != voice_keys.end()) continue;
    first[parameter.name] = parts[parameter.name];
    parts.erase(parameter.name);
  }
  parts["name"] = identifier_of(model);
  const Json score = {{"instrument", name_of(model)},
                      {"duration_s", 1},
                      {"voices", Json::array({std::move(parts)})},
                      {"events", Json::array({std::move(first)})}};
  Score read = parse_score(score.dump(), identifier_of(model), read_input);
  return maker_of_voice(model, std::move(read.voices.front()));
}

InstrumentMaker keyboard_maker(const Json& parts) {
  for (const auto& [key, value] : parts.items())
    if (key != "keyboard") refuse("piano", key, "is no part of this instrument", "keyboard");
  return maker_of_keyboard(parts["keyboard"].dump(), "piano", read_input);
}

}  // namespace

InstrumentMaker maker_of(const std::string& source, bool is_text, const std::string& parts_text) {
  Json parts = Json::parse(parts_text);
  if (parts.empty()) return is_text ? maker_of_text(source, "instrument") : maker_of_name(source);
  if (!is_text) {
    if (const auto model = model_with_parts(source)) return model_maker(*model, std::move(parts));
    if (source == "mass_barrier")
      return maker_of_mass_barrier(parse_json(parts_text, source, "instrument", {"material"}), read_input);
    if (source == "piano") return keyboard_maker(parts);
  }
  refuse(is_text ? "instrument" : source, parts.begin().key(), "is no part of this instrument",
         "no keys: set its parameters instead");
}

}  // namespace contactspline::python
