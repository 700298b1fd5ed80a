// SPDX-License-Identifier: MIT
// CPU time of a command, for ratios within one run: the machine may be busy.
#pragma once

#include <algorithm>
#include <ctime>
#include <limits>

#include "program.hpp"

namespace contactspline::testing {

/// The smallest of some runs, of any outcome.
inline double cpu_time_s(const Call& call, int runs = 3) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const std::clock_t begin = std::clock();
    static_cast<void>(run_in_process(call));
    least = std::min(least, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return least;
}

}  // namespace contactspline::testing
