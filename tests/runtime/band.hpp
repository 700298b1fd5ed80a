// SPDX-License-Identifier: MIT
// An ensemble of strings that differ in everything, and the same voices on their own.
#pragma once

#include <random>

#include "contactspline/models/ensemble.hpp"
#include "strings.hpp"

namespace contactspline::testing {

inline constexpr int kRate = 44100;

/// What one voice is made of.
template <std::floating_point T>
struct Player {
  std::vector<Segment<T>> felt;
  std::vector<Mode> modes;
  ModeShapes<T> strike, pickup;
  HammerStringControls<T> controls;

  [[nodiscard]] HammerString<T> alone() const { return {felt, modes, strike, kRate}; }
};

/// C2, C4 and C7 by turns, with felts of different splines, stiffness and loss, hammers and dampers of their own.
template <std::floating_point T>
std::vector<Player<T>> band(std::size_t voices) {
  std::vector<Player<T>> players;
  const StruckString strings[] = {c4(), c2(), c7()};
  for (std::size_t i = 0; i < voices; ++i) {
    const StruckString& struck = strings[i % 3];
    const auto modes = audible_modes(struck);
    HammerStringControls<T> controls{static_cast<T>(struck.hammer_kg * (1 + 0.1 * static_cast<double>(i % 4)))};
    controls.felt = {static_cast<T>(1 + i % 5), static_cast<T>(i % 2 == 0 ? 0 : 0.1)};
    controls.damping_per_s = static_cast<T>(i % 4 == 3 ? 5 : 0);
    players.push_back({table_in<T>(felt_table(struck, 8 << (i % 4))), bare(modes),
                       shapes<T>(modes, &ResonatorMode::strike_shape), shapes<T>(modes, &ResonatorMode::pickup_shape),
                       controls});
  }
  return players;
}

template <std::floating_point T>
Ensemble<T> ensemble_of(const std::vector<Player<T>>& players, double inaudible_j = 1e-14) {
  Ensemble<T> ensemble(kRate, inaudible_j);
  for (const Player<T>& player : players)
    ensemble.add(player.felt, player.modes, player.strike, player.pickup, player.controls);
  return ensemble;
}

}  // namespace contactspline::testing
