// SPDX-License-Identifier: MIT
// Times several tasks against each other.
#pragma once

#include <time.h>

#include <chrono>
#include <string>
#include <vector>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "bench/stopwatch.hpp"

namespace contactspline::bench {

/// Flushes denormal numbers to 0 on this thread, as audio hosts do.
inline void flush_denormals() {
#if defined(__SSE__)
  _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
}

/// CPU time of this thread. Wall time would count interruptions, which are common in rounds of milliseconds.
struct ThreadClock {
  static std::chrono::nanoseconds now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
  }
};

template <typename Run>
struct TimedTask {
  std::string name;
  Run run;  ///< computes a fixed number of samples at each call
};

/// Times all tasks in rounds. In each round every task runs once; the first one changes from round to round.
template <typename Run, typename Clock = std::chrono::steady_clock>
class PairedTimer {
 public:
  /// samples: computed at each call of a task. The constructor runs every task once to warm up.
  PairedTimer(std::vector<TimedTask<Run>>& tasks, double samples)
      : tasks_(tasks), samples_(samples), times_(tasks.size()), ratios_(tasks.size()) {
    flush_denormals();
    for (auto& task : tasks_) task.run();
  }

  void round() {
    for (std::size_t offset = 0; offset < tasks_.size(); ++offset) {
      const std::size_t i = (first_ + offset) % tasks_.size();
      const auto begin = Clock::now();
      tasks_[i].run();
      times_[i].push_back(std::chrono::duration<double, std::nano>(Clock::now() - begin).count() / samples_);
    }
    for (std::size_t i = 0; i < tasks_.size(); ++i) ratios_[i].push_back(times_[0].back() / times_[i].back());
    ++first_;
  }

  /// Median time per sample [ns].
  [[nodiscard]] double nanoseconds(std::size_t task) const { return median(times_[task]); }
  /// Median over the rounds of the time of task 0 divided by the time of this task.
  [[nodiscard]] double ratio(std::size_t task) const { return median(ratios_[task]); }

 private:
  std::vector<TimedTask<Run>>& tasks_;
  double samples_;
  std::vector<std::vector<double>> times_, ratios_;
  std::size_t first_ = 0;
};

}  // namespace contactspline::bench
