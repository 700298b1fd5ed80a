// SPDX-License-Identifier: MIT
#include "generator/spline/design_impact.hpp"

#include <fmt/format.h>

#include <span>

#include "contactspline/step/contact.hpp"
#include "generator/spline/simulated_impact.hpp"
#include "generator/support/error.hpp"

namespace contactspline {

BarrierImpact exact_impact(const Material& material, double mass_kg, double speed_m_per_s) {
  const ContactLaw& contact = material.contact;
  // With loss, exact and spline impact are computed by the same quadrature.
  if (material.loss_s_per_m > 0)
    return barrier_impact(law_view(contact), mass_kg, speed_m_per_s, material.loss_s_per_m);
  const double compression = max_compression(contact, mass_kg, speed_m_per_s);
  return {compression, contact_duration(contact, mass_kg, speed_m_per_s), speed_m_per_s, contact.force(compression)};
}

BarrierImpact spline_impact(const Design& design, double mass_kg, double speed_m_per_s) {
  if (design.material.loss_s_per_m > 0)
    return barrier_impact(law_view(design.spline), mass_kg, speed_m_per_s, design.material.loss_s_per_m);
  const SplineImpact impact = impact_on_spline(design.spline, mass_kg, speed_m_per_s);
  const auto table = segment_table(design.spline);
  return {impact.max_compression_m, impact.contact_duration_s, speed_m_per_s,
          force<double>(std::span(table), impact.max_compression_m)};
}

BarrierImpact simulated_impact(const Design& design, double mass_kg, double speed_m_per_s, double sample_rate_hz,
                               std::string_view argument) {
  // A heavy mass on a soft spring stays in contact for a long time.
  constexpr double kMaxSamples = 1e8;
  const double samples = spline_impact(design, mass_kg, speed_m_per_s).contact_duration_s * sample_rate_hz;
  if (!(samples <= kMaxSamples))
    refuse(
        argument, "--rate",
        fmt::format("at {} m/s and {} Hz the contact lasts {:.3g} samples", speed_m_per_s, sample_rate_hz, samples),
        fmt::format("at most {:g}", kMaxSamples));
  const SimulatedImpact found = simulate_impact(segment_table(design.spline), mass_kg, speed_m_per_s, sample_rate_hz,
                                                0.5, design.material.loss_s_per_m);
  return {found.max_compression_m, found.contact_duration_s, found.exit_speed_m_per_s, found.max_force_n};
}

}  // namespace contactspline
