// SPDX-License-Identifier: MIT
// The single entry from a material to its spline: all code that needs a spline calls design_spline() or
// design_material().
#pragma once

#include <optional>
#include <string_view>

#include "generator/material/material_reader.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/spectrum_error.hpp"
#include "generator/spline/spline_error.hpp"

namespace contactspline {

/// A material with its spline and the measured errors of the spline, to be emitted, inspected or drawn.
struct Design {
  Material material;
  Spline spline;
  Quality quality;
  std::optional<SpectrumError> spectrum;  ///< error of the impacts' force (measure_spectrum)
};

/// Designs the spline of a material. If the material has a tolerance, sets its `segments` to the smallest number that
/// meets it, found by bisection and a search of some smaller numbers. Throws BadInput, with `file` in its message, if
/// no number meets the tolerance, if the spline is not convex or leaves the range of double, or if its compensation
/// cannot be designed.
[[nodiscard]] Spline design_spline(Material& material, std::string_view file);

/// The same, with the errors of the spline.
[[nodiscard]] Design design_material(Material material, std::string_view file);

/// Parses the text of a material file and designs its spline. `read` reads the files that the material names. Throws
/// BadInput.
[[nodiscard]] Design design_material(std::string_view text, std::string_view file,
                                     const ReadFile& read = shipped_file);

}  // namespace contactspline
