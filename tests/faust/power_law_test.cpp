// SPDX-License-Identifier: MIT
// The power law of contactspline.lib against k y^a and its own integral.
#include <cmath>
#include <vector>

#include "cpp_program.hpp"
#include "support/compare.hpp"

#define FAUSTFLOAT double
#include "power_law_double.hpp"

namespace contactspline::testing {
namespace {

constexpr double kStiffness = 1e9, kMaxCompression = 0.001;
constexpr int kSegments = 16, kPerSegment = 8;

/// Compressions from one segment below 0 to one segment beyond the spline, every knot among them.
std::vector<double> compressions() {
  std::vector<double> y;
  for (int i = -kPerSegment; i <= (kSegments + 1) * kPerSegment; ++i)
    y.push_back(kMaxCompression * i / (kSegments * kPerSegment));
  return y;
}

/// Largest distance of the chords from y^a on 0 to 1. With width h it is h^2/8 times the largest second derivative;
/// for a < 2 that of the first chord, where the derivative is not bounded, is found where the slopes are equal.
double chord_error(double a) {
  const double width = 1.0 / kSegments;
  if (a >= 2) return a * (a - 1) * width * width / 8;
  return std::pow(width, a) * std::max(std::pow(a, -1 / (a - 1)) * (1 - 1 / a), a * (a - 1) / 8);
}

TEST(PowerLaw, OfTheLibraryIsTheLawAtItsKnotsAndItsChordsBetween) {
  const auto y = compressions();
  CppProgram<power_law_double, double> program(44100);
  const auto outputs = program.run({y}, y.size());
  ASSERT_EQ(outputs.size(), 6u);
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = std::vector{1.5, 2.5, 3.0}[k];
    SCOPED_TRACE(::testing::Message() << "exponent " << a);
    const double largest = kStiffness * std::pow(kMaxCompression, a);
    EXPECT_LT(chord_error(a), 0.003);  // as the documentation says
    const auto &force = outputs[2 * k], &energy = outputs[2 * k + 1];
    double worst = 0, integral = 0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double exact = y[i] > 0 ? kStiffness * std::pow(y[i], a) : 0;
      if (i > 0) integral += (force[i] + force[i - 1]) / 2 * (y[i] - y[i - 1]);
      EXPECT_TRUE(within(energy[i], integral, 1e-13 * largest * kMaxCompression)) << y[i];
      if (y[i] > kMaxCompression) continue;
      if (i % kPerSegment == 0) {
        EXPECT_TRUE(within(force[i], exact, 1e-14 * largest)) << y[i];
      }
      EXPECT_GE(force[i], exact - 1e-14 * largest) << y[i];
      worst = std::max(worst, (force[i] - exact) / largest);
    }
    EXPECT_TRUE(within(worst, 0, chord_error(a)));
    EXPECT_GT(worst, 0.9 * chord_error(a));
  }
}

}  // namespace
}  // namespace contactspline::testing
