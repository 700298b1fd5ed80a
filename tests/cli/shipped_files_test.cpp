// SPDX-License-Identifier: MIT
// Every file that ships through every command that takes it, also in a Debug build and under sanitizers. Scores are
// played by shipped_score_test.
#include <gtest/gtest.h>

#include <string>

#include "generator/support/embedded_files.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

class ShippedFiles : public ::testing::Test {
 protected:
  void run_all(const std::string& name, const std::vector<Words>& commands) {
    SCOPED_TRACE(name);
    for (const Words& command : commands) {
      const Outcome outcome = run({.arguments = command, .folder = box_.path()});
      EXPECT_EQ(outcome.exit_code, 0) << command.front() << ": " << outcome.err;
    }
  }
  void expect_generated(const std::string& name) {
    for (const std::string extension : {".lib", ".hpp", ".json"})
      EXPECT_TRUE(fs::exists(box_ / "out" / (name + extension))) << name << extension;
  }

  Sandbox box_;
};

TEST_F(ShippedFiles, MaterialsGoThroughEveryCommand) {
  for (const std::string& name : shipped_names(Shipped::kMaterials)) {
    run_all(name, {{"inspect", name, "--json"},
                   {"generate", name, "-o", "out"},
                   {"impact", name, "--rate", "44100"},
                   {"render", "mass-barrier", "--material", name, "--duration", "0.1", "-o", name + ".wav",
                    "--no-figure"}});
    expect_generated(name);
    EXPECT_GT(fs::file_size(box_ / (name + ".wav")), 1000u);
  }
}

TEST_F(ShippedFiles, ResonatorsGoThroughEveryCommand) {
  for (const std::string& name : shipped_names(Shipped::kResonators)) {
    run_all(name, {{"inspect", name, "--json"}, {"generate", name, "-o", "out"}});
    expect_generated(name);
  }
}

TEST_F(ShippedFiles, KeyboardsAreGenerated) {
  for (const std::string& name : shipped_names(Shipped::kKeyboards)) {
    run_all(name, {{"generate", name, "-o", "out"}});
    expect_generated(name);
  }
}

}  // namespace
}  // namespace contactspline::testing
