// SPDX-License-Identifier: MIT
// What `generate` turns into source text: a material or a resonator, as a file or by the name under which it ships.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/emit.hpp"

namespace contactspline {

struct Source {
  std::string name;
  std::function<std::string(const Emitter&, std::string_view command)> emit;
  std::vector<std::filesystem::path> files;  ///< it was read from; none for a shipped name
};

/// Reads a SOURCE argument: a path where it ends in .json or holds a slash, else a shipped name. Modes of a resonator
/// are kept below max_frequency_hz; a line on standard error says where its own limit leaves some of them out. Throws
/// BadInput.
[[nodiscard]] Source source_argument(const std::string& argument, double max_frequency_hz);

/// The resonator of such an argument, or nothing where it is no resonator. Throws BadInput.
[[nodiscard]] std::optional<Resonator> resonator_argument(const std::string& argument);

}  // namespace contactspline
