// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace contactspline {

/// Text in UTF-8, without a byte order mark: of UTF-16, which such a mark or a zero in the first character tells, or
/// of Latin-1, which is what no UTF-8 is taken for. Characters beyond 16 bits of UTF-16 become question marks.
[[nodiscard]] std::string in_utf8(std::string_view text);

}  // namespace contactspline
