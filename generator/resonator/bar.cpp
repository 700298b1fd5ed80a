// SPDX-License-Identifier: MIT
#include "generator/resonator/bar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace contactspline {
namespace {

using std::numbers::pi;

// The root of cos(x) = sign/cosh(x) beside an odd multiple of pi/2, where Newton's method starts.
double root_beside(double x, double sign) {
  for (int step = 0; step < 8; ++step) {
    const double slope = -std::sin(x) + sign * std::tanh(x) / std::cosh(x);
    x -= (std::cos(x) - sign / std::cosh(x)) / slope;
  }
  return x;
}

std::ptrdiff_t supports(const Bar& bar) {
  return std::ranges::count(bar.ends, BarEnd::kSupported);
}

// The shape at a distance s from a free or clamped end of a bar of length L whose other end is free or clamped:
// (g ((1 + e) cos(beta s) - (1 - e) sin(beta s)) + exp(-beta s) + sign exp(-beta (L - s)))/(2 (1 + e)), where e =
// sign exp(-beta L), and g is 1 at a free end and -1 at a clamped one. sign is that of the shape at the other end.
// Decaying exponentials only: the difference of cosh and sinh, as textbooks write it, would cancel.
double shape_from(BarEnd end, double beta, double length, double sign, double s) {
  const double far = sign * std::exp(-beta * length);
  const double wave = (1 + far) * std::cos(beta * s) - (1 - far) * std::sin(beta * s);
  const double decaying = std::exp(-beta * s) + sign * std::exp(-beta * (length - s));
  return ((end == BarEnd::kFree ? wave : -wave) + decaying) / (2 * (1 + far));
}

// The same at a distance s from a support, which is the middle of an odd shape of a bar twice as long: sines alone,
// so that the shape is 0 there.
double shape_from_support(BarEnd other_end, double beta, double length, double sign, double s) {
  const double far = std::exp(-2 * beta * length);
  const double wave = sign * std::sqrt(2 * (1 + far * far)) * std::sin(beta * s);
  const double decaying = std::exp(-beta * (length - s)) - std::exp(-beta * (length + s));
  return ((other_end == BarEnd::kFree ? wave : -wave) + decaying) / (2 * (1 - far));
}

}  // namespace

double wavenumber_times_length(const Bar& bar, int i) {
  const double index = i;
  if (supports(bar) == 2) return index * pi;
  if (supports(bar) == 1) return root_beside((2 * index + 0.5) * pi, 1) / 2;  // half of a bar twice as long
  return bar.ends[0] == bar.ends[1] ? root_beside((index + 0.5) * pi, 1) : root_beside((index - 0.5) * pi, -1);
}

UndampedMode undamped_mode(const Bar& bar, int i) {
  const double beta = wavenumber_times_length(bar, i) / bar.length_m;
  const double stiffness = bar.bending_stiffness_n_m2 * std::pow(beta, 4);
  return {std::sqrt(stiffness * bar.length_m / bar.mass_kg), beta, bar.mass_kg / (supports(bar) == 2 ? 2 : 4)};
}

double shape_at(const Bar& bar, int i, double wavenumber_per_m, double x_m) {
  const bool is_far = x_m > bar.length_m / 2;
  const double s = is_far ? bar.length_m - x_m : x_m;  // from the nearer end: there the shape is exact
  const BarEnd near = bar.ends[is_far ? 1 : 0], other = bar.ends[is_far ? 0 : 1];
  const double beta = wavenumber_per_m, length = bar.length_m, sign = i % 2 == 0 ? -1 : 1;
  if (supports(bar) == 1)
    return near == BarEnd::kSupported ? shape_from_support(other, beta, length, -sign, s)
                                      : shape_from(near, beta, 2 * length, -1, s);
  const double shape = supports(bar) == 2 ? std::sin(beta * s) : shape_from(near, beta, length, sign, s);
  return is_far ? sign * shape : shape;
}

}  // namespace contactspline
