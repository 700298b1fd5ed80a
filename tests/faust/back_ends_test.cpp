// SPDX-License-Identifier: MIT
// Every program and every kind of emitted material through every back end of the installed Faust but C++: the build
// compiles them as C++ in both precisions, for the tests of agreement and for the plug-ins. wast is not compiled: it
// is the text of wasm.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "faust_command.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

namespace fs = std::filesystem;

/// The instruments, and the probe on each kind of emitted material. A double-precision instrument differs from a
/// single-precision one by its type names alone, which the probes show as well.
std::vector<fs::path> programs(const std::string& precision) {
  std::vector<fs::path> found;
  if (precision == "single")
    for (const auto& entry : fs::directory_iterator(kFaustSources))
      if (entry.path().extension() == ".dsp") found.push_back(entry.path());
  for (const char* material : kMaterials)
    found.push_back(fs::path(kGenerated) / ("probe_" + std::string(material) + ".dsp"));
  std::ranges::sort(found);
  return found;
}

struct BackEnd {
  std::string language;
  std::string listed_as;  ///< in `faust --version`
};

std::ostream& operator<<(std::ostream& out, const BackEnd& back_end) {
  return out << back_end.language;
}

class BackEndTest : public ::testing::TestWithParam<std::tuple<BackEnd, std::string>> {};

TEST_P(BackEndTest, CompilesEveryProgram) {
  const auto& [back_end, precision] = GetParam();
  if (run(std::string(kFaust) + " --version").output.find(back_end.listed_as + '\n') == std::string::npos)
    GTEST_SKIP() << kFaust << " was built without the back end \"" << back_end.listed_as << '"';
  const auto all = programs(precision);
  ASSERT_GE(all.size(), 2u) << "no programs to compile";
  const auto folder = empty_folder(back_end.language + '_' + precision);
  for (const auto& program : all) {
    const auto output = folder / (program.stem().string() + '.' + back_end.language);
    const auto outcome = run_faust_compiler("-lang " + back_end.language + " -" + precision, program, output);
    EXPECT_EQ(outcome.exit_code, 0) << program << ": " << outcome.output;
    EXPECT_TRUE(fs::exists(output) && fs::file_size(output) > 0) << program << ": no output";
  }
  Measured() << all.size() << " programs";
}

INSTANTIATE_TEST_SUITE_P(
    Faust, BackEndTest,
    ::testing::Combine(::testing::Values(BackEnd{"c", "DSP to C"}, BackEnd{"llvm", "DSP to LLVM IR"},
                                         BackEnd{"interp", "DSP to Interpreter"},
                                         BackEnd{"wasm", "DSP to WebAssembly (wast/wasm)"}),
                       ::testing::Values("single", "double")),
    [](const auto& test) { return std::get<0>(test.param).language + '_' + std::get<1>(test.param); });

}  // namespace
}  // namespace contactspline::testing
