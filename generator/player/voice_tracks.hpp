// SPDX-License-Identifier: MIT
// What happens to a voice of a score, sample by sample: its controls and its strikes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "generator/player/score.hpp"

namespace contactspline {

/// The sample at a time [s], rounded.
[[nodiscard]] inline std::size_t sample_at(double time_s, double sample_rate_hz) {
  return static_cast<std::size_t>(std::llround(time_s * sample_rate_hz));
}

/// The controls of a voice, or the pedals of a score, over time.
class ControlTrack {
 public:
  ControlTrack(const Voice& voice, double sample_rate_hz)
      : ControlTrack(voice.bends ? *voice.bends : voice.glides, voice.initial, sample_rate_hz) {}
  ControlTrack(std::span<const Glide> glides, std::vector<double> initial, double sample_rate_hz)
      : glides_(glides), sample_rate_hz_(sample_rate_hz), values_(std::move(initial)), moves_(values_.size()) {}

  /// Values for a sample. Samples must be asked for by rising number.
  std::span<const double> at(std::size_t sample) {
    for (; next_ < glides_.size() && sample_at(glides_[next_].time_s, sample_rate_hz_) <= sample; ++next_)
      begin(glides_[next_], sample);
    for (std::size_t i = 0; i < moves_.size(); ++i)
      if (moves_[i].is_active) values_[i] = advance(moves_[i], sample);
    return values_;
  }

  /// Number of samples from this one, the one just asked for, in which a control stays the same; `step` while it
  /// moves.
  [[nodiscard]] std::size_t steady_samples(std::size_t sample, std::size_t control, std::size_t step = 1) const {
    if (moves_[control].is_active) return step;
    if (next_ == glides_.size()) return std::numeric_limits<std::size_t>::max();
    return sample_at(glides_[next_].time_s, sample_rate_hz_) - sample;
  }

 private:
  struct Move {
    bool is_active = false;
    std::size_t begin, length;
    double from, to;
  };

  void begin(const Glide& glide, std::size_t sample) {
    moves_[glide.control] = {true, sample, sample_at(glide.over_s, sample_rate_hz_), values_[glide.control],
                             glide.to};
  }

  // Eases in and out, so that neither place nor speed jumps.
  static double advance(Move& move, std::size_t sample) {
    move.is_active = sample < move.begin + move.length;
    if (!move.is_active) return move.to;
    const double part = static_cast<double>(sample - move.begin) / static_cast<double>(move.length);
    return move.from + (move.to - move.from) * part * part * (3 - 2 * part);  // eased(part), in this order
  }

  std::span<const Glide> glides_;
  double sample_rate_hz_;
  std::vector<double> values_;
  std::vector<Move> moves_;
  std::size_t next_ = 0;
};

/// The strikes of a voice, or its notes, and the ends of their holds, by rising sample.
template <typename Played>
class PlayedTrack {
 public:
  struct Change {
    std::size_t sample;
    const Played* strike;
    bool is_end;  ///< of its hold

    /// Of changes in one sample the lower comes first.
    [[nodiscard]] std::size_t order() const {
      if constexpr (requires { strike->begins; }) return is_end ? strike->ends : strike->begins;
      return 0;
    }
  };

  /// hold: a member of what is played, after which the hold ends.
  PlayedTrack(std::span<const Played> strikes, double sample_rate_hz, double Played::*hold = &Played::hold_s) {
    for (const Played& strike : strikes) {
      changes_.push_back({sample_at(strike.time_s, sample_rate_hz), &strike, false});
      if (std::isfinite(strike.*hold))
        changes_.push_back({sample_at(strike.time_s + strike.*hold, sample_rate_hz), &strike, true});
    }
    std::ranges::stable_sort(changes_, {},
                             [](const Change& change) { return std::pair(change.sample, change.order()); });
  }

  /// The next change up to this sample, or null.
  const Change* next_until(std::size_t sample) {
    return next_ < changes_.size() && changes_[next_].sample <= sample ? &changes_[next_++] : nullptr;
  }
  /// Number of samples from this one to the next change.
  [[nodiscard]] std::size_t samples_to_next(std::size_t sample) const {
    return next_ < changes_.size() ? changes_[next_].sample - sample : std::numeric_limits<std::size_t>::max();
  }

 private:
  std::vector<Change> changes_;
  std::size_t next_ = 0;
};
using StrikeTrack = PlayedTrack<Strike>;
using NoteTrack = PlayedTrack<Note>;

}  // namespace contactspline
