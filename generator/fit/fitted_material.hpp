// SPDX-License-Identifier: MIT
// A fit as text: a material file, a report, JSON.
#pragma once

#include <string>
#include <string_view>

#include "generator/fit/fit.hpp"

namespace contactspline {

/// The fit in lines of at most 110 columns: law, intervals, scatter of each source, models it was chosen among, and
/// the largest speed that the data allow.
[[nodiscard]] std::string report_of(const Fit& fit, const Measurements& measured);

/// A material file of the fit, with the report in its comments. `mark` is the program's.
[[nodiscard]] std::string material_text(const Fit& fit, const Measurements& measured, std::string_view mark);

/// All numbers of the fit.
[[nodiscard]] std::string json_of(const Fit& fit, const Measurements& measured);

}  // namespace contactspline
