// SPDX-License-Identifier: MIT
// Gaps and stiffnesses of a network on their way to what their controls ask for.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/network_parts.hpp"
#include "contactspline/network/sleeping_contacts.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline::detail {

/// Moves gaps at 1 m/s at most, those over rough surfaces too, and raises stiffnesses by at most 1 W of work
/// (followed_stiffness).
template <std::floating_point T>
class FollowingControls {
 public:
  /// samples_of_step: on which a force acts.
  FollowingControls(double sample_rate_hz, int samples_of_step)
      : time_step_(T(1 / sample_rate_hz)), step_(T(samples_of_step / sample_rate_hz)) {}

  /// The controls of a connection have changed.
  void follow(NetworkConnection<T>& connection) { connection.is_following = is_following_ = is_behind_ = true; }
  /// A place has a new target, or has moved in this sample: the next sample begins with new lifts.
  void note_moving_place() { is_following_ = is_behind_ = true; }
  /// Is anything still behind its control, or does a place move? Not a surface that slides on and on.
  [[nodiscard]] bool is_following() const { return is_behind_; }
  /// Work of the stiffness controls in the last sample [J].
  [[nodiscard]] double work() const { return work_; }

  /// Begins a sample: sets the lifts of all connections to the motion of their gaps, and the stiffnesses of the
  /// solver. resting: the connections that act in the samples between, where forces act over two (TwoSteps), or none.
  void advance(NetworkParts<T>& parts, CoupledContacts<T>& solver, std::span<CoupledConnection<T>> resting,
               SleepingContacts<T>& sleeping) {
    work_ = 0;
    is_behind_ = false;
    if (!std::exchange(is_following_, false)) return;
    for (std::size_t k = 0; k < parts.connections.size(); ++k) {
      NetworkConnection<T>& c = parts.connections[k];
      const T last_lift = std::exchange(c.lift, T(0));
      if (!resting.empty()) c.lift_before = last_lift;
      const bool slides = c.surface.is_rough() && c.slide != 0;
      bool is_behind = false;
      if (c.is_following) {
        const double part = resting.empty() ? 1 : 0.5;  // of the energy that a connection holds
        if (slides) c.surface.go(c.slide);
        is_behind = move_gap(c);
        is_behind |= follow_stiffness(c, solver[k], part);
        if (!resting.empty()) is_behind |= follow_stiffness(c, resting[k], part);
        c.is_following = is_behind || slides;
        sleeping.shrink(parts, c, c.lift);
      }
      // A gap that moved must be seen at rest in the samples that follow.
      const bool moves = c.lift != 0 || c.lift_before != 0;
      is_following_ = is_following_ || c.is_following || moves;
      is_behind_ = is_behind_ || is_behind || (moves && !slides);
    }
  }

 private:
  static constexpr T kGapSpeed_m_per_s = 1;

  // Is the gap still moving? A rough surface lifts it.
  bool move_gap(NetworkConnection<T>& c) {
    const T target = c.surface.is_rough() ? c.target_gap - c.surface.height() : c.target_gap;
    const T before = c.gap, max_step = kGapSpeed_m_per_s * time_step_, distance = target - c.gap;
    c.gap = std::abs(distance) < max_step ? target : c.gap + std::copysign(max_step, distance);
    c.lift = before - c.gap;
    return c.gap != target;
  }

  // Is the stiffness still behind its control?
  bool follow_stiffness(const NetworkConnection<T>& c, CoupledConnection<T>& acting, double part) {
    T& stiffness = acting.table.empty() ? acting.spring_n_per_m : acting.contact.stiffness_ratio;
    const T target = acting.table.empty() ? c.spring : c.contact.stiffness_ratio * c.weight;
    acting.contact.loss_s_per_m = c.contact.loss_s_per_m;
    acting.resistance = c.resistance / step_;
    if (stiffness == target) return false;
    const double before = acting.energy_at(acting.compression);
    const T energy_per_stiffness = acting.table.empty() ? acting.compression * acting.compression / 2
                                                        : acting.memory.energy(acting.table, acting.compression);
    stiffness = followed_stiffness(stiffness, target, energy_per_stiffness, time_step_);
    work_ += part * (acting.energy_at(acting.compression) - before);
    return stiffness != target;
  }

  T time_step_, step_;  // of a sample, and of those on which a force acts
  double work_ = 0;
  bool is_following_ = false, is_behind_ = false;  // must the next sample look; is something not where it is to be
};

}  // namespace contactspline::detail
