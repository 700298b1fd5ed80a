// SPDX-License-Identifier: MIT
// The impact of a mass on a rigid barrier through any contact law, with or without Hunt-Crossley loss.
#pragma once

#include <functional>
#include <vector>

#include "generator/contact/contact_law.hpp"

namespace contactspline {

/// A contact law as functions of the compression [m]: potential V [J] and force F = dV/dy [N], and the compressions,
/// in rising order, at which F is not smooth.
struct LawView {
  std::function<double(double)> energy, force;
  std::vector<double> breaks;
};

/// A view of a law. The law must outlive the view.
[[nodiscard]] LawView law_view(const ContactLaw& law);

struct BarrierImpact {
  double max_compression_m;
  double contact_duration_s;
  double exit_speed_m_per_s;
  double max_force_n;  ///< with loss, its damping part included: the largest force comes before the turning point
};

/// A moment of an impact: the time since the bodies touched, and the force with its damping part.
struct ImpactMoment {
  double time_s, compression_m, force_n;
};

/// Compression [m] at which V equals `energy_j` (> 0) [J], to double precision.
[[nodiscard]] double compression_at_energy(const LawView& law, double energy_j);

/// Largest compression [m] of an impact without loss, where V equals m v^2/2: a closed form for a power law, else a
/// root to double precision. mass_kg > 0, speed_m_per_s >= 0.
[[nodiscard]] double max_compression(const ContactLaw& law, double mass_kg, double speed_m_per_s);

/// max_compression, computed in 113 bits and rounded once: the same bits on every machine.
[[nodiscard]] double exact_max_compression(const ContactLaw& law, double mass_kg, double speed_m_per_s);

/// Contact duration [s] of an impact without loss: a closed form for a power law, else a quadrature with a relative
/// error of about 1e-10. mass_kg > 0, speed_m_per_s > 0.
[[nodiscard]] double contact_duration(const ContactLaw& law, double mass_kg, double speed_m_per_s);

/// Impact with loss: m dv/dt = -F(y) (1 + loss v). mass_kg > 0, speed_m_per_s > 0, loss_s_per_m >= 0. With d = loss
/// v, d - ln(1 + d) decreases by loss^2/m for each joule stored (Hunt and Crossley, J. Appl. Mech. 42, 1975). So the
/// speeds are closed forms, and the duration is the integral of dy/v on the way in and out. Relative error about
/// 1e-10.
[[nodiscard]] BarrierImpact barrier_impact(const LawView& law, double mass_kg, double speed_m_per_s,
                                           double loss_s_per_m);

/// The same impact from touch to separation: `steps` (> 0) steps in, to the turning point, and as many out. They are
/// shorter near the turning point: the compression is ym (1 - x^2) at equal steps of x. Times as exact as durations.
[[nodiscard]] std::vector<ImpactMoment> barrier_motion(const LawView& law, double mass_kg, double speed_m_per_s,
                                                       double loss_s_per_m, int steps);

/// The loss [s/m] for which the exit speed is `restitution` (0.05 to 1) times the impact speed (> 0). It does not
/// depend on the law: d (1 + e) = ln((1 + d)/(1 - e d)), d = loss v. Computed in 113 bits and rounded once.
[[nodiscard]] double loss_for_restitution(double restitution, double speed_m_per_s);

}  // namespace contactspline
