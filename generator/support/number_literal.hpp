// SPDX-License-Identifier: MIT
// Numbers as text. C++, Faust and JSON read them back to the same bits.
#pragma once

#include <span>
#include <string>

namespace contactspline {

/// The shortest decimal number that reads back to exactly `value`; it always has a point or an exponent. Throws
/// std::domain_error if the value is not finite.
[[nodiscard]] std::string literal(double value);

/// `value` rounded to `digits` significant decimal digits; 0 if the result is subnormal.
[[nodiscard]] double rounded_to(double value, int digits);

/// The literals of `values`, separated by commas, wrapped at 110 columns and indented by `indent` spaces.
[[nodiscard]] std::string literal_rows(std::span<const double> values, int indent);

}  // namespace contactspline
