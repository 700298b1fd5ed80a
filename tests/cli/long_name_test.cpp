// SPDX-License-Identifier: MIT
// A name of an output that the file system does not take is refused before anything is computed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cpu_time.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

struct LongName {
  std::string option;
  Words words;
};

TEST(LongName, IsRefusedAtOnce) {
  const Sandbox box;
  const std::string name(300, 'a'), sound = name + ".wav", figure = name + ".svg", within = name + "/a.wav";
  const std::vector<LongName> cases = {
      {"--output", {"render", "--score", "fur_elise", "-o", sound}},
      {"--output", {"render", "--score", "fur_elise", "-o", within}},
      {"--figure", {"render", "--score", "fur_elise", "-o", "a.wav", "--figure", figure}},
      {"--stems", {"render", "--score", "fur_elise", "-o", "a.wav", "--stems", name}},
      {"--output", {"generate", "piano", "-o", name}},
      {"--depfile", {"generate", "piano", "-o", ".", "--depfile", name}},
      {"--figure", {"inspect", "felt_c4", "--compare", "--figure", figure}},
      {"--figure", {"impact", "felt_c4", "--speeds", "0.1", "6", "200", "--figure", figure}}};
  const double nothing = cpu_time_s({.arguments = {"--version"}});
  for (const auto& [option, words] : cases) {
    SCOPED_TRACE(fmt::format("{} {}", words[0], option));
    const Call call{.arguments = words, .folder = box.path()};
    expect_refused(run(call), option + ": the name has 30", "allowed: a name of at most 255 bytes");
    EXPECT_LT(cpu_time_s(call), 3 * nothing + 0.005);
  }
  EXPECT_TRUE(box.listing().empty());
}

TEST(LongName, MayHave255Bytes) {
  const Sandbox box;
  std::string sound(251, 'a');
  sound += ".wav";
  succeed({.arguments = {"render", "mass-barrier", "--duration", "0.01", "-o", sound}, .folder = box.path()});
}

}  // namespace
}  // namespace contactspline::testing
