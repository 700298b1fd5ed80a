// SPDX-License-Identifier: MIT
// The output formats of `generate`.
#pragma once

#include <span>
#include <string_view>

namespace contactspline {

/// One output format.
struct Emitter {
  std::string_view name;       ///< the word for --emit
  std::string_view extension;  ///< the written file and its template end with it
};

/// The formats faust, cpp and json.
[[nodiscard]] std::span<const Emitter> emitters();

}  // namespace contactspline
