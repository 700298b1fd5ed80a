// SPDX-License-Identifier: MIT
#include "spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace contactspline::testing {

Partial strongest_partial(std::span<const float> sound, double sample_rate_hz, double from_hz, double to_hz) {
  const auto length = static_cast<double>(sound.size());
  std::vector<double> windowed(sound.begin(), sound.end());
  for (std::size_t n = 0; n < windowed.size(); ++n)
    windowed[n] *= 1 - std::cos(2 * std::numbers::pi * (static_cast<double>(n) + 0.5) / length);
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double>().fwd(spectrum, windowed);
  const auto bin = [&](double frequency_hz) {
    return static_cast<std::size_t>(std::clamp(frequency_hz * length / sample_rate_hz, 1.0, length / 2 - 2));
  };
  std::size_t top = bin(from_hz);
  for (std::size_t k = top; k <= bin(to_hz); ++k)
    if (std::abs(spectrum[k]) > std::abs(spectrum[top])) top = k;
  const double before = std::log(std::abs(spectrum[top - 1]) + 1e-300);
  const double here = std::log(std::abs(spectrum[top]) + 1e-300);
  const double after = std::log(std::abs(spectrum[top + 1]) + 1e-300);
  const double shift = (before - after) / (2 * std::min(before - 2 * here + after, -1e-300));
  return {(static_cast<double>(top) + shift) * sample_rate_hz / length, 2 * std::abs(spectrum[top]) / length};
}

double rms(std::span<const float> sound) {
  double sum = 0;
  for (const float x : sound) sum += static_cast<double>(x) * static_cast<double>(x);
  return std::sqrt(sum / static_cast<double>(sound.size()));
}

}  // namespace contactspline::testing
