// SPDX-License-Identifier: MIT
// Impacts of a design on a rigid barrier: of its law, of its spline, and simulated with its spline.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "generator/contact/barrier_impact.hpp"
#include "generator/spline/design.hpp"

namespace contactspline {

/// The impact by the material's law: closed forms for a power law without loss, else a quadrature with a relative
/// error of about 1e-10. mass_kg > 0, speed_m_per_s > 0.
[[nodiscard]] BarrierImpact exact_impact(const Material& material, double mass_kg, double speed_m_per_s);

/// The same by the spline, in continuous time.
[[nodiscard]] BarrierImpact spline_impact(const Design& design, double mass_kg, double speed_m_per_s);

/// The same by the contact step at a sample rate (> 0), which takes one step a sample. Throws BadInput, with
/// `argument` in its message, if the contact lasts more than 1e8 samples.
[[nodiscard]] BarrierImpact simulated_impact(const Design& design, double mass_kg, double speed_m_per_s,
                                             double sample_rate_hz, std::string_view argument);

/// Samples of a contact with which the step errs by 1 to 2 % of its duration, and below which by more than 4 %.
inline constexpr double kEnoughSamples = 10, kTooFewSamples = 4.5;

/// Says how many samples a contact has and which rate has enough of them, as "lasts 30.1 us, 1.3 samples at 44.1 kHz,
/// too few ..."; empty where they are not too few. contact_duration_s, sample_rate_hz > 0.
[[nodiscard]] std::string short_contact(double contact_duration_s, double sample_rate_hz);

/// The same of the fastest impact that a material states, as "a contact at 2 m/s lasts ..."; empty where it states
/// none.
[[nodiscard]] std::string short_contact(const Material& material, double sample_rate_hz);

/// These three impacts over time, without loss or with it: the first two at 257 moments, the third once a sample. The
/// third throws BadInput, with `argument` in its message, if the contact lasts more than 1e5 samples.
[[nodiscard]] std::vector<ImpactMoment> exact_motion(const Material& material, double mass_kg, double speed_m_per_s);
[[nodiscard]] std::vector<ImpactMoment> spline_motion(const Design& design, double mass_kg, double speed_m_per_s);
[[nodiscard]] std::vector<ImpactMoment> simulated_motion(const Design& design, double mass_kg, double speed_m_per_s,
                                                         double sample_rate_hz, std::string_view argument);

}  // namespace contactspline
