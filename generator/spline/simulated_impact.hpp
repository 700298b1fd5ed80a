// SPDX-License-Identifier: MIT
// A simulated impact of a mass on a rigid barrier, measured to fractions of a sample.
#pragma once

#include <span>
#include <vector>

#include "contactspline/step/contact.hpp"
#include "contactspline/step/memory.hpp"
#include "generator/contact/barrier_impact.hpp"

namespace contactspline {

struct SimulatedImpact {
  double contact_duration_s;  ///< from the end of the free motion before to the beginning of the free motion after
  double max_compression_m;   ///< compression at the turning point, also between samples
  double exit_speed_m_per_s;
  double max_force_n;  ///< peak of the parabola through the largest force and its neighbours
};

/// Simulates a mass (> 0) that hits the barrier with a speed (> 0), at a sample rate (> 0). `phase` in [0, 1) is the
/// position of the first contact between two samples. `loss_s_per_m` >= 0 is the Hunt-Crossley loss. For the
/// duration, the free motion before is extrapolated to the barrier, that after to where the force ended: a felt with
/// memory stays compressed for a while. `motion`, unless it is null, gets a moment for each sample: its middle, with
/// the mean of the two compressions (negative: apart) and the force over it.
[[nodiscard]] SimulatedImpact simulate_impact(std::span<const Segment<double>> table, double mass_kg,
                                              double speed_m_per_s, double sample_rate_hz, double phase = 0.5,
                                              double loss_s_per_m = 0, std::span<const Memory> memories = {},
                                              std::vector<ImpactMoment>* motion = nullptr);

}  // namespace contactspline
