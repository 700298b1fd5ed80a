// SPDX-License-Identifier: MIT
// Compensation of the time step: a corrected contact law with which a simulated contact (discrete gradient, one step
// per sample) lasts as long as the exact one.
#pragma once

#include <string_view>

#include "generator/material/material.hpp"
#include "generator/spline/fit_target.hpp"

namespace contactspline {

/// Throws BadInput, with `file` and the key in its message, if the compensation of a material cannot be designed:
/// uniform knots, a minimised force error, or a sample rate too low or too high for its impacts.
void require_compensable(const Material& material, std::string_view file);

/// Half the phase [rad] by which the contact's oscillation advances in one sample at the material's
/// max_compression_m: dt/2 sqrt(F'/m). The material must have a compensation.
[[nodiscard]] double largest_half_angle(const Material& material);
constexpr double kMaxHalfAngle = 1.4;  ///< the largest that can be corrected; the limit of the formula is pi/2

/// The fit target of the corrected law. A simulated step from y0 to y1 with speeds v0 and v1 takes 2 (y1 - y0)/(v0 +
/// v1), which is longer than the exact motion when the speed falls. The corrected law has the same energies at
/// compressions q, dq = theta/tan(theta) dy, theta = dt/2 sqrt(F'(y)/m), which makes the contact shorter by that
/// amount (exactly for a spring; up to fourth order in dt for any law).
struct CompensatedTarget {
  FitTarget target;
  double end;  ///< q at max_compression_m, relative to it; it is 1 in the target. Convert back by y = end y', f =
               ///< f'/end.
};

/// The corrected fit target of a material, which must have an impact and a compensation.
[[nodiscard]] CompensatedTarget compensated_target(const Material& material);

}  // namespace contactspline
