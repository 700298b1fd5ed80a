// SPDX-License-Identifier: MIT
// What a program allocates by new; link count_allocations.cpp.
#pragma once

#include <atomic>
#include <cstddef>

namespace contactspline::testing {

extern std::atomic<std::size_t> allocations;  ///< since the program began, by all threads

}  // namespace contactspline::testing
