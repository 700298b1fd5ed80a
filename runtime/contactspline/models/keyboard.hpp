// SPDX-License-Identifier: MIT
// The keys of an emitted keyboard as hammer voices.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/step/version.hpp"

namespace contactspline {

/// The felts of all keys of an emitted keyboard in precision T, a compile-time constant; index by key - first_key.
template <typename Keyboard, std::floating_point T>
inline constexpr auto felts_of = [] {
  static_assert(fits_runtime<Keyboard>, "generated for another version: run `contactspline generate` again");
  constexpr std::size_t row = Keyboard::segments + 1;
  std::array<std::array<Segment<T>, row>, Keyboard::keys> felts{};
  for (std::size_t i = 0; i < Keyboard::keys * row; ++i)
    felts[i / row][i % row] = {static_cast<T>(Keyboard::knots[i]), static_cast<T>(Keyboard::energies[i]),
                               static_cast<T>(Keyboard::forces[i]), static_cast<T>(Keyboard::half_curvatures[i])};
  return felts;
}();

/// Index of a key in the arrays of a keyboard. Throws std::out_of_range for a key that it lacks.
template <typename Keyboard>
[[nodiscard]] std::size_t index_of_key(int key) {
  constexpr int kLast = Keyboard::first_key + static_cast<int>(Keyboard::keys) - 1;
  if (key < Keyboard::first_key || key > kLast)
    throw std::out_of_range("key " + std::to_string(key) + ": the keyboard lacks it; allowed: " +
                            std::to_string(Keyboard::first_key) + " to " + std::to_string(kLast));
  return static_cast<std::size_t>(key - Keyboard::first_key);
}

/// One string of a key. Throws std::out_of_range for a key that the keyboard lacks.
template <typename Keyboard>
[[nodiscard]] StiffString string_of(int key) {
  static_assert(fits_runtime<Keyboard>, "generated for another version: run `contactspline generate` again");
  const std::size_t k = index_of_key<Keyboard>(key);
  return {Keyboard::lengths[k],
          Keyboard::masses[k],
          Keyboard::tensions[k],
          Keyboard::bending_stiffnesses[k],
          {Keyboard::constant_losses[k], Keyboard::quadratic_losses[k]}};
}

/// Speed [m/s] at which a velocity throws the hammer: min (max/min)^velocity; velocity from 0 to 1, clamped. Not a
/// number if the velocity is not, and then no hammer is thrown.
template <typename Keyboard>
[[nodiscard]] double strike_speed(double velocity) {
  if (!is_number(velocity)) return velocity;
  return Keyboard::min_speed_m_per_s *
         std::pow(Keyboard::max_speed_m_per_s / Keyboard::min_speed_m_per_s, std::clamp(velocity, 0.0, 1.0));
}

/// One key of an emitted keyboard: a hammer voice whose output is the force of all its strings on the bridge [N].
template <typename Keyboard, std::floating_point T>
class KeyboardVoice : public HammerVoice<T> {
 public:
  /// All modes below half the sample rate, or the lowest `max_modes` of them. Throws std::out_of_range for
  /// a key that the keyboard lacks.
  KeyboardVoice(int key, double sample_rate_hz, std::size_t max_modes = 4096)
      : KeyboardVoice(index_of_key<Keyboard>(key), sample_rate_hz, string_of<Keyboard>(key),
                      modes_below(string_of<Keyboard>(key), sample_rate_hz / 2, max_modes)) {}

 private:
  KeyboardVoice(std::size_t k, double sample_rate_hz, const StiffString& string, const std::vector<StringMode>& modes)
      : HammerVoice<T>({.felt = SegmentTable<T>(felts_of<Keyboard, T>[k]),
                        .modes = bare(modes),
                        .strike = strike_shapes(modes, Keyboard::strike_positions[k]),
                        .output = bridge_shapes<T>(string, modes, Keyboard::strings[k]),
                        .controls = {.hammer_mass_kg = static_cast<T>(Keyboard::hammer_masses[k]),
                                     .felt = {.loss_s_per_m = static_cast<T>(Keyboard::felt_loss_s_per_m)}},
                        .damper = {has_damper(k) ? Keyboard::damper_per_s : 0.0, Keyboard::damper_time_s}},
                       sample_rate_hz) {}

  static bool has_damper(std::size_t k) {
    return Keyboard::first_key + static_cast<int>(k) <= Keyboard::last_damped_key;
  }

  static ModeShapes<T> strike_shapes(const std::vector<StringMode>& modes, double position_m) {
    ModeShapes<T> shapes(modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i)
      shapes[i] = static_cast<T>(std::sin(modes[i].wavenumber_per_m * position_m));
    return shapes;
  }
};

}  // namespace contactspline
