// SPDX-License-Identifier: MIT
#include "hosts/python/makers.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "generator/cli/inputs.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"
#include "hosts/named_instruments.hpp"
#include "hosts/python/own_keyboard.hpp"

namespace contactspline::python {
namespace {

using Json = nlohmann::json;

constexpr std::array kModels = {Model::kHammerString, Model::kSlideString, Model::kFretString};

// What a score calls hammer-string is an identifier here.
std::string identifier_of(Model model) {
  std::string name(name_of(model));
  std::ranges::replace(name, '-', '_');
  return name;
}

// Objects that stand for files: a score names them by paths that no file system has.
class Objects {
 public:
  void replace(Json& parts, const char* key) {
    if (!parts.contains(key) || !parts[key].is_object()) return;
    const std::string path = std::string(key) + ".json";
    texts_[path] = parts[key].dump();
    parts[key] = path;
  }
  [[nodiscard]] std::string read(const std::string& path) const {
    const auto found = texts_.find(path);
    return found != texts_.end() ? found->second : read_input(path);
  }

 private:
  std::map<std::string, std::string> texts_;
};

// A voice of a score: its reader knows the keys, their units and ranges.
InstrumentMaker model_maker(Model model, Json parts) {
  Objects objects;
  objects.replace(parts, "resonator");
  objects.replace(parts, "material");
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
  Score read =
      parse_score(score.dump(), identifier_of(model), [&](const std::string& path) { return objects.read(path); });
  return maker_of_voice(model, std::move(read.voices.front()));
}

InstrumentMaker mass_barrier_maker(const Json& parts) {
  for (const auto& [key, value] : parts.items())
    if (key != "material") refuse("mass_barrier", key, "is unknown", "material");
  if (!parts.contains("material")) refuse("mass_barrier", "material", "missing", "a name, a path or an object");
  const Json& material = parts["material"];
  if (!material.is_string() && !material.is_object())
    refuse("mass_barrier", "material", "is no material", "a name, a path or an object, such as \"felt_c4\"");
  return maker_of_mass_barrier(material.is_object() ? design_material(material.dump(), "material.json", read_input)
                                                    : design_argument(material.get<std::string>()));
}

// A score plays all keys once, so that its reader designs their felts.
InstrumentMaker keyboard_maker(Json parts) {
  for (const auto& [key, value] : parts.items())
    if (key != "keyboard") refuse("piano", key, "is no part of this instrument", "keyboard");
  Objects objects;
  objects.replace(parts, "keyboard");
  if (!parts["keyboard"].is_string())
    refuse("piano", "keyboard", "is no keyboard", "a name, a path or an object, such as \"piano\"");
  const auto read = [&](const std::string& path) { return objects.read(path); };
  const NamedText named =
      named_text("piano", "keyboard", parts["keyboard"].get<std::string>(), Shipped::kKeyboards, read);
  Keyboard keyboard = parse_keyboard(named.text, named.file);
  if (!keyboard.body) refuse(named.file, "keyboard.body", "missing", "one such as that of the piano that ships");
  Json keys = Json::array();
  for (int key = keyboard.first_key; key <= keyboard.last_key; ++key)
    keys.push_back({{"time_s", 0}, {"key", key}, {"hold_s", 0}});
  const Json score = {
      {"instrument", "hammer-string"}, {"duration_s", 1}, {"keyboard", parts["keyboard"]}, {"events", keys}};
  const auto made =
      std::make_shared<const OwnKeyboardParts>(std::move(keyboard), parse_score(score.dump(), "piano", read));
  return InstrumentMaker::of(
      [made](auto precision, double rate) -> std::unique_ptr<AnyInstrument<decltype(precision)>> {
        return std::make_unique<InstrumentBehind<OwnKeyboard<decltype(precision)>>>(made, rate);
      });
}

}  // namespace

InstrumentMaker maker_of(const std::string& source, bool is_text, const std::string& parts_text) {
  Json parts = Json::parse(parts_text);
  if (parts.empty()) return is_text ? maker_of_text(source, "instrument") : maker_of_name(source);
  if (!is_text) {
    for (const Model model : kModels)
      if (source == identifier_of(model)) return model_maker(model, std::move(parts));
    if (source == "mass_barrier") return mass_barrier_maker(parts);
    if (source == "piano") return keyboard_maker(std::move(parts));
  }
  refuse(is_text ? "instrument" : source, parts.begin().key(), "is no part of this instrument",
         "no keys: set its parameters instead");
}

}  // namespace contactspline::python
