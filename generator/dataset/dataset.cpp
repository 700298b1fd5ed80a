// SPDX-License-Identifier: MIT
#include "generator/dataset/dataset.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <thread>

#include "generator/dataset/pending_shard.hpp"
#include "generator/dataset/sample_player.hpp"
#include "generator/support/error.hpp"
#include "generator/support/task_pool.hpp"

namespace contactspline {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kTellAfter = std::chrono::milliseconds(100);
// What a thread renders at once: at most so much, at least a row, and so little that all threads end together. It
// does not depend on their number: HDF5 places the blocks of an array in the order in which rows fill them.
constexpr std::size_t kRowsBytes = 1 << 22, kParts = 256;

SampleRows rows_for(const Plan& plan, std::size_t count) {
  SampleRows rows{0, count, std::vector<std::vector<float>>(plan.recorded.size()), {}, {}};
  for (std::size_t r = 0; r < plan.recorded.size(); ++r) {
    const std::size_t values = count * plan.length_of(plan.recorded[r]);
    if (plan.recorded[r].kind == Recorded::kEnergy)
      rows.energy.resize(values);
    else
      rows.sounds[r].resize(values);
  }
  rows.columns.assign(plan.columns.size(), std::vector<double>(count));
  return rows;
}

SampleArrays arrays_of(const Plan& plan, SampleRows& rows, std::size_t row) {
  SampleArrays arrays;
  for (std::size_t r = 0; r < plan.recorded.size(); ++r) {
    const std::size_t length = plan.length_of(plan.recorded[r]);
    if (plan.recorded[r].kind == Recorded::kEnergy) {
      arrays.sounds.emplace_back();
      arrays.energy = std::span(rows.energy).subspan(row * length, length);
    } else {
      arrays.sounds.push_back(std::span(rows.sounds[r]).subspan(row * length, length));
    }
  }
  return arrays;
}

/// Renders samples on several threads, each with an instrument of its own.
class Renderer {
 public:
  Renderer(const Plan& plan, std::size_t threads) : plan_(plan), sampler_(plan.columns, plan.sequence, plan.seed) {
    for (std::size_t t = 0; t < threads; ++t) players_.emplace_back(plan);
  }

  // thread: each has one call at a time.
  void render(std::size_t thread, SampleRows& rows, const std::function<void()>& watch) {
    for (std::size_t row = 0; row < rows.count; ++row) play(players_[thread], rows.first + row, row, rows, watch);
  }

 private:
  void play(SamplePlayer& player, std::size_t sample, std::size_t row, SampleRows& rows,
            const std::function<void()>& watch) const {
    const std::vector<double> values = sampler_.values(sample);
    for (std::size_t c = 0; c < values.size(); ++c) rows.columns[c][row] = values[c];
    try {
      player.play(values, arrays_of(plan_, rows, row), watch);
    } catch (const std::runtime_error& error) {
      std::vector<std::string> words;
      for (std::size_t c = 0; c < values.size(); ++c)
        words.push_back(fmt::format("{} {:.6g}", plan_.columns[c].name, values[c]));
      throw BadInput(fmt::format("{}: sample {}: {}; allowed: other ranges than {}", plan_.file, sample, error.what(),
                                 fmt::join(words, ", ")));
    }
  }

  const Plan& plan_;
  Sampler sampler_;
  std::vector<SamplePlayer> players_;
};

}  // namespace

SampleRange range_of_shard(const Plan& plan, std::size_t index, std::size_t shards) {
  const std::size_t first = plan.count * index / shards;
  return {first, plan.count * (index + 1) / shards - first};
}

std::filesystem::path shard_path(const Plan& plan, const std::filesystem::path& folder, std::size_t index,
                                 std::size_t shards) {
  return folder / fmt::format("{}-{:05}-of-{:05}.h5", plan.name, index + 1, shards);
}

std::filesystem::path joined_path(const Plan& plan, const std::filesystem::path& folder) {
  return folder / (plan.name + ".h5");
}

double measured_time_of_sample(const Plan& plan, const SampleRange& range, const std::function<void()>& watch) {
  const Sampler sampler(plan.columns, plan.sequence, plan.seed);
  SamplePlayer player(plan);
  SampleRows rows = rows_for(plan, 1);
  const Clock::time_point begin = Clock::now();
  Clock::time_point watched = begin;
  const auto watch_at_times = [&] {
    if (Clock::now() - watched <= kTellAfter) return;
    watch();
    watched = Clock::now();
  };
  std::chrono::duration<double> passed{};
  std::size_t played = 0;
  const std::size_t max = 1 + range.count / 400;  // on one core, while others wait
  for (; played < max && passed.count() < 0.1; ++played) {
    try {
      player.play(sampler.values(range.first + played), arrays_of(plan, rows, 0), watch_at_times);
    } catch (const std::runtime_error&) {  // whoever renders it will say so
    }
    passed = Clock::now() - begin;
  }
  return passed.count() / static_cast<double>(std::max<std::size_t>(played, 1));
}

// A thread renders some rows, and writes them when those before are written, so that no thread waits for another and
// the file is the same on any number of threads.
void write_shard(const std::filesystem::path& path, const Plan& plan, const ShardHeading& heading, int threads,
                 const std::function<void(std::size_t)>& done) {
  namespace tbb = oneapi::tbb;
  ShardWriter writer(path, plan, heading);
  Renderer renderer(plan, static_cast<std::size_t>(threads));
  const tbb::global_control allowed(  // without it oneTBB warns of more threads than cores
      tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const std::size_t threads_used = static_cast<std::size_t>(threads);
  const std::size_t rows_at_once =
      std::max<std::size_t>(std::min(kRowsBytes / plan.bytes_per_sample(), heading.range.count / kParts), 1);
  std::vector<SampleRows> parts(2 * threads_used);  // in memory
  std::size_t begun = 0;
  std::atomic<std::size_t> written = 0;
  const std::thread::id caller = std::this_thread::get_id();
  Clock::time_point told = Clock::now();
  const auto begin = [&](tbb::flow_control& flow) -> SampleRows* {
    if (begun == heading.range.count) return flow.stop(), nullptr;
    SampleRows& rows = parts[begun / rows_at_once % parts.size()];
    const std::size_t count = std::min(rows_at_once, heading.range.count - begun);
    if (rows.count != count) rows = rows_for(plan, count);
    rows.first = heading.range.first + begun;
    begun += count;
    return &rows;
  };
  const auto watch = [&] {
    if (tbb::is_current_task_group_canceling()) throw Stopped();  // nobody sees it: oneTBB keeps the first exception
    if (std::this_thread::get_id() != caller || Clock::now() - told <= kTellAfter) return;
    done(written);
    told = Clock::now();
  };
  const auto render = [&](SampleRows* rows) {
    renderer.render(static_cast<std::size_t>(tbb::this_task_arena::current_thread_index()), *rows, watch);
    return rows;
  };
  const auto write = [&](SampleRows* rows) {
    writer.write(*rows);
    written += rows->count;
  };
  tbb::task_arena(threads).execute([&] {
    tbb::parallel_pipeline(parts.size(),
                           tbb::make_filter<void, SampleRows*>(tbb::filter_mode::serial_in_order, begin) &
                               tbb::make_filter<SampleRows*, SampleRows*>(tbb::filter_mode::parallel, render) &
                               tbb::make_filter<SampleRows*, void>(tbb::filter_mode::serial_in_order, write));
  });
  writer.finish();
}

void remove_leftovers(const std::filesystem::path& shard) {
  try {
    const PendingShard removes_them_at_its_end(shard);
  } catch (const BadInput&) {
  }
}

}  // namespace contactspline
