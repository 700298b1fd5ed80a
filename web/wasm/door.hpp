// SPDX-License-Identifier: MIT
// How the page calls a module: plain C functions. Texts cross as UTF-8 in the module's memory.
#pragma once

#include <cstddef>
#include <string>

/// Exports a function under its own name.
#define CONTACTSPLINE_WEB(result, name, ...) extern "C" __attribute__((export_name(#name))) result name(__VA_ARGS__)

namespace contactspline::web {

/// A text that stays in memory until the next call; the page reads it up to the terminating zero.
inline const char* keep(std::string text) {
  static std::string kept;
  kept = std::move(text);
  return kept.c_str();
}

}  // namespace contactspline::web
