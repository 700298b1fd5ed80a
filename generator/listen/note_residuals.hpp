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
  std::vector<std::vector<double>> level_db = {};  ///< of each note, frame and band; empty: 3
  double cents = 3;
  double far_levels = 10;  ///< differences of level beyond so many scales count by their root
  double far_cents = 400;  ///< differences of partials beyond count as much as this one
};

/// Notes that are recorded, with one gain for each or one for all, and how their residuals are scaled.
struct NotesToMatch {
  std::vector<NoteImpression> recorded;
  bool has_common_gain = false;
  ResidualScales scales = {};
};

/// Residuals of all notes, each with its group. Those of a group may depend on each other: four neighbouring bands of
/// a note at all times, or a partial.
struct Residuals {
  std::vector<double> values;
  std::vector<std::size_t> groups;
  std::size_t group_count = 0;
};

[[nodiscard]] Residuals residuals_of(const NotesToMatch& notes, std::span<const NoteImpression> rendered);

/// How many residuals there are.
[[nodiscard]] std::size_t count_residuals(const NotesToMatch& notes);

/// The gain of each note [dB].
[[nodiscard]] std::vector<double> gains_of(const NotesToMatch& notes, std::span<const NoteImpression> rendered);

/// Sets the scales: of each level the scatter by noise and one more that all have, the likeliest; of partials the one
/// by which their residuals have a mean square of 1.
void set_scales(NotesToMatch& notes, std::span<const NoteImpression> rendered);

}  // namespace contactspline
