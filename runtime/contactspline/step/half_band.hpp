// SPDX-License-Identifier: MIT
// Half the sample rate, again and again: what a model gives that runs finer than its host.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

namespace contactspline {

namespace detail {

/// Modified Bessel function of the first kind, of order 0, by its power series.
inline double bessel_i0(double x) {
  double sum = 1, term = 1;
  for (int k = 1; term > 1e-17 * sum; ++k) sum += term *= (x / (2 * k)) * (x / (2 * k));
  return sum;
}

/// The taps of a half-band filter that are not 0, but for the middle one, which is 1/2: 2 half_length of them, by
/// Kaiser's window for 100 dB. Their sum is 1/2, so that a constant stays as it is.
inline std::vector<double> half_band_taps(std::size_t half_length) {
  constexpr double kBeta = 0.1102 * (100 - 8.7);
  const double centre = 2.0 * double(half_length) - 1;
  std::vector<double> taps;
  double sum = 0;
  for (std::size_t i = 0; i < 2 * half_length; ++i) {
    const double at = 2.0 * double(i) - centre, part = at / (centre + 1);
    taps.push_back(std::sin(std::numbers::pi * at / 2) / (std::numbers::pi * at) *
                   bessel_i0(kBeta * std::sqrt(1 - part * part)));
    sum += taps.back();
  }
  for (double& tap : taps) tap /= 2 * sum;
  return taps;
}

}  // namespace detail

/// Halves the rate of a signal by a half-band filter of linear phase with 4 half_length - 1 taps. Its delay is
/// half_length - 1 samples of the lower rate.
template <std::floating_point T>
class HalfBand {
 public:
  explicit HalfBand(std::size_t half_length) : taps_(2 * half_length), odd_(2 * half_length), even_(half_length) {
    const std::vector<double> taps = detail::half_band_taps(half_length);
    std::transform(taps.begin(), taps.end(), taps_.begin(), [](double tap) { return static_cast<T>(tap); });
  }

  [[nodiscard]] std::size_t delay() const { return even_.size() - 1; }

  /// A sample of the lower rate for two of the higher one.
  T tick(T first, T second) {
    const T middle = pushed(even_, first).back();
    const std::vector<T>& odd = pushed(odd_, second);
    T sum = middle / 2;
    for (std::size_t i = 0; i < taps_.size(); ++i) sum += taps_[i] * odd[i];
    return sum;
  }

  void reset() {
    std::fill(odd_.begin(), odd_.end(), T(0));
    std::fill(even_.begin(), even_.end(), T(0));
  }

 private:
  // The newest sample first.
  static const std::vector<T>& pushed(std::vector<T>& history, T sample) {
    std::move_backward(history.begin(), history.end() - 1, history.end());
    history.front() = sample;
    return history;
  }

  std::vector<T> taps_, odd_, even_;
};

/// Factors that a model may run finer than its host.
inline constexpr int kOversamplings[] = {1, 2, 4, 8};

/// Divides the rate of a signal by 1, 2, 4 or 8. Up to 0.4535 of the lower rate (20 kHz of 44.1) it keeps amplitudes
/// within 1e-4; what would be mirrored there is 90 dB down. Its constructor allocates, nothing else.
template <std::floating_point T>
class Decimator {
 public:
  /// factor: one of kOversamplings.
  explicit Decimator(int factor) {
    // The last stage has to be steep; those before delay by whole samples of the lowest rate.
    for (const auto& [at_factor, half_length] : {Stage{8, 5}, Stage{4, 7}, Stage{2, 35}})
      if (factor >= at_factor) stages_.emplace_back(half_length);
  }

  /// Samples of the higher rate for each of the lower one.
  [[nodiscard]] std::size_t factor() const { return std::size_t{1} << stages_.size(); }
  /// In samples of the lower rate: 0, 34, 37 or 38.
  [[nodiscard]] std::size_t delay() const {
    std::size_t delay = 0, rate = factor();
    for (const HalfBand<T>& stage : stages_) delay += stage.delay() * factor() / (rate /= 2);
    return delay / factor();
  }

  /// high: factor() samples for each of `low`; it is used up.
  void process(std::span<T> high, std::span<T> low) {
    std::size_t samples = low.size() * factor();
    for (HalfBand<T>& stage : stages_) {
      samples /= 2;
      for (std::size_t n = 0; n < samples; ++n) high[n] = stage.tick(high[2 * n], high[2 * n + 1]);
    }
    std::copy_n(high.begin(), low.size(), low.begin());
  }

  void reset() {
    for (HalfBand<T>& stage : stages_) stage.reset();
  }

 private:
  struct Stage {
    int at_factor;
    std::size_t half_length;
  };

  std::vector<HalfBand<T>> stages_;
};

}  // namespace contactspline
