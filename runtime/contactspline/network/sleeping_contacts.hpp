// SPDX-License-Identifier: MIT
// Which contacts of a network are too far apart to be looked at in a sample.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_parts.hpp"

namespace contactspline::detail {

/// Lets contacts sleep that cannot touch soon, and wakes them in the sample in which they may. The gap of a sleeping
/// contact is divided between the bodies that move it. A body that may have used up its part of a gap has that gap
/// measured again (docs/how-it-works/several-contacts.md). Where springs may sleep, they do while they have no
/// stiffness and no resistance.
template <std::floating_point T>
class SleepingContacts {
 public:
  explicit SleepingContacts(std::size_t connections) {
    awake_.reserve(connections);
    bodies_.reserve(2 * connections);
  }

  /// Connections that are computed in each sample.
  [[nodiscard]] std::span<const std::size_t> awake() const { return awake_; }
  /// Does the last sample end an interval, in which contacts fall asleep only once?
  [[nodiscard]] bool is_interval_over() const { return since_interval_ == 0; }
  /// Samples of an interval.
  static constexpr int kInterval = 16;

  /// Wakes all connections.
  void wake_all(NetworkParts<T>& parts) {
    for (NetworkConnection<T>& c : parts.connections) wake(c);
  }
  /// Wakes one between two samples.
  void wake(NetworkConnection<T>& c) { c.is_awake = is_list_old_ = true; }
  void restart() { since_interval_ = 0; }
  /// Springs without stiffness and resistance may sleep from now on.
  void let_springs_sleep() { springs_sleep_ = true; }

  /// Takes the motion of a gap or place from the slacks of its contact [m].
  void shrink(NetworkParts<T>& parts, NetworkConnection<T>& c, T motion) {
    if (c.is_awake) return;
    for (auto [moves, body, max, slack] : {first(c), second(c)}) {
      if (!moves) continue;
      *slack -= kMargin * std::abs(double(motion));
      lower_mark(parts.bodies[body], *slack, max);
    }
  }

  /// Lists what is awake, if that has changed.
  void list_awake(NetworkParts<T>& parts) {
    if (!is_list_old_) return;
    is_list_old_ = false;
    awake_.clear();
    for (NetworkPlace<T>& place : parts.places) place.is_awake = false;
    for (std::size_t k = 0; k < parts.connections.size(); ++k) {
      const NetworkConnection<T>& c = parts.connections[k];
      if (c.is_awake) awake_.push_back(k);
      for (const std::size_t p : {c.first, c.second})
        if (c.is_awake && p != kGround) parts.places[p].is_awake = true;
    }
    bodies_.clear();
    for (std::size_t b = 0; b < parts.bodies.size(); ++b) {
      NetworkBody<T>& body = parts.bodies[b];
      const bool has_sleeping =
          std::ranges::any_of(body.connections, [&](std::size_t k) { return !parts.connections[k].is_awake; });
      if (has_sleeping)
        bodies_.push_back(b);
      else
        body.travelled = 0, body.mark = kNever;
      body.is_predicted = false;
      body.awake.clear();
      body.awake_shapes.clear();
      for (const std::size_t p : body.places) {
        if (!parts.places[p].is_awake) continue;
        body.awake.push_back(p);
        body.awake_shapes.push_back(parts.places[p].shapes.data());
      }
    }
  }

  /// Wakes the contacts that may close in a sample that was solved without them. wake(k): adds contact k to the
  /// sample, which must then be solved again. Returns whether it must.
  template <typename Wake>
  bool wake_reachable(NetworkParts<T>& parts, const CoupledContacts<T>& solver, Wake wake) {
    if (bodies_.empty() && since_interval_ + 1 < kInterval) return false;
    for (const std::size_t k : solver.active()) {
      const T force = std::abs(solver[k].force);
      if (force == 0) continue;
      for (const std::size_t p : {parts.connections[k].first, parts.connections[k].second})
        if (p != kGround) parts.body_of(p).reach += parts.places[p].travel_per_force * force;
    }
    bool has_woken = false;
    for (const std::size_t b : bodies_) {
      const NetworkBody<T>& body = parts.bodies[b];
      if (kMargin * (body.travelled + double(body.reach)) >= body.mark) has_woken |= measure_gaps(parts, b, wake);
    }
    if (has_woken)
      for (NetworkBody<T>& body : parts.bodies) body.reach = body.travel;
    return has_woken;
  }

  /// Ends a sample in which all contacts stay awake.
  void stay_awake() { since_interval_ = (since_interval_ + 1) % kInterval; }

  /// Lets connections fall asleep. The solver has ended its sample, the bodies have not moved yet.
  void end_sample(NetworkParts<T>& parts, const CoupledContacts<T>& solver) {
    for (const std::size_t b : bodies_) parts.bodies[b].travelled += double(parts.bodies[b].reach);
    stay_awake();
    if (is_interval_over())
      for (const std::size_t k : awake_) fall_asleep(parts, parts.connections[k], solver[k]);
    list_awake(parts);
  }

 private:
  // A contact falls asleep if so many samples like the last one would not close it, and sleeps on if two would not.
  static constexpr double kSleepingSamples = 4, kSamplesToSleepOn = 2;
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  // Covers the rounding of the bounds.
  static constexpr double kMargin = 1.001;

  // What one body has to do with a connection: by how much it moves it at most for its travel, and the slack.
  struct Side {
    bool moves;  // is there such a body, and is it not that of the first side?
    std::size_t body;
    T max;
    double* slack;
  };
  static Side first(NetworkConnection<T>& c) {
    return {c.first != kGround, c.first_body, c.first_max, &c.first_slack};
  }
  static Side second(NetworkConnection<T>& c) {
    const bool moves = c.second != kGround && (c.first == kGround || c.second_body != c.first_body);
    return {moves, c.second_body, c.second_max, &c.second_slack};
  }

  static void lower_mark(NetworkBody<T>& body, double slack, T max) {
    body.mark = (std::min)(body.mark, slack / double(max));
  }

  // Bound of the motion of a connection in this sample [m].
  [[nodiscard]] static double motion(const NetworkParts<T>& parts, const NetworkConnection<T>& c) {
    return kMargin *
           double(c.first_max * parts.bodies[c.first_body].reach + c.second_max * parts.bodies[c.second_body].reach);
  }

  // Divides a gap between the bodies that move it [m]. Slacks count from where travels were last 0.
  static void divide(NetworkParts<T>& parts, NetworkConnection<T>& c, double gap) {
    const double part = first(c).moves && second(c).moves ? gap / 2 : gap;
    for (auto [moves, b, max, slack] : {first(c), second(c)}) {
      if (!moves) continue;
      NetworkBody<T>& body = parts.bodies[b];
      *slack = part + kMargin * body.travelled * double(max);
      lower_mark(body, *slack, max);
    }
  }

  // Measures the gaps of which a body may have used up its part, and wakes the contacts that may close.
  template <typename Wake>
  bool measure_gaps(NetworkParts<T>& parts, std::size_t b, Wake wake) {
    NetworkBody<T>& body = parts.bodies[b];
    const double travelled = kMargin * std::exchange(body.travelled, 0.0);
    body.mark = kNever;
    bool has_woken = false;
    for (const std::size_t k : body.connections) {
      NetworkConnection<T>& c = parts.connections[k];
      if (c.is_awake) continue;
      const Side side = first(c).moves && c.first_body == b ? first(c) : second(c);
      *side.slack -= travelled * double(side.max);
      if (*side.slack > kMargin * double(side.max * body.reach)) {
        lower_mark(body, *side.slack, side.max);
      } else if (const double gap = -double(parts.measured(k)); gap > kSamplesToSleepOn * motion(parts, c)) {
        divide(parts, c, gap);
      } else {
        c.is_awake = is_list_old_ = has_woken = true;
        wake(k);
      }
    }
    return has_woken;
  }

  void fall_asleep(NetworkParts<T>& parts, NetworkConnection<T>& c, const CoupledConnection<T>& acting) {
    if (acting.force != 0 || acting.is_friction) return;
    const bool is_spring = acting.table.empty();
    if (is_spring && (!springs_sleep_ || c.is_following || acting.spring_n_per_m != 0 || acting.resistance != 0))
      return;
    const double gap = is_spring ? kNever : -double(acting.compression);
    if (!(gap > kSleepingSamples * motion(parts, c)) || gap <= 0) return;
    c.is_awake = false;
    is_list_old_ = true;
    divide(parts, c, gap);
  }

  IndexList awake_, bodies_;  // connections; bodies with others, that sleep
  int since_interval_ = 0;
  bool is_list_old_ = true, springs_sleep_ = false;
};

}  // namespace contactspline::detail
