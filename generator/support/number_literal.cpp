// SPDX-License-Identifier: MIT
#include "generator/support/number_literal.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <system_error>

namespace contactspline {

std::string literal(double value) {
  if (!std::isfinite(value)) throw std::domain_error("literal: value is not finite");
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

double rounded_to(double value, int digits) {
  const std::string text = fmt::format("{:.{}e}", value, digits - 1);
  double nearest = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), nearest);
  return result.ec == std::errc() && std::isnormal(nearest) ? nearest : 0.0;
}

std::string literal_rows(std::span<const double> values, int indent) {
  constexpr std::size_t kColumns = 110;
  const std::string margin(static_cast<std::size_t>(indent), ' ');
  std::string rows = margin;
  std::size_t row_start = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string text = literal(values[i]) + (i + 1 < values.size() ? "," : "");
    if (rows.size() - row_start + 1 + text.size() > kColumns) {
      row_start = rows.size() + 1;
      rows += "\n" + margin;
    } else if (i > 0) {
      rows += ' ';
    }
    rows += text;
  }
  return rows;
}

}  // namespace contactspline
