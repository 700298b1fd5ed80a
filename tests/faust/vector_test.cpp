// SPDX-License-Identifier: MIT
// Every program that ships, compiled by Faust with -vec, against the scalar one; both as an audio thread plays them.
#define FAUSTFLOAT double
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cpp_program.hpp"
#include "fret_string_double.hpp"
#include "fret_string_vector.hpp"
#include "hammer_string_double.hpp"
#include "hammer_string_vector.hpp"
#include "mass_barrier_double.hpp"
#include "mass_barrier_vector.hpp"
#include "piano_double.hpp"
#include "piano_vector.hpp"
#include "slide_string_double.hpp"
#include "slide_string_vector.hpp"
#include "support/real_time.hpp"

namespace contactspline::testing {
namespace {

// 50 ms. A buzzing string amplifies a rounding by 10 to 100 in each collision: after 100 ms the fret-string's reach
// 1e-9.
constexpr std::size_t kSamples = 2205;

template <typename Dsp>
class RealTimeProgram : public CppProgram<Dsp, double> {
 public:
  using CppProgram<Dsp, double>::CppProgram;

 protected:
  void compute(int samples, double** inputs, double** outputs) override {
    expect_real_time([&] { CppProgram<Dsp, double>::compute(samples, inputs, outputs); });
  }
};

template <typename Dsp>
Signals<double> play(const std::string& trigger) {
  RealTimeProgram<Dsp> program(44100);
  program.set(trigger, 1);
  return program.run({}, kSamples);
}

/// The same operations in another order of loops: only roundings may differ. The bound of string_models_test.cpp.
template <typename Scalar, typename Vector>
void expect_same_samples(const std::string& trigger) {
  constexpr double kBound = 1e-10;
  const auto expected = play<Scalar>(trigger);
  const auto actual = play<Vector>(trigger);
  ASSERT_EQ(actual.size(), expected.size());
  ASSERT_EQ(expected.size(), 2u);
  for (std::size_t channel = 0; channel < expected.size(); ++channel) {
    double peak = 0;
    for (const double value : expected[channel]) peak = std::max(peak, std::abs(value));
    ASSERT_GT(peak, 0) << "channel " << channel << " is silent";
    for (std::size_t n = 0; n < kSamples; ++n)
      ASSERT_LE(std::abs(actual[channel][n] - expected[channel][n]), kBound * peak)
          << "channel " << channel << ", sample " << n;
  }
}

TEST(VectorMode, MassBarrierHasTheScalarSamples) {
  expect_same_samples<mass_barrier_double, mass_barrier_vector>("throw");
}

TEST(VectorMode, HammerStringHasTheScalarSamples) {
  expect_same_samples<hammer_string_double, hammer_string_vector>("strike");
}

TEST(VectorMode, SlideStringHasTheScalarSamples) {
  expect_same_samples<slide_string_double, slide_string_vector>("pluck");
}

TEST(VectorMode, FretStringHasTheScalarSamples) {
  expect_same_samples<fret_string_double, fret_string_vector>("pluck");
}

TEST(VectorMode, PianoHasTheScalarSamples) {
  expect_same_samples<piano_double, piano_vector>("gate");
}

}  // namespace
}  // namespace contactspline::testing
