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
  std::set<std::string> expected, found;
  for (const std::string& file : shipped_files())
    for (const std::string extension : {".lib", ".hpp", ".json"})
      if (extension != ".lib" || !file.starts_with("data/instruments"))
        expected.insert(fs::path(file).stem().string() + extension);
  for (const auto& entry : fs::directory_iterator(kSource / "generated"))
    found.insert(entry.path().filename().string());
  EXPECT_EQ(found, expected) << "Delete the files that no input makes any more. " << mending_command();
}

}  // namespace
}  // namespace contactspline::testing
