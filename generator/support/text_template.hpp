// SPDX-License-Identifier: MIT
// Templates with @KEY@ placeholders.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace contactspline {

using TemplateValues = std::map<std::string, std::string, std::less<>>;

/// The text of templates/KIND.EXTENSION.in. Throws std::logic_error if it does not exist.
[[nodiscard]] std::string_view emitted_template(std::string_view kind, std::string_view extension);

/// `text` with every @KEY@ (upper case, digits, _) replaced by its value. Throws std::logic_error, with the key in
/// its message, if a key has no value or a value is not used.
[[nodiscard]] std::string fill_template(std::string_view text, const TemplateValues& values);

}  // namespace contactspline
