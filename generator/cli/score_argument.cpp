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

ScoreSource shipped_score(const std::string& name) {
  const auto texts = embedded_scores();
  const auto found = std::ranges::find(texts, name + ".json", &EmbeddedText::file_name);
  if (found == texts.end())
    throw BadInput(fmt::format("{}: SCORE: no such score ships; allowed: a .json file, {}", name,
                               fmt::join(shipped_scores(), ", ")));
  return {parse_score(found->content, found->file_name, read_input), {}};
}

}  // namespace

std::vector<std::string> shipped_scores() {
  std::vector<std::string> names;
  for (const auto& text : embedded_scores()) names.emplace_back(text.file_name.substr(0, text.file_name.rfind('.')));
  return names;
}

ScoreSource score_argument(const std::string& argument) {
  if (!is_path(argument)) return shipped_score(argument);
  const std::filesystem::path file = argument;
  ScoreSource source;
  source.files.push_back(file);
  const auto read = [&](const std::string& path) {  // relative to the score
    source.files.push_back(file.parent_path() / path);
    return read_input(source.files.back());
  };
  source.score = parse_score(read_input(file), argument, read);
  return source;
}

}  // namespace contactspline
