// SPDX-License-Identifier: MIT
// A scheme that is struck as its duty says.
#pragma once

#include <algorithm>
#include <memory>
#include <span>

#include "bench/schemes.hpp"

namespace contactspline::bench {

/// A player that is struck as its duty says.
template <std::floating_point T>
class Performance {
 public:
  Performance(std::unique_ptr<Player<T>> player, const Duty& duty, int first_strike = 0)
      : player_(std::move(player)),
        speed_(static_cast<T>(duty.speed_m_per_s)),
        distance_(static_cast<T>(duty.distance_m)),
        between_(static_cast<std::size_t>(duty.samples_between)),
        until_strike_(static_cast<std::size_t>(first_strike)) {}

  void play(std::span<T> out) {
    while (!out.empty()) {
      if (until_strike_ == 0) {
        player_->strike(speed_, distance_);
        until_strike_ = between_;
      }
      const std::size_t samples = std::min(out.size(), until_strike_);
      player_->play(out.first(samples));
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
