// SPDX-License-Identifier: MIT
// Single strikes: the Faust mass-barrier model against its C++ twin, sample by sample.
#include <gtest/gtest.h>

#include "strike_cases.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

bool within_bound(const Difference& seen, const Difference& bound) {
  return seen.displacement <= bound.displacement && seen.force <= bound.force;
}

class StrikeTest : public ::testing::TestWithParam<MaterialUnderTest> {};

TEST_P(StrikeTest, InDoubleAgreesWithTheTwinToTwelveDigits) {
  const MaterialUnderTest& material = GetParam();
  Difference worst;
  for (const Strike& strike : strikes_on(material)) {
    SCOPED_TRACE(::testing::Message() << strike);
    ASSERT_LT(strike.samples, kMaxSamples) << "not a single contact";
    const auto expected = run_twin(material.in_double.table, strike);
    const auto actual = run_faust(*material.in_double.mass_barrier(strike.sample_rate_hz), strike);
    ASSERT_TRUE(all_finite(actual.displacement) && all_finite(actual.force));
    EXPECT_TRUE(sequences_within<double>(actual.displacement, expected.displacement, 1e-12));
    EXPECT_TRUE(sequences_within<double>(actual.force, expected.force, 1e-12));
    widen(worst, relative(difference(actual, expected), expected));
  }
  Measured() << "worst difference, relative to the peak: " << worst;
}

// The slider begins at the loss emitted for Faust; the twin takes the one emitted for C++.
TEST_P(StrikeTest, HasTheMaterialsLossUnlessAnotherIsSet) {
  const MaterialUnderTest& material = GetParam();
  Strike strike{44100, 1.0, -2.3 / 44100, mass_for(material), 1, material.loss_s_per_m, 0, 0};
  strike.samples = samples_of(material, strike);
  const auto expected = run_twin(material.in_double.table, strike);
  strike.loss_s_per_m = kMaterialsLoss;
  const auto actual = run_faust(*material.in_double.mass_barrier(strike.sample_rate_hz), strike);
  EXPECT_TRUE(sequences_within<double>(actual.displacement, expected.displacement, 1e-12));
  EXPECT_TRUE(sequences_within<double>(actual.force, expected.force, 1e-12));
  Measured() << "loss " << material.loss_s_per_m << " s/m";
}

// A mass that is put elsewhere has no last increment, from which its loss would be predicted.
TEST_P(StrikeTest, ThrownAgainFromWithinTheBarrierAgreesWithTheTwin) {
  const MaterialUnderTest& material = GetParam();
  Strike strike{44100, 1.0, -2.3 / 44100, mass_for(material), 1, 0.3, 0, 60};
  MassBarrier<double> twin(material.in_double.table, strike.sample_rate_hz);
  const auto faust = material.in_double.mass_barrier(strike.sample_rate_hz);
  for (const double start_m : {strike.start_m, 0.3 * material.max_compression_m}) {
    strike.start_m = start_m;
    const auto expected = run_twin(twin, strike);
    const auto actual = run_faust(*faust, strike);
    EXPECT_TRUE(sequences_within<double>(actual.displacement, expected.displacement, 1e-12));
    EXPECT_TRUE(sequences_within<double>(actual.force, expected.force, 1e-12));
    faust->set("throw", 0);
    (void)faust->run({}, 1);
  }
}

TEST_P(StrikeTest, InSingleStaysWithinRoundingOfTheTwinInSingleAndInDouble) {
  const MaterialUnderTest& material = GetParam();
  Difference worst, worst_of_bound;
  for (const Strike& strike : strikes_on(material)) {
    SCOPED_TRACE(::testing::Message() << strike);
    const auto exact = run_twin(material.in_double.table, strike);
    const auto twin = run_twin(material.in_single.table, strike);
    const auto actual = run_faust(*material.in_single.mass_barrier(strike.sample_rate_hz), strike);
    ASSERT_TRUE(all_finite(actual.displacement) && all_finite(actual.force));
    const auto bound = rounding_bound(material, strike, exact);
    const auto from_exact = difference(actual, exact);
    EXPECT_TRUE(within_bound(from_exact, bound)) << from_exact << "; bound " << bound;
    const auto from_twin = difference(actual, twin);
    EXPECT_TRUE(within_bound(from_twin, {2 * bound.displacement, 2 * bound.force})) << from_twin;
    widen(worst, relative(from_exact, exact));
    widen(worst_of_bound, {from_exact.displacement / bound.displacement, from_exact.force / bound.force});
  }
  Measured() << "worst difference from double, relative to the peak: " << worst
             << ", relative to the bound: " << worst_of_bound;
}

INSTANTIATE_TEST_SUITE_P(Materials, StrikeTest, ::testing::ValuesIn(materials_under_test()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace contactspline::testing
