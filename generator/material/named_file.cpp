// SPDX-License-Identifier: MIT
#include "generator/material/named_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <optional>
#include <utility>

#include "generator/support/file_kind.hpp"

namespace contactspline {

NamedText read_named(const JsonObject& object, const char* key, Shipped folder, const ReadFile& read) {
  const std::string allowed = fmt::format("a .json file, {}", fmt::join(shipped_names(folder), ", "));
  const std::string name = object.text(key, allowed);
  const auto refuse_other = [&](std::optional<Shipped> kind) {
    if (kind && *kind != folder)
      object.fail(object.key(key), fmt::format("'{}' is a {}", shown(name), kind_name(*kind)), allowed);
  };
  if (is_path(name)) {
    std::string text = read(name);
    refuse_other(kind_of_file(text, name, kind_name(folder)));
    return {std::move(text), name, false};
  }
  const EmbeddedFile* found = find_embedded(folder, name + ".json");
  if (found == nullptr) refuse_other(kind_of_name(name));
  if (found == nullptr) object.fail(object.key(key), fmt::format("'{}' does not ship", shown(name)), allowed);
  return {std::string(found->content), name + ".json", true};
}

ReadFile reader_beside(const NamedText& named, const ReadFile& read) {
  if (named.ships) return shipped_file;
  return [&](const std::string& path) {
    return read((std::filesystem::path(named.file).parent_path() / path).string());
  };
}

}  // namespace contactspline
