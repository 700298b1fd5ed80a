// SPDX-License-Identifier: MIT
// Why an instrument has no Faust program.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "generator/emit/emit_instrument_faust.hpp"

namespace contactspline {
namespace {

// With these a program compiles within 3 s (docs/reference/instruments.md).
constexpr std::size_t kMaxContacts = 6;
constexpr std::size_t kMaxLinear = 8;  // springs and links
constexpr std::size_t kMaxModes = 400;

// A strike that moves more than one mass: the class moves all that is joined to it, and puts back what it may meet.
std::optional<std::string> joined_strike(const InstrumentModel& model, const InstrumentArrays& arrays) {
  const auto body_at = [&](std::size_t place) { return place == kGround ? kGround : arrays.place_bodies[place]; };
  const auto is_mass = [&](std::size_t body) { return body != kGround && model.bodies[body].is_mass; };
  for (const std::size_t struck : model.strikes)
    for (const InstrumentConnection& c : arrays.connections) {
      const std::size_t first = body_at(c.first), second = body_at(c.second);
      if (first != struck && second != struck) continue;
      const std::size_t other = first == struck ? second : first;
      if (is_mass(other))
        return fmt::format("{}: the strike of {} moves {}, too, and a program of Faust moves one mass alone",
                           model.name, model.bodies[struck].name, model.bodies[other].name);
    }
  return {};
}

// For each body one of those with which springs and links join it.
std::vector<std::size_t> joined_bodies(const InstrumentModel& model) {
  std::vector<std::size_t> one(model.bodies.size());
  std::iota(one.begin(), one.end(), std::size_t{0});
  for (const auto& [name, each, gaps_m, weights] : model.connections) {
    if (each.kind == ConnectionKind::kContact || each.kind == ConnectionKind::kFriction) continue;
    if (each.first == kGround || each.second == kGround) continue;
    const std::size_t from = one[model.places[each.first].body], to = one[model.places[each.second].body];
    std::ranges::replace(one, from, to);
  }
  return one;
}

// A friction with another point of friction or contact that moves the same bodies: for these the few steps of a
// program do not suffice.
std::optional<std::string> coupled_friction(const InstrumentModel& model) {
  const std::vector<std::size_t> joined = joined_bodies(model);
  const auto ends_of = [&](const ConnectionGroup& group) {
    std::vector<std::size_t> ends;
    for (const std::size_t place : {group.each.first, group.each.second})
      if (place != kGround) ends.push_back(joined[model.places[place].body]);
    return ends;
  };
  for (const ConnectionGroup& friction : model.connections) {
    if (friction.each.kind != ConnectionKind::kFriction) continue;
    if (friction.gaps_m.size() > 1)
      return fmt::format(
          "{} has the friction {} of {} points, and Faust solves one point that is alone on its bodies", model.name,
          friction.name, friction.gaps_m.size());
    const std::vector<std::size_t> ends = ends_of(friction);
    for (const ConnectionGroup& other : model.connections) {
      const bool is_friction = other.each.kind == ConnectionKind::kFriction;
      if (&other == &friction || (!is_friction && other.each.kind != ConnectionKind::kContact)) continue;
      if (std::ranges::find_first_of(ends, ends_of(other)) == ends.end()) continue;
      return fmt::format(
          "{} has the friction {} and the {} {} on bodies that move each other, and Faust solves a "
          "friction that is alone there",
          model.name, friction.name, is_friction ? "friction" : "contact", other.name);
    }
  }
  return {};
}

// A connection that Faust's library does not have.
std::optional<std::string> unknown_connection(const InstrumentModel& model) {
  for (const ConnectionGroup& group : model.connections) {
    if (group.each.kind == ConnectionKind::kFriction && group.each.friction.pressed_by != kNoConnection)
      return fmt::format("{} has the friction {} that a contact presses, which only the C++ class plays", model.name,
                         group.name);
    if (group.each.roughness.height_m > 0)
      return fmt::format("{} has the rough contact {}, which only the C++ class plays", model.name, group.name);
  }
  return {};
}

}  // namespace

std::optional<std::string> faust_obstacle(const InstrumentModel& model, const InstrumentArrays& arrays) {
  if (!model.bows.empty())
    return fmt::format("{} has the bow {}, which only the C++ class plays", model.name,
                       model.connections[model.bows.front().group].name);
  if (auto unknown = unknown_connection(model)) return unknown;
  if (auto coupled = coupled_friction(model)) return coupled;
  for (const InstrumentBody& body : model.bodies)
    if (body.airy_functions > 0)
      return fmt::format("{} has the plate {} with stretch, which only the C++ class plays", model.name, body.name);
  for (const InstrumentBody& body : model.bodies)
    if (body.longitudinal > 0)
      return fmt::format("{} has the string {} with longitudinal modes, which only the C++ class plays", model.name,
                         body.name);
  for (const ModelOutput& output : model.outputs)
    if (output.quantity == OutputQuantity::kTension)
      return fmt::format("{} has the output {}, a tension, which only the C++ class plays", model.name, output.name);
  if (const InstrumentBody* body = model.stretching_body()) {
    if (!arrays.memories.empty())
      return fmt::format("{} has the body {} with stretch and a contact with memory, which only the C++ class plays",
                         model.name, body->name);
  }
  for (std::size_t c = 0; c < model.controls.size(); ++c)
    if (model.controls[c].quantity == ControlQuantity::kPlace || model.parameters[c].acts == Acts::kAtNextNote)
      return fmt::format("{} has the control {}, which only the C++ class plays", model.name,
                         model.parameters[c].name);
  // A contact with memory takes Faust about as long as two without.
  std::size_t contacts = 0, linear = 0;
  for (const InstrumentConnection& connection : arrays.connections) {
    if (connection.kind == ConnectionKind::kFriction)
      ++contacts;
    else if (connection.kind == ConnectionKind::kContact)
      contacts += model.tables[connection.table].memories.empty() ? 1 : 2;
    else
      ++linear;
  }
  const auto too_many = [&](std::size_t count, std::size_t max, std::string_view what) {
    return fmt::format("{} has {} {}, and Faust compiles at most {} in reasonable time", model.name, count, what,
                       max);
  };
  if (contacts > kMaxContacts)
    return too_many(
        contacts, kMaxContacts,
        arrays.memories.empty() ? "points of contact" : "points of contact, counting those with memory twice");
  if (linear > kMaxLinear) return too_many(linear, kMaxLinear, "springs and links");
  if (arrays.masses.size() > kMaxModes) return too_many(arrays.masses.size(), kMaxModes, "modes");
  return joined_strike(model, arrays);
}

}  // namespace contactspline
