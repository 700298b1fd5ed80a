// SPDX-License-Identifier: MIT
// The levels of the partials of a recorded note.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "generator/fit/measurements.hpp"

namespace contactspline {

struct RecordedSound {
  double sample_rate_hz;
  std::vector<double> samples;  ///< full scale is 1
};

/// Decodes a sound file: what libsndfile reads, the mean of its channels. Throws BadInput, also for more channels and
/// where they cancel.
[[nodiscard]] RecordedSound read_recording(std::string_view bytes, const std::string& file, int max_channels = 1);

/// When a note begins [s]: its power over 5 ms reaches 0.01 of its largest. samples: not all 0.
[[nodiscard]] double onset_of(std::span<const double> samples, double sample_rate_hz);

/// Throws BadInput if a recording is silent or saturated.
void require_sounding(const RecordedSound& recording, const std::string& file);

/// Takes the mean of the samples away. Throws BadInput if they are silent or saturated, or if something sounds before
/// the note: between it and the loudest 10 ms the level falls 30 dB below those.
void require_one_sound(RecordedSound& recording, const std::string& file);

/// The levels of `partials` (places among the modes) or, without them, of all those with output that stand 20 dB out
/// of what is beside them and below 0.45 of the sample rate. Each is measured at the peak of the spectrum within 3 %
/// of its mode's frequency, in a Hann window that begins 10 ms after the onset and holds 8 periods of the lowest
/// mode, 0.1 s or more; and is counted back to the onset by the mode's decay. Throws BadInput if the recording is
/// silent, saturated or too short, or if a chosen partial is not in it.
[[nodiscard]] std::vector<Blow::Level> levels_of(const RecordedSound& recording, const std::string& file,
                                                 const StruckResonator& struck,
                                                 const std::optional<std::vector<std::size_t>>& partials);

}  // namespace contactspline
