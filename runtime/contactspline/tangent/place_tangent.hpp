// SPDX-License-Identifier: MIT
// A place of a network, at rest or moving along its string, with the derivatives of its mode shapes.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/string_place.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/tangent/dual.hpp"

namespace contactspline::detail {

/// The derivatives of the mode shapes at a place with respect to P parameters.
template <std::floating_point T, std::size_t P>
struct ShapeSlopes {
  std::array<std::vector<T>, P> of;
  std::array<bool, P> any{};  ///< are they not all 0?

  explicit ShapeSlopes(std::size_t modes = 0) {
    for (std::vector<T>& slopes : of) slopes.resize(modes);
  }
};

/// A place of a network.
template <std::floating_point T, std::size_t P>
struct PlaceTangent {
  using Number = Dual<T, P>;

  std::size_t body, begin, modes;  ///< begin: of the modes of its body
  const T* acting;                 ///< shapes with which forces act over the sample,
  const T* seen;                   ///< and those with which displacements are seen after it
  ShapeSlopes<T, P> acting_slopes;
  std::vector<T> drive = {};  ///< receptance times shape of each mode
  Number push = {};
  T load = 0;          ///< force on it over the sample [N]
  Number moved = {};   ///< slopes: of its increment without forces
  Number driven = {};  ///< slopes: of the forces of connections on it
  bool is_asked = false, is_pushed = false;
  std::optional<std::size_t> mover = {};

  void measure_drive(const std::vector<T>& receptance) {
    drive.resize(modes);
    for (std::size_t i = 0; i < modes; ++i) drive[i] = receptance[begin + i] * acting[i];
  }
};

/// What a place that moves has beside its PlaceTangent, as the network has it. lift: what the move itself adds to the
/// increment of the connections there. has_turned: the slopes of the place changed in the last sample.
template <std::floating_point T, std::size_t P>
struct MoverTangent {
  using Number = Dual<T, P>;

  std::size_t index;
  std::vector<T> wavenumbers;
  ControlRange<T> range;
  MovingPlace<T> motion;
  Number place, target;
  ShapeSlopes<T, P> after, change;
  Number owed = {}, lift = {};
  bool is_moving = false, has_turned = false;

  MoverTangent(std::size_t q, const NetworkPlan<T>& plan, double sample_rate_hz)
      : MoverTangent(q, plan, StringShapes<T>(std::span<const double>(plan.places()[q].wavenumbers_per_m)),
                     sample_rate_hz) {}

  /// Puts it elsewhere, without a move.
  void put(const Number& place_m) {
    motion.put(place_m.value);
    target = place = held(place, place_m, range);
    has_turned = false;
    write_after();
  }
  /// Moves it over a sample: the shapes there and their slopes. mean: slopes of the mean shapes. Does it move? One
  /// which has reached its target also moves if only the slopes of the target change: so do those of the shapes, over
  /// one sample.
  bool move(ShapeSlopes<T, P>& mean) {
    lift = Number();
    const bool moves = motion.move_to(target.value);
    place.value = motion.place();
    const bool turns = place.value == target.value && place.slopes != target.slopes;
    if (turns) place.slopes = target.slopes;
    is_moving = moves || turns || has_turned;
    has_turned = turns;
    if (!is_moving) return false;
    std::swap(change, after);  // the shapes before
    write_after();
    for (std::size_t p = 0; p < P; ++p) {
      mean.any[p] = after.any[p] || change.any[p];
      for (std::size_t i = 0; i < wavenumbers.size(); ++i) {
        mean.of[p][i] = (change.of[p][i] + after.of[p][i]) / 2;
        change.of[p][i] = after.of[p][i] - change.of[p][i];
      }
      change.any[p] = mean.any[p];
    }
    return true;
  }

 private:
  MoverTangent(std::size_t q, const NetworkPlan<T>& plan, const StringShapes<T>& shapes, double sample_rate_hz)
      : index(q),
        wavenumbers(plan.places()[q].wavenumbers_per_m.begin(), plan.places()[q].wavenumbers_per_m.end()),
        range{0, shapes.length()},
        motion(shapes, plan.places()[q].place_m,
               shapes.longest_step(plan.bodies()[plan.places()[q].body], sample_rate_hz)),
        place(plan.places()[q].place_m),
        target(place),
        after(wavenumbers.size()),
        change(wavenumbers.size()) {}

  // sin(wavenumber place), by the derivatives of the place.
  void write_after() {
    for (std::size_t p = 0; p < P; ++p) after.any[p] = place.slopes[p] != 0;
    for (std::size_t i = 0; i < wavenumbers.size(); ++i) {
      const T slope = std::cos(wavenumbers[i] * motion.place()) * wavenumbers[i];
      for (std::size_t p = 0; p < P; ++p) after.of[p][i] = slope * place.slopes[p];
    }
  }
};

}  // namespace contactspline::detail
