// SPDX-License-Identifier: MIT
// The impact that fits integrate, and its derivatives, against closed forms and central differences.
#include "generator/fit/impact_model.hpp"

#include <gtest/gtest.h>

#include "fit/measured_impacts.hpp"
#include "generator/contact/barrier_impact.hpp"
#include "generator/fit/fit_dual.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kMass = 0.003, kSpeed = 2;

FitDual dual(double value, std::size_t parameter) {
  FitDual number(value);
  number.set_slope(parameter, 1);
  return number;
}

// About as long as a blow of a piano hammer.
template <typename Real = double>
ViscoelasticLaw<Real> law(const Real& exponent, const Real& loss, const Real& weight = Real(0.0),
                          const Real& log_force = Real(3.0)) {
  return {log_force, exponent, loss, weight, Real(2e-5), 5e-4};
}

PowerLaw power(double exponent) {
  return {std::exp(3.0) / std::pow(5e-4, exponent), exponent};
}

// A step of a hundredth of the contact: an error of order 4 is about 1e-8; at the ends, where the force begins as
// y^a, each is a step^(a + 2) = 1e-6 for the smallest exponent.
TEST(ImpactModel, LastsAsLongAsTheClosedForm) {
  for (const double exponent : {1.0, 1.5, 2.0, 2.5, 4.0, 6.0}) {
    const auto impact = measure_impact(law(exponent, 0.0), kMass, kSpeed);
    ASSERT_TRUE(impact);
    EXPECT_TRUE(relatively_within(impact->duration_s, power(exponent).contact_duration(kMass, kSpeed), 2e-6))
        << exponent;
    EXPECT_TRUE(relatively_within(impact->max_compression_m, power(exponent).max_compression(kMass, kSpeed), 2e-5));
    EXPECT_TRUE(within(impact->restitution, 1, 2e-6));
  }
}

TEST(ImpactModel, LosesWhatHuntAndCrossleysLawLoses) {
  for (const double exponent : {1.5, 2.5, 4.0})
    for (const double loss : {0.05, 0.3, 1.0, 3.0}) {
      const auto impact = measure_impact(law(exponent, loss), kMass, kSpeed);
      const ContactLaw contact(power(exponent));
      const BarrierImpact exact = barrier_impact(law_view(contact), kMass, kSpeed, loss);
      ASSERT_TRUE(impact);
      EXPECT_TRUE(relatively_within(impact->duration_s, exact.contact_duration_s, 1e-5)) << exponent << " " << loss;
      EXPECT_TRUE(relatively_within(impact->restitution * kSpeed, exact.exit_speed_m_per_s, 1e-5));
      EXPECT_TRUE(relatively_within(impact->max_force_n, exact.max_force_n, 1e-4));
      EXPECT_TRUE(relatively_within(impact->max_compression_m, exact.max_compression_m, 1e-4));
    }
}

// T ~ F^(-1/(a + 1)).
TEST(ImpactModel, DurationFallsWithStiffnessAsTheClosedFormDoes) {
  for (const double exponent : {1.5, 2.5, 4.0}) {
    const auto impact =
        measure_impact(law<FitDual>(FitDual(exponent), FitDual(0.0), FitDual(0.0), dual(3.0, 0)), kMass, kSpeed);
    ASSERT_TRUE(impact);
    EXPECT_TRUE(relatively_within(impact->duration_s.slope(0), -impact->duration_s.value / (exponent + 1), 1e-5));
  }
}

// Central differences of width d have an error of about d^2 = 1e-8 of the value, and rounding 1e-15/d. The number of
// steps may differ between the two sides, which adds 2 * 1e-9/d.
TEST(ImpactModel, DerivativesOfAPulseAreItsDifferences) {
  constexpr double kWidth = 1e-4;
  const std::vector<double> at = {3.0, 2.3, 0.2, 0.4, 0.01e-3};  // ln F, exponent, loss, weight, begin
  std::vector<double> times;
  for (int i = 1; i < 200; ++i) times.push_back(i * 2e-5);
  const auto forces = [&]<typename Real>(const std::vector<Real>& p) {
    std::vector<Real> found(times.size());
    EXPECT_TRUE(
        pulse_force(law<Real>(p[1], p[2], p[3], p[0]), kMass, Real(kSpeed), p[4], times, std::span<Real>(found)));
    return found;
  };
  std::vector<FitDual> duals;
  for (std::size_t i = 0; i < at.size(); ++i) duals.push_back(dual(at[i], i));
  const auto exact = forces(duals);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double width = i == 4 ? kWidth * 1e-3 : kWidth;
    auto above = at, below = at;
    above[i] += width;
    below[i] -= width;
    const auto high = forces(above), low = forces(below);
    std::vector<double> difference, derivative;
    for (std::size_t k = 0; k < times.size(); ++k) {
      difference.push_back((high[k] - low[k]) / (2 * width));
      derivative.push_back(exact[k].slope(i));
    }
    EXPECT_TRUE(sequences_within<double>(derivative, difference, 3e-4)) << i;
  }
}

// An independent simulation with tiny steps. The force begins as y^a, so the error is largest for small exponents.
TEST(ImpactModel, PulsesAreThoseOfAnIndependentSimulation) {
  std::vector<double> times;
  for (int i = 0; i < 200; ++i) times.push_back(i * 2e-5);
  for (const double exponent : {1.5, 2.5, 4.0})
    for (const auto& [loss, weight] : {std::pair{0.0, 0.0}, {0.2, 0.0}, {0.0, 0.7}, {0.1, 0.4}}) {
      TrueMaterial truth = lasting(1e-3, exponent, loss, kMass);
      truth.weight = weight;
      truth.time_s = 1e-4;
      const double begin = 1.234e-4, force = truth.law.force(5e-4);
      const auto expected = force_at(truth, kSpeed, begin, times);
      std::vector<double> found(times.size());
      ASSERT_TRUE(pulse_force<double>({std::log(force), exponent, loss, weight, truth.time_s, 5e-4}, kMass, kSpeed,
                                      begin, times, std::span(found)));
      EXPECT_TRUE(sequences_within<double>(found, expected, 1e-5)) << exponent << " " << loss << " " << weight;
    }
}

}  // namespace
}  // namespace contactspline::testing
