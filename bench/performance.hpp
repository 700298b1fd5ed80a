// SPDX-License-Identifier: MIT
// A player that is struck as its workload states.
#pragma once

#include <algorithm>
#include <memory>
#include <span>

#include "bench/schemes.hpp"

namespace contactspline::bench {

/// Strikes a player as its workload states.
template <std::floating_point T>
class Performance {
 public:
  Performance(std::unique_ptr<Player<T>> player, const Workload& workload, int first_strike = 0)
      : player_(std::move(player)),
        speed_(static_cast<T>(workload.speed_m_per_s)),
        distance_(static_cast<T>(workload.distance_m)),
        between_(static_cast<std::size_t>(workload.samples_between)),
        until_strike_(static_cast<std::size_t>(first_strike)) {}

  void process(std::span<T> out) {
    while (!out.empty()) {
      if (until_strike_ == 0) {
        player_->strike(speed_, distance_);
        until_strike_ = between_;
      }
      const std::size_t samples = std::min(out.size(), until_strike_);
      player_->process(out.first(samples));
      until_strike_ -= samples;
      out = out.last(out.size() - samples);
    }
  }

 private:
  std::unique_ptr<Player<T>> player_;
  T speed_, distance_;
  std::size_t between_, until_strike_;
};

}  // namespace contactspline::bench
