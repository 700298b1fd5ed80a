// SPDX-License-Identifier: MIT
// `-` in place of a file: what it names and writes is what the file itself would, and errors name standard input.
#include <gtest/gtest.h>

#include <string>

#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

class StandardInput : public ::testing::Test {
 protected:
  StandardInput() { write_file(box_ / "probe.json", material(16)); }

  [[nodiscard]] Outcome reading(const std::string& file, const Words& arguments) const {
    return run({.arguments = arguments, .folder = box_.path(), .standard_input = box_ / file});
  }
  [[nodiscard]] std::string show(const std::string& name) const { return printed(box_, {"show", name}); }

  Sandbox box_;
};

TEST_F(StandardInput, IsAFileForEachCommand) {
  for (const char* name : {"probe", "tom", "string_c4", "piano"}) {
    const std::string file = std::string(name) + ".json";
    if (file != "probe.json") write_file(box_ / file, show(name));
    EXPECT_EQ(succeed(reading(file, {"inspect", "-"})), printed(box_, {"inspect", file})) << name;
    if (file == "piano.json") continue;  // takes seconds
    EXPECT_EQ(succeed(reading(file, {"generate", "-", "--emit", "json", "-o", "-"})),
              printed(box_, {"generate", file, "--emit", "json", "-o", "-"}));
  }
  EXPECT_EQ(succeed(reading("probe.json", {"impact", "felt_c4", "-", "--csv"})),
            printed(box_, {"impact", "felt_c4", "probe.json", "--csv"}));
}

// Of a mass-barrier, a score and a MIDI file: the same bytes.
TEST_F(StandardInput, IsPlayed) {
  write_file(box_ / "stroke.json", kStroke);
  write_file(box_ / "song.mid", std::string("MThd\0\0\0\6\0\0\0\1\0\x60MTrk\0\0\0\x0c", 22) +  // one note
                                    std::string("\0\x90\x3c\x64\x10\x80\x3c\0\0\xff\x2f\0", 12));
  const auto expect_same = [&](const std::string& file, const Words& before, const Words& after) {
    for (const std::string name : {"-", file.c_str()})
      succeed(reading(
          file, followed_by(followed_by(before, {name}), followed_by(after, {"-o", name + "a.wav", "--no-figure"}))));
    EXPECT_TRUE(read_file(box_ / "-a.wav") == read_file(box_ / (file + "a.wav"))) << file;
  };
  expect_same("probe.json", {"render", "mass-barrier", "--duration", "0.1", "--material"}, {});
  expect_same("stroke.json", {"render"}, {});
  expect_same("stroke.json", {"render", "--score"}, {});
  expect_same("song.mid", {"render"}, {"--rate", "8000"});
}

TEST_F(StandardInput, IsNamedInErrors) {
  write_file(box_ / "bad.json", R"({"name": "bad", "kontact": {}})");
  expect_refused(reading("bad.json", {"inspect", "-"}), "standard input: kontact: unknown key", "allowed: name");
  write_file(box_ / "empty.json", "");
  expect_refused(reading("empty.json", {"generate", "-", "-o", "out"}), "standard input: line 1, column 1",
                 "the file ends");
  expect_refused(reading("probe.json", {"render", "-", "-o", "a.wav"}), "standard input: file: is a material",
                 "allowed: a score");
  write_file(box_ / "large.json", std::string((1 << 20) + 1, ' '));
  expect_refused(reading("large.json", {"impact", "-"}), "standard input: file: is larger than 1 MiB", "allowed");
  expect_refused(reading("probe.json", {"generate", "-", "-o", "out", "--depfile", "d"}),
                 "--depfile: standard input is no file to depend on", "allowed: with material files");
  EXPECT_FALSE(fs::exists(box_ / "out"));
}

// What the text names is beside the working folder's files.
TEST_F(StandardInput, NamesFilesOfTheWorkingFolder) {
  write_file(box_ / "felt_synthetic.json", show("felt_synthetic"));
  write_file(box_ / "felt_synthetic.csv", show("felt_synthetic.csv"));
  EXPECT_EQ(succeed(reading("felt_synthetic.json", {"inspect", "-"})), printed(box_, {"inspect", "felt_synthetic"}));
}

}  // namespace
}  // namespace contactspline::testing
