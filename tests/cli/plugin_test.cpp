// SPDX-License-Identifier: MIT
// contactspline plugin: the project that it writes. tests/package builds it and plays what it makes.
#include <gtest/gtest.h>

#include <string>

#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

TEST(Plugin, WritesAProjectWithTheClass) {
  const Sandbox box;
  const Call call = {.arguments = {"plugin", "tom", "-o", "drum", "--vendor", "Me & you", "--no-build"},
                     .folder = box.path()};
  EXPECT_EQ(succeed(call), "wrote drum/CMakeLists.txt\nwrote drum/tom.hpp\n");
  const std::string project = read_file(box / "drum/CMakeLists.txt");
  for (const char* text : {"Written by contactspline " VERSION, "HEADER tom.hpp", "instruments::tom<float>",
                           "VENDOR \"Me & you\"", "ID contactspline.own.tom "})
    EXPECT_NE(project.find(text), std::string::npos) << text;
  EXPECT_EQ(project.find('@'), std::string::npos);
  EXPECT_EQ(project.find(box.path().string()), std::string::npos);  // can be moved
  EXPECT_NE(read_file(box / "drum/tom.hpp").find("class tom "), std::string::npos);
  EXPECT_EQ(succeed(call), "");  // nothing has changed
}

TEST(Plugin, RefusesWhatItCannotMake) {
  const Sandbox box;
  const auto refused = [&](Words more, const char* what, const char* allowed) {
    expect_refused(run({.arguments = followed_by({"plugin"}, more), .folder = box.path()}), what, allowed);
    EXPECT_FALSE(fs::exists(box.path() / "drum"));
  };
  refused({"felt_c4", "-o", "drum"}, "felt_c4: INSTRUMENT: is no instrument", "an instrument file");
  refused({"snair", "-o", "drum"}, "snair: INSTRUMENT: is no instrument", "; did you mean snare?");
  refused({"absent.json", "-o", "drum"}, "absent.json", "");
  refused({"tom", "-o", "drum", "--vendor", "${HOME}"}, "--vendor: has a character that CMake reads", "a name");
  refused({"tom"}, "--output: missing", "folder for the project");
}

// Where nothing can be built, nothing is written.
TEST(Plugin, NeedsACompilerUnlessItBuildsNothing) {
  const Sandbox box;
  const Outcome outcome = run_program({.arguments = {"plugin", "tom", "-o", "drum"},
                                       .folder = box.path(),
                                       .environment = {{"PATH", box.path().string()}}});
  expect_refused(outcome, "compiler: not installed", "install cmake, g++ and dpf-source, or --no-build");
  EXPECT_FALSE(fs::exists(box.path() / "drum"));
}

TEST(Plugin, KeepsFilesOfOthers) {
  const Sandbox box;
  fs::create_directory(box.path() / "drum");
  write_file(box / "drum/CMakeLists.txt", "project(somebody_elses)\n");
  expect_refused(run({.arguments = {"plugin", "tom", "-o", "drum", "--no-build"}, .folder = box.path()}),
                 "drum/CMakeLists.txt", "--force");
  EXPECT_EQ(read_file(box / "drum/CMakeLists.txt"), "project(somebody_elses)\n");
}

}  // namespace
}  // namespace contactspline::testing
