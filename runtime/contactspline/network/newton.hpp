// SPDX-License-Identifier: MIT
// Newton's method on the convex merit of a group of contacts, and the bounding law where it takes too long.
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
#include "contactspline/network/contact_group.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/step/contact.hpp"

namespace contactspline::detail {

/// Finds the forces of a group: the minimum of its convex merit.
template <std::floating_point T>
class NewtonSolver {
 public:
  using State = GroupState<T>;

  NewtonSolver(std::size_t max_contacts, double sample_rate_hz, int max_steps, int patience)
      : time_step_(T(1 / sample_rate_hz)),
        max_steps_(max_steps),
        patience_(patience),
        now_(max_contacts),
        next_(max_contacts),
        system_(max_contacts),
        root_(max_contacts),
        step_(max_contacts) {
    rows_.reserve(max_contacts);
  }

  /// Begins a sample.
  void begin() { steps_ = 0; }

  /// Solves a group that has been gathered. is_new: in this sample it has not been solved before.
  const State& solve(const ContactGroup<T>& group, bool is_new) {
    for (std::size_t a = 0; a < group.size(); ++a) {
      now_.force[a] = group.connection(a).force;
      now_.segment[a] = next_.segment[a] = group.connection(a).segment;
    }
    if (!iterate(group, is_new)) apply_bounding_law(group);
    return now_;
  }

  [[nodiscard]] int steps() const { return steps_; }
  [[nodiscard]] std::size_t bounded() const { return bounded_; }

 private:
  static constexpr T kRounding = std::numeric_limits<T>::epsilon();

  // Finds the solution, or returns false. Each step is Newton's, about the point that linearise_nearby() chooses. If
  // patience_ of them in a row do not halve the smallest residual, Newton's method on the convex merit goes on, which
  // cannot fail.
  bool iterate(const ContactGroup<T>& group, bool is_new) {
    if (is_new) {
      group.displace(now_);
    } else {
      group.evaluate(now_);  // this group may be solved already
      if (now_.is_found) return true;
    }
    if (max_steps_ == 0) return false;
    T best = (std::numeric_limits<T>::max)();
    for (int step = 0, refused = 0; step < max_steps_; ++step) {
      linearise_nearby(group);
      compute_direction(group);
      move(group, 1);
      ++steps_;
      refused = next_.norm <= best / 2 ? 0 : refused + 1;
      if (refused > patience_ && !next_.is_found && !descend(group)) break;
      std::swap(now_, next_);
      best = (std::min)(best, now_.norm);
      if (now_.is_found || (refused > 1 && group.is_rounding(now_))) return true;
    }
    return group.is_rounding(now_);
  }

  // Linearises each contact where its own contact step ends if the other forces hold: better than where the
  // increments of now_ lie, which overshoot. The residual is scaled so that compute_direction() still applies.
  void linearise_nearby(const ContactGroup<T>& group) {
    for (std::size_t a = 0; a < group.size(); ++a) {
      const CoupledConnection<T>& c = group.connection(a);
      now_.slope[a] = now_.residual[a] = 0;
      if (!c.is_friction && now_.force[a] == 0 && c.compression <= 0 && c.compression + now_.increment[a] <= 0)
        continue;  // stays apart
      const T xi = group.coupling()(a, a);
      const Approach<T> alone{c.compression, now_.increment[a] + xi * now_.force[a], xi};
      const auto step = group.law(a).alone(c, alone, time_step_);
      now_.slope[a] = step.slope;
      next_.segment[a] = step.segment;
      now_.residual[a] = (1 + xi * now_.slope[a]) * (step.force - now_.force[a]);
    }
  }

  // One step of Newton's method on the merit from now_ to next_, which lowers it. False if rounding hides its slope.
  bool descend(const ContactGroup<T>& group) {
    group.evaluate(now_);
    compute_direction(group);
    move(group, 1);
    const T length = search_along_direction(group);
    if (!(length > 0)) return false;
    if (length < 1) move(group, length);
    return true;
  }

  void move(const ContactGroup<T>& group, T length) {
    for (std::size_t a = 0; a < group.size(); ++a) next_.force[a] = now_.force[a] + length * step_[a];
    group.evaluate(next_);
  }

  // Slope of the merit at this part of the distance from now_ to next_, which lie a whole direction apart.
  [[nodiscard]] T merit_slope(const ContactGroup<T>& group, T length) const {
    T sum = 0;
    for (std::size_t a = 0; a < group.size(); ++a) {
      const T change = next_.increment[a] - now_.increment[a];
      std::size_t segment = now_.segment[a];
      const T force = group.law(a).at(now_.increment[a] + length * change, segment).force;
      sum += change * (force - (now_.force[a] + length * step_[a]));
    }
    return sum;
  }

  // A length, 0 to 1, up to which the merit falls and at which it falls at most half as steeply as at 0, or 1. 0 if
  // rounding hides the slope.
  [[nodiscard]] T search_along_direction(const ContactGroup<T>& group) const {
    const T slope_at_0 = merit_slope(group, 0);
    if (!(slope_at_0 < 0)) return 0;
    T low = 0, high = 1, slope_low = slope_at_0, slope_high = merit_slope(group, 1);
    if (slope_high <= 0) return 1;
    for (int i = 0; i < 60 && slope_low < slope_at_0 / 2; ++i) {
      const T secant = low + (high - low) * (slope_low / (slope_low - slope_high));
      const T length = i % 2 == 0 ? (std::max)(secant * T(0.999), low) : low + (high - low) / 2;
      const T slope = merit_slope(group, length);
      (slope <= 0 ? low : high) = length;
      (slope <= 0 ? slope_low : slope_high) = slope;
    }
    return low;
  }

  // Solves (I + D Xi) step = residual, D the slopes, by a Cholesky factor of I + sqrt(D) Xi sqrt(D).
  void compute_direction(const ContactGroup<T>& group) {
    const std::size_t n = group.size();
    rows_.clear();
    bool others_move = false;
    for (std::size_t a = 0; a < n; ++a) {
      step_[a] = now_.residual[a];
      if (now_.slope[a] * group.coupling()(a, a) > kRounding)
        rows_.push_back(a);
      else
        others_move |= now_.residual[a] != 0;
    }
    const std::size_t m = rows_.size(), padded = system_.padded(m);
    for (std::size_t r = 0; r < m; ++r) root_[r] = std::sqrt(now_.slope[rows_[r]]);
    for (std::size_t r = 0; r < m; ++r) {
      const T* from = group.coupling().column(rows_[r]);
      T* to = system_.column(r);
      for (std::size_t q = 0; q < m; ++q) to[q] = root_[r] * root_[q] * from[rows_[q]];
      std::fill(to + m, to + padded, T(0));
      to[r] += 1;
      T residual = now_.residual[rows_[r]] / root_[r];
      if (others_move) residual -= root_[r] * moved_by_others(group, rows_[r]);
      system_.right(r) = residual;
    }
    system_.solve(m);
    for (std::size_t r = 0; r < m; ++r) step_[rows_[r]] = root_[r] * system_.right(r);
  }

  // Displacement of position a by the residuals of the positions that are not in rows_.
  [[nodiscard]] T moved_by_others(const ContactGroup<T>& group, std::size_t a) const {
    T sum = 0;
    for (std::size_t b = 0, r = 0; b < group.size(); ++b) {
      if (r < rows_.size() && rows_[r] == b)
        ++r;
      else
        sum += group.coupling()(a, b) * now_.residual[b];
    }
    return sum;
  }

  // One linear step with a law that is nowhere less stiff than the real one: passive, whatever the increments.
  // Contacts that do not touch at the end join until none is left out that should touch: at most one step for each.
  void apply_bounding_law(const ContactGroup<T>& group) {
    ++bounded_;
    const std::size_t n = group.size();
    for (std::size_t a = 0; a < n; ++a)  // does it act?
      next_.force[a] =
          group.connection(a).is_friction || group.law(a).at(now_.increment[a], now_.segment[a]).force > 0;
    for (bool changed = true; changed;) {
      for (std::size_t a = 0; a < n; ++a) {
        const auto& law = group.law(a);
        const bool acts = next_.force[a] != 0;
        now_.slope[a] = acts ? law.steepest_slope() : T(0);
        now_.residual[a] = acts ? law.force_at_rest() + now_.slope[a] * group.free_increment(a) : T(0);
      }
      compute_direction(group);
      std::copy_n(step_.data(), n, now_.force.data());
      group.displace(now_);
      changed = false;
      for (std::size_t a = 0; a < n; ++a) {
        const CoupledConnection<T>& c = group.connection(a);
        if (next_.force[a] != 0 || c.compression + now_.increment[a] <= (std::max)(c.compression, T(0))) continue;
        next_.force[a] = 1;
        changed = true;
      }
    }
  }

  T time_step_;
  int max_steps_, patience_;
  State now_, next_;
  LinearSystem<T> system_;
  ModalArray<T> root_, step_;
  IndexList rows_;  // positions in the group with a slope
  int steps_ = 0;   // of this sample
  std::size_t bounded_ = 0;
};

}  // namespace contactspline::detail
