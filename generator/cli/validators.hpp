// SPDX-License-Identifier: MIT
// Validators for option values. Their messages say what is allowed.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <concepts>
#include <filesystem>
#include <string>
#include <system_error>
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

/// I/N, two integers, I from 1 to N and N up to `max`.
[[nodiscard]] inline CLI::Validator part_of_whole(int max) {
  const auto check = [=](const std::string& text) {
    const auto slash = text.find('/');
    const auto is_digits = [](const std::string& digits) {
      return !digits.empty() && digits.size() < 10 && digits.find_first_not_of("0123456789") == std::string::npos;
    };
    if (slash != std::string::npos && is_digits(text.substr(0, slash)) && is_digits(text.substr(slash + 1))) {
      const int part = std::stoi(text), whole = std::stoi(text.substr(slash + 1));
      if (1 <= part && part <= whole && whole <= max) return std::string();
    }
    return fmt::format("'{}' is refused; allowed: I/N, such as 3/64, with I from 1 to N and N up to {}", text, max);
  };
  return {check, ""};
}

/// One of the given words.
[[nodiscard]] inline CLI::Validator one_of(std::vector<std::string> words) {
  const auto check = [words](const std::string& text) {
    if (std::ranges::find(words, text) != words.end()) return std::string();
    return fmt::format("'{}' is refused; allowed: {}", text, fmt::join(words, ", "));
  };
  return {check, fmt::format("{{{}}}", fmt::join(words, ","))};
}

/// Empty unless a path is longer than the file system takes.
[[nodiscard]] inline std::string why_too_long(const std::string& path) {
  std::error_code error;
  static_cast<void>(std::filesystem::status(path, error));
  if (error != std::errc::filename_too_long) return {};
  return fmt::format("the name has {} bytes, too many for a file system; allowed: a name of at most 255 bytes",
                     path.size());
}

/// The name of a file to write. "-" is refused, because for other options it means standard output.
[[nodiscard]] inline CLI::Validator file_name() {
  const auto check = [](const std::string& text) {
    return text.empty() || text == "-" || text.ends_with('/')
               ? fmt::format("'{}' is refused; allowed: a file name", text)
               : why_too_long(text);
  };
  return {check, ""};
}

/// The name of a folder to write to, as `allowed` says.
[[nodiscard]] inline CLI::Validator folder_name(std::string allowed) {
  const auto check = [allowed = std::move(allowed)](const std::string& text) {
    return text.empty() ? fmt::format("'' is refused; allowed: {}", allowed) : why_too_long(text);
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
