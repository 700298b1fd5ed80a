// SPDX-License-Identifier: MIT
// The instruction sets of this machine, one after the other, for tests of the vectorised kernels.
#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstdint>
#include <vector>

#include "contactspline/simd/kernels.hpp"

namespace contactspline::testing {

/// Runs one instruction set while it lives.
class OnlyTarget {
 public:
  explicit OnlyTarget(std::int64_t target) { take(target); }
  ~OnlyTarget() { take(0); }

 private:
  static void take(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    detail::take_vectorised_kernels<float>();
    detail::take_vectorised_kernels<double>();
  }
};

/// All that the library holds and this machine has, the one without vectors among them.
inline std::vector<std::int64_t> targets() {
  std::vector<std::int64_t> all;
  for (int bit = 0; bit < 63; ++bit)
    if (const std::int64_t target = std::int64_t{1} << bit; hwy::SupportedTargets() & target) all.push_back(target);
  return all;
}

/// Rounding differs, as sums are taken in another order and products may be fused. In double precision the difference
/// stays below 1e-12 of the peak, which is what is asked for; in single precision it is of the size of what single
/// precision leaves of the exact sound, 85 dB below it or less: 5.6e-5.
template <typename T>
double kernel_bound() {
  return sizeof(T) == sizeof(double) ? 1e-12 : 5.6e-5;
}

}  // namespace contactspline::testing
