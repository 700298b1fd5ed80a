// SPDX-License-Identifier: MIT
// fd.hammer of the Faust libraries on their finite-difference string: what Faust offers as installed.
#pragma once

#include <concepts>
#include <memory>
#include <span>

namespace contactspline::bench {

/// The strings that there is a program for.
enum class FdString { c2, c4 };

/// A hammer and a string by fd.hammer, compiled from Faust to C++. What differs from HammerString: fd_hammer.lib.
template <std::floating_point T>
class FdHammerString {
 public:
  FdHammerString(FdString string, int sample_rate_hz);
  FdHammerString(FdHammerString&&) noexcept;
  ~FdHammerString();

  /// Adds 2.5 m/s to the hammer, which begins at rest 0.1 mm off the string.
  void strike();

  /// Displacement where the string is struck [m], sample by sample; the hammer moves from the second one on.
  void play(std::span<T> out);

 private:
  class Program;
  std::unique_ptr<Program> program_;
};

}  // namespace contactspline::bench
