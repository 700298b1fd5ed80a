// SPDX-License-Identifier: MIT
#include "generator/instrument/instrument_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include "generator/material/named_file.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/designed_materials.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kMaxBodies = 64;
constexpr std::size_t kMaxPoints = 512;  // for all places together; the same for connections
constexpr std::size_t kMaxObjects = 256;
constexpr Range kGap{ControlRanges<double>::gap_m.min, ControlRanges<double>::gap_m.max};
constexpr Range kWeight{1e-9, 1e9};
// Of a contact at its steepest with the masses that it moves. Rounding of forces that cancel each other moves it by a
// part of its compression that rises with the square (docs/how-it-works/several-contacts.md).
constexpr double kMaxContactFrequency_hz = 1e9;
constexpr Range kStiffness{0, 1e9};
constexpr Range kResistance{0, 1e6};
constexpr Range kFullScale{1e-9, 1e9};
constexpr double kMaxListening_m = 4;  // so much farther sound may come than the first: the filters are as long
constexpr unsigned char kSustainController = 64;
constexpr int kMaxKey = 127, kMaxVoices = 64;
constexpr int kMaxSemitones = 24;   // that a key may tune
constexpr int kVoices = 8;          // of keys that tune
constexpr double kGlide_s = 0.005;  // of forces and dampings, which would click
constexpr double kPlaceGlide_s = 0.02;
constexpr double kFinger_n = 10;
constexpr auto kGroundName = "ground";

// Members of the emitted C++ class and a parameter, which must not be called like it.
constexpr const char* kMemberNames[] = {
    "tick",          "process",  "output",  "energy",    "work",           "dissipated",
    "network",       "reset",    "strike",  "release",   "pluck",          "data",
    "speed",         "value",    "set",     "prepare",   "name",           "events",
    "contact_force", "ground",   "samples", "is_silent", "format_version", "sample_rate_hz",
    "parameters",    "outputs",  "presets", "force",     "note_on",        "description",
    "value_type",    "note_off", "tune",    "keyed",     "voice",          "license"};

constexpr std::array kQuantities = {
    ControlQuantity::kForce,      ControlQuantity::kDamping,  ControlQuantity::kStiffnessRatio,
    ControlQuantity::kLoss,       ControlQuantity::kGapShift, ControlQuantity::kStiffness,
    ControlQuantity::kResistance, ControlQuantity::kPlace,    ControlQuantity::kMass};

std::string joined(const std::vector<std::string>& names) {
  return names.empty() ? "none, for the file has no such object"
                       : shown(fmt::format("{}", fmt::join(names, ", ")), 240);
}

/// Reads an instrument, part after part.
class Reader {
 public:
  Reader(const JsonObject& json, const ReadFile& read) : json_(json), read_(read), materials_(read) {}

  InstrumentModel read() {
    model_.name = read_name(json_, kMemberNames);
    for (const char* prefix : {"set_", "strike_", "pluck_"})
      if (model_.name.starts_with(prefix))
        json_.fail("name", fmt::format("begins with {}", prefix), "a name that no member of the emitted class has");
    model_.description = read_description(json_);
    model_.license = read_license(json_);
    for (const JsonObject& body : json_.objects("bodies", kBodyKeys, kMaxBodies)) read_body(body);
    for (const JsonObject& place : optional_objects("places", {"name", "body", "position_m", "angle_rad", "across_m",
                                                               "positions_m", "mean_radius_m", "shapes"}))
      read_place(place);
    for (const JsonObject& contact :
         optional_objects("contacts", {"name", "between", "material", "gap_m", "gaps_m", "weight", "weights"}))
      read_contact(contact);
    for (const JsonObject& spring : optional_objects(
             "springs", {"name", "between", "stiffness_n_per_m", "resistance_n_s_per_m", "gap_m", "gaps_m"}))
      read_spring(spring);
    for (const JsonObject& link : optional_objects("links", {"name", "between", "gap_m", "gaps_m"})) read_link(link);
    if (connections_ > kMaxPoints)
      json_.fail("contacts", fmt::format("the file has {} connections", connections_),
                 fmt::format("at most {}, points of profiles included", kMaxPoints));
    std::vector<std::string> keys = {"name", "initial", "min", "max", "release_n", "acts"};
    for (const ControlQuantity quantity : kQuantities) keys.emplace_back(key_of(quantity));
    if (json_.has("strikes")) read_strikes();
    for (const JsonObject& control : optional_objects("controls", keys)) read_control(control);
    add_events();
    read_keys();
    for (const JsonObject& output :
         json_.objects("outputs",
                       {"name", "displacement_m", "velocity_m_per_s", "force_n", "end_force_n", "pressure_pa",
                        "distance_m", "angle_rad", "around_rad", "side_m", "full_scale"},
                       kMaxBodies))
      read_output(output);
    read_presets();
    return std::move(model_);
  }

 private:
  [[nodiscard]] std::vector<JsonObject> optional_objects(const char* name,
                                                         const std::vector<std::string>& keys) const {
    return json_.has(name) ? json_.objects(name, keys, kMaxObjects) : std::vector<JsonObject>{};
  }

  // The name of a body, place or connection, which no other one has.
  std::string read_own_name(const JsonObject& object) {
    std::string name = read_local_name(object, kGroundName);
    if (!names_.insert(name).second)
      object.fail(object.key("name"), fmt::format("'{}' is the name of two objects", name), "once");
    return name;
  }

  // The name of a control or an output with its quantity, which no other one has.
  std::string read_public_name(const JsonObject& object, const char* quantity) {
    std::string name = read_local_name(object) + "_" + quantity;
    require_public(object, object.key("name"), name);
    return name;
  }

  void require_public(const JsonObject& object, std::string_view key, const std::string& name) {
    if (name == model_.name || !public_names_.insert(name).second)
      object.fail(key, fmt::format("'{}' stands for two things", name), "another name");
  }

  template <typename Objects>
  [[nodiscard]] static std::vector<std::string> names_of(const Objects& objects) {
    std::vector<std::string> names;
    for (const auto& object : objects) names.push_back(object.name);
    return names;
  }

  // Index of the object that a key names.
  template <typename Objects>
  static std::size_t index_of(const JsonObject& json, std::string_view key, const std::string& name,
                              const Objects& objects, const char* what) {
    const auto found = std::ranges::find(objects, name, [](const auto& object) { return object.name; });
    if (found == objects.end())
      json.fail(key, fmt::format("'{}' is no {}", shown(name), what), joined(names_of(objects)));
    return static_cast<std::size_t>(found - objects.begin());
  }

  static std::string one_of_keys(const JsonObject& json, const std::vector<std::string>& keys, const char* what) {
    std::vector<std::string> given;
    std::ranges::copy_if(keys, std::back_inserter(given),
                         [&](const std::string& key) { return json.has(key.c_str()); });
    if (given.size() != 1)
      json.fail(json.key(given.empty() ? keys.front() : given[1]), fmt::format("{} {} are given", given.size(), what),
                fmt::format("just one of {}", fmt::join(keys, ", ")));
    return given.front();
  }

  void read_body(const JsonObject& body) {
    InstrumentBody read{read_own_name(body), {}, false};
    const std::string kind =
        one_of_keys(body, {"resonator", "string", "bar", "membrane", "plate", "modes", "mass_kg"}, "kinds of body");
    if (kind == "mass_kg") {
      read.is_mass = true;
      read.resonator = {read.name, "", ModeTable{{{{0, 0, body.number("mass_kg", kModalMass_kg)}, 1, 1}}}, {}, {}, 1};
      model_.places.push_back({read.name, model_.bodies.size(), {Place{}}});
    } else if (kind == "resonator") {
      const NamedText named = read_named(body, "resonator", Shipped::kResonators, read_);
      read.resonator = parse_resonator(named.text, named.file);
    } else {
      read.resonator = {read.name, "", kind == "modes" ? read_modes(body) : read_shaped_body(body),
                        {},        {}, kMaxModes};
      read.resonator.max_modes = max_modes_of(read.resonator.body);
    }
    read_modifiers(body, read);
    model_.bodies.push_back(std::move(read));
  }

  static decltype(Resonator::body) read_modes(const JsonObject& body) {
    ModeTable table;
    for (const JsonObject& row : body.objects("modes", {"frequency_hz", "decay_per_s", "mass_kg"}, kMaxModes))
      table.rows.push_back({{2 * std::numbers::pi * row.number("frequency_hz", kModeFrequency_hz),
                             row.number("decay_per_s", kModeDecay_per_s), row.number("mass_kg", kModalMass_kg)},
                            0,
                            0});
    return table;
  }

  static void read_modifiers(const JsonObject& body, InstrumentBody& read) {
    auto* string = std::get_if<StiffString>(&read.resonator.body);
    if (string != nullptr && string->detuning_cents.size() != 1)
      body.fail(body.key(body.has("resonator") ? "resonator" : "string"), "has several strings", "one body each");
    if (body.has("tuning_cents")) {
      if (string == nullptr) body.fail(body.key("tuning_cents"), "is not for this body", "beside strings");
      string->detuning_cents.front() += body.number("tuning_cents", kTuningCents);
    }
    if (body.has("max_modes")) {
      if (read.is_mass) body.fail(body.key("max_modes"), "is not for a mass", "beside resonators");
      read.resonator.max_modes = body.integer("max_modes", 1, max_modes_of(read.resonator.body));
    }
  }

  void read_place(const JsonObject& place) {
    InstrumentPlace read{read_own_name(place), 0, {}};
    const std::string name = place.text("body", joined(names_of(model_.bodies)));
    read.body = index_of(place, place.key("body"), name, model_.bodies, "body");
    const InstrumentBody& body = model_.bodies[read.body];
    if (body.is_mass)
      place.fail(place.key("body"), fmt::format("'{}' is a mass", name), "a resonator; a mass is itself a place");
    if (const auto* table = std::get_if<ModeTable>(&body.resonator.body)) {
      for (const char* key : {"position_m", "positions_m", "angle_rad", "across_m", "mean_radius_m"})
        if (place.has(key)) place.fail(place.key(key), "has no meaning on a table of modes", "shapes");
      read.shapes = place.numbers("shapes", kModeShape, kMaxModes);
      if (read.shapes.size() != table->rows.size())
        place.fail(place.key("shapes"), fmt::format("has {} entries", read.shapes.size()),
                   fmt::format("one for each of the {} modes", table->rows.size()));
      read.points.emplace_back();
    } else {
      read_points(place, body, read);
    }
    points_ += read.points.size();
    if (points_ > kMaxPoints)
      place.fail(place.key("name"), fmt::format("the places have more than {} points", kMaxPoints), "fewer points");
    model_.places.push_back(std::move(read));
  }

  static void read_points(const JsonObject& place, const InstrumentBody& body, InstrumentPlace& read) {
    if (place.has("shapes")) place.fail(place.key("shapes"), "is not for this body", "position_m or positions_m");
    const bool is_round = std::holds_alternative<Membrane>(body.resonator.body);
    if (place.has("mean_radius_m")) {
      if (!is_round) place.fail(place.key("mean_radius_m"), "is not for this body", "on a membrane");
      for (const char* key : {"position_m", "positions_m", "angle_rad"})
        if (place.has(key)) place.fail(place.key(key), "stands beside mean_radius_m", "one of the two");
      read.points.push_back(
          {.position_m = 0, .mean_radius_m = place.number("mean_radius_m", {1e-6, extent_of(body.resonator.body)})});
      return;
    }
    if (place.has("angle_rad") && !is_round)
      place.fail(place.key("angle_rad"), "is not for this body", "on a membrane");
    const auto* plate = std::get_if<Plate>(&body.resonator.body);
    if (place.has("across_m") && plate == nullptr)
      place.fail(place.key("across_m"), "is not for this body", "on a plate");
    const double across = plate != nullptr ? place.number("across_m", {0, plate->width_m}) : 0;
    const double angle = place.has("angle_rad") ? place.number("angle_rad", kPlaceAngle_rad) : 0;
    // On a membrane a negative radius lies on the other side of the centre.
    const double extent = extent_of(body.resonator.body);
    const Range range{is_round ? -extent : 0, extent};
    const std::string key = one_of_keys(place, {"position_m", "positions_m"}, "kinds of position");
    const auto positions = key == "position_m" ? std::vector{place.number("position_m", range)}
                                               : place.numbers("positions_m", range, kMaxPoints);
    for (const double position : positions)
      read.points.push_back({std::abs(position), position < 0 ? angle + std::numbers::pi : angle, across});
  }

  // The places of a connection and its gaps.
  ConnectionGroup read_group(const JsonObject& json, ConnectionKind kind) {
    ConnectionGroup group{read_own_name(json), {kind, kGround, kGround}, {}};
    constexpr auto kAllowed = "an array of two places, one of which may be ground";
    const auto between = json.texts("between", kAllowed, 2);
    if (between.size() != 2) json.fail(json.key("between"), "names one place", kAllowed);
    const auto place_of = [&](const std::string& name) {
      return name == kGroundName ? kGround : index_of(json, json.key("between"), name, model_.places, "place");
    };
    group.each.first = place_of(between[0]);
    group.each.second = place_of(between[1]);
    check_ends(json, group.each);
    for (const std::size_t place : {group.each.first, group.each.second}) check_motion(json, place);
    const std::size_t size = std::max(points_of(group.each.first), points_of(group.each.second));
    for (const std::size_t place : {group.each.first, group.each.second})
      if (points_of(place) != 1 && points_of(place) != size)
        json.fail(json.key("between"), "joins lists of different length", "places with as many points, or with one");
    group.gaps_m = read_column(json, "gap_m", "gaps_m", kGap, 0, size);
    connections_ += size;
    return group;
  }

  void check_ends(const JsonObject& json, const InstrumentConnection& each) const {
    if (each.first == kGround && each.second == kGround)
      json.fail(json.key("between"), "joins the ground with itself", "a place of a body");
    if (each.first == kGround || each.second == kGround) return;
    const std::size_t body = model_.places[each.first].body;
    if (body == model_.places[each.second].body)
      json.fail(json.key("between"), fmt::format("joins body '{}' with itself", model_.bodies[body].name),
                "places of two bodies");
  }

  // A connection moves what it holds, and no less than the lightest mass of a file.
  void check_motion(const JsonObject& json, std::size_t place) {
    if (place == kGround || masses_kg_.contains(place)) return;
    const std::string& name = model_.places[place].name;
    for (std::size_t i = 0; i < points_of(place); ++i) {
      const double mass = masses_kg_[place].emplace_back(effective_mass(model_, place, i));
      if (!(mass < std::numeric_limits<double>::max()))
        json.fail(json.key("between"), fmt::format("no mode moves at place '{}'", name),
                  "a place away from supports and edges, or ground");
      if (mass < kModalMass_kg.min)
        json.fail(
            json.key("between"),
            fmt::format("place '{}' moves like a mass of {:.3g} kg, 1/(sum of shape^2/mass)", name, mass),
            fmt::format("at least {} kg, with smaller shapes, larger masses or fewer modes", kModalMass_kg.min));
    }
  }

  // No contact is too stiff for the masses that it moves, at this stiffness ratio. key: what makes it stiffer.
  void check_stiffness(const JsonObject& json, const std::string& key, const ConnectionGroup& group,
                       double ratio) const {
    double steepest = 0;
    for (const Segment<double>& segment : model_.tables[group.each.table].segments)
      steepest = std::max(steepest, 2 * segment.half_curvature);
    for (std::size_t i = 0; i < group.weights.size(); ++i) {
      double inverse_mass = 0;
      for (const std::size_t place : {group.each.first, group.each.second})
        if (place != kGround) inverse_mass += 1 / masses_kg_.at(place)[points_of(place) == 1 ? 0 : i];
      const double stiffness = steepest * group.weights[i] * ratio;
      const double frequency_hz = std::sqrt(stiffness * inverse_mass) / (2 * std::numbers::pi);
      if (frequency_hz <= kMaxContactFrequency_hz) continue;
      const double too_large = std::pow(frequency_hz / kMaxContactFrequency_hz, 2);
      json.fail(json.key(key),
                fmt::format("contact '{}' with {:.3g} N/m oscillates on the {:.3g} kg that it moves at {:.3g} Hz",
                            group.name, stiffness, 1 / inverse_mass, frequency_hz),
                fmt::format("at most {:g} Hz: larger masses, or a {} of at most {:.2g}", kMaxContactFrequency_hz,
                            key == "max" || key == "weights" ? key : "weight",
                            (key == "max" ? ratio : group.weights[i]) / too_large));
    }
  }

  // Contacts are not too stiff where a control moves their place or makes their mass lightest.
  void check_lightest(const JsonObject& json, const ControlTargets& control, double min_mass_kg) {
    const bool moves = control.quantity == ControlQuantity::kPlace;
    for (const std::size_t target : control.targets) {
      const std::size_t place = moves ? target : place_of_mass(target);
      if (!masses_kg_.contains(place)) continue;  // nothing touches it
      masses_kg_[place] = {moves ? effective_mass(model_, place, 0, true) : min_mass_kg};
      for (const ConnectionGroup& group : model_.connections)
        if (group.each.kind == ConnectionKind::kContact && (group.each.first == place || group.each.second == place))
          check_stiffness(json, moves ? "place_m" : "min", group, largest_ratio(group));
    }
  }

  [[nodiscard]] std::size_t place_of_mass(std::size_t body) const {
    return static_cast<std::size_t>(std::ranges::find(model_.places, body, &InstrumentPlace::body) -
                                    model_.places.begin());
  }
  [[nodiscard]] double mass_of(std::size_t body) const {
    return std::get<ModeTable>(model_.bodies[body].resonator.body).rows.front().mode.mass_kg;
  }

  // The largest stiffness ratio that the controls so far may give a contact.
  [[nodiscard]] double largest_ratio(const ConnectionGroup& group) const {
    double largest = 1;
    for (std::size_t c = 0; c < model_.controls.size(); ++c)
      for (const std::size_t target : model_.controls[c].targets)
        if (model_.controls[c].quantity == ControlQuantity::kStiffnessRatio && &model_.connections[target] == &group)
          largest = std::max(largest, model_.parameters[c].allowed.max);
    return largest;
  }

  [[nodiscard]] std::size_t points_of(std::size_t place) const {
    return place == kGround ? 1 : model_.places[place].points.size();
  }

  // One number for all connections of a group, or one for each.
  static std::vector<double> read_column(const JsonObject& json, const char* one, const char* each, Range range,
                                         double otherwise, std::size_t size) {
    if (json.has(one) && json.has(each))
      json.fail(json.key(each), fmt::format("stands beside {}", one), "one of the two");
    if (!json.has(each)) return std::vector(size, json.has(one) ? json.number(one, range) : otherwise);
    auto numbers = json.numbers(each, range, kMaxPoints);
    if (numbers.size() != size)
      json.fail(json.key(each), fmt::format("has {} entries", numbers.size()),
                fmt::format("one for each of the {} connections", size));
    return numbers;
  }

  void read_contact(const JsonObject& json) {
    ConnectionGroup group = read_group(json, ConnectionKind::kContact);
    const auto& [material, table] = materials_.of(json);
    const std::string name = json.text("material", "");
    const auto found = std::ranges::find(model_.tables, name, &ContactTable::material);
    group.each.table = static_cast<std::size_t>(found - model_.tables.begin());
    if (found == model_.tables.end()) model_.tables.push_back({name, table, material.memories});
    group.each.loss_s_per_m = material.loss_s_per_m;
    group.weights = read_column(json, "weight", "weights", kWeight, 1, group.gaps_m.size());
    check_stiffness(json, json.has("weights") ? "weights" : "weight", group, 1);
    model_.connections.push_back(std::move(group));
  }

  void read_spring(const JsonObject& json) {
    ConnectionGroup group = read_group(json, ConnectionKind::kSpring);
    if (!json.has("stiffness_n_per_m") && !json.has("resistance_n_s_per_m"))
      json.fail(json.key("stiffness_n_per_m"), "missing", "stiffness_n_per_m, resistance_n_s_per_m, or both");
    if (json.has("stiffness_n_per_m")) group.each.stiffness_n_per_m = json.number("stiffness_n_per_m", kStiffness);
    if (json.has("resistance_n_s_per_m"))
      group.each.resistance_n_s_per_m = json.number("resistance_n_s_per_m", kResistance);
    model_.connections.push_back(std::move(group));
  }

  // A link that closes a circle of rigid links would have nothing left to hold.
  void read_link(const JsonObject& json) {
    ConnectionGroup group = read_group(json, ConnectionKind::kLink);
    const std::size_t first = end_of_chain(group.each.first), second = end_of_chain(group.each.second);
    if (first == second)
      json.fail(json.key("between"), "closes a circle of rigid links", "links that hold each place once");
    chains_[first] = second;
    model_.connections.push_back(std::move(group));
  }

  std::size_t end_of_chain(std::size_t place) {
    while (chains_.contains(place)) place = chains_.at(place);
    return place;
  }

  [[nodiscard]] static bool suits(ControlQuantity quantity, ConnectionKind kind) {
    switch (quantity) {
      case ControlQuantity::kStiffnessRatio:
      case ControlQuantity::kLoss:
        return kind == ConnectionKind::kContact;
      case ControlQuantity::kStiffness:
      case ControlQuantity::kResistance:
        return kind == ConnectionKind::kSpring;
      default:
        return true;
    }
  }

  std::size_t target_of(const JsonObject& json, const char* key, ControlQuantity quantity,
                        const std::string& name) const {
    const std::string path = json.key(key);
    if (quantity == ControlQuantity::kDamping) return index_of(json, path, name, model_.bodies, "body");
    if (quantity == ControlQuantity::kForce) return single_place(json, key, name);
    if (quantity == ControlQuantity::kPlace) return place_on_string(json, key, name);
    if (quantity == ControlQuantity::kMass) return struck_mass(json, key, name);
    const std::size_t found = index_of(json, path, name, model_.connections, "contact, spring or link");
    const ConnectionKind kind = model_.connections[found].each.kind;
    if (!suits(quantity, kind))
      json.fail(path, fmt::format("'{}' is a {}", name, name_of(kind)),
                quantity == ControlQuantity::kStiffness || quantity == ControlQuantity::kResistance ? "a spring"
                                                                                                    : "a contact");
    return found;
  }

  std::size_t single_place(const JsonObject& json, const char* key, const std::string& name) const {
    const std::size_t place = index_of(json, json.key(key), name, model_.places, "place");
    if (model_.places[place].points.size() != 1)
      json.fail(json.key(key), fmt::format("'{}' has several points", name), "a place of one point");
    return place;
  }

  // A place that a control may move: one point of a string, which no rigid link holds.
  std::size_t place_on_string(const JsonObject& json, const char* key, const std::string& name) const {
    const std::size_t place = single_place(json, key, name);
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
        return model_.places[target].points.front().position_m;
      case ControlQuantity::kMass:
        return mass_of(target);
      default:
        return 0;
    }
  }

  void read_control(const JsonObject& json) {
    std::vector<std::string> keys;
    for (const ControlQuantity quantity : kQuantities) keys.emplace_back(key_of(quantity));
    const std::string key = one_of_keys(json, keys, "quantities");
    ControlTargets control;
    control.quantity = kQuantities[static_cast<std::size_t>(std::ranges::find(keys, key) - keys.begin())];
    const std::string name = read_public_name(json, key.c_str());
    for (const std::string& target_name :
         json.texts(key.c_str(), "the name of what it controls, or an array of names", kMaxObjects)) {
      const std::size_t target = target_of(json, key.c_str(), control.quantity, target_name);
      if (!controlled_.insert({control.quantity, target}).second)
        json.fail(json.key(key), fmt::format("'{}' already has such a control", target_name), "one control for each");
      control.targets.push_back(target);
    }
    ModelParameter parameter = parameter_of(json, name, control);
    if (control.quantity == ControlQuantity::kGapShift) check_gaps(json, control, parameter.initial);
    if (control.quantity == ControlQuantity::kStiffnessRatio)
      for (const std::size_t group : control.targets)
        check_stiffness(json, "max", model_.connections[group], parameter.allowed.max);
    if (control.quantity == ControlQuantity::kPlace || control.quantity == ControlQuantity::kMass)
      check_lightest(json, control, parameter.allowed.min);
    if (json.has("release_n")) read_pluck(json, parameter, control.quantity);
    if (control.quantity == ControlQuantity::kForce) narrow_slider(json, parameter);
    model_.parameters.push_back(std::move(parameter));
    model_.controls.push_back(std::move(control));
  }

  // The values that a control may take, and its first one.
  [[nodiscard]] ModelParameter parameter_of(const JsonObject& json, const std::string& name,
                                            const ControlTargets& control) const {
    Range all = range_of(control.quantity);
    if (control.quantity == ControlQuantity::kPlace)
      for (const std::size_t place : control.targets)
        all.max = std::min(all.max, extent_of(model_.bodies[model_.places[place].body].resonator.body));
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
            .glide_s = waits ? 0 : glide_of(control.quantity)};
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

  static double glide_of(ControlQuantity quantity) {
    if (quantity == ControlQuantity::kPlace) return kPlaceGlide_s;
    return quantity == ControlQuantity::kForce || quantity == ControlQuantity::kDamping ? kGlide_s : 0;
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

  // A force without limits of its own is played up to what a finger does.
  static void narrow_slider(const JsonObject& json, ModelParameter& force) {
    const double largest = std::max(kFinger_n, 2 * std::abs(force.initial));
    if (!json.has("min")) force.slider.min = std::max(force.slider.min, -largest);
    if (!json.has("max")) force.slider.max = std::min(force.slider.max, largest);
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

  void read_strikes() {
    for (const std::string& name : json_.texts("strikes", "an array of masses", kMaxBodies)) {
      const std::size_t body = index_of(json_, "strikes", name, model_.bodies, "body");
      if (!model_.bodies[body].is_mass) json_.fail("strikes", fmt::format("'{}' is not a mass", name), "masses");
      model_.strikes.push_back(body);
      require_public(json_, "strikes", speed_name(model_.strikes.size() - 1));
    }
  }

  void read_keys() {
    for (const char* key : {"polyphony", "damper"})
      if (json_.has(key) && !json_.has("keys")) json_.fail(key, "has no place here", "beside keys");
    for (const JsonObject& row : optional_objects("keys", {"key", "first", "last", "event", "tuned_key"}))
      read_key(row);
    if (model_.keys.ranges.empty()) return;
    std::ranges::sort(model_.keys.ranges, {}, &KeyRange::first);
    model_.keys.voices = static_cast<std::size_t>(json_.has("polyphony") ? json_.integer("polyphony", 1, kMaxVoices)
                                                  : model_.keys.tune()   ? kVoices
                                                                         : 1);
    if (json_.has("damper")) read_damper(json_.object("damper", {"bodies", "damping_per_s"}));
    if (!model_.keys.tune()) return;
    model_.keys.bend = model_.parameters.size();
    model_.parameters.push_back({.name = "bend_cents",
                                 .unit = "cents",
                                 .allowed = {-1200, 1200},
                                 .slider = {-200, 200},
                                 .initial = 0,
                                 .step_samples = 16});
  }

  // Keys that play one event.
  void read_key(const JsonObject& row) {
    const std::string key = one_of_keys(row, {"key", "first"}, "kinds of keys");
    if (key == "key" && row.has("last")) row.fail(row.key("last"), "stands beside key", "beside first");
    KeyRange range{row.integer(key.c_str(), 0, kMaxKey), 0, 0};
    range.last = key == "key" ? range.first : row.integer("last", range.first, kMaxKey);
    const std::string name = row.text("event", joined(names_of(model_.events)));
    range.event = index_of(row, row.key("event"), name, model_.events, "event");
    if (row.has("tuned_key")) read_tuned_key(row, range);
    for (const KeyRange& other : model_.keys.ranges)
      if (range.first <= other.last && other.first <= range.last)
        row.fail(row.key(key), fmt::format("key {} plays two events", std::max(range.first, other.first)),
                 "each key once");
    model_.keys.ranges.push_back(range);
  }

  void read_tuned_key(const JsonObject& row, KeyRange& range) const {
    range.tuned_key = row.integer("tuned_key", 0, kMaxKey);
    const auto is_string = [](const InstrumentBody& body) {
      return std::holds_alternative<StiffString>(body.resonator.body);
    };
    if (std::ranges::none_of(model_.bodies, is_string))
      row.fail(row.key("tuned_key"), "tunes nothing", "in a file with a string among its bodies");
    for (const int key : {range.first, range.last})
      if (std::abs(key - range.tuned_key) > kMaxSemitones)
        row.fail(row.key("tuned_key"),
                 fmt::format("key {} is {} semitones from {}", key, std::abs(key - range.tuned_key), range.tuned_key),
                 fmt::format("at most {} semitones, such as {}", kMaxSemitones, (range.first + range.last) / 2));
  }

  void read_damper(const JsonObject& damper) {
    for (const std::string& name : damper.texts("bodies", joined(names_of(model_.bodies)), kMaxBodies)) {
      const std::size_t body = index_of(damper, damper.key("bodies"), name, model_.bodies, "body");
      if (std::ranges::find(model_.keys.damped, body) != model_.keys.damped.end())
        damper.fail(damper.key("bodies"), fmt::format("'{}' is named twice", name), "once");
      model_.keys.damped.push_back(body);
    }
    model_.keys.damper_per_s = damper.number("damping_per_s", range_of(ControlQuantity::kDamping));
    model_.keys.sustain = model_.parameters.size();
    model_.parameters.push_back({.name = "sustain",
                                 .unit = "",
                                 .allowed = {0, 1},
                                 .slider = {0, 1},
                                 .initial = 0,
                                 .controller = kSustainController});
  }

  // Values of parameters under a name.
  void read_presets() {
    std::vector<std::string> keys = names_of(model_.parameters);
    keys.insert(keys.begin(), "name");
    for (const JsonObject& json : optional_objects("presets", keys)) {
      ModelPreset preset{read_line(json, "name", 64), {}};
      if (preset.name.empty()) json.fail(json.key("name"), "is empty", "a name such as bright");
      if (std::ranges::find(model_.presets, preset.name, &ModelPreset::name) != model_.presets.end())
        json.fail(json.key("name"), fmt::format("'{}' is the name of two presets", shown(preset.name)), "once");
      for (const ModelParameter& p : model_.parameters)
        preset.values.push_back(json.has(p.name.c_str()) ? json.number(p.name.c_str(), {p.allowed.min, p.allowed.max})
                                                         : p.initial);
      model_.presets.push_back(std::move(preset));
    }
  }

  // What an output is the sum of.
  std::size_t source_of(const JsonObject& json, const std::string& key, const std::string& name) const {
    if (key == "force_n") return index_of(json, json.key(key), name, model_.connections, "contact, spring or link");
    if (key != "end_force_n") return place_that_stays(json, key, name);
    const std::size_t body = index_of(json, json.key(key), name, model_.bodies, "body");
    if (!std::holds_alternative<StiffString>(model_.bodies[body].resonator.body))
      json.fail(json.key(key), fmt::format("'{}' is not a string", name), "a string");
    return body;
  }

  std::size_t place_that_stays(const JsonObject& json, const std::string& key, const std::string& name) const {
    const std::size_t place = single_place(json, key.c_str(), name);
    if (controlled_.contains({ControlQuantity::kPlace, place}))
      json.fail(json.key(key), fmt::format("a control moves '{}'", name), "a place of its own that stays");
    return place;
  }

  // A loud sound of largest instruments.
  static double default_full_scale(std::string_view unit) {
    if (unit == "N") return 50;
    if (unit == "Pa") return 20;
    return unit == "m/s" ? 1 : 0.001;
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

  void read_output(const JsonObject& json) {
    const std::string key = one_of_keys(
        json, {"displacement_m", "velocity_m_per_s", "force_n", "end_force_n", "pressure_pa"}, "quantities");
    ModelOutput output{read_public_name(json, key.c_str()), OutputQuantity::kDisplacement, {}};
    if (key == "velocity_m_per_s") output.quantity = OutputQuantity::kVelocity;
    if (key == "force_n") output.quantity = OutputQuantity::kForce;
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

  inline static const std::vector<std::string> kBodyKeys = {
      "name", "resonator", "string", "bar", "membrane", "plate", "modes", "mass_kg", "tuning_cents", "max_modes"};

  const JsonObject& json_;
  const ReadFile& read_;
  DesignedMaterials materials_;
  InstrumentModel model_;
  std::vector<ModelParameter> plucks_;
  std::set<std::string> names_, public_names_;
  std::map<std::size_t, std::vector<double>> masses_kg_;  // of the points of the places that connections may move
  std::set<std::pair<ControlQuantity, std::size_t>> controlled_;
  std::map<std::size_t, std::size_t> chains_;  // from a place to the next one that rigid links hold with it
  std::size_t points_ = 0, connections_ = 0;
  Reach listening_{std::numeric_limits<double>::max(), 0};  // of all outputs that are pressures
};

}  // namespace

InstrumentModel parse_instrument(std::string_view text, std::string_view file, const ReadFile& read) {
  const JsonObject json =
      parse_json(text, file, "instrument",
                 {"name", "description", "license", "bodies", "places", "contacts", "springs", "links", "controls",
                  "strikes", "outputs", "keys", "polyphony", "damper", "presets"});
  return Reader(json, read).read();
}

}  // namespace contactspline
