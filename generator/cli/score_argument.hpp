// SPDX-License-Identifier: MIT
// SCORE on the command line: a score file, or the name of one that ships.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "generator/score.hpp"

namespace contactspline {

constexpr auto kScoreHelp = "score file (.json, .mid), or the name of a score that ships";

/// A score and the files it was read from.
struct ScoreSource {
  Score score;
  std::vector<std::filesystem::path> files;
};

/// Names of the scores that ship, rising.
[[nodiscard]] std::vector<std::string> shipped_scores();

/// Reads a SCORE and the resonators and materials it names: a path where it ends in .json or .mid or holds a slash,
/// else a shipped name. Throws BadInput.
[[nodiscard]] ScoreSource score_argument(const std::string& argument);

}  // namespace contactspline
