// SPDX-License-Identifier: MIT
// The modes of a plate with ribs, by the method of Rayleigh and Ritz (docs/reference/resonators.md).
#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "generator/resonator/plate.hpp"

namespace contactspline {

/// sin(along pi x/length) sin(across pi y/width): a mode of the plate without ribs.
struct PlateSine {
  int along, across;
};

/// Modes of a plate with ribs by rising frequency. The shape of a mode is the sum of the sines with its weights,
/// whose squares sum to 1. The wavenumber is that of the mean square: it weighs those of the sines with the squares.
struct RibbedModes {
  std::vector<PlateSine> sines;
  std::vector<UndampedMode> modes;
  std::vector<std::vector<double>> weights;  ///< for each mode, of the sines
};

/// The modes of the plate (its own ribs do not count) with these ribs, computed from so many sines. Half of the modes
/// found are kept: the highest are the least accurate. Their frequencies are above the exact ones.
[[nodiscard]] RibbedModes ribbed_modes(const Plate& plate, const std::vector<Rib>& ribs, std::size_t sines);

/// Ribs on a plate. The modes are computed when they are first asked for, by any thread.
class RibbedPlate {
 public:
  static constexpr std::size_t kSines = 800, kModes = kSines / 2;

  RibbedPlate(Plate plate, std::vector<Rib> ribs);
  [[nodiscard]] const RibbedModes& modes() const;
  /// The shape of a mode, by its place in `modes`, at a place on the plate.
  [[nodiscard]] double shape_at(std::size_t mode, double position_m, double across_m) const;

 private:
  Plate plate_;
  std::vector<Rib> ribs_;
  mutable std::once_flag once_;
  mutable RibbedModes modes_;
};

}  // namespace contactspline
