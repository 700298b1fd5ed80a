// SPDX-License-Identifier: MIT
// Curves that were measured in an impact, with noise: what a user gets who asks for the sound of the loudest blow.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "printed_text.hpp"
#include "program.hpp"
#include "sandbox.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using Json = nlohmann::json;

struct Sample {
  double compression_m, force_n;
};

// A mass of 8 g at 3 m/s on F = k y^a (1 + loss dy/dt), in 63 samples with noise.
std::vector<Sample> measured_impact(std::mt19937& random) {
  const auto from = [&](double min, double max) { return std::uniform_real_distribution(min, max)(random); };
  constexpr double kMass = 0.008, kSpeed = 3, kStep = 1e-7;
  constexpr std::size_t kSamples = 63;
  const double exponent = from(1.5, 3.5), loss = from(0, 0.15), noise = from(0.005, 0.02);
  const double range = kSpeed * from(1.3e-3, 3.8e-3) / 2.9;
  const double stiffness = (exponent + 1) * kMass * kSpeed * kSpeed / 2 / std::pow(range, exponent + 1);
  std::vector<Sample> path;
  for (double y = kSpeed * kStep / 2, v = kSpeed; y > 0; y += v * kStep) {
    path.push_back({y, stiffness * std::pow(y, exponent) * (1 + loss * v)});
    v -= path.back().force_n / kMass * kStep;
  }
  std::vector<Sample> samples;
  const double largest = std::ranges::max(path, {}, &Sample::force_n).force_n;
  for (std::size_t i = 0; i < kSamples; ++i) {
    samples.push_back(path[path.size() * (2 * i + 1) / (2 * kSamples)]);
    samples.back().force_n += largest * noise * std::normal_distribution(0.0, 1.0)(random);
  }
  return samples;
}

void write_curve(const Sandbox& box, const std::vector<Sample>& samples) {
  std::string csv = "compression_mm,force_n\n";
  for (const auto& [y, force] : samples) csv += fmt::format("{:.6f},{:.5f}\n", 1e3 * y, force);
  write_file(box / "probe.csv", csv);
}

void write_material(const Sandbox& box, double max_speed, const std::string& spline) {
  write_file(box / "probe.json",
             fmt::format(R"({{"name": "probe", "contact": {{"curve": {{"file": "probe.csv", "shape": "hardening",
  "impact_speed_m_per_s": 3}}}}, "impact": {{"mass_kg": 0.008, "max_speed_m_per_s": {:.12g}, "min_speed_m_per_s": 0.1}},
  "spline": {{{}}}}})",
                         max_speed, spline));
}

constexpr auto kForSound = R"("knots": "optimal", "minimise": "spectrum", "segments": 32)";
constexpr auto kUniform = R"("knots": "uniform", "segments": 32)";

Outcome inspected(const Sandbox& box) {
  return run({.arguments = {"inspect", "probe.json", "--json"}, .folder = box.path()});
}

// Noise makes some forces negative, and at the first touch may leave no force at all. The spectrum is then as good as
// that of other curves.
TEST(MeasuredImpact, IsDesignedForTheSpectrum) {
  std::mt19937 random(28);
  int designed = 0, with_slack = 0, with_negative_forces = 0;
  for (int i = 0; i < 8; ++i) {
    SCOPED_TRACE(i);
    const Sandbox box;
    const std::vector<Sample> samples = measured_impact(random);
    write_curve(box, samples);
    write_material(box, 2.4, kForSound);
    const Outcome outcome = inspected(box);
    if (outcome.err.find("gives back") != std::string::npos) continue;  // noise of more work than the loss
    const Json json = Json::parse(succeed(outcome));
    EXPECT_LT(json.at("errors").at("spectrum_db").at("worst").get<double>(), 9);
    EXPECT_LT(json.at("errors").at("spectrum_db").at("mean").get<double>(), 1);
    ++designed;
    with_negative_forces += std::ranges::min(samples, {}, &Sample::force_n).force_n < 0;
    with_slack += json.at("segments")[1].at("force_n").get<double>() < 1e-3;  // the law's force there is 0
  }
  EXPECT_GE(designed, 7);
  EXPECT_GE(with_slack, 2);
  EXPECT_GE(with_negative_forces, 4);
}

// A refused speed names the highest one, which is accepted, and 1 % more is not.
TEST(MeasuredImpact, NamesTheHighestSpeed) {
  std::mt19937 random(11);
  int refused = 0;
  for (int i = 0; i < 5; ++i) {
    SCOPED_TRACE(i);
    const Sandbox box;
    write_curve(box, measured_impact(random));
    write_material(box, 3, kUniform);
    const Outcome outcome = inspected(box);
    if (outcome.err.find("are needed") == std::string::npos) continue;
    ++refused;
    expect_refused(outcome, "probe.json: contact.curve: measured up to",
                   "allowed: impact.max_speed_m_per_s of at most");
    const double highest = number_after(outcome.err, "of at most ");
    write_material(box, highest, kUniform);
    succeed(inspected(box));
    write_material(box, 1.01 * highest, kUniform);
    expect_refused(inspected(box), "probe.json: contact.curve", "are needed");
  }
  EXPECT_GE(refused, 3);
}

// F = 1e5 y up to 1 mm: 3 g at 5.7735 m/s; a hundredth of it at 0.057735 m/s.
TEST(MeasuredCurve, NamesTheSpeedsAndTheCompressionsThatItCovers) {
  const Sandbox box;
  std::string csv = "compression_mm,force_n\n";
  for (int i = 1; i <= 20; ++i) csv += fmt::format("{},{}\n", 0.05 * i, 5 * i);
  write_file(box / "probe.csv", csv);
  const auto refusal = [&](const std::string& more) {
    write_file(
        box / "probe.json",
        R"({"name": "probe", "contact": {"curve": {"file": "probe.csv", "shape": "hardening"}}, )" + more + "}");
    return run({.arguments = {"inspect", "probe.json"}, .folder = box.path()});
  };
  const auto impact = [](double speed) {
    return fmt::format(R"("impact": {{"mass_kg": 0.003, "max_speed_m_per_s": {}, "min_speed_m_per_s": 0.01}},
      "spline": {{"knots": "uniform", "segments": 8}})",
                       speed);
  };
  const auto compression = [](double metres) {
    return fmt::format(R"("spline": {{"knots": "uniform", "segments": 8, "max_compression_m": {}}})", metres);
  };
  EXPECT_TRUE(relatively_within(number_after(refusal(impact(5.8)).err, "of at most "), 5.7735, 1.1e-3));
  succeed(refusal(impact(number_after(refusal(impact(5.8)).err, "of at most "))));
  EXPECT_TRUE(relatively_within(number_after(refusal(impact(0.057)).err, "of at least "), 0.057735, 1.1e-3));
  succeed(refusal(impact(number_after(refusal(impact(0.057)).err, "of at least "))));
  expect_refused(refusal(compression(1.1e-3)), "probe.json: contact.curve", "allowed: spline.max_compression_m from");
  for (const auto* word : {"from ", "to "}) {
    const std::string allowed = refusal(compression(1.1e-3)).err;
    const double offered = number_after(allowed.substr(allowed.find("spline.max")), word);
    succeed(refusal(compression(offered)));
    EXPECT_TRUE(relatively_within(offered, std::string(word) == "to " ? 1e-3 : 1e-5, 1.1e-3));
  }
}

}  // namespace
}  // namespace contactspline::testing
