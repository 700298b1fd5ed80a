// SPDX-License-Identifier: MIT
#include "generator/support/json_syntax.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "generator/support/error.hpp"

namespace contactspline {
namespace {

/// A part of the parser's message, and what is expected there. The first that fits counts.
struct Expectation {
  std::string_view message, expected;
};

constexpr auto kValue = "a value: a number, a text in double quotes, true, false, null, { or [";

constexpr std::array kExpectations = {
    Expectation{"missing closing quote", "the double quote that ends a text"},
    Expectation{"control character", "no line end and no control character in a text"},
    Expectation{"ill-formed UTF-8", "characters in UTF-8"},
    Expectation{"BOM", "characters in UTF-8"},
    Expectation{"surrogate", "a pair of surrogates, such as \\ud83d\\ude00"},
    Expectation{"'\\u' must be followed", "four hexadecimal digits after \\u"},
    Expectation{"after backslash", "one of \" \\ / b f n r t u after a backslash"},
    Expectation{"'*/'", "*/, the end of the comment"},
    Expectation{"invalid comment", "a comment that begins with // or /*"},
    Expectation{"expected digit", "a digit"},
    Expectation{"expected '+', '-', or digit", "a digit, + or -"},
    Expectation{"object key", "a key in double quotes"},
    Expectation{"object separator", "a colon between key and value"},
    Expectation{"while parsing object", "a comma or }"},
    Expectation{"while parsing array", "a comma or ]"},
    Expectation{"; expected end of input", "the end of the file"},
};

std::string_view expected_in(std::string_view message) {
  const auto fits = [&](const Expectation& one) { return message.find(one.message) != message.npos; };
  const auto found = std::ranges::find_if(kExpectations, fits);
  return found == kExpectations.end() ? kValue : found->expected;
}

bool is_in_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

// The beginning of the text in quotes or of the word that ends at a place, or the place itself.
std::size_t token_begin(std::string_view text, std::size_t at, std::string_view message) {
  if (message.find("unexpected string literal") != message.npos) {
    do at = text.substr(0, at).rfind('"');
    while (at != text.npos && at > 0 && text[at - 1] == '\\');
    if (at == text.npos) at = 0;
  } else if (message.find("invalid literal") != message.npos || (at < text.size() && is_in_word(text[at]))) {
    while (at > 0 && is_in_word(text[at - 1])) --at;
  }
  return at;
}

std::string found_at(std::string_view text, std::size_t at) {
  if (at >= text.size()) return "the file ends";
  if (text[at] == '\0') return "a NUL byte";
  if (text[at] == '\n' || text[at] == '\r') return "the line ends";
  const auto code = static_cast<unsigned char>(text[at]);
  if (code < 0x20 || code == 0x7f) return "a control character";
  if (code > 0x7f) return "a character beyond ASCII is not expected";
  std::size_t end = at + 1;
  if (is_in_word(text[at]))
    while (end < text.size() && is_in_word(text[end])) ++end;
  return fmt::format("'{}' is not expected", text.substr(at, std::min<std::size_t>(end - at, 40)));
}

// The last character before a place that is neither a blank nor in a comment or a text; 0 if there is none.
char last_token_before(std::string_view text, std::size_t end) {
  char last = '\0';
  for (std::size_t i = 0; i < end; ++i) {
    const std::string_view rest = text.substr(i, end - i);
    if (rest.starts_with("//") || rest.starts_with("/*")) {
      const bool is_line = rest[1] == '/';
      const std::size_t behind = rest.find(is_line ? "\n" : "*/", 2);
      if (behind == rest.npos) return last;
      i += behind + (is_line ? 0 : 1);
    } else if (rest[0] == '"') {
      for (++i; i < end && text[i] != '"'; ++i)
        if (text[i] == '\\') ++i;
      last = '"';
    } else if (rest.find_first_not_of(" \t\r\n") == 0) {
      last = rest[0];
    }
  }
  return last;
}

bool is_digit_at(std::string_view text, std::size_t at) {
  return at < text.size() && text[at] >= '0' && text[at] <= '9';
}

// A decimal comma: digits on both sides of it. The number with a point, or nothing.
std::string with_decimal_point(std::string_view text, std::size_t at) {
  if (at < 2 || text[at - 1] != ',' || !is_digit_at(text, at) || !is_digit_at(text, at - 2)) return {};
  std::size_t begin = at - 1, end = at;
  while (begin > 0 && is_digit_at(text, begin - 1)) --begin;
  while (is_digit_at(text, end)) ++end;
  constexpr std::size_t kMost = 20;
  return end - begin > kMost ? "1.5"
                             : fmt::format("{}.{}", text.substr(begin, at - 1 - begin), text.substr(at, end - at));
}

/// What is wrong and what is expected behind a comma: the last one of an object or an array, or a decimal comma.
struct BehindComma {
  std::string_view wrong;
  std::string allowed;
};

BehindComma behind_comma(std::string_view text, std::size_t at, std::string_view expected) {
  if (const std::string number = with_decimal_point(text, at); !number.empty())
    return {" behind a comma", fmt::format("a decimal point, as in {}, or {}", number, expected)};
  if (at >= text.size() || (text[at] != '}' && text[at] != ']') || last_token_before(text, at) != ',')
    return {"", std::string(expected)};
  return {" behind a comma", fmt::format("{}, or no comma", expected)};
}

}  // namespace

bool is_something_else(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r\n");
  if (begin == text.npos) return false;
  const auto first = static_cast<unsigned char>(text[begin]);  // from 0x80 on: maybe the mark of UTF-8 or UTF-16
  return first > 0x20 && first < 0x7f && first != '{' && first != '/';
}

void refuse_syntax(std::string_view text, std::string_view file, std::size_t at, std::string_view message) {
  at = token_begin(text, std::min(at, text.size()), message);
  const std::string_view before = text.substr(0, at);
  const auto line = 1 + std::ranges::count(before, '\n');
  const auto column = at - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0
  // Another file may name it: nothing of it is shown.
  if (is_something_else(text)) refuse(file, "file", "is not a JSON object", "a file that begins with {");
  const auto [wrong, allowed] = behind_comma(text, at, expected_in(message));
  refuse(file, fmt::format("line {}, column {}", line, column), found_at(text, at) + std::string(wrong), allowed);
}

}  // namespace contactspline
