// SPDX-License-Identifier: MIT
// Templates, shipped materials, resonators, keyboards and scores, embedded at build time.
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

/// Every file of resonators/ or of keyboards/, by rising name.
[[nodiscard]] std::span<const EmbeddedText> embedded_resonators();
[[nodiscard]] std::span<const EmbeddedText> embedded_keyboards();

/// Every file of scores/, by rising name.
[[nodiscard]] std::span<const EmbeddedText> embedded_scores();

}  // namespace contactspline
