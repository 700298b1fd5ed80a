// SPDX-License-Identifier: MIT
// What makes a fit doubtful.
#pragma once

#include "generator/fit/fit_problem.hpp"
#include "generator/fit/fit_result.hpp"

namespace contactspline {

/// Adds a line for what the data show that the model, of these values, does not, and for numbers that no collision in
/// an instrument is likely to have.
void add_notes(Fit& fit, const Measurements& measured, const FitValues& values);

}  // namespace contactspline
