// SPDX-License-Identifier: MIT
// The keys of an emitted keyboard as hammer-strings.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "contactspline/hammer_string.hpp"
#include "contactspline/stiff_string.hpp"

namespace contactspline {

/// Felt tables of all keys of an emitted keyboard in precision T, a compile-time constant; index by key - first_key.
template <typename Keyboard, std::floating_point T>
inline constexpr auto felts_of = [] {
  constexpr std::size_t row = Keyboard::segments + 1;
  std::array<std::array<Segment<T>, row>, Keyboard::keys> felts{};
  for (std::size_t i = 0; i < Keyboard::keys * row; ++i)
    felts[i / row][i % row] = {static_cast<T>(Keyboard::knots[i]), static_cast<T>(Keyboard::energies[i]),
                               static_cast<T>(Keyboard::forces[i]), static_cast<T>(Keyboard::half_curvatures[i])};
  return felts;
}();

/// The string of a key, first_key to last.
template <typename Keyboard>
[[nodiscard]] StiffString string_of(int key) {
  const auto k = static_cast<std::size_t>(key - Keyboard::first_key);
  return {Keyboard::lengths[k],
          Keyboard::masses[k],
          Keyboard::tensions[k],
          Keyboard::bending_stiffnesses[k],
          {Keyboard::constant_losses[k], Keyboard::quadratic_losses[k]}};
}

/// One key of an emitted keyboard: a hammer-string with a damper, heard by the force of its strings on the bridge.
template <typename Keyboard, std::floating_point T>
class KeyboardVoice {
 public:
  /// All modes below half the sample rate, or the lowest `most_modes` of them. key: first_key to the last one.
  KeyboardVoice(int key, double sample_rate_hz, std::size_t most_modes = 4096)
      : KeyboardVoice(key, sample_rate_hz, string_of<Keyboard>(key), most_modes) {}

  /// Throws the hammer at the strings [m/s] and lifts the damper; the strings may be sounding.
  void strike(T velocity_m_per_s) {
    damper_.move_to(0);
    model_.strike(velocity_m_per_s, T(1e-4));
  }

  /// Lets the damper fall, where the key has one.
  void release() { damper_.move_to(has_damper_ ? kDamper : T(0)); }

  /// Advances one sample. Force of all strings on the bridge [N]. Safe in an audio thread.
  T tick() {
    controls_.damping_per_s = damper_.held();
    damper_.advance(1);
    model_.tick(controls_);
    return model_.string().displacement(bridge_);
  }

  /// Advances out.size() samples and writes the force of all strings on the bridge [N] after each: what as many
  /// tick() do, but many times as fast where ContactSpline::simd is linked. Safe in an audio thread.
  void play(std::span<T> out) {
    while (!out.empty()) {
      const std::size_t samples = std::min(out.size(), damper_.samples());
      controls_.damping_per_s = damper_.held();
      damper_.advance(samples);
      model_.play(controls_, bridge_, out.first(samples));
      out = out.subspan(samples);
    }
  }

  [[nodiscard]] const HammerString<T>& model() const { return model_; }
  [[nodiscard]] HammerStringControls<T>& controls() { return controls_; }

 private:
  static constexpr T kDamper = 60;              // extra decay [1/s]
  static constexpr double kDamperTime = 0.005;  // s, in which the damper has done 63 % of its way

  // The damper glides: with each sample it does a constant share of what it has still to go. So that whole blocks can
  // be played, its damping is held for kHold samples at the mean of what it is in them, which takes the same from the
  // string but for a ripple; and it ends where nobody can tell.
  class GlidingDamper {
   public:
    explicit GlidingDamper(double sample_rate_hz)
        : left_each_(std::exp(-1 / (kDamperTime * sample_rate_hz))), left_(std::pow(left_each_, kHold)) {
      const double share = -std::expm1(-1 / (kDamperTime * sample_rate_hz));
      left_on_mean_ = left_each_ * (1 - left_) / (share * kHold);
    }

    void move_to(T target) {
      to_go_ = to_go_ * std::pow(left_each_, static_cast<double>(done_)) + target_ - target;
      target_ = target;
      done_ = 0;
    }

    /// Extra decay [1/s] in the coming samples().
    [[nodiscard]] T held() const { return static_cast<T>(target_ + to_go_ * left_on_mean_); }

    /// As many samples as the damping stays what it is.
    [[nodiscard]] std::size_t samples() const {
      return to_go_ == 0 ? std::numeric_limits<std::size_t>::max() : kHold - done_;
    }

    /// samples <= samples()
    void advance(std::size_t samples) {
      if (to_go_ == 0) return;
      done_ += samples;
      if (done_ < kHold) return;
      done_ = 0;
      to_go_ *= left_;
      if (std::abs(to_go_) < kSettled) to_go_ = 0;
    }

   private:
    static constexpr std::size_t kHold = 16;  // samples
    static constexpr double kSettled = 1e-5;  // 1/s: 1e-5 of the amplitude in a second

    double left_each_, left_;  // of the way, after one sample and after kHold
    double left_on_mean_;      // over kHold
    double target_ = 0;        // 1/s
    double to_go_ = 0;         // of the damping, above target_, when the held samples began [1/s]
    std::size_t done_ = 0;     // of the held samples
  };

  KeyboardVoice(int key, double sample_rate_hz, const StiffString& string, std::size_t most_modes)
      : KeyboardVoice(static_cast<std::size_t>(key - Keyboard::first_key), sample_rate_hz, string,
                      modes_below(string, sample_rate_hz / 2, most_modes)) {}

  KeyboardVoice(std::size_t k, double sample_rate_hz, const StiffString& string, const std::vector<StringMode>& modes)
      : bridge_(modes.size()),
        damper_(sample_rate_hz),
        has_damper_(Keyboard::first_key + static_cast<int>(k) <= Keyboard::last_damped_key),
        controls_{.hammer_mass_kg = static_cast<T>(Keyboard::hammer_masses[k]), .felt = {.loss_s_per_m = T(0.1)}},
        model_(SegmentTable<T>(felts_of<Keyboard, T>[k]), modes_in(modes),
               shapes_at(modes, Keyboard::strike_positions[k]), sample_rate_hz) {
    for (std::size_t i = 0; i < modes.size(); ++i)
      bridge_[i] = static_cast<T>(Keyboard::strings[k] * bridge_shape(string, modes[i].wavenumber_per_m));
  }

  static std::vector<Mode> modes_in(const std::vector<StringMode>& modes) {
    std::vector<Mode> bare;
    for (const StringMode& mode : modes) bare.push_back(mode.mode);
    return bare;
  }

  static ModeShapes<T> shapes_at(const std::vector<StringMode>& modes, double place_m) {
    ModeShapes<T> shapes(modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i)
      shapes[i] = static_cast<T>(std::sin(modes[i].wavenumber_per_m * place_m));
    return shapes;
  }

  ModeShapes<T> bridge_;  // of all strings of the key
  GlidingDamper damper_;
  bool has_damper_;
  HammerStringControls<T> controls_;
  HammerString<T> model_;
};

}  // namespace contactspline
