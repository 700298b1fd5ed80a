// SPDX-License-Identifier: MIT
// What is compared of a note: levels in bands of the mel scale over time, and the frequencies of its partials.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace contactspline {

struct Partial {
  double frequency_hz, level_db;
};

struct NoteImpression {
  static constexpr std::size_t kBands = 48;
  static constexpr double kFloor_db = -60;  ///< of the loudest power: what is softer counts as much

  double frame_s;                 ///< between frames
  std::vector<double> band_hz;    ///< middles of the bands
  std::vector<double> power;      ///< frame by frame, of each band
  std::vector<double> noise;      ///< of each band before the note; 0 where nothing was recorded there
  std::vector<Partial> partials;  ///< by falling level

  [[nodiscard]] double loudest() const;
};

/// When a note begins [s]: its power over 5 ms reaches 0.01 of its largest. samples: not all 0.
[[nodiscard]] double onset_of(std::span<const double> samples, double sample_rate_hz);

/// The impression of a note from 3 ms before its onset on, over so many seconds or to the end of the samples: by Hann
/// windows of about 46 ms, a quarter of that apart, in triangular bands from 60 Hz to 16 kHz or 0.45 of the sample
/// rate. The partials are the peaks of the spectrum of the 0.4 s from 20 ms after the onset on, with a Hann window,
/// that are at most `depth_db` below the highest and stand 12 dB out of what is beside them; at most `max_partials`.
[[nodiscard]] NoteImpression impression_of(std::span<const double> samples, double sample_rate_hz, double seconds,
                                           double depth_db, std::size_t max_partials);

/// How a rendered note differs from a recorded one.
struct NoteDifference {
  std::vector<double> level_db;  ///< recorded less rendered, of each frame and band
  std::vector<double> cents;     ///< rendered to recorded: of each recorded partial, to the nearest rendered one
};

/// The gain [dB] that brings rendered notes nearest to recorded ones, in the least squares of their levels. Not all
/// of them may be silent.
[[nodiscard]] double gain_between(std::span<const NoteImpression* const> recorded,
                                  std::span<const NoteImpression* const> rendered);

/// With this gain. To what is rendered are added the noise of the recording and its floor. An impression without
/// partials is two octaves from all.
[[nodiscard]] NoteDifference compare(const NoteImpression& recorded, const NoteImpression& rendered, double gain_db);

/// The mean of the absolute differences of level [dB], without what both have below the floor.
[[nodiscard]] double distance_db(const NoteImpression& recorded, const NoteImpression& rendered, double gain_db);

}  // namespace contactspline
