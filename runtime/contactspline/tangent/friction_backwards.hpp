// SPDX-License-Identifier: MIT
// Samples of friction backwards (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <utility>

#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/friction_tangent.hpp"
#include "contactspline/tangent/network_record.hpp"

namespace contactspline::detail {

/// The adjoints of friction, one sample after another from the last one back: by the derivatives of FrictionSample
/// with respect to all that goes in.
template <std::floating_point T>
class FrictionBackwards {
 public:
  /// A sample, after the adjoints of what it kept are known: first its increment, which other forces move, too.
  void linearise(const typename NetworkPlan<T>::Connection& plan, double sample_rate_hz,
                 const typename NetworkRecord<T>::Rubbing& rubbing) {
    time_step_ = static_cast<T>(1 / sample_rate_hz);
    follows_ = rubbing.follows, is_pressed_ = rubbing.is_pressed;
    const std::array<T, kMaterial> material = FrictionNumbers<T>::of(*plan.friction, plan.friction_width_m).values();
    std::array<Number, kMaterial> numbers;
    for (std::size_t i = 0; i < kMaterial; ++i) numbers[i] = input(i, material[i]);
    const FrictionState<Number> before{input(kStrain, rubbing.before.strain),
                                       input(kTemperature, rubbing.before.temperature),
                                       input(kNormalBefore, rubbing.before.normal_force)};
    const FrictionSample<T, kInputs> sample(numbers, sample_rate_hz, before, input(kNormal, rubbing.normal_force));
    const auto kept = sample.advance(input(kIncrement, rubbing.increment));
    for (std::size_t i = 0; i < kInputs; ++i)
      adjoints_[i] = kept_.strain * kept.strain.slopes[i] + kept_.temperature * kept.temperature.slopes[i] +
                     kept_.normal_force * kept.normal_force.slopes[i];
    response_ = sample.respond(rubbing.increment);
  }
  [[nodiscard]] T of_increment() const { return adjoints_[kIncrement]; }  ///< its adjoint by what is kept
  [[nodiscard]] T response() const { return response_.stiffness; }        ///< slope of the force [N/m]

  /// The same sample, with the adjoint of its force. Returns that of a force that presses the surfaces.
  T push(T force) {
    for (std::size_t i = 0; i < kInputs; ++i) adjoints_[i] += force * response_.force.slopes[i];
    for (std::size_t i = 0; i < kMaterial; ++i) numbers_[i] += adjoints_[i];
    kept_ = {adjoints_[kStrain], adjoints_[kTemperature], adjoints_[kNormalBefore]};
    speed_ += time_step_ * (adjoints_[kIncrement] + response_.stiffness * force);
    const T normal = follows_ ? adjoints_[kNormal] : T(0);
    normal_ += normal;
    return is_pressed_ ? normal : T(0);
  }

  /// The adjoint of the normal force or of the surface speed over the samples since it was taken last.
  [[nodiscard]] T take(bool of_speed) { return std::exchange(of_speed ? speed_ : normal_, T(0)); }
  [[nodiscard]] FrictionNumbers<T> numbers() const { return FrictionNumbers<T>::of(numbers_); }

 private:
  static constexpr std::size_t kMaterial = FrictionNumbers<T>::kCount;
  enum Input : std::size_t { kStrain = kMaterial, kTemperature, kNormalBefore, kNormal, kIncrement, kInputs };
  using Number = Dual<T, kInputs>;

  [[nodiscard]] static Number input(std::size_t i, T value) {
    Number number(value);
    number.slopes[i] = 1;
    return number;
  }

  T time_step_ = 0;
  bool follows_ = true, is_pressed_ = false;
  std::array<T, kInputs> adjoints_{};
  typename FrictionSample<T, kInputs>::Response response_;
  FrictionState<T> kept_;  // adjoints
  std::array<T, kMaterial> numbers_{};
  T speed_ = 0, normal_ = 0;
};

}  // namespace contactspline::detail
