// SPDX-License-Identifier: MIT
// What the C and LLVM back ends made of mass_barrier.dsp and probe.dsp on felt C4, run and judged like the C++.
#include <gtest/gtest.h>

#include "native_program.hpp"
#include "paths.hpp"
#include "step_cases.hpp"
#include "strike_cases.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

struct BackEnd {
  std::string name;
  std::string library;      ///< empty where this machine cannot build it
  std::string why_missing;  ///< the reason
};

std::ostream& operator<<(std::ostream& out, const BackEnd& back_end) {
  return out << back_end.name;
}

const MaterialUnderTest& felt_c4() {
  return *std::ranges::find(materials_under_test(), "felt_c4", &MaterialUnderTest::name);
}

class NativeTest : public ::testing::TestWithParam<BackEnd> {
 protected:
  void SetUp() override {
    if (GetParam().library.empty())
      GTEST_SKIP() << "the " << GetParam().name << " back end is not run: " << GetParam().why_missing;
    library_ = std::make_unique<Library>(GetParam().library);
  }

  template <std::floating_point T>
  [[nodiscard]] std::unique_ptr<FaustProgram<T>> make(const std::string& program, int sample_rate_hz) const {
    const std::string name = GetParam().name + '_' + program + (std::is_same_v<T, double> ? "_double" : "_single");
    if (GetParam().name == "c") return std::make_unique<CProgram<T>>(*library_, name, sample_rate_hz);
    return std::make_unique<LlvmProgram<T>>(*library_, name, sample_rate_hz);
  }

  template <std::floating_point T>
  void expect_strikes_of_the_twin() const {
    Difference worst, from_cpp;
    for (const Strike& strike : strikes_on(felt_c4())) {
      SCOPED_TRACE(::testing::Message() << strike);
      const auto exact = run_twin(felt_c4().in_double.table, strike);
      const auto actual = run_faust(*make<T>("mass_barrier", strike.sample_rate_hz), strike);
      ASSERT_TRUE(all_finite(actual.displacement) && all_finite(actual.force));
      const auto bound = bound_in<T>(felt_c4(), strike, exact);
      const auto seen = difference(actual, exact);
      EXPECT_LE(seen.displacement, bound.displacement);
      EXPECT_LE(seen.force, bound.force);
      widen(worst, relative(seen, exact));
      const auto cpp = run_faust(*felt_c4().in<T>().mass_barrier(strike.sample_rate_hz), strike);
      widen(from_cpp, relative(difference(actual, cpp), exact));
    }
    Measured() << "worst difference from the twin in double, relative to the peak: " << worst
               << ", from the C++ back end: " << from_cpp;
  }

  template <std::floating_point T>
  void expect_exact_but_for_roundings(double lowest) const {
    const auto worst = worst_error<T>(felt_c4(), *make<T>("probe", kRate), lowest);
    Measured() << "worst error in roundings: " << worst;
    EXPECT_LE(worst.largest(), kRoundings);
  }

 private:
  std::unique_ptr<Library> library_;
};

TEST_P(NativeTest, StrikesInDoubleAgreeWithTheTwin) {
  expect_strikes_of_the_twin<double>();
}

TEST_P(NativeTest, StrikesInSingleAgreeWithTheTwin) {
  expect_strikes_of_the_twin<float>();
}

TEST_P(NativeTest, FunctionsInDoubleAreExactButForRoundings) {
  expect_exact_but_for_roundings<double>(-8);
}

TEST_P(NativeTest, FunctionsInSingleAreExactButForRoundings) {
  expect_exact_but_for_roundings<float>(-6);
}

INSTANTIATE_TEST_SUITE_P(Faust, NativeTest,
                         ::testing::Values(BackEnd{"c", kCLibrary, ""}, BackEnd{"llvm", kLlvmLibrary, kWhyNoLlvm}),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace contactspline::testing
