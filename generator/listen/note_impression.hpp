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
  std::vector<double> freedom;    ///< of each band: noise in it scatters like the mean of so many powers
  std::vector<double> power;      ///< frame by frame, of each band
  std::vector<double> noise;      ///< of each band before the note; 0 where nothing was recorded there
  double noise_frames = 0;        ///< so many frames were recorded there
  std::vector<Partial> partials;  ///< by falling level

  [[nodiscard]] double loudest() const;
};

struct Sound {
  std::span<const double> samples;
  double sample_rate_hz;
  double recorded_rate_hz;  ///< of the recording that it is compared with, which has nothing above half of it
};

/// The impression of a note from 3 ms before its onset on, over so many seconds or to the end of the samples: by Hann
/// windows of about 46 ms, a quarter of that apart, in triangular bands from 60 Hz to 16 kHz or 0.45 of the recorded
/// rate. The partials are the peaks of the spectrum of the 0.4 s from 20 ms after the onset on, with a Hann window,
/// that are at most `depth_db` below the highest and stand 12 dB out of what is beside them; at most `max_partials`.
/// Hum, which sounds as loud in the 0.1 s or more before the note, is none of them.
[[nodiscard]] NoteImpression impression_of(const Sound& sound, double seconds, double depth_db,
                                           std::size_t max_partials);

/// How a rendered note differs from a recorded one.
struct NoteDifference {
  std::vector<double> level_db;  ///< of each frame and band: recorded less what is expected of the rendered one
  std::vector<double> noise_db;  ///< so much the noise of the recording scatters each of them
  std::vector<double> cents;     ///< rendered to recorded: of each recorded partial, to the nearest rendered one
};

/// Notes that are compared, with the weight of each frame and band in the least squares of a gain; empty: all alike.
struct ComparedNotes {
  std::span<const NoteImpression> recorded, rendered;
  std::span<const std::vector<double>> weights;
};

/// The gain [dB] that brings rendered notes nearest to recorded ones, in the least squares of their levels. Not all
/// of them may be silent.
[[nodiscard]] double gain_between(const ComparedNotes& notes);

/// With this gain. The noise of the recording and its floor are added to what is rendered, and the level expected of
/// the sum is the mean of its logarithm. An impression without partials is two octaves from all.
[[nodiscard]] NoteDifference compare(const NoteImpression& recorded, const NoteImpression& rendered, double gain_db);

/// The mean of the absolute differences of level [dB] without frames and bands that both notes have below the floor,
/// and what noise alone leaves of it.
struct LevelDistance {
  double all_db, noise_db;
};
[[nodiscard]] LevelDistance level_distance(const NoteImpression& recorded, const NoteImpression& rendered,
                                           double gain_db);

}  // namespace contactspline
