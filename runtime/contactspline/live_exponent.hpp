// SPDX-License-Identifier: MIT
// The exponent of a contact law as a live control.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "contactspline/contact.hpp"

namespace contactspline {

/// The table of a material with a live exponent, for any exponent of its range: the blend of the two members of its
/// family nearest to it, C1 and convex as they are. Models that were given table() follow every change. In the midst
/// of a contact a change of exponent does the work V'(y) - V(y) on it, as a change of stiffness does.
template <typename Material, std::floating_point T>
class LiveExponent {
 public:
  static constexpr std::size_t size = Material::live::segments + 1;

  explicit LiveExponent(T exponent) { set(exponent); }

  /// Takes an exponent, from Material::live::least_exponent to most_exponent; what lies beyond counts as the nearest
  /// of these. Safe in an audio thread: a multiplication or two for each number of the table.
  void set(T exponent) {
    using Live = typename Material::live;
    constexpr T kSteps = static_cast<T>(Live::members - 1);
    constexpr T kLeast = static_cast<T>(Live::least_exponent), kMost = static_cast<T>(Live::most_exponent);
    const T place = std::clamp((exponent - kLeast) / (kMost - kLeast), T(0), T(1)) * kSteps;
    const auto below = std::min(static_cast<std::size_t>(place), Live::members - 2);
    const T part = place - static_cast<T>(below);
    for (std::size_t j = 1; j < size; ++j) {
      const Segment<T>&low = kMembers[below][j], &high = kMembers[below + 1][j];
      table_[j] = {low.knot, blend(low.energy, high.energy, part), blend(low.force, high.force, part),
                   blend(low.half_curvature, high.half_curvature, part)};
    }
  }

  /// "Out of contact" followed by the segments; stays where it is.
  [[nodiscard]] SegmentTable<T, size> table() const { return table_; }

 private:
  static T blend(T low, T high, T part) { return low + part * (high - low); }

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
