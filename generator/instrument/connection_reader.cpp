// SPDX-License-Identifier: MIT
#include "generator/instrument/connection_reader.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "generator/material/friction_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {
namespace {

constexpr Range kWeight{1e-9, 1e9};
constexpr Range kStiffness{0, 1e9};
constexpr Range kResistance{0, 1e6};
constexpr double kStiffBristles_per_m = 1e6;
constexpr Range kRoughHeight_m{1e-9, 1e-3};
constexpr Range kRoughLength_m{1e-5, 0.1};

/// Reads connections, kind after kind.
class ConnectionReader {
 public:
  ConnectionReader(InstrumentDraft& draft, DesignedMaterials& materials, MovedMasses& masses, const ReadFile& read)
      : draft_(draft), model_(draft.model), materials_(materials), masses_(masses), read_(read) {}

  void read() {
    for (const JsonObject& contact :
         draft_.objects("contacts", {"name", "between", "material", "gap_m", "gaps_m", "weight", "weights",
                                     "roughness", "surface_speed_m_per_s"}))
      read_contact(contact);
    for (const JsonObject& spring : draft_.objects(
             "springs", {"name", "between", "stiffness_n_per_m", "resistance_n_s_per_m", "gap_m", "gaps_m"}))
      read_spring(spring);
    for (const JsonObject& link : draft_.objects("links", {"name", "between", "gap_m", "gaps_m"})) read_link(link);
    if (const InstrumentBody* body = model_.stretching_body(); body != nullptr && draft_.json.has("frictions"))
      draft_.json.fail("frictions", fmt::format("stand in a file where '{}' has `stretch`", body->name),
                       "frictions or `stretch`, one of the two");
    for (const JsonObject& friction :
         draft_.objects("frictions", {"name", "between", "material", "width_m", "coefficient", "stiffness_per_m",
                                      "normal_force_n", "surface_speed_m_per_s", "pressed_by"}))
      read_friction(friction);
    if (connections_ > kMaxPoints)
      draft_.json.fail("contacts", fmt::format("the file has {} connections", connections_),
                       fmt::format("at most {}, points of profiles included", kMaxPoints));
  }

 private:
  void read_contact(const JsonObject& json) {
    ConnectionGroup group = read_group(json, ConnectionKind::kContact);
    const auto& [material, table] = materials_.of(json);
    const std::string name = json.text("material", "");
    const auto found = std::ranges::find(model_.tables, name, &ContactTable::material);
    group.each.table = static_cast<std::size_t>(found - model_.tables.begin());
    if (found == model_.tables.end()) model_.tables.push_back({name, table, material.memories});
    group.each.loss_s_per_m = material.loss_s_per_m;
    group.weights = read_column(json, "weight", "weights", kWeight, 1, group.gaps_m.size());
    masses_.check_stiffness(json, json.has("weights") ? "weights" : "weight", group, 1);
    if (json.has("roughness")) group.each.roughness = roughness(json);
    if (json.has("surface_speed_m_per_s")) {
      if (!json.has("roughness"))
        json.fail(json.key("surface_speed_m_per_s"), "stands in a contact without roughness", "beside roughness");
      group.each.friction.surface_speed_m_per_s = surface_speed(json);
    }
    model_.connections.push_back(std::move(group));
  }

  static Roughness roughness(const JsonObject& contact) {
    const JsonObject json = contact.object("roughness", {"height_m", "length_m", "profile"});
    return {.height_m = json.number("height_m", kRoughHeight_m),
            .length_m = json.number("length_m", kRoughLength_m),
            .is_periodic = read_word(json, "profile", "random", "periodic") == "periodic"};
  }

  static double surface_speed(const JsonObject& json) {
    return json.number("surface_speed_m_per_s", range_of(ControlQuantity::kSurfaceSpeed));
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

  void read_friction(const JsonObject& json) {
    ConnectionGroup group = read_group(json, ConnectionKind::kFriction);
    InstrumentFriction& friction = group.each.friction;
    friction = one_of_keys(json, {"material", "coefficient"}, "laws") == "material" ? friction_of_material(json)
                                                                                    : constant_friction(json);
    if (json.has("normal_force_n"))
      friction.normal_force_n = json.number("normal_force_n", range_of(ControlQuantity::kNormalForce));
    if (json.has("surface_speed_m_per_s")) friction.surface_speed_m_per_s = surface_speed(json);
    if (json.has("pressed_by")) friction.pressed_by = contact_that_presses(json, group.gaps_m.size());
    model_.connections.push_back(std::move(group));
  }

  // A contact with as many points.
  std::size_t contact_that_presses(const JsonObject& json, std::size_t points) const {
    std::vector<ConnectionGroup> contacts = model_.connections;
    std::erase_if(contacts, [](const ConnectionGroup& group) { return group.each.kind != ConnectionKind::kContact; });
    const std::string key = json.key("pressed_by"), name = json.text("pressed_by", "the name of a contact");
    const std::size_t contact = index_of(json, key, name, contacts, "contact");  // of a file the contacts come first
    const std::size_t pressing = contacts[contact].gaps_m.size();
    if (pressing != points)
      json.fail(key, fmt::format("'{}' has {} point{}", name, pressing, pressing == 1 ? "" : "s"),
                fmt::format("a contact of {} point{}, as the friction", points, points == 1 ? "" : "s"));
    return contact;
  }

  [[nodiscard]] InstrumentFriction friction_of_material(const JsonObject& json) const {
    const NamedText named = read_named(json, "material", Shipped::kFrictions, read_);
    const RubbingSurfaces surfaces = parse_friction(named.text, named.file);
    if (json.has("stiffness_per_m"))
      json.fail(json.key("stiffness_per_m"), "stands beside material", "beside coefficient");
    if (json.has("width_m") && !surfaces.warms())
      json.fail(json.key("width_m"), fmt::format("stands beside '{}', which does not warm", surfaces.name),
                "beside a material with heat");
    return {surfaces.friction, json.has("width_m") ? json.number("width_m", kRubbingWidth_m) : surfaces.width_m};
  }

  static InstrumentFriction constant_friction(const JsonObject& json) {
    if (json.has("width_m")) json.fail(json.key("width_m"), "stands beside coefficient", "beside material");
    const double stiffness =
        json.has("stiffness_per_m") ? json.number("stiffness_per_m", kBristleStiffness_per_m) : kStiffBristles_per_m;
    return {coulomb_friction(json.number("coefficient", kFrictionCoefficient), {.stiffness_per_m = stiffness})};
  }

  // The places of a connection and its gaps.
  ConnectionGroup read_group(const JsonObject& json, ConnectionKind kind) {
    ConnectionGroup group{draft_.own_name(json), {kind, kGround, kGround}, {}};
    constexpr auto kAllowed = "an array of two places, one of which may be ground";
    const auto between = json.texts("between", kAllowed, 2);
    if (between.size() != 2) json.fail(json.key("between"), "names one place", kAllowed);
    const auto place_of = [&](const std::string& name) {
      return name == kGroundName ? kGround : index_of(json, json.key("between"), name, model_.places, "place");
    };
    group.each.first = place_of(between[0]);
    group.each.second = place_of(between[1]);
    check_ends(json, group.each);
    for (const std::size_t place : {group.each.first, group.each.second}) masses_.add(json, place);
    const std::size_t size = std::max(draft_.points_of(group.each.first), draft_.points_of(group.each.second));
    for (const std::size_t place : {group.each.first, group.each.second})
      if (draft_.points_of(place) != 1 && draft_.points_of(place) != size)
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

  std::size_t end_of_chain(std::size_t place) {
    while (chains_.contains(place)) place = chains_.at(place);
    return place;
  }

  InstrumentDraft& draft_;
  InstrumentModel& model_;
  DesignedMaterials& materials_;
  MovedMasses& masses_;
  const ReadFile& read_;
  std::map<std::size_t, std::size_t> chains_;  // from a place to the next one that rigid links hold with it
  std::size_t connections_ = 0;
};

}  // namespace

void read_connections(InstrumentDraft& draft, DesignedMaterials& materials, MovedMasses& masses,
                      const ReadFile& read) {
  ConnectionReader(draft, materials, masses, read).read();
}

}  // namespace contactspline
