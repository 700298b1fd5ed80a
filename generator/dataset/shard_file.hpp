// SPDX-License-Identifier: MIT
// Shards of a data set as HDF5 files.
//
// A file has attributes that say where it comes from, the group `parameters` with a number of each sample for each
// column of the plan, and the group `outputs` with a row of each sample for each thing that is kept; both have the
// attribute `unit`. Every array has Fletcher's checksums, which HDF5 checks whenever somebody reads.
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

/// Leaves out what HDF5 does at the end of the process: after it has met a damaged file, it prints a message there.
/// To be called before all others, and not where somebody else in the process writes with HDF5.
void let_hdf5_end_in_silence();

enum class ShardState : unsigned char { kAbsent, kComplete, kDamaged, kOfOthers };

/// kDamaged: it cannot be read, or a checksum is wrong. kOfOthers: of another plan, program or range. reads_all: also
/// reads the samples.
[[nodiscard]] ShardState state_of_shard(const std::filesystem::path& path, const Plan& plan,
                                        const ShardHeading& heading, bool reads_all);

/// The size of a shard's file, at most.
[[nodiscard]] std::size_t largest_shard_bytes(const Plan& plan, const ShardHeading& heading);

/// Values of some samples, one row after the other.
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

  /// Writes rows after those that are there.
  void write(const SampleRows& rows);
  void finish();

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Writes a file whose arrays are those of all shards, one after the other, without a copy (virtual data sets). The
/// shards must stay beside it. Throws BadInput.
void join_shards(const std::filesystem::path& path, const Plan& plan, const std::string& program,
                 std::span<const std::filesystem::path> shards, std::span<const SampleRange> ranges);

}  // namespace contactspline
