// SPDX-License-Identifier: MIT
// Limits in characters count letters, not bytes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "generator/support/json_reader.hpp"
#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

// One byte, two, three and four; and two characters that make one letter.
const std::vector<std::string> kLetters = {"e",       "\u00e9",  "\u6f22",      "\U0001d11e",
                                           "e\u0301", "e\u036f", "\u0439\u0301"};

std::string repeated(const std::string& letter, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += letter;
  return text;
}

TEST(Characters, AreLetters) {
  for (const std::string& letter : kLetters)
    for (const int count : {0, 1, 200}) EXPECT_EQ(count_characters(repeated(letter, count)), count) << letter;
  EXPECT_EQ(count_characters("\u0301"), 1u);                // an accent without a letter
  EXPECT_EQ(count_characters("e\u0301\u0301\u0301e"), 4u);  // one accent belongs to its letter
  EXPECT_EQ(count_characters("e\u0370"), 2u);               // the first letter behind the accents
}

TEST(Characters, OfADescriptionAreAtMost200) {
  const Sandbox box;
  for (const std::string& letter : kLetters) {
    write_file(box / "probe.json", material(8, repeated(letter, 200)));
    succeed({.arguments = {"inspect", "probe.json"}, .folder = box.path()});
    write_file(box / "probe.json", material(8, repeated(letter, 201)));
    expect_refused(run({.arguments = {"inspect", "probe.json"}, .folder = box.path()}),
                   "probe.json: description: is too long", "allowed: one line of at most 200");
  }
}

TEST(Characters, OfTheNameOfAVoiceAreAtMost64) {
  const Sandbox box;
  const auto rendered = [&](const std::string& name) {
    write_file(box / "score.json", fmt::format(R"({{"instrument": "trichord_c4", "duration_s": 0.01,
      "voices": [{{"name": "{}"}}], "events": [{{"time_s": 0, "hammer_speed_m_per_s": 1}}]}})",
                                               name));
    return run(
        {.arguments = {"render", "--score", "score.json", "-o", "a.wav", "--no-figure"}, .folder = box.path()});
  };
  for (const std::string& letter : kLetters) {
    EXPECT_EQ(rendered(repeated(letter, 64)).exit_code, 0) << letter;
    expect_refused(rendered(repeated(letter, 65)), "score.json: voices[0].name: has 65 characters",
                   "allowed: 1 to 64 characters");
  }
}

}  // namespace
}  // namespace contactspline::testing
