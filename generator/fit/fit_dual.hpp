// SPDX-License-Identifier: MIT
// A number with its derivatives with respect to six parameters. No template, and vectors of the compiler: it is
// compiled in a tenth of the time of a general one, and loops over the slopes would cost fits ten times theirs.
#pragma once

#include <cmath>
#include <cstddef>

namespace contactspline {

struct FitDual {
  static constexpr std::size_t kSlopes = 6;
  using Pair [[gnu::vector_size(16)]] = double;

  double value = 0;
  Pair a{}, b{}, c{};  ///< the slopes

  FitDual() = default;
  FitDual(double constant) : value(constant) {}  // implicit, because a constant is a number, too
  FitDual(double of, Pair slopes_a, Pair slopes_b, Pair slopes_c)
      : value(of), a(slopes_a), b(slopes_b), c(slopes_c) {}

  [[nodiscard]] double slope(std::size_t p) const { return (p < 2 ? a : p < 4 ? b : c)[p % 2]; }
  void set_slope(std::size_t p, double slope) { (p < 2 ? a : p < 4 ? b : c)[p % 2] = slope; }

  /// The value f(x) with slopes of f's derivative times those of x.
  [[nodiscard]] static FitDual of(double value, double derivative, const FitDual& x) {
    return {value, derivative * x.a, derivative * x.b, derivative * x.c};
  }
  /// The value f(x, y), in the same way.
  [[nodiscard]] static FitDual of(double value, double by_x, const FitDual& x, double by_y, const FitDual& y) {
    return {value, by_x * x.a + by_y * y.a, by_x * x.b + by_y * y.b, by_x * x.c + by_y * y.c};
  }
};

inline FitDual operator+(const FitDual& x, const FitDual& y) {
  return {x.value + y.value, x.a + y.a, x.b + y.b, x.c + y.c};
}
inline FitDual operator-(const FitDual& x, const FitDual& y) {
  return {x.value - y.value, x.a - y.a, x.b - y.b, x.c - y.c};
}
inline FitDual operator*(const FitDual& x, const FitDual& y) {
  return FitDual::of(x.value * y.value, y.value, x, x.value, y);
}
inline FitDual operator/(const FitDual& x, const FitDual& y) {
  const double inverse = 1 / y.value, quotient = x.value * inverse;
  return FitDual::of(quotient, inverse, x, -quotient * inverse, y);
}
inline FitDual exp(const FitDual& x) {
  const double value = std::exp(x.value);
  return FitDual::of(value, value, x);
}
inline FitDual log(const FitDual& x) {
  return FitDual::of(std::log(x.value), 1 / x.value, x);
}
inline FitDual sqrt(const FitDual& x) {
  const double value = std::sqrt(x.value);
  return FitDual::of(value, 0.5 / value, x);
}

// With a constant, which has no derivatives to multiply.
inline FitDual operator*(const FitDual& x, double factor) {
  return FitDual::of(x.value * factor, factor, x);
}
inline FitDual operator*(double factor, const FitDual& x) {
  return x * factor;
}
inline FitDual operator/(const FitDual& x, double divisor) {
  return x * (1 / divisor);
}
inline FitDual operator/(double dividend, const FitDual& x) {
  const double value = dividend / x.value;
  return FitDual::of(value, -value / x.value, x);
}
inline FitDual operator+(const FitDual& x, double constant) {
  return {x.value + constant, x.a, x.b, x.c};
}
inline FitDual operator+(double constant, const FitDual& x) {
  return x + constant;
}
inline FitDual operator-(const FitDual& x, double constant) {
  return x + -constant;
}
inline FitDual operator-(const FitDual& x) {
  return {-x.value, -x.a, -x.b, -x.c};
}
inline FitDual operator-(double constant, const FitDual& x) {
  return -x + constant;
}
inline FitDual& operator+=(FitDual& x, const FitDual& other) {
  return x = x + other;
}
inline FitDual& operator-=(FitDual& x, const FitDual& other) {
  return x = x - other;
}

}  // namespace contactspline
