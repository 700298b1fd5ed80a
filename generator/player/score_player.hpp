// SPDX-License-Identifier: MIT
// A score played to the end: sound, and the contact force for a figure.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "generator/player/mass_barrier_player.hpp"
#include "generator/player/score.hpp"

namespace contactspline {

/// The signal in the sound: of the resonator at its pickup, the force of a string on its bridge (the end farthest
/// from 0), the contact force, or the velocity of the body that all strings end at. Without the body the bridge
/// stands still.
enum class Signal { kDisplacement, kVelocity, kBridge, kForce, kBody };

enum class Precision { kSingle, kDouble };

struct PlayOptions {
  double sample_rate_hz;  ///< > 0
  Signal signal = Signal::kVelocity;
  Precision precision = Precision::kDouble;  ///< of the models; the sum of the voices is kept in single precision
  std::size_t output = 0;  ///< of an instrument file: index of the output to play, in place of signal
  std::optional<std::size_t> only_voice = {};  ///< plays this one alone, with the channels of the whole score
};

struct Performance {
  double sample_rate_hz;
  int channels;                ///< channels_of() the score
  std::vector<float> samples;  ///< interleaved, in SI units [m], [m/s] or [N]
  std::vector<float> force_n;  ///< largest contact force, of an instrument file the largest sum, of any voice in each
                               ///< of at most 1200 equal stretches of time
  double largest_force_n;
  std::size_t contacts;  ///< of all voices
};

/// The signal that sounds best: that of the body, if there is one, bridge for other hammers on strings, else
/// velocity.
[[nodiscard]] Signal best_signal(const Score& score);

/// 2 if a voice is panned or the score has a body, else 1.
[[nodiscard]] int channels_of(const Score& score);

/// Plays every voice of a score, or only one: the modes below half the sample rate, each contact with its own
/// controls. The sound is the sum of the voices. `progress` is called a hundred times or so. Throws BadInput where
/// a voice has no mode below half the rate, no bridge where its force is the signal, or a sound that is not finite.
[[nodiscard]] Performance play(const Score& score, const PlayOptions& options, const Progress& progress);

}  // namespace contactspline
