// SPDX-License-Identifier: MIT
// What an audio thread calls. Link count_allocations.cpp.
#pragma once

#include <gtest/gtest.h>

#include <functional>

#include "support/count_allocations.hpp"

#ifdef CONTACTSPLINE_REALTIME_SANITIZER
#define CONTACTSPLINE_NONBLOCKING [[clang::nonblocking]]
#else
#define CONTACTSPLINE_NONBLOCKING
#endif

namespace contactspline::testing {

using Play = std::function<void()>;

/// RealtimeSanitizer ends the program where play locks, allocates or makes another call that may block.
inline void play_in_real_time(const Play& play) noexcept CONTACTSPLINE_NONBLOCKING {
  play();
}

/// The same, and it must not allocate by new.
inline void expect_real_time(const Play& play) {
  const std::size_t before = allocations;
  play_in_real_time(play);
  EXPECT_EQ(allocations, before);
}

}  // namespace contactspline::testing
