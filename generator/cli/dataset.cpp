// SPDX-License-Identifier: MIT
// contactspline dataset: the samples of a plan in HDF5 files.
#include "generator/dataset/dataset.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"

namespace contactspline {
namespace {

namespace fs = std::filesystem;

/// A shard of a run.
struct Shard {
  fs::path path;
  ShardHeading heading;
  ShardState state = ShardState::kAbsent;
  std::string failure = {};  ///< why it cannot be written

  [[nodiscard]] bool is_open() const { return state != ShardState::kComplete && failure.empty(); }
};

std::string in_words(double seconds) {
  if (seconds < 120) return fmt::format("{:.2g} s", std::max(seconds, 0.1));
  return seconds < 7200 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.3g} h", seconds / 3600);
}

std::string size_in_words(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

/// On a terminal: how much is done, and the time that is left.
class ProgressLine {
 public:
  ProgressLine(std::string name, std::size_t samples) : name_(std::move(name)), samples_(samples) {}
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() {
    if (is_terminal_) std::fputs("\r\x1b[K", stderr);
  }

  void show(std::size_t done) const {
    if (!is_terminal_ || done == 0) return;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
    const double part = static_cast<double>(done) / static_cast<double>(samples_);
    std::fputs(
        fmt::format("\r{}: {:.0f} %, {} left \x1b[K", name_, 100 * part, in_words(passed.count() * (1 - part) / part))
            .c_str(),
        stderr);
  }

 private:
  std::string name_;
  std::size_t samples_;
  bool is_terminal_ = ::isatty(STDERR_FILENO) != 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

Plan read_plan(const DatasetOptions& options) {
  const std::string text = options.text.empty() ? read_input(options.plan) : options.text;
  return parse_plan(text, options.plan,
                    [&](const std::string& path) { return read_input(fs::path(options.plan).parent_path() / path); });
}

void report(const DatasetOptions& options, const std::string& line) {
  options.report ? options.report(line) : write_stdout(line);
}

void report_failure(const DatasetOptions& options, const std::string& failure) {
  const std::string line = fmt::format("contactspline: {}\n", failure);
  options.report ? options.report(line) : static_cast<void>(std::fputs(line.c_str(), stderr));
}

std::vector<Shard> shards_of(const Plan& plan, const DatasetOptions& options) {
  if (options.shards > plan.count)
    throw BadInput(fmt::format("--shards: {} are more than the samples of the plan; allowed: 1 to {}", options.shards,
                               plan.count));
  std::vector<Shard> shards;
  for (std::size_t i = 0; i < options.shards; ++i)
    if (options.only == 0 || options.only == i + 1)
      shards.push_back({shard_path(plan, options.output, i, options.shards),
                        {std::string(mark()), range_of_shard(plan, i, options.shards)}});
  return shards;
}

// Finds out which shards are there. A file that may be somebody else's costs its shard only.
void look_at(std::vector<Shard>& shards, const Plan& plan, const DatasetOptions& options) {
  for (Shard& shard : shards) {
    shard.state = state_of_shard(shard.path, plan, shard.heading, !options.join);
    if (shard.state == ShardState::kOfOthers && !options.force)
      refuse(shard.path.string(), "file", "is of another plan or version",
             "another folder, or --force to replace it");
    if (shard.state != ShardState::kDamaged || options.join) continue;
    try {
      require_writable({&shard.path, 1}, {}, options.force);
    } catch (const BadInput&) {
      shard.failure = fmt::format(
          "{}: file: cannot be read, and may be of another program; allowed: to remove it, or --force to replace it",
          shard.path.string());
    }
  }
}

// What is still to do, before it begins. Throws BadInput where the disk has no room for it.
void announce(const std::vector<Shard>& shards, const Plan& plan, const DatasetOptions& options, int threads) {
  std::size_t samples = 0, open = 0;
  double bytes = 0;
  for (const Shard& shard : shards) {
    if (!shard.is_open()) continue;
    samples += shard.heading.range.count;
    bytes += static_cast<double>(largest_shard_bytes(plan, shard.heading));
    ++open;
  }
  if (open == 0) return;
  std::error_code error;
  fs::path folder = fs::absolute(options.output, error);
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  const fs::space_info space = fs::space(folder, error);
  if (!error && static_cast<double>(space.available) < bytes)
    refuse(options.output, "file",
           fmt::format("has {} free, and the samples take {}", size_in_words(static_cast<double>(space.available)),
                       size_in_words(bytes)),
           "a folder on a disk with enough room");
  const double time =
      measured_time_of_sample(plan, shards.front().heading.range, options.watch) * static_cast<double>(samples);
  report(options,
         fmt::format("{}: {} samples of {:.4g} s in {} {}, {}, about {} on {} {}\n", plan.name, samples,
                     static_cast<double>(plan.length) / plan.sample_rate_hz, open, open == 1 ? "shard" : "shards",
                     size_in_words(bytes), in_words(time / threads), threads, threads == 1 ? "thread" : "threads"));
}

// Writes the shards that are not complete. One that fails costs the others nothing.
void write_shards(const std::vector<Shard>& shards, const Plan& plan, const DatasetOptions& options, int threads) {
  std::size_t total = 0, done = 0, failed = 0;
  for (const Shard& shard : shards)
    if (shard.is_open()) total += shard.heading.range.count;
  const ProgressLine progress(plan.name, total);
  std::string failure;
  for (const Shard& shard : shards) {
    if (shard.state == ShardState::kComplete) {
      remove_leftovers(shard.path);
      report(options, fmt::format("kept {}\n", shard.path.string()));
      continue;
    }
    try {
      if (!shard.failure.empty()) throw BadInput(shard.failure);
      write_shard(shard.path, plan, shard.heading, threads, [&](std::size_t samples) {
        progress.show(done + samples);
        options.watch();
      });
      report(options, fmt::format("wrote {}\n", shard.path.string()));
    } catch (const BadInput& error) {
      if (failed++ > 0) report_failure(options, failure);
      failure = error.what();
    }
    if (shard.is_open()) done += shard.heading.range.count;
  }
  if (failed > 0)
    throw BadInput(failed == 1 && shards.size() == 1
                       ? failure
                       : fmt::format("{} ({} of {} shards failed: the same command again writes these alone)",
                                     failure, failed, shards.size()));
}

void join(const std::vector<Shard>& shards, const Plan& plan, const DatasetOptions& options) {
  std::vector<fs::path> paths;
  std::vector<SampleRange> ranges;
  for (const Shard& shard : shards) {
    if (options.join && shard.state != ShardState::kComplete)
      refuse(shard.path.string(), "file", shard.state == ShardState::kAbsent ? "does not exist" : "is damaged",
             "the same command without --join, which writes it");
    paths.push_back(shard.path);
    ranges.push_back(shard.heading.range);
  }
  const fs::path joined = joined_path(plan, options.output);
  join_shards(joined, plan, std::string(mark()), paths, ranges);
  report(options, fmt::format("joined {}\n", joined.string()));
}

}  // namespace

std::string make_dataset(const DatasetOptions& options) {
  const bool is_program = !options.report;
  if (is_program) let_hdf5_end_in_silence();
  const Plan plan = read_plan(options);
  std::vector<Shard> shards = shards_of(plan, options);
  const fs::path joined = joined_path(plan, options.output);
  std::vector<fs::path> outputs = {joined}, inputs = {options.plan};
  for (const Shard& shard : shards) outputs.push_back(shard.path);
  for (const auto& [path, text] : plan.inputs) inputs.push_back(fs::path(options.plan).parent_path() / path);
  require_distinct(outputs, inputs);
  if (options.only == 0) require_writable({&joined, 1}, {}, options.force);
  look_at(shards, plan, options);
  if (!options.join) {
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    const int threads = options.threads == 0 ? cores : options.threads;
    announce(shards, plan, options, threads);
    write_shards(shards, plan, options, threads);
  }
  if (options.only > 0) return shards.front().path.string();
  join(shards, plan, options);
  return joined.string();
}

}  // namespace contactspline
