// SPDX-License-Identifier: MIT
// A stroke of a bow: it comes down, speeds up, turns where the next stroke begins, and is lifted.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>

#include "contactspline/data/pluck.hpp"

namespace contactspline {

/// Force over speed of a bow at which a string slips once a period [N s/m]: between Schelleng's limits. max 0: not
/// known.
struct BowLimits {
  double min_n_s_per_m = 0, max_n_s_per_m = 0;
};

/// The bow of a string over time. Strokes alternate their direction; one that begins while the bow is down goes on in
/// its direction.
class Stroke {
 public:
  /// What the bow does in a sample.
  struct Motion {
    double force_n, speed_m_per_s;
  };

  void prepare(double sample_rate_hz) {
    sample_s_ = 1 / sample_rate_hz;
    stop();
  }
  /// Begins with the next sample. acceleration: above 0.
  void begin(double acceleration_m_per_s2) {
    if (!is_down_) direction_ = -direction_;
    is_down_ = true;
    acceleration_m_per_s2_ = acceleration_m_per_s2;
  }
  /// Lifts the bow within kFall_s.
  void lift() { is_down_ = false; }
  /// The bow is up and still; the next stroke has the direction of the first.
  void stop() {
    is_down_ = false;
    direction_ = -1;
    pressed_ = speed_m_per_s_ = 0;
  }
  /// Does it touch the string?
  [[nodiscard]] bool is_active() const { return is_down_ || pressed_ > 0; }

  /// The next sample of a bow that is active, on its way to a force and a speed, by the speed that it has in its
  /// first direction. assistance: 0 to 1, how much of the way to the limits the force is moved, in decibels.
  Motion next(double force_n, double speed_m_per_s, const BowLimits& limits, double assistance) {
    pressed_ = std::clamp(pressed_ + (is_down_ ? sample_s_ : -sample_s_) / kFall_s, 0.0, 1.0);
    const double change = direction_ * speed_m_per_s - speed_m_per_s_, most = acceleration_m_per_s2_ * sample_s_;
    speed_m_per_s_ += std::clamp(change, -most, most);
    if (pressed_ == 0) speed_m_per_s_ = 0;
    return {eased(pressed_) * assisted(force_n, limits, assistance), speed_m_per_s_};
  }

 private:
  static constexpr double kFall_s = 0.02;

  [[nodiscard]] double assisted(double force_n, const BowLimits& limits, double assistance) const {
    if (limits.max_n_s_per_m == 0 || assistance == 0) return force_n;
    const double speed = std::abs(speed_m_per_s_);
    const double right = std::clamp(force_n, limits.min_n_s_per_m * speed, limits.max_n_s_per_m * speed);
    return std::pow(force_n, 1 - assistance) * std::pow(right, assistance);
  }

  double sample_s_ = 0;
  double direction_ = -1, acceleration_m_per_s2_ = 0;
  double pressed_ = 0, speed_m_per_s_ = 0;
  bool is_down_ = false;
};

}  // namespace contactspline
