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
  bool all_forms = false;      ///< C++ headers of materials hold all forms of the derivation, as JSON does
};

/// The formats faust, cpp and json.
[[nodiscard]] std::span<const Emitter> emitters();

}  // namespace contactspline
