// SPDX-License-Identifier: MIT
// One term for one thing (docs/reference/glossary.md): identifiers, keys and messages use none of the terms that were
// given up.
#include <gtest/gtest.h>

#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "source/source_tree.hpp"

namespace contactspline::testing {
namespace {

// Words that no identifier and no key may be made of, with the term to use. Ordinary words of English are not among
// them.
const std::map<std::string, std::string> kWords = {{"levelled", "equioscillating"},
                                                   {"serving", "compliance fraction"},
                                                   {"outlook", "step candidates"},
                                                   {"landing", "crossed knots"},
                                                   {"allowed_hpp", "validators"},
                                                   {"contest", "paired timer"},
                                                   {"duty", "workload"},
                                                   {"duties", "workloads"},
                                                   {"admittance", "receptance"},
                                                   {"admittances", "receptances"},
                                                   {"picture", "figure"},
                                                   {"pictures", "figures"}};

// Whole identifiers that were given up.
const std::set<std::string> kIdentifiers = {
    "ForceLine",     "FeltArrays", "FeltTables", "HammerFlight",  "StrikeArrays", "StrikeTables",
    "StruckModes",   "StruckRow",  "Flight",     "Outlook",       "Landing",      "made_rising",
    "stored_right",  "GradedWays", "BentLaw",    "kOutOfReach_m", "kWorthIt",     "needed_line",
    "contact_input", "Contest",    "Duty",       "kServingShare", "kCaught_m"};

// Words in messages, help, comments and docs that were given up.
const std::vector<std::string> kPhrases = {"says nothing to", "says nothing of", "picture",  "gives way",
                                           "give way",        "coming sample's", "heard at", "output hears"};

// C++ or Faust without comments; strings and comments go to `texts`.
std::string code_of(const std::string& text, std::vector<std::string>& texts) {
  static const std::regex token(
      R"re("(?:\\.|[^"\\\n])*"|R"\w*\([^]*?\)\w*"|//[^\n]*|/\*[^]*?\*/|'(?:\\.|[^'\\\n])')re");
  std::string code;
  auto from = text.cbegin();
  for (std::sregex_iterator match(text.begin(), text.end(), token), end; match != end; ++match) {
    code.append(from, (*match)[0].first);
    texts.push_back(match->str());
    code += ' ';
    from = (*match)[0].second;
  }
  return code.append(from, text.cend());
}

// kMaxWayHere -> k, max, way, here
std::vector<std::string> words_of(const std::string& identifier) {
  static const std::regex word("[A-Z]+(?![a-z])|[A-Z]?[a-z]+");
  std::vector<std::string> words;
  for (std::sregex_iterator match(identifier.begin(), identifier.end(), word), end; match != end; ++match) {
    std::string lower = match->str();
    std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    words.push_back(lower);
  }
  return words;
}

// What is wrong with the identifiers in a piece of code, one line each.
std::set<std::string> wrong_identifiers(const std::string& code) {
  static const std::regex identifier("[A-Za-z_][A-Za-z0-9_]*");
  std::set<std::string> wrong;
  for (std::sregex_iterator match(code.begin(), code.end(), identifier), end; match != end; ++match) {
    if (kIdentifiers.contains(match->str())) wrong.insert(match->str());
    for (const std::string& word : words_of(match->str()))
      if (kWords.contains(word)) wrong.insert(match->str() + ": use " + kWords.at(word));
  }
  return wrong;
}

std::set<std::string> wrong_phrases(const std::string& text) {
  std::set<std::string> wrong;
  for (const std::string& phrase : kPhrases)
    if (text.find(phrase) != std::string::npos) wrong.insert(phrase + " in: " + text.substr(0, 100));
  return wrong;
}

TEST(Vocabulary, WordsAreFoundInEveryKindOfIdentifier) {
  for (const auto* code : {"plot_picture", "kLongestDuty", "duty_", "PictureOf", "the_contest_of", "Landing"})
    EXPECT_FALSE(wrong_identifiers(code).empty()) << code;
  for (const auto* code : {"depicture", "dutyless", "way", "give", "least", "most", "need", "fall", "expect", "few"})
    EXPECT_TRUE(wrong_identifiers(code).empty()) << code;
  std::vector<std::string> texts;
  EXPECT_EQ(code_of("a /* way */ b \"way \\\" x\" // give\nc", texts), "a   b    \nc");
  EXPECT_EQ(texts, (std::vector<std::string>{"/* way */", "\"way \\\" x\"", "// give"}));
  EXPECT_FALSE(wrong_phrases("// the force heard at the bridge").empty());
  EXPECT_TRUE(wrong_phrases("// the output that sounds").empty());
}

TEST(Vocabulary, NoIdentifierUsesATermThatWasGivenUp) {
  const auto files = source_files({"generator", "runtime", "hosts", "examples", "bench"}, {".cpp", ".hpp"});
  ASSERT_GT(files.size(), 100u);
  for (const SourceFile& file : files) {
    std::vector<std::string> texts;
    for (const std::string& wrong : wrong_identifiers(code_of(file.text, texts)))
      ADD_FAILURE() << file.path << ": " << wrong;
  }
}

TEST(Vocabulary, NoFaustIdentifierDoes) {
  for (const SourceFile& file : source_files({"faust", "generated"}, {".lib", ".dsp", ".hpp"})) {
    std::vector<std::string> texts;
    for (const std::string& wrong : wrong_identifiers(code_of(file.text, texts)))
      ADD_FAILURE() << file.path << ": " << wrong;
  }
}

TEST(Vocabulary, NoKeyDoes) {
  for (const SourceFile& file : source_files({"data", "generated"}, {".json"})) {
    static const std::regex key("\"([A-Za-z0-9_]+)\"\\s*:");
    for (std::sregex_iterator match(file.text.begin(), file.text.end(), key), end; match != end; ++match)
      for (const std::string& wrong : wrong_identifiers((*match)[1])) ADD_FAILURE() << file.path << ": " << wrong;
  }
}

TEST(Vocabulary, NoMessageCommentOrPageDoes) {
  for (const SourceFile& file :
       source_files({"generator", "runtime", "templates", "docs"}, {".cpp", ".hpp", ".in", ".md"})) {
    std::vector<std::string> texts;
    if (file.path.ends_with(".in") || file.path.ends_with(".md"))
      texts.push_back(file.text);
    else
      code_of(file.text, texts);
    for (const std::string& text : texts)
      for (const std::string& wrong : wrong_phrases(text)) ADD_FAILURE() << file.path << ": " << wrong;
  }
}

}  // namespace
}  // namespace contactspline::testing
