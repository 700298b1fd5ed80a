// SPDX-License-Identifier: MIT
// The build of a project that contactspline plugin has written, by CMake and a compiler.
#pragma once

#include <filesystem>
#include <string>

namespace contactspline {

/// Throws BadInput where CMake or a compiler is missing: before anything is written.
void require_compiler();

/// Builds the project in its folder `build`. Throws BadInput with the first error of CMake or the compiler.
void build_plugin(const std::filesystem::path& project, const std::string& name);

}  // namespace contactspline
