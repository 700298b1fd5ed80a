// SPDX-License-Identifier: MIT
// Where the contact lies in a recorded pulse.
#pragma once

#include <span>

#include "generator/fit/measurements.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// What a measured impact may have: its contact duration [s] and its largest force [N].
inline constexpr Range kMeasuredDuration{1e-6, 0.2}, kMeasuredForce{1e-3, 1e6};

/// The contact of a recorded pulse, and as long before and after it, without offset, drift and hum of the sensor; of
/// many samples the means of neighbours. `lines` are those of the samples in their file. Throws BadInput if time does
/// not rise, if there is no contact or a second one, if the record begins or ends within it, if it has too few
/// samples or a saturated top, and if impulse, mass and speed disagree.
[[nodiscard]] Pulse contact_window(const Pulse& recorded, std::span<const std::size_t> lines, double mass_kg);

/// The standard deviation of white noise in a recorded force, in its unit: second differences take the contact away.
[[nodiscard]] double white_noise_of(const std::vector<double>& force);

/// Contact of a pulse: time from the first to the last sample above a tenth of the largest force, that force [N], and
/// the impulse [N s].
struct PulseMeasures {
  double begin_s, end_s, max_force_n, impulse_n_s;
};
[[nodiscard]] PulseMeasures measures_of(const Pulse& pulse);

}  // namespace contactspline
