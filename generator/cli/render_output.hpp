// SPDX-License-Identifier: MIT
// What the render commands have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace contactspline {

constexpr double kPeak = 0.89;  ///< of the sound written, -1 dB below full scale

/// What brings a largest value to kPeak; 1 for silence.
[[nodiscard]] double scale_to_peak(double peak);

/// Throws BadInput, beginning with `key`, where more than an hour at 44.1 kHz is asked for: it is held in memory.
void require_short(const std::string& key, double duration_s, int sample_rate_hz);

/// The picture's file: `svg`, or where that is empty the sound's name with .svg.
[[nodiscard]] std::string picture_beside(const std::string& sound, const std::string& svg);

/// Shows the part done on a terminal, where somebody watches.
void show_progress(double part);

/// Adds -o and --svg.
void add_outputs(CLI::App& command, std::string& sound, std::string& svg);

/// Adds hammer-string, slide-string and fret-string below `render`.
void add_render_score(CLI::App& render);

}  // namespace contactspline
