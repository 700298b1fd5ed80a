// SPDX-License-Identifier: MIT
// Values of samples: their laws, and that they depend on the sample alone.
#include "generator/dataset/distribution.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace contactspline::testing {
namespace {

PlanColumn column(std::string name, Law law, double low, double high) {
  PlanColumn made;
  made.name = std::move(name);
  made.law = law;
  made.low = low;
  made.high = high;
  return made;
}

const std::vector<PlanColumn> kColumns = {
    column("a", Law::kUniform, -1, 3), column("b", Law::kLogarithmic, 0.01, 100), column("c", Law::kConstant, 7, 0)};

TEST(Sampler, SampleDependsOnItsNumberAlone) {
  for (const Sequence sequence : {Sequence::kRandom, Sequence::kSobol}) {
    const Sampler sampler(kColumns, sequence, 5), again(kColumns, sequence, 5), other(kColumns, sequence, 6);
    std::vector<std::vector<double>> forwards;
    for (std::uint64_t i = 0; i < 100; ++i) forwards.push_back(sampler.values(i));
    for (std::uint64_t i = 100; i-- > 0;) EXPECT_EQ(again.values(i), forwards[i]) << i;
    EXPECT_NE(other.values(3), forwards[3]);
    EXPECT_EQ(forwards[9][2], 7);
  }
}

TEST(Sampler, OtherColumnsChangeNoRandomNumbers) {
  const std::vector<PlanColumn> alone = {kColumns[1]};
  const Sampler both(kColumns, Sequence::kRandom, 1), one(alone, Sequence::kRandom, 1);
  for (std::uint64_t i = 0; i < 20; ++i) EXPECT_EQ(both.values(i)[1], one.values(i)[0]);
}

// Of 2^k points, each of 2^k equal parts of each dimension holds one; and of two dimensions each of 2^k boxes of any
// shape, because the first two dimensions of Sobol's sequence are a net with t = 0. A shift of the bits keeps that.
TEST(Sampler, SobolPointsAreANet) {
  constexpr int kBits = 8, kPoints = 1 << kBits;
  const std::vector<PlanColumn> unit = {column("x", Law::kUniform, 0, 1), column("y", Law::kUniform, 0, 1)};
  const Sampler sampler(unit, Sequence::kSobol, 42);
  for (const std::uint64_t first : {std::uint64_t(kPoints - 1), std::uint64_t(1) << 30}) {
    // Boost leaves out the origin: sample i is point i + 1.
    const std::uint64_t begin = (first / kPoints + 1) * kPoints - 1;
    for (int x_bits = 0; x_bits <= kBits; ++x_bits) {
      std::set<std::pair<int, int>> boxes;
      for (std::uint64_t i = begin; i < begin + kPoints; ++i) {
        const auto values = sampler.values(i);
        boxes.emplace(static_cast<int>(std::ldexp(values[0], x_bits)),
                      static_cast<int>(std::ldexp(values[1], kBits - x_bits)));
      }
      EXPECT_EQ(boxes.size(), std::size_t(kPoints)) << x_bits;
    }
  }
}

// The largest distance between the share of values below x and the law's is below 1.95 / sqrt(n) but for one case in
// a thousand (Kolmogorov and Smirnov).
TEST(Sampler, RandomNumbersFollowTheirLaws) {
  constexpr int kSamples = 20000;
  const Sampler sampler(kColumns, Sequence::kRandom, 11);
  std::vector<double> uniform, logarithmic;
  double correlation = 0;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const auto values = sampler.values(i);
    uniform.push_back((values[0] + 1) / 4);
    logarithmic.push_back(std::log(values[1] / 0.01) / std::log(1e4));
    correlation += (uniform.back() - 0.5) * (logarithmic.back() - 0.5) * 12 / kSamples;
  }
  EXPECT_LT(std::abs(correlation), 3.3 / std::sqrt(kSamples));  // its deviation is 1 / sqrt(n)
  for (auto* parts : {&uniform, &logarithmic}) {
    std::ranges::sort(*parts);
    double distance = 0;
    for (int i = 0; i < kSamples; ++i)
      distance = std::max(distance, std::abs((*parts)[std::size_t(i)] - (i + 0.5) / kSamples));
    EXPECT_LT(distance, 1.95 / std::sqrt(kSamples));
    EXPECT_EQ(std::ranges::adjacent_find(*parts), parts->end());  // of 2^53 numbers, no two are the same
    EXPECT_GT(parts->front(), 0);
    EXPECT_LT(parts->back(), 1);
  }
}

TEST(Sampler, TablesBeginAgain) {
  PlanColumn table = column("t", Law::kTable, 0, 0);
  table.table = {3, 1, 2};
  const std::vector<PlanColumn> columns = {table};
  const Sampler sampler(columns, Sequence::kRandom, 0);
  for (std::uint64_t i = 0; i < 9; ++i) EXPECT_EQ(sampler.values(i)[0], table.table[i % 3]);
}

}  // namespace
}  // namespace contactspline::testing
