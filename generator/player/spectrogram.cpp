// SPDX-License-Identifier: MIT
#include "generator/player/spectrogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace contactspline {
namespace {

constexpr double kWindow_s = 0.09;
constexpr double kFloor_db = -100;
constexpr double kLowest_hz = 40, kHighest_hz = 16000;

std::vector<double> hann(std::size_t length) {
  std::vector<double> window(length);
  for (std::size_t i = 0; i < length; ++i) {
    const double phase = 2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length);
    window[i] = (1 - std::cos(phase)) / 2;
  }
  return window;
}

// A window's worth of samples around one of them, with silence before and after all.
std::vector<double> windowed(std::span<const float> samples, std::size_t middle, const std::vector<double>& window) {
  std::vector<double> part(window.size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    const std::size_t at = middle + i - part.size() / 2;  // wraps below the first
    if (at < samples.size()) part[i] = window[i] * static_cast<double>(samples[at]);
  }
  return part;
}

// Power around a place between bins: the largest within, or between the two neighbours where none lies within.
double power_between(const std::vector<std::complex<double>>& bins, double from, double to) {
  const auto power = [&](std::size_t bin) { return std::norm(bins[std::min(bin, bins.size() / 2)]); };
  const auto first = static_cast<std::size_t>(std::ceil(from)), last = static_cast<std::size_t>(to);
  if (last < first) {
    const double middle = (from + to) / 2;
    const auto below = static_cast<std::size_t>(middle);
    const double part = middle - static_cast<double>(below);
    return std::pow((1 - part) * std::sqrt(power(below)) + part * std::sqrt(power(below + 1)), 2);
  }
  double largest = 0;
  for (std::size_t bin = first; bin <= last; ++bin) largest = std::max(largest, power(bin));
  return largest;
}

}  // namespace

Spectrogram spectrogram_of(std::span<const float> samples, double sample_rate_hz, std::size_t columns,
                           std::size_t rows) {
  const auto length = std::bit_ceil(static_cast<std::size_t>(sample_rate_hz * kWindow_s * 0.75));
  const double highest = std::min(kHighest_hz, sample_rate_hz / 2);
  Spectrogram result{columns, rows, std::min(kLowest_hz, highest / 10), highest, {}};
  result.level_db.reserve(columns * rows);
  const auto window = hann(length);
  const double half_row = std::pow(highest / result.lowest_hz, 0.5 / static_cast<double>(rows - 1));
  const double bin_hz = sample_rate_hz / static_cast<double>(length);
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> bins;
  double loudest = 0;
  for (std::size_t column = 0; column < columns; ++column) {
    fft.fwd(bins, windowed(samples, samples.size() * (2 * column + 1) / (2 * columns), window));
    double row_hz = result.lowest_hz;
    for (std::size_t row = 0; row < rows; ++row) {
      const double power = power_between(bins, row_hz / half_row / bin_hz, row_hz * half_row / bin_hz);
      loudest = std::max(loudest, power);
      result.level_db.push_back(power);
      row_hz *= half_row * half_row;
    }
  }
  for (double& level : result.level_db)
    level = level > 0 ? std::max(kFloor_db, 10 * std::log10(level / loudest)) : kFloor_db;
  return result;
}

}  // namespace contactspline
