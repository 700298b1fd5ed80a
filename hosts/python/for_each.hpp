// SPDX-License-Identifier: MIT
// Tasks on all cores, whose progress the interpreter sees.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace contactspline::python {

/// Calls task(i) for all i below tasks, on so many threads. Where one throws, the others stop, and it is thrown
/// again. watch: called about ten times a second on this thread with the number of tasks done; it stops all by an
/// exception.
inline void for_each(std::size_t tasks, std::size_t threads, const std::function<void(std::size_t)>& task,
                     const std::function<void(std::size_t)>& watch, std::atomic<bool>& is_stopped) {
  std::atomic<std::size_t> next = 0, done = 0, running = threads;
  std::exception_ptr failure;
  std::mutex mutex;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < tasks && !is_stopped; i = next++) {
        task(i);
        ++done;
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      is_stopped = true;
    }
    --running;
  };
  {
    std::vector<std::jthread> pool;
    for (std::size_t t = 0; t < threads; ++t) pool.emplace_back(work);
    for (std::size_t pauses = 1; running > 0; ++pauses) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      try {
        if (pauses % 100 == 0) watch(done);
      } catch (...) {
        is_stopped = true;
        throw;
      }
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace contactspline::python
