// SPDX-License-Identifier: MIT
// wave_file.cpp, which the program for Windows has in place of libsndfile, writes the same bytes. It is compiled here
// with other names for its functions.
#include <gtest/gtest.h>

#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "generator/cli/sound_file.hpp"
#include "generator/support/error.hpp"
#include "support/precisions.hpp"

namespace contactspline {

template <typename T>
std::string wave_bytes(const std::string& file, std::span<const T> samples, double scale, int channels,
                       int sample_rate_hz, int bits = kUsualBits);

namespace testing {
namespace {

CONTACTSPLINE_EACH_PRECISION(WaveFile);

// Noise from -1.5 to 1.5, of which a third is clipped, with odd and even numbers of bytes.
TYPED_TEST(WaveFile, HasTheBytesOfLibsndfile) {
  std::mt19937 random(28);
  std::uniform_real_distribution<TypeParam> noise(-1.5, 1.5);
  for (const auto& [channels, bits] : {std::pair{1, 24}, {2, 24}, {1, 16}, {2, 16}, {1, 32}, {2, 32}})
    for (const std::size_t frames : {1, 2, 3, 7, 1001}) {
      std::vector<TypeParam> samples(frames * static_cast<std::size_t>(channels));
      for (TypeParam& sample : samples) sample = noise(random);
      const std::span<const TypeParam> view(samples);
      EXPECT_TRUE(wave_bytes("a.wav", view, 0.9, channels, 48000, bits) ==
                  sound_bytes("a.wav", view, 0.9, channels, 48000, bits))
          << frames << " frames, " << channels << " channels, " << bits << " bits";
    }
  EXPECT_THROW((void)wave_bytes("a.flac", std::span<const TypeParam>(), 1, 1, 48000), BadInput);
}

}  // namespace
}  // namespace testing
}  // namespace contactspline
