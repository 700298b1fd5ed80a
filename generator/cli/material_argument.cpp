// SPDX-License-Identifier: MIT
#include "generator/cli/material_argument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "generator/cli/output.hpp"
#include "generator/embedded.hpp"
#include "generator/error.hpp"

namespace contactspline {
namespace {

constexpr std::string_view kSuffix = ".json";

}  // namespace

bool is_path(std::string_view argument) {
  return argument.ends_with(kSuffix) || argument.find('/') != argument.npos;
}

std::vector<std::string> shipped_names() {
  std::vector<std::string> names;
  for (const auto& text : embedded_texts())
    if (text.file_name.ends_with(kSuffix))
      names.emplace_back(text.file_name.substr(0, text.file_name.size() - kSuffix.size()));
  return names;
}

std::vector<std::filesystem::path> input_files(const std::string& argument, const Material& material) {
  if (!is_path(argument)) return {};
  std::vector<std::filesystem::path> files{argument};
  if (material.measured) files.push_back(files.front().parent_path() / material.measured->file);
  return files;
}

ReadFile reader_beside(const std::filesystem::path& material_file) {
  return [folder = material_file.parent_path()](const std::string& path) { return read_input(folder / path); };
}

Design design_argument(const std::string& argument) {
  if (is_path(argument)) return design_contact(read_input(argument), argument, reader_beside(argument));
  const std::string file = argument + std::string(kSuffix);
  const auto texts = embedded_texts();
  const auto found = std::ranges::find(texts, file, &EmbeddedText::file_name);
  if (found == texts.end())
    throw BadInput(fmt::format("{}: MATERIAL: no such material ships; allowed: a .json file, {}", argument,
                               fmt::join(shipped_names(), ", ")));
  return design_contact(found->content, file);
}

}  // namespace contactspline
