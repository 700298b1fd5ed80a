// SPDX-License-Identifier: MIT
// A bank of modes that stretch their body where they move far: its pitch falls as it fades, and modes drive each
// other.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <span>

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/two_step_motion.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// A bank of modes with forms that stretch: in tune and exactly as compliant as ModalBank where it moves little, and
/// passive at any amplitude. For each sample call predict(), then push() for each force, then commit(). A contact
/// acts over two samples: before its push it reads increment() and receptance(), with its compression before the last
/// sample, so that it keeps one compression for even samples and one for odd ones, and half of the energy at each. No
/// allocation after construction.
template <std::floating_point T>
class StretchingBank {
 public:
  using Shapes = ModeShapes<T>;
  using VelocityShapes = typename ModalBank<T>::VelocityShapes;

  /// The forms name no other modes than these.
  StretchingBank(std::span<const Mode> modes, std::span<const StretchForm> forms, double sample_rate_hz)
      : bank_(modes, sample_rate_hz), motion_(forms, bank_) {}

  [[nodiscard]] std::size_t size() const { return bank_.size(); }

  /// Begins a sample, with a damper as in ModalBank::predict(). push(), increment() and receptance() take it into
  /// account.
  void predict(T damping = 0) {
    damping_ = held(damping_, damping, ControlRanges<T>::damping);
    motion_.begin(bank_, damping_);
  }
  /// Adds a force [N] at a place for this sample.
  void push(const Shapes& at, T force) { motion_.push(bank_, at.data(), force); }
  /// Change of displacement at a place [m] over the last sample and this one, with the forces pushed so far.
  [[nodiscard]] T increment(const Shapes& at) { return motion_.increment(at.data()); }
  /// Change of that increment at place `at` per newton at place `of_force` [m/N].
  [[nodiscard]] T receptance(const Shapes& at, const Shapes& of_force) {
    return motion_.receptance(bank_, at, of_force);
  }
  /// Change of displacement at a place over the last sample, between two samples [m].
  [[nodiscard]] T last_change(const Shapes& at) const { return motion_.last_change(at.data()); }
  /// Ends the sample.
  void commit() { motion_.end(bank_); }

  /// Displacements, velocities and pickups are those of the bank. Do not advance it.
  [[nodiscard]] const ModalBank<T>& bank() const { return bank_; }
  [[nodiscard]] T displacement(std::size_t mode) const { return bank_.displacement(mode); }  ///< [m]
  [[nodiscard]] T displacement(const Shapes& at) const { return bank_.displacement(at); }    ///< at a place [m]

  /// Sets the motion of a mode between two samples: its displacement [m] and its velocity [m/s].
  void set_motion(std::size_t mode, T displacement_m, T velocity_m_per_s) {
    bank_.set_motion(mode, displacement_m, velocity_m_per_s);
    motion_.take_motion(bank_);
  }
  /// As ModalBank::retune. Modes that stretch the body by themselves stay.
  void retune(std::span<const Mode> modes) {
    bank_.retune(modes.first(motion_.own_springs()));
    motion_.take_motion(bank_);
  }
  /// Brings all modes to rest. Does not allocate.
  void reset() {
    bank_.reset();
    motion_.take_motion(bank_);
  }

  /// Energy of the last two displacements [J]. In each sample it changes by the work of the forces minus
  /// dissipated(), exact up to rounding; a force F at a place that moves by x over two samples does the work F x/2.
  [[nodiscard]] double energy() const { return motion_.energy(bank_); }
  [[nodiscard]] double kinetic_energy() const { return motion_.kinetic_energy(bank_); }  ///< its kinetic part [J]
  [[nodiscard]] double stretching_energy() const { return motion_.stretching_energy(bank_); }  ///< of the forms [J]
  /// Energy [J] that the losses of the modes and the damper dissipated in the last sample.
  [[nodiscard]] double dissipated() const { return motion_.dissipated(bank_); }

 private:
  ModalBank<T> bank_;
  detail::TwoStepMotion<T> motion_;
  T damping_ = 0;
};

}  // namespace contactspline
