// SPDX-License-Identifier: MIT
// Output of the render commands: files, level, length limit, progress.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace contactspline {

enum class FigureFormat;  // figure_file.hpp

/// What every instrument of `render` writes.
struct RenderOutput {
  std::string sound;   ///< empty: default_sound() of what is played
  std::string figure;  ///< empty: the sound file's name with .svg
  bool no_figure = false;
  int sample_rate_hz = 44100;
  std::optional<int> oversampling = {};  ///< the models run at so many times the rate; empty: as a score says, or 1
  int bits = 24;                         ///< of a sample: 16, 24, or 32 of single precision
  std::optional<double> level_db = {};   ///< of the peak, relative to full scale; empty: kPeak
  std::optional<double> gain_db = {};    ///< in place of a level: relative to a full scale of 1 SI unit
  bool force = false;                    ///< replaces files that the program did not write

  [[nodiscard]] int model_rate_hz() const { return sample_rate_hz * oversampling.value_or(1); }
};

constexpr double kPeak = 0.89;  ///< largest value in the sound file: -1 dB relative to full scale

/// NAME.wav in the working folder for a name that ships, a file NAME.json or NAME.mid. Throws BadInput for standard
/// input, which has no name.
[[nodiscard]] std::string default_sound(const std::string& played);

constexpr double kHighPass_hz = 25;  ///< below the lowest tone of a piano, 27.5 Hz

/// Butterworth high-pass of sixth order at kHighPass_hz. It takes away what moves a loudspeaker and no ear: the
/// static part of forces and displacements, and what controls move slowly.
void high_pass(std::span<float> interleaved, int channels, double sample_rate_hz);
void high_pass(std::span<double> interleaved, int channels, double sample_rate_hz);

/// Fades the last 10 ms of a sound, or its second half if it is shorter than 20 ms, to 0 by a raised cosine.
void fade_end(std::span<float> interleaved, int channels, double sample_rate_hz);
void fade_end(std::span<double> samples, double sample_rate_hz);

/// The factor from SI units to samples: the gain, or what brings the largest sample to the level; 1 for silence. If
/// samples exceed full scale, a line on standard error counts them.
[[nodiscard]] double scale_of(const RenderOutput& output, std::span<const float> samples);
[[nodiscard]] double scale_of(const RenderOutput& output, std::span<const double> samples);

/// If samples exceed full scale after scaling, a line on standard error counts them.
void report_clipping(const std::string& file, std::span<const float> samples, double scale);

/// How long a sound may be: an hour at 44.1 kHz. The whole sound is held in memory.
[[nodiscard]] double longest_sound_s(int sample_rate_hz);

/// Throws BadInput, with `key` at the beginning of its message, if the sound is longer.
void require_short(const std::string& key, double duration_s, int sample_rate_hz);

/// Throws BadInput if the sound, with these channels, the figure or the stems cannot be written: formats, files that
/// would be replaced, a figure that is asked for without gnuplot. To be called before anything is computed.
void require_outputs(const RenderOutput& output, int channels, const std::vector<std::filesystem::path>& inputs,
                     const std::vector<std::filesystem::path>& stems = {});

/// Draws the figure of a render in a format.
using DrawFigure = std::function<std::string(FigureFormat)>;

/// Writes the sound, then draws and writes the figure. Returns two lines that name them. If a figure that was not
/// asked for cannot be drawn, a line on standard error says so; otherwise this throws BadInput.
[[nodiscard]] std::string write_outputs(const RenderOutput& output, std::string sound, const DrawFigure& draw);

/// Shows the fraction that is done (0 to 1) on standard error, if that is a terminal.
void show_progress(double fraction);

}  // namespace contactspline
