// SPDX-License-Identifier: MIT
// docs/how-to/fit.md and the data of its tutorials in examples/fit: the page shows them as they are, they lead to the
// parameters that they were made from, and make_data.py makes them again.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

const fs::path kExamples = fs::path(SOURCE_FOLDER) / "examples/fit";

void expect_fit(const std::string& example, const std::string& law_and_loss,
                const std::map<std::string, double>& estimates) {
  const std::string file = (kExamples / (example + ".fit.json")).string();
  const auto fit = nlohmann::json::parse(succeed({.arguments = {"fit", file, "--json"}}));
  EXPECT_EQ(fit.at("law").get<std::string>() + " " + fit.at("loss").get<std::string>(), law_and_loss);
  for (const auto& [estimate, value] : estimates) {
    const auto& found = fit.at("estimates").at(estimate);
    EXPECT_LE(found.at("low").get<double>(), value) << estimate;
    EXPECT_GE(found.at("high").get<double>(), value) << estimate;
    // A stiffness moves with the exponent, and both with a low-pass of the sensor that nobody stated.
    EXPECT_LT(found.at("high").get<double>() / found.at("low").get<double>(), 1.7) << estimate;
  }
}

TEST(FitTutorials, FindTheFeltFromFivePulses) {
  expect_fit("felt", "power hunt_crossley",
             {{"stiffness_n_per_m_alpha", 4.5e9}, {"exponent", 2.5}, {"loss_s_per_m", 0.12}});
}

TEST(FitTutorials, FindTheRubberBallFromContactTimes) {
  expect_fit("rubber_ball", "hertz hunt_crossley", {{"stiffness_n_per_m_alpha", 4.903e5}, {"loss_s_per_m", 0.1}});
}

TEST(FitTutorials, FindTheMalletFromARecordedBar) {
  expect_fit("mallet", "power none", {{"stiffness_n_per_m_alpha", 8e8}, {"exponent", 1.8}, {"mass_kg", 0.032}});
}

TEST(FitTutorials, FindTheTineFromItsNotes) {
  const auto fit =
      nlohmann::json::parse(succeed({.arguments = {"fit", (kExamples / "tine.fit.json").string(), "--json"}}));
  for (const auto& [open, value] : {std::pair{"bodies[0].bar.bending_stiffness_n_m2", 0.0341},
                                    {"bodies[0].bar.constant_loss_per_s", 5.0},
                                    {"contacts[0].weight", 0.5},
                                    {"recordings[1].velocity", 0.9}}) {
    const auto& found = fit.at("estimates").at(open);
    EXPECT_LE(found.at("low").get<double>(), value) << open;
    EXPECT_GE(found.at("high").get<double>(), value) << open;
    EXPECT_LT(found.at("high").get<double>() / found.at("low").get<double>(), 1.05) << open;
  }
  EXPECT_LT(fit.at("recordings").at(2).at("after").at("level_db").get<double>(), 0.1);
}

TEST(FitTutorials, HaveTheDataOfTheirScript) {
  const Sandbox box;
  const std::string command =
      "/usr/bin/python3 '" + (kExamples / "make_data.py").string() + "' '" + box.path().string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(box.path())) {
    ++files;
    EXPECT_EQ(read_file(entry.path()), read_file(kExamples / entry.path().filename())) << entry.path().filename();
  }
  EXPECT_EQ(files, 11);
}

// The lines of an excerpt are lines of the whole, in their order. A line of three dots stands for others.
bool is_excerpt(const std::string& excerpt, const std::string& whole) {
  std::istringstream shown(excerpt), all(whole);
  std::string line, next;
  int found = 0;
  while (std::getline(shown, line)) {
    if (line == "  ...") continue;
    do {
      if (!std::getline(all, next)) return false;
    } while (next != line);
    ++found;
  }
  return found >= 3;
}

TEST(FitPage, TellsExcerptsFromOtherText) {
  EXPECT_TRUE(is_excerpt("a\n  ...\nc\nd\n", "a\nb\nc\nd\ne\n"));
  for (const char* wrong : {"a\nd\nc\n", "a\nb\nx\n", "a\nb\n", ""})
    EXPECT_FALSE(is_excerpt(wrong, "a\nb\nc\nd\ne\n")) << wrong;
}

// What the page shows of the files is what they are, and what it shows of the reports is an excerpt of them.
TEST(FitPage, ShowsFilesAndReportsAsTheyAre) {
  const std::string page = read_file(fs::path(SOURCE_FOLDER) / "docs/how-to/fit.md"), fence = "```text\n";
  std::size_t at = 0;
  for (const char* name : {"felt", "rubber_ball", "mallet", "tine"}) {
    const fs::path file = kExamples / (std::string(name) + ".fit.json");
    EXPECT_NE(page.find("```json\n" + read_file(file) + "```"), std::string::npos) << name;
    at = page.find(fence, at);
    ASSERT_NE(at, std::string::npos) << name;
    at += fence.size();
    EXPECT_TRUE(
        is_excerpt(page.substr(at, page.find("```", at) - at), succeed({.arguments = {"fit", file.string()}})))
        << name;
  }
}

}  // namespace
}  // namespace contactspline::testing
