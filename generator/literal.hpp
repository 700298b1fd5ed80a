// SPDX-License-Identifier: MIT
// Numbers as text that C++, Faust and JSON read back to the same bits.
#pragma once

#include <span>
#include <string>

namespace contactspline {

/// Shortest decimal that reads back to exactly `value`, always with a point or an exponent. Throws std::domain_error
/// where value is not finite.
[[nodiscard]] std::string literal(double value);

/// `value` rounded to so many significant decimal digits; 0 where that is below the normal numbers.
[[nodiscard]] double rounded_to(double value, int digits);

/// Literals of `values` separated by commas, wrapped at 110 columns and indented by `indent` spaces.
[[nodiscard]] std::string literal_rows(std::span<const double> values, int indent);

}  // namespace contactspline
