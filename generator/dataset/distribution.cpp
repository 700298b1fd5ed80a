// SPDX-License-Identifier: MIT
#include "generator/dataset/distribution.hpp"

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <string_view>

namespace contactspline {
namespace {

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;  // 2^64 over the golden ratio, odd

// The output function of SplitMix64.
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

std::uint64_t start_of(std::string_view name, std::uint64_t seed) {
  std::uint64_t hash = mixed(seed + kGolden);
  for (const char c : name) hash = mixed(hash ^ static_cast<unsigned char>(c)) + kGolden;
  return hash;
}

// The middle of one of 2^53 equal parts of (0, 1).
double fraction(std::uint64_t bits) {
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

bool is_spread(const PlanColumn& column) {
  return column.law == Law::kUniform || column.law == Law::kLogarithmic;
}

double value_of(const PlanColumn& column, double part, std::uint64_t sample) {
  switch (column.law) {
    case Law::kConstant:
      return column.low;
    case Law::kTable:
      return column.table[sample % column.table.size()];
    case Law::kUniform:
      return std::clamp(column.low + (column.high - column.low) * part, column.low, column.high);
    case Law::kLogarithmic:
      break;
  }
  return std::clamp(column.low * std::exp(std::log(column.high / column.low) * part), column.low, column.high);
}

}  // namespace

Sampler::Sampler(std::span<const PlanColumn> columns, Sequence sequence, std::uint64_t seed)
    : columns_(columns), sequence_(sequence) {
  for (const PlanColumn& column : columns)
    if (is_spread(column)) starts_.push_back(start_of(column.name, seed));
}

std::vector<double> Sampler::spread(std::uint64_t sample) const {
  std::vector<double> parts(starts_.size());
  if (parts.empty()) return parts;
  if (sequence_ == Sequence::kRandom) {
    for (std::size_t c = 0; c < parts.size(); ++c) parts[c] = fraction(mixed(starts_[c] + (sample + 1) * kGolden));
    return parts;
  }
  boost::random::sobol points(parts.size());
  points.seed(sample);
  for (std::size_t c = 0; c < parts.size(); ++c) parts[c] = fraction(points() ^ starts_[c]);
  return parts;
}

std::vector<double> Sampler::values(std::uint64_t sample) const {
  const std::vector<double> parts = spread(sample);
  std::vector<double> values;
  std::size_t next = 0;
  for (const PlanColumn& column : columns_)
    values.push_back(value_of(column, is_spread(column) ? parts[next++] : 0, sample));
  return values;
}

}  // namespace contactspline
