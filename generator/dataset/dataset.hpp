// SPDX-License-Identifier: MIT
// Data sets: the samples of a plan, in shards.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "generator/dataset/plan.hpp"
#include "generator/dataset/shard_file.hpp"

namespace contactspline {

/// The samples of shard `index` of `shards`, 0 to shards - 1: equal parts of the plan's, up to one sample.
[[nodiscard]] SampleRange range_of_shard(const Plan& plan, std::size_t index, std::size_t shards);

/// folder/NAME-00001-of-00007.h5, and folder/NAME.h5 of all shards together.
[[nodiscard]] std::filesystem::path shard_path(const Plan& plan, const std::filesystem::path& folder,
                                               std::size_t index, std::size_t shards);
[[nodiscard]] std::filesystem::path joined_path(const Plan& plan, const std::filesystem::path& folder);

/// Time that one core takes for a sample [s], measured on the first ones of the range: a hundredth of them, or a
/// tenth of a second. `watch` is called about ten times a second, and may
/// throw to stop.
[[nodiscard]] double measured_time_of_sample(const Plan& plan, const SampleRange& range,
                                             const std::function<void()>& watch);

/// Renders samples on the given number of threads and writes them to a shard. Its bytes do not depend on the number
/// of threads. done(samples) is called about ten times a second on the calling thread, with the number of those that
/// are written; it may throw to stop. Throws BadInput where the file cannot be written or a sample is not finite;
/// then no file is left.
void write_shard(const std::filesystem::path& path, const Plan& plan, const ShardHeading& heading, int threads,
                 const std::function<void(std::size_t)>& done);

/// Removes what a process that was killed has left beside a shard. Does nothing while another one writes it.
void remove_leftovers(const std::filesystem::path& shard);

}  // namespace contactspline
