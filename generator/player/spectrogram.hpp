// SPDX-License-Identifier: MIT
// Spectrogram of a sound on a logarithmic scale of frequency.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace contactspline {

struct Spectrogram {
  std::size_t columns, rows;
  double lowest_hz, highest_hz;  ///< of the first and the last row; the rows between by equal ratios
  std::vector<double> level_db;  ///< column by column, below the loudest of all, at least -100
};

/// Levels by Hann windows of about 90 ms around the middle of `columns` equal stretches of time, from 40 Hz to 16 kHz
/// or half the sample rate. A row shows the loudest bin within it. samples: at least one; sample_rate_hz: > 0.
[[nodiscard]] Spectrogram spectrogram_of(std::span<const float> samples, double sample_rate_hz, std::size_t columns,
                                         std::size_t rows);

}  // namespace contactspline
