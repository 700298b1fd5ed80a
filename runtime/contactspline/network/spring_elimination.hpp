// SPDX-License-Identifier: MIT
// Springs are linear: they are eliminated, and contacts meet bodies and springs together.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/sample_law.hpp"

namespace contactspline::detail {

/// Motions whose energies round to 0 [m]: errors of less do not count.
template <std::floating_point T>
inline constexpr T kTinyMotion = std::numeric_limits<T>::min_exponent < -1000 ? T(1e-150) : T(1e-18);

/// The springs of a sample. Their forces are root z with
///
///     (I + root Xi root) z = root (K compression/slope + free increment - Xi of contacts)
///
/// root the roots of their slopes. The Cholesky factor L of the matrix eliminates z as it does rows of any system:
/// with W = L^-1 root Xi, contacts meet the receptances Xi - W' W and have the increments free - W' ahead without
/// forces of contacts, ahead = L^-1 root (K compression/slope + free increment).
///
/// Xi - W' W loses digits: beside a spring of slope c it is about xi/(1 + c xi), and its error is that of xi. An
/// error of one sign in it raises the energy by as much in each collision. So L, W and the difference are computed in
/// double precision and then rounded (docs/how-it-works/several-contacts.md).
template <std::floating_point T>
class SpringElimination {
 public:
  explicit SpringElimination(std::size_t connections)
      : range_(connections),
        exact_factor_(connections),
        exact_rows_(connections),
        exact_root_(connections),
        factor_(connections),
        rows_(connections),
        receptance_(connections),
        slope_(connections),
        root_(connections),
        push_(connections),
        ahead_(connections),
        right_(connections),
        free_(connections),
        force_(connections) {
    for (auto* list : {&springs_, &eliminated_, &ready_}) list->reserve(connections);
    is_ready_.resize(connections);
    ends_.reserve(connections);
  }

  void clear() { springs_.clear(); }
  void add(std::size_t i) { springs_.push_back(i); }
  [[nodiscard]] bool empty() const { return springs_.empty(); }

  /// The receptances of the bodies have changed.
  void forget() { eliminated_.clear(); }

  /// Begins a sample. Returns whether the receptances beside the springs have changed. receptance: of the bodies.
  bool predict(std::span<const CoupledConnection<T>> connections, const ColumnMatrix<double>& receptance) {
    const bool is_old = is_elimination_old(connections);
    if (is_old) eliminate(connections, receptance);
    for (std::size_t s = 0; s < springs_.size(); ++s) {
      const CoupledConnection<T>& c = connections[springs_[s]];
      ahead_[s] = root_[s] * c.free_increment + push_[s] * c.compression;
    }
    solve_forwards(factor_, ends_, ahead_.data());
    return is_old;
  }

  /// Eliminates the springs from contact i, before anything below is asked of it in this sample. receptance: of the
  /// bodies.
  void take(std::size_t i, const ColumnMatrix<double>& receptance) {
    if (std::exchange(is_ready_[i], true)) return;
    eliminate_from(i, receptance);
    ready_.push_back(i);
    for (const std::size_t j : ready_) receptance_(i, j) = receptance_(j, i) = beside_springs(i, j, receptance);
  }

  /// The receptances that contacts meet, of those that were taken.
  [[nodiscard]] const ColumnMatrix<T>& receptance() const { return receptance_; }

  /// The increment of contact i without forces of contacts.
  [[nodiscard]] T increment(std::size_t i, T free_increment) const {
    if (springs_.empty()) return free_increment;
    const T* w = rows_.column(i);
    for (std::size_t s = range_[i].begin; s < range_[i].end; ++s) free_increment -= w[s] * ahead_[s];
    return free_increment;
  }

  /// The forces of the springs beside those of the contacts, and where they end. receptance: of the bodies.
  void solve(std::span<CoupledConnection<T>> connections, const ColumnMatrix<T>& receptance,
             std::span<const std::size_t> contacts, std::span<EndOfSample<T>> ends) {
    const std::size_t m = springs_.size();
    for (std::size_t s = 0; s < m; ++s) {
      right_[s] = ahead_[s];
      force_[s] = 0;
      free_[s] = connections[springs_[s]].free_increment;
    }
    for (const std::size_t i : contacts) {
      const T force = connections[i].force;
      if (force == 0) continue;
      for (std::size_t s = range_[i].begin; s < range_[i].end; ++s) {
        right_[s] -= rows_(s, i) * force;
        free_[s] -= receptance(springs_[s], i) * force;
      }
    }
    for (int pass = 0;; ++pass) {
      solve_backwards(factor_, ends_, right_.data());
      for (std::size_t s = 0; s < m; ++s) force_[s] += root_[s] * right_[s];
      if (!have_errors(connections, receptance, ends) || pass == kRefinements) return;
      solve_forwards(factor_, ends_, right_.data());
    }
  }

 private:
  struct Range {
    std::size_t begin, end;
  };
  static constexpr T kRounding = std::numeric_limits<T>::epsilon();
  static constexpr int kRefinements = 2;  // of the forces
  static constexpr bool kRounds = std::numeric_limits<T>::digits < std::numeric_limits<double>::digits;

  // Slope of a spring's force [N/m]: force = K compression + slope increment.
  [[nodiscard]] static T slope_of(const CoupledConnection<T>& c) { return c.spring_n_per_m / 2 + c.resistance; }

  // Moves the springs by their forces. Does the law of one of them want a force that differs by more than rounding?
  // right_ becomes what corrects the forces. free_: their increments under the forces of contacts.
  bool have_errors(std::span<CoupledConnection<T>> connections, const ColumnMatrix<T>& receptance,
                   std::span<EndOfSample<T>> ends) {
    bool have_errors = false;
    for (std::size_t s = 0; s < springs_.size(); ++s) {
      const std::size_t i = springs_[s];
      CoupledConnection<T>& c = connections[i];
      T x = free_[s];
      for (std::size_t t = range_[i].begin; t < range_[i].end; ++t) x -= receptance(springs_[t], i) * force_[t];
      const T slope = slope_[s], at_rest = c.spring_n_per_m * c.compression;
      const T error = at_rest + slope * x - force_[s];
      const T displacements = std::abs(c.free_increment) + std::abs(x) + receptance(i, i) * std::abs(force_[s]);
      const T forces = std::abs(force_[s]) + std::abs(at_rest);
      have_errors |= std::abs(error) > kRounding * (2 * forces + slope * displacements) + slope * kTinyMotion<T>;
      c.force = force_[s];
      ends[i] = {c.compression + x, 0};
      right_[s] = slope > 0 ? error / root_[s] : T(0);
    }
    return have_errors;
  }

  [[nodiscard]] bool is_elimination_old(std::span<const CoupledConnection<T>> connections) const {
    if (eliminated_ != springs_) return true;
    for (std::size_t s = 0; s < springs_.size(); ++s)
      if (slope_[s] != slope_of(connections[springs_[s]])) return true;
    return false;
  }

  void eliminate(std::span<const CoupledConnection<T>> connections, const ColumnMatrix<double>& receptance) {
    eliminated_ = springs_;
    for (std::size_t s = 0; s < springs_.size(); ++s) {
      const CoupledConnection<T>& c = connections[springs_[s]];
      slope_[s] = slope_of(c);
      root_[s] = std::sqrt(slope_[s]);
      push_[s] = slope_[s] > 0 ? c.spring_n_per_m / slope_[s] * root_[s] : T(0);
      exact_root_[s] = std::sqrt(double(slope_[s]));
    }
    factorise_springs(receptance);
    for (const std::size_t i : springs_)
      measure_range(i, [&](std::size_t s) { return receptance(springs_[s], i) == 0; });
    for (const std::size_t i : ready_) is_ready_[i] = false;
    ready_.clear();
  }

  void factorise_springs(const ColumnMatrix<double>& receptance) {
    const std::size_t m = springs_.size();
    for (std::size_t s = 0; s < m; ++s) {
      double* to = exact_factor_.column(s);
      for (std::size_t t = 0; t < m; ++t)
        to[t] = exact_root_[s] * exact_root_[t] * receptance(springs_[t], springs_[s]);
      std::fill(to + m, to + exact_factor_.padded(m), 0.0);
      to[s] += 1;
    }
    factorise(exact_factor_, m);
    ends_.assign(m, 0);
    for (std::size_t s = 0; s < m; ++s)
      for (std::size_t t = s; t < m; ++t) {
        factor_(t, s) = static_cast<T>(exact_factor_(t, s));
        if (exact_factor_(t, s) != 0) ends_[s] = t + 1;
      }
  }

  // Row i of W, of a contact.
  void eliminate_from(std::size_t i, const ColumnMatrix<double>& receptance) {
    double* w = exact_rows_.column(i);
    for (std::size_t s = 0; s < springs_.size(); ++s) w[s] = exact_root_[s] * receptance(springs_[s], i);
    solve_forwards(exact_factor_, ends_, w);
    for (std::size_t s = 0; s < springs_.size(); ++s) rows_(s, i) = static_cast<T>(w[s]);
    measure_range(i, [&](std::size_t s) { return w[s] == 0 && receptance(springs_[s], i) == 0; });
  }

  // The springs that move connection i.
  template <typename IsApart>
  void measure_range(std::size_t i, IsApart is_apart) {
    Range& range = range_[i] = {0, springs_.size()};
    while (range.end > 0 && is_apart(range.end - 1)) --range.end;
    while (range.begin < range.end && is_apart(range.begin)) ++range.begin;
  }

  [[nodiscard]] T beside_springs(std::size_t i, std::size_t j, const ColumnMatrix<double>& receptance) const {
    const double *w = exact_rows_.column(i), *v = exact_rows_.column(j);
    double beside = receptance(j, i);
    const std::size_t begin = (std::max)(range_[i].begin, range_[j].begin);
    const std::size_t end = (std::min)(range_[i].end, range_[j].end);
    for (std::size_t s = begin; s < end; ++s) beside -= v[s] * w[s];
    if (i == j) beside = (std::max)(beside, std::numeric_limits<double>::epsilon() * receptance(i, i));
    // Rounded up so far that the rounding errors of all receptances together take energy: none is larger than
    // eps sqrt(Xi_ii Xi_jj), and there are n in a row.
    if (kRounds && i == j) beside *= 1 + static_cast<double>(range_.size()) * double(kRounding);
    return static_cast<T>(beside);
  }

  IndexList springs_, eliminated_;                  // of this sample; for which the constants below were computed
  IndexList ready_;                                 // contacts that were taken since then
  std::vector<char> is_ready_;                      // of all connections: is it one of these?
  std::vector<Range> range_;                        // springs that move a connection
  std::vector<std::size_t> ends_;                   // rows of the factor from which on each column is 0
  ColumnMatrix<double> exact_factor_, exact_rows_;  // L and W
  ModalArray<double> exact_root_;
  ColumnMatrix<T> factor_, rows_, receptance_;  // L, W and Xi - W' W, rounded
  ModalArray<T> slope_, root_, push_, ahead_;
  ModalArray<T> right_, free_, force_;  // of solve()
};

}  // namespace contactspline::detail
