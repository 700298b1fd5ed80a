// SPDX-License-Identifier: MIT
// contactspline show: every file that ships, byte by byte.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>

#include "generator/support/embedded_files.hpp"
#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

constexpr std::array kFolders = {Shipped::kMaterials, Shipped::kFrictions, Shipped::kResonators, Shipped::kKeyboards,
                                 Shipped::kScores};

TEST(Show, PrintsEveryFileThatShips) {
  for (const Shipped folder : kFolders) {
    for (const EmbeddedFile& file : embedded_files(folder))
      EXPECT_TRUE(succeed({.arguments = {"show", std::string(file.name)}}) == file.content) << file.name;
    for (const std::string& name : shipped_names(folder))
      EXPECT_TRUE(succeed({.arguments = {"show", name}}) ==
                  find_embedded(folder, name + (name == "bach_prelude" ? ".mid" : ".json"))->content)
          << name;
  }
}

// A name stands for one thing only.
TEST(Show, FindsNoNameTwice) {
  std::map<std::string, int> names;
  for (const Shipped folder : kFolders)
    for (const std::string& name : shipped_names(folder)) EXPECT_EQ(++names[name], 1) << name;
}

TEST(Show, MayStateAnotherName) {
  const Sandbox box;
  std::string expected = printed(box, {"show", "felt_c4"});
  const std::size_t at = expected.find("\"felt_c4\"");
  ASSERT_NE(at, std::string::npos);
  expected.replace(at, 9, "\"my_felt\"");
  EXPECT_EQ(printed(box, {"show", "felt_c4", "--name", "my_felt"}), expected);
  expect_refused(run({.arguments = {"show", "felt_c4", "--name", "My Felt"}, .folder = box.path()}),
                 "--name: name: 'My Felt' is not a usable identifier", "allowed: a-z");
  expect_refused(run({.arguments = {"show", "dulcimer_jig", "--name", "mine"}, .folder = box.path()}),
                 "dulcimer_jig: --name: the file has no name of its own", "allowed: with a material");
}

}  // namespace
}  // namespace contactspline::testing
