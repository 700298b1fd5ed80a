// SPDX-License-Identifier: MIT
// The best possible time: the loads, stores and multiply-adds of a struck modal string, without dependencies between
// them.
#pragma once

#include <array>
#include <concepts>
#include <span>
#include <vector>

#include "bench/baselines/modal_string.hpp"

namespace contactspline::bench {

/// Per mode and sample the same work as detail::pass: seven values read, two written, six operations. No written
/// value is read again, the force is known in advance, and the sums are reduced once per block.
template <std::floating_point T>
class Roofline {
 public:
  Roofline(std::span<const Mode> modes, std::span<const double>, double)
      : modes_((modes.size() + 2 * kLanes - 1) / (2 * kLanes) * 2) {
    for (auto& mode : modes_) mode = {T(0.9), T(0.1), T(0.5), T(0.5), T(0.5), T(0.5), T(0.5)};
  }

  void process(std::span<T> out) {
    for (T& sample : out) {
      pass(modes_, written_, T(1), sums_);
      sample = 0;
    }
    out.front() = reduce(sums_[0] + sums_[1] + sums_[2] + sums_[3]);
    for (Lanes& sum : sums_) sum = 0;
  }

 private:
  using Modes = detail::Modes<T>;
  using Lanes = typename Modes::Lanes;
  static constexpr std::size_t kLanes = Lanes::size();
  static constexpr std::size_t kWritten = 8;  // places, written again and again, so that they stay in the cache
  struct alignas(64) Written {
    Lanes rest = 0, displacement = 0;
  };

  // Not inlined, or the compiler would compute the values common to all samples only once.
  [[gnu::noinline]] static void pass(std::span<const Modes> modes, std::span<Written, kWritten> written, T force,
                                     Lanes* sums) {
    Lanes first[2] = {sums[0], sums[1]}, second[2] = {sums[2], sums[3]};
    for (std::size_t i = 0; i < modes.size(); i += 2)
      for (std::size_t half = 0; half < 2; ++half) {
        const Modes& mode = modes[i + half];
        const Lanes d = mode.rest + mode.gain * force;
        const Lanes q = mode.displacement + mode.pickup;
        Written& to = written[(i + half) % kWritten];
        to.rest = mode.keep * force - mode.pull * d;
        to.displacement = q;
        first[half] += mode.strike * d;
        second[half] += mode.pickup * q;
      }
    sums[0] = first[0], sums[1] = first[1], sums[2] = second[0], sums[3] = second[1];
  }

  std::vector<Modes> modes_;
  std::array<Written, kWritten> written_;
  Lanes sums_[4] = {0, 0, 0, 0};
};

}  // namespace contactspline::bench
