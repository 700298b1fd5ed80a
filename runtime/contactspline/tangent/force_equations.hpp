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

/// Each force responds to the increment of its connection by f_1 > 0 [N/m], and changes of the forces reduce all
/// increments by Xi times these. So increments x under constant forces become y = x - Xi f_1 y, and the forces change
/// by f_1 y:
///
///     y = s^-1 (I + s Xi s)^-1 s x,    s = sqrt(f_1)
///
/// The matrix is symmetric with eigenvalues of 1 or more. The adjoints of the forces solve the same equations with
/// another right side.
template <std::floating_point T>
class ForceEquations {
 public:
  explicit ForceEquations(std::size_t connections) : factor_(connections) {
    acting_.reserve(connections);
    responses_.reserve(connections);
    roots_.reserve(connections);
    ends_.reserve(connections);
  }

  /// Begins a sample without connections.
  void begin() {
    acting_.clear();
    responses_.clear();
  }
  /// Adds a connection; one whose force does not respond is left out.
  void add(std::size_t connection, T response) {
    if (!(response > 0)) return;
    acting_.push_back(connection);
    responses_.push_back(response);
  }
  /// Factorises the matrix, after the last connection. solver: of the network, for its receptances.
  void factorise(const CoupledContacts<T>& solver) {
    const std::size_t n = acting_.size();
    if (n == 1) {
      alone_ = 1 / (1 + solver.receptance(acting_[0], acting_[0]) * responses_[0]);
      return;
    }
    roots_.clear();
    for (const T response : responses_) roots_.push_back(std::sqrt(response));
    for (std::size_t j = 0; j < n; ++j) {
      T* column = factor_.column(j);
      std::fill_n(column, factor_.padded(n), T(0));
      for (std::size_t i = j; i < n; ++i)
        column[i] = T(i == j) + roots_[i] * solver.receptance(acting_[i], acting_[j]) * roots_[j];
    }
    detail::factorise(factor_, n);
    ends_.assign(n, n);
  }

  /// The connections that respond, in the order of values.
  [[nodiscard]] std::span<const std::size_t> acting() const { return acting_; }
  /// The response f_1 of connection acting()[i].
  [[nodiscard]] T response(std::size_t i) const { return responses_[i]; }

  /// values x of the acting connections become y.
  void solve(T* values) const {
    const std::size_t n = acting_.size();
    if (n == 1) {
      values[0] *= alone_;
      return;
    }
    for (std::size_t i = 0; i < n; ++i) values[i] *= roots_[i];
    solve_forwards(factor_, ends_, values);
    solve_backwards(factor_, ends_, values);
    for (std::size_t i = 0; i < n; ++i) values[i] /= roots_[i];
  }

 private:
  std::vector<std::size_t> acting_, ends_;
  std::vector<T> responses_, roots_;
  ColumnMatrix<T> factor_;
  T alone_ = 1;  // the inverse of the matrix, if it has one row
};

}  // namespace contactspline::detail
