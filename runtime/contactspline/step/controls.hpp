// SPDX-License-Identifier: MIT
// The rule for the controls of every model (docs/reference/controls.md): what a model does with a value that it
// cannot use.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

#include "contactspline/step/contact.hpp"

namespace contactspline {

namespace detail {

template <std::floating_point T>
using BitsOf = std::conditional_t<sizeof(T) == sizeof(std::uint32_t), std::uint32_t, std::uint64_t>;

/// The bits of |value|, in the order of the values: those of infinity are larger than those of all numbers, those of
/// NaN larger still. Compilers that assume finite numbers (-Ofast) drop std::isnan, but not this.
template <std::floating_point T>
[[nodiscard]] constexpr BitsOf<T> magnitude_bits(T value) {
  static_assert(std::numeric_limits<T>::is_iec559);
  if constexpr (sizeof(T) > sizeof(double))  // long double
    return magnitude_bits(static_cast<double>(value));
  else
    return std::bit_cast<BitsOf<T>>(value) & (~BitsOf<T>(0) >> 1);
}

template <std::floating_point T>
inline constexpr BitsOf<T> kInfinityBits = magnitude_bits(std::numeric_limits<T>::infinity());

}  // namespace detail

/// Is the value anything but NaN? Also right under -ffinite-math-only.
template <std::floating_point T>
[[nodiscard]] constexpr bool is_number(T value) {
  return detail::magnitude_bits(value) <= detail::kInfinityBits<T>;
}

/// Are all values finite? Also right under -ffinite-math-only.
template <std::floating_point T>
[[nodiscard]] constexpr bool all_finite(std::span<const T> values) {
  detail::BitsOf<T> largest = 0;
  for (const T value : values) largest = (std::max)(largest, detail::magnitude_bits(value));
  return largest < detail::kInfinityBits<T>;
}

/// The values that a control may take.
template <std::floating_point T>
struct ControlRange {
  T min, max;
};

/// The value in effect: moved into the range, infinity too; the last value in effect if `value` is not a number.
template <std::floating_point T>
[[nodiscard]] constexpr T held(T last, T value, ControlRange<T> range) {
  return is_number(value) ? std::clamp(value, range.min, range.max) : last;
}

/// The ranges of all live controls.
template <std::floating_point T>
struct ControlRanges {
  using Range = ControlRange<T>;
  static constexpr Range mass_kg{T(1e-9), T(1e4)};
  static constexpr Range stiffness_ratio{T(1e-6), T(1e6)};
  static constexpr Range loss_s_per_m{0, T(1e3)};
  static constexpr Range damping_per_s{0, T(1e5)};
  static constexpr Range damping{0, T(1e5)};  ///< damping_per_s times dt
  static constexpr Range bend_cents{T(-4800), T(4800)};
  static constexpr Range force_n{T(-1e3), T(1e3)};
  static constexpr Range bridge_force_n{T(-1e6), T(1e6)};
  static constexpr Range normal_force_n{0, T(1e3)};
  static constexpr Range friction_coefficient{0, T(10)};
  static constexpr Range hand_stiffness_n_per_m{0, T(1e9)};
  static constexpr Range resistance_n_s_per_m{0, T(1e6)};
  static constexpr Range gap_m{T(-0.1), T(0.1)};
  static constexpr Range place_m{0, T(100)};
  static constexpr Range height_m{T(-0.1), T(0.1)};
  static constexpr Range speed_m_per_s{T(-1e3), T(1e3)};
  static constexpr Range throw_distance_m{0, T(0.05)};
  static constexpr Range displacement_m{T(-1e3), T(1e3)};
  static constexpr Range gravity_m_per_s2{T(-1e3), T(1e3)};
  static constexpr Range gain{T(-1e9), T(1e9)};
  static constexpr Range pan{0, 1};
};

template <std::floating_point T>
[[nodiscard]] constexpr ContactControls<T> held(const ContactControls<T>& last, const ContactControls<T>& controls) {
  using Ranges = ControlRanges<T>;
  return {held(last.stiffness_ratio, controls.stiffness_ratio, Ranges::stiffness_ratio),
          held(last.loss_s_per_m, controls.loss_s_per_m, Ranges::loss_s_per_m)};
}

/// Power with which a rising stiffness may do work on a model, about that of a hand [W].
inline constexpr double kStiffeningPower_w = 1;

/// A stiffness that follows a control while it stores energy: it falls at once, and rises as far as
/// kStiffeningPower_w over one sample allows. energy_per_stiffness: the stored energy is the stiffness times this
/// [J].
template <std::floating_point T>
[[nodiscard]] constexpr T followed_stiffness(T now, T control, T energy_per_stiffness, T time_step_s) {
  const T work = T(kStiffeningPower_w) * time_step_s;
  return (control - now) * energy_per_stiffness <= work ? control : now + work / energy_per_stiffness;
}

/// A mass that follows a control: the factor for its velocity. What is added was at rest, what is taken away leaves
/// with the velocity of the rest: neither adds kinetic energy.
template <std::floating_point T>
[[nodiscard]] constexpr T velocity_factor(T mass_kg, T new_mass_kg) {
  return new_mass_kg > mass_kg ? mass_kg / new_mass_kg : T(1);
}

}  // namespace contactspline
