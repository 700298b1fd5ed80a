// SPDX-License-Identifier: MIT
// Damaged material files: each gives either output or one readable line that names the file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "generator/embedded.hpp"
#include "generator/emit.hpp"
#include "generator/error.hpp"

namespace contactspline::testing {
namespace {

constexpr int kMostSegments = 64;  // larger tables are slow, not different

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

const std::vector<std::string> kNumbers = words(
    "0 -0 1 -1 0.1 0.5 0.999 1.0000001 3 10 16 63 64 65536 65537 1e-9 1e-320 1e18 1e300 1e308 1e309 -1e999 "
    "4294967297 "
    "1e .5 +1 0x10 NaN");

const std::vector<std::string> kTokens = words(
    "null true { } [ ] : , \" \\ \\u0000 \\ud800 \\n // /* */ \xff \xc3 \xef\xbb\xbf \x7f \xc2\x85 \"name\" "
    "\"description\" \"contact\" \"impact\" \"spline\" \"knots\" \"segments\" \"exponent\" \"max_compression_m\" "
    "\"max_compression_m\":1e-3, \"uniform\" \"\" \"a\\nb\":1, {\"a\":{\"a\":1}} [[[[[[[[");

std::vector<std::string> json_of(std::span<const EmbeddedText> shipped) {
  std::vector<std::string> texts;
  for (const auto& text : shipped)
    if (text.file_name.ends_with(".json")) texts.emplace_back(text.content);
  return texts;
}

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

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
        text.insert(at, any_of(below(2) == 0 ? kTokens : kNumbers));
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
    text.replace(begin, end - begin, below(2) == 0 ? any_of(kNumbers) : some_number());
  }

  const std::string& any_of(const std::vector<std::string>& tokens) { return tokens[below(tokens.size())]; }

  std::string some_number() {
    const double exponent = std::uniform_real_distribution<double>(-12, 19)(random_);
    return nlohmann::json(std::pow(10, exponent)).dump();
  }

  std::mt19937 random_;
};

void expect_one_readable_line(const std::string& message) {
  EXPECT_TRUE(message.starts_with("fuzz.json: ")) << message;
  EXPECT_TRUE(message.find("; allowed: ") != std::string::npos ||
              message.find("; use an exponent") != std::string::npos ||
              message.find("; energies and stiffnesses must") != std::string::npos)
      << message;
  EXPECT_TRUE(std::ranges::all_of(message, [](unsigned char c) { return c >= 0x20 && c < 0x7f; })) << message;
  EXPECT_LT(message.size(), 500u) << message;
}

bool design_and_emit_material(const std::string& text, const Emitter& emitter, std::string& source) {
  const Material material = parse_material(text, "fuzz.json");
  if (material.spline.segments > kMostSegments) return false;
  const Spline spline = uniform_spline(material, "fuzz.json");
  source = emit(emitter, {material, spline, measure_quality(spline, material)}, "contactspline generate fuzz.json");
  return true;
}

/// What becomes of a file: false where it is left out as too slow.
using Generate = bool (*)(const std::string& text, const Emitter& emitter, std::string& source);

void damage_files(const std::vector<std::string>& files, int rounds, Generate generate) {
  Mutator mutator(20260101);
  int emitted = 0, refused = 0;
  std::set<std::string> messages;
  for (int round = 0; round < rounds && !::testing::Test::HasFailure(); ++round) {
    const Emitter& emitter = emitters()[static_cast<std::size_t>(round) % emitters().size()];
    const std::string text = mutator.damaged(files[mutator.below(files.size())]);
    std::string source;
    try {
      emitted += generate(text, emitter, source);
      EXPECT_TRUE(source.empty() || emitter.name != "json" || nlohmann::json::accept(source)) << text << source;
    } catch (const BadInput& error) {
      ++refused;
      messages.insert(error.what());
      expect_one_readable_line(error.what());
    } catch (const std::exception& error) {
      ADD_FAILURE() << "not BadInput: " << error.what() << "\n" << text;
    }
  }
  std::cout << emitted << " emitted, " << refused << " refused with " << messages.size() << " different messages\n";
  EXPECT_GE(emitted, rounds / 20);
  EXPECT_GE(refused, rounds / 4);
}

TEST(DamagedMaterial, GivesOutputOrOneReadableLine) {
  damage_files(json_of(embedded_texts()), 20'000, design_and_emit_material);
}

}  // namespace
}  // namespace contactspline::testing
