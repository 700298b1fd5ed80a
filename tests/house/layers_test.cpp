// SPDX-License-Identifier: MIT
// The rooms of the generator: arrows run only downwards, nothing runs in a circle, and libraries stay in their rooms.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "house/source_tree.hpp"

namespace contactspline::testing {
namespace {

using Graph = std::map<std::string, std::set<std::string>>;

const std::map<std::string, int> kLevels = {{"support", 1}, {"contact", 2},   {"material", 3},
                                            {"spline", 4},  {"resonator", 5}, {"instrument", 6},
                                            {"emit", 7},    {"player", 7},    {"cli", 8}};

const std::vector<SourceFile>& generator() {
  static const auto files = source_files({"generator"}, {".cpp", ".hpp"});
  return files;
}

std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  std::vector<std::string> found;
  const std::regex expression(pattern);
  for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end; ++match)
    found.push_back((*match)[1]);
  return found;
}

std::vector<std::string> includes_of(const SourceFile& file) {
  return matches(file.text, R"(#include "(generator/[^"]+)\")");
}

std::string room_of(const std::string& path) {
  const auto begin = path.find('/') + 1;
  return path.substr(begin, path.find('/', begin) - begin);
}

std::string without_ending(const std::string& path) {
  return path.substr(0, path.rfind('.'));
}

// A .cpp belongs to the header of its name, or, where there is none, to the first one it includes.
std::string module_of(const SourceFile& file) {
  const std::string name = without_ending(file.path);
  const auto has_header = [&](const SourceFile& other) { return other.path == name + ".hpp"; };
  const auto includes = includes_of(file);
  if (std::ranges::any_of(generator(), has_header) || includes.empty() || file.path.ends_with("main.cpp"))
    return name;
  return without_ending(includes.front());
}

// Nodes on a circle: those left when nodes without arrows from or to others are taken away again and again.
std::set<std::string> circle_in(Graph graph) {
  for (bool changed = true; changed;) {
    std::set<std::string> reached;
    for (auto& [node, arrows] : graph) {
      std::erase_if(arrows, [&](const std::string& to) { return !graph.contains(to); });
      reached.insert(arrows.begin(), arrows.end());
    }
    const auto erased =
        std::erase_if(graph, [&](const auto& node) { return node.second.empty() || !reached.contains(node.first); });
    changed = erased > 0;
  }
  std::set<std::string> circle;
  for (const auto& [node, arrows] : graph) circle.insert(node);
  return circle;
}

TEST(Layers, CircleIsFoundWhereThereIsOne) {
  EXPECT_EQ(circle_in({{"a", {"b"}}, {"b", {"c"}}, {"c", {}}}), std::set<std::string>{});
  EXPECT_EQ(circle_in({{"a", {"b"}}, {"b", {"a", "c"}}, {"c", {}}, {"d", {"a"}}}), (std::set<std::string>{"a", "b"}));
}

TEST(Layers, EveryFileLiesInARoom) {
  ASSERT_GT(generator().size(), 60u);
  for (const SourceFile& file : generator()) EXPECT_TRUE(kLevels.contains(room_of(file.path))) << file.path;
}

TEST(Layers, ArrowsRunOnlyDownwards) {
  for (const SourceFile& file : generator())
    for (const std::string& include : includes_of(file)) {
      const std::string from = room_of(file.path), to = room_of(include);
      ASSERT_TRUE(kLevels.contains(to)) << file.path << " includes " << include;
      EXPECT_TRUE(from == to || kLevels.at(to) < kLevels.at(from)) << file.path << " includes " << include;
    }
}

TEST(Layers, NoModuleIncludesItselfThroughOthers) {
  Graph modules;
  for (const SourceFile& file : generator()) {
    const std::string module = module_of(file);
    auto& arrows = modules[module];
    for (const std::string& include : includes_of(file))
      if (without_ending(include) != module) arrows.insert(without_ending(include));
  }
  std::string text;
  for (const std::string& module : circle_in(modules)) text += module + " ";
  EXPECT_EQ(text, "");
}

TEST(Layers, EachRoomLinksJustTheRoomsItIncludes) {
  const auto lists = source_files({"generator"}, {".txt"});
  ASSERT_EQ(lists.size(), 1u);
  Graph included;
  for (const SourceFile& file : generator())
    for (const std::string& include : includes_of(file))
      if (room_of(include) != room_of(file.path)) included[room_of(file.path)].insert(room_of(include));
  for (const auto& [room, level] : kLevels) {
    const auto linked =
        matches(lists.front().text, "contactspline_room\\(" + room + "\\s[^)]*?USES ([a-z ]+?)\\s*(?:LIBRARIES|\\))");
    const auto names = linked.empty() ? std::vector<std::string>{} : matches(linked.front(), "([a-z]+)");
    const std::set<std::string> links(names.begin(), names.end());
    for (const std::string& used : included[room])
      EXPECT_TRUE(links.contains(used)) << room << " does not link " << used;
    for (const std::string& link : links)
      EXPECT_TRUE(included[room].contains(link)) << room << " does not use " << link;
  }
}

TEST(Layers, LibrariesStayInTheirRooms) {
  const std::map<std::string, std::set<std::string>> allowed = {
      {"nlohmann/", {"generator/support/json_reader.cpp"}},
      {"CLI/", {"generator/cli/command_line.cpp", "generator/cli/validators.hpp"}},
      {"sndfile", {"generator/cli/sound_file.cpp"}},
      {"portSMF/", {"generator/player/midi_reader.cpp"}}};
  for (const SourceFile& file : generator())
    for (const auto& [library, files] : allowed) {
      const bool is_included = file.text.find("#include <" + library) != std::string::npos;
      EXPECT_TRUE(!is_included || files.contains(file.path)) << file.path << " includes " << library;
    }
}

TEST(Layers, RuntimeKnowsNothingOfTheGenerator) {
  for (const SourceFile& file : source_files({"runtime"}, {".cpp", ".hpp"}))
    EXPECT_TRUE(includes_of(file).empty()) << file.path;
}

}  // namespace
}  // namespace contactspline::testing
