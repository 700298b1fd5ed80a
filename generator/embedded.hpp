// SPDX-License-Identifier: MIT
// Templates and shipped materials, embedded at build time.
#pragma once

#include <span>
#include <string_view>

namespace contactspline {

struct EmbeddedText {
  std::string_view file_name;  ///< as in templates/ or materials/
  std::string_view content;
};

/// Every file of templates/ and materials/, by rising name within each.
[[nodiscard]] std::span<const EmbeddedText> embedded_texts();

}  // namespace contactspline
