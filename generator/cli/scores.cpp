// SPDX-License-Identifier: MIT
// contactspline scores: what ships.
#include <fmt/format.h>

#include "generator/cli/commands.hpp"
#include "generator/cli/output.hpp"
#include "generator/cli/score_argument.hpp"

namespace contactspline {
namespace {

void list_scores() {
  std::string table = fmt::format("{:<16} {:<14} {:>6}  {}\n", "name", "instrument", "s", "description");
  for (const std::string& name : shipped_scores()) {
    const Score score = score_argument(name).score;
    table += fmt::format("{:<16} {:<14} {:>6.4g}  {}\n", name, name_of(score.instrument), score.duration_s,
                         score.description);
  }
  write_stdout(table);
}

}  // namespace

void add_scores(CLI::App& app) {
  app.add_subcommand("scores", "List the scores that ship")
      ->footer("Play one: contactspline render INSTRUMENT --score NAME -o out.wav")
      ->callback(list_scores);
}

}  // namespace contactspline
