// SPDX-License-Identifier: MIT
// A material: contact law, range of impacts and the spline asked for, as read from a material file.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "generator/contact_input.hpp"
#include "generator/potential.hpp"

namespace contactspline {

/// Impacts the spline is designed for: a mass on a rigid barrier over a range of speeds.
struct Impact {
  double mass_kg;
  double max_speed_m_per_s;
  double min_speed_m_per_s;
};

/// Uniform knots: `segments` of equal width over [0, max_compression_m].
struct SplineDesign {
  int segments;
  double max_compression_m;
};

struct Material {
  std::string name;         ///< lower-case identifier; names files and code
  std::string description;  ///< one line, may be empty
  Potential contact;
  std::optional<Impact> impact;
  SplineDesign spline;
  double loss_s_per_m = 0;                   ///< Hunt-Crossley loss: force F(y) (1 + loss dy/dt)
  std::optional<Measurement> measured = {};  ///< what `contact` was smoothed from
};

/// The contact law in words, without a line end: a formula, or what was measured.
[[nodiscard]] std::string law_text(const Material& material);

/// Parses the text of a material file: JSON with comments, SI units in the key names. `file` stands in
/// messages only; `read` gives the files it names. A max_compression_m left out follows from `impact` by energy.
/// Throws BadInput: unknown, duplicate, missing, wrong-typed, non-finite and out-of-range keys are errors.
[[nodiscard]] Material parse_material(std::string_view text, std::string_view file,
                                      const ReadFile& read = shipped_file);

}  // namespace contactspline
