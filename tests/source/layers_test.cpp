// SPDX-License-Identifier: MIT
// The folders of generator and runtime: a folder includes lower ones only, nothing includes itself through others,
// and libraries stay in their folders.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "source/source_tree.hpp"
#include "support/expressions.hpp"

namespace contactspline::testing {
namespace {

using Graph = std::map<std::string, std::set<std::string>>;

/// A tree of folders: where it is, how its files name each other in an #include, and the level of each folder.
struct Tree {
  std::string folder, include_pattern;
  std::map<std::string, int> levels;
};

const Tree kGenerator{"generator",
                      R"(#include "(generator/[^"]+)\")",
                      {{"support", 1},
                       {"contact", 2},
                       {"material", 3},
                       {"spline", 4},
                       {"resonator", 5},
                       {"fit", 6},
                       {"instrument", 6},
                       {"emit", 7},
                       {"player", 7},
                       {"dataset", 8},
                       {"listen", 8},
                       {"cli", 9}}};
const Tree kRuntime{"runtime/contactspline",
                    R"(#include "(contactspline/[^"]+)\")",
                    {{"step", 1},
                     {"data", 2},
                     {"midi", 2},
                     {"simd", 2},
                     {"modal", 3},
                     {"network", 4},
                     {"models", 5},
                     {"tangent", 6},
                     {"instrument", 6},
                     {"host", 7}}};

std::vector<SourceFile> files_of(const Tree& tree) {
  return source_files({tree.folder}, {".cpp", ".hpp"});
}

std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  std::vector<std::string> found;
  for (const Groups& match : matches_of(text, pattern)) found.push_back(match[1]);
  return found;
}

// The headers of the same tree that a file includes, as their paths in the tree.
std::vector<std::string> includes_of(const Tree& tree, const SourceFile& file) {
  std::vector<std::string> includes = matches(file.text, tree.include_pattern);
  const std::string above = tree.folder.substr(0, tree.folder.rfind('/') + 1);
  for (std::string& include : includes) include = above + include;
  // It does not exist: the compiler stops there.
  std::erase(includes, "runtime/contactspline/needs_cpp20.hpp");
  return includes;
}

std::string folder_of(const Tree& tree, const std::string& path) {
  const auto begin = tree.folder.size() + 1;
  return path.substr(begin, path.find('/', begin) - begin);
}

std::string without_ending(const std::string& path) {
  return path.substr(0, path.rfind('.'));
}

// A .cpp belongs to the header of its name, or, where there is none, to the first one it includes. One that compiles
// an -inl.hpp is a module of its own.
std::string module_of(const Tree& tree, const std::vector<SourceFile>& files, const SourceFile& file) {
  const std::string name = without_ending(file.path);
  const auto has_header = [&](const SourceFile& other) { return other.path == name + ".hpp"; };
  const auto includes = includes_of(tree, file);
  const auto is_inline = [](const std::string& include) { return include.ends_with("-inl.hpp"); };
  if (std::ranges::any_of(files, has_header) || std::ranges::any_of(includes, is_inline) || includes.empty() ||
      file.path.ends_with("main.cpp"))
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

TEST(LayersOfTheTree, CircleIsFoundWhereThereIsOne) {
  EXPECT_EQ(circle_in({{"a", {"b"}}, {"b", {"c"}}, {"c", {}}}), std::set<std::string>{});
  EXPECT_EQ(circle_in({{"a", {"b"}}, {"b", {"a", "c"}}, {"c", {}}, {"d", {"a"}}}), (std::set<std::string>{"a", "b"}));
}

// What a file of a room of the house names in an #include or an import, not in other paths: files of rooms below, or
// of its own.
TEST(LayersOfTheHouse, ArrowsRunOnlyDownwards) {
  const std::map<std::string, int> levels{{"runtime", 1}, {"generator", 2}, {"hosts", 3}, {"web", 4}};
  std::size_t arrows = 0;
  for (const auto& [room, level] : levels)
    for (const SourceFile& file : source_files({room}, {".cpp", ".hpp", ".js", ".mjs", ".ts"}))
      for (const std::string& named :
           matches(file.text, R"((?:#include|from|import) "(?:[^"]*/)?(runtime|generator|hosts|web)/[^"]*")")) {
        EXPECT_LE(levels.at(named), level) << file.path << " names a file of " << named;
        ++arrows;
      }
  EXPECT_GT(arrows, 500u);
}

class Layers : public ::testing::TestWithParam<Tree> {};

TEST_P(Layers, EveryFileLiesInAFolderWithALevel) {
  const Tree& tree = GetParam();
  const auto files = files_of(tree);
  ASSERT_GT(files.size(), 30u);
  for (const SourceFile& file : files) EXPECT_TRUE(tree.levels.contains(folder_of(tree, file.path))) << file.path;
}

TEST_P(Layers, ArrowsRunOnlyDownwards) {
  const Tree& tree = GetParam();
  std::size_t arrows = 0;
  for (const SourceFile& file : files_of(tree))
    for (const std::string& include : includes_of(tree, file)) {
      const std::string from = folder_of(tree, file.path), to = folder_of(tree, include);
      ASSERT_TRUE(tree.levels.contains(to)) << file.path << " includes " << include;
      EXPECT_TRUE(from == to || tree.levels.at(to) < tree.levels.at(from)) << file.path << " includes " << include;
      ++arrows;
    }
  EXPECT_GT(arrows, 60u);
}

TEST_P(Layers, NoModuleIncludesItselfThroughOthers) {
  const Tree& tree = GetParam();
  const auto files = files_of(tree);
  Graph modules;
  for (const SourceFile& file : files) {
    const std::string module = module_of(tree, files, file);
    auto& arrows = modules[module];
    for (const std::string& include : includes_of(tree, file))
      if (without_ending(include) != module) arrows.insert(without_ending(include));
  }
  std::string text;
  for (const std::string& module : circle_in(modules)) text += module + " ";
  EXPECT_EQ(text, "");
}

INSTANTIATE_TEST_SUITE_P(Trees, Layers, ::testing::Values(kGenerator, kRuntime),
                         [](const auto& tree) { return matches(tree.param.folder, "([a-z]+)").front(); });

TEST(LayersOfTheTree, EachFolderLinksJustTheFoldersItIncludes) {
  const auto lists = source_files({"generator"}, {".txt"});
  ASSERT_EQ(lists.size(), 1u);
  Graph included;
  for (const SourceFile& file : files_of(kGenerator))
    for (const std::string& include : includes_of(kGenerator, file)) {
      const std::string from = folder_of(kGenerator, file.path), to = folder_of(kGenerator, include);
      if (from != to) included[from].insert(to);
    }
  for (const auto& [name, level] : kGenerator.levels) {
    const auto linked =
        matches(lists.front().text, "generator_library\\(" + name + "\\s[^)]*?USES ([a-z ]+?)\\s*(?:LIBRARIES|\\))");
    const auto names = linked.empty() ? std::vector<std::string>{} : matches(linked.front(), "([a-z]+)");
    const std::set<std::string> links(names.begin(), names.end());
    for (const std::string& used : included[name])
      EXPECT_TRUE(links.contains(used)) << name << " does not link " << used;
    for (const std::string& link : links)
      EXPECT_TRUE(included[name].contains(link)) << name << " does not use " << link;
  }
}

TEST(LayersOfTheTree, LibrariesStayInTheirFolders) {
  const std::map<std::string, std::set<std::string>> allowed = {
      {"nlohmann/", {"generator/support/json_reader.cpp"}},
      {"CLI/", {"generator/cli/command_line.cpp", "generator/cli/validators.hpp"}},
      {"ceres/", {"generator/fit/fit_problem.cpp", "generator/listen/listening_problem.cpp"}},
      {"sndfile", {"generator/support/memory_sound.hpp"}},
      {"hdf5.h", {"generator/dataset/hdf5_handle.hpp"}}};
  for (const SourceFile& file : files_of(kGenerator))
    for (const auto& [library, files] : allowed) {
      const bool is_included = file.text.find("#include <" + library) != std::string::npos;
      EXPECT_TRUE(!is_included || files.contains(file.path)) << file.path << " includes " << library;
    }
}

// The engine is compiled once (runtime/contactspline/host/engine_*.cpp): what reads, emits and plays calls it.
TEST(LayersOfTheTree, GeneratorSeesTheNetworkInOneFile) {
  std::map<std::string, std::vector<std::string>> includes;
  for (const Tree& tree : {kGenerator, kRuntime})
    for (const SourceFile& file : files_of(tree)) {
      includes[file.path] = includes_of(kGenerator, file);
      for (const std::string& include : includes_of(kRuntime, file)) includes[file.path].push_back(include);
    }
  std::set<std::string> seeing;
  for (const SourceFile& file : files_of(kGenerator)) {
    std::set<std::string> reached;
    for (std::vector<std::string> next{file.path}; !next.empty();) {
      const std::string path = next.back();
      next.pop_back();
      if (reached.insert(path).second) next.insert(next.end(), includes[path].begin(), includes[path].end());
    }
    if (reached.contains("runtime/contactspline/network/contact_network.hpp")) seeing.insert(file.path);
  }
  EXPECT_EQ(seeing, std::set<std::string>{"generator/instrument/static_equilibrium.cpp"});
}

TEST(LayersOfTheTree, RuntimeKnowsNothingOfTheGenerator) {
  for (const SourceFile& file : source_files({"runtime"}, {".cpp", ".hpp"}))
    EXPECT_TRUE(matches(file.text, kGenerator.include_pattern).empty()) << file.path;
}

}  // namespace
}  // namespace contactspline::testing
