// SPDX-License-Identifier: MIT
#include "generator/instrument/output_reader.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {
namespace {

constexpr Range kFullScale{1e-9, 1e9};
constexpr double kMaxListening_m = 4;  // so much farther sound may come than the first: the filters are as long

// A loud sound of largest instruments.
double default_full_scale(std::string_view unit) {
  if (unit == "N") return 50;
  if (unit == "Pa") return 20;
  return unit == "m/s" ? 1 : 0.001;
}

/// Reads outputs, of which all pressures are heard together.
class OutputReader {
 public:
  explicit OutputReader(InstrumentDraft& draft) : draft_(draft), model_(draft.model) {}

  void read() {
    for (const JsonObject& output :
         draft_.json.objects("outputs",
                             {"name", "displacement_m", "velocity_m_per_s", "force_n", "end_force_n", "end_tension_n",
                              "pressure_pa", "distance_m", "angle_rad", "around_rad", "side_m", "full_scale"},
                             kMaxBodies))
      read_output(output);
  }

 private:
  void read_output(const JsonObject& json) {
    const std::string key = one_of_keys(
        json, {"displacement_m", "velocity_m_per_s", "force_n", "end_force_n", "end_tension_n", "pressure_pa"},
        "quantities");
    ModelOutput output{draft_.public_name(json, key.c_str()), OutputQuantity::kDisplacement, {}};
    if (key == "velocity_m_per_s") output.quantity = OutputQuantity::kVelocity;
    if (key == "force_n") output.quantity = OutputQuantity::kForce;
    if (key == "end_tension_n") output.quantity = OutputQuantity::kTension;
    if (key == "pressure_pa") return read_pressure(json, std::move(output));
    for (const char* other : {"distance_m", "angle_rad", "around_rad", "side_m"})
      if (json.has(other)) json.fail(json.key(other), fmt::format("stands beside {}", key), "beside pressure_pa");
    output.is_end_force = key == "end_force_n";
    output.full_scale =
        json.has("full_scale") ? json.number("full_scale", kFullScale) : default_full_scale(unit_of(output.name));
    for (const std::string& name :
         json.texts(key.c_str(), "the name of its source, or an array of names", kMaxObjects))
      output.targets.push_back(source_of(json, key, name));
    model_.outputs.push_back(std::move(output));
  }

  // What a listening place in the room takes of one body.
  void read_pressure(const JsonObject& json, ModelOutput output) {
    output.quantity = OutputQuantity::kPressure;
    output.full_scale = json.has("full_scale") ? json.number("full_scale", kFullScale) : default_full_scale("Pa");
    const std::size_t body =
        index_of(json, json.key("pressure_pa"), json.text("pressure_pa", joined(names_of(model_.bodies))),
                 model_.bodies, "body");
    output.targets.push_back(body);
    const Resonator& resonator = model_.bodies[body].resonator;
    check_radiation(resonator, json.file(), json.key("pressure_pa"));
    output.listening = read_listening_place(json);
    const Reach reach = reach_of(resonator.body, output.listening);
    check_reach(reach, json.file(), json.key("distance_m"));
    listening_ = {std::min(listening_.nearest_m, reach.nearest_m), std::max(listening_.farthest_m, reach.farthest_m)};
    if (listening_.farthest_m - listening_.nearest_m > kMaxListening_m)
      json.fail(json.key("distance_m"),
                fmt::format("the outputs are from {:.3g} to {:.3g} m away from points of their bodies",
                            listening_.nearest_m, listening_.farthest_m),
                fmt::format("distances that differ by at most {:g} m", kMaxListening_m));
    model_.outputs.push_back(std::move(output));
  }

  // What an output is the sum of.
  std::size_t source_of(const JsonObject& json, const std::string& key, const std::string& name) const {
    if (key == "force_n")
      return index_of(json, json.key(key), name, model_.connections, "contact, spring, link or friction");
    if (key != "end_force_n" && key != "end_tension_n") return place_that_stays(json, key, name);
    const std::size_t body = index_of(json, json.key(key), name, model_.bodies, "body");
    if (!std::holds_alternative<StiffString>(model_.bodies[body].resonator.body))
      json.fail(json.key(key), fmt::format("'{}' is not a string", name), "a string");
    if (key == "end_tension_n" && !model_.bodies[body].stretches())
      json.fail(json.key(key), fmt::format("'{}' has no `stretch`, so its tension stays", name),
                "a string with `stretch`");
    return body;
  }

  std::size_t place_that_stays(const JsonObject& json, const std::string& key, const std::string& name) const {
    const std::size_t place = draft_.single_place(json, key.c_str(), name);
    if (draft_.controlled.contains({ControlQuantity::kPlace, place}))
      json.fail(json.key(key), fmt::format("a control moves '{}'", name), "a place of its own that stays");
    return place;
  }

  InstrumentDraft& draft_;
  InstrumentModel& model_;
  Reach listening_{std::numeric_limits<double>::max(), 0};  // of all outputs that are pressures
};

}  // namespace

void read_outputs(InstrumentDraft& draft) {
  OutputReader(draft).read();
}

void read_input(InstrumentDraft& draft) {
  if (!draft.json.has("input")) return;
  const JsonObject json = draft.json.object("input", {"force_n", "full_scale"});
  ModelInput& input = draft.model.input;
  for (const std::string& name : json.texts("force_n", "the name of a place, or an array of names", kMaxObjects)) {
    const std::size_t place = draft.single_place(json, "force_n", name);
    if (std::ranges::find(input.places, place) != input.places.end())
      json.fail(json.key("force_n"), fmt::format("'{}' is named twice", name), "once");
    input.places.push_back(place);
  }
  input.full_scale_n = json.has("full_scale") ? json.number("full_scale", kFullScale) : default_full_scale("N");
}

void read_presets(InstrumentDraft& draft) {
  std::vector<std::string> keys = names_of(draft.model.parameters);
  keys.insert(keys.begin(), "name");
  for (const JsonObject& json : draft.objects("presets", keys)) {
    ModelPreset preset{read_line(json, "name", 64), {}};
    if (preset.name.empty()) json.fail(json.key("name"), "is empty", "a name such as bright");
    if (std::ranges::find(draft.model.presets, preset.name, &ModelPreset::name) != draft.model.presets.end())
      json.fail(json.key("name"), fmt::format("'{}' is the name of two presets", shown(preset.name)), "once");
    for (const ModelParameter& p : draft.model.parameters)
      preset.values.push_back(json.has(p.name.c_str()) ? json.number(p.name.c_str(), {p.allowed.min, p.allowed.max})
                                                       : p.initial);
    draft.model.presets.push_back(std::move(preset));
  }
}

}  // namespace contactspline
