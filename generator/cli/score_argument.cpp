// SPDX-License-Identifier: MIT
#include "generator/cli/score_argument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "generator/cli/material_argument.hpp"
#include "generator/cli/output.hpp"
#include "generator/embedded.hpp"
#include "generator/error.hpp"

namespace contactspline {
namespace {

bool is_midi(std::string_view file) {
  return file.ends_with(".mid");
}

ScoreSource shipped_score(const std::string& name) {
  const auto texts = embedded_scores();
  const auto names = shipped_scores();
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw BadInput(fmt::format("{}: SCORE: no such score ships; allowed: a .json or .mid file, {}", name,
                               fmt::join(names, ", ")));
  const auto& [file, content] = texts[static_cast<std::size_t>(found - names.begin())];
  return {is_midi(file) ? parse_midi_score(content, file) : parse_score(content, file, read_input), {}};
}

}  // namespace

std::vector<std::string> shipped_scores() {
  std::vector<std::string> names;
  for (const auto& text : embedded_scores()) names.emplace_back(text.file_name.substr(0, text.file_name.rfind('.')));
  return names;
}

ScoreSource score_argument(const std::string& argument) {
  if (!is_path(argument) && !is_midi(argument)) return shipped_score(argument);
  const std::filesystem::path file = argument;
  ScoreSource source;
  source.files.push_back(file);
  const auto read = [&](const std::string& path) {  // relative to the score
    source.files.push_back(file.parent_path() / path);
    return read_input(source.files.back());
  };
  source.score = is_midi(argument) ? parse_midi_score(read_input(file), argument)
                                   : parse_score(read_input(file), argument, read);
  return source;
}

}  // namespace contactspline
