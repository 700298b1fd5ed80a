// SPDX-License-Identifier: MIT
// A mass thrown at a rigid barrier, with or without gravity.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <span>
#include <utility>

#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline {

/// Live controls of the mass-barrier model. Their ranges are those of ControlRanges.
template <std::floating_point T>
struct MassBarrierControls {
  T mass_kg;
  T gravity_m_per_s2 = 0;  ///< towards the barrier
  ContactControls<T> contact = {};
};

/// A point mass and a rigid barrier at 0. Displacement and velocity are positive into the barrier, so a displacement
/// > 0 is a compression. The energy balance is exact: without loss, m v^2/2 - m g q + V(q) is constant (midpoint
/// rule, docs/how-it-works/contact-step.md). A stiffness that rises under load and a mass that changes follow
/// docs/reference/controls.md.
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class MassBarrier {
 public:
  /// memories: of the material, as memories_of tells them.
  constexpr MassBarrier(SegmentTable<T, Extent> table, T sample_rate_hz, std::span<const Memory> memories = {})
      : table_(table), time_step_(1 / sample_rate_hz), memory_(memories, double(sample_rate_hz)) {}

  /// Sets the displacement [m], -1000 to 1000 (negative: in front of the barrier), and the velocity [m/s] towards the
  /// barrier, -1000 to 1000. The contact forgets what it remembers. Does nothing if one of them is not a number.
  void throw_from(T displacement_m, T velocity_m_per_s) {
    if (!is_number(displacement_m) || !is_number(velocity_m_per_s)) return;
    displacement_ = held(T(0), displacement_m, Ranges::displacement_m);
    segment_ = segment_index(table_, displacement_);
    velocity_step_ = held(T(0), velocity_m_per_s, Ranges::speed_m_per_s) * time_step_;
    pending_step_ = 0;
    force_ = 0;
    memory_.reset();
    is_thrown_ = true;
  }

  /// The mass at rest at the surface of the barrier, as at first. Does not allocate.
  void reset() { throw_from(0, 0); }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick(const MassBarrierControls<T>& controls) {
    follow(controls);
    const T dt = time_step_;
    const T receptance = dt * dt / (2 * mass_);
    const T gravity_step = dt * dt * gravity_;
    const Approach<T> approach{displacement_, velocity_step_ + pending_step_ + gravity_step / 2, receptance};
    const auto step = memory_.advance(table_, contact_, dt, approach, segment_);
    segment_ = step.segment;
    displacement_ = step.compression;
    force_ = step.force;
    pending_step_ += gravity_step - 2 * (receptance * force_);
    if (std::abs(pending_step_) * 256 > std::abs(velocity_step_))
      velocity_step_ += std::exchange(pending_step_, T(0));
  }

  [[nodiscard]] T displacement() const { return displacement_; }  ///< [m], into the barrier
  /// [m/s], into the barrier
  [[nodiscard]] T velocity() const { return (velocity_step_ + pending_step_) / time_step_; }
  [[nodiscard]] T force() const { return force_; }  ///< contact force over the last sample [N]
  /// The ratio in effect. While the contact is loaded it lags behind a control that rises.
  [[nodiscard]] T stiffness_ratio() const { return contact_.stiffness_ratio; }
  /// Energy that the contact stores [J], with what it remembers.
  [[nodiscard]] T contact_energy() const { return memory_.energy(table_, displacement_, contact_.stiffness_ratio); }
  [[nodiscard]] const ContactMemory<T>& memory() const { return memory_; }

 private:
  using Ranges = ControlRanges<T>;

  void follow(const MassBarrierControls<T>& controls) {
    gravity_ = held(gravity_, controls.gravity_m_per_s2, Ranges::gravity_m_per_s2);
    if (std::exchange(is_thrown_, false)) {
      mass_ = held(mass_, controls.mass_kg, Ranges::mass_kg);
      contact_ = held(contact_, controls.contact);
      return;
    }
    const T mass = held(mass_, controls.mass_kg, Ranges::mass_kg);
    if (mass != mass_) {
      const T factor = velocity_factor(mass_, mass);
      velocity_step_ *= factor;
      pending_step_ *= factor;
      mass_ = mass;
    }
    contact_ = followed_contact(memory_, table_, displacement_, contact_, controls.contact, time_step_);
  }

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
  bool is_thrown_ = true;  // since the last sample: the next one takes mass and stiffness as they are
  T mass_ = 1, gravity_ = 0;
  ContactControls<T> contact_;
  ContactMemory<T> memory_;
};

}  // namespace contactspline
