// SPDX-License-Identifier: MIT
// Files damaged at random: what becomes of each is either accepted or refused in one readable line.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/paths.hpp"
#include "generator/support/embedded_files.hpp"
#include "generator/support/error.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {

inline std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

inline std::vector<std::string> texts_of(std::span<const EmbeddedFile> shipped, std::string_view suffix) {
  std::vector<std::string> texts;
  for (const auto& text : shipped)
    if (text.name.ends_with(suffix)) texts.emplace_back(text.content);
  return texts;
}

/// Damages texts; `keys` are inserted beside what breaks any JSON.
class Mutator {
 public:
  Mutator(unsigned seed, const std::string& keys)
      : random_(seed),
        tokens_(words(
            "null true { } [ ] : , \" \\ \\u0000 \\ud800 \\n // /* */ \xff \xc3 \xef\xbb\xbf \x7f \xc2\x85 \"\" "
            "\"a\\nb\":1, {\"a\":{\"a\":1}} [[[[[[[[ " +
            keys)) {}

  std::size_t below(std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_); }

  std::string damaged(std::string text) {
    for (std::size_t count = 1 + below(3); count > 0; --count) damage(text);
    return text;
  }

 private:
  void damage(std::string& text) {
    if (text.empty()) return;
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(text.size() - at, 1 + below(12));
    switch (below(8)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        return;
      case 1:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        return;
      case 2:
        text.erase(at, length);
        return;
      case 3:
        text.insert(at, text.substr(at, length));
        return;
      case 4:
        text.insert(at, any_of(below(2) == 0 ? tokens_ : numbers_));
        return;
      case 5:
        text.resize(at);
        return;
      default:
        replace_number(text, at);
    }
  }

  // Keeps the file readable, so that what follows the parser is reached.
  void replace_number(std::string& text, std::size_t from) {
    constexpr auto kDigits = "0123456789";
    const auto begin = text.find_first_of(kDigits, from);
    if (begin == std::string::npos) return;
    const auto end = std::min(text.find_first_not_of("0123456789.e+-", begin), text.size());
    text.replace(begin, end - begin, below(2) == 0 ? any_of(numbers_) : some_number());
  }

  const std::string& any_of(const std::vector<std::string>& some) { return some[below(some.size())]; }

  std::string some_number() {
    const double exponent = std::uniform_real_distribution<double>(-12, 19)(random_);
    return nlohmann::json(std::pow(10, exponent)).dump();
  }

  std::mt19937 random_;
  std::vector<std::string> tokens_;
  std::vector<std::string> numbers_ = words(
      "0 -0 1 -1 0.1 0.5 0.999 1.0000001 3 10 16 63 64 65536 65537 1e-9 1e-320 1e18 1e300 1e308 1e309 -1e999 "
      "4294967297 1e .5 +1 0x10 NaN");
};

/// Damages `texts` in so many rounds. `file` is the name their messages begin with. One round in `accepted_one_in`
/// must be taken, and one in `refused_one_in` refused: otherwise the damage misses.
inline void damage_files(const std::vector<std::string>& texts, std::string_view file, const std::string& keys,
                         int rounds, TakeBytes take, int accepted_one_in = 20, int refused_one_in = 4) {
  ASSERT_FALSE(texts.empty());
  Mutator mutator(20260101, keys);
  int taken = 0, refused = 0;
  std::set<std::string> messages;
  for (int round = 0; round < rounds && !::testing::Test::HasFailure(); ++round) {
    const std::string text = mutator.damaged(texts[mutator.below(texts.size())]);
    try {
      take(text);
      ++taken;
    } catch (const BadInput& error) {
      ++refused;
      messages.insert(error.what());
      EXPECT_EQ(fault_of_message(error.what(), file), "") << error.what();
    } catch (const std::exception& error) {
      ADD_FAILURE() << "not BadInput: " << error.what() << "\n" << text;
    }
  }
  Measured() << taken << " taken, " << refused << " refused with " << messages.size() << " different messages";
  EXPECT_GE(taken, rounds / accepted_one_in);
  EXPECT_GE(refused, rounds / refused_one_in);
}

}  // namespace contactspline::testing
