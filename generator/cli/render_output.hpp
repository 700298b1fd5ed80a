// SPDX-License-Identifier: MIT
// Output of the render commands: level, length limit, figure file, progress.
#pragma once

#include <string>

namespace contactspline {

/// What every instrument of `render` writes.
struct RenderOutput {
  std::string sound;
  std::string svg;  ///< empty: the sound file's name with .svg
  int sample_rate_hz = 44100;
  bool force = false;  ///< replaces files that the program did not write
};

constexpr double kPeak = 0.89;  ///< largest value in the sound file: -1 dB relative to full scale

/// The factor that brings the largest value `peak` (>= 0) to kPeak; 1 for silence.
[[nodiscard]] double scale_to_peak(double peak);

/// Throws BadInput, with `key` at the beginning of its message, if the sound has more samples than one hour at 44.1
/// kHz. The whole sound is held in memory.
void require_short(const std::string& key, double duration_s, int sample_rate_hz);

/// The file of the figure: the one that was given, or the name of the sound file with .svg.
[[nodiscard]] std::string figure_file(const RenderOutput& output);

/// Shows the fraction that is done (0 to 1) on standard error, if that is a terminal.
void show_progress(double fraction);

}  // namespace contactspline
