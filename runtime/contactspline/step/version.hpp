// SPDX-License-Identifier: MIT
// The version of the library, and that of the layout of emitted structs.
#pragma once

#include "contactspline/step/cpp20.hpp"

namespace contactspline {

// The one place of the project's version: cmake/Version.cmake reads these three lines.
inline constexpr int kVersionMajor = 0;
inline constexpr int kVersionMinor = 2;
inline constexpr int kVersionPatch = 0;

/// The layout of emitted structs. `contactspline generate` writes it into each of them as format_version. Raise it
/// when a member that the runtime reads is added, renamed, removed or changes its meaning.
inline constexpr int kFormatVersion = 2;

/// Can this runtime read the struct? A struct without format_version is written by hand and is taken as it is.
template <typename Emitted>
inline constexpr bool fits_runtime = [] {
  if constexpr (requires { Emitted::format_version; }) return Emitted::format_version == kFormatVersion;
  return true;
}();

}  // namespace contactspline
