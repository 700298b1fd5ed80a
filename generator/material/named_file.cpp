// SPDX-License-Identifier: MIT
#include "generator/material/named_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <utility>

#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/nearest_name.hpp"

namespace contactspline {

namespace {

std::string allowed_in(Shipped folder, std::string_view wrong = {}) {
  return fmt::format("a .json file, {}", names_in_short(shipped_names(folder), wrong,
                                                        fmt::format("contactspline list {}s", kind_name(folder))));
}

}  // namespace

NamedText named_text(std::string_view file, std::string_view key, const std::string& name, Shipped folder,
                     const ReadFile& read) {
  const auto refuse_other = [&](std::optional<Shipped> kind) {
    if (kind && *kind != folder)
      refuse(file, key, fmt::format("'{}' is {}", shown(name), a_kind(*kind)), allowed_in(folder));
  };
  if (is_path(name)) {
    std::string text = read_for_key(file, key, name, read);
    refuse_other(kind_of_file(text, name, kind_name(folder)));
    return {std::move(text), name, false};
  }
  const EmbeddedFile* found = find_embedded(folder, name + ".json");
  if (found == nullptr) refuse_other(kind_of_name(name));
  if (found == nullptr) refuse(file, key, fmt::format("'{}' does not ship", shown(name)), allowed_in(folder, name));
  return {std::string(found->content), name + ".json", true};
}

NamedText read_named(const JsonObject& object, const char* key, Shipped folder, const ReadFile& read) {
  if (object.has_object(key)) {
    NamedText named{object.json(key), fmt::format("{}: {}", object.file(), object.key(key)), false, true};
    if (const auto kind = kind_of_file(named.text, named.file, kind_name(folder)); kind && *kind != folder)
      object.fail(object.key(key), "is " + a_kind(*kind), allowed_in(folder));
    return named;
  }
  return named_text(object.file(), object.key(key), object.text(key, allowed_in(folder)), folder, read);
}

ReadFile reader_beside(const NamedText& named, const ReadFile& read) {
  if (named.ships) return shipped_file;
  if (named.is_object) return read;
  return [&](const std::string& path) {
    return read((std::filesystem::path(named.file).parent_path() / path).string());
  };
}

}  // namespace contactspline
