// SPDX-License-Identifier: MIT
// What the forces on a body add at once to the pressure at listening places (docs/how-it-works/listening.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/instrument/instrument_data.hpp"
#include "contactspline/modal/mode.hpp"
#include "contactspline/network/contact_network.hpp"

namespace contactspline::detail {

/// Taps at another sample rate, by sinc interpolation below half of the lower rate. Tap n is for the time (n +
/// 1/2)/rate.
[[nodiscard]] inline std::vector<double> taps_at(std::span<const double> taps, double rate_hz, double new_rate_hz) {
  if (rate_hz == new_rate_hz) return {taps.begin(), taps.end()};
  const double step = rate_hz / new_rate_hz, width = std::max(step, 1.0);
  std::vector<double> made(static_cast<std::size_t>(static_cast<double>(taps.size()) / step) + 1);
  for (std::size_t n = 0; n < made.size(); ++n)
    for (std::size_t k = 0; k < taps.size(); ++k) {
      const double x = std::numbers::pi * ((double(n) + 0.5) * step - (double(k) + 0.5)) / width;
      made[n] += step / width * taps[k] * (x == 0 ? 1 : std::sin(x) / x);
    }
  return made;
}

/// Filters the forces at places.
template <std::floating_point T>
class NetworkPressure {
 public:
  /// Allocates.
  void prepare(const InstrumentData& data, double sample_rate_hz) {
    paths_.clear();
    forces_.clear();
    std::size_t first_tap = 0;
    for (const PressurePath& path : data.pressure_paths) {
      const std::vector<double> taps =
          taps_at(data.pressure_taps.subspan(first_tap, path.taps), data.pressure_rate_hz, sample_rate_hz);
      first_tap += path.taps;
      Path& made = paths_.emplace_back(Path{path.output, history_at(path.place, taps.size()), {}});
      for (const double tap : taps) made.taps.push_back(static_cast<T>(tap));
    }
    reset();
  }

  /// Takes the forces of the last sample.
  void follow(const ContactNetwork<T>& network) {
    for (Forces& forces : forces_) forces.add(network.force_at(forces.place));
  }

  [[nodiscard]] T output(std::size_t output) const {
    T sum = 0;
    for (const Path& path : paths_)
      if (path.output == output && forces_[path.forces].acting > 0) {
        const T* last = forces_[path.forces].last();
        sum += sum_of<T>(path.taps.size(), [&](std::size_t i) { return path.taps[i] * last[i]; });
      }
    return sum;
  }

  void reset() {
    for (Forces& forces : forces_) forces.reset();
  }

 private:
  // The last forces at a place, the newest first. They are kept twice, so that any number of them lie in one row.
  struct Forces {
    void add(T force_n) {
      begin = begin == 0 ? length - 1 : begin - 1;
      values[begin] = values[begin + length] = force_n;
      acting = force_n != 0 ? length : acting - (acting > 0 ? 1 : 0);
    }
    [[nodiscard]] const T* last() const { return values.data() + begin; }
    void reset() {
      values.assign(2 * length, T(0));
      begin = acting = 0;
    }

    std::size_t place, length, begin = 0;
    std::size_t acting = 0;  // so many more samples have one of these forces in their row
    std::vector<T> values = {};
  };
  struct Path {
    std::size_t output, forces;
    std::vector<T> taps;
  };

  std::size_t history_at(std::size_t place, std::size_t length) {
    auto found = std::ranges::find(forces_, place, &Forces::place);
    if (found == forces_.end()) found = forces_.insert(found, Forces{place, length});
    found->length = std::max(found->length, length);
    return static_cast<std::size_t>(found - forces_.begin());
  }

  std::vector<Path> paths_;
  std::vector<Forces> forces_;
};

}  // namespace contactspline::detail
