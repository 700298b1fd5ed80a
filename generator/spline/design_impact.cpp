// SPDX-License-Identifier: MIT
#include "generator/spline/design_impact.hpp"

#include <fmt/format.h>

#include <span>

#include "contactspline/step/contact.hpp"
#include "generator/contact/memory_impact.hpp"
#include "generator/spline/simulated_impact.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

// By quadrature or integration, of the law or of the spline alike.
BarrierImpact lossy_impact(const LawView& law, const Material& material, double mass_kg, double speed_m_per_s) {
  if (material.memories.empty()) return barrier_impact(law, mass_kg, speed_m_per_s, material.loss_s_per_m);
  return memory_impact(law, mass_kg, speed_m_per_s, material.loss_s_per_m, material.memories);
}

bool is_lossy(const Material& material) {
  return material.loss_s_per_m > 0 || !material.memories.empty();
}

constexpr int kMotionSteps = 128;  // each way
constexpr double kPhase = 0.5;

std::vector<ImpactMoment> motion_of(const LawView& law, const Material& material, double mass_kg,
                                    double speed_m_per_s) {
  if (material.memories.empty())
    return barrier_motion(law, mass_kg, speed_m_per_s, material.loss_s_per_m, kMotionSteps);
  return memory_motion(law, mass_kg, speed_m_per_s, material.loss_s_per_m, material.memories);
}

// Refuses a contact that lasts too many samples: a heavy mass on a soft spring stays in contact for a long time.
void require_short(const Design& design, double mass_kg, double speed_m_per_s, double sample_rate_hz,
                   std::string_view argument, double max_samples) {
  const double samples = spline_impact(design, mass_kg, speed_m_per_s).contact_duration_s * sample_rate_hz;
  if (!(samples <= max_samples))
    refuse(
        argument, "--rate",
        fmt::format("at {} m/s and {} Hz the contact lasts {:.3g} samples", speed_m_per_s, sample_rate_hz, samples),
        fmt::format("at most {:g}", max_samples));
}

}  // namespace

BarrierImpact exact_impact(const Material& material, double mass_kg, double speed_m_per_s) {
  const ContactLaw& contact = material.contact;
  if (is_lossy(material)) return lossy_impact(law_view(contact), material, mass_kg, speed_m_per_s);
  const double compression = max_compression(contact, mass_kg, speed_m_per_s);
  return {compression, contact_duration(contact, mass_kg, speed_m_per_s), speed_m_per_s, contact.force(compression)};
}

BarrierImpact spline_impact(const Design& design, double mass_kg, double speed_m_per_s) {
  if (is_lossy(design.material))
    return lossy_impact(law_view(design.spline), design.material, mass_kg, speed_m_per_s);
  const SplineImpact impact = impact_on_spline(design.spline, mass_kg, speed_m_per_s);
  const auto table = segment_table(design.spline);
  return {impact.max_compression_m, impact.contact_duration_s, speed_m_per_s,
          force<double>(std::span(table), impact.max_compression_m)};
}

std::string short_contact(double contact_duration_s, double sample_rate_hz) {
  const double samples = contact_duration_s * sample_rate_hz;
  if (samples >= kTooFewSamples) return {};
  return fmt::format("lasts {:.3g} us, {:.2g} samples at {:g} kHz, too few to follow it: {:.0f} kHz has {:g}",
                     1e6 * contact_duration_s, samples, sample_rate_hz / 1000,
                     kEnoughSamples / contact_duration_s / 1000, kEnoughSamples);
}

std::string short_contact(const Material& material, double sample_rate_hz) {
  if (!material.impact) return {};
  const Impact& impact = *material.impact;
  const double duration_s = exact_impact(material, impact.mass_kg, impact.max_speed_m_per_s).contact_duration_s;
  const std::string text = short_contact(duration_s, sample_rate_hz);
  return text.empty() ? text : fmt::format("a contact at {} m/s {}", impact.max_speed_m_per_s, text);
}

BarrierImpact simulated_impact(const Design& design, double mass_kg, double speed_m_per_s, double sample_rate_hz,
                               std::string_view argument) {
  require_short(design, mass_kg, speed_m_per_s, sample_rate_hz, argument, 1e8);
  const SimulatedImpact found = simulate_impact(segment_table(design.spline), mass_kg, speed_m_per_s, sample_rate_hz,
                                                kPhase, design.material.loss_s_per_m, design.material.memories);
  return {found.max_compression_m, found.contact_duration_s, found.exit_speed_m_per_s, found.max_force_n};
}

std::vector<ImpactMoment> exact_motion(const Material& material, double mass_kg, double speed_m_per_s) {
  return motion_of(law_view(material.contact), material, mass_kg, speed_m_per_s);
}

std::vector<ImpactMoment> spline_motion(const Design& design, double mass_kg, double speed_m_per_s) {
  return motion_of(law_view(design.spline), design.material, mass_kg, speed_m_per_s);
}

std::vector<ImpactMoment> simulated_motion(const Design& design, double mass_kg, double speed_m_per_s,
                                           double sample_rate_hz, std::string_view argument) {
  require_short(design, mass_kg, speed_m_per_s, sample_rate_hz, argument, 1e5);
  std::vector<ImpactMoment> motion;
  (void)simulate_impact(segment_table(design.spline), mass_kg, speed_m_per_s, sample_rate_hz, kPhase,
                        design.material.loss_s_per_m, design.material.memories, &motion);
  return motion;
}

}  // namespace contactspline
