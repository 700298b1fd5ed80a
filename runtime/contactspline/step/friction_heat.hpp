// SPDX-License-Identifier: MIT
// Friction that weakens as its surfaces warm, as that of rosin does.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <concepts>

namespace contactspline {

/// How the coefficient of friction follows the temperature T of the surfaces above ambient, and T the heat of slip. A
/// normal force N over a width w has
///
///     mu = hot + (cold - hot)/(1 + (T/softening)^2)
///     capacity N dT/dt + (sqrt(renewal w N |v|) + conduction N) T = power of the slip
///
/// A coefficient that does not depend on the temperature has hot = cold.
struct FrictionHeat {
  double cold_coefficient, hot_coefficient;
  double softening_k = 1;           ///< > 0: where mu is halfway between them [K]
  double capacity_j_per_n_k = 1;    ///< > 0
  double conduction_w_per_n_k = 0;  ///< >= 0: into what lies below the surfaces
  double renewal_w_per_m_k2 = 0;    ///< >= 0: by fresh surface that the slip at speed v brings
};

/// The temperature of surfaces that rub. It does not change within a sample, so the friction step stays unique.
template <std::floating_point T>
class FrictionTemperature {
 public:
  /// The coefficient is 0 for any temperature.
  constexpr FrictionTemperature() = default;
  /// width_m: of the surfaces across the motion, > 0.
  constexpr FrictionTemperature(const FrictionHeat& heat, double width_m, double sample_rate_hz)
      : cold_(static_cast<T>(heat.cold_coefficient)),
        hot_(static_cast<T>(heat.hot_coefficient)),
        softening_(static_cast<T>(heat.softening_k)),
        capacity_(static_cast<T>(heat.capacity_j_per_n_k)),
        conduction_(static_cast<T>(heat.conduction_w_per_n_k / heat.capacity_j_per_n_k / sample_rate_hz)),
        renewal_(
            static_cast<T>(std::sqrt(heat.renewal_w_per_m_k2 * width_m / sample_rate_hz) / heat.capacity_j_per_n_k)) {
  }

  /// mu at this temperature.
  [[nodiscard]] T coefficient() const {
    const T ratio = temperature_ / softening_, q = ratio * ratio;
    return hot_ + (cold_ - hot_) / (1 + q);
  }

  /// Follows a sample: its normal force [N], its increment [m] and the heat of its slip [J]. Exact for constant power
  /// and speed. Surfaces that a rising normal force adds are cold, so the heat stays.
  void advance(T normal_force_n, T increment_m, T heat_j) {
    if (normal_force_n > normal_force_) temperature_ *= normal_force_ / normal_force_n;
    normal_force_ = normal_force_n;
    if (!(normal_force_n > 0)) return;
    const T cooling = conduction_ + renewal_ * std::sqrt(std::abs(increment_m) / normal_force_n);
    const T lost = -std::expm1(-cooling), gained = cooling > 0 ? lost / cooling : T(1);
    temperature_ += gained * heat_j / (capacity_ * normal_force_n) - lost * temperature_;
  }

  void reset() { temperature_ = normal_force_ = 0; }

  [[nodiscard]] T temperature() const { return temperature_; }  ///< above ambient [K]

 private:
  T cold_ = 0, hot_ = 0, softening_ = 1, capacity_ = 1;
  T conduction_ = 0, renewal_ = 0;  // what cools in a sample: of T; and per root of increment over normal force
  T temperature_ = 0, normal_force_ = 0;
};

}  // namespace contactspline
