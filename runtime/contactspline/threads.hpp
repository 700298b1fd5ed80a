// SPDX-License-Identifier: MIT
// Voices on many cores, by oneTBB: link ContactSpline::threads.
#pragma once

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <cstddef>

namespace contactspline {

/// Runs the groups of an Ensemble on several cores; the caller's thread takes part and returns when all are done. One
/// thread may play at a time. What is ours takes no lock and allocates nothing; oneTBB keeps its tasks in pools of
/// its own and wakes a thread that fell asleep through the operating system (docs/polyphony.md).
class Threads {
 public:
  /// At most so many threads, the caller's counted in; by default as many as the machine has. Starts them: not for
  /// the audio thread.
  explicit Threads(int most = oneapi::tbb::task_arena::automatic) : arena_(most) {
    arena_.initialize();
    (*this)(static_cast<std::size_t>(arena_.max_concurrency()), [](std::size_t) {});
  }

  [[nodiscard]] int size() const { return arena_.max_concurrency(); }

  template <typename Task>
  void operator()(std::size_t tasks, const Task& task) {
    if (tasks == 1) return task(0);
    arena_.execute(
        [&] { oneapi::tbb::parallel_for(std::size_t(0), tasks, task, oneapi::tbb::simple_partitioner()); });
  }

 private:
  oneapi::tbb::task_arena arena_;
};

}  // namespace contactspline
