// SPDX-License-Identifier: MIT
// Validators for option values. Their messages say what is allowed.
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

/// A number from `min` to `max`. Unlike CLI::Range it refuses NaN.
template <typename T>
[[nodiscard]] CLI::Validator number_from(T min, T max) {
  const auto check = [=](const std::string& text) {
    T value{};
    if (CLI::detail::lexical_cast(text, value) && value >= min && value <= max) return std::string();
    return fmt::format("'{}' is refused; allowed: {} from {} to {}", text,
                       std::integral<T> ? "an integer" : "a number", min, max);
  };
  return {check, fmt::format("{} to {}", min, max)};
}

/// A number from `min` to `max`, or a word.
[[nodiscard]] inline CLI::Validator number_or(const char* word, double min, double max) {
  const auto check = [=, number = number_from(min, max)](const std::string& text) mutable {
    std::string copy = text;
    if (text == word || number(copy).empty()) return std::string();
    return fmt::format("'{}' is refused; allowed: {}, or a number from {} to {}", text, word, min, max);
  };
  return {check, fmt::format("{} or {} to {}", word, min, max)};
}

/// One of the given words.
[[nodiscard]] inline CLI::Validator one_of(std::vector<std::string> words) {
  const auto check = [words](const std::string& text) {
    if (std::ranges::find(words, text) != words.end()) return std::string();
    return fmt::format("'{}' is refused; allowed: {}", text, fmt::join(words, ", "));
  };
  return {check, fmt::format("{{{}}}", fmt::join(words, ","))};
}

/// The name of a file to write. "-" is refused, because for other options it means standard output.
[[nodiscard]] inline CLI::Validator file_name() {
  const auto check = [](const std::string& text) {
    return text.empty() || text == "-" || text.ends_with('/')
               ? fmt::format("'{}' is refused; allowed: a file name", text)
               : std::string();
  };
  return {check, ""};
}

/// Any text except an empty one.
[[nodiscard]] inline CLI::Validator not_empty(std::string allowed) {
  const auto check = [allowed = std::move(allowed)](const std::string& text) {
    return text.empty() ? fmt::format("'' is refused; allowed: {}", allowed) : std::string();
  };
  return {check, ""};
}

}  // namespace contactspline
