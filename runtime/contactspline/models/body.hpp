// SPDX-License-Identifier: MIT
// A soundboard or another body that strings drive through their bridge, and that moves their ends.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>

#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/stiff_string.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// The sound of strings on a body, for each ear: the body's velocity there, times `pickup_ratio`, and the force
/// of the strings on the bridge, times a mobility, through a high-pass (docs/how-it-works/body.md).
struct Listening {
  double pickup_ratio = 1;
  double mobility_m_per_n_s = 0;
  double above_hz = 80;                      ///< below half the sample rate
  double quality = std::numbers::sqrt2 / 2;  ///< gain of the high-pass at above_hz (HighPass)
};

/// The motion of a key's strings parallel to the body, all together, beside the one towards it. It is there if both
/// ratios are above 0.
struct HorizontalMotion {
  double strike_ratio = 0, bridge_ratio = 0;  ///< by how much less the hammer and the bridge act on it
  double cents = 0;                           ///< above the mean of the other motions
};

/// A body with one bridge. Strings and body take turns, half a sample apart: the strings advance one sample while the
/// bridge stands still, then the body advances one sample while the strings stand still, tick(). The strings count
/// the displacements of their modes from where the bridge would hold them at rest, so they follow its change(). Each
/// side sees a constant force, so nothing is solved together, and yet the energy of strings, bridge and body is
/// balanced to rounding (docs/how-it-works/body.md). No allocation after construction.
template <std::floating_point T>
class Body {
 public:
  /// `bridge`: shapes of the body's modes at the bridge, one for each mode. `stiffness`: the sum of
  /// bridge_stiffness() of all strings that are there from the beginning. `knock`: shapes where knock() acts, or
  /// none.
  Body(std::span<const Mode> modes, ModeShapes<T> bridge, const BridgeStiffness& stiffness, double sample_rate_hz,
       ModeShapes<T> knock = ModeShapes<T>(0))
      : bank_(modes, sample_rate_hz),
        bridge_(std::move(bridge)),
        knock_(std::move(knock)),
        sample_rate_hz_(static_cast<T>(sample_rate_hz)),
        stiffness_(stiffness),
        first_modes_(stiffness.modes),
        admittance_(bank_.admittance(bridge_, bridge_)),
        knock_admittance_(knock_.size() > 0 ? bank_.admittance(bridge_, knock_) : T(0)) {}

  /// Displacement of the bridge [m], and its change over the last sample, which the strings follow in the next one.
  [[nodiscard]] T displacement() const { return displacement_; }
  [[nodiscard]] T change() const { return change_; }

  /// Modes of strings join between two samples: the stiffness that they add [N/m] (HammerString::follow), whose ends
  /// have been there all the time.
  void join(double stiffness_n_per_m) {
    stiffness_.modes += stiffness_n_per_m;
    force_n_ += static_cast<T>(stiffness_n_per_m / 2) * change_;
  }
  /// Modes of strings leave, with their energy: their stiffness, and their force on the bridge
  /// (HammerString::bridge_force).
  void leave(double stiffness_n_per_m, T force_n) {
    stiffness_.modes -= stiffness_n_per_m;
    force_n_ -= force_n;
  }

  /// Strings at the bridge change their tension: what their stiffness gains, and their force on the bridge [N].
  void retune(const BridgeStiffness& gain, T force_gain_n) {
    stiffness_ += gain;
    force_n_ += force_gain_n;
  }

  /// An impulse [N s] on the body during the next sample, -1e3 to 1e3, at the place `knock` of the constructor. One
  /// that is not a number does nothing.
  void knock(T impulse_n_s) {
    if (knock_.size() > 0) knock_n_ += sample_rate_hz_ * held(T(0), impulse_n_s, {T(-1e3), T(1e3)});
  }

  /// Advances one sample under the force of the strings on the bridge [N], taken after their sample: the sum of shape
  /// times modal displacement, -1e6 to 1e6. A force that is not a number counts as the last one. Safe in an audio
  /// thread.
  void tick(T force_n) {
    force_n_ = held(force_n_, force_n, ControlRanges<T>::bridge_force_n);
    const T knock_n = std::exchange(knock_n_, T(0)), free = free_increment_ + knock_admittance_ * knock_n;
    const T half = static_cast<T>((stiffness_.ends + stiffness_.modes) / 2);
    // The force is pull - half change, where the change is the free one plus admittance times the force.
    const T pull = force_n_ - static_cast<T>(stiffness_.ends) * displacement_;
    const T force = (pull - half * free) / (1 + admittance_ * half);
    const T* const places[] = {bridge_.data(), knock_.data()};
    const T forces[] = {force, knock_n};
    bank_.advance(T(0), std::span(places).first(knock_n != 0 ? 2 : 1), forces, std::span(places).first(1),
                  &free_increment_);
    change_ = free + admittance_ * force;
    displacement_ = bank_.displacement(bridge_);
  }

  /// Energy [J] of the body, of the tension of the strings at its bridge, and of the change that the strings have not
  /// followed yet; the sum with the strings' own energy changes by the work of other forces minus dissipated() of
  /// all.
  [[nodiscard]] double energy() const {
    const double w = double(displacement_), change = double(change_);
    return bank_.energy() + stiffness_.ends / 2 * w * w + (stiffness_.modes / 2 * change - double(force_n_)) * change;
  }

  /// The modes, for pickups and dissipated().
  [[nodiscard]] const ModalBank<T>& modes() const { return bank_; }

  /// Brings the body to rest, with the strings that were there at the beginning: all others leave. Does not allocate.
  void reset() {
    bank_.reset();
    stiffness_.modes = first_modes_;
    displacement_ = change_ = free_increment_ = force_n_ = knock_n_ = 0;
  }

 private:
  ModalBank<T> bank_;
  ModeShapes<T> bridge_, knock_;
  T sample_rate_hz_;
  BridgeStiffness stiffness_;
  double first_modes_;  // stiffness of the modes at the beginning [N/m]
  T admittance_, knock_admittance_;
  T displacement_ = 0, change_ = 0, force_n_ = 0;
  T free_increment_ = 0;  // of the bridge, over the next sample
  T knock_n_ = 0;         // in the next sample
};

}  // namespace contactspline
