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

/// A point mass before a barrier at 0; displacement and velocity count into the barrier, so displacement > 0 is
/// compression. Exact energy balance: m v^2/2 - m g q + V(q) is constant without loss (midpoint rule,
/// docs/contact-step.md).
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class MassBarrier {
 public:
  MassBarrier(SegmentTable<T, Extent> table, T sample_rate_hz) : table_(table), time_step_(1 / sample_rate_hz) {}

  /// Puts the mass at a displacement [m] (negative: before the barrier) with a velocity [m/s] towards the barrier.
  void throw_from(T displacement_m, T velocity_m_per_s) {
    displacement_ = displacement_m;
    segment_ = segment_index(table_, displacement_m);
    advance_ = velocity_m_per_s * time_step_;
    gained_ = 0;
    force_ = 0;
  }

  /// Advances one sample. Safe in an audio thread: no allocation, no lock, bounded time.
  void tick(const MassBarrierControls<T>& controls) {
    const T dt = time_step_;
    const T admittance = dt * dt / (2 * controls.mass_kg);
    const T fall = dt * dt * controls.gravity_m_per_s2;
    const Approach<T> approach{displacement_, advance_ + gained_ + fall / 2, admittance};
    const auto step = contact_step(table_, controls.contact, dt, approach, segment_);
    segment_ = step.segment;
    displacement_ = step.compression;
    force_ = step.force;
    gained_ += fall - 2 * (admittance * force_);
    if (std::abs(gained_) * 256 > std::abs(advance_)) advance_ += std::exchange(gained_, T(0));
  }

  [[nodiscard]] T displacement() const { return displacement_; }                  ///< [m], into the barrier
  [[nodiscard]] T velocity() const { return (advance_ + gained_) / time_step_; }  ///< [m/s], into the barrier
  [[nodiscard]] T force() const { return force_; }  ///< contact force over the last sample [N]

 private:
  SegmentTable<T, Extent> table_;
  T time_step_;
  T displacement_ = 0;
  std::size_t segment_ = 0;  // that holds the displacement
  // Velocity times time_step, the way of a sample [m]: no factor comes between it and the displacement, whose
  // rounding would add up over many bounces. In two parts: what gravity adds in a sample is small beside it and
  // always the same, so that every sum would be rounded the same way; it is gathered first.
  T advance_ = 0;
  T gained_ = 0;
  T force_ = 0;
};

}  // namespace contactspline
