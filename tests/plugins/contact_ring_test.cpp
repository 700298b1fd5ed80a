// SPDX-License-Identifier: MIT
// What the audio thread hands to a window arrives whole and in order. package.contact_ring looks for races.
#include "window/contact_ring.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <vector>

namespace contactspline {
namespace {

constexpr std::size_t kBlock = 256;

void write(ContactRing& ring, std::uint32_t block) {
  std::array<float, kBlock> motion, force;
  std::iota(motion.begin(), motion.end(), static_cast<float>(block * kBlock));
  for (std::size_t n = 0; n < kBlock; ++n) force[n] = motion[n] + 0.5f;
  ring.write(motion, force, static_cast<float>(block) / 4, block);
}

TEST(ContactRing, HandsOverWhatIsWrittenOnce) {
  ContactRing ring;
  std::vector<ContactSample> samples;
  EXPECT_FALSE(ring.is_watched());
  write(ring, 0);
  ring.watch(true);
  EXPECT_TRUE(ring.is_watched());
  ring.read(samples);
  EXPECT_TRUE(samples.empty());  // from before it was watched
  write(ring, 1);
  write(ring, 2);
  ring.read(samples);
  ASSERT_EQ(samples.size(), 2 * kBlock);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    EXPECT_EQ(samples[n].motion, static_cast<float>(kBlock + n));
    EXPECT_EQ(samples[n].force, samples[n].motion + 0.5f);
    EXPECT_EQ(samples[n].notes, 1 + n / kBlock);
    EXPECT_EQ(samples[n].energy, static_cast<float>(samples[n].notes) / 4);
  }
  ring.read(samples);
  EXPECT_TRUE(samples.empty());
  ring.watch(false);
  EXPECT_FALSE(ring.is_watched());
}

TEST(ContactRing, KeepsTheLastSamplesForASlowWindow) {
  ContactRing ring;
  ring.watch(true);
  constexpr std::uint32_t kBlocks = 3 * ContactRing::kSize / kBlock + 1;
  for (std::uint32_t block = 0; block < kBlocks; ++block) write(ring, block);
  std::vector<ContactSample> samples;
  ring.read(samples);
  ASSERT_EQ(samples.size(), ContactRing::kSize);
  for (std::size_t n = 0; n < samples.size(); ++n)
    ASSERT_EQ(samples[n].motion, static_cast<float>(kBlocks * kBlock - ContactRing::kSize + n));
}

}  // namespace
}  // namespace contactspline
