// SPDX-License-Identifier: MIT
// A simulated impact of a mass on a rigid barrier, measured to fractions of a sample.
#pragma once

#include <span>

#include "contactspline/contact.hpp"

namespace contactspline {

struct SimulatedImpact {
  double contact_duration_s;  ///< from the uniform motion before to the uniform motion after
  double max_compression_m;   ///< at the turning point, between samples too
  double exit_speed_m_per_s;
};

/// Throws a mass (> 0) at the barrier with a speed (> 0), at a sample rate (> 0) in hertz. `phase` in [0, 1): how far
/// between two samples the contact begins. `loss_s_per_m`: Hunt-Crossley loss, >= 0. The
/// duration is measured by drawing the free motion back to the barrier.
[[nodiscard]] SimulatedImpact simulate_impact(std::span<const Segment<double>> table, double mass_kg,
                                              double speed_m_per_s, double sample_rate_hz, double phase = 0.5,
                                              double loss_s_per_m = 0);

}  // namespace contactspline
