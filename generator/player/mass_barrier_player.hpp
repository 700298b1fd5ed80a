// SPDX-License-Identifier: MIT
// The mass-barrier instrument played to the end.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "contactspline/mass_barrier.hpp"

namespace contactspline {

struct MassBarrierScore {
  MassBarrierControls<double> controls;
  double start_m;         ///< displacement at which the mass is thrown; negative is before the barrier
  double speed_m_per_s;   ///< towards the barrier
  double duration_s;      ///< > 0
  double sample_rate_hz;  ///< > 0
};

struct MassBarrierMotion {
  double sample_rate_hz;
  std::vector<double> displacement_m;  ///< after each sample, into the barrier
  std::vector<double> force_n;         ///< over each sample
};

/// Called with the part done, 0 to 1, a hundred times over a render.
using Progress = std::function<void(double)>;

[[nodiscard]] MassBarrierMotion play_mass_barrier(std::span<const Segment<double>> table,
                                                  const MassBarrierScore& score, const Progress& progress);

}  // namespace contactspline
