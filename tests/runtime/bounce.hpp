// SPDX-License-Identifier: MIT
// A mass dropped onto a barrier, and what becomes of its energy.
#pragma once

#include <algorithm>
#include <cmath>

#include "contactspline/models/mass_barrier.hpp"
#include "runtime/step_cases.hpp"
#include "support/finite.hpp"

namespace contactspline::testing {

inline constexpr double kGravity = 9.80665;

/// Dropped so that it reaches the barrier with a speed; without loss.
struct Drop {
  double mass_kg;
  double speed_m_per_s;
  double stiffness_ratio;
  double sample_rate_hz;
  double seconds;
};

/// Relative to the energy at the beginning.
struct EnergyDrift {
  double worst = 0;
  double last = 0;
  long samples = 0;
  long bounces = 0;
  bool is_finite = true;
};

/// m v^2/2 - m g q + V(q) of the states as they are, in the longest type there is, on the table's own potential.
template <typename T>
long double energy_of(const MassBarrier<T>& barrier, SegmentTable<T> table, const MassBarrierControls<T>& controls) {
  using Long = long double;
  const T displacement = barrier.displacement();
  const auto& [knot, energy, force, half_curvature] = table[segment_index(table, displacement)];
  const Long q = displacement, v = barrier.velocity(), t = q - Long(knot);
  const Long stored = Long(energy) + t * (Long(force) + t * Long(half_curvature));
  return Long(controls.mass_kg) * (v * v / 2 - Long(controls.gravity_m_per_s2) * q) +
         Long(controls.contact.stiffness_ratio) * stored;
}

/// Follows the energy of a drop: every sample in contact, every 64th in flight.
template <typename T>
EnergyDrift follow(SegmentTable<T> table, const Drop& drop) {
  const MassBarrierControls<T> controls{
      static_cast<T>(drop.mass_kg), static_cast<T>(kGravity), {static_cast<T>(drop.stiffness_ratio), 0}};
  MassBarrier<T> barrier(table, static_cast<T>(drop.sample_rate_hz));
  barrier.throw_from(static_cast<T>(-drop.speed_m_per_s * drop.speed_m_per_s / (2 * kGravity)), 0);
  const long double initial = energy_of(barrier, table, controls);
  EnergyDrift drift;
  drift.samples = std::lround(drop.seconds * drop.sample_rate_hz);
  bool was_touching = false;
  for (long i = 1; i <= drift.samples; ++i) {
    barrier.tick(controls);
    const bool is_touching = barrier.force() > 0;
    drift.bounces += is_touching && !was_touching;
    was_touching = is_touching;
    if (!is_touching && i % 64 != 0 && i != drift.samples) continue;
    drift.last = static_cast<double>((energy_of(barrier, table, controls) - initial) / initial);
    if (!is_finite(drift.last)) drift.is_finite = false;
    drift.worst = std::max(drift.worst, std::abs(drift.last));
  }
  return drift;
}

/// Where the energy must stay, relative: in roundings u,
/// - of a bounce: the coefficients of a step are rounded, and the same every time, so that what a bounce loses by
/// them adds
///   up: A, B, g and the force are each a few roundings, together 8 of the energy;
/// - of every sample: the displacement is rounded by u |q|, of which gravity makes u m g |q| <= u E, and in contact
/// force and
///   way a few u F |y|; these vary from sample to sample and add up as their square root: twice that;
/// - of the velocity in flight: what gravity adds in a sample is always rounded the same way, but gathered until it
/// is a
///   256th of the velocity: n / 256 additions, n the samples of a fall, each within u / 2 of their sum. It comes back
///   in the rise, but not in between.
template <typename T>
double allowed_drift(const Drop& drop, const EnergyDrift& drift) {
  const double fall = drop.speed_m_per_s / kGravity * drop.sample_rate_hz;
  return kRoundoff<T> *
         (8 * static_cast<double>(drift.bounces) + 2 * std::sqrt(static_cast<double>(drift.samples)) + fall / 256);
}

}  // namespace contactspline::testing
