// SPDX-License-Identifier: MIT
// Output of the render commands: files, level, length limit, progress.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace contactspline {

enum class FigureFormat;  // figures.hpp

/// What every instrument of `render` writes.
struct RenderOutput {
  std::string sound;
  std::string figure;  ///< empty: the sound file's name with .svg
  bool no_figure = false;
  int sample_rate_hz = 44100;
  bool force = false;  ///< replaces files that the program did not write
};

constexpr double kPeak = 0.89;  ///< largest value in the sound file: -1 dB relative to full scale

/// The factor that brings the largest value `peak` (>= 0) to kPeak; 1 for silence.
[[nodiscard]] double scale_to_peak(double peak);

/// Throws BadInput, with `key` at the beginning of its message, if the sound has more samples than one hour at 44.1
/// kHz. The whole sound is held in memory.
void require_short(const std::string& key, double duration_s, int sample_rate_hz);

/// Throws BadInput if the sound, with these channels, or the figure cannot be written: formats, files that would be
/// replaced, a figure that is asked for without gnuplot. To be called before anything is computed.
void require_outputs(const RenderOutput& output, int channels, const std::vector<std::filesystem::path>& inputs);

/// Draws the figure of a render in a format.
using DrawFigure = std::function<std::string(FigureFormat)>;

/// Writes the sound, then draws and writes the figure. Returns two lines that name them. If a figure that was not
/// asked for cannot be drawn, a line on standard error says so; otherwise this throws BadInput.
[[nodiscard]] std::string write_outputs(const RenderOutput& output, std::string sound, const DrawFigure& draw);

/// Shows the fraction that is done (0 to 1) on standard error, if that is a terminal.
void show_progress(double fraction);

}  // namespace contactspline
