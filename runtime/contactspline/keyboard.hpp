// SPDX-License-Identifier: MIT
// The keys of an emitted keyboard as hammer-strings.
#pragma once

#include <array>
#include <cstddef>
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
    damper_ = 0;
    model_.strike(velocity_m_per_s, T(1e-4));
  }

  /// Lets the damper fall, where the key has one.
  void release() { damper_ = has_damper_ ? kDamper : T(0); }

  /// Advances one sample. Force of all strings on the bridge [N]. Safe in an audio thread.
  T tick() {
    controls_.damping_per_s += damper_rate_ * (damper_ - controls_.damping_per_s);
    model_.tick(controls_);
    return strings_ * model_.string().displacement(bridge_);
  }

  [[nodiscard]] const HammerString<T>& model() const { return model_; }
  [[nodiscard]] HammerStringControls<T>& controls() { return controls_; }

 private:
  static constexpr T kDamper = 60;              // extra decay [1/s]
  static constexpr double kDamperTime = 0.005;  // s, in which the damper has done 63 % of its way

  KeyboardVoice(int key, double sample_rate_hz, const StiffString& string, std::size_t most_modes)
      : KeyboardVoice(static_cast<std::size_t>(key - Keyboard::first_key), sample_rate_hz, string,
                      modes_below(string, sample_rate_hz / 2, most_modes)) {}

  KeyboardVoice(std::size_t k, double sample_rate_hz, const StiffString& string, const std::vector<StringMode>& modes)
      : bridge_(modes.size()),
        strings_(static_cast<T>(Keyboard::strings[k])),
        damper_rate_(static_cast<T>(-std::expm1(-1 / (kDamperTime * sample_rate_hz)))),
        has_damper_(Keyboard::first_key + static_cast<int>(k) <= Keyboard::last_damped_key),
        controls_{.hammer_mass_kg = static_cast<T>(Keyboard::hammer_masses[k]), .felt = {.loss_s_per_m = T(0.1)}},
        model_(SegmentTable<T>(felts_of<Keyboard, T>[k]), modes_in(modes),
               shapes_at(modes, Keyboard::strike_positions[k]), sample_rate_hz) {
    for (std::size_t i = 0; i < modes.size(); ++i)
      bridge_[i] = static_cast<T>(bridge_shape(string, modes[i].wavenumber_per_m));
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

  ModeShapes<T> bridge_;
  T strings_;
  T damper_rate_;
  bool has_damper_;
  T damper_ = 0;
  HammerStringControls<T> controls_;
  HammerString<T> model_;
};

}  // namespace contactspline
