// SPDX-License-Identifier: MIT
#include "generator/cli/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>

#include "generator/cli/waiting_line.hpp"
#include "generator/support/task_pool.hpp"

namespace contactspline {

void in_parallel(std::size_t count, int jobs, const std::string& done, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> finished = 0;
  std::atomic<bool> is_stopped = false;
  std::optional<WaitingLine> line;  // a single task has a line of its own
  if (count > 1) line.emplace([&] { return fmt::format("{} {} of {} files", done, finished.load(), count); });
  const std::size_t threads =
      jobs > 0 ? static_cast<std::size_t>(jobs) : std::max(1u, std::thread::hardware_concurrency());
  run_tasks(
      count, threads, task, [&](std::size_t tasks) { finished = tasks; }, is_stopped);
}

}  // namespace contactspline
