// SPDX-License-Identifier: MIT
// How the forces of a network change together over one sample: the linear equations of its derivatives, the same
// forwards and backwards (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/linear_algebra.hpp"

namespace contactspline::detail {

/// Each force responds to the increment of its connection by r >= 0 [N/m], and forces g reduce all increments by Xi
/// g. Increments x under constant forces so change the forces by g = r (x - Xi g), that is g = G x with
///
///     G = s (I + s Xi s)^-1 s,    s = sqrt(r)
///
/// G is symmetric, so it serves derivatives in both directions. The matrix has eigenvalues of 1 or more.
template <std::floating_point T>
class ForceEquations {
 public:
  explicit ForceEquations(std::size_t connections) : factor_(connections) {
    acting_.reserve(connections);
    roots_.reserve(connections);
    ends_.reserve(connections);
  }

  /// Begins a sample without connections.
  void begin() {
    acting_.clear();
    roots_.clear();
  }
  /// Adds a connection; one whose force does not respond is left out.
  void add(std::size_t connection, T response) {
    if (!(response > 0)) return;
    acting_.push_back(connection);
    roots_.push_back(std::sqrt(response));
  }
  /// Factorises the matrix, after the last connection. solver: of the network, for its admittances.
  void factorise(const CoupledContacts<T>& solver) {
    const std::size_t n = acting_.size();
    if (n == 1) {
      alone_ = 1 / (1 + roots_[0] * solver.admittance(acting_[0], acting_[0]) * roots_[0]);
      return;
    }
    for (std::size_t j = 0; j < n; ++j) {
      T* column = factor_.column(j);
      std::fill_n(column, factor_.padded(n), T(0));
      for (std::size_t i = j; i < n; ++i)
        column[i] = T(i == j) + roots_[i] * solver.admittance(acting_[i], acting_[j]) * roots_[j];
    }
    detail::factorise(factor_, n);
    ends_.assign(n, n);
  }

  /// The connections that respond, in the order of values.
  [[nodiscard]] std::span<const std::size_t> acting() const { return acting_; }
  /// s of connection acting()[i].
  [[nodiscard]] T root(std::size_t i) const { return roots_[i]; }

  /// values x of the acting connections become (I + s Xi s)^-1 s x: times s these are G x, divided by s they are what
  /// the transposed equations f + Xi r f = x give.
  void solve(T* values) const {
    for (std::size_t i = 0; i < roots_.size(); ++i) values[i] *= roots_[i];
    if (roots_.size() == 1) {
      values[0] *= alone_;
      return;
    }
    solve_forwards(factor_, ends_, values);
    solve_backwards(factor_, ends_, values);
  }

 private:
  std::vector<std::size_t> acting_, ends_;
  std::vector<T> roots_;
  ColumnMatrix<T> factor_;
  T alone_ = 1;  // the inverse of the matrix, if it has one row
};

}  // namespace contactspline::detail
