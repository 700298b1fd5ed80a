// SPDX-License-Identifier: MIT
// The encodings in which editors, spreadsheets and shells write text.
#pragma once

#include <string>
#include <string_view>

namespace contactspline {

/// Does the text begin with the byte order mark of UTF-16, as what PowerShell writes by `>` does?
[[nodiscard]] bool is_marked_utf_16(std::string_view text);

/// Text in UTF-8, without a byte order mark: of UTF-16, which such a mark or a zero in the first character tells, or
/// of Latin-1, which is what no UTF-8 is taken for. Characters beyond 16 bits of UTF-16 become question marks.
[[nodiscard]] std::string in_utf8(std::string_view text);

}  // namespace contactspline
