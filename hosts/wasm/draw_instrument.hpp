// SPDX-License-Identifier: MIT
// The shapes of what an instrument file describes, at the points that the page draws.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <variant>
#include <vector>

#include "generator/instrument/instrument.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "hosts/wasm/drawn_instrument.hpp"

namespace contactspline::web {

namespace detail {

[[nodiscard]] inline DrawnKind drawn_kind(const InstrumentBody& body) {
  const auto& shaped = body.resonator.body;
  if (body.is_mass) return DrawnKind::kMass;
  if (std::holds_alternative<StiffString>(shaped)) return DrawnKind::kString;
  if (const auto* const bar = std::get_if<Bar>(&shaped))
    return std::ranges::count(bar->ends, BarEnd::kClamped) > 0 ? DrawnKind::kTine : DrawnKind::kBar;
  if (std::holds_alternative<Membrane>(shaped)) return DrawnKind::kMembrane;
  const auto* const plate = std::get_if<RoundPlate>(&shaped);
  if (plate == nullptr) return DrawnKind::kNothing;
  return plate->rim == PlateRim::kFree ? DrawnKind::kFreePlate : DrawnKind::kPlate;
}

[[nodiscard]] inline std::vector<Place> points_along(double length_m, std::size_t count) {
  std::vector<Place> points;
  for (std::size_t p = 0; p < count; ++p)
    points.push_back({length_m * static_cast<double>(p) / static_cast<double>(count - 1)});
  return points;
}

[[nodiscard]] inline std::vector<Place> points_of_disc(double radius_m, bool is_free) {
  std::vector<Place> points = {{0}};
  const double rings = is_free ? kRings : kRings + 1;
  for (std::size_t ring = 1; ring <= kRings; ++ring)
    for (std::size_t p = 0; p < kRingPoints; ++p)
      points.push_back({.position_m = radius_m * static_cast<double>(ring) / rings,
                        .angle_rad = std::numbers::pi * static_cast<double>(p) / (kRingPoints - 1)});
  return points;
}

[[nodiscard]] inline std::vector<Place> points_of(const InstrumentBody& body) {
  switch (const DrawnKind kind = drawn_kind(body)) {
    case DrawnKind::kNothing:
      return {};
    case DrawnKind::kMass:
      return {Place{}};
    case DrawnKind::kString:
      return points_along(extent_of(body.resonator.body), kStringPoints);
    case DrawnKind::kBar:
    case DrawnKind::kTine:
      return points_along(extent_of(body.resonator.body), kBarPoints);
    default:
      return points_of_disc(extent_of(body.resonator.body), kind == DrawnKind::kFreePlate);
  }
}

[[nodiscard]] inline double part_of_length(const InstrumentBody& body, const Place& point) {
  switch (drawn_kind(body)) {
    case DrawnKind::kNothing:
    case DrawnKind::kMass:
      return kNowhere;
    case DrawnKind::kString:
    case DrawnKind::kBar:
    case DrawnKind::kTine:
      return point.position_m / extent_of(body.resonator.body);
    default:
      return (1 + position_of(point) / extent_of(body.resonator.body)) / 2;
  }
}

}  // namespace detail

/// The packed DrawnInstrument of arrays_of(model, max_frequency_hz), for what draws them.
[[nodiscard]] inline Bytes packed_drawing(const InstrumentModel& model, double max_frequency_hz) {
  InstrumentModel shapes;  // of places at all points
  shapes.bodies = model.bodies;
  shapes.keys.ranges = model.keys.ranges;  // keys that lower bodies bring down modes
  shapes.keys.tuned = model.keys.tuned;
  std::vector<DrawnBody> bodies;
  for (InstrumentBody& body : shapes.bodies) {
    body.airy_functions = std::min<std::size_t>(body.airy_functions, 1);  // which sort the modes alike
    const std::vector<Place> points = detail::points_of(body);
    if (!points.empty()) shapes.places.push_back({"", bodies.size(), points});
    bodies.push_back({detail::drawn_kind(body), points.size()});
  }
  const InstrumentArrays arrays = arrays_of(shapes, max_frequency_hz);
  std::vector<double> places;
  for (const InstrumentPlace& place : model.places)
    for (const Place& point : place.points) places.push_back(detail::part_of_length(model.bodies[place.body], point));
  return packed(DrawnInstrument{bodies, arrays.shapes, places});
}

}  // namespace contactspline::web
