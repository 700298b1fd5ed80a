// SPDX-License-Identifier: MIT
// The target of the fits of knots and forces: the contact law and the impacts of a material, in units of the largest
// compression, the largest force and the mass.
#pragma once

#include <functional>
#include <vector>

#include "generator/material/material.hpp"

namespace contactspline {

/// A compression at which a law is not smooth, with the energy stored there. At a `kink` a layer begins to act.
struct Break {
  double compression, energy;
  bool kink;
};

/// The exact law and its impacts, which a fit approximates.
struct FitTarget {
  std::function<double(double)> force;          ///< over compression from 0 to 1, rising, force(1) = 1
  std::function<double(double)> compression;    ///< largest compression over the kinetic energy of an impact
  std::function<double(double)> half_duration;  ///< half the contact duration over that energy
  double min_compression;  ///< largest compression of the slowest impact; that of the fastest is 1
  double min_energy, max_energy;
  std::vector<Break> breaks = {};  ///< by rising compression, all below 1
  double time_unit_s = 1;          ///< the time in which a unit force gives the mass a unit speed
};

/// The force up to compression 1, and beyond it the power law with the same value and slope there. Guesses evaluate
/// the force a little beyond 1, where a layer may begin that no impact reaches.
[[nodiscard]] std::function<double(double)> extrapolated(std::function<double(double)> force);

/// The same target with its compressions and durations interpolated from tables between its breaks, to about 1e-8. A
/// law without closed forms needs a quadrature for every duration, and a fit needs thousands of durations.
[[nodiscard]] FitTarget tabulated(FitTarget target);

/// The fit target of a material, which must have an impact. Its max_compression_m is 1. If the speeds of the impacts
/// are closer than 2:1, the range is widened to half the fastest speed.
[[nodiscard]] FitTarget fit_target(const Material& material);

}  // namespace contactspline
