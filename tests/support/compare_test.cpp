// SPDX-License-Identifier: MIT
// The comparator itself, with planted wrong answers. Compiled once more with -Ofast, which assumes that all numbers
// are finite.
#include "support/compare.hpp"

#include <limits>
#include <vector>

namespace contactspline::testing {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::vector<double> kRight = {0.0, 1.0, -2.0, 0.5};

bool agree(const std::vector<double>& actual, const std::vector<double>& expected) {
  return static_cast<bool>(sequences_within<double>(actual, expected, 1e-9));
}

TEST(Compare, PassesOnEqualAndOnNearValues) {
  EXPECT_TRUE(within(1.0, 1.0, 0.0));
  EXPECT_TRUE(within(1.0, 1.1, 0.2));
  EXPECT_TRUE(relatively_within(0.0, 0.0, 1e-9));
  EXPECT_TRUE(agree(kRight, kRight));
}

TEST(Compare, FailsOnWrongValues) {
  EXPECT_FALSE(within(1.0, 1.1, 0.05));
  EXPECT_FALSE(relatively_within(1.0, 2.0, 0.4));
  EXPECT_FALSE(agree({0.0, 1.0, -2.0, 0.501}, kRight));
}

TEST(Compare, FailsOnNanAndInfinityOnEitherSide) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    EXPECT_FALSE(within(bad, 1.0, 1.0));
    EXPECT_FALSE(within(1.0, bad, 1.0));
    EXPECT_FALSE(within(bad, bad, 1.0));
    EXPECT_FALSE(agree({0.0, bad, -2.0, 0.5}, kRight));
    EXPECT_FALSE(agree(kRight, {0.0, bad, -2.0, 0.5}));
  }
  EXPECT_FALSE(within(1.0, 1.0, kNan));
}

TEST(Compare, FailsOnMissingData) {
  EXPECT_FALSE(agree({}, kRight));
  EXPECT_FALSE(agree({0.0, 1.0, -2.0}, kRight));
  EXPECT_FALSE(agree(kRight, {}));
  EXPECT_FALSE(agree({}, {}));
}

TEST(Compare, FailsOnSilence) {
  EXPECT_FALSE(agree({0.0, 0.0}, {0.0, 0.0}));
}

}  // namespace
}  // namespace contactspline::testing
