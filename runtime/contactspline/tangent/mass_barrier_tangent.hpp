// SPDX-License-Identifier: MIT
// A mass thrown at a rigid barrier, with its derivatives with respect to several parameters.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <cstddef>
#include <span>

#include "contactspline/models/mass_barrier.hpp"
#include "contactspline/tangent/contact_tangent.hpp"

namespace contactspline {

/// One value for each number of a throw, as in ContactNumbers.
template <std::floating_point T>
struct ThrowNumbers {
  ContactNumbers<T> contact = {};
  T mass_kg = 0, gravity_m_per_s2 = 0;
  T displacement_m = 0, velocity_m_per_s = 0;  ///< of the throw
};

/// A MassBarrier with its derivatives with respect to P parameters. Their cost is that of P lines of the contact.
template <std::floating_point T, std::size_t P>
class MassBarrierTangent {
 public:
  using Number = Dual<T, P>;

  /// As MassBarrier, with one direction for each parameter. Controls stay from the throw on.
  MassBarrierTangent(SegmentTable<T> table, T sample_rate_hz, const MassBarrierControls<T>& controls,
                     const std::array<ThrowNumbers<T>, P>& directions, std::span<const Memory> memories = {})
      : model_(table, sample_rate_hz, memories),
        contact_(table, memories, double(sample_rate_hz), detail::contacts_of(directions, &ThrowNumbers<T>::contact)),
        controls_(controls),
        directions_(directions),
        time_step_(1 / sample_rate_hz) {
    const T dt = time_step_;
    const Number mass = detail::with_slopes(controls.mass_kg, directions_, &ThrowNumbers<T>::mass_kg);
    receptance_ = Number(dt * dt / 2) / mass;
    gravity_step_ = Number(dt * dt) *
                    detail::with_slopes(controls.gravity_m_per_s2, directions_, &ThrowNumbers<T>::gravity_m_per_s2);
  }

  /// MassBarrier::throw_from.
  void throw_from(T displacement_m, T velocity_m_per_s) {
    model_.throw_from(displacement_m, velocity_m_per_s);
    contact_.reset();
    displacement_ = detail::with_slopes(model_.displacement(), directions_, &ThrowNumbers<T>::displacement_m);
    velocity_step_ =
        Number(time_step_) * detail::with_slopes(model_.velocity(), directions_, &ThrowNumbers<T>::velocity_m_per_s);
    force_ = T(0);
  }

  /// MassBarrier::tick.
  void tick() {
    model_.tick(controls_);
    const Number free_increment = velocity_step_ + Number(T(0.5)) * gravity_step_;
    const auto step = contact_.advance(controls_.contact, displacement_, free_increment, receptance_, model_.force(),
                                       model_.displacement());
    displacement_ = step.compression;
    force_ = step.force;
    velocity_step_ = velocity_step_ + gravity_step_ - Number(2) * receptance_ * force_;
  }

  [[nodiscard]] const Number& displacement() const { return displacement_; }             ///< [m]
  [[nodiscard]] Number velocity() const { return velocity_step_ / Number(time_step_); }  ///< [m/s]
  [[nodiscard]] const Number& force() const { return force_; }                           ///< [N]
  [[nodiscard]] const MassBarrier<T>& model() const { return model_; }

 private:
  MassBarrier<T> model_;
  ContactTangent<T, P> contact_;
  MassBarrierControls<T> controls_;
  std::array<ThrowNumbers<T>, P> directions_;
  T time_step_;
  Number receptance_, gravity_step_, displacement_, velocity_step_, force_;
};

}  // namespace contactspline
