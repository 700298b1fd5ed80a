// SPDX-License-Identifier: MIT
// Errors in the syntax of a JSON text, in plain words.
#pragma once

#include <cstddef>
#include <string_view>

namespace contactspline {

/// Is a text no JSON object, but something else, such as a table or a recording?
[[nodiscard]] bool is_something_else(std::string_view text);

/// Throws BadInput that names line and column, what stands there and what is expected. `at`: index of the character
/// where the parser stopped; the size of the text at its end. `message`: what the parser says of it.
[[noreturn]] void refuse_syntax(std::string_view text, std::string_view file, std::size_t at,
                                std::string_view message);

}  // namespace contactspline
