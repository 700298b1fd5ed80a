// SPDX-License-Identifier: MIT
// How the page calls a module: plain C functions. Texts cross as UTF-8 in the module's memory.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// Exports a function under its own name.
#define CONTACTSPLINE_WEB(result, name, ...) extern "C" __attribute__((export_name(#name))) result name(__VA_ARGS__)

namespace contactspline::web {

/// A text that stays in memory until the next call; the page reads it up to the terminating zero.
inline const char* keep(std::string text) {
  static std::string kept;
  kept = std::move(text);
  return kept.c_str();
}

/// A text as a string of JSON.
inline std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + "\"";
}

}  // namespace contactspline::web
