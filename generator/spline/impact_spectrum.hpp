// SPDX-License-Identifier: MIT
// The spectrum of the contact force of an impact on a piecewise-linear force, in closed form.
#pragma once

#include <vector>

#include "generator/spline/piecewise_linear_force.hpp"

namespace contactspline {

/// The Fourier integral of the force of a unit mass with kinetic `energy` (> 0) that meets a rigid barrier, at the
/// angular frequencies 0, step, ... (count - 1) step. Time counts from the largest compression, so it is real: the
/// integral of F(t) cos(W t). At 0 it is the impulse. Within each segment the force is a sinusoid. Relative to the
/// impulse it is exact to about 1e-12.
[[nodiscard]] std::vector<double> impact_spectrum(const PiecewiseLinearForce& force, double energy, double step,
                                                  int count);

}  // namespace contactspline
