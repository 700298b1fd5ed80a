// SPDX-License-Identifier: MIT
// MATERIAL on the command line: a material file, or the name of one that ships.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "generator/emit.hpp"

namespace contactspline {

constexpr auto kMaterialHelp = "material file (.json), or the name of a material that ships";

/// Does an argument name a file, rather than something that ships?
[[nodiscard]] bool is_path(std::string_view argument);

/// Names of the materials that ship, rising.
[[nodiscard]] std::vector<std::string> shipped_names();

/// The files that a MATERIAL argument was read from: none for a shipped name.
[[nodiscard]] std::vector<std::filesystem::path> input_files(const std::string& argument, const Material& material);

/// Reads what a material file names, from beside it.
[[nodiscard]] ReadFile reader_beside(const std::filesystem::path& material_file);

/// Reads and designs a MATERIAL: a path where it ends in .json or holds a slash, else a shipped name. Throws
/// BadInput.
[[nodiscard]] Design design_argument(const std::string& argument);

}  // namespace contactspline
