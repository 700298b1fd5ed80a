// SPDX-License-Identifier: MIT
// Prints what docs/figures/stiff_hammer.gp draws: time [ms], then displacement of the struck string [mm] by
// fd.hammer and by HammerString with the felt as it is, the same with one a thousand times as stiff, and what the
// blow's energy allows.
#include <cstdio>

#include "stiff_hammer.hpp"

int main() {
  using namespace contactspline::testing;
  constexpr std::size_t kSamples = 530;
  const auto fd = struck_by_fd(1, kSamples), stiff_fd = struck_by_fd(1000, kSamples);
  const auto ours = struck_by_us(1, kSamples), stiff_ours = struck_by_us(1000, kSamples);
  for (std::size_t n = 0; n < kSamples; ++n)
    std::printf("%.4f %.5g %.5g %.5g %.5g %.5g\n", 1e3 * static_cast<double>(n) / kStrokeRate, 1e3 * fd[n],
                1e3 * ours.displacement[n], 1e3 * stiff_fd[n], 1e3 * stiff_ours.displacement[n],
                1e3 * largest_bend());
}
