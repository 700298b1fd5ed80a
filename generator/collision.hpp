// SPDX-License-Identifier: MIT
// The motion of a mass thrown at a rigid barrier through any contact law, with or without Hunt-Crossley loss.
#pragma once

#include <functional>
#include <vector>

#include "generator/potential.hpp"
#include "generator/spline.hpp"

namespace contactspline {

/// What the motion depends on: V [J] and its slope F [N], and the compressions [m], rising, at which F is not smooth.
struct LawView {
  std::function<double(double)> energy, force;
  std::vector<double> breaks;
};

/// Refer to what they are made of.
[[nodiscard]] LawView law_view(const Potential& potential);
[[nodiscard]] LawView law_view(const Spline& spline);

struct Collision {
  double max_compression_m;
  double contact_duration_s;
  double exit_speed_m_per_s;
};

/// Compression [m] at which an energy (> 0) [J] is stored, to double precision.
[[nodiscard]] double compression_storing(const LawView& law, double energy_j);

/// m dv/dt = -F(y) (1 + loss v), mass > 0, speed > 0, loss >= 0 [s/m]. On the way in and out, d = loss v follows from
/// the energy V stored: d - ln(1 + d) falls by loss^2/m for each joule (Hunt and Crossley, J. Appl. Mech. 42, 1975),
/// so speeds are closed forms and the duration is the integral of dy/v in and out. To about 1e-10.
[[nodiscard]] Collision collide(const LawView& law, double mass_kg, double speed_m_per_s, double loss_s_per_m);

/// The loss [s/m] by which a mass that arrives with a speed (> 0) leaves with `restitution` (0.05 to 1) of it,
/// whatever the law: d (1 + e) = ln((1 + d)/(1 - e d)), d = loss v. Computed in 113 bits and rounded once.
[[nodiscard]] double loss_for_restitution(double restitution, double speed_m_per_s);

}  // namespace contactspline
