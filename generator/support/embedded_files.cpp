// SPDX-License-Identifier: MIT
#include "generator/support/embedded_files.hpp"

#include <algorithm>

namespace contactspline {
namespace {

bool has_input_ending(std::string_view file_name) {
  return file_name.ends_with(".json") || is_midi_path(file_name);
}

}  // namespace

std::span<const EmbeddedFile> embedded_files(Shipped folder) {
  switch (folder) {
    case Shipped::kTemplates:
      return detail::embedded_templates();
    case Shipped::kMaterials:
      return detail::embedded_materials();
    case Shipped::kFrictions:
      return detail::embedded_frictions();
    case Shipped::kResonators:
      return detail::embedded_resonators();
    case Shipped::kKeyboards:
      return detail::embedded_keyboards();
    case Shipped::kInstruments:
      return detail::embedded_instruments();
    case Shipped::kScores:
      break;
  }
  return detail::embedded_scores();
}

const EmbeddedFile* find_embedded(Shipped folder, std::string_view file_name) {
  const auto files = embedded_files(folder);
  const auto found = std::ranges::find(files, file_name, &EmbeddedFile::name);
  return found == files.end() ? nullptr : &*found;
}

std::vector<std::string> shipped_names(Shipped folder) {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embedded_files(folder))
    if (has_input_ending(file.name)) names.emplace_back(file.name.substr(0, file.name.rfind('.')));
  return names;
}

bool is_midi_path(std::string_view name) {
  constexpr std::string_view kEndings[] = {".mid", ".midi", ".rmi", ".kar"};
  return std::ranges::any_of(kEndings, [&](std::string_view ending) { return name.ends_with(ending); });
}

bool is_path(std::string_view name) {
  return has_input_ending(name) || name.find('/') != name.npos;
}

}  // namespace contactspline
