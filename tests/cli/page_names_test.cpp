// SPDX-License-Identifier: MIT
// Every key, subcommand and option that a page names exists. The readers are asked for their keys: each object of
// each file that ships, and of each example of the pages, is read once with a key more, and the refusal lists what is
// allowed there. `--help` is asked for the subcommands and options.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/expressions.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;
using Names = std::set<std::string>;

struct Page {
  std::string path;
  std::string prose, code;                                 ///< outside and inside its blocks of code
  std::map<std::string, std::vector<std::string>> blocks;  ///< by language
};

Page page_of(const std::string& path, const std::string& text) {
  Page page{path, {}, {}, {}};
  std::string language;
  bool in_code = false;
  for (const std::string& line : lines_of(text)) {
    const bool is_fence = line.starts_with("```");
    if (is_fence && !in_code) page.blocks[language = line.substr(3)].emplace_back();
    if (is_fence) in_code = !in_code;
    if (is_fence) continue;
    (in_code ? page.code : page.prose) += line + "\n";
    if (in_code) page.blocks[language].back() += line + "\n";
  }
  return page;
}

// Measurements name what there was, as the changelog does.
std::vector<Page> pages() {
  const fs::path source = SOURCE_FOLDER;
  std::vector<Page> pages{page_of("README.md", read_file(source / "README.md"))};
  for (const auto& entry : fs::recursive_directory_iterator(source / "docs")) {
    const std::string path = fs::relative(entry.path(), source).generic_string();
    if (path.ends_with(".md") && !path.starts_with("docs/measurements/"))
      pages.push_back(page_of(path, read_file(entry.path())));
  }
  return pages;
}

// The first group of each match.
std::vector<std::string> matches(const std::string& text, const char* expression) {
  std::vector<std::string> found;
  for (const Groups& match : matches_of(text, expression)) found.push_back(match[1]);
  return found;
}

void add(const std::vector<std::string>& from, Names& to) {
  to.insert(from.begin(), from.end());
}

const std::vector<std::string>& blocks_of(const Page& page, const std::string& language) {
  static const std::vector<std::string> none;
  const auto found = page.blocks.find(language);
  return found == page.blocks.end() ? none : found->second;
}

Json parsed(const std::string& json) {
  return Json::parse(json, nullptr, true, true);  // with comments
}

// A block of a page as a file. Keys without braces are added to the file that the page shows first.
Json whole(const std::string& block, const Page& page) {
  if (block.starts_with("{") || block.starts_with("//")) return parsed(block);
  Json file = parsed(blocks_of(page, "json").front());
  file.update(parsed("{" + block.substr(0, block.find_last_of(",")) + "}"));
  return file;
}

/// Asks the readers of input files for the keys that they allow.
class Readers {
 public:
  explicit Readers(const std::vector<Page>& pages) {
    for (const Page& page : pages) write_examples(page);
    for (const Page& page : pages)
      for (const std::string& block : blocks_of(page, "json")) ask(whole(block, page), page.path);
    for (const char* folder : {"data", "examples/keyboards", "examples/instruments"})
      for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOURCE_FOLDER) / folder))
        if (entry.path().extension() == ".json") ask(parsed(read_file(entry.path())), entry.path().filename());
    ask_about_curves();
  }

  [[nodiscard]] const Names& keys() const { return keys_; }
  [[nodiscard]] std::size_t objects() const { return asked_.size(); }

 private:
  // The files that other examples name.
  void write_examples(const Page& page) {
    std::string all;
    for (const std::string& block : blocks_of(page, "json")) {
      all += block;
      const auto name = matches(block, "^\\{\\s*\"name\": \"([a-z0-9_]+)\"");
      if (!name.empty()) write_file(box_ / (name[0] + ".json"), block);
    }
    const auto curves = matches(all, "\"([a-z0-9_]+\\.csv)\"");
    const std::vector<std::string>& shown = blocks_of(page, "csv");
    for (std::size_t i = 0; i < std::min(curves.size(), shown.size()); ++i) write_file(box_ / curves[i], shown[i]);
  }

  void ask(const Json& file, const std::string& name) {
    if (file.value("instrument", "") == "bell") return;  // a model of one's own: package.own_plugin plays it
    const Words command =
        file.contains("pulses") || file.contains("tables") || file.contains("struck") || file.contains("recordings")
            ? Words{"fit", "asked.json", "-o", "fitted.json"}
        : file.contains("count")    ? Words{"dataset", "asked.json", "-o", "out"}
        : file.contains("events")   ? Words{"render", "asked.json", "-o", "a.wav"}
        : file.contains("bristles") ? Words{"inspect", "asked.json"}
                                    : Words{"generate", "asked.json", "-o", "out"};
    const Json flat = file.flatten();
    for (const auto& [place, value] : flat.items())
      for (Json::json_pointer at = Json::json_pointer(place).parent_pointer();; at = at.parent_pointer()) {
        if (file[at].is_object()) ask(file, at, command, name);
        if (at.empty()) break;
      }
  }

  // One object, unless one at such a place with such keys was asked about.
  void ask(const Json& file, const Json::json_pointer& at, const Words& command, const std::string& name) {
    std::string known = command[0] + replaced(at.to_string(), "[0-9]", "");
    for (const auto& item : file[at].items()) known += " " + item.key();
    if (!asked_.insert(known).second) return;
    Json changed = file;
    changed[at]["asked"] = 0;
    write_file(box_ / "asked.json", changed.dump());
    const Outcome outcome = run({.arguments = command, .folder = box_.path()});
    const auto allowed = matches(outcome.err, "asked: unknown key; allowed: (.*)");
    ASSERT_EQ(allowed.size(), 1u) << name << at.to_string() << ": " << outcome.err;
    add(matches(allowed[0], "([a-z0-9_]+)"), keys_);
  }

  // The columns of a measured curve.
  void ask_about_curves() {
    write_file(box_ / "felt_synthetic.csv", "asked,force_n\n0,0\n");
    fs::copy_file(fs::path(SOURCE_FOLDER) / "data/materials/felt_synthetic.json", box_ / "asked.json",
                  fs::copy_options::overwrite_existing);
    const Outcome outcome = run({.arguments = {"generate", "asked.json", "-o", "out"}, .folder = box_.path()});
    const auto units = matches(outcome.err, "header compression_UNIT,force_UNIT \\(([a-z, ]+);");
    ASSERT_EQ(units.size(), 1u) << outcome.err;
    for (const std::string& unit : matches(units[0], "([a-z]+)")) keys_.insert("compression_" + unit);
  }

  Sandbox box_;
  Names asked_, keys_;
};

// The names of parameters, events and outputs, which stand in the lists of the runtime.
Names listed_names() {
  Names names;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOURCE_FOLDER) / "runtime"))
    if (entry.is_regular_file()) add(matches(read_file(entry.path()), "\"([a-z][a-z0-9_]*)\""), names);
  return names;
}

// The keys that a page shows in its examples, that its tables of keys name, and that its prose names by their unit.
// An `x_` is for any control.
Names keys_of(const Page& page) {
  Names keys;
  for (const std::string& block : blocks_of(page, "json")) add(matches(block, "\"([a-z][a-z0-9_]*)\":"), keys);
  const char* heading = "^\\| key( of `?[a-z ]+`?)? \\|";
  bool of_keys = false;
  for (const std::string& line : lines_of(page.prose)) {
    of_keys = line.starts_with("|") && (of_keys || first_match(line, heading));
    if (of_keys) add(matches(line.substr(0, line.find('|', 1)), "`([a-z][a-z0-9_]*)`"), keys);
  }
  add(matches(page.prose, "`([a-z][a-z0-9_]*_(m|m2|kg|s|hz|n|pa|j|w|rad|db|cents|ratio|alpha|per_s|per_m))`"), keys);
  std::erase_if(keys, [](const std::string& key) { return key.starts_with("x_"); });
  return keys;
}

// The keys of what the program prints as JSON.
Names printed_keys() {
  Names keys;
  for (const Words& command :
       {Words{"inspect", "felt_c4", "--json"}, Words{"inspect", "felt_c4", "--compare", "--json"},
        Words{"impact", "felt_c4", "--json"}})
    add(matches(succeed({.arguments = command}), "\"([a-z0-9_.]+)\":"), keys);
  return keys;
}

Names without(Names names, const Names& known) {
  std::erase_if(names, [&](const std::string& name) { return known.contains(name); });
  return names;
}

TEST(PageNames, OfKeysAreReadOrListedOrPrinted) {
  const std::vector<Page> all = pages();
  const Readers readers(all);
  Names known = readers.keys();
  known.merge(listed_names());
  known.merge(printed_keys());
  std::size_t named = 0;
  for (const Page& page : all) {
    named += keys_of(page).size();
    for (const std::string& key : without(keys_of(page), known)) ADD_FAILURE() << page.path << ": " << key;
  }
  EXPECT_GT(readers.objects(), 150u);
  EXPECT_GT(named, 250u);
  const Page wrong = page_of("wrong.md",
                             "Write fewer modes into the file (`max_frequency_hz`).\n\n| key | range |\n"
                             "|---|---|\n| `sise`, `name` | 1 |\n\n```json\n{ \"nmae\": 1 }\n```\n");
  EXPECT_EQ(without(keys_of(wrong), known), (Names{"max_frequency_hz", "nmae", "sise"}));
}

/// Asks the program for its subcommands and their options.
class Program {
 public:
  Program() { ask({}); }

  // A command line that a page shows: what it names that does not exist. `begin`: after the program's name.
  [[nodiscard]] std::vector<std::string> unknown_in(const Words& line) const {
    std::vector<std::string> unknown;
    std::string command;
    for (const std::string& word : line) {
      if (helps_.contains(command + " " + word))
        command += " " + word;
      else if (&word == &line.front() && !word.starts_with("-"))
        unknown.push_back(word);
      if (word.starts_with("-") && word != "-" && !has(command, word)) unknown.push_back(word);
    }
    return unknown;
  }

  [[nodiscard]] bool is_subcommand(const std::string& word) const { return helps_.contains(" " + word); }

  // An option of any subcommand.
  [[nodiscard]] bool has_option(const std::string& option) const {
    return std::ranges::any_of(helps_, [&](const auto& help) { return has(help.first, option); });
  }

 private:
  void ask(const Words& words) {
    const std::string help = succeed({.arguments = followed_by(words, {"--help"})});
    std::string command;
    for (const std::string& word : words) command += " " + word;
    helps_[command] = help;
    const auto begin = help.find("\nSubcommands:");
    if (begin == std::string::npos) return;
    const std::string subcommands = help.substr(begin, help.find("\n\n", begin) - begin);
    for (const std::string& word : matches(subcommands, "\n  ([a-z-]+) ")) ask(followed_by(words, {word}));
  }

  [[nodiscard]] bool has(const std::string& command, const std::string& option) const {
    const auto options = matches(helps_.at(command), "[ ,](--?[a-z0-9-]+)");
    return std::ranges::find(options, option) != options.end();
  }

  std::map<std::string, std::string> helps_;  ///< by subcommand
};

// The command lines of a page, from the word after the program's name: in its blocks, in its indented lines and in
// its spans of code, where the name may be left out before a subcommand.
std::vector<std::string> command_lines(const Page& page, const Program& program) {
  std::vector<std::string> lines;
  for (const std::string& block : blocks_of(page, "sh"))
    for (const std::string& line : matches(block, "(?:^|\n)contactspline ([^#>|&\n]*)")) lines.push_back(line);
  for (const std::string& line : matches(page.prose, "\n    (?:[a-z/]*/)?contactspline ([^#>|&\n]*)"))
    lines.push_back(line);
  for (const std::string& span : matches(page.prose, "`([^`\n]+)`")) {
    const std::string first = span.substr(0, span.find(' '));
    if (first == "contactspline" && first != span) lines.push_back(span.substr(first.size() + 1));
    if (program.is_subcommand(first)) lines.push_back(span);
  }
  return lines;
}

// What a page names of the command line and does not exist.
std::vector<std::string> unknown_options(const Page& page, const Program& program) {
  std::vector<std::string> unknown;
  for (const std::string& line : command_lines(page, program)) {
    std::istringstream words(line);
    for (const std::string& word : program.unknown_in({std::istream_iterator<std::string>(words), {}}))
      unknown.push_back(line + ": " + word);
  }
  for (const std::string& option : matches(page.prose, "`(--[a-z0-9-]+)[^`]*`"))
    if (!program.has_option(option)) unknown.push_back(option);
  return unknown;
}

TEST(PageNames, OfSubcommandsAndOptionsAreInTheHelp) {
  const Program program;
  std::size_t lines = 0;
  for (const Page& page : pages()) {
    lines += command_lines(page, program).size();
    for (const std::string& unknown : unknown_options(page, program)) ADD_FAILURE() << page.path << ": " << unknown;
  }
  EXPECT_GT(lines, 60u);
  const Page wrong = page_of("wrong.md",
                             "`contactspline inspekt felt_c4` `inspect --stems DIR` `--speedz`\n\n"
                             "    build/contactspline render mass-barrier --channel 1   # --not-here\n\n"
                             "```sh\ncontactspline list --all\n```\n");
  EXPECT_EQ(unknown_options(wrong, program),
            (std::vector<std::string>{"list --all: --all", "render mass-barrier --channel 1   : --channel",
                                      "inspekt felt_c4: inspekt", "inspect --stems DIR: --stems", "--speedz"}));
}

}  // namespace
}  // namespace contactspline::testing
