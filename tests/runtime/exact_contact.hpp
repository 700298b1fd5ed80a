// SPDX-License-Identifier: MIT
// The contact step in 113 bits, its root between bounds with a change of sign: what every other answer is measured
// against.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/step/contact.hpp"
#if !defined(__SIZEOF_FLOAT128__)
#include <boost/multiprecision/cpp_bin_float.hpp>
#endif

namespace contactspline::testing {

#if defined(__SIZEOF_FLOAT128__)
using Wide = __float128;
#else
using Wide = boost::multiprecision::cpp_bin_float_quad;
#endif

[[nodiscard]] inline Wide magnitude(Wide value) {
  return value < 0 ? Wide(-value) : value;
}

/// The C1 potential that a table stands for: its force runs straight from knot to knot through the table's forces,
/// and beyond the last knot with the table's half_curvature; its energy is the area below. The other entries of a
/// table follow from these but for rounding, which slope_error() and energy_error() tell.
class ExactContact {
 public:
  template <typename T>
  explicit ExactContact(std::span<const Segment<T>> table) : pieces_(table.size()) {
    for (std::size_t j = 1; j < table.size(); ++j)
      pieces_[j] = {Wide(table[j].knot), 0, Wide(table[j].force), 2 * Wide(table[j].half_curvature)};
    for (std::size_t j = 1; j + 1 < table.size(); ++j) {
      Piece& piece = pieces_[j];
      Piece& next = pieces_[j + 1];
      const Wide width = next.knot - piece.knot;
      const Wide rise = next.force - piece.force;
      slope_error_ = std::max(slope_error_, Wide(magnitude(piece.slope * width - rise) / next.force));
      piece.slope = rise / width;
      next.energy = piece.energy + width * (piece.force + next.force) / 2;
      energy_error_ = std::max(energy_error_, Wide(magnitude(Wide(table[j + 1].energy) - next.energy) / next.energy));
    }
  }
  template <typename T>
  explicit ExactContact(const std::vector<Segment<T>>& table) : ExactContact(std::span<const Segment<T>>(table)) {}

  [[nodiscard]] std::size_t last() const { return pieces_.size() - 1; }
  [[nodiscard]] Wide knot(std::size_t j) const { return pieces_[j].knot; }
  [[nodiscard]] Wide knot_energy(std::size_t j) const { return pieces_[j].energy; }
  [[nodiscard]] Wide knot_force(std::size_t j) const { return pieces_[j].force; }
  [[nodiscard]] Wide slope(std::size_t j) const { return pieces_[j].slope; }

  /// 0 out of contact, else 1 to last().
  [[nodiscard]] std::size_t segment_of(Wide y) const {
    const auto above = std::upper_bound(pieces_.begin() + 1, pieces_.end(), y,
                                        [](Wide value, const Piece& piece) { return value < piece.knot; });
    return static_cast<std::size_t>(above - pieces_.begin()) - 1;
  }
  [[nodiscard]] Wide force(Wide y) const {
    const Piece& piece = pieces_[segment_of(y)];
    return piece.force + piece.slope * (y - piece.knot);
  }
  [[nodiscard]] Wide energy(Wide y) const {
    const Piece& piece = pieces_[segment_of(y)];
    const Wide t = y - piece.knot;
    return piece.energy + t * (piece.force + piece.slope * t / 2);
  }

  /// Worst |2 c_j h_j - (F_j+1 - F_j)| / F_j+1.
  [[nodiscard]] Wide slope_error() const { return slope_error_; }
  /// Worst relative deviation of a table energy from the area below the force.
  [[nodiscard]] Wide energy_error() const { return energy_error_; }

 private:
  struct Piece {
    Wide knot = 0, energy = 0, force = 0, slope = 0;
  };
  std::vector<Piece> pieces_;
  Wide slope_error_ = 0, energy_error_ = 0;
};

/// The root x of h and its force.
struct ExactStep {
  Wide increment, force;
  std::size_t end_segment;
};

/// One approach to an exact contact. h(x) = x - xf + xi [V(y0 + x) - V(y0)]/x rises with slope >= 1.
class ExactApproach {
 public:
  ExactApproach(const ExactContact& contact, Wide compression, Wide free_increment, Wide receptance)
      : contact_(contact),
        y0_(compression),
        xf_(free_increment),
        xi_(receptance),
        start_(contact.segment_of(compression)),
        f0_(contact.force(compression)) {}

  [[nodiscard]] std::size_t start() const { return start_; }
  [[nodiscard]] std::size_t end_segment(Wide x) const {
    std::size_t low = 0, high = contact_.last();
    while (low < high) {
      const std::size_t middle = (low + high + 1) / 2;
      if (distance_to(middle) <= x)
        low = middle;
      else
        high = middle - 1;
    }
    return low;
  }

  /// V(y0 + x) - V(y0) as the area below the force, with a difference of energies for whole segments only.
  [[nodiscard]] Wide work(Wide x, std::size_t end_segment) const {
    if (end_segment == start_) return x * (f0_ + contact_.slope(start_) * x / 2);
    const std::size_t first = end_segment > start_ ? start_ + 1 : start_;
    const std::size_t entry = end_segment > start_ ? end_segment : end_segment + 1;
    const Wide beyond = x - distance_to(entry);
    return distance_to(first) * (f0_ + contact_.knot_force(first)) / 2 +
           (contact_.knot_energy(entry) - contact_.knot_energy(first)) +
           beyond * (contact_.knot_force(entry) + contact_.slope(end_segment) * beyond / 2);
  }
  /// [V(y0 + x) - V(y0)]/x, and V'(y0) where x is 0.
  [[nodiscard]] Wide mean_force(Wide x, std::size_t end_segment) const {
    return end_segment == start_ ? Wide(f0_ + contact_.slope(start_) * x / 2) : Wide(work(x, end_segment) / x);
  }
  [[nodiscard]] Wide mean_force(Wide x) const { return mean_force(x, end_segment(x)); }
  [[nodiscard]] Wide h(Wide x, std::size_t end_segment) const { return x - xf_ + xi_ * mean_force(x, end_segment); }
  [[nodiscard]] Wide h(Wide x) const { return h(x, end_segment(x)); }

  /// The step, between two bounds where h changes its sign: the mean force is >= 0 and rises, so the root lies
  /// between xf - xi (mean force at xf) and xf.
  [[nodiscard]] ExactStep solve() const {
    const Wide greatest = mean_force(xf_);
    if (greatest == 0) return {xf_, 0, end_segment(xf_)};
    return solve_between(xf_ - xi_ * greatest, xf_);
  }
  /// The same where the root is known to lie within `reach` of a guess; solve() where that proves wrong.
  [[nodiscard]] ExactStep solve_near(Wide guess, Wide reach) const {
    const bool bracketed = mean_force(xf_) > 0 && h(guess - reach) <= 0 && h(guess + reach) >= 0;
    return bracketed ? solve_between(guess - reach, guess + reach) : solve();
  }

  /// Least (shift < 0) or greatest (shift > 0) force of the step when xf moves by `shift`, not less extreme than it
  /// is: h = shift there, between the step's root and `shift` beyond, for h' >= 1. 12 halvings are enough for a
  /// bound.
  [[nodiscard]] Wide force_at_shift(const ExactStep& step, Wide shift) const {
    Wide near = step.increment, far = step.increment + shift;
    const std::size_t first = end_segment(near),
                      last = end_segment(far);  // mostly one segment: found once, not 12 times
    for (int i = 0; i < 12; ++i) {
      const Wide middle = (near + far) / 2;
      if ((h(middle, first == last ? first : end_segment(middle)) < shift) == (shift > 0))
        near = middle;
      else
        far = middle;
    }
    // Two views of one force, one rising with x, the other falling: each bounds it from one end of the bracket.
    const Wide stored = mean_force(far), balance = (xf_ + shift - near) / xi_;
    return shift > 0 ? std::min(stored, balance) : std::max({stored, balance, Wide(0)});
  }

 private:
  static constexpr double kTolerance = 0x1p-100;

  [[nodiscard]] Wide distance_to(std::size_t knot) const { return contact_.knot(knot) - y0_; }

  [[nodiscard]] Wide tolerance(Wide low, Wide high) const {
    return kTolerance * std::max(magnitude(xf_), low > 0 ? low : Wide(-high));
  }

  // Tries to spare the bisection its hundred steps: guesses the root by the secant method (Illinois), and takes
  // bounds closely around the guess if h changes its sign between them. Otherwise the bounds stay.
  void narrow(Wide& low, Wide& high, std::size_t segment) const {
    const Wide enough = tolerance(low, high) / 4;
    Wide left = low, right = high, h_left = h(left, segment), h_right = h(right, segment), guess = low;
    int side = 0;  // the side that moved last: -1 left, 1 right
    for (int i = 0; i < 40 && h_left < 0 && h_right > 0; ++i) {
      const Wide next = right - h_right * (right - left) / (h_right - h_left);
      const bool found = magnitude(next - guess) <= enough || next <= left || next >= right;
      guess = next;
      if (found) break;
      const Wide value = h(guess, segment);
      if (value < 0) {
        left = guess, h_left = value;
        if (side == -1) h_right /= 2;
        side = -1;
      } else {
        right = guess, h_right = value;
        if (side == 1) h_left /= 2;
        side = 1;
      }
    }
    const Wide before = std::max(low, Wide(guess - enough)), after = std::min(high, Wide(guess + enough));
    if (h(before, segment) <= 0 && h(after, segment) >= 0) low = before, high = after;
  }

  // First among the knots, then within the segment.
  [[nodiscard]] ExactStep solve_between(Wide low, Wide high) const {
    std::size_t below = 0, above = contact_.last();
    while (below < above) {
      const std::size_t middle = (below + above + 1) / 2;
      const Wide x = distance_to(middle);
      if (x <= low || (x < high && h(x, middle) <= 0))
        below = middle;
      else
        above = middle - 1;
    }
    if (below > 0) low = std::max(low, distance_to(below));
    if (below < contact_.last()) high = std::min(high, distance_to(below + 1));
    narrow(low, high, below);
    while (high - low > tolerance(low, high)) {
      const Wide middle = (low + high) / 2;
      if (middle == low || middle == high) break;
      (h(middle, below) < 0 ? low : high) = middle;
    }
    const Wide x = (low + high) / 2;
    // The force has two expressions. Take the one that passes on less of the error of x.
    const Wide stored = mean_force(x, below);
    const bool stiff = below == start_ ? xi_ * contact_.slope(start_) / 2 > 1
                                       : xi_ * magnitude(contact_.force(y0_ + x) - stored) > magnitude(x);
    return {x, stiff ? Wide((xf_ - x) / xi_) : stored, below};
  }

  const ExactContact& contact_;
  Wide y0_, xf_, xi_;
  std::size_t start_;
  Wide f0_;
};

}  // namespace contactspline::testing
