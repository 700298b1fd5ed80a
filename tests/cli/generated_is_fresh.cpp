// SPDX-License-Identifier: MIT
// generated/ holds just what the shipped materials, resonators, keyboards and instruments make today.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

const fs::path kSource = SOURCE_FOLDER;

// data/materials/*.json data/resonators/*.json data/keyboards/*.json data/instruments/*.json
Words shipped_files() {
  Words files;
  for (const std::string folder : {"materials", "resonators", "keyboards", "instruments"})
    for (const auto& entry : fs::directory_iterator(kSource / "data" / folder))
      if (entry.path().extension() == ".json")
        files.push_back("data/" + folder + "/" + entry.path().filename().string());
  std::ranges::sort(files);
  return files;
}

std::string mending_command() {
  return fmt::format(
      "To mend it:\n  cd {} && {} generate data/materials/*.json data/resonators/*.json data/keyboards/*.json "
      "data/instruments/*.json -o generated\n",
      kSource.string(), kProgram);
}

TEST(generated_is_fresh, byte_for_byte) {
  const Words check = {"-o", "generated", "--check"};
  const auto outcome =
      run({.arguments = followed_by(followed_by({"generate"}, shipped_files()), check), .folder = kSource});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err << mending_command();
}

TEST(generated_is_fresh, without_leftovers) {
  const auto names_of = [](const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
    return names;
  };
  const Sandbox box;
  const Words into_box = {"-o", box.path().string()};
  const auto outcome =
      run({.arguments = followed_by(followed_by({"generate"}, shipped_files()), into_box), .folder = kSource});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(names_of(kSource / "generated"), names_of(box.path()))
      << "Delete the files that no input makes any more. " << mending_command();
}

}  // namespace
}  // namespace contactspline::testing
