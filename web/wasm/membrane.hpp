// SPDX-License-Identifier: MIT
// Circular membranes, found among the bodies of an instrument, and their displacement anywhere.
#pragma once

#include <math.h>  // jn() of POSIX, which <cmath> need not have

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/modal/modal.hpp"

namespace contactspline::web {

/// A membrane with a fixed rim, in parts of its radius. Mode k has the shape J_m(x r) cos(m angle), x a zero of J_m,
/// as generator/resonator/resonator.hpp has it.
class MembraneShapes {
 public:
  /// Nothing where a body of an instrument is no membrane: frequencies and masses of all modes must be those of
  /// zeros.
  static std::optional<MembraneShapes> of(const InstrumentData& data, std::size_t body) {
    const auto frequencies = data.part_of(data.angular_frequencies, body), decays = data.part_of(data.decays, body);
    const auto masses = data.part_of(data.masses, body);
    MembraneShapes found;
    for (std::size_t k = 0; k < masses.size(); ++k) {
      const double x = kFirstZero * std::hypot(frequencies[k], decays[k]) / std::hypot(frequencies[0], decays[0]);
      const auto order = order_of(x, masses[k] / masses[0]);
      if (!order) return {};
      found.modes_.push_back({*order, x});
    }
    if (found.modes_.size() < 10) return {};
    return found;
  }

  [[nodiscard]] ModeShapes<double> at(double r, double angle) const {
    ModeShapes<double> shapes(modes_.size());
    for (std::size_t k = 0; k < modes_.size(); ++k)
      shapes[k] = jn(modes_[k].order, modes_[k].zero * r) * std::cos(modes_[k].order * angle);
    return shapes;
  }

  /// Where a place with these shapes is on the diameter through the strike, -1 to 1.
  [[nodiscard]] double along_diameter(std::span<const double> shapes) const {
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (jn(0, kFirstZero * middle) > shapes[0] ? low : high) = middle;
    }
    for (std::size_t k = 0; k < modes_.size(); ++k)
      if (modes_[k].order == 1) return std::copysign(low, shapes[k]);
    return low;
  }

 private:
  struct Numbered {
    int order;
    double zero;
  };
  static constexpr double kFirstZero = 2.404825557695773;  // of J_0
  static constexpr double kWithin = 1e-7;                  // emitted numbers have 13 digits

  // The modal mass is the area's, half of it for m > 0, times J_{m+1}(x)^2.
  static std::optional<int> order_of(double x, double mass_ratio) {
    const double first = std::pow(jn(1, kFirstZero), 2);
    for (int m = 0; m <= x; ++m) {
      const double expected = (m == 0 ? 1 : 0.5) * std::pow(jn(m + 1, x), 2) / first;
      if (std::abs(jn(m, x)) < kWithin && std::abs(mass_ratio / expected - 1) < kWithin) return m;
    }
    return {};
  }

  std::vector<Numbered> modes_;
};

/// The points of a membrane that are drawn: the middle, then so many rings of equal distance within the rim, each
/// with so many points from the angle 0 to pi. Below is the same: all shapes are even.
inline constexpr std::size_t kRings = 7, kRingPoints = 13;

inline std::vector<ModeShapes<double>> membrane_points(const MembraneShapes& membrane) {
  std::vector<ModeShapes<double>> points = {membrane.at(0, 0)};
  for (std::size_t ring = 1; ring <= kRings; ++ring)
    for (std::size_t p = 0; p < kRingPoints; ++p)
      points.push_back(membrane.at(static_cast<double>(ring) / (kRings + 1),
                                   std::numbers::pi * static_cast<double>(p) / (kRingPoints - 1)));
  return points;
}

}  // namespace contactspline::web
