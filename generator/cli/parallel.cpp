// SPDX-License-Identifier: MIT
#include "generator/cli/parallel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <optional>
#include <thread>
#include <vector>

#include "generator/cli/waiting_line.hpp"

namespace contactspline {

void in_parallel(std::size_t count, int jobs, const std::string& done, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next = 0, finished = 0;
  std::vector<std::exception_ptr> errors(count);
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        task(i);
      } catch (...) {
        errors[i] = std::current_exception();
        next = count;
      }
      ++finished;
    }
  };
  std::optional<WaitingLine> line;  // a single task has a line of its own
  if (count > 1) line.emplace([&] { return fmt::format("{} {} of {} files", done, finished.load(), count); });
  {
    const std::size_t threads = jobs > 0 ? static_cast<std::size_t>(jobs) : std::thread::hardware_concurrency();
    std::vector<std::jthread> helpers;
    for (std::size_t i = 1; i < std::min(threads, count); ++i) helpers.emplace_back(work);
    work();
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace contactspline
