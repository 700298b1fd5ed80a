// SPDX-License-Identifier: MIT
// The derivatives of all modes of a network with respect to one parameter, in arrays.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/mode.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/mode_tangent.hpp"
#include "contactspline/tangent/network_modes.hpp"

namespace contactspline::detail {

/// A force that drives modes, by what each mode moves per newton.
template <std::floating_point T>
struct DrivingForce {
  const T* drive;
  T force;
};

/// Derivatives of displacements, free increments and changes over the last sample, and of the constants of the modes.
template <std::floating_point T>
struct ModeSlopes {
  std::vector<T> displacement, increment, change;
  std::vector<T> pushed;  ///< free increments with what is known before the forces of a sample
  std::vector<T> stiffness, loss, receptance;
  std::vector<char> has_constants;  ///< for each body: do constants of its modes change?
  std::vector<char> is_pushed;      ///< for each body: is `pushed` in use in this sample?

  /// direction: of all bodies, or empty.
  ModeSlopes(const NetworkPlan<T>& plan, const NetworkModes<T>& modes, double sample_rate_hz,
             const std::vector<std::vector<Mode>>& direction)
      : displacement(modes.size()),
        increment(modes.size()),
        change(modes.size()),
        pushed(modes.size()),
        stiffness(modes.size()),
        loss(modes.size()),
        receptance(modes.size()),
        has_constants(plan.bodies().size()),
        is_pushed(plan.bodies().size()) {
    for (std::size_t b = 0; b < (std::min)(direction.size(), plan.bodies().size()); ++b)
      for (std::size_t i = 0; i < (std::min)(direction[b].size(), plan.bodies()[b].size()); ++i) {
        const std::size_t m = modes.begins[b] + i;
        const ModeStep step = step_tangent(plan.bodies()[b][i], direction[b][i], sample_rate_hz);
        stiffness[m] = static_cast<T>(step.stiffness);
        loss[m] = static_cast<T>(step.loss);
        receptance[m] = static_cast<T>(step.receptance);
        if (stiffness[m] != 0 || loss[m] != 0 || receptance[m] != 0) has_constants[b] = 1;
      }
  }

  /// Adds to the free increments of a body: where, from its first mode on.
  [[nodiscard]] T* push(const NetworkModes<T>& modes, std::size_t body) {
    const std::size_t begin = modes.begins[body];
    if (std::exchange(is_pushed[body], 1) == 0)
      copy(modes.begins[body + 1] - begin, increment.data() + begin, pushed.data() + begin);
    return pushed.data() + begin;
  }
  /// Adds what forces do through the slopes of the receptances. loads: of each mode of the body, by its shapes [N].
  void push_loads(const NetworkModes<T>& modes, std::size_t body, const T* loads) {
    const std::size_t begin = modes.begins[body], n = modes.begins[body + 1] - begin;
    const bool was_pushed = std::exchange(is_pushed[body], 1) != 0;
    if (was_pushed)
      add_product(n, T(1), receptance.data() + begin, loads, pushed.data() + begin);
    else
      load(n, increment.data() + begin, receptance.data() + begin, loads, pushed.data() + begin);
  }
  /// The free increments of a body, with what was added.
  [[nodiscard]] const T* free(const NetworkModes<T>& modes, std::size_t body) const {
    return (is_pushed[body] != 0 ? pushed : increment).data() + modes.begins[body];
  }
  /// Advances the modes of a body under forces. keeps_change: is `change` needed?
  void advance(const NetworkModes<T>& modes, std::size_t body, std::span<const DrivingForce<T>> forces,
               bool keeps_change) {
    const std::size_t begin = modes.begins[body], n = modes.begins[body + 1] - begin;
    const bool is_free = forces.size() <= 2 && is_pushed[body] == 0;
    if (n == 1) return advance_one(modes, body, forces);
    for (; forces.size() > 2; forces = forces.subspan(1))
      add_scaled(n, forces[0].force, forces[0].drive, push(modes, body));
    const DrivingForce<T> none{modes.receptance.data() + begin, T(0)};
    const DrivingForce<T> a = !forces.empty() ? forces[0] : none, b = forces.size() > 1 ? forces[1] : none;
    const T *stiff = modes.stiffness.data() + begin, *lossy = modes.loss.data() + begin;
    T *at = displacement.data() + begin, *next = increment.data() + begin, *moved = change.data() + begin;
    const auto kernel = !is_free       ? advance_all<true, true>
                        : keeps_change ? advance_all<false, true>
                                       : advance_all<false, false>;
    kernel(n, stiff, lossy, a.force, a.drive, b.force, b.drive, pushed.data() + begin, at, next, moved);
    is_pushed[body] = 0;
  }
  /// What the derivatives of the constants do to the increments after a sample. change, displacement: of the model.
  void bend(std::size_t begin, std::span<const T> changes, std::span<const T> displacements) {
    pull(changes.size(), stiffness.data() + begin, loss.data() + begin, changes.data(), displacements.data(),
         increment.data() + begin);
  }

  // Separate functions, because compilers respect __restrict on parameters.
  static void add_scaled(std::size_t n, T factor, const T* __restrict from, T* __restrict to) {
    for (std::size_t i = 0; i < n; ++i) to[i] += factor * from[i];
  }
  static void add_product(std::size_t n, T factor, const T* __restrict a, const T* __restrict b, T* __restrict to) {
    for (std::size_t i = 0; i < n; ++i) to[i] += factor * a[i] * b[i];
  }
  static void copy(std::size_t n, const T* __restrict from, T* __restrict to) {
    for (std::size_t i = 0; i < n; ++i) to[i] = from[i];
  }
  [[nodiscard]] static T dot(std::size_t n, const T* a, const T* b) {
    return n == 1 ? *a * *b : dot_all(n, a, b);  // 1: a mass
  }

 private:
  // Four vectors of 16 bytes.
  [[nodiscard, gnu::noinline]] static T dot_all(std::size_t n, const T* __restrict a, const T* __restrict b) {
    constexpr std::size_t kLanes = 16 / sizeof(T);
    T first[kLanes] = {}, second[kLanes] = {}, third[kLanes] = {}, fourth[kLanes] = {};
    std::size_t i = 0;
    for (; i + 4 * kLanes <= n; i += 4 * kLanes)
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        first[lane] += a[i + lane] * b[i + lane];
        second[lane] += a[i + kLanes + lane] * b[i + kLanes + lane];
        third[lane] += a[i + 2 * kLanes + lane] * b[i + 2 * kLanes + lane];
        fourth[lane] += a[i + 3 * kLanes + lane] * b[i + 3 * kLanes + lane];
      }
    T sum = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      sum += (first[lane] + second[lane]) + (third[lane] + fourth[lane]);
    for (; i < n; ++i) sum += a[i] * b[i];
    return sum;
  }
  void advance_one(const NetworkModes<T>& modes, std::size_t body, std::span<const DrivingForce<T>> forces) {
    const std::size_t i = modes.begins[body];
    T moved = std::exchange(is_pushed[body], 0) != 0 ? pushed[i] : increment[i];
    for (const DrivingForce<T>& force : forces) moved += *force.drive * force.force;
    change[i] = moved;
    displacement[i] += moved;
    increment[i] = (2 - modes.loss[i]) * moved - increment[i] - modes.stiffness[i] * displacement[i];
  }
  // kPushed: the modes start from `pushed`, else from the free increments. kKeepsChange: writes `change`.
  template <bool kPushed, bool kKeepsChange>
  [[gnu::noinline]] static void advance_all(std::size_t n, const T* __restrict stiffness, const T* __restrict loss,
                                            T force_a, const T* __restrict a, T force_b, const T* __restrict b,
                                            const T* __restrict pushed, T* __restrict displacement,
                                            T* __restrict increment, T* __restrict change) {
    for (std::size_t i = 0; i < n; ++i) {
      const T moved = (kPushed ? pushed[i] : increment[i]) + (a[i] * force_a + b[i] * force_b);
      const T after = displacement[i] + moved;
      increment[i] = (2 - loss[i]) * moved - increment[i] - stiffness[i] * after;
      displacement[i] = after;
      if constexpr (kKeepsChange) change[i] = moved;
    }
  }

  static void load(std::size_t n, const T* __restrict increment, const T* __restrict receptance,
                   const T* __restrict loads, T* __restrict pushed) {
    for (std::size_t i = 0; i < n; ++i) pushed[i] = increment[i] + receptance[i] * loads[i];
  }
  static void pull(std::size_t n, const T* __restrict stiffness, const T* __restrict loss, const T* __restrict change,
                   const T* __restrict displacement, T* __restrict increment) {
    for (std::size_t i = 0; i < n; ++i) increment[i] -= loss[i] * change[i] + stiffness[i] * displacement[i];
  }
};

}  // namespace contactspline::detail
