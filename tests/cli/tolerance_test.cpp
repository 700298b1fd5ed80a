// SPDX-License-Identifier: MIT
// A tolerance that no spline keeps: refused soon, with one that a spline keeps.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "cpu_time.hpp"
#include "program.hpp"
#include "sandbox.hpp"

namespace contactspline::testing {
namespace {

constexpr auto kPower = R"("stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5)";
constexpr auto kSeries = R"("series": [{"stiffness_n_per_m_alpha": 4.5e9, "exponent": 2.5},
  {"stiffness_n_per_m_alpha": 3e7, "exponent": 1.4}])";

void write_material(const Sandbox& box, const char* law, const std::string& spline) {
  write_file(box / "probe.json", fmt::format(R"({{"name": "probe", "contact": {{{}}},
  "impact": {{"mass_kg": 0.003, "max_speed_m_per_s": 6, "min_speed_m_per_s": 0.1}}, "spline": {{{}}}}})",
                                             law, spline));
}

Call design(const Sandbox& box) {
  return {.arguments = {"generate", "probe.json", "--emit", "json", "-o", "-"}, .folder = box.path()};
}

// Its errors are integrals of roots. The search ends in less time than one of its designs takes to be measured.
TEST(Tolerance, IsRefusedSoon) {
  const Sandbox box;
  write_material(box, kSeries, R"("knots": "graded", "tolerance": 1e-7)");
  expect_refused(run(design(box)), "probe.json: spline.tolerance", "is not met by 1024 graded segments");
  const double refusal = cpu_time_s(design(box), 1);
  write_material(box, kSeries, R"("knots": "graded", "segments": 1024)");
  EXPECT_LT(refusal, cpu_time_s(design(box), 1));
}

TEST(Tolerance, OfARefusalIsAccepted) {
  const Sandbox box;
  for (const std::string knots : {"optimal", "uniform"}) {
    SCOPED_TRACE(knots);
    const auto write = [&](const std::string& tolerance) {
      write_material(box, kPower, fmt::format(R"("knots": "{}", "tolerance": {})", knots, tolerance));
    };
    write("1e-7");
    const Outcome refused = run(design(box));
    constexpr std::string_view kOffer = "allowed: at least ";
    const std::size_t at = refused.err.find(kOffer);
    ASSERT_NE(at, std::string::npos) << refused.err;
    write(refused.err.substr(at + kOffer.size()));
    succeed(design(box));
  }
}

}  // namespace
}  // namespace contactspline::testing
