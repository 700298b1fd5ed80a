// SPDX-License-Identifier: MIT
// A file that another one names may be somebody else's, anywhere on the disk: no message shows what is in it.
#include <gtest/gtest.h>

#include <string>

#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

constexpr auto kCurve = R"({"name": "probe", "contact": {"curve": {"file": "../foreign", "shape": "hardening"}},
  "impact": {"mass_kg": 0.01, "max_speed_m_per_s": 2, "min_speed_m_per_s": 0.1},
  "spline": {"knots": "uniform", "segments": 8}})";
constexpr auto kInstrument = R"({"name": "probe", "bodies": [{"name": "bar", "resonator": "../foreign"}],
  "places": [{"name": "end", "body": "bar", "position_m": 0}], "outputs": [{"name": "end", "velocity_m_per_s": "end"}]})";
const std::string kScore = hammer_score("string_c4", "../foreign");
constexpr auto kPlayed = R"({"instrument": "../foreign", "duration_s": 1, "events": [{"time_s": 0}]})";

TEST(ForeignFile, IsNotShown) {
  const Sandbox box;
  fs::create_directory(box / "mine");
  for (const std::string foreign : {"secret:x:0:0:secret\n", "secret,x\n", "# secret\nsecret,x\n1,2\n", "secret\n",
                                    "\n secret = 1\n", "[secret]\n", "-----secret-----\n", "\"secret\" 1",
                                    "compression_secret,force_secret\n1,2\n", "compression_mm,secret\n1,2\n"}) {
    SCOPED_TRACE(foreign);
    write_file(box / "foreign", foreign);
    for (const auto& [text, command] : {std::pair<std::string, Words>{kCurve, Words{"inspect", "mine/file.json"}},
                                        {kInstrument, {"inspect", "mine/file.json"}},
                                        {kScore, {"render", "--score", "mine/file.json", "-o", "a.wav"}},
                                        {kPlayed, {"render", "--score", "mine/file.json", "-o", "a.wav"}},
                                        {"", {"inspect", "mine/../foreign"}}}) {
      write_file(box / "mine/file.json", text);
      const Outcome outcome = run({.arguments = command, .folder = box.path()});
      expect_refused(outcome, "", "foreign");
      EXPECT_EQ(outcome.err.find("secret"), std::string::npos) << outcome.err;
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
