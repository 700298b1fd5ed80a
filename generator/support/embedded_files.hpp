// SPDX-License-Identifier: MIT
// The files embedded in the program: the templates, and what ships: materials, resonators, keyboards,
// instruments and scores.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace contactspline {

/// A folder of embedded files.
enum class Shipped { kTemplates, kMaterials, kFrictions, kResonators, kKeyboards, kInstruments, kScores };

struct EmbeddedFile {
  std::string_view name;  ///< without the folder
  std::string_view content;
};

namespace detail {

// One function for each folder. The build writes their definitions (cmake/EmbedFiles.cmake).
[[nodiscard]] std::span<const EmbeddedFile> embedded_templates();
[[nodiscard]] std::span<const EmbeddedFile> embedded_materials();
[[nodiscard]] std::span<const EmbeddedFile> embedded_frictions();
[[nodiscard]] std::span<const EmbeddedFile> embedded_resonators();
[[nodiscard]] std::span<const EmbeddedFile> embedded_keyboards();
[[nodiscard]] std::span<const EmbeddedFile> embedded_instruments();
[[nodiscard]] std::span<const EmbeddedFile> embedded_scores();

}  // namespace detail

/// All files of a folder, sorted by name.
[[nodiscard]] std::span<const EmbeddedFile> embedded_files(Shipped folder);

/// The file with that name (with its ending), or null if there is none.
[[nodiscard]] const EmbeddedFile* find_embedded(Shipped folder, std::string_view file_name);

/// The names that a user can give for the files of a folder: its .json and .mid files without the ending, sorted.
[[nodiscard]] std::vector<std::string> shipped_names(Shipped folder);

/// True if an argument or a key names a file: it ends in .json or .mid, or contains a slash. Any other text names
/// something that ships.
[[nodiscard]] bool is_path(std::string_view name);

/// Does a name end as those of MIDI files do?
[[nodiscard]] bool is_midi_path(std::string_view name);

}  // namespace contactspline
