// SPDX-License-Identifier: MIT
// The impact of a mass on a rigid barrier through a contact law with memory.
#pragma once

#include <span>
#include <vector>

#include "contactspline/step/memory.hpp"
#include "generator/contact/barrier_impact.hpp"

namespace contactspline {

/// Impact with memories and Hunt-Crossley loss: m dv/dt = -(F(y) - sum w_i M_i) (1 + loss v), t_i dM_i/dt = F(y) -
/// M_i, until the force ends. Integrated with adaptive steps; relative error about 1e-8. mass_kg > 0, speed_m_per_s >
/// 0, loss_s_per_m >= 0; one to kMaxMemories memories, weights > 0 with a sum below 1, times > 0.
[[nodiscard]] BarrierImpact memory_impact(const LawView& law, double mass_kg, double speed_m_per_s,
                                          double loss_s_per_m, std::span<const Memory> memories);

/// The same over time: a moment at the beginning and after each step, until the force ends.
[[nodiscard]] std::vector<ImpactMoment> memory_motion(const LawView& law, double mass_kg, double speed_m_per_s,
                                                      double loss_s_per_m, std::span<const Memory> memories);

}  // namespace contactspline
