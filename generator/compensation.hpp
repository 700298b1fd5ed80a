// SPDX-License-Identifier: MIT
// A contact law bent so that a simulation by the discrete gradient, one step a sample, lasts as long as the law
// itself.
#pragma once

#include <span>
#include <vector>

#include "contactspline/contact.hpp"
#include "generator/knots.hpp"
#include "generator/material.hpp"
#include "generator/resonator.hpp"

namespace contactspline {

/// Half the angle [rad] by which the contact's oscillation turns in a sample at the material's max_compression_m,
/// dt/2 sqrt(F'/m). The law can be bent up to kMostHalfAngle, short of a quarter turn. Needs a compensation.
[[nodiscard]] double largest_half_angle(const Material& material);
constexpr double kMostHalfAngle = 1.4;

/// A fit's target for that bent law. A step from y0 to y1 at speeds v0 and v1 takes 2 (y1 - y0)/(v0 + v1), more than
/// the motion does where the speed falls; the law with compressions q, dq = theta/tan(theta) dy, theta = dt/2
/// sqrt(F'(y)/m), and unchanged energies takes that much less (exactly for a spring; for any law up to fourth order
/// in dt).
struct CompensatedTarget {
  FitTarget target;
  double end;  ///< q at max_compression_m, in parts of it; 1 in the target: y = end y', f = f'/end give back the
               ///< law's parts
};

/// The material must have an impact and a compensation.
[[nodiscard]] CompensatedTarget compensated_target(const Material& material);

/// Static compliance [m/N] at the strike point that the modes, simulated at a rate with exact poles, lack against the
/// modes themselves: the sum of shape^2/m (1/w^2 - dt^2/(4 tan^2(w dt/2))). w dt < pi.
[[nodiscard]] double missing_compliance(std::span<const ResonatorMode> modes, double sample_rate_hz);

/// The part of it that served felts on strings best (docs/knots.md): modes slower than the contact do not give way.
constexpr double kServingShare = 0.8;

/// A spline's table in series with a spring of that compliance [m/N], which may be negative to take it away: at each
/// force the compression is greater by force times compliance.
[[nodiscard]] std::vector<Segment<double>> in_series(std::vector<Segment<double>> table, double compliance_m_per_n);

}  // namespace contactspline
