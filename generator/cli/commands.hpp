// SPDX-License-Identifier: MIT
// The subcommands: each one adds itself to the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>

namespace contactspline {

/// `generate --check` found files that differ from what would be written. what() names them.
struct Stale : std::runtime_error {
  using std::runtime_error::runtime_error;
};

void add_generate(CLI::App& app);
void add_inspect(CLI::App& app);
void add_materials(CLI::App& app);
void add_scores(CLI::App& app);
void add_impact(CLI::App& app);
void add_render(CLI::App& app);

}  // namespace contactspline
