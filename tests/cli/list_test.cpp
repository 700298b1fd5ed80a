// SPDX-License-Identifier: MIT
// contactspline list: what ships, in tables.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "cpu_time.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/embedded_files.hpp"
#include "printed_text.hpp"
#include "program.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;

TEST(Materials, ListsEveryOneThatShips) {
  const Sandbox box;
  const auto lines = lines_of(printed(box, {"list", "materials"}));
  std::vector<std::string> names;
  for (const auto& line : lines) names.push_back(line.substr(0, line.find(' ')));
  EXPECT_EQ(names, (std::vector<std::string>{"name", "felt_c2", "felt_c4", "felt_c7", "felt_live", "felt_over_wood",
                                             "felt_stulov_c4", "felt_synthetic", "mb1", "rubber_on_wood",
                                             "steel_ball_on_plate", "steel_on_steel"}));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Json json = Json::parse(printed(box, {"generate", names[i], "--emit", "json", "-o", "-"}));
    std::istringstream row(lines[i]);
    std::string name, stiffness, exponent;
    std::size_t segments = 0;
    row >> name >> stiffness >> exponent >> segments;
    if (json.contains("law")) {
      EXPECT_EQ(stiffness, names[i] == "felt_over_wood" ? "sum" : "measured");
      EXPECT_EQ(exponent, "-");
    } else {
      EXPECT_TRUE(relatively_within(std::stod(stiffness), json.at("stiffness_n_per_m_alpha"), 5e-4));
      EXPECT_TRUE(relatively_within(std::stod(exponent), json.at("exponent"), 5e-4));
    }
    EXPECT_EQ(segments, json.at("knots_m").size());
    EXPECT_TRUE(lines[i].ends_with("  " + json.at("title").get<std::string>()));
  }
}

TEST(List, HasATableForEachKind) {
  const std::string all = succeed({.arguments = {"list"}});
  for (const auto& [kind, folder] :
       std::vector<std::pair<std::string, Shipped>>{{"materials", Shipped::kMaterials},
                                                    {"frictions", Shipped::kFrictions},
                                                    {"resonators", Shipped::kResonators},
                                                    {"keyboards", Shipped::kKeyboards},
                                                    {"instruments", Shipped::kInstruments},
                                                    {"scores", Shipped::kScores}}) {
    const std::string table = succeed({.arguments = {"list", kind}});
    EXPECT_NE(all.find(fmt::format("{}\n\n{}", kind, table)), std::string::npos) << kind;
    std::vector<std::string> names;
    for (const auto& line : lines_of(table)) names.push_back(line.substr(0, line.find(' ')));
    EXPECT_EQ(names.front(), "name");
    EXPECT_EQ(std::vector(names.begin() + 1, names.end()), shipped_names(folder));
  }
}

TEST(List, PrintsTheKeysThatAnInstrumentPlays) {
  for (const std::string& name : shipped_names(Shipped::kInstruments)) {
    const auto file = find_embedded(Shipped::kInstruments, name + ".json")->content;
    const Json json = Json::parse(file, nullptr, true, true);
    int first = 128, last = -1;
    for (const Json& row : json.value("keys", Json::array())) {
      first = std::min(first, row.value("key", row.value("first", 128)));
      last = std::max(last, row.value("key", row.value("last", -1)));
    }
    const std::string keys = last < 0 ? "-" : fmt::format("{}-{}", first, last);
    bool is_found = false;
    for (const auto& line : lines_of(succeed({.arguments = {"list", "instruments"}}))) {
      std::istringstream row(line);
      std::string of, bodies, connections, controls, printed;
      row >> of >> bodies >> connections >> controls >> printed;
      if (of != name) continue;
      is_found = true;
      EXPECT_EQ(printed, keys) << name;
    }
    EXPECT_TRUE(is_found) << name;
  }
}

TEST(List, PrintsTheLowestModeOfAResonator) {
  for (const auto& line : lines_of(succeed({.arguments = {"list", "resonators"}}))) {
    std::istringstream row(line);
    std::string name, body;
    double frequency = NAN;
    if (!(row >> name >> body >> frequency)) continue;  // the heading
    const Json modes = Json::parse(run({.arguments = {"generate", name, "--emit", "json", "-o", "-"}}).out);
    const double lowest = modes.at("angular_frequency_rad_per_s").at(0).get<double>() / (2 * std::numbers::pi);
    EXPECT_TRUE(relatively_within(frequency, lowest, 1e-4)) << line;
  }
}

// At once, because it designs nothing: ten materials, 19 scores and 17 instruments ship, most of them with a
// felt of optimal knots.
TEST(List, TakesLessTimeThanTheDesignOfAFewMaterials) {
  const double design = cpu_time_s({.arguments = {"generate", "felt_c4", "--emit", "json", "-o", "-"}});
  EXPECT_LT(cpu_time_s({.arguments = {"list", "materials"}}), design / 2);
  EXPECT_LT(cpu_time_s({.arguments = {"list", "keyboards"}}), design / 2);
  EXPECT_LT(cpu_time_s({.arguments = {"list", "scores"}}), design / 2);
  EXPECT_LT(cpu_time_s({.arguments = {"list"}}), 5 * design);
}

}  // namespace
}  // namespace contactspline::testing
