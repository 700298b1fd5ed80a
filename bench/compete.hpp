// SPDX-License-Identifier: MIT
// Programs timed side by side.
#pragma once

#include <chrono>
#include <string>
#include <vector>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "bench/stopwatch.hpp"

namespace contactspline::bench {

/// Denormals become 0, as in every audio host.
inline void flush_denormals() {
#if defined(__SSE__)
  _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
}

template <typename Play>
struct Contestant {
  std::string name;
  Play play;  ///< so many samples at each call
};

/// Lets all of them play the same short time in turn, round by round.
template <typename Play, typename Clock = std::chrono::steady_clock>
class Contest {
 public:
  /// samples: that each plays at a call. All play once beforehand.
  Contest(std::vector<Contestant<Play>>& all, double samples)
      : all_(all), samples_(samples), times_(all.size()), ratios_(all.size()) {
    flush_denormals();
    for (auto& one : all_) one.play();
  }

  void round() {
    for (std::size_t turn = 0; turn < all_.size(); ++turn) {
      const std::size_t i = (first_ + turn) % all_.size();
      const auto begin = Clock::now();
      all_[i].play();
      times_[i].push_back(std::chrono::duration<double, std::nano>(Clock::now() - begin).count() / samples_);
    }
    for (std::size_t i = 0; i < all_.size(); ++i) ratios_[i].push_back(times_[0].back() / times_[i].back());
    ++first_;
  }

  /// Median time of a sample [ns].
  [[nodiscard]] double nanoseconds(std::size_t contestant) const { return median(times_[contestant]); }
  /// Median over the rounds of the first one's time over this one's.
  [[nodiscard]] double ratio(std::size_t contestant) const { return median(ratios_[contestant]); }

 private:
  std::vector<Contestant<Play>>& all_;
  double samples_;
  std::vector<std::vector<double>> times_, ratios_;
  std::size_t first_ = 0;
};

}  // namespace contactspline::bench
