// SPDX-License-Identifier: MIT
// What a program calls that an audio thread must not call; link count_calls.cpp.
#pragma once

#include <atomic>
#include <cstddef>

namespace contactspline::testing {

// Since the program began, by all threads and all libraries.
extern std::atomic<std::size_t> allocations;  ///< by malloc, calloc, realloc and what calls them, such as new
extern std::atomic<std::size_t> locks;        ///< of mutexes and of locks for readers and writers, and waits

}  // namespace contactspline::testing
