// SPDX-License-Identifier: MIT
// What a program calls that an audio thread must not call; link count_calls.cpp.
#pragma once

#include <cstddef>

namespace contactspline::testing {

// Since this thread began, by all libraries.
extern constinit thread_local std::size_t
    allocations;                                  ///< by malloc, calloc, realloc and what calls them, such as new
extern constinit thread_local std::size_t locks;  ///< of mutexes and of locks for readers and writers, and waits

}  // namespace contactspline::testing
