// SPDX-License-Identifier: MIT
// The low-pass of a sensor or of its filter, as a recorded force has passed it.
#pragma once

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "generator/fit/measurements.hpp"

namespace contactspline {

/// Butterworth's low-pass of an order, applied to values at rising times in place: a section of order 1, exact for
/// values that are straight between the times, and sections of order 2 by the trapezoidal rule. w: 2 pi times the
/// frequency where power falls by half [rad/s]; for orders above 1, steps should be a quarter of 1/w or less.
template <typename Real>
void pass_low(std::span<const double> times, std::span<Real> values, const Real& w, int order) {
  for (int section = 0; section < (order + 1) / 2; ++section) {
    const bool is_single = order % 2 == 1 && section == 0;
    const double angle = order % 2 == 0 ? (section + 0.5) / order : static_cast<double>(section) / order;
    const double damping = 2 * std::cos(std::numbers::pi * angle);
    Real y(0.0), slope(0.0), before(0.0);  // slope: dy/dt in units of w
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double step = i == 0 ? 0 : times[i] - times[i - 1];
      const Real a = w * (step / 2), drive = before + values[i], rise = values[i] - before;
      before = values[i];
      if (is_single && i > 0) {
        using std::exp;
        const Real lag = rise / (w * step);  // of an output that follows a straight line
        y = before - lag + (y - before + rise + lag) * exp(w * -step);
      } else if (!is_single) {
        const Real square = a * a, friction = a * damping;
        const Real next = (slope * (1.0 - friction - square) + a * (drive - 2.0 * y)) / (1.0 + friction + square);
        y += a * (slope + next);
        slope = next;
      }
      values[i] = y;
    }
  }
}

/// Times among which those of a pulse are every `stride`-th, dense enough for pass_low.
struct DenseTimes {
  std::vector<double> time_s;
  std::size_t stride = 1;
};

/// longest_s: no step is longer, unless that took more than 24 steps a sample.
inline DenseTimes dense_times(const std::vector<double>& time_s, double longest_s) {
  double longest_gap = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) longest_gap = std::max(longest_gap, time_s[i] - time_s[i - 1]);
  constexpr double kMaxStride = 24;
  DenseTimes dense;
  dense.stride = static_cast<std::size_t>(std::clamp(std::ceil(longest_gap / longest_s), 1.0, kMaxStride));
  for (std::size_t i = 0; i + 1 < time_s.size(); ++i)
    for (std::size_t k = 0; k < dense.stride; ++k)
      dense.time_s.push_back(time_s[i] + (time_s[i + 1] - time_s[i]) * static_cast<double>(k) /
                                             static_cast<double>(dense.stride));
  dense.time_s.push_back(time_s.back());
  return dense;
}

}  // namespace contactspline
