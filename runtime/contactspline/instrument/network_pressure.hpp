// SPDX-License-Identifier: MIT
// What the forces on a network's bodies add at once to the pressure at listening places.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/modal/force_history.hpp"
#include "contactspline/network/contact_network.hpp"

namespace contactspline::detail {

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
      const auto taps = data.pressure_taps.subspan(first_tap, path.taps);
      first_tap += path.taps;
      paths_.push_back({path.output, 0, taps_in<T>(taps, data.pressure_rate_hz, sample_rate_hz)});
      paths_.back().forces = history_at(path.place, paths_.back().taps.size());
    }
    reset();
  }

  /// Takes the forces of the last sample.
  void follow(const ContactNetwork<T>& network) {
    for (Forces& forces : forces_) forces.last.add(network.force_at(forces.place));
  }

  [[nodiscard]] T output(std::size_t output) const {
    T sum = 0;
    for (const Path& path : paths_)
      if (path.output == output) sum += forces_[path.forces].last.filtered(path.taps);
    return sum;
  }

  void reset() {
    for (Forces& forces : forces_) forces.last.reset();
  }

 private:
  struct Forces {
    std::size_t place;
    ForceHistory<T> last = ForceHistory<T>();
  };
  struct Path {
    std::size_t output, forces;
    std::vector<T> taps;
  };

  std::size_t history_at(std::size_t place, std::size_t length) {
    auto found = std::ranges::find(forces_, place, &Forces::place);
    if (found == forces_.end()) found = forces_.insert(found, Forces{place});
    found->last.widen(length);
    return static_cast<std::size_t>(found - forces_.begin());
  }

  std::vector<Path> paths_;
  std::vector<Forces> forces_;
};

}  // namespace contactspline::detail
