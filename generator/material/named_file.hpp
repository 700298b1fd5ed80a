// SPDX-License-Identifier: MIT
// Files that another file names: by a path, or by the name of something that ships; or what stands in their place.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "generator/material/contact_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

struct NamedText {
  std::string text, file;
  bool ships;
  bool is_object = false;  ///< within the file that would name it
  Shipped kind = {};       ///< one of those that are asked for; the first where nothing shows it
};

/// The text of what `name` names, the value of `key` in `file`: a .json file, which `read` reads, or something in a
/// folder of what ships. Throws BadInput if there is no such file, or if it is of another kind.
[[nodiscard]] NamedText named_text(std::string_view file, std::string_view key, const std::string& name,
                                   Shipped folder, const ReadFile& read);

/// The text of what the key `key` of an object names: a .json file, which `read` reads, or something in a folder of
/// what ships; or of the object that stands there. Throws BadInput as named_text() does.
[[nodiscard]] NamedText read_named(const JsonObject& object, const char* key, Shipped folder, const ReadFile& read);

/// The same of one of several kinds.
[[nodiscard]] NamedText read_named(const JsonObject& object, const char* key, std::span<const Shipped> folders,
                                   const ReadFile& read);

/// Reads what a named file names in turn: beside the file, or what ships if the file ships; an object is a part of
/// the file that `read` reads beside. Both must outlive it.
[[nodiscard]] ReadFile reader_beside(const NamedText& named, const ReadFile& read);

}  // namespace contactspline
