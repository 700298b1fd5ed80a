// SPDX-License-Identifier: MIT
// ct.potential, ct.force, ct.step and the step of ct.contact on random input over many decades.
#include <gtest/gtest.h>

#include "step_cases.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

template <typename T>
void expect_exact_but_for_roundings(const MaterialUnderTest& material, double lowest) {
  const auto worst = worst_error(material, *material.in<T>().probe(kRate), lowest);
  Measured() << "worst error in roundings: " << worst;
  EXPECT_LE(worst.largest(), kRoundings);
}

template <typename T>
void expect_the_runtime(const MaterialUnderTest& material, double lowest) {
  const ExactContact exact(material.in<T>().table);
  const auto inputs = RandomInput<T>(material, lowest, Closeness::kLength).take(kSamples);
  const auto outputs = run_probe(*material.in<T>().probe(kRate), inputs);
  Worst worst;
  for (std::size_t i = 0; i < inputs.size(); ++i)
    worst.widen(roundings(exact, inputs[i], solve_exactly(exact, inputs[i])), outputs[i],
                run_twin(material.in<T>().table, inputs[i]));
  Measured() << "worst difference in roundings: " << worst;
  EXPECT_LE(worst.largest(), 2 * kRoundings);
}

/// Whatever the input: finite, never pulling, exactly 0 while apart, and wrong by less than the motion itself where
/// products leave the range of the precision.
template <typename T>
void expect_sane(const MaterialUnderTest& material, double lowest) {
  constexpr Real kMotion = 1.001L;
  const ExactContact exact(material.in<T>().table);
  const auto inputs = RandomInput<T>(material, lowest, Closeness::kRepresentable).take(kSamples);
  const auto outputs = run_probe(*material.in<T>().probe(kRate), inputs);
  std::size_t apart = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto& [y0, xf, xi, ratio, loss, last] = inputs[i];
    const auto& out = outputs[i];
    SCOPED_TRACE(::testing::Message() << "y0 " << y0 << ", xf " << xf << ", xi " << xi << ", stiffness ratio "
                                      << ratio << ", loss " << loss << ", last increment " << last);
    for (const T value : {out.potential, out.force, out.step, out.contact})
      ASSERT_TRUE(is_finite(value) && value >= 0) << value;
    if (y0 <= 0 && y0 + xf <= 0) {
      ++apart;
      ASSERT_TRUE(out.potential == 0 && out.force == 0 && out.step == 0 && out.contact == 0);
    }
    const auto expected = solve_exactly(exact, inputs[i]);
    ASSERT_LE(error_in(momentum(inputs[i], expected.step), out.step, expected.step), kMotion);
    ASSERT_LE(error_in(momentum(inputs[i], expected.contact), out.contact, expected.contact), kMotion);
  }
  EXPECT_GT(apart, inputs.size() / 100) << "the random input hardly tests separation";
}

class StepTest : public ::testing::TestWithParam<MaterialUnderTest> {};

TEST_P(StepTest, InDoubleIsExactButForRoundings) {
  expect_exact_but_for_roundings<double>(GetParam(), -8);
}

TEST_P(StepTest, InSingleIsExactButForRoundings) {
  expect_exact_but_for_roundings<float>(GetParam(), -6);
}

TEST_P(StepTest, InDoubleAgreesWithTheRuntime) {
  expect_the_runtime<double>(GetParam(), -8);
}

TEST_P(StepTest, InSingleAgreesWithTheRuntime) {
  expect_the_runtime<float>(GetParam(), -4);
}

TEST_P(StepTest, InDoubleIsSaneFromHugeToVanishingMotion) {
  expect_sane<double>(GetParam(), -150);
}

TEST_P(StepTest, InSingleIsSaneFromHugeToVanishingMotion) {
  expect_sane<float>(GetParam(), -30);
}

INSTANTIATE_TEST_SUITE_P(Materials, StepTest, ::testing::ValuesIn(materials_under_test()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace contactspline::testing
