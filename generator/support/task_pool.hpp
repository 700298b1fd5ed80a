// SPDX-License-Identifier: MIT
// Tasks on several cores, whose progress the calling thread sees.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace contactspline {

/// Ends a task because another one has failed.
struct Stopped : std::exception {};

/// Calls task(i) for all i below tasks, on the given number of threads or one for each task. Where one throws, those
/// that have not begun are left out, and is_stopped tells the others, which may throw Stopped; then the exception of
/// the first one by its number is thrown again. watch: called about ten times a second and at the end, on this
/// thread, with the number of tasks done; it stops all by an exception.
inline void run_tasks(std::size_t tasks, std::size_t threads, const std::function<void(std::size_t)>& task,
                      const std::function<void(std::size_t)>& watch, std::atomic<bool>& is_stopped) {
  threads = std::min(threads, tasks);
  std::atomic<std::size_t> next = 0, done = 0;
  std::vector<std::exception_ptr> failures(tasks);
  std::mutex mutex;  // of what follows
  std::condition_variable ended;
  std::size_t running = threads;
  const auto work = [&] {
    for (std::size_t i = next++; i < tasks && !is_stopped; i = next++) {
      try {
        task(i);
        ++done;
      } catch (const Stopped&) {
      } catch (...) {
        failures[i] = std::current_exception();
        is_stopped = true;
      }
    }
    const std::lock_guard lock(mutex);
    if (--running == 0) ended.notify_one();
  };
  const auto has_ended = [&] {
    std::unique_lock lock(mutex);
    return ended.wait_for(lock, std::chrono::milliseconds(100), [&] { return running == 0; });
  };
  {
    std::vector<std::jthread> pool;
    try {
      for (std::size_t t = 0; t < threads; ++t) pool.emplace_back(work);
      while (!has_ended()) watch(done);
    } catch (...) {
      is_stopped = true;
      throw;
    }
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  watch(tasks);
}

}  // namespace contactspline
