// SPDX-License-Identifier: MIT
// The key `struck` of a fit file: blows on a resonator that is known.
#pragma once

#include <string>
#include <vector>

#include "generator/fit/measurements.hpp"
#include "generator/material/contact_reader.hpp"

namespace contactspline {

inline const std::vector<std::string> kStruckKeys{"resonator", "output", "gain", "blows", "pulses"};

/// Reads the resonator and the levels of its partials at each blow: tables, or recordings whose levels are measured
/// (recorded_note.hpp). Adds what it reads to `files`. Throws BadInput.
[[nodiscard]] StruckResonator read_struck(const JsonObject& object, const ReadFile& read,
                                          std::vector<std::string>& files);

/// Throws BadInput if the blows cannot tell stiffness, exponent and unknown speeds apart.
void require_enough_levels(const JsonObject& fit, const Measurements& measured);

}  // namespace contactspline
