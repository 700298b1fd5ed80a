// SPDX-License-Identifier: MIT
// docs/reference/materials.md: every example is accepted by every command, and the figures it states come out.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "program.hpp"
#include "sandbox.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

/// The fenced blocks of a language.
std::vector<std::string> blocks(const std::string& language) {
  const std::string text = read_file(fs::path(SOURCE_FOLDER) / "docs/reference/materials.md"),
                    fence = "```" + language + "\n";
  std::vector<std::string> found;
  for (std::size_t at = 0; (at = text.find(fence, at)) != std::string::npos;) {
    at += fence.size();
    found.push_back(text.substr(at, text.find("```", at) - at));
  }
  return found;
}

std::string name_in(const std::string& material) {
  const auto at = material.find("\"name\": \"") + 9;
  return material.substr(at, material.find('"', at) - at);
}

TEST(MaterialsDocument, HasExamplesThatWork) {
  const Sandbox box;
  const auto curves = blocks("csv"), materials = blocks("json");
  ASSERT_EQ(curves.size(), 2u);
  // Power law, hertz, sum, series, curve, both branches, restitution, memory, live exponent.
  ASSERT_EQ(materials.size(), 9u);
  write_file(box / "my_felt.csv", curves[0]);
  write_file(box / "my_impact.csv", curves[1]);
  for (const std::string& material : materials) {
    const std::string file = name_in(material) + ".json";
    write_file(box / file, material);
    succeed({.arguments = {"generate", file, "-o", "out"}, .folder = box.path()});
    succeed({.arguments = {"inspect", file, "--figure", file + ".svg"}, .folder = box.path()});
    succeed({.arguments = {"impact", file}, .folder = box.path()});
    succeed({.arguments = {"render", "mass-barrier", "--material", file, "--duration", "0.05", "-o", "a.wav"},
             .folder = box.path()});
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(box / "out"), {}), 27);
}

TEST(MaterialsDocument, StatesTheContactTimeOfItsBall) {
  const Sandbox box;
  write_file(box / "ball.json", blocks("json").at(1));
  const std::string text =
      succeed({.arguments = {"impact", "ball.json", "--speed", "1", "--speed", "2"}, .folder = box.path()});
  std::vector<double> durations;
  for (std::size_t at = 0; (at = text.find("exact ", at + 1)) != std::string::npos;)
    durations.push_back(std::stod(text.substr(at + 6)));
  ASSERT_EQ(durations.size(), 2u);
  EXPECT_TRUE(within(durations[0], 5.5, 0.05));
  EXPECT_TRUE(within(durations[1], 4.8, 0.05));
}

}  // namespace
}  // namespace contactspline::testing
