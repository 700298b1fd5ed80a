// SPDX-License-Identifier: MIT
// contactspline impact: compares exact, spline and simulated impacts in a table.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/spline/simulated_impact.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

const Impact& impact_of(const Material& material, const std::string& argument) {
  if (!material.impact) refuse(argument, "impact", "missing", "an object with the mass of the impacts");
  return *material.impact;
}

// A closed form without loss. With loss, exact and spline impact are computed by the same quadrature.
BarrierImpact exact_impact(const Material& material, double mass_kg, double speed) {
  const ContactLaw& contact = material.contact;
  if (material.loss_s_per_m > 0) return barrier_impact(law_view(contact), mass_kg, speed, material.loss_s_per_m);
  return {max_compression(contact, mass_kg, speed), contact_duration(contact, mass_kg, speed), speed};
}

BarrierImpact spline_impact(const Design& design, double mass_kg, double speed) {
  if (design.material.loss_s_per_m > 0)
    return barrier_impact(law_view(design.spline), mass_kg, speed, design.material.loss_s_per_m);
  const SplineImpact impact = impact_on_spline(design.spline, mass_kg, speed);
  return {impact.max_compression_m, impact.contact_duration_s, speed};
}

// The simulation takes one step per sample, and a heavy mass on a soft spring stays in contact for a long time.
void require_short(const Design& design, double mass_kg, double speed, double rate_hz, const std::string& argument) {
  constexpr double kMaxSamples = 1e8;
  const double samples = spline_impact(design, mass_kg, speed).contact_duration_s * rate_hz;
  if (!(samples <= kMaxSamples))
    refuse(argument, "--rate",
           fmt::format("at {} m/s and {} Hz the contact lasts {:.3g} samples", speed, rate_hz, samples),
           fmt::format("at most {:g}", kMaxSamples));
}

std::string loss_text(const Material& material, const BarrierImpact& exact, double speed) {
  if (material.loss_s_per_m == 0) return {};
  return fmt::format(", loss {:.4g} s/m: restitution {:.4g}", material.loss_s_per_m,
                     exact.exit_speed_m_per_s / speed);
}

std::string heading(const Design& design, double mass_kg, double speed) {
  const BarrierImpact exact = exact_impact(design.material, mass_kg, speed);
  const BarrierImpact spline = spline_impact(design, mass_kg, speed);
  const double exact_s = exact.contact_duration_s;
  const double exact_m = exact.max_compression_m;
  return fmt::format(
      "{}, {} kg at {} m/s{}\n"
      "             {:>12} {:>9} {:>14} {:>9} {:>15} {:>8}\n"
      "  exact      {:>9.3f} us {:>9} {:>11.4f} um\n"
      "  spline {:>3} {:>9.3f} us {:>7.3f} % {:>11.4f} um {:>7.3f} %\n",
      design.material.name, mass_kg, speed, loss_text(design.material, exact, speed), "duration", "error",
      "compression", "error", "exit error", "samples", 1e6 * exact_s, "", 1e6 * exact_m,
      design.spline.segments.size(), 1e6 * spline.contact_duration_s, 100 * (spline.contact_duration_s / exact_s - 1),
      1e6 * spline.max_compression_m, 100 * (spline.max_compression_m / exact_m - 1));
}

std::string simulated_row(const Design& design, double mass_kg, double speed, double rate_hz) {
  const SimulatedImpact found =
      simulate_impact(segment_table(design.spline), mass_kg, speed, rate_hz, 0.5, design.material.loss_s_per_m);
  const BarrierImpact exact = exact_impact(design.material, mass_kg, speed);
  const double exact_s = exact.contact_duration_s;
  const double exact_m = exact.max_compression_m;
  return fmt::format("  {:>6.1f} kHz {:>9.3f} us {:>7.3f} % {:>11.4f} um {:>7.3f} % {:>15.1e} {:>8.2f}\n",
                     rate_hz / 1000, 1e6 * found.contact_duration_s, 100 * (found.contact_duration_s / exact_s - 1),
                     1e6 * found.max_compression_m, 100 * (found.max_compression_m / exact_m - 1),
                     found.exit_speed_m_per_s / exact.exit_speed_m_per_s - 1, exact_s * rate_hz);
}

}  // namespace

void compare_impacts(const ImpactOptions& options) {
  std::string text;
  for (const std::string& argument : options.materials) {
    const Design design = design_argument(argument);
    const Impact& impact = impact_of(design.material, argument);
    for (const double speed : options.speeds.empty() ? std::vector{impact.max_speed_m_per_s} : options.speeds) {
      text += heading(design, impact.mass_kg, speed);
      for (const double rate : options.rates) require_short(design, impact.mass_kg, speed, rate, argument);
      for (const double rate : options.rates) text += simulated_row(design, impact.mass_kg, speed, rate);
    }
  }
  write_stdout(text);
}

}  // namespace contactspline
