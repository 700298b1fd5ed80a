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

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_parts.hpp"

namespace contactspline::detail {

/// Lets contacts sleep that cannot touch soon, and wakes them before they may. A sleeping contact has a slack: the
/// gap that is certainly left, by bounds of the motion of its bodies and of what forces may do
/// (docs/how-it-works/several-contacts.md). `largest_root`: NetworkReceptances::largest_root().
template <std::floating_point T>
class SleepingContacts {
 public:
  explicit SleepingContacts(std::size_t connections) {
    for (auto* list : {&awake_, &asleep_, &woken_}) list->reserve(connections);
  }

  /// Connections that are computed in each sample.
  [[nodiscard]] std::span<const std::size_t> awake() const { return awake_; }
  /// Contacts that end_sample() woke.
  [[nodiscard]] std::span<const std::size_t> woken() const { return woken_; }
  /// Does the last sample end an interval, in which contacts fall asleep only once?
  [[nodiscard]] bool is_interval_over() const { return since_interval_ == 0; }
  /// Samples of an interval.
  static constexpr int kInterval = 16;

  /// Wakes all contacts.
  void wake_all(NetworkParts<T>& parts) {
    for (NetworkConnection<T>& c : parts.connections) c.is_awake = true;
    is_list_old_ = true;
  }
  void restart() { since_interval_ = 0; }

  /// Takes the motion of a gap or place from the slack of its contact [m].
  void shrink(NetworkConnection<T>& c, T motion) {
    if (c.is_awake) return;
    c.slack -= kMargin * std::abs(motion);
    min_slack_ = (std::min)(min_slack_, c.slack);
  }

  /// Lists what is awake, if that has changed.
  void list_awake(NetworkParts<T>& parts) {
    if (!is_list_old_) return;
    is_list_old_ = false;
    for (auto* list : {&awake_, &asleep_}) list->clear();
    for (NetworkPlace<T>& place : parts.places) place.is_awake = false;
    for (std::size_t k = 0; k < parts.connections.size(); ++k) {
      const NetworkConnection<T>& c = parts.connections[k];
      (c.is_awake ? awake_ : asleep_).push_back(k);
      for (const std::size_t p : {c.first, c.second})
        if (c.is_awake && p != kGround) parts.places[p].is_awake = true;
    }
    for (NetworkBody<T>& body : parts.bodies) {
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

  /// Wakes the contacts that may have come within reach in a sample, by the bound of what moved since they fell
  /// asleep. wake(k): adds contact k to the sample, which must then be solved again. Returns whether it must.
  template <typename Wake>
  bool wake_reachable(NetworkParts<T>& parts, const CoupledContacts<T>& solver, T largest_root, Wake wake) {
    reach_ = 0;
    for (const std::size_t k : solver.active())
      reach_ += parts.connections[k].root_receptance * std::abs(solver[k].force);
    bool has_woken = false;
    if (!may_touch(parts, largest_root, reached_ + reach_, 0)) return false;
    for (const std::size_t k : asleep_) {
      NetworkConnection<T>& c = parts.connections[k];
      if (c.is_awake || c.slack > motion(parts, c, &NetworkBody<T>::travelled, reached_ + reach_)) continue;
      c.is_awake = is_list_old_ = has_woken = true;
      wake(k);
    }
    return has_woken;
  }

  /// Ends a sample in which all contacts stay awake.
  void stay_awake() { since_interval_ = (since_interval_ + 1) % kInterval; }

  /// Lets contacts fall asleep that cannot touch soon, and wakes those that may. The solver has ended its sample, the
  /// bodies have not moved yet.
  void end_sample(NetworkParts<T>& parts, const CoupledContacts<T>& solver, T largest_root) {
    woken_.clear();
    reached_ += reach_;
    const bool is_time = ++since_interval_ == kInterval;
    if (is_time || may_touch(parts, largest_root, reached_ + kWakingSamples * reach_, kWakingSamples))
      reduce_slacks(parts);
    if (is_time) {
      since_interval_ = 0;
      for (const std::size_t k : awake_) {
        NetworkConnection<T>& c = parts.connections[k];
        const T y = solver[k].compression;
        if (y > 0 || solver[k].force != 0 || solver[k].table.empty()) continue;
        if (-y <= kSleepingSamples * motion(parts, c, &NetworkBody<T>::travel, reach_)) continue;
        c.is_awake = false;
        c.slack = -y;
        min_slack_ = (std::min)(min_slack_, c.slack);
        is_list_old_ = true;
      }
    }
    list_awake(parts);
  }

 private:
  // A contact falls asleep if this many samples like the last one would not close it, and wakes before this many
  // might.
  static constexpr T kSleepingSamples = 16, kWakingSamples = 2;
  // Covers the rounding of the bounds.
  static constexpr T kMargin = T(1.001);

  // Bound of the motion of a connection by the travel of its bodies and the reach of forces [m].
  [[nodiscard]] static T motion(const NetworkParts<T>& parts, const NetworkConnection<T>& c,
                                T NetworkBody<T>::*travel, T reach) {
    return kMargin * (c.first_max * parts.bodies[c.first_body].*travel +
                      c.second_max * parts.bodies[c.second_body].*travel + c.root_receptance * reach);
  }

  // Might a sleeping contact have used up its slack, with this reach since slacks were last reduced and so many more
  // samples like this one? A bound for all of them together.
  [[nodiscard]] bool may_touch(const NetworkParts<T>& parts, T largest_root, T reach, T more_samples) const {
    if (asleep_.empty()) return false;
    T motion = largest_root * reach;
    for (const NetworkBody<T>& body : parts.bodies)
      motion += body.max_shape * (body.travelled + more_samples * body.travel);
    return kMargin * motion >= min_slack_;
  }

  // Takes from the slacks what moved since this was last done. Wakes contacts that may soon touch.
  void reduce_slacks(NetworkParts<T>& parts) {
    min_slack_ = (std::numeric_limits<T>::max)();
    for (const std::size_t k : asleep_) {
      NetworkConnection<T>& c = parts.connections[k];
      if (c.is_awake) continue;
      c.slack -= motion(parts, c, &NetworkBody<T>::travelled, reached_);
      if (c.slack > kWakingSamples * motion(parts, c, &NetworkBody<T>::travel, reach_)) {
        min_slack_ = (std::min)(min_slack_, c.slack);
      } else {
        c.is_awake = is_list_old_ = true;
        woken_.push_back(k);
      }
    }
    for (NetworkBody<T>& body : parts.bodies) body.travelled = 0;
    reached_ = 0;
  }

  IndexList awake_, asleep_;  // connections
  IndexList woken_;
  // Sum of force times root of receptance: over the last sample, and since slacks were last reduced.
  T reach_ = 0, reached_ = 0;
  T min_slack_ = (std::numeric_limits<T>::max)();  // of the sleeping contacts
  int since_interval_ = 0;
  bool is_list_old_ = true;
};

}  // namespace contactspline::detail
