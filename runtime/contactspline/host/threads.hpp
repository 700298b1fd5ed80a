// SPDX-License-Identifier: MIT
// Voices on several cores with oneTBB. Link ContactSpline::threads.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>

#include <cstddef>

namespace contactspline {

/// Runs the groups of an Ensemble on several cores. The calling thread takes part and returns when all groups are
/// done. Only one thread may call it at a time. This class takes no lock and allocates nothing, but oneTBB manages
/// its own memory pools and wakes sleeping threads through the operating system (docs/how-to/polyphony.md).
class Threads {
 public:
  /// max: number of threads at most, the calling thread included; the default is one for each core. Starts the
  /// threads: do not call on the audio thread.
  explicit Threads(int max = oneapi::tbb::task_arena::automatic) : arena_(max) {
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
