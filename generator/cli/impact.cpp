// SPDX-License-Identifier: MIT
// contactspline impact: exact, spline and simulated impacts side by side.
#include "generator/impact.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "generator/cli/allowed.hpp"
#include "generator/cli/commands.hpp"
#include "generator/cli/material_argument.hpp"
#include "generator/cli/output.hpp"
#include "generator/collision.hpp"
#include "generator/error.hpp"

namespace contactspline {
namespace {

struct ImpactOptions {
  std::vector<std::string> materials;
  std::vector<double> speeds;
  std::vector<double> rates = {44100, 88200, 176400, 352800};
};

const Impact& impact_of(const Material& material, const std::string& argument) {
  if (!material.impact)
    throw BadInput(fmt::format("{}: impact: missing; allowed: an object, for it gives the mass", argument));
  return *material.impact;
}

// Closed forms where there is no loss; else both by the same quadrature.
Collision exact_collision(const Material& material, double mass_kg, double speed) {
  const Potential& contact = material.contact;
  if (material.loss_s_per_m > 0) return collide(law_view(contact), mass_kg, speed, material.loss_s_per_m);
  return {contact.max_compression(mass_kg, speed), contact.contact_duration(mass_kg, speed), speed};
}

Collision spline_collision(const Design& design, double mass_kg, double speed) {
  if (design.material.loss_s_per_m > 0)
    return collide(law_view(design.spline), mass_kg, speed, design.material.loss_s_per_m);
  const SplineImpact impact = impact_on_spline(design.spline, mass_kg, speed);
  return {impact.max_compression_m, impact.contact_duration_s, speed};
}

// The simulation takes one step a sample, and a soft spring under a heavy mass is slow.
void require_short(const Design& design, double mass_kg, double speed, double rate_hz, const std::string& argument) {
  constexpr double kMostSamples = 1e8;
  const double samples = spline_collision(design, mass_kg, speed).contact_duration_s * rate_hz;
  if (!(samples <= kMostSamples))
    throw BadInput(
        fmt::format("{}: --rate: at {} m/s and {} Hz the contact lasts {:.3g} samples; allowed: at most {:g}",
                    argument, speed, rate_hz, samples, kMostSamples));
}

std::string loss_text(const Material& material, const Collision& exact, double speed) {
  if (material.loss_s_per_m == 0) return {};
  return fmt::format(", loss {:.4g} s/m: {:.4g} of the speed is left", material.loss_s_per_m,
                     exact.exit_speed_m_per_s / speed);
}

std::string heading(const Design& design, double mass_kg, double speed) {
  const Collision exact = exact_collision(design.material, mass_kg, speed);
  const Collision spline = spline_collision(design, mass_kg, speed);
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
  const Collision exact = exact_collision(design.material, mass_kg, speed);
  const double exact_s = exact.contact_duration_s;
  const double exact_m = exact.max_compression_m;
  return fmt::format("  {:>6.1f} kHz {:>9.3f} us {:>7.3f} % {:>11.4f} um {:>7.3f} % {:>15.1e} {:>8.2f}\n",
                     rate_hz / 1000, 1e6 * found.contact_duration_s, 100 * (found.contact_duration_s / exact_s - 1),
                     1e6 * found.max_compression_m, 100 * (found.max_compression_m / exact_m - 1),
                     found.exit_speed_m_per_s / exact.exit_speed_m_per_s - 1, exact_s * rate_hz);
}

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

}  // namespace

void add_impact(CLI::App& app) {
  const auto options = std::make_shared<ImpactOptions>();
  CLI::App* command = app.add_subcommand("impact", "Compare exact, spline and simulated impacts on a rigid barrier");
  command->add_option("MATERIAL", options->materials, kMaterialHelp)->check(not_empty(kMaterialHelp))->required();
  command
      ->add_option("--speed", options->speeds,
                   "impact speed in m/s; may be given again (default: the material's largest)")
      ->check(number_from(1e-6, 1e3))
      ->allow_extra_args(false);
  command->add_option("--rate", options->rates, "sample rate in Hz; may be given again")
      ->check(number_from(1e3, 1e8))
      ->allow_extra_args(false)
      ->capture_default_str();
  command->footer(
      "Example:\n"
      "  contactspline impact mb1 felt_c4 --speed 2\n"
      "Errors are relative to the exact motion under the contact law, the material's loss included. Where the time\n"
      "step dominates they fall by 4 with each doubling of the rate, with loss by 2.");
  command->callback([options] { compare_impacts(*options); });
}

}  // namespace contactspline
