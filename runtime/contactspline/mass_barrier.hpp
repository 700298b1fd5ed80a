// SPDX-License-Identifier: MIT
// A mass thrown at a rigid barrier, with or without gravity.
#pragma once

#include <cmath>
#include <utility>

#include "contactspline/contact.hpp"

namespace contactspline {

/// Live controls of the mass-barrier model.
template <std::floating_point T>
struct MassBarrierControls {
  T mass_kg;               ///< > 0
  T gravity_m_per_s2 = 0;  ///< towards the barrier
  ContactControls<T> contact = {};
};

/// A point mass and a rigid barrier at 0. Displacement and velocity are positive into the barrier, so a displacement
/// > 0 is a compression. The energy balance is exact: without loss, m v^2/2 - m g q + V(q) is constant (midpoint
/// rule, docs/contact-step.md).
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class MassBarrier {
 public:
  MassBarrier(SegmentTable<T, Extent> table, T sample_rate_hz) : table_(table), time_step_(1 / sample_rate_hz) {}

  /// Sets the displacement [m] (negative: in front of the barrier) and the velocity [m/s] towards the barrier.
  void throw_from(T displacement_m, T velocity_m_per_s) {
    displacement_ = displacement_m;
    segment_ = segment_index(table_, displacement_m);
    velocity_step_ = velocity_m_per_s * time_step_;
    pending_step_ = 0;
    force_ = 0;
  }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick(const MassBarrierControls<T>& controls) {
    const T dt = time_step_;
    const T admittance = dt * dt / (2 * controls.mass_kg);
    const T gravity_step = dt * dt * controls.gravity_m_per_s2;
    const Approach<T> approach{displacement_, velocity_step_ + pending_step_ + gravity_step / 2, admittance};
    const auto step = contact_step(table_, controls.contact, dt, approach, segment_);
    segment_ = step.segment;
    displacement_ = step.compression;
    force_ = step.force;
    pending_step_ += gravity_step - 2 * (admittance * force_);
    if (std::abs(pending_step_) * 256 > std::abs(velocity_step_))
      velocity_step_ += std::exchange(pending_step_, T(0));
  }

  [[nodiscard]] T displacement() const { return displacement_; }  ///< [m], into the barrier
  /// [m/s], into the barrier
  [[nodiscard]] T velocity() const { return (velocity_step_ + pending_step_) / time_step_; }
  [[nodiscard]] T force() const { return force_; }  ///< contact force over the last sample [N]

 private:
  SegmentTable<T, Extent> table_;
  T time_step_;
  T displacement_ = 0;
  std::size_t segment_ = 0;  // contains the displacement
  // Velocity times time_step_ [m]. It is added to the displacement without a factor, whose rounding would accumulate
  // over many bounces. It has two parts: gravity adds the same small number in every sample, so each sum would be
  // rounded in the same direction. pending_step_ collects these numbers until their sum is large enough.
  T velocity_step_ = 0;
  T pending_step_ = 0;
  T force_ = 0;
};

}  // namespace contactspline
