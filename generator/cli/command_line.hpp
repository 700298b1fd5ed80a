// SPDX-License-Identifier: MIT
// The command line as a function.
#pragma once

namespace contactspline {

/// Runs the program with these arguments. Returns its exit status: 0; 1 if `generate --check` finds stale files; 2
/// for bad input, after one line on standard error.
[[nodiscard]] int run_command_line(int argc, const char* const* argv);

}  // namespace contactspline
