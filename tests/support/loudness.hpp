// SPDX-License-Identifier: MIT
// How loud sounds are, by the A-weighting of IEC 61672-1.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace contactspline::testing {

/// Weighs samples at a rate [Hz]: sections of first order, by the bilinear transform, 0 dB at 1 kHz.
inline void weigh(std::vector<double>& sound, double rate) {
  const std::pair<double, bool> poles[] = {{20.598997, true}, {20.598997, true},  {107.65265, true},
                                           {737.86223, true}, {12194.217, false}, {12194.217, false}};
  for (const auto& [pole_hz, is_high] : poles) {
    const double w = std::tan(std::numbers::pi * pole_hz / rate), gain = (is_high ? 1 : w) / (1 + w);
    double before = 0, weighted = 0;
    for (double& x : sound) {
      weighted = gain * (is_high ? x - before : x + before) + (1 - w) / (1 + w) * weighted;
      before = std::exchange(x, weighted);
    }
  }
  constexpr double kAtOneKilohertz = 1.2589;  // 2 dB
  for (double& x : sound) x *= kAtOneKilohertz;
}

}  // namespace contactspline::testing
