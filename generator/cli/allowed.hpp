// SPDX-License-Identifier: MIT
// Checks of option values that say what is allowed.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <concepts>
#include <string>
#include <utility>
#include <vector>

namespace contactspline {

/// A number from `least` to `most`. NaN is none, though CLI::Range lets it pass.
template <typename T>
[[nodiscard]] CLI::Validator number_from(T least, T most) {
  const auto check = [=](const std::string& text) {
    T value{};
    if (CLI::detail::lexical_cast(text, value) && value >= least && value <= most) return std::string();
    return fmt::format("'{}' is refused; allowed: {} from {} to {}", text,
                       std::integral<T> ? "an integer" : "a number", least, most);
  };
  return {check, fmt::format("{} to {}", least, most)};
}

/// One of some words.
[[nodiscard]] inline CLI::Validator one_of(std::vector<std::string> words) {
  const auto check = [words](const std::string& text) {
    if (std::ranges::find(words, text) != words.end()) return std::string();
    return fmt::format("'{}' is refused; allowed: {}", text, fmt::join(words, ", "));
  };
  return {check, fmt::format("{{{}}}", fmt::join(words, ","))};
}

/// The name of a file to write; not the "-" that elsewhere means standard output.
[[nodiscard]] inline CLI::Validator file_name() {
  const auto check = [](const std::string& text) {
    return text.empty() || text == "-" || text.ends_with('/')
               ? fmt::format("'{}' is refused; allowed: a file name", text)
               : std::string();
  };
  return {check, ""};
}

/// Any text but the empty one.
[[nodiscard]] inline CLI::Validator not_empty(std::string allowed) {
  const auto check = [allowed = std::move(allowed)](const std::string& text) {
    return text.empty() ? fmt::format("'' is refused; allowed: {}", allowed) : std::string();
  };
  return {check, ""};
}

}  // namespace contactspline
