// SPDX-License-Identifier: MIT
#include "generator/instrument/moved_masses.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {
namespace {

// Of a contact at its steepest with the masses that it moves. Rounding of forces that cancel each other moves it by a
// part of its compression that rises with the square (docs/how-it-works/several-contacts.md).
constexpr double kMaxContactFrequency_hz = 1e9;

}  // namespace

void MovedMasses::add(const JsonObject& json, std::size_t place) {
  if (place == kGround || masses_kg_.contains(place)) return;
  const std::string& name = draft_.model.places[place].name;
  for (std::size_t i = 0; i < draft_.points_of(place); ++i) {
    const double mass = masses_kg_[place].emplace_back(effective_mass(draft_.model, place, i));
    if (!(mass < std::numeric_limits<double>::max()))
      json.fail(json.key("between"), fmt::format("no mode moves at place '{}'", name),
                "a place away from supports and edges, or ground");
    if (mass < kModalMass_kg.min)
      json.fail(json.key("between"),
                fmt::format("place '{}' moves like a mass of {:.3g} kg, 1/(sum of shape^2/mass)", name, mass),
                fmt::format("at least {} kg, with smaller shapes, larger masses or fewer modes", kModalMass_kg.min));
  }
}

void MovedMasses::check_stiffness(const JsonObject& json, const std::string& key, const ConnectionGroup& group,
                                  double ratio) const {
  double steepest = 0;
  for (const Segment<double>& segment : draft_.model.tables[group.each.table].segments)
    steepest = std::max(steepest, 2 * segment.half_curvature);
  for (std::size_t i = 0; i < group.weights.size(); ++i) {
    double inverse_mass = 0;
    for (const std::size_t place : {group.each.first, group.each.second})
      if (place != kGround) inverse_mass += 1 / masses_kg_.at(place)[draft_.points_of(place) == 1 ? 0 : i];
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

void MovedMasses::check_lightest(const JsonObject& json, const ControlTargets& control, double min_mass_kg) {
  const bool moves = control.quantity == ControlQuantity::kPlace;
  for (const std::size_t target : control.targets) {
    const std::size_t place = moves ? target : place_of_mass(target);
    if (!masses_kg_.contains(place)) continue;  // nothing touches it
    masses_kg_[place].assign(draft_.points_of(place),
                             moves ? effective_mass(draft_.model, place, 0, true) : min_mass_kg);
    for (const ConnectionGroup& group : draft_.model.connections)
      if (group.each.kind == ConnectionKind::kContact && (group.each.first == place || group.each.second == place))
        check_stiffness(json, moves ? "place_m" : "min", group, largest_ratio(group));
  }
}

// The largest stiffness ratio that the controls so far may give a contact.
double MovedMasses::largest_ratio(const ConnectionGroup& group) const {
  double largest = 1;
  for (std::size_t c = 0; c < draft_.model.controls.size(); ++c)
    for (const std::size_t target : draft_.model.controls[c].targets)
      if (draft_.model.controls[c].quantity == ControlQuantity::kStiffnessRatio &&
          &draft_.model.connections[target] == &group)
        largest = std::max(largest, draft_.model.parameters[c].allowed.max);
  return largest;
}

std::size_t MovedMasses::place_of_mass(std::size_t body) const {
  return static_cast<std::size_t>(std::ranges::find(draft_.model.places, body, &InstrumentPlace::body) -
                                  draft_.model.places.begin());
}

}  // namespace contactspline
