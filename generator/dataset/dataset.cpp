// SPDX-License-Identifier: MIT
#include "generator/dataset/dataset.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "contactspline/host/threads.hpp"
#include "generator/dataset/sample_player.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kPartBytes = 1 << 24;  // rendered at once; two parts are in memory

SampleRows rows_for(const Plan& plan, std::size_t count) {
  SampleRows rows{count, std::vector<std::vector<float>>(plan.recorded.size()), {}, {}};
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
  Renderer(const Plan& plan, int threads)
      : plan_(plan),
        sampler_(plan.columns, plan.sequence, plan.seed),
        allowed_(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)),
        threads_(threads) {
    for (int t = 0; t < threads_.size(); ++t) players_.emplace_back(plan);
  }

  void render(std::size_t first, SampleRows& rows) {
    std::atomic<std::size_t> next = 0;
    std::string failure;
    std::mutex mutex;
    threads_(players_.size(), [&](std::size_t thread) {
      for (std::size_t row = next++; row < rows.count; row = next++) {
        const std::string wrong = play(players_[thread], first + row, row, rows);
        if (wrong.empty()) continue;
        const std::scoped_lock lock(mutex);
        failure = wrong;
        next = rows.count;
      }
    });
    if (!failure.empty()) throw BadInput(failure);
  }

 private:
  // Says what went wrong, or nothing.
  std::string play(SamplePlayer& player, std::size_t sample, std::size_t row, SampleRows& rows) const {
    const std::vector<double> values = sampler_.values(sample);
    for (std::size_t c = 0; c < values.size(); ++c) rows.columns[c][row] = values[c];
    try {
      player.play(values, arrays_of(plan_, rows, row));
      return {};
    } catch (const std::runtime_error& error) {
      std::vector<std::string> words;
      for (std::size_t c = 0; c < values.size(); ++c)
        words.push_back(fmt::format("{} {:.6g}", plan_.columns[c].name, values[c]));
      return fmt::format("{}: sample {}: {}; allowed: other ranges than {}", plan_.file, sample, error.what(),
                         fmt::join(words, ", "));
    }
  }

  const Plan& plan_;
  Sampler sampler_;
  oneapi::tbb::global_control allowed_;  // without it oneTBB warns of more threads than cores
  Threads threads_;
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

double measured_time_of_sample(const Plan& plan, const SampleRange& range) {
  using Clock = std::chrono::steady_clock;
  const Sampler sampler(plan.columns, plan.sequence, plan.seed);
  SamplePlayer player(plan);
  SampleRows rows = rows_for(plan, 1);
  const Clock::time_point begin = Clock::now();
  std::chrono::duration<double> passed{};
  std::size_t played = 0;
  for (; played < range.count && passed.count() < 0.1; ++played) {
    try {
      player.play(sampler.values(range.first + played), arrays_of(plan, rows, 0));
    } catch (const std::runtime_error&) {  // whoever renders it will say so
    }
    passed = Clock::now() - begin;
  }
  return passed.count() / static_cast<double>(std::max<std::size_t>(played, 1));
}

void write_shard(const std::filesystem::path& path, const Plan& plan, const ShardHeading& heading, int threads,
                 const std::function<void(std::size_t)>& done) {
  ShardWriter writer(path, plan, heading);
  Renderer renderer(plan, threads);
  const std::size_t block = writer.block();
  const std::size_t rows = std::max(kPartBytes / plan.bytes_per_sample(), 4 * static_cast<std::size_t>(threads));
  const std::size_t part = (rows + block - 1) / block * block;
  SampleRows rendered, written;
  std::future<void> writing;  // of the part before, while the next one is rendered
  for (std::size_t begin = 0; begin < heading.range.count; begin += part) {
    const std::size_t count = std::min(part, heading.range.count - begin);
    if (rendered.count != count) rendered = rows_for(plan, count);
    renderer.render(heading.range.first + begin, rendered);
    if (writing.valid()) writing.get();
    std::swap(rendered, written);
    writing = std::async(std::launch::async, [&writer, &written] { writer.write(written); });
    done(begin + count);
  }
  if (writing.valid()) writing.get();
  writer.finish();
}

}  // namespace contactspline
