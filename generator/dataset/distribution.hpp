// SPDX-License-Identifier: MIT
// Values that differ from sample to sample of a data set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace contactspline {

enum class Law : unsigned char { kConstant, kUniform, kLogarithmic, kTable };

/// A value of each sample.
struct PlanColumn {
  std::string name;  ///< hammer_mass_kg, or the key of an event: events[0].velocity
  std::string unit;  ///< of SI; empty for a number
  Law law = Law::kConstant;
  double low = 0, high = 0;   ///< kUniform and kLogarithmic; kConstant: low
  std::vector<double> table;  ///< kTable: sample i takes entry i, and begins again after the last one
};

/// What spreads the samples of the columns with a law: independent random numbers, or a Sobol sequence, whose points
/// fill the box of all laws evenly.
enum class Sequence : unsigned char { kRandom, kSobol };

/// The value of column c of sample i is a function of the columns, sequence, seed, c and i alone.
///
/// kRandom: number i of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014), whose stream starts at a hash of seed and
/// name. kSobol: point i of Boost's sequence (direction numbers of Joe and Kuo), each dimension shifted bit by bit by
/// such a hash.
class Sampler {
 public:
  /// The columns must outlive it.
  Sampler(std::span<const PlanColumn> columns, Sequence sequence, std::uint64_t seed);

  /// A value for each column.
  [[nodiscard]] std::vector<double> values(std::uint64_t sample) const;

 private:
  // Numbers in (0, 1) for the columns with a law, in their order.
  [[nodiscard]] std::vector<double> spread(std::uint64_t sample) const;

  std::span<const PlanColumn> columns_;
  Sequence sequence_;
  std::vector<std::uint64_t> starts_;  ///< of the columns with a law
};

}  // namespace contactspline
