// SPDX-License-Identifier: MIT
// What a keyboard on its body is built of.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "contactspline/data/mode.hpp"
#include "contactspline/data/parameter.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/data/string_parts.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline {

/// The largest number of places at which strings drive a body.
inline constexpr std::size_t kMaxBridgePlaces = 16;

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

/// How strings move along themselves. They do not if axial_stiffness_n is 0.
struct LongitudinalMotion {
  /// E A, modulus times cross-section of the core, as axial_stiffness() returns it. Above the tension.
  double axial_stiffness_n = 0;
  Losses losses = {0, 0};   ///< those of the longitudinal modes
  double output_ratio = 1;  ///< weight of their force on the bridge in the sound
};

/// E A [N] of a string whose modes along itself have frequencies that are frequency_ratio > 1 times those across it
/// without bending stiffness. The wave speeds sqrt(EA/mu) and sqrt(T/mu) have the same ratio.
[[nodiscard]] inline double axial_stiffness(double tension_n, double frequency_ratio) {
  return frequency_ratio * frequency_ratio * tension_n;
}

/// The longitudinal modes k = 1, 2, ... of a string between rigid ends, of a wave speed sqrt(EA/mu), below a limit
/// and at most `max_modes`; without the first that does not oscillate and those above it. Their unit of displacement
/// is a newton of force on the bridge.
[[nodiscard]] inline std::vector<Mode> longitudinal_modes(const StiffString& string, const LongitudinalMotion& motion,
                                                          double max_frequency_hz, std::size_t max_modes) {
  std::vector<Mode> modes;
  const double speed = std::sqrt(motion.axial_stiffness_n * string.length_m / string.mass_kg);
  while (modes.size() < max_modes) {
    const double beta = static_cast<double>(modes.size() + 1) * std::numbers::pi / string.length_m;
    if (!(speed * beta < 2 * std::numbers::pi * max_frequency_hz)) break;
    const auto mode = UndampedMode{speed * beta, beta, 1}.with(motion.losses);
    if (!mode) break;
    modes.push_back(*mode);
  }
  return modes;
}

/// The sound pressure of a body at a place in the room [Pa]: what its modal velocities and displacements weigh, and
/// filters of the forces at the places of its bridge [Pa/N], place after place, equally long.
struct EarPressure {
  std::span<const double> of_velocity, of_displacement, taps;
};

/// The same at both ears. rate_hz: sample rate of the filters; 0 without listening places.
struct BodyPressure {
  EarPressure left, right;
  double rate_hz = 0;
};

/// The body of a KeyboardOnBody: its modes, with shapes at the bridge, at both ears and, unless it is empty, where
/// keys knock at the body. A bridge of several places has the shapes of the first place, then those of the second
/// one, and so on, up to kMaxBridgePlaces of them. With `pressure` the ears are in the room.
struct BoardOfKeyboard {
  std::span<const Mode> modes;
  std::span<const double> bridge, left, right;
  Listening listening = {};
  std::span<const double> knock = {};
  BodyPressure pressure = {};

  [[nodiscard]] std::size_t places() const { return modes.empty() ? 1 : bridge.size() / modes.size(); }
};

/// What one key is built of.
struct KeyParts {
  StiffString strings;                ///< each by itself: one for each detuning
  double strike_position_m;           ///< from the end that does not move
  std::vector<Segment<double>> felt;  ///< table of one string
  std::vector<Memory> memories = {};  ///< of the felt
  double hammer_mass_kg;              ///< share of one string
  Damper damper;                      ///< damping 0: there is none
  double bridge_ratio = 1;            ///< motion of the bridge where these strings end, over that at its shapes
  double output_ratio = 1;            ///< weight of these strings' force on the bridge in the sound (Listening)
  HorizontalMotion horizontal = {};
  std::size_t bridge_place = 0;  ///< number of the body's place where these strings end
  LongitudinalMotion longitudinal = {};
};

/// A body at a sample rate, with the arrays that BoardOfKeyboard views.
struct BodyArrays {
  struct Ear {
    std::vector<double> of_velocity, of_displacement, taps;
  };
  std::vector<Mode> modes;
  std::vector<double> bridge, knock, left, right;
  std::vector<Ear> ears;  ///< none or two, in the room
  double sample_rate_hz;

  [[nodiscard]] BoardOfKeyboard board(const Listening& listening) const {
    return {modes, bridge, left, right, listening, knock, pressure()};
  }

 private:
  [[nodiscard]] BodyPressure pressure() const {
    if (ears.empty()) return {};
    const auto ear = [&](const Ear& e) -> EarPressure { return {e.of_velocity, e.of_displacement, e.taps}; };
    return {ear(ears[0]), ear(ears[1]), sample_rate_hz};
  }
};

/// What a keyboard on its body is built of.
struct KeyboardParts {
  std::string name, description;
  int first_key;  ///< of MIDI
  std::vector<KeyParts> keys;
  std::function<BodyArrays(double sample_rate_hz)> body;
  Listening listening = {};
  bool has_ears = false;                                ///< in the room: the outputs are pressures
  double min_speed_m_per_s = 1, max_speed_m_per_s = 1;  ///< of the hammer, at velocity 0 and 1
  double felt_loss_s_per_m = 0;                         ///< of all felts, at first
  double una_corda_stiffness_ratio = 1;                 ///< of all felts, under the soft pedal
  std::size_t max_modes = 80;                           ///< of each string
  std::vector<Preset> presets = {};

  /// Speed [m/s] at which a velocity throws the hammer: min (max/min)^velocity; velocity from 0 to 1, clamped. Not a
  /// number if the velocity is not, and then no hammer is thrown.
  [[nodiscard]] double speed_of(double velocity) const {
    if (!is_number(velocity)) return velocity;
    return min_speed_m_per_s * std::pow(max_speed_m_per_s / min_speed_m_per_s, std::clamp(velocity, 0.0, 1.0));
  }
};

}  // namespace contactspline
