// SPDX-License-Identifier: MIT
// A mass thrown at a rigid barrier, with or without gravity.
#pragma once

#include "contactspline/contact.hpp"

namespace contactspline {

/// Live controls of the mass-barrier model.
template <std::floating_point T>
struct MassBarrierControls {
  T mass_kg;               ///< > 0
  T gravity_m_per_s2 = 0;  ///< towards the barrier
  ContactControls<T> contact = {};
};

/// A point mass before a barrier at 0; displacement and velocity count into the barrier, so displacement > 0 is
/// compression. Exact energy balance: m v^2/2 - m g q + V(q) is constant without loss (midpoint rule, design 2.2).
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class MassBarrier {
 public:
  MassBarrier(SegmentTable<T, Extent> table, T sample_rate_hz) : table_(table), time_step_(1 / sample_rate_hz) {}

  /// Puts the mass at a displacement [m] (negative: before the barrier) with a velocity [m/s] towards the barrier.
  void throw_from(T displacement_m, T velocity_m_per_s) {
    displacement_ = displacement_m;
    velocity_ = velocity_m_per_s;
    force_ = 0;
  }

  /// Advances one sample. Safe in an audio thread: no allocation, no lock, bounded time.
  void tick(const MassBarrierControls<T>& controls) {
    const T dt = time_step_;
    const T inverse_mass = 1 / controls.mass_kg;
    const T free_increment = dt * (velocity_ + dt * controls.gravity_m_per_s2 / 2);
    const T admittance = dt * dt * inverse_mass / 2;
    force_ = contact_force(table_, controls.contact, dt, Approach<T>{displacement_, free_increment, admittance});
    displacement_ += free_increment - admittance * force_;
    velocity_ += dt * (controls.gravity_m_per_s2 - inverse_mass * force_);
  }

  [[nodiscard]] T displacement() const { return displacement_; }  ///< [m], into the barrier
  [[nodiscard]] T velocity() const { return velocity_; }          ///< [m/s], into the barrier
  [[nodiscard]] T force() const { return force_; }                ///< contact force over the last sample [N]

 private:
  SegmentTable<T, Extent> table_;
  T time_step_;
  T displacement_ = 0;
  T velocity_ = 0;
  T force_ = 0;
};

}  // namespace contactspline
