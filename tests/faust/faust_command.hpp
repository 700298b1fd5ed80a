// SPDX-License-Identifier: MIT
// Runs the installed Faust compiler.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>

#include "paths.hpp"
#include "shell.hpp"

namespace contactspline::testing {

/// faust with options on a program, into an output file. Of two files of one name it takes that of the last -I.
[[nodiscard]] inline Outcome run_faust_compiler(const std::string& options, const std::filesystem::path& program,
                                                const std::filesystem::path& output) {
  std::ostringstream command;
  command << kFaust << ' ' << options;
  for (const char* folder : {kFaustSources, kTestPrograms, kShipped, kGenerated})
    command << " -I \"" << folder << '"';
  command << ' ' << program << " -o " << output;
  return run(command.str());
}

[[nodiscard]] inline std::string read_file(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// A folder of its own for a test's output, empty.
[[nodiscard]] inline std::filesystem::path empty_folder(const std::string& name) {
  const auto folder = std::filesystem::path(kGenerated) / "tests" / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace contactspline::testing
