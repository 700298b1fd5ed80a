// SPDX-License-Identifier: MIT
// The adjoints of modes and places of a network, and the places where something acts in a sample
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_record.hpp"

namespace contactspline::detail {

/// Adjoints of the modes of all bodies: of displacements before a sample, of changes over it, and of increments after
/// it. Before it the latter are change - increment. The others add up over all samples.
template <std::floating_point T>
struct ModeAdjoints {
  std::vector<T> displacement, increment, change;
  std::vector<T> stiffness, loss, receptance;

  explicit ModeAdjoints(std::size_t n)
      : displacement(n), increment(n), change(n), stiffness(n), loss(n), receptance(n) {}
};

/// A place in a sample, and its adjoints.
template <std::floating_point T>
struct PlaceAdjoints {
  std::size_t begin;              ///< first mode of its body
  const T* acting;                ///< shapes with which forces act over the sample,
  const T* seen;                  ///< and those with which displacements are seen after it
  std::vector<T> shapes, forced;  ///< adjoint of the shapes by displacements, and of receptance times shapes
  T force = 0;                    ///< on it over the sample [N]
  T by_weights = 0;               ///< adjoint of its displacement after the sample by weights
  T before = 0, after = 0;        ///< adjoints of what presses connections there before and after the sample,
  T by_forces = 0;                ///< and what forces that respond to the latter add to it
  T pushed = 0;                   ///< the adjoint of a force on it
  bool is_touched = false;
  bool is_moving = false;  ///< along its string, over the sample

  [[nodiscard]] std::size_t modes() const { return shapes.size(); }
};

/// The places of a network, and where something acts in a sample.
template <std::floating_point T>
class PlacesBackwards {
 public:
  using Place = PlaceAdjoints<T>;
  using Record = NetworkRecord<T>;
  using Ends = typename Record::Ends;

  PlacesBackwards(const NetworkPlan<T>& plan, const NetworkModes<T>& modes) : plan_(plan) {
    for (const auto& place : plan.places())
      places_.push_back({modes.begins[place.body], place.shapes.data(), place.shapes.data(),
                         std::vector<T>(place.shapes.size()), std::vector<T>(place.shapes.size())});
  }

  [[nodiscard]] Place& operator[](std::size_t p) { return places_[p]; }
  [[nodiscard]] const Place& operator[](std::size_t p) const { return places_[p]; }
  [[nodiscard]] std::size_t size() const { return places_.size(); }

  /// Lists the places where something acts in sample n, with the forces on them.
  void list(const Record& record, std::size_t n) {
    for (const std::size_t p : touched_) places_[p].is_touched = false;
    touched_.clear();
    for (const auto& acting : record.in_sample(record.acting, &Ends::acting, n)) {
      const auto& connection = plan_.connections()[acting.connection];
      if (connection.first != kGround) touch(connection.first).force -= acting.sample.force;
      if (connection.second != kGround) touch(connection.second).force += acting.sample.force;
    }
    for (const auto& push : record.in_sample(record.pushes, &Ends::pushes, n)) touch(push.place).force += push.force;
    forced_ = touched_.size();
  }
  /// Lists a place that moves, before any that only has a weight.
  void list_moving(std::size_t p) {
    touch(p).is_moving = true;
    forced_ = touched_.size();
  }
  /// Lists a place that only has a weight.
  Place& touch(std::size_t p) {
    Place& place = places_[p];
    if (place.is_touched) return place;
    touched_.push_back(p);
    place.force = place.by_weights = place.before = place.after = place.by_forces = 0;
    place.is_touched = true;
    return place;
  }

  /// All that are listed, first those on which forces act or that move.
  [[nodiscard]] std::span<const std::size_t> touched() const { return touched_; }
  [[nodiscard]] std::span<const std::size_t> forced() const { return touched().first(forced_); }

 private:
  const NetworkPlan<T>& plan_;
  std::vector<Place> places_;
  std::vector<std::size_t> touched_;
  std::size_t forced_ = 0;
};

}  // namespace contactspline::detail
