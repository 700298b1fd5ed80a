// SPDX-License-Identifier: MIT
// How loud, and how far to a side, a MIDI file wants an instrument among others.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "generator/player/midi_file.hpp"

namespace contactspline {

/// What the sides of an instrument are multiplied by from a time on.
struct MixGains {
  double time_s;
  double left, right;
};

/// What volume (7), expression (11) and pan (10) of an instrument's channels, 1 to 16, ask for, as General MIDI has
/// it: volume and expression by their squares, pan by the cosine and the sine of an angle. 1 at first and at volume
/// 100, expression 127, pan 64. A reset of controllers brings expression back, one of the system all three. Of
/// several channels the latest message counts. Controllers that are not `free`, because they move a parameter of the
/// instrument, do not mix. By rising time; empty where nothing differs from 1.
[[nodiscard]] std::vector<MixGains> mix_of(std::span<const MidiFileMessage> messages, std::span<const int> channels,
                                           const std::function<bool(int controller)>& free);

/// The gains at any sample, which glide to each other with a time constant of 5 ms. Ask by rising time.
class MixGlide {
 public:
  MixGlide(std::span<const MixGains> gains, double sample_rate_hz);

  struct Sides {
    double left = 1, right = 1;
  };
  /// Those of the next sample.
  [[nodiscard]] Sides next();

 private:
  std::span<const MixGains> gains_;  // that are to come
  double sample_rate_hz_, part_;
  std::size_t sample_ = 0;
  Sides now_, wanted_;
};

}  // namespace contactspline
