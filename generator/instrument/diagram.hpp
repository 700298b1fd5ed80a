// SPDX-License-Identifier: MIT
// The drawing of an instrument: its bodies, places and connections, as lines, dots and labels.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "generator/instrument/instrument.hpp"

namespace contactspline {

/// What a line or a label of a diagram is for.
enum class DiagramPart { kContact, kSpring, kLink, kFriction, kSupport, kBody, kTable, kPlace };

/// "contact", "spring", "link", "support", "body", "table" or "place".
[[nodiscard]] std::string_view name_of(DiagramPart part);

/// x: 0 to 1 from left to right. y: rows of bodies, from below.
struct DiagramPoint {
  double x, y;
};

struct DiagramLine {
  DiagramPoint from, to;
  DiagramPart part;
};

/// A point of a place, or a mass.
struct DiagramDot {
  DiagramPoint at;
  bool is_mass;
};

/// That of a body begins at its point; the others have their middle there.
struct DiagramLabel {
  DiagramPoint at;
  std::string text;
  DiagramPart part;
};

/// The room that a diagram has, in points of the screen, with labels in a font of 12.
struct DiagramSize {
  double width, height;
};

struct Diagram {
  double bottom, top;  ///< of the y in view
  std::vector<DiagramLine> lines;
  std::vector<DiagramDot> dots;
  std::vector<DiagramLabel> labels;
};

/// A row for each body from the top, with its places to scale. What the ground holds ends at a bar below its body.
/// Labels lie beside lines and beside each other where the size has room for it.
[[nodiscard]] Diagram diagram_of(const InstrumentModel& model, DiagramSize size);

}  // namespace contactspline
