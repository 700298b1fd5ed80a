// SPDX-License-Identifier: MIT
// Instruments that run at a multiple of their rate, in the library for C, and the filter that divides the rate again.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "c/handle.hpp"
#include "contactspline.h"
#include "contactspline/step/half_band.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

Handle create(const char* name, double rate) {
  Handle handle(contactspline_create(name, rate, CONTACTSPLINE_DOUBLE));
  EXPECT_TRUE(handle) << contactspline_last_error();
  return handle;
}

struct Sound {
  std::vector<double> first, force;
};

/// What the first output plays next, and the force, in blocks of a length that divides nothing.
Sound next_of(const Handle& handle, std::size_t samples) {
  Sound sound{std::vector<double>(samples), std::vector<double>(samples)};
  std::vector<double*> outputs(contactspline_output_count(handle.get()));
  for (std::size_t done = 0; done < samples;) {
    const std::size_t length = std::min<std::size_t>(samples - done, 77);
    outputs.front() = sound.first.data() + done;
    contactspline_process_double(handle.get(), outputs.data(), sound.force.data() + done, length);
    done += length;
  }
  return sound;
}

/// What a decimator makes of a sine [Hz] at its higher rate, as a factor of its amplitude and phase.
std::complex<double> response(int factor, double frequency_hz) {
  Decimator<double> decimator(factor);
  const std::size_t settled = 2 * decimator.delay(), length = settled + 4410;
  const double step = 2 * std::numbers::pi * frequency_hz / (factor * kRate);
  std::complex<double> sum = 0;
  std::vector<double> parts[2];
  for (int part = 0; part < 2; ++part) {
    std::vector<double> high(length * decimator.factor());
    for (std::size_t n = 0; n < high.size(); ++n)
      high[n] = part == 0 ? std::cos(step * double(n)) : std::sin(step * double(n));
    parts[part].resize(length);
    decimator.reset();
    decimator.process(high, parts[part]);
  }
  for (std::size_t n = settled; n < length; ++n)
    sum += std::complex(parts[0][n], parts[1][n]) * std::polar(1.0, -step * factor * double(n));
  return sum / double(length - settled);
}

// Within its band a constant gain and a constant delay; what would be mirrored into the band is 90 dB down.
TEST(Decimator, KeepsTheBandAndDropsWhatWouldBeMirrored) {
  for (const auto& [factor, delay] : {std::pair{1, 0}, {2, 34}, {4, 37}, {8, 38}}) {
    EXPECT_EQ(Decimator<double>(factor).delay(), std::size_t(delay));
    for (const double frequency : {0.0, 100.0, 5000.0, 12345.0, 19000.0, 20000.0}) {
      const auto late = std::polar(1.0, -2 * std::numbers::pi * frequency * delay / kRate);
      EXPECT_LT(std::abs(response(factor, frequency) - late), 1e-4) << factor << ", " << frequency;
    }
    for (int mirror = 1; mirror < factor; ++mirror)
      for (const double frequency : {0.0, 3000.0, 19999.0, -19999.0}) {
        const double beyond = mirror * kRate + frequency;
        if (beyond >= factor * kRate / 2) continue;
        EXPECT_LT(std::abs(response(factor, beyond)), std::pow(10, -90.0 / 20)) << factor << ", " << beyond;
      }
  }
}

// The samples of the instrument at the higher rate through the filter; of the force the largest, as late as the
// sound.
TEST(CLibraryOversampling, PlaysTheInstrumentAtTheHigherRate) {
  for (const int factor : {2, 8}) {
    const Handle fine = create("tom", factor * kRate), coarse = create("tom", kRate);
    ASSERT_TRUE(fine && coarse);
    contactspline_set(coarse.get(), 0, 1.5 * contactspline_get(coarse.get(), 0));
    contactspline_set(fine.get(), 0, contactspline_get(coarse.get(), 0));
    ASSERT_EQ(contactspline_oversample(coarse.get(), factor), 1) << contactspline_last_error();
    EXPECT_EQ(contactspline_get(coarse.get(), 0), contactspline_get(fine.get(), 0));
    for (const auto& handle : {&fine, &coarse}) contactspline_strike(handle->get(), 0, 2);
    constexpr std::size_t kSamples = 500;
    Sound expected = next_of(fine, factor * kSamples);
    const Sound sound = next_of(coarse, kSamples);
    Decimator<double> decimator(factor);
    std::vector<double> low(kSamples);
    decimator.process(expected.first, low);
    const std::size_t latency = contactspline_latency(coarse.get());
    EXPECT_EQ(latency, decimator.delay());
    double largest = 0;
    for (std::size_t n = 0; n < kSamples; ++n) {
      EXPECT_EQ(sound.first[n], low[n]) << n;
      double force = 0;
      for (int k = 0; n >= latency && k < factor; ++k)
        force = std::max(force, expected.force[(n - latency) * factor + std::size_t(k)]);
      EXPECT_EQ(sound.force[n], force) << n;
      largest = std::max(largest, force);
    }
    EXPECT_GT(largest, 0);
    ASSERT_EQ(contactspline_oversample(coarse.get(), 1), 1);
    EXPECT_EQ(contactspline_latency(coarse.get()), 0u);
  }
}

TEST(CLibraryOversampling, IsRefusedInOneLine) {
  const Handle handle = create("tom", 192000);
  ASSERT_TRUE(handle);
  EXPECT_EQ(contactspline_oversample(handle.get(), 3), 0);
  EXPECT_STREQ(contactspline_last_error(), "contactspline: factor: 3 is unknown; allowed: 1, 2, 4, 8");
  EXPECT_EQ(contactspline_oversample(handle.get(), 8), 0);
  EXPECT_STREQ(contactspline_last_error(),
               "contactspline: factor: 8 times 192000 Hz is out of range; allowed: up to 768000 Hz");
  EXPECT_EQ(contactspline_oversample(nullptr, 2), 0);
  EXPECT_EQ(contactspline_latency(nullptr), 0u);
}

}  // namespace
}  // namespace contactspline::testing
