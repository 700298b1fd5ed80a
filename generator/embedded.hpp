// SPDX-License-Identifier: MIT
// Templates, shipped materials and resonators, embedded at build time.
#pragma once

#include <span>
#include <string_view>

namespace contactspline {

struct EmbeddedText {
  std::string_view file_name;  ///< without its folder
  std::string_view content;
};

/// Every file of templates/ and materials/, by rising name within each.
[[nodiscard]] std::span<const EmbeddedText> embedded_texts();

/// Every file of resonators/, by rising name.
[[nodiscard]] std::span<const EmbeddedText> embedded_resonators();

}  // namespace contactspline
