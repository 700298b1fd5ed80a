// SPDX-License-Identifier: MIT
// Several files at once.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace contactspline {

/// Calls task(0) to task(count - 1) on `jobs` threads (0: one for each core), and on a terminal shows how many are
/// done: "`done` 3 of 12 files". The first task that throws, by its number, is the one whose exception is thrown
/// here; tasks that have not begun by then are left out.
void in_parallel(std::size_t count, int jobs, const std::string& done, const std::function<void(std::size_t)>& task);

}  // namespace contactspline
