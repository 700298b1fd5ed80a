// SPDX-License-Identifier: MIT
// A material: contact law, range of impacts and the spline asked for, as read from a material file.
#pragma once

#include <optional>
#include <string>
#include <string_view>

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
  PowerLaw contact;
  std::optional<Impact> impact;
  SplineDesign spline;
};

/// Parses the text of a material file: JSON with comments, SI units in the key names. `file` stands in
/// messages only. A max_compression_m left out follows from `impact` by energy. Throws BadInput: unknown, duplicate,
/// missing, wrong-typed, non-finite and out-of-range keys are errors.
[[nodiscard]] Material parse_material(std::string_view text, std::string_view file);

}  // namespace contactspline
