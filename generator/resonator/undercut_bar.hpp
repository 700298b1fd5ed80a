// SPDX-License-Identifier: MIT
// The modes of a bar that is thinner in its middle, as those of marimbas are, by the method of Rayleigh and Ritz.
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "generator/resonator/bar.hpp"

namespace contactspline {

/// An arch that is cut out of the middle of a bar with free ends. Within length_m the thickness, in parts of that of
/// the ends, is 1 - (1 - thickness_ratio) (1 - (2 s/length_m)^2) at a distance s from the middle (F.
/// Orduna-Bustamante, J. Acoust. Soc. Am. 90, 1991). EI follows its cube, the mass per length the thickness.
struct Undercut {
  double length_m;         ///< above 0, at most the length of the bar
  double thickness_ratio;  ///< of the middle, 0.05 to 1
};

/// The modes of a bar with an arch. Mass and bending stiffness of the bar are those without it. They are computed
/// when they are first asked for, by any thread: the moments are sums of those of the uniform bar, so that the two
/// rigid motions are left out. Frequencies are above the exact ones, the lowest eight by less than 1e-6 of themselves
/// where the arch takes half of the bar, 2e-4 where it takes a twentieth. All numbers have nine digits, on which
/// machines agree.
class UndercutBar {
 public:
  static constexpr std::size_t kFunctions = 96, kModes = 32;

  UndercutBar(const Bar& bar, const Undercut& undercut) : bar_(bar), undercut_(undercut) {}

  /// By rising frequency. The wavenumber is that of the uniform bar at this frequency, so that losses follow the
  /// frequency alike.
  [[nodiscard]] const std::vector<UndampedMode>& modes() const;
  /// The shape of a mode, by its place in modes(), at x [m]: 1 at the first end.
  [[nodiscard]] double shape_at(std::size_t mode, double x_m) const;

 private:
  struct WeighedMode {
    UndampedMode mode;
    std::vector<double> weights;
  };

  [[nodiscard]] double thickness_ratio_at(double x_m) const;
  void compute() const;
  [[nodiscard]] std::vector<WeighedMode> modes_of_parity(std::size_t parity) const;

  Bar bar_;
  Undercut undercut_;
  mutable std::once_flag once_;
  mutable std::vector<UndampedMode> modes_;
  mutable std::vector<double> wavenumbers_;           // of the uniform bar
  mutable std::vector<std::vector<double>> weights_;  // of each mode: of the uniform bar's shapes, in M''/mu
};

}  // namespace contactspline
