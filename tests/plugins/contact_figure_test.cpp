// SPDX-License-Identifier: MIT
// What a window makes of the samples of a contact.
#include "window/contact_figure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace contactspline {
namespace {

constexpr double kRate = 48000;

// A sine of 400 Hz, and a blow of 2 ms that begins 5 ms after a note at 0.1 s.
ContactSample sample_at(double time_s) {
  const bool is_struck = time_s >= 0.105 && time_s < 0.107;
  return {static_cast<float>(0.5 * std::sin(2 * std::numbers::pi * 400 * time_s)),
          is_struck ? static_cast<float>(8 * std::sin(std::numbers::pi * (time_s - 0.105) / 0.002)) : 0.0f,
          static_cast<float>(time_s), time_s >= 0.1 ? 1u : 0u};
}

std::vector<ContactSample> samples_until(double end_s) {
  std::vector<ContactSample> samples;
  for (double n = 0; n < end_s * kRate; ++n) samples.push_back(sample_at(n / kRate));
  return samples;
}

TEST(ContactFigure, ShowsTheMotionFromARiseThroughZero) {
  ContactFigure figure(kRate);
  EXPECT_TRUE(figure.motion().empty());
  EXPECT_FALSE(figure.is_moving());
  figure.add(samples_until(0.3));
  const auto motion = figure.motion();
  ASSERT_EQ(motion.size(), 960u);  // 20 ms
  EXPECT_GT(motion[0], 0);
  EXPECT_LT(motion[0], 0.03);
  EXPECT_NEAR(motion[30], 0.5, 0.01);  // a quarter of a period later
  EXPECT_NEAR(figure.motion_peak(), 0.5, 0.002);
  EXPECT_TRUE(figure.is_moving());
}

TEST(ContactFigure, ShowsTheForceOfTheLastBlow) {
  ContactFigure figure(kRate);
  figure.add(samples_until(0.3));
  EXPECT_NEAR(figure.blow_s(), 0.004, 0.0001);  // with 2 ms without contact
  EXPECT_NEAR(figure.blow_peak(), 8, 0.01);
  EXPECT_NEAR(figure.blow()[48], 8, 0.1);
  // A new note takes its place when its contact begins.
  figure.add(std::vector<ContactSample>(100, {0, 0, 0, 2}));
  EXPECT_NEAR(figure.blow_peak(), 8, 0.01);
  figure.add(std::vector<ContactSample>(48000, {0, 3, 0, 2}));
  EXPECT_EQ(figure.blow_peak(), 3);
  EXPECT_NEAR(figure.blow_s(), ContactFigure::kBlow_s, 0.0001);
}

TEST(ContactFigure, ShowsTheEnergyOfTheLastSecondsAndRests) {
  ContactFigure figure(kRate);
  figure.add(samples_until(12));
  ASSERT_EQ(figure.energies().size(), 125u);
  EXPECT_NEAR(figure.energies().back(), 12, ContactFigure::kEnergyStep_s);
  EXPECT_NEAR(figure.energies().front(), 7, 2 * ContactFigure::kEnergyStep_s);
  figure.add(std::vector<ContactSample>(static_cast<std::size_t>(7 * kRate), {0.2f, 0, 0, 1}));
  EXPECT_FALSE(figure.is_moving());
}

TEST(ContactFigure, RoundsUpToOneTwoFive) {
  EXPECT_DOUBLE_EQ(round_up(0.011), 0.02);
  EXPECT_DOUBLE_EQ(round_up(0.02), 0.02);
  EXPECT_DOUBLE_EQ(round_up(3), 5);
  EXPECT_DOUBLE_EQ(round_up(7), 10);
  EXPECT_DOUBLE_EQ(round_up(0), 1);
  EXPECT_DOUBLE_EQ(round_up(std::nan("")), 1);
}

}  // namespace
}  // namespace contactspline
