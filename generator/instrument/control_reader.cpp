// SPDX-License-Identifier: MIT
#include "generator/instrument/control_reader.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "contactspline/midi/midi_meaning.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

constexpr double kFinger_n = 10, kArm_m_per_s = 1;
constexpr Range kForceOverSpeed{1e-3, 1e4};  // of a bow [N s/m]
constexpr int kMaxController = 119;

// The keys of what controls set, in the order of kControlQuantities.
std::vector<std::string> quantity_keys() {
  std::vector<std::string> keys;
  for (const auto& row : kControlQuantities<double>) keys.emplace_back(row.key);
  return keys;
}

/// Reads what is struck, then the controls.
class ControlReader {
 public:
  ControlReader(InstrumentDraft& draft, MovedMasses& masses) : draft_(draft), model_(draft.model), masses_(masses) {}

  void read() {
    if (draft_.json.has("strikes")) read_strikes();
    std::vector<std::string> keys = {"name", "initial", "min", "max", "release_n", "acts", "controller"};
    std::ranges::copy(quantity_keys(), std::back_inserter(keys));
    for (const JsonObject& control : draft_.objects("controls", keys)) read_control(control);
    add_events();
    read_bows();
  }

 private:
  void read_strikes() {
    for (const std::string& name : draft_.json.texts("strikes", "an array of masses", kMaxBodies)) {
      const std::size_t body = index_of(draft_.json, "strikes", name, model_.bodies, "body");
      if (!model_.bodies[body].is_mass)
        draft_.json.fail("strikes", fmt::format("'{}' is not a mass", name), "masses");
      model_.strikes.push_back(body);
      draft_.require_public(draft_.json, "strikes", speed_name(model_.strikes.size() - 1));
    }
  }

  void read_control(const JsonObject& json) {
    const std::vector<std::string> keys = quantity_keys();
    const std::string key = one_of_keys(json, keys, "quantities");
    ControlTargets control;
    control.quantity = kControlQuantities<double>[std::ranges::find(keys, key) - keys.begin()].quantity;
    const std::string name = draft_.public_name(json, key.c_str());
    for (const std::string& target_name :
         json.texts(key.c_str(), "the name of what it controls, or an array of names", kMaxObjects)) {
      const std::size_t target = target_of(json, key.c_str(), control.quantity, target_name);
      if (!draft_.controlled.insert({control.quantity, target}).second)
        json.fail(json.key(key), fmt::format("'{}' already has such a control", target_name), "one control for each");
      control.targets.push_back(target);
    }
    ModelParameter parameter = parameter_of(json, name, control);
    if (control.quantity == ControlQuantity::kGapShift) check_gaps(json, control, parameter.initial);
    if (control.quantity == ControlQuantity::kStiffnessRatio)
      for (const std::size_t group : control.targets)
        masses_.check_stiffness(json, "max", model_.connections[group], parameter.allowed.max);
    if (control.quantity == ControlQuantity::kPlace || control.quantity == ControlQuantity::kMass)
      masses_.check_lightest(json, control, parameter.allowed.min);
    if (json.has("release_n")) read_pluck(json, parameter, control.quantity);
    if (json.has("controller")) read_controller(json, parameter);
    if (control.quantity == ControlQuantity::kForce || control.quantity == ControlQuantity::kNormalForce)
      narrow_slider(json, parameter, kFinger_n);
    if (control.quantity == ControlQuantity::kSurfaceSpeed) narrow_slider(json, parameter, kArm_m_per_s);
    model_.parameters.push_back(std::move(parameter));
    model_.controls.push_back(std::move(control));
  }

  std::size_t target_of(const JsonObject& json, const char* key, ControlQuantity quantity,
                        const std::string& name) const {
    const std::string path = json.key(key);
    if (quantity == ControlQuantity::kDamping) return index_of(json, path, name, model_.bodies, "body");
    if (quantity == ControlQuantity::kForce) return draft_.single_place(json, key, name);
    if (quantity == ControlQuantity::kPlace) return place_on_string(json, key, name);
    if (quantity == ControlQuantity::kMass) return struck_mass(json, key, name);
    const std::size_t found = index_of(json, path, name, model_.connections, "contact, spring, link or friction");
    const ConnectionKind kind = model_.connections[found].each.kind;
    if (quantity == ControlQuantity::kGapShift) {
      if (kind == ConnectionKind::kFriction)
        json.fail(path, fmt::format("'{}' is a friction", name), "a contact, spring or link");
    } else if (quantity == ControlQuantity::kSurfaceSpeed && kind != ConnectionKind::kFriction) {
      if (model_.connections[found].each.roughness.height_m == 0)
        json.fail(path,
                  fmt::format("'{}' is a {}{}", name, name_of(kind),
                              kind == ConnectionKind::kContact ? " without roughness" : ""),
                  "a friction, or a contact with roughness");
    } else if (kind != kind_with(quantity)) {
      json.fail(path, fmt::format("'{}' is a {}", name, name_of(kind)),
                fmt::format("a {}", name_of(kind_with(quantity))));
    }
    return found;
  }

  // The kind of connection that has a quantity.
  [[nodiscard]] static ConnectionKind kind_with(ControlQuantity quantity) {
    switch (quantity) {
      case ControlQuantity::kStiffness:
      case ControlQuantity::kResistance:
        return ConnectionKind::kSpring;
      case ControlQuantity::kNormalForce:
      case ControlQuantity::kSurfaceSpeed:
        return ConnectionKind::kFriction;
      default:
        return ConnectionKind::kContact;
    }
  }

  // A place that a control may move: points of a string, which no rigid link holds.
  std::size_t place_on_string(const JsonObject& json, const char* key, const std::string& name) const {
    const std::size_t place = index_of(json, json.key(key), name, model_.places, "place");
    if (const InstrumentBody* body = model_.stretching_body())
      json.fail(json.key(key), fmt::format("stands in a file where '{}' has `stretch`", body->name),
                "places that move or `stretch`, one of the two");
    if (!std::holds_alternative<StiffString>(model_.bodies[model_.places[place].body].resonator.body))
      json.fail(json.key(key), fmt::format("'{}' is not on a string", name), "a place on a string");
    for (const ConnectionGroup& group : model_.connections)
      if (group.each.kind == ConnectionKind::kLink && (group.each.first == place || group.each.second == place))
        json.fail(json.key(key), fmt::format("the rigid link '{}' holds '{}' where it is", group.name, name),
                  "a place under contacts, springs or forces; a stiff spring instead of the link");
    return place;
  }

  std::size_t struck_mass(const JsonObject& json, const char* key, const std::string& name) const {
    const std::size_t body = index_of(json, json.key(key), name, model_.bodies, "body");
    if (std::ranges::find(model_.strikes, body) == model_.strikes.end())
      json.fail(json.key(key), fmt::format("'{}' is not struck", name), "a mass that `strikes` names");
    return body;
  }

  // What a control is before it is set: what the file says of its first target.
  [[nodiscard]] double value_of(ControlQuantity quantity, std::size_t target) const {
    switch (quantity) {
      case ControlQuantity::kStiffnessRatio:
        return 1;
      case ControlQuantity::kLoss:
        return model_.connections[target].each.loss_s_per_m;
      case ControlQuantity::kStiffness:
        return model_.connections[target].each.stiffness_n_per_m;
      case ControlQuantity::kResistance:
        return model_.connections[target].each.resistance_n_s_per_m;
      case ControlQuantity::kPlace:
        return model_.places[target].middle_m();
      case ControlQuantity::kMass:
        return mass_of(target);
      case ControlQuantity::kNormalForce:
        return model_.connections[target].each.friction.normal_force_n;
      case ControlQuantity::kSurfaceSpeed:
        return model_.connections[target].each.friction.surface_speed_m_per_s;
      default:
        return 0;
    }
  }

  [[nodiscard]] double mass_of(std::size_t body) const {
    return std::get<ModeTable>(model_.bodies[body].resonator.body).rows.front().mode.mass_kg;
  }

  // The values that a control may take, and its first one.
  [[nodiscard]] ModelParameter parameter_of(const JsonObject& json, const std::string& name,
                                            const ControlTargets& control) const {
    Range all = range_of(control.quantity);
    if (control.quantity == ControlQuantity::kPlace)
      for (const std::size_t place : control.targets) narrow_to_string(model_.places[place], all);
    const Range range{json.has("min") ? json.number("min", all) : all.min,
                      json.has("max") ? json.number("max", all) : all.max};
    if (!(range.min < range.max))
      json.fail(json.key(json.has("max") ? "max" : "min"), "leaves no range", "min below max");
    const double initial =
        json.has("initial") ? json.number("initial", range) : value_of(control.quantity, control.targets.front());
    if (initial < range.min || initial > range.max)
      json.fail(json.key("initial"), fmt::format("missing, and the file begins with {}", initial),
                fmt::format("{} to {}", range.min, range.max));
    const bool waits = acts_at_next_note(json, control.quantity);
    const bool is_logarithmic = range.min > 0 && range.max >= 100 * range.min;
    return {.name = name,
            .unit = std::string(unit_of(name)),
            .allowed = {range.min, range.max},
            .slider = {range.min, range.max},
            .initial = initial,
            .scale = is_logarithmic ? Scale::kLogarithmic : Scale::kLinear,
            .acts = waits ? Acts::kAtNextNote : Acts::kAtOnce,
            .glide_s = waits ? 0 : control_quantity<double>(control.quantity).glide_s};
  }

  // Where the middle of points may be that stay on their string.
  void narrow_to_string(const InstrumentPlace& place, Range& range) const {
    const double length_m = extent_of(model_.bodies[place.body].resonator.body);
    for (const Place& point : place.points) {
      const double offset_m = point.position_m - place.middle_m();
      range.min = std::max(range.min, rounded_to(-offset_m, 13));
      range.max = std::min(range.max, rounded_to(length_m - offset_m, 13));
    }
  }

  static bool acts_at_next_note(const JsonObject& json, ControlQuantity quantity) {
    const bool is_mass = quantity == ControlQuantity::kMass;
    if (!json.has("acts")) return is_mass;
    constexpr auto kAllowed = "at_once or at_next_note";
    const std::string acts = json.text("acts", kAllowed);
    if (acts != "at_once" && acts != "at_next_note")
      json.fail(json.key("acts"), fmt::format("'{}' is neither", shown(acts)), kAllowed);
    if (is_mass && acts == "at_once") json.fail(json.key("acts"), "is at_once beside a mass", "at_next_note");
    if (quantity == ControlQuantity::kForce && acts == "at_next_note")
      json.fail(json.key("acts"), "is at_next_note beside a force", "at_once, or release_n for a pluck");
    return acts == "at_next_note";
  }

  // A shifted gap stays within the range of a gap.
  void check_gaps(const JsonObject& json, const ControlTargets& control, double initial) const {
    for (const std::size_t target : control.targets)
      for (const double gap : model_.connections[target].gaps_m)
        if (!(std::abs(gap + initial) <= kGap.max))
          json.fail(json.key("initial"),
                    fmt::format("{} m added to the gap {} m of '{}' is out of range", initial, gap,
                                model_.connections[target].name),
                    fmt::format("a sum from {} to {} m", kGap.min, kGap.max));
  }

  void read_pluck(const JsonObject& json, const ModelParameter& control, ControlQuantity quantity) {
    if (quantity != ControlQuantity::kForce)
      json.fail(json.key("release_n"), "is not for this control", "beside force_n");
    const double release_n = json.number("release_n", {control.allowed.min, control.allowed.max});
    if (release_n == 0) json.fail(json.key("release_n"), "plucks without force", "not 0");
    const std::string stem = control.name.substr(0, control.name.size() - std::string_view("_force_n").size());
    plucks_.push_back({.name = stem + "_release_n",
                       .unit = "N",
                       .allowed = control.allowed,
                       .slider = {std::max(control.allowed.min, std::min(0.0, 2 * release_n)),
                                  std::min(control.allowed.max, std::max(0.0, 2 * release_n))},
                       .initial = release_n,
                       .acts = Acts::kAtNextNote});
    model_.plucks.push_back(model_.controls.size());
  }

  // What of MIDI moves a control.
  static void read_controller(const JsonObject& json, ModelParameter& parameter) {
    if (json.has_text("controller")) {
      constexpr auto kAllowed = "\"pressure\" or an integer from 1 to 119";
      const std::string name = json.text("controller", kAllowed);
      if (name != "pressure")
        json.fail(json.key("controller"), fmt::format("'{}' is unknown", shown(name)), kAllowed);
      parameter.controller = kPressureController;
    } else {
      parameter.controller = static_cast<unsigned char>(json.integer("controller", 1, kMaxController));
    }
    for (const int pedal : kMidiPedals)
      if (parameter.controller == pedal)
        json.fail(json.key("controller"), fmt::format("{} is a pedal", pedal), "another number, such as 2 or 74");
  }

  // What is bowed, and the parameters that all bows share.
  void read_bows() {
    for (const JsonObject& row : draft_.objects("bows", {"friction", "min_n_s_per_m", "max_n_s_per_m"})) {
      const std::string name = row.text("friction", "the name of a friction");
      const std::size_t group =
          index_of(row, row.key("friction"), name, model_.connections, "contact, spring, link or friction");
      if (model_.connections[group].each.kind != ConnectionKind::kFriction)
        row.fail(row.key("friction"), fmt::format("'{}' is a {}", name, name_of(model_.connections[group].each.kind)),
                 "a friction");
      if (std::ranges::find(model_.bows, group, &ModelBow::group) != model_.bows.end())
        row.fail(row.key("friction"), fmt::format("'{}' is named twice", name), "once");
      for (const ControlQuantity quantity : {ControlQuantity::kNormalForce, ControlQuantity::kSurfaceSpeed})
        if (value_of(quantity, group) == 0 && !draft_.controlled.contains({quantity, group}))
          row.fail(row.key("friction"), fmt::format("'{}' has no {}", name, control_quantity<double>(quantity).key),
                   fmt::format("{0} in the friction, or a control of it", control_quantity<double>(quantity).key));
      model_.events.push_back({"bow_" + name, EventKind::kBow, model_.bows.size(), model_.parameters.size()});
      model_.bows.push_back({group, limits_of(row)});
    }
    if (model_.bows.empty()) return;
    add_bow_parameter({.name = "bow_acceleration_m_per_s2",
                       .unit = "m/s2",
                       .allowed = {0, 1000},
                       .slider = {0, 50},
                       .initial = 5,
                       .acts = Acts::kAtNextNote});
    if (std::ranges::none_of(model_.bows, [](const ModelBow& bow) { return bow.limits.max_n_s_per_m > 0; })) return;
    model_.assistance = model_.parameters.size();
    add_bow_parameter({.name = "assistance", .unit = "", .allowed = {0, 1}, .slider = {0, 1}, .initial = 1});
  }

  void add_bow_parameter(ModelParameter parameter) {
    draft_.require_public(draft_.json, "bows", parameter.name);
    model_.parameters.push_back(std::move(parameter));
  }

  static BowLimits limits_of(const JsonObject& row) {
    const bool has_min = row.has("min_n_s_per_m");
    if (has_min != row.has("max_n_s_per_m"))
      row.fail(row.key(has_min ? "max_n_s_per_m" : "min_n_s_per_m"), "is missing",
               "both limits of the force over the speed, or none");
    if (!has_min) return {};
    const double min = row.number("min_n_s_per_m", kForceOverSpeed);
    const double max = row.number("max_n_s_per_m", kForceOverSpeed);
    if (!(min < max))
      row.fail(row.key("min_n_s_per_m"), fmt::format("{} is not below {}", min, max), "min below max");
    return {min, max};
  }

  // A force or a speed without limits of its own is played up to what a finger or an arm does.
  static void narrow_slider(const JsonObject& json, ModelParameter& parameter, double by_hand) {
    const double largest = std::max(by_hand, 2 * std::abs(parameter.initial));
    if (!json.has("min")) parameter.slider.min = std::max(parameter.slider.min, -largest);
    if (!json.has("max")) parameter.slider.max = std::min(parameter.slider.max, largest);
  }

  // The parameters of strikes and plucks, after those of the controls, and the events.
  void add_events() {
    for (std::size_t s = 0; s < model_.strikes.size(); ++s) {
      const std::string& mass = model_.bodies[model_.strikes[s]].name;
      model_.events.push_back({"strike_" + mass, EventKind::kStrike, s, model_.parameters.size()});
      model_.parameters.push_back({.name = speed_name(s),
                                   .unit = "m/s",
                                   .allowed = {-100, 100},
                                   .slider = {0, 10},
                                   .initial = 2.5,
                                   .acts = Acts::kAtNextNote});
    }
    for (std::size_t p = 0; p < plucks_.size(); ++p) {
      const std::string stem =
          plucks_[p].name.substr(0, plucks_[p].name.size() - std::string_view("_release_n").size());
      model_.events.push_back({"pluck_" + stem, EventKind::kPluck, p, model_.parameters.size()});
      model_.parameters.push_back(plucks_[p]);
    }
  }

  [[nodiscard]] std::string speed_name(std::size_t strike) const {
    return model_.bodies[model_.strikes[strike]].name + "_speed_m_per_s";
  }

  InstrumentDraft& draft_;
  InstrumentModel& model_;
  MovedMasses& masses_;
  std::vector<ModelParameter> plucks_;
};

}  // namespace

void read_controls(InstrumentDraft& draft, MovedMasses& masses) {
  ControlReader(draft, masses).read();
}

}  // namespace contactspline
