// SPDX-License-Identifier: MIT
// A strike of a hammer on a resonator at rest, as a function of its numbers.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "contactspline/models/hammer_string.hpp"
#include "contactspline/tangent/contact_gradient.hpp"
#include "contactspline/tangent/mode_tangent.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"  // of vectors that are returned: only by functions that are always inline

namespace contactspline {

/// A hammer thrown at a resonator at rest, and its output: the sum of output shape times modal displacement. Felt,
/// modes and memories must outlive it.
template <std::floating_point T>
struct HammerStrike {
  SegmentTable<T> felt;
  std::span<const Mode> modes;
  ModeShapes<T> strike, output;
  HammerStringControls<T> controls;
  T velocity_m_per_s, distance_m;
  std::span<const Memory> memories = {};
};

/// One value for each number of a strike, as in ContactNumbers. What is empty is 0.
template <std::floating_point T>
struct StrikeNumbers {
  ContactNumbers<T> felt = {};
  T hammer_mass_kg = 0, velocity_m_per_s = 0, distance_m = 0;
  std::vector<Mode> modes = {};
  ModeShapes<T> strike = {}, output = {};
};

namespace detail {

/// A number for each mode, in vectors without remainder.
template <std::floating_point T>
using ModeLines = ModalArray<T>;

/// Some modes side by side: what the compiler makes of it suits the processor.
inline constexpr std::size_t kLaneBytes = 32;
template <std::floating_point T>
struct LanesOf {
  using type [[gnu::vector_size(kLaneBytes)]] = T;
};
template <std::floating_point T>
using Lanes = typename LanesOf<T>::type;
template <std::floating_point T>
inline constexpr std::size_t kLaneCount = kLaneBytes / sizeof(T);

template <std::floating_point T>
[[gnu::always_inline]] inline Lanes<T> load(const T* from) {
  Lanes<T> lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}
template <std::floating_point T>
[[gnu::always_inline]] inline void store(const Lanes<T>& lanes, T* to) {
  std::memcpy(to, &lanes, sizeof(lanes));
}
template <std::floating_point T>
[[gnu::always_inline]] inline T sum_of_lanes(const Lanes<T>& lanes) {
  T sum = 0;
  for (std::size_t lane = 0; lane < kLaneCount<T>; ++lane) sum += lanes[lane];
  return sum;
}
template <std::floating_point T>
[[nodiscard]] T product(const ModeLines<T>& a, const T* b) {
  Lanes<T> sum{};
  for (std::size_t i = 0; i < a.padded_size(); i += kLaneCount<T>) sum += load(&a.data()[i]) * load(&b[i]);
  return sum_of_lanes<T>(sum);
}

/// Constants of the modes, a line each.
template <std::floating_point T>
struct StrikeLines {
  ModeLines<T> keep, pull, push;  ///< push: of the force at the strike [m/N]
  ModeLines<T> strike, output;    ///< shapes
  T receptance = 0;               ///< of the string at the strike [m/N]

  StrikeLines() = default;
  explicit StrikeLines(std::size_t modes) : keep(modes), pull(modes), push(modes), strike(modes), output(modes) {}
};

/// What advances the modes, as ModalBank does it with the damper inside. The change of a mode over a sample is c =
/// increment + push f; q grows by c, and the increment becomes keep c + (c - increment) - pull q.
template <std::floating_point T>
struct StrikeModes : StrikeLines<T> {
  using StrikeLines<T>::keep, StrikeLines<T>::pull, StrikeLines<T>::push, StrikeLines<T>::strike,
      StrikeLines<T>::output, StrikeLines<T>::receptance;
  T gain;  ///< of the damper

  StrikeModes(const HammerStrike<T>& of, double sample_rate_hz)
      : StrikeLines<T>(of.modes.size()), gain(1 / (1 + of.controls.damping_per_s / static_cast<T>(sample_rate_hz))) {
    for (std::size_t i = 0; i < of.modes.size(); ++i) {
      const ModeStep step = step_of(of.modes[i], sample_rate_hz);
      strike[i] = of.strike[i];
      output[i] = of.output[i];
      keep[i] = gain * static_cast<T>(2 - step.loss) - 1;
      pull[i] = gain * static_cast<T>(step.stiffness);
      push[i] = gain * static_cast<T>(step.receptance) * strike[i];
      receptance += push[i] * strike[i];
    }
  }
  [[nodiscard]] std::size_t padded_size() const { return keep.padded_size(); }
};

template <std::floating_point T>
[[nodiscard]] HammerString<T> struck(const HammerStrike<T>& strike, double sample_rate_hz) {
  HammerString<T> model(strike.felt, strike.modes, strike.strike, sample_rate_hz, strike.memories);
  model.strike(strike.velocity_m_per_s, strike.distance_m);
  return model;
}

}  // namespace detail

/// The derivative in a direction of the sum whose gradient is given: the sum of all products.
template <std::floating_point T>
[[nodiscard]] T derivative(const StrikeNumbers<T>& gradient, const StrikeNumbers<T>& direction) {
  return derivative(gradient.felt, direction.felt) + gradient.hammer_mass_kg * direction.hammer_mass_kg +
         gradient.velocity_m_per_s * direction.velocity_m_per_s + gradient.distance_m * direction.distance_m +
         detail::product(gradient.strike, direction.strike) + detail::product(gradient.output, direction.output) +
         static_cast<T>(detail::product(gradient.modes, direction.modes));
}

}  // namespace contactspline

#pragma GCC diagnostic pop
