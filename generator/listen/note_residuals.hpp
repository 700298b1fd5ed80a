// SPDX-License-Identifier: MIT
// Residuals of rendered notes beside recorded ones, as a search makes them small.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "generator/listen/note_impression.hpp"

namespace contactspline {

/// What residuals are divided by, and where differences begin to count less.
struct ResidualScales {
  double level_db = 3;     ///< of a residual of 1
  double cents = 3;        ///< the same
  double far_db = 30;      ///< differences of level beyond count by their root
  double far_cents = 400;  ///< differences of partials beyond count as much as this one
};

/// Residuals of all notes, each with its group. Those of a group may depend on each other: four neighbouring bands of
/// a note at all times, or a partial.
struct Residuals {
  std::vector<double> values;
  std::vector<std::size_t> groups;
  std::size_t group_count = 0;
};

/// recorded and rendered: of each note; with one gain for each note or one for all.
[[nodiscard]] Residuals residuals_of(std::span<const NoteImpression> recorded,
                                     std::span<const NoteImpression> rendered, bool has_common_gain,
                                     const ResidualScales& scales);

/// How many residuals there are of these recordings.
[[nodiscard]] std::size_t count_residuals(std::span<const NoteImpression> recorded);

/// The gain of each note [dB].
[[nodiscard]] std::vector<double> gains_of(std::span<const NoteImpression> recorded,
                                           std::span<const NoteImpression> rendered, bool has_common_gain);

/// Scales by which the residuals of levels and those of partials have a mean square of 1 each.
[[nodiscard]] ResidualScales scales_of(std::span<const NoteImpression> recorded,
                                       std::span<const NoteImpression> rendered, bool has_common_gain,
                                       const ResidualScales& before);

}  // namespace contactspline
