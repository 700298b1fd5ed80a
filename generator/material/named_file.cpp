// SPDX-License-Identifier: MIT
#include "generator/material/named_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "generator/support/error.hpp"
#include "generator/support/file_kind.hpp"
#include "generator/support/nearest_name.hpp"

namespace contactspline {

namespace {

using Folders = std::span<const Shipped>;

std::string allowed_in(Folders folders, std::string_view wrong = {}) {
  std::vector<std::string> names, commands;
  for (const Shipped folder : folders) {
    std::ranges::copy(shipped_names(folder), std::back_inserter(names));
    commands.push_back(fmt::format("contactspline list {}s", kind_name(folder)));
  }
  return fmt::format("a .json file, {}",
                     names_in_short(std::move(names), wrong, fmt::format("{}", fmt::join(commands, "` or `"))));
}

NamedText text_of_name(std::string_view file, std::string_view key, const std::string& name, Folders folders,
                       const ReadFile& read) {
  const auto one_of = [&](std::optional<Shipped> kind) {
    if (kind && std::ranges::count(folders, *kind) == 0)
      refuse(file, key, fmt::format("'{}' is {}", shown(name), a_kind(*kind)), allowed_in(folders));
    return kind.value_or(folders[0]);
  };
  if (is_path(name)) {
    std::string text = read_for_key(file, key, name, read);
    const Shipped kind = one_of(kind_of_file(text, name, kind_name(folders[0])));
    return {std::move(text), name, false, false, kind};
  }
  for (const Shipped folder : folders)
    if (const EmbeddedFile* found = find_embedded(folder, name + ".json"))
      return {std::string(found->content), name + ".json", true, false, folder};
  (void)one_of(kind_of_name(name));
  refuse(file, key, fmt::format("'{}' does not ship", shown(name)), allowed_in(folders, name));
}

}  // namespace

NamedText named_text(std::string_view file, std::string_view key, const std::string& name, Shipped folder,
                     const ReadFile& read) {
  return text_of_name(file, key, name, {&folder, 1}, read);
}

NamedText read_named(const JsonObject& object, const char* key, Shipped folder, const ReadFile& read) {
  return read_named(object, key, Folders(&folder, 1), read);
}

NamedText read_named(const JsonObject& object, const char* key, Folders folders, const ReadFile& read) {
  if (!object.has_object(key))
    return text_of_name(object.file(), object.key(key), object.text(key, allowed_in(folders)), folders, read);
  NamedText named{object.json(key), fmt::format("{}: {}", object.file(), object.key(key)), false, true};
  const auto kind = kind_of_file(named.text, named.file, kind_name(folders[0]));
  if (kind && std::ranges::count(folders, *kind) == 0)
    object.fail(object.key(key), "is " + a_kind(*kind), allowed_in(folders));
  named.kind = kind.value_or(folders[0]);
  return named;
}

ReadFile reader_beside(const NamedText& named, const ReadFile& read) {
  if (named.ships) return shipped_file;
  if (named.is_object) return read;
  return [&](const std::string& path) {
    return read((std::filesystem::path(named.file).parent_path() / path).string());
  };
}

}  // namespace contactspline
