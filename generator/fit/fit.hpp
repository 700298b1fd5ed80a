// SPDX-License-Identifier: MIT
// The fit of a contact law and its loss to measurements.
#pragma once

#include <functional>
#include <string>

#include "generator/fit/fit_result.hpp"
#include "generator/fit/measurements.hpp"
#include "generator/fit/models.hpp"

namespace contactspline {

/// Fits every law with every loss that is allowed and that the number of values can tell, by least squares with a
/// robust norm from several starts, and chooses by the Bayesian information criterion, corrected for few values.
/// `tell` hears what is fitted now. Throws BadInput if nothing describes the data, or no material that does can be
/// read.
[[nodiscard]] Fit fit_material(const Measurements& measured, const std::string& file,
                               const std::function<void(const std::string&)>& tell);

}  // namespace contactspline
