// SPDX-License-Identifier: MIT
// A contact law whose exponent is a live control.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/version.hpp"

namespace contactspline {

/// The table of a material with a live exponent, for any exponent in its range. It interpolates between the two
/// nearest members of the material's family; like them it is C1 and convex. Models that hold table() use each new
/// exponent from the next sample on. If the exponent changes during a contact, the change adds the energy V_new(y) -
/// V_old(y), as a change of stiffness does.
template <typename Material, std::floating_point T>
class LiveExponent {
  static_assert(fits_runtime<Material>, "generated for another version: run `contactspline generate` again");

 public:
  static constexpr std::size_t size = Material::live::segments + 1;

  /// exponent: as for set(); the smallest one if it is not a number.
  explicit LiveExponent(T exponent) { set(held(kRange.min, exponent, kRange)); }

  /// Sets the exponent, clamped to Material::live::min_exponent and max_exponent. Does nothing if it is not a number.
  /// Safe on an audio thread: one or two multiplications for each number of the table.
  void set(T exponent) {
    if (!is_number(exponent)) return;
    using Live = typename Material::live;
    constexpr T kSteps = static_cast<T>(Live::members - 1);
    const T part = (std::clamp(exponent, kRange.min, kRange.max) - kRange.min) / (kRange.max - kRange.min);
    const T place = (std::min)(part, T(1)) * kSteps;
    const auto below = (std::min)(static_cast<std::size_t>(place), Live::members - 2);
    const T fraction = place - static_cast<T>(below);
    for (std::size_t j = 1; j < size; ++j) {
      const Segment<T>&low = kMembers[below][j], &high = kMembers[below + 1][j];
      table_[j] = {low.knot, blend(low.energy, high.energy, fraction), blend(low.force, high.force, fraction),
                   blend(low.half_curvature, high.half_curvature, fraction)};
    }
  }

  /// Entry 0 is "out of contact", then the segments. The memory does not move when the exponent changes.
  [[nodiscard]] SegmentTable<T, size> table() const { return table_; }

 private:
  static constexpr ControlRange<T> kRange{static_cast<T>(Material::live::min_exponent),
                                          static_cast<T>(Material::live::max_exponent)};

  static T blend(T low, T high, T fraction) { return low + fraction * (high - low); }

  static constexpr auto kMembers = [] {
    using Live = typename Material::live;
    std::array<std::array<Segment<T>, size>, Live::members> members{};
    for (std::size_t i = 0; i < Live::members; ++i)
      for (std::size_t j = 0; j < Live::segments; ++j) {
        const std::size_t k = i * Live::segments + j;
        members[i][j + 1] = {static_cast<T>(Live::knots[j]), static_cast<T>(Live::energies[k]),
                             static_cast<T>(Live::forces[k]), static_cast<T>(Live::half_curvatures[k])};
      }
    return members;
  }();

  std::array<Segment<T>, size> table_{};
};

}  // namespace contactspline
