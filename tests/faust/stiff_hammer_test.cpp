// SPDX-License-Identifier: MIT
// A felt a thousand times too stiff: what becomes of HammerString and of fd.hammer.
#include "stiff_hammer.hpp"

#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

double largest(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, std::abs(value));
  }
  return largest;
}

// So that the comparison is fair: with the felt as it is, both are the same stroke. fd.hammer's grid, of second order
// at 64 steps, and its explicit contact leave some per cent over the 5 ms of the stroke.
TEST(StiffHammer, IsTheSameStrokeAsOfFdHammerWhereTheFeltIsSoft) {
  const auto ours = struck_by_us(1, 220).displacement;
  const auto theirs = struck_by_fd(1, 220);
  EXPECT_TRUE(sequences_within<double>(theirs, ours, 0.05));
}

// fd.hammer bends the string three times as far as the energy of the blow can, so that it made at least eight times
// that energy out of nothing; ours keeps to the bound, and its books to 1e-12.
TEST(StiffHammer, KeepsItsEnergyWhereFdHammerMakesSome) {
  const auto theirs = struck_by_fd(1000, 44100);
  EXPECT_GT(largest(theirs), 3 * largest_bend());
  const auto ours = struck_by_us(1000, 44100);
  EXPECT_LE(largest(ours.displacement), largest_bend());
  EXPECT_GT(largest(ours.displacement), 0.5 * largest_bend());
  EXPECT_TRUE(within(ours.books.worst, 0, 1e-12 * ours.books.peak));
}

}  // namespace
}  // namespace contactspline::testing
