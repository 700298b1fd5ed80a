// SPDX-License-Identifier: MIT
// Regular expressions, as in ECMAScript. <regex> takes seconds in each file that uses it, so one file does for all.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace contactspline::testing {

using Groups = std::vector<std::string>;  ///< [0] is the whole match

/// All matches of `expression` in `text`, in order.
std::vector<Groups> matches_of(const std::string& text, const std::string& expression);

/// The first match of `expression` in `text`.
std::optional<Groups> first_match(const std::string& text, const std::string& expression);

/// The groups of `expression` if it describes all of `text`.
std::optional<Groups> whole_match(const std::string& text, const std::string& expression);

/// `text` with each match of `expression` replaced; $1 stands for its first group.
std::string replaced(const std::string& text, const std::string& expression, const std::string& with);

}  // namespace contactspline::testing
