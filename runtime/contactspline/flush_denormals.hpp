// SPDX-License-Identifier: MIT
// Numbers too small to be heard must not slow a processor down.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace contactspline {

/// While one lives, its thread takes numbers too small to be heard for 0: what dies away costs no more than what
/// sounds.
class FlushDenormals {
 public:
#if defined(__SSE2__)
  FlushDenormals() : before_(_mm_getcsr()) {
    _mm_setcsr(before_ | kFlushToZero | kDenormalsAreZero);
  }
  ~FlushDenormals() {
    _mm_setcsr(before_);
  }

 private:
  static constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  unsigned before_;
#elif defined(__aarch64__)
  FlushDenormals() {
    asm volatile("mrs %0, fpcr" : "=r"(before_));
    asm volatile("msr fpcr, %0" : : "r"(before_ | kFlushToZero));
  }
  ~FlushDenormals() {
    asm volatile("msr fpcr, %0" : : "r"(before_));
  }

 private:
  static constexpr unsigned long kFlushToZero = 1ul << 24;
  unsigned long before_;
#else
  FlushDenormals() {}  // other machines pay for them or do not have them
#endif

 public:
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
};

}  // namespace contactspline
