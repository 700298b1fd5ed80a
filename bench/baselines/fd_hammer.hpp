// SPDX-License-Identifier: MIT
// fd.hammer of the Faust libraries on their finite-difference string: the hammer-string that is installed with Faust.
#pragma once

#include <concepts>
#include <memory>
#include <span>

namespace contactspline::bench {

/// The strings for which there is a Faust program.
enum class FdString { c2, c4 };

/// A hammer and a string by fd.hammer, compiled from Faust to C++. fd_hammer.lib lists the differences to
/// HammerString.
template <std::floating_point T>
class FdHammerString {
 public:
  FdHammerString(FdString string, int sample_rate_hz);
  FdHammerString(FdHammerString&&) noexcept;
  ~FdHammerString();

  /// Adds 2.5 m/s to the hammer, which starts at rest, 0.1 mm from the string.
  void strike();

  /// Writes the displacement at the place of the strike [m]. The hammer moves from the second sample on.
  void process(std::span<T> out);

 private:
  class Program;
  std::unique_ptr<Program> program_;
};

}  // namespace contactspline::bench
