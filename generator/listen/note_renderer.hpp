// SPDX-License-Identifier: MIT
// Renders the notes of a recorded instrument with numbers in place of its open ones, as impressions.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "generator/listen/note_impression.hpp"
#include "generator/listen/recorded_instrument.hpp"
#include "generator/spline/designed_materials.hpp"

namespace contactspline {

/// The impressions of all notes with the same numbers; nothing where the instrument cannot be made or played with
/// them.
using RenderedNotes = std::optional<std::vector<NoteImpression>>;

/// A note of the instrument, and the numbers in place of the open ones.
struct NoteToRender {
  std::size_t note;
  std::vector<double> point;
};

class NoteRenderer {
 public:
  /// Both must outlive it.
  NoteRenderer(const RecordedInstrument& recorded, const ReadFile& read);

  /// The impression of each, on all cores, at the rate of its recording; nothing where it cannot be made or played.
  [[nodiscard]] std::vector<std::optional<NoteImpression>> render(std::span<const NoteToRender> notes) const;

  /// The impressions of these notes with each of the points.
  [[nodiscard]] std::vector<RenderedNotes> render(std::span<const std::vector<double>> points,
                                                  std::span<const std::size_t> notes) const;

  /// The same with one point. Throws BadInput where the instrument cannot be made, a key does not play, or what is
  /// rendered is silent.
  [[nodiscard]] std::vector<NoteImpression> render_one(const std::vector<double>& point,
                                                       std::span<const std::size_t> notes) const;

 private:
  const RecordedInstrument& recorded_;
  ReadFile read_;  ///< beside the instrument file
  std::unique_ptr<DesignedMaterials> materials_;
};

}  // namespace contactspline
