// SPDX-License-Identifier: MIT
// A soundboard or another body that strings drive through their bridge, and that moves their ends.
#pragma once

#include "contactspline/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>

#include "contactspline/controls.hpp"
#include "contactspline/modal.hpp"

namespace contactspline {

/// A body with one bridge. Strings and body take turns, half a sample apart: the strings advance one sample while the
/// bridge stands still, at displacement(), then the body advances one sample while the strings
/// stand still, tick(). Each side sees a constant force, so nothing is solved together, and yet the energy of
/// strings, bridge and body is balanced to rounding (docs/body.md). No allocation after construction.
template <std::floating_point T>
class Body {
 public:
  /// `bridge`: shapes of the body's modes at the bridge, one for each mode. `stiffness`: what all strings add that
  /// are there from the beginning, the sum of their bridge_stiffness() [N/m], >= 0.
  Body(std::span<const Mode> modes, ModeShapes<T> bridge, double stiffness_n_per_m, double sample_rate_hz)
      : bank_(modes, sample_rate_hz),
        bridge_(std::move(bridge)),
        stiffness_(stiffness_n_per_m),
        admittance_(bank_.admittance(bridge_, bridge_)) {}

  /// Displacement of the bridge [m], for the coming sample of the strings.
  [[nodiscard]] T displacement() const { return displacement_; }

  /// Change of displacement() over the last sample [m].
  [[nodiscard]] T change() const { return change_; }

  /// Modes of strings join between two samples: the stiffness that they add [N/m], and their force at present [N]
  /// (HammerString::stiffness_on, HammerString::follow). energy() then counts them.
  void join(double stiffness_n_per_m, T force_n) {
    stiffness_ += stiffness_n_per_m;
    force_n_ += force_n;
  }
  /// Modes of strings leave, with the energy of their motion.
  void leave(double stiffness_n_per_m, T force_n) { join(-stiffness_n_per_m, -force_n); }

  /// Advances one sample under the force of the strings on the bridge [N], taken after their sample: the sum of shape
  /// times modal displacement, -1e6 to 1e6. A force that is not a number counts as the last one. Safe in an audio
  /// thread. The body feels this force less stiffness times displacement.
  void tick(T force_n) {
    force_n_ = held(force_n_, force_n, ControlRanges<T>::bridge_force_n);
    bank_.predict();
    const T stiffness = static_cast<T>(stiffness_), pull = force_n_ - stiffness * displacement_;
    // The force is pull - stiffness increment/2, where increment is the free one plus admittance times the force.
    bank_.push(bridge_, (pull - stiffness / 2 * bank_.increment(bridge_)) / (1 + admittance_ * stiffness / 2));
    bank_.commit();
    const T before = std::exchange(displacement_, bank_.displacement(bridge_));
    change_ = displacement_ - before;
  }

  /// Energy [J] of the body and of what the bridge adds to the energy of the strings; the sum with the strings' own
  /// energy changes by the work of other forces minus dissipated() of all.
  [[nodiscard]] double energy() const {
    const double w = double(displacement_);
    return bank_.energy() + (stiffness_ / 2 * w - double(force_n_)) * w;
  }

  /// The modes, for pickups and dissipated().
  [[nodiscard]] const ModalBank<T>& modes() const { return bank_; }

  /// Brings the body to rest. Does not allocate.
  void reset() {
    bank_.reset();
    displacement_ = change_ = force_n_ = 0;
  }

 private:
  ModalBank<T> bank_;
  ModeShapes<T> bridge_;
  double stiffness_;
  T admittance_;
  T displacement_ = 0, change_ = 0, force_n_ = 0;
};

}  // namespace contactspline
