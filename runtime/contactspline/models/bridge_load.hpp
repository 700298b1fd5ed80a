// SPDX-License-Identifier: MIT
// The places along a bridge, loaded by the stiffness of the strings that end there: one linear system.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <vector>

namespace contactspline::detail {

/// Forces f at P places of a body whose strings pull back. Over a sample the places move by c = free + Y f, and
/// f = pull - H c: Y are the body's changes of displacement per force [m/N], symmetric and positive semidefinite, H
/// half of the stiffness at each place [N/m], a diagonal matrix, both of them not negative. So
///
///     (I + H Y) f = pull - H free
///
/// which factor() eliminates once, in P^3/3 products, and solve() solves in P^2. The divisors are those of
/// I + H^(1/2) Y H^(1/2), of which each is at least 1: no force divides by less, whatever the body and the strings
/// (docs/how-it-works/body.md). With one place it is the division by 1 + Y H.
template <std::floating_point T>
class BridgeLoad {
 public:
  /// Places without receptance. Allocates.
  explicit BridgeLoad(std::size_t places) : places_(places), receptance_(places * places), factor_(receptance_) {}

  [[nodiscard]] std::size_t places() const { return places_; }

  /// Change of displacement over a sample at a place per newton at another one [m/N]; the same both ways.
  void set_receptance(std::size_t at, std::size_t of_force, T m_per_n) {
    receptance_[at * places_ + of_force] = receptance_[of_force * places_ + at] = m_per_n;
  }

  /// Takes half the stiffness at each place [N/m], `places()` numbers of at least 0.
  void factor(const T* half_n_per_m) {
    for (std::size_t column = 0; column < places_; ++column)
      for (std::size_t row = 0; row < places_; ++row)
        at(row, column) = static_cast<T>(row == column) + receptance_[column * places_ + row] * half_n_per_m[row];
    for (std::size_t step = 0; step < places_; ++step) {
      at(step, step) = (std::max)(at(step, step), T(1));  // what rounding may take away
      for (std::size_t row = step + 1; row < places_; ++row) at(row, step) /= at(step, step);
      for (std::size_t column = step + 1; column < places_; ++column) {
        for (std::size_t row = step + 1; row < places_; ++row) at(row, column) -= at(row, step) * at(step, column);
        at(step, column) /= at(step, step);
      }
    }
  }

  /// Replaces pull - H free by the forces [N], `places()` numbers.
  void solve(T* forces_n) const {
    for (std::size_t column = 0; column + 1 < places_; ++column)
      for (std::size_t row = column + 1; row < places_; ++row) forces_n[row] -= at(row, column) * forces_n[column];
    for (std::size_t place = 0; place < places_; ++place) forces_n[place] /= at(place, place);
    for (std::size_t column = places_; column-- > 1;)
      for (std::size_t row = 0; row < column; ++row) forces_n[row] -= at(row, column) * forces_n[column];
  }

  /// Adds to each change [m] what the forces [N] move.
  void add_response(const T* forces_n, T* changes_m) const {
    for (std::size_t column = 0; column < places_; ++column)
      for (std::size_t row = 0; row < places_; ++row)
        changes_m[row] += receptance_[column * places_ + row] * forces_n[column];
  }

 private:
  // Column by column: the divisors, below them the lower factor, above them the upper one, both with ones as
  // diagonal.
  [[nodiscard]] T& at(std::size_t row, std::size_t column) { return factor_[column * places_ + row]; }
  [[nodiscard]] T at(std::size_t row, std::size_t column) const { return factor_[column * places_ + row]; }

  std::size_t places_;
  std::vector<T> receptance_, factor_;
};

}  // namespace contactspline::detail
