// SPDX-License-Identifier: MIT
// A number with its derivatives with respect to several parameters.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <type_traits>

#include "contactspline/step/controls.hpp"

namespace contactspline {

/// A value and its slopes, the derivatives with respect to P parameters.
template <std::floating_point T, std::size_t P>
struct Dual {
  T value = 0;
  std::array<T, P> slopes{};

  constexpr Dual() = default;
  /// A constant, of any arithmetic type: implicit, because it is a number, too.
  template <typename Constant>
  requires std::is_arithmetic_v<Constant>
  constexpr Dual(Constant constant) : value(static_cast<T>(constant)) {}
  constexpr Dual(T of, const std::array<T, P>& derivatives) : value(of), slopes(derivatives) {}

  [[nodiscard]] friend constexpr Dual operator+(const Dual& a, const Dual& b) {
    return each(a.value + b.value, [&](std::size_t p) { return a.slopes[p] + b.slopes[p]; });
  }
  [[nodiscard]] friend constexpr Dual operator-(const Dual& a, const Dual& b) {
    return each(a.value - b.value, [&](std::size_t p) { return a.slopes[p] - b.slopes[p]; });
  }
  [[nodiscard]] friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    return each(a.value * b.value, [&](std::size_t p) { return a.slopes[p] * b.value + a.value * b.slopes[p]; });
  }
  [[nodiscard]] friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    const T quotient = a.value / b.value;
    return each(quotient, [&](std::size_t p) { return (a.slopes[p] - quotient * b.slopes[p]) / b.value; });
  }
  [[nodiscard]] friend constexpr bool operator<(const Dual& a, const Dual& b) { return a.value < b.value; }

 private:
  template <typename Slope>
  static constexpr Dual each(T value, Slope slope) {
    Dual result(value);
    for (std::size_t p = 0; p < P; ++p) result.slopes[p] = slope(p);
    return result;
  }
};

/// What a control with slopes becomes: as without them. A value beyond its range does not follow the parameters.
template <std::floating_point T, std::size_t P>
[[nodiscard]] constexpr Dual<T, P> held(const Dual<T, P>& last, const Dual<T, P>& control, ControlRange<T> range) {
  if (!is_number(control.value)) return last;
  const T value = held(last.value, control.value, range);
  return value == control.value ? control : Dual<T, P>(value);
}

}  // namespace contactspline
