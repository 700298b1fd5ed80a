// SPDX-License-Identifier: MIT
// A good material file to damage, for tests of what is refused.
#pragma once

#include <string>

#include "bad_input.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {

/// A material file with every key.
inline constexpr auto kGood = R"({
  "name": "probe",
  "description": "a probe",
  "contact": { "stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5 },
  "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },
  "spline": { "knots": "uniform", "segments": 8, "max_compression_m": 1e-3 }
})";

/// kGood with its one `from` replaced.
inline std::string changed(const std::string& from, const std::string& to) {
  return changed(kGood, from, to);
}

/// kGood with another spline, with its impact or without.
inline std::string with_spline(const std::string& spline, bool impact = true) {
  std::string text =
      changed(R"({ "knots": "uniform", "segments": 8, "max_compression_m": 1e-3 })", "{ " + spline + " }");
  if (impact) return text;
  const std::string range =
      R"(  "impact": { "mass_kg": 0.003, "max_speed_m_per_s": 6.0, "min_speed_m_per_s": 0.1 },)";
  return text.erase(text.find(range), range.size());
}

/// The bad file, as probe.json, is refused by `generate` in one line; nothing is written, not even beside what is
/// there.
inline void expect_refused_without_a_trace(const BadFile& bad) {
  const auto& [test, text, key, says] = bad;
  const Sandbox box;
  write_file(box / "probe.json", text);
  fs::create_directories(box / "out");
  fs::create_directories(box / "tmp");
  for (const auto name : {"probe.lib", "probe.hpp", "probe.json"}) write_file(box / "out" / name, "old");
  const auto before = box.listing();
  const auto outcome = run({.arguments = {"generate", "probe.json", "-o", "out", "--depfile", "out/probe.d"},
                            .folder = box.path(),
                            .environment = {{"TMPDIR", (box / "tmp").string()}}});
  expect_refused(outcome, "probe.json: " + key, says);
  EXPECT_EQ(names_in(box.listing()), names_in(before));
  EXPECT_TRUE(box.listing() == before);
}

}  // namespace contactspline::testing
