// SPDX-License-Identifier: MIT
// No file of somebody else is replaced: only what bears the mark of the program, what is empty, or with --force.
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "cases.hpp"
#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/expressions.hpp"

namespace contactspline::testing {
namespace {

// Two keys of the piano, with two segments each: its 88 keys take 1.6 s.
std::string small_keyboard() {
  std::string text(find_embedded(Shipped::kKeyboards, "piano.json")->content);
  for (const auto& [key, value] : {std::pair{"first_key", "60"},
                                   {"last_key", "61"},
                                   {"last_damped_key", "61"},
                                   {"first_double_key", "60"},
                                   {"first_triple_key", "60"},
                                   {"segments", "2"}})
    text = replaced(text, std::string(R"((")") + key + R"(": )[0-9]+)", std::string("$01") + value);
  return text;
}

/// A command and one of the files it writes; `other` makes the command write other bytes.
struct Writing {
  std::string test;
  Words command, other;
  std::string output;
};

void PrintTo(const Writing& writing, std::ostream* stream) {
  *stream << writing.test;
}

std::vector<Writing> all_writings() {
  const Words bounce = {"render", "mass-barrier", "--duration", "0.02", "-o", "a.wav"};
  const Words stroke = {"render", "--score", "stroke.json", "-o", "a.wav"};
  std::vector<Writing> writings = {{"figure_of_a_material",
                                    {"inspect", "felt_c4", "--figure", "a.svg"},
                                    {"inspect", "mb1", "--figure", "a.svg"},
                                    "a.svg"},
                                   {"figure_of_knots",
                                    {"inspect", "felt_c4", "--compare", "--figure", "a.svg"},
                                    {"inspect", "mb1", "--compare", "--figure", "a.svg"},
                                    "a.svg"},
                                   {"sound_of_a_bounce", bounce, followed_by(bounce, {"--mass", "0.1"}), "a.wav"},
                                   {"figure_of_a_bounce", bounce, followed_by(bounce, {"--mass", "0.1"}), "a.svg"},
                                   {"sound_of_a_score", stroke, followed_by(stroke, {"--signal", "force"}), "a.wav"},
                                   {"figure_of_a_score", stroke, followed_by(stroke, {"--signal", "force"}), "a.svg"},
                                   {"depfile_without_inputs",
                                    {"generate", "mb1", "--emit", "cpp", "-o", "out", "--depfile", "d"},
                                    {"generate", "mb1", "-o", "out", "--depfile", "d"},
                                    "d"},
                                   {"depfile",
                                    {"generate", "probe.json", "--emit", "cpp", "-o", "out", "--depfile", "d"},
                                    {"generate", "probe.json", "-o", "out", "--depfile", "d"},
                                    "d"}};
  for (const std::string ending : {".flac", ".ogg", ".aiff", ".png", ".pdf"}) {
    const bool is_figure = ending == ".png" || ending == ".pdf";
    const Words command = {"render", "mass-barrier", "--duration", "0.02", "-o", is_figure ? "a.wav" : "a" + ending};
    const Words with_figure =
        followed_by(command, is_figure ? Words{"--figure", "a" + ending} : Words{"--no-figure"});
    writings.push_back({ending.substr(1), with_figure, followed_by(with_figure, {"--mass", "0.1"}), "a" + ending});
  }
  for (const std::string extension : {"lib", "hpp", "json"}) {
    const auto emitted = [&](const std::string& name) {
      writings.push_back({name + "_" + extension, {"generate", name}, {}, name + "." + extension});
    };
    emitted("felt_live");
    emitted("felt_over_wood");
    writings.push_back({"keyboard_" + extension, {"generate", "keyboard.json"}, {}, "piano." + extension});
    writings.push_back({"string_c4_" + extension,
                        {"generate", "string_c4"},
                        {"generate", "string_c4", "--rate", "96000"},
                        "string_c4." + extension});
  }
  return writings;
}

class Overwriting : public ::testing::TestWithParam<Writing> {
 protected:
  Overwriting() {
    write_file(box / "probe.json", kProbeMaterial);
    write_file(box / "stroke.json", kStroke);
    write_file(box / "keyboard.json", small_keyboard());
  }

  [[nodiscard]] Call call(const Words& command) const { return {.arguments = command, .folder = box.path()}; }

  Sandbox box;
};

TEST_P(Overwriting, AFileOfSomebodyElseIsRefused) {
  const fs::path output = box / GetParam().output;
  write_file(output, "my own work\n");
  const auto before = box.listing();
  expect_refused(
      run(call(GetParam().command)), "",
      GetParam().output + ": file: exists, and this program did not write it; allowed: another name, or --force");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

TEST_P(Overwriting, AFileOfSomebodyElseIsAllowedByForce) {
  write_file(box / GetParam().output, "my own work\n");
  succeed(call(followed_by(GetParam().command, {"--force"})));
  EXPECT_NE(read_file(box / GetParam().output), "my own work\n");
}

TEST_P(Overwriting, AnEmptyFileIsAllowed) {
  write_file(box / GetParam().output, "");
  succeed(call(GetParam().command));
  EXPECT_NE(read_file(box / GetParam().output), "");
}

TEST_P(Overwriting, AFileOfTheProgramIsAllowed) {
  succeed(call(GetParam().command));
  const fs::path output = box / GetParam().output;
  const std::string first = read_file(output);
  if (GetParam().other.empty()) {
    write_file(output, first + "\n");  // as if another version had written it
    succeed(call(GetParam().command));
    EXPECT_EQ(read_file(output), first);
  } else {
    succeed(call(GetParam().other));
    EXPECT_NE(read_file(output), first);
  }
}

CONTACTSPLINE_CASES(Each, Overwriting, all_writings());

// The name of a material, not that of its file, names the outputs.
TEST(Overwrite, ACopyOfAMaterialDoesNotReplaceTheOriginal) {
  const Sandbox box;
  write_file(box / "probe.json", kProbeMaterial);
  write_file(box / "other.json", kProbeMaterial);
  const auto before = box.listing();
  expect_refused(run({.arguments = {"generate", "other.json"}, .folder = box.path()}), "./probe.json: file: exists",
                 "--force");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

TEST(Overwrite, AnInputIsRefusedInSpiteOfForce) {
  const Sandbox box;
  write_file(box / "probe.json", kProbeMaterial);
  write_file(box / "probe.svg", kProbeMaterial);
  const auto before = box.listing();
  for (const Words& command : {Words{"generate", "probe.json", "--force"},
                               Words{"inspect", "./probe.svg", "--figure", "probe.svg", "--force"},
                               Words{"render", "mass-barrier", "--material", "./probe.svg", "-o", "a.wav", "--figure",
                                     "probe.svg", "--force"}})
    expect_refused(run({.arguments = command, .folder = box.path()}), "", "is already an input or another output");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

TEST(Overwrite, ALinkToAFileOfSomebodyElseIsRefused) {
  const Sandbox box;
  write_file(box / "mine", "my own work\n");
  fs::create_symlink("mine", box / "mb1.lib");
  const auto before = box.listing();
  expect_refused(run({.arguments = {"generate", "mb1"}, .folder = box.path()}), "./mb1.lib: file: exists", "--force");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

TEST(Overwrite, AMakefileIsNoDepfile) {
  const Sandbox box;
  write_file(box / "Makefile", "all: mb1.hpp\n\nmb1.hpp: mb1.json\n\tcontactspline generate mb1.json\n");
  const auto before = box.listing();
  expect_refused(run({.arguments = {"generate", "mb1", "-o", "out", "--depfile", "Makefile"}, .folder = box.path()}),
                 "Makefile: file: exists", "--force");
  EXPECT_TRUE(box.listing() == before) << names_in(box.listing());
}

}  // namespace
}  // namespace contactspline::testing
