// SPDX-License-Identifier: MIT
// The contact step by bisection in long double: what the library is measured against.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "contactspline/step/contact.hpp"

namespace contactspline::testing {

/// The potential whose force runs straight through the forces of a table; energies are areas below it.
class ExactContact {
 public:
  using Real = long double;

  template <std::floating_point T>
  explicit ExactContact(SegmentTable<T> table) {
    for (const auto& s : table) pieces_.push_back({s.knot, 0, s.force, 2 * Real(s.half_curvature)});
    for (std::size_t j = 2; j < pieces_.size(); ++j) {
      Piece& before = pieces_[j - 1];
      const Real width = pieces_[j].knot - before.knot;
      before.slope = (pieces_[j].force - before.force) / width;
      pieces_[j].energy = before.energy + width * (before.force + pieces_[j].force) / 2;
    }
  }

  /// Index of the segment that holds y, 0 out of contact.
  [[nodiscard]] std::size_t index(Real y) const {
    const auto above = std::upper_bound(pieces_.begin() + 1, pieces_.end(), y,
                                        [](Real value, const Piece& piece) { return value < piece.knot; });
    return static_cast<std::size_t>(above - pieces_.begin()) - 1;
  }
  [[nodiscard]] Real force(Real y) const {
    const Piece& piece = pieces_[index(y)];
    return piece.force + piece.slope * (y - piece.knot);
  }
  [[nodiscard]] Real slope(Real y) const { return pieces_[index(y)].slope; }
  [[nodiscard]] Real potential(Real y) const {
    const Piece& piece = pieces_[index(y)];
    return piece.energy + (y - piece.knot) * (piece.force + force(y)) / 2;
  }

  /// The discrete gradient f [N] with x = xf - xi f. It rises with x, so x lies between xf - xi f(xf) and xf.
  [[nodiscard]] Real step(Real y0, Real xf, Real xi) const {
    Real low = xf - xi * gradient(y0, xf), high = xf;
    Real x = (low + high) / 2;
    while (high - low > 0x1p-63L * std::max(std::abs(x), std::abs(xf))) {
      (x + xi * gradient(y0, x) < xf ? low : high) = x;
      x = (low + high) / 2;
    }
    return std::max(Real(0), (xf - x) / xi);
  }

  /// With the stiffness scaled and a viscous force loss F(y0) x/dt; 0 where the sum would pull.
  [[nodiscard]] Real contact(Real ratio, Real loss, Real dt, Real y0, Real xf, Real xi) const {
    const Real resistance = loss * ratio * force(y0) / dt;
    const Real divisor = 1 + xi * resistance;
    const Real elastic = ratio * step(y0, xf / divisor, ratio * xi / divisor);
    return std::max(Real(0), (elastic + resistance * xf) / divisor);
  }

 private:
  struct Piece {
    Real knot, energy, force, slope;
  };

  // Area below the force from y0 to y0 + x, whole segments at once, divided by x.
  [[nodiscard]] Real gradient(Real y0, Real x) const {
    const std::size_t from = index(y0), to = index(y0 + x);
    if (from == to) return force(y0) + pieces_[from].slope * x / 2;
    const Piece& first = pieces_[to > from ? from + 1 : from];
    const Piece& entry = pieces_[to > from ? to : to + 1];
    const Real distance = entry.knot - y0, beyond = x - distance;
    const Real work = (first.knot - y0) * (force(y0) + first.force) / 2 + (entry.energy - first.energy) +
                      beyond * (entry.force + pieces_[to].slope * beyond / 2);
    return work / x;
  }

  std::vector<Piece> pieces_;
};

}  // namespace contactspline::testing
