// SPDX-License-Identifier: MIT
// Exact derivatives of a sample of friction with its heat, with respect to whatever goes in
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numeric>

#include "contactspline/data/friction_materials.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/tangent/dual.hpp"

namespace contactspline {

/// One value for each number of a material that rubs, as in FrictionMaterial, and for the width of the surfaces.
template <std::floating_point T>
struct FrictionNumbers {
  T stiffness_per_m = 0, damping_s_per_m = 0;
  T cold_coefficient = 0, hot_coefficient = 0, softening_k = 0;
  T capacity_j_per_n_k = 0, conduction_w_per_n_k = 0, renewal_w_per_m_k2 = 0, width_m = 0;

  static constexpr std::size_t kCount = 9;
  /// All of them, in this order.
  [[nodiscard]] std::array<T, kCount> values() const {
    return {stiffness_per_m,    damping_s_per_m,      cold_coefficient,   hot_coefficient, softening_k,
            capacity_j_per_n_k, conduction_w_per_n_k, renewal_w_per_m_k2, width_m};
  }
  [[nodiscard]] static FrictionNumbers of(const std::array<T, kCount>& v) {
    return {v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]};
  }
  [[nodiscard]] static FrictionNumbers of(const FrictionMaterial& material, double width_m) {
    const auto& [bristles, heat] = material;
    return of({static_cast<T>(bristles.stiffness_per_m), static_cast<T>(bristles.damping_s_per_m),
               static_cast<T>(heat.cold_coefficient), static_cast<T>(heat.hot_coefficient),
               static_cast<T>(heat.softening_k), static_cast<T>(heat.capacity_j_per_n_k),
               static_cast<T>(heat.conduction_w_per_n_k), static_cast<T>(heat.renewal_w_per_m_k2),
               static_cast<T>(width_m)});
  }
};

/// The derivative in a direction of the sum whose gradient is given: the sum of all products.
template <std::floating_point T>
[[nodiscard]] T derivative(const FrictionNumbers<T>& gradient, const FrictionNumbers<T>& direction) {
  const auto a = gradient.values(), b = direction.values();
  return std::inner_product(a.begin(), a.end(), b.begin(), T(0));
}

namespace detail {

/// f(a), whose derivative there is known.
template <std::floating_point T, std::size_t P>
[[nodiscard]] constexpr Dual<T, P> chained(T value, T derivative, const Dual<T, P>& a) {
  Dual<T, P> result(value);
  for (std::size_t p = 0; p < P; ++p) result.slopes[p] = derivative * a.slopes[p];
  return result;
}

/// What friction keeps between two samples.
template <typename Number>
struct FrictionState {
  Number strain = {}, temperature = {}, normal_force = {};
};

/// A sample of Friction and of FrictionTemperature in dual numbers, in the order in which the network computes it.
template <std::floating_point T, std::size_t P>
class FrictionSample {
 public:
  using Number = Dual<T, P>;
  using Numbers = std::array<Number, FrictionNumbers<T>::kCount>;  // in the order of FrictionNumbers::values()

  /// Friction::press with the coefficient of the temperature. normal_force: held to its range.
  FrictionSample(const Numbers& material, double sample_rate_hz, const FrictionState<Number>& before,
                 const Number& normal_force)
      : material_(material), rate_(static_cast<T>(sample_rate_hz)), before_(before), normal_(normal_force) {
    const auto& [stiffness, damping, cold, hot, softening, capacity, conduction, renewal, width] = material_;
    const Number ratio = before.temperature / softening;
    const Number coefficient = hot + (cold - hot) / (Number(1) + ratio * ratio);
    yield_ = coefficient / stiffness;
    strain_ = before.normal_force < normal_ ? before.strain * before.normal_force / normal_ : before.strain;
    if (yield_ < strain_) strain_ = yield_;
    if (strain_ < Number() - yield_) strain_ = Number() - yield_;
    stiffness_ = normal_ * stiffness;
    resistance_ = normal_ * damping * Number(rate_);
  }

  /// The force [N] at a constant increment, and its slope with respect to the increment [N/m].
  struct Response {
    Number force;
    T stiffness = 0;
  };
  [[nodiscard]] Response respond(T x) const {
    if (!(normal_.value > 0)) return {};
    if (holds(x)) {
      const Number slope = stiffness_ / Number(2) + resistance_;
      return {stiffness_ * strain_ + slope * Number(x), slope.value};
    }
    const T sign = sign_at(x);
    const Number distance = distance_to(sign), limit = stiffness_ * yield_ + resistance_ * distance;
    const T held = distance.value < std::abs(x) ? distance.value / std::abs(x) : T(distance.value > 0);
    const Number force = limit - stiffness_ / Number(2) * distance * distance / Number(std::abs(x));
    return {Number(sign) * force, stiffness_.value / 2 * held * held};
  }

  /// What is kept after the increment.
  [[nodiscard]] FrictionState<Number> advance(const Number& x) const {
    if (!(normal_.value > 0)) return {Number(), before_.temperature, normal_};
    const T sign = sign_at(x.value);
    const bool has_slipped = !holds(x.value);
    const Number strain = has_slipped ? Number(sign) * yield_ : strain_ + x;
    const Number slip = has_slipped ? Number(sign) * x - distance_to(sign) : Number();
    const Number heat = stiffness_ * yield_ * slip + resistance_ * (strain - strain_) * x;
    return {strain, warmed(x, heat), normal_};
  }

 private:
  [[nodiscard]] bool holds(T x) const { return std::abs(strain_.value + x) <= yield_.value; }
  [[nodiscard]] T sign_at(T x) const { return strain_.value + x < 0 ? T(-1) : T(1); }
  [[nodiscard]] Number distance_to(T sign) const {
    const Number distance = yield_ - Number(sign) * strain_;
    return distance.value > 0 ? distance : Number();
  }

  // FrictionTemperature::advance. Where nothing moves, the renewal has no derivative and counts as constant.
  [[nodiscard]] Number warmed(const Number& x, const Number& heat) const {
    const auto& [stiffness, damping, cold, hot, softening, capacity, conduction, renewal, width] = material_;
    const Number temperature =
        before_.normal_force < normal_ ? before_.temperature * before_.normal_force / normal_ : before_.temperature;
    const Number way = x.value < 0 ? Number() - x : x;
    const Number flow = root(renewal * width * way / (Number(rate_) * normal_)) / capacity;
    const Number cooling = conduction / (capacity * Number(rate_)) + flow;
    const T decayed = std::exp(-cooling.value);
    const Number lost = chained(-std::expm1(-cooling.value), decayed, cooling);
    const Number gained = cooling.value > 0 ? lost / cooling : Number(1);
    return temperature + gained * heat / (capacity * normal_) - lost * temperature;
  }
  [[nodiscard]] static Number root(const Number& a) {
    const T value = std::sqrt(a.value);
    return chained(value, value > 0 ? 1 / (2 * value) : T(0), a);
  }

  Numbers material_;
  T rate_;
  FrictionState<Number> before_;
  Number normal_, yield_, strain_, stiffness_, resistance_;
};

/// Numbers of a material with the slopes of a direction each.
template <std::floating_point T, std::size_t P>
[[nodiscard]] typename FrictionSample<T, P>::Numbers with_slopes(
    const FrictionNumbers<T>& material, const std::array<FrictionNumbers<T>, P>& directions) {
  typename FrictionSample<T, P>::Numbers numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i].value = material.values()[i];
    for (std::size_t p = 0; p < P; ++p) numbers[i].slopes[p] = directions[p].values()[i];
  }
  return numbers;
}

}  // namespace detail

}  // namespace contactspline
