// SPDX-License-Identifier: MIT
// A hammer-string with a damper and an output: one voice of a piano, a dulcimer, a marimba.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "contactspline/data/string_parts.hpp"
#include "contactspline/models/hammer_string.hpp"

namespace contactspline {

namespace detail {

/// The damping by a damper that is lifted at once, as a key lifts it before the hammer strikes, and comes down
/// gently: the damping approaches its full value exponentially. It is held for kHold samples at its mean over them,
/// so that whole blocks can be processed: the string loses the same, apart from a ripple. The fall ends when nobody
/// can hear the rest.
class FallingDamper {
 public:
  FallingDamper(const Damper& damper, double sample_rate_hz)
      : full_per_s_(damper.damping_per_s), time_(damper.time_s * sample_rate_hz) {
    set_pace(1);
  }

  /// position: 0 lifted to 1 down. A damper that is lifted a little loses its damping at once. pace: so many times as
  /// fast as the damper falls by itself.
  void move_to(double position, double pace = 1) {
    const double target = position * full_per_s_, now = target_ - remainder_;
    if (target == target_) return;
    if (pace != pace_) set_pace(pace);
    target_ = target;
    remainder_ = (std::max)(0.0, target - now);
    done_ = 0;
  }

  /// Ends the movement at once.
  void finish() { remainder_ = 0; }

  /// Damping in the coming samples() [1/s].
  [[nodiscard]] double value() const { return target_ - remainder_ * mean_factor_; }

  /// Number of samples for which value() holds.
  [[nodiscard]] std::size_t samples() const {
    return remainder_ == 0 ? (std::numeric_limits<std::size_t>::max)() : kHold - done_;
  }

  /// samples <= samples()
  void advance(std::size_t samples) {
    if (remainder_ == 0) return;
    done_ += samples;
    if (done_ < kHold) return;
    done_ = 0;
    remainder_ *= hold_factor_;
    if (remainder_ < kInaudible) remainder_ = 0;
  }

 private:
  static constexpr std::size_t kHold = 16;    // samples
  static constexpr double kInaudible = 1e-5;  // 1/s: 1e-5 of the amplitude in a second

  void set_pace(double pace) {
    pace_ = pace;
    const double factor = std::exp(-1 / (time_ / pace));
    hold_factor_ = std::pow(factor, kHold);
    mean_factor_ = factor * (1 - hold_factor_) / (-std::expm1(-1 / (time_ / pace)) * kHold);
  }

  double full_per_s_;
  double time_;  // in which the remainder falls to 1/e [samples]
  double pace_ = 1;
  double hold_factor_ = 0;  // of the remainder over kHold
  double mean_factor_ = 0;  // its mean over kHold
  double target_ = 0;       // [1/s]
  double remainder_ = 0;    // damping below the target when the hold began [1/s]
  std::size_t done_ = 0;    // samples of the hold
};

}  // namespace detail

/// What a hammer voice is built of. The felt must outlive the voice.
template <std::floating_point T>
struct HammerVoiceParts {
  SegmentTable<T> felt;
  std::span<const Mode> modes;
  ModeShapes<T> strike, output;
  HammerStringControls<T> controls;
  Damper damper = {};
  std::span<const Memory> memories = {};  ///< of the felt
};

/// A hammer-string with a damper. `output` are mode shapes: the output is the sum of shape times modal displacement,
/// for instance the displacement at a pickup [m] or the force on a bridge [N], as ModalBank::sound_pickup gives it.
template <std::floating_point T>
class HammerVoice {
 public:
  static constexpr T kThrowDistance_m = T(1e-4);  ///< from which the hammer is thrown

  HammerVoice(HammerVoiceParts<T> parts, double sample_rate_hz)
      : model_(parts.felt, parts.modes, std::move(parts.strike), sample_rate_hz, parts.memories),
        output_(model_.string().sound_pickup(parts.output)),
        controls_(parts.controls),
        damper_(parts.damper, sample_rate_hz) {}

  /// Throws the hammer at the strings [m/s], -1000 to 1000, and lifts the damper. The strings may be sounding. Does
  /// nothing if the velocity is not a number.
  void strike(T velocity_m_per_s) {
    if (!is_number(velocity_m_per_s)) return;
    lift();
    model_.strike(velocity_m_per_s, kThrowDistance_m);
  }

  /// Moves the place of the strike, from the next throw on. Does nothing if a shape is not finite.
  void strike_at(const ModeShapes<T>& strike) { model_.strike_at(strike); }
  /// Takes other memories of the felt from the next strike on.
  void set_memories(std::span<const Memory> memories, double sample_rate_hz) {
    model_.set_memories(memories, sample_rate_hz);
  }

  /// Changes frequencies and decays of the sounding strings (ModalBank::retune), for a bend of the pitch; the output
  /// stays that of the first frequencies. Does not allocate.
  void retune(std::span<const Mode> modes) { model_.retune(modes); }

  /// Lifts the damper, as a key does that is pressed without a sound.
  void lift() { damper_.move_to(0); }

  /// Lowers the damper.
  void release() { damper_.move_to(1); }

  /// Brings the strings to rest, stops the hammer and lifts the damper. Does not allocate.
  void reset() {
    lift();
    model_.reset();
  }

  /// Advances one sample and returns the output. Safe in an audio thread: no allocation, no lock, bounded time.
  T tick() {
    damping_per_s_ = own_damping();
    model_.tick(damped());
    damper_.advance(1);
    return model_.string().displacement(output_);
  }

  /// Advances one sample on a bridge that has moved by change_m, and returns what Body::tick() takes [N]
  /// (HammerString::tick). `bridge`: of model().bridge(), for a model of each string by itself. Safe in an audio
  /// thread.
  T tick(const BridgeShapes<T>& bridge, T change_m) {
    damping_per_s_ = own_damping();
    const T force = model_.tick(damped(), bridge, change_m);
    damper_.advance(1);
    return force;
  }

  /// Advances out.size() samples, writes the output after each and, unless `forces` is null, the contact forces [N].
  /// Equals as many calls of tick(), but is many times as fast if ContactSpline::simd is linked. Safe in an audio
  /// thread.
  void process(std::span<T> out, T* forces = nullptr) { process(output_, out, forces); }
  /// The same for other output shapes.
  void process(const ModeShapes<T>& output, std::span<T> out, T* forces) {
    damping_per_s_ = own_damping();
    while (!out.empty()) {
      const std::size_t samples = (std::min)(out.size(), damper_.samples());
      model_.process(damped(), output, out.first(samples), forces);
      damper_.advance(samples);
      out = out.subspan(samples);
      if (forces != nullptr) forces += samples;
    }
  }

  /// Is the hammer stopped, and the energy of the strings below a limit [J]? Such a voice may be skipped until it is
  /// struck again. The default is 90 dB below a C4 hammer at 0.1 m/s.
  [[nodiscard]] bool is_silent(double inaudible_j = 1e-14) const {
    return !model_.is_hammer_flying() && model_.string().energy() < inaudible_j;
  }

  /// Energy of strings, hammer and felt [J]; a hammer that is stopped has none.
  [[nodiscard]] double energy() const { return model_.energy(controls_); }
  /// Damping in the coming sample, the damper's and that of the controls [1/s].
  [[nodiscard]] T damping_per_s() const { return damped().damping_per_s; }

  [[nodiscard]] const HammerString<T>& model() const { return model_; }
  /// The shapes that process() uses.
  [[nodiscard]] const ModeShapes<T>& output_shapes() const { return output_; }
  /// Live controls. Their damping adds to the damper's.
  [[nodiscard]] HammerStringControls<T>& controls() { return controls_; }

 private:
  // The damping of the controls, before the damper's is added: one that is not a number leaves the damper alone.
  [[nodiscard]] T own_damping() const {
    return held(damping_per_s_, controls_.damping_per_s, ControlRanges<T>::damping_per_s);
  }

  [[nodiscard]] HammerStringControls<T> damped() const {
    HammerStringControls<T> controls = controls_;
    controls.damping_per_s = own_damping() + static_cast<T>(damper_.value());
    return controls;
  }

  HammerString<T> model_;
  ModeShapes<T> output_;
  HammerStringControls<T> controls_;
  T damping_per_s_ = 0;  // the last one of the controls that was a number
  detail::FallingDamper damper_;
};

}  // namespace contactspline
