// SPDX-License-Identifier: MIT
// A mode's constants as modal.lib derives them, against their definitions in long double.
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
    const long double dt = 1.0L / kRate, x = decay[i] * dt, half_turn = w[i] * dt / 2;
    const long double missing = -std::expm1(-x), fall = 4 * std::exp(-x);
    const long double sine = std::sin(half_turn), cosine = std::cos(half_turn);
    const long double stiffness = missing * missing + fall * sine * sine;
    const long double sum = missing * missing + fall * cosine * cosine;
    // 1 - exp(-x) loses a few 2^-53/0.02 where it is written so; the series ends with x^6/30240 < 3e-15. Beside that,
    // sine and cosine: near their zeros their argument's rounding counts.
    constexpr double kBound = 1.5e-14;
    EXPECT_TRUE(relatively_within(found[1][i], static_cast<double>(-std::expm1(-2 * x)), kBound));
    EXPECT_TRUE(within(found[0][i], static_cast<double>(stiffness), kBound * static_cast<double>(stiffness)));
    EXPECT_TRUE(within(found[2][i], static_cast<double>(dt * dt / (8 * kMass) * sum),
                       static_cast<double>(dt * dt / (8 * kMass)) * (kBound * static_cast<double>(sum) + 1e-18)));
    EXPECT_EQ(found[3][i], half_turn * 2 < std::numbers::pi ? 1 : 0);
  }
}

}  // namespace
}  // namespace contactspline::testing
