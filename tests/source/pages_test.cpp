// SPDX-License-Identifier: MIT
// Links between Markdown files lead to a file that exists and to a heading in it. The pages that sources name exist,
// and so do the files that pages name. Their examples of a felt are the one that ships.
#include <gtest/gtest.h>

#include <cctype>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "source_tree.hpp"
#include "support/expressions.hpp"

namespace contactspline::testing {
namespace {

using Headings = std::set<std::string>;

// The lines of a page inside its blocks of code, or outside them.
std::vector<std::string> lines_of(const std::string& text, bool code) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  bool in_code = false;
  for (std::string line; std::getline(stream, line);) {
    const bool fence = line.starts_with("```");
    if (fence) in_code = !in_code;
    if (!fence && in_code == code) lines.push_back(line);
  }
  return lines;
}

std::vector<std::string> code_of(const std::string& text) {
  return lines_of(text, true);
}
std::vector<std::string> prose_of(const std::string& text) {
  return lines_of(text, false);
}

// A heading as hosts of Markdown write it in a link: lower case, no punctuation, a hyphen for each space.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    if (c == ' ') anchor += '-';
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return anchor;
}

Headings headings_of(const std::string& text) {
  Headings headings;
  for (const std::string& line : prose_of(text))
    if (line.starts_with('#')) headings.insert(anchor_of(line.substr(line.find(' ') + 1)));
  return headings;
}

constexpr auto kCode = "`[^`]*`";

// What stands in the round brackets of [text](target), without links to other hosts.
std::vector<std::string> targets_of(const std::string& text) {
  std::vector<std::string> targets;
  for (const std::string& line : prose_of(text)) {
    const std::string prose = replaced(line, kCode, "code");
    for (const Groups& link : matches_of(prose, "\\]\\(([^()\\s]*)\\)"))
      if (link[1].find("://") == std::string::npos) targets.push_back(link[1]);
  }
  return targets;
}

// The pages of the tree and their headings.
std::map<std::string, Headings> headings_of(const std::vector<SourceFile>& pages) {
  std::map<std::string, Headings> headings;
  for (const SourceFile& page : pages) headings[page.path] = headings_of(page.text);
  return headings;
}

// The targets in a page that lead nowhere.
std::vector<std::string> dead_targets(const SourceFile& page, const std::map<std::string, Headings>& headings) {
  std::vector<std::string> dead;
  for (const std::string& target : targets_of(page.text)) {
    const std::size_t hash = target.find('#');
    const std::string file = target.substr(0, hash);
    const std::string path =
        file.empty() ? page.path : (fs::path(page.path).parent_path() / file).lexically_normal().generic_string();
    const auto linked = headings.find(path);
    if (hash == std::string::npos ? fs::exists(fs::path(SOURCE_FOLDER) / path)
                                  : linked != headings.end() && linked->second.contains(target.substr(hash + 1)))
      continue;
    dead.push_back(target);
  }
  return dead;
}

std::vector<SourceFile> pages() {
  std::vector<SourceFile> pages = source_files({"docs"}, {".md"});
  for (const char* path : {"README.md", "CONTRIBUTING.md", "CHANGELOG.md"})
    pages.push_back({path, text_of(fs::path(SOURCE_FOLDER) / path)});
  return pages;
}

TEST(Pages, DeadLinksAreFound) {
  const SourceFile page{"docs/how-to/a.md",
                        "# A\n## Newton's `f(x)` method\n[b](../reference/b.md#c) [b](b.md) [a](#a)\n"
                        "[a](#newtons-fx-method) [a](a.md#d) [root](../../README.md) `[code](x)`\n"
                        "```cpp\n# D\n[&](int x) {}\n```\n[web](https://example.org/x)"};
  const std::map<std::string, Headings> headings = {{page.path, headings_of(page.text)},
                                                    {"docs/reference/b.md", {"c"}}};
  EXPECT_EQ(dead_targets(page, headings), (std::vector<std::string>{"b.md", "a.md#d"}));
}

TEST(Pages, LinkToAFileAndToAHeadingInIt) {
  const std::vector<SourceFile> all = pages();
  const std::map<std::string, Headings> headings = headings_of(all);
  std::size_t links = 0;
  for (const SourceFile& page : all) {
    links += targets_of(page.text).size();
    for (const std::string& target : dead_targets(page, headings)) ADD_FAILURE() << page.path << ": " << target;
  }
  EXPECT_GT(links, 150u);
}

TEST(Pages, AreAllInTheIndex) {
  std::set<std::string> linked = {"docs/index.md"};
  for (const std::string& target : targets_of(text_of(fs::path(SOURCE_FOLDER) / "docs/index.md")))
    linked.insert("docs/" + target);
  for (const SourceFile& page : source_files({"docs"}, {".md"}))
    EXPECT_TRUE(linked.contains(page.path)) << page.path << " is not in docs/index.md";
}

TEST(Pages, OfHowItWorksShowAFigureEach) {
  for (const SourceFile& page : source_files({"docs/how-it-works"}, {".md"}))
    EXPECT_NE(page.text.find("](../figures/"), std::string::npos) << page.path;
}

// No build compiles the programs whose numbers the figures show.
TEST(Pages, HaveFiguresFromProgramsThatIncludeHeadersOfTheRuntime) {
  std::size_t included = 0;
  for (const SourceFile& file : source_files({"docs/figures"}, {".cpp"}))
    for (const Groups& header : matches_of(file.text, "#include \"(contactspline/([a-z]+)/[^\"]+)\"")) {
      if (header[2] == "materials" || header[2] == "resonators") continue;  // that the generator emits
      ++included;
      EXPECT_TRUE(fs::exists(fs::path(SOURCE_FOLDER) / "runtime" / header[1])) << file.path << ": " << header[1];
    }
  EXPECT_GT(included, 5u);
}

// Every text of the tree but the pages.
std::vector<SourceFile> sources() {
  return source_files(
      {"bench", "cmake", "data", "examples", "faust", "generator", "hosts", "runtime", "scripts", "templates",
       "tests", "web"},
      {".cpp", ".hpp", ".h", ".lib", ".dsp", ".in", ".json", ".cmake", ".txt", ".sh", ".mjs", ".js", ".py", ""});
}

TEST(Pages, ThatSourcesNameExist) {
  std::size_t named = 0;
  for (const SourceFile& file : sources()) {
    if (file.path.ends_with("pages_test.cpp")) continue;
    for (const Groups& page : matches_of(file.text, "\\bdocs/[a-z/-]+\\.md\\b")) {
      ++named;
      EXPECT_TRUE(fs::exists(fs::path(SOURCE_FOLDER) / page[0])) << file.path << ": " << page[0];
    }
  }
  EXPECT_GT(named, 80u);
}

// A file, a folder or a program, from the tree's root, from a folder of the source or as an include.
bool is_there(const std::string& path) {
  for (const char* folder : {"", "generator", "runtime", "runtime/contactspline", "examples", "web"})
    for (const char* ending : {"", ".cpp"})
      if (fs::exists(fs::path(SOURCE_FOLDER) / folder / (path + ending))) return true;
  return false;
}

TEST(Pages, NameFilesThatExist) {
  std::size_t named = 0;
  for (const SourceFile& page : pages()) {
    if (page.path == "CHANGELOG.md") continue;  // names what there was
    for (const Groups& path : matches_of(page.text, "`([a-z]+/[a-z0-9_./-]+)`")) {
      const std::string& name = path[1];
      if (name.starts_with("build/") || name.starts_with("out/") || name.find("...") != std::string::npos) continue;
      ++named;
      EXPECT_TRUE(is_there(name)) << page.path << ": " << name;
    }
  }
  EXPECT_GT(named, 150u);
}

// Adds the identifiers in a text that are more than one word: hammer_string, HammerString.
void add_identifiers(const std::string& text, std::set<std::string>& identifiers) {
  for (const Groups& match : matches_of(text, "[A-Za-z][A-Za-z0-9]*(_|[a-z][A-Z])[A-Za-z0-9_]*"))
    identifiers.insert(match[0]);
}

// The identifiers in the spans of code of a page, but for what stands for a user's own name.
std::set<std::string> identifiers_of(const std::string& page) {
  std::set<std::string> identifiers;
  for (const std::string& line : prose_of(page))
    for (const Groups& code : matches_of(line, kCode))
      add_identifiers(replaced(code[0], "(--|\\b(my_|x_|__))[a-z_]+|[A-Za-z_]*NAME[A-Za-z_]*", ""), identifiers);
  return identifiers;
}

// Measurements name what there was, as the changelog does.
TEST(Pages, NameIdentifiersThatExist) {
  std::set<std::string> existing;
  for (const SourceFile& file : sources()) {
    add_identifiers(file.path, existing);
    add_identifiers(file.text, existing);
  }
  std::size_t named = 0;
  for (const SourceFile& page : pages()) {
    if (page.path == "CHANGELOG.md" || page.path.starts_with("docs/measurements/")) continue;
    std::set<std::string> in_examples;
    for (const std::string& line : code_of(page.text)) add_identifiers(line, in_examples);
    for (const std::string& name : identifiers_of(page.text)) {
      ++named;
      EXPECT_TRUE(existing.contains(name) || in_examples.contains(name)) << page.path << ": " << name;
    }
  }
  EXPECT_GT(named, 400u);
}

// The range of blows and the spline of each example of the felt C4: one power law, and nothing after the spline.
std::vector<Groups> felts_of(const std::string& text) {
  return matches_of(text, R"("stiffness_n_per_m_alpha": 4\.5e9, "exponent": 2\.5[^{}\]]*\},\s*(?://[^\n]*)?\s*)"
                          R"(("impact": \{[^{}]*\}),\s*("spline": \{[^{}]*\})\s*\})");
}

TEST(Pages, ShowOneFelt) {
  const auto shipped = felts_of(text_of(fs::path(SOURCE_FOLDER) / "data/materials/felt_c4.json"));
  ASSERT_EQ(shipped.size(), 1u);
  std::set<std::string> shown;
  for (const SourceFile& page : pages())
    for (const Groups& felt : felts_of(page.text)) {
      shown.insert(page.path);
      EXPECT_EQ(felt[1], shipped[0][1]) << page.path;
      EXPECT_EQ(felt[2], shipped[0][2]) << page.path;
    }
  EXPECT_EQ(shown, (std::set<std::string>{"README.md", "docs/how-it-works/knots.md", "docs/reference/materials.md",
                                          "docs/start/tutorial.md"}));
}

}  // namespace
}  // namespace contactspline::testing
