// SPDX-License-Identifier: MIT
// Files that cannot be read, or are too large: one line that names the file and the reason.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>
#include <utility>
#include <vector>

#include "bad_material.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

TEST(UnreadableFile, IsNotReadWhereItIsHuge) {
  const Sandbox box;
  write_file(box / "probe.json", kGood);
  fs::resize_file(box / "probe.json", 1ULL << 40);
  expect_refused(run({.arguments = {"inspect", "probe.json"}, .folder = box.path()}),
                 "probe.json: file: ", "is larger than 1 MiB; allowed: a file of at most 1 MiB that can be read");
}

TEST(UnreadableFile, CannotBeOpened) {
  const Sandbox box;
  fs::create_directories(box / "folder.json");
  fs::create_symlink("nowhere", box / "dangling.json");
  fs::create_symlink("loop.json", box / "loop.json");
  ASSERT_EQ(::mkfifo((box / "pipe.json").c_str(), 0600), 0);
  const std::string allowed = "; allowed: a file of at most 1 MiB that can be read";
  const std::string long_name = std::string(300, 'a').append(".json");
  for (const auto& [path, says] :
       std::vector<std::pair<std::string, std::string>>{{"nowhere.json", "does not exist"},
                                                        {"./nowhere", "does not exist"},
                                                        {"no/where.json", "does not exist"},
                                                        {"folder.json", "is not a regular file"},
                                                        {"folder.json/", "is not a regular file"},
                                                        {"dangling.json", "does not exist"},
                                                        {"loop.json", "Too many levels of symbolic links"},
                                                        {"pipe.json", "is not a regular file"},
                                                        {"/dev/zero", "is not a regular file"},
                                                        {long_name, "File name too long"}})
    expect_refused(run({.arguments = {"inspect", path}, .folder = box.path()}), path + ": file: ", says + allowed);
  expect_refused(run({.arguments = {"inspect", "a\nb\033.json"}, .folder = box.path()}),
                 "a?b?.json: file: ", "does not exist");
}

TEST(UnreadableFile, CannotBeRead) {
  const Sandbox box;
  write_file(box / "probe.json", kGood);
  fs::permissions(box / "probe.json", fs::perms::none);
  const auto outcome = run({.arguments = {"inspect", "probe.json"}, .folder = box.path(), .as_nobody = true});
  if (outcome.exit_code == kNotStarted) GTEST_SKIP() << "root reads all, and nobody cannot start the program";
  expect_refused(outcome, "probe.json: file: Permission denied", "allowed: a file of at most 1 MiB that can be read");
}

}  // namespace
}  // namespace contactspline::testing
