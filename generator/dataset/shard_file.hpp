// SPDX-License-Identifier: MIT
// Shards of a data set as HDF5 files. The only file of the project that knows HDF5.
//
// A file has the attributes of ShardHeading, the group `parameters` with a number of each sample for each column of
// the plan, and the group `outputs` with a row of each sample for each thing that is kept; both have the attribute
// `unit`. Every array has Fletcher's sums, which HDF5 checks whenever somebody reads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "generator/dataset/plan.hpp"

namespace contactspline {

/// Samples of a plan: first to first + count - 1.
struct SampleRange {
  std::size_t first, count;
};

/// Where a shard comes from: a shard with the same heading has the same samples.
struct ShardHeading {
  std::string program;  ///< its name and version
  SampleRange range;
};

enum class ShardState : unsigned char { kAbsent, kComplete, kDamaged, kOfOthers };

/// kDamaged: it cannot be read, or a sum is wrong. kOfOthers: of another plan, program or range. check_sums: reads it
/// all.
[[nodiscard]] ShardState state_of_shard(const std::filesystem::path& path, const Plan& plan,
                                        const ShardHeading& heading, bool check_sums);

/// Values of some samples, one row behind the other.
struct SampleRows {
  std::size_t first = 0, count = 0;        ///< sample of the plan in the first row, number of rows
  std::vector<std::vector<float>> sounds;  ///< for each thing that is kept; the energy's is empty
  std::vector<double> energy;
  std::vector<std::vector<double>> columns;  ///< for each column a number of each sample
};

/// Writes a shard under a temporary name beside it, which another process cannot write to meanwhile. finish() renames
/// it: then it is whole and on the disk. All throw BadInput where it cannot be written; then no file is left.
class ShardWriter {
 public:
  ShardWriter(const std::filesystem::path& path, const Plan& plan, const ShardHeading& heading);
  ShardWriter(const ShardWriter&) = delete;
  ShardWriter& operator=(const ShardWriter&) = delete;
  ~ShardWriter();

  /// Writes rows behind those that are there.
  void write(const SampleRows& rows);
  void finish();

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Writes a file whose arrays are those of all shards, one behind the other, without a copy (virtual data sets). The
/// shards must stay beside it. Throws BadInput.
void join_shards(const std::filesystem::path& path, const Plan& plan, const std::string& program,
                 std::span<const std::filesystem::path> shards, std::span<const SampleRange> ranges);

}  // namespace contactspline
