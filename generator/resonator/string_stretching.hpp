// SPDX-License-Identifier: MIT
// How a string stretches where it moves far, also along itself.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/mode.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/data/stretch_form.hpp"

namespace contactspline {

/// A string between rigid supports whose strain at x is the slope of its longitudinal displacement plus half of the
/// square of that of its transverse one (G. F. Carrier, Quarterly of Applied Mathematics 3, 1945; B. Bank and L.
/// Sujbert, J. Acoust. Soc. Am. 117, 2005). axial_stiffness_n: Young's modulus times section, E S.
struct StretchingString {
  StiffString string;
  double axial_stiffness_n;
  std::size_t longitudinal = 0;  ///< number of longitudinal modes that move; more are in equilibrium at any time
  Losses longitudinal_losses = {};
};

/// The lowest longitudinal modes, of shapes sin(m pi x/length) and frequencies m/(2 length) sqrt(E S length/mass).
/// Empty if one of them is overdamped.
[[nodiscard]] std::vector<Mode> longitudinal_modes(const StretchingString& string);

/// Its forms: of the even strain, then one for each longitudinal mode m, which couples the transverse modes whose
/// numbers have m for sum or difference. Of a body with transverse modes of these numbers (1, 2, ...), then the
/// longitudinal ones. With s_m of all forms the strain at x is sum over m >= 0 of s_m cos(m pi x/length)/4.
[[nodiscard]] std::vector<StretchForm> stretch_forms(const StretchingString& string, std::span<const int> numbers);

/// What form m adds to the tension at the end x = length, for s_m = 1 [N].
[[nodiscard]] double end_tension_n(const StretchingString& string, std::size_t form);

}  // namespace contactspline
