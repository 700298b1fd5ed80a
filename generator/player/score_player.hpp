// SPDX-License-Identifier: MIT
// A score played to the end: sound, and the contact force for a figure.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "generator/player/score.hpp"

namespace contactspline {

enum class Precision { kSingle, kDouble };

constexpr double kLongestRing_s = 30;  ///< behind a MIDI file, whatever still rings then

struct PlayOptions {
  double sample_rate_hz;                         ///< > 0
  std::size_t output = 0;                        ///< of outputs_of() the score
  std::optional<std::size_t> right_output = {};  ///< `output` is on the left, this one on the right
  bool is_on_body = false;  ///< the sound is the velocity of the body that all strings end at, in place of an output
  Precision precision = Precision::kDouble;  ///< of the models; the sum of the voices is kept in single precision
  double max_ring_s = 0;  ///< behind the duration of the score, as long as it rings: until it is 60 dB down
  int oversampling = 1;   ///< the models run at so many times the rate: one of kOversamplings
  std::optional<std::size_t> only_voice = {};  ///< plays this one alone, with the channels of the whole score
};

struct Performance {
  double sample_rate_hz;
  int channels;                ///< channels_of() the score and its options
  std::vector<float> samples;  ///< interleaved, in SI units [m], [m/s] or [N]
  std::vector<float> force_n;  ///< largest contact force, of an instrument file the largest sum, of any voice in each
                               ///< of equal stretches of time, at most 1200 over the duration of the score
  double largest_force_n;
  std::size_t contacts;       ///< of all voices; of an instrument file how often the sum of their forces begins
  double contact_s = 0;       ///< how long a voice has a contact force, summed over the voices; 0 for keyboards
  double mean_contact_s = 0;  ///< weighted by the impulses; 0 without contacts, and of keyboards
};

/// The outputs of a score's instrument; of a keyboard those of the strings of a key.
[[nodiscard]] std::vector<Output> outputs_of(const Score& score);

/// The output that sounds best: the body of a keyboard, if there is one, else the bridge of its strings; of an
/// instrument file those that begin with `left_` and `right_`, if both are there and have one unit, else the first.
/// Sets output, right_output and is_on_body.
void choose_best_output(const Score& score, PlayOptions& options);

/// What sounds, named without its side.
[[nodiscard]] Output sounding_output(const Score& score, const PlayOptions& options);

/// 2 if a voice is panned, the score has a body or both sides are played, else 1.
[[nodiscard]] int channels_of(const Score& score, const PlayOptions& options);

/// Samples at 1/factor of their rate (1, 2, 4 or 8), without delay: the first one stays at its time. What would be
/// mirrored is 90 dB down.
[[nodiscard]] std::vector<double> decimated(std::span<const double> samples, int factor);

/// Called with the part done, 0 to 1, a hundred times over a render.
using Progress = std::function<void(double)>;

/// Plays every voice of a score, or only one: the modes below half the sample rate, each contact with its own
/// controls. The sound is the sum of the voices. `progress` is called a hundred times or so. Throws BadInput where
/// a voice has no mode below half the rate, or a sound that is not finite.
[[nodiscard]] Performance play(const Score& score, const PlayOptions& options, const Progress& progress);

}  // namespace contactspline
