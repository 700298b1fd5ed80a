// SPDX-License-Identifier: MIT
// A mode's constants as contactspline_modal.lib derives them, against their definitions in long double.
#include <cmath>
#include <numbers>
#include <vector>

#include "cpp_program.hpp"
#include "support/compare.hpp"

#define FAUSTFLOAT double
#include "coefficients_double.hpp"

namespace contactspline::testing {
namespace {

constexpr int kRate = 44100;

// From a decay over hours to one within a sample, on both sides of where the series ends, at 0.02 a sample.
TEST(FaustCoefficients, AreThoseOfThePolesWhateverTheDecay) {
  constexpr double kMass = 0.002;
  std::vector<double> w, decay, mass;
  for (double x = 1e-9; x < 10; x *= 1.1)
    for (const double angle : {0.001, 0.1, 1.0, 2.0, 3.0, 3.14, 3.2}) {
      w.push_back(angle * kRate);
      decay.push_back(x * kRate);
      mass.push_back(kMass);
    }
  CppProgram<coefficients_double, double> program(kRate);
  const auto found = program.run({w, decay, mass}, w.size());
  for (std::size_t i = 0; i < w.size(); ++i) {
    SCOPED_TRACE(decay[i] / kRate);
    SCOPED_TRACE(w[i] / kRate);
    const long double x = static_cast<long double>(decay[i]) / kRate, phase = static_cast<long double>(w[i]) / kRate;
    const long double missing = -std::expm1(-x), sine = std::sin(phase / 2);
    const double stiffness = static_cast<double>(missing * missing + 4 * std::exp(-x) * sine * sine);
    const double averaging = stiffness / static_cast<double>(phase * phase + x * x);
    const double audible = phase < std::numbers::pi_v<long double> ? 1 : 0;
    // 1 - exp(-x) loses a few 2^-53/0.02 where it is written so; the series ends with x^6/30240 < 3e-15.
    constexpr double kBound = 1.5e-14;
    EXPECT_TRUE(relatively_within(found[0][i], stiffness, kBound));
    EXPECT_TRUE(relatively_within(found[1][i], static_cast<double>(-std::expm1(-2 * x)), kBound));
    EXPECT_TRUE(relatively_within(found[2][i], averaging / (2 * kMass * kRate * kRate), kBound));
    EXPECT_EQ(found[3][i], audible);
    // A sound rises at most as at half the sample rate, by (pi/2)^2: docs/how-it-works/modal.md.
    constexpr double kLeast = 4 / (std::numbers::pi * std::numbers::pi);
    EXPECT_TRUE(relatively_within(found[4][i], audible / std::max(averaging, kLeast), kBound));
    // exp(-x) = 1 - decay_loss and, near half the sample rate, the sine lose digits; so does 1 + Re z there.
    const long double real = std::exp(-x) * std::cos(phase), imaginary = std::exp(-x) * std::sin(phase);
    const long double cotangent = (1 + real) / imaginary, push = audible / (2 * kMass * kRate);
    const double lost = 1e-15 * static_cast<double>(std::exp(x) / std::abs(std::sin(phase)));
    const auto bound = [&](long double value) {
      return lost * static_cast<double>(std::abs(value) + 8 * push * phase / std::abs(imaginary));
    };
    EXPECT_TRUE(
        relatively_within(found[5][i], static_cast<double>(missing + 2 * std::exp(-x) * sine * sine), kBound));
    EXPECT_TRUE(relatively_within(found[6][i], static_cast<double>(imaginary), 8 * lost));
    const long double push_v = push * (phase * cotangent - x), push_u = push * (phase + x * cotangent);
    EXPECT_TRUE(within(found[7][i], static_cast<double>(push_v), 8 * bound(push_v)));
    EXPECT_TRUE(within(found[8][i], static_cast<double>(push_u), 8 * bound(push_u)));
  }
}

}  // namespace
}  // namespace contactspline::testing
