// SPDX-License-Identifier: MIT
// contactspline render mass-barrier: a bouncing mass to a sound file and a figure.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/render_output.hpp"
#include "generator/cli/sound_file.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

double option_or(std::optional<double> given, const Design& design, double Impact::*member,
                 const MassBarrierOptions& options, const char* option) {
  if (given) return *given;
  const auto& impact = design.material.impact;
  if (!impact)
    throw BadInput(
        fmt::format("{}: {}: missing, and the material has no impact; allowed: a number", options.material, option));
  return (*impact).*member;
}

MassBarrierScore score_of(const MassBarrierOptions& options, const Design& design) {
  const double mass_kg = option_or(options.mass_kg, design, &Impact::mass_kg, options, "--mass");
  const double speed = option_or(options.speed_m_per_s, design, &Impact::max_speed_m_per_s, options, "--speed");
  return {{.mass_kg = mass_kg,
           .gravity_m_per_s2 = options.gravity_m_per_s2,
           .contact = {.stiffness_ratio = options.stiffness_ratio,
                       .loss_s_per_m = options.loss_s_per_m.value_or(design.material.loss_s_per_m)}},
          options.start_m,
          speed,
          options.duration_s,
          static_cast<double>(options.output.sample_rate_hz)};
}

std::size_t contacts_in(std::span<const double> force) {
  std::size_t contacts = 0;
  for (std::size_t i = 0; i < force.size(); ++i) contacts += force[i] > 0 && (i == 0 || force[i - 1] == 0);
  return contacts;
}

}  // namespace

void render_mass_barrier(const MassBarrierOptions& options) {
  require_short("--duration", options.duration_s, options.output.sample_rate_hz);
  const Design design = design_argument(options.material);
  require_outputs(options.output, 1, input_files(options.material, design.material));
  const auto motion = play_mass_barrier(segment_table(design.spline), score_of(options, design), show_progress);
  std::vector<double> signal = options.signal == "force" ? motion.force_n : motion.displacement_m;
  fade_end(signal, options.output.sample_rate_hz);
  const double scale = scale_of(options.output, signal);
  const std::string written = write_outputs(
      options.output, sound_bytes(options.output.sound, signal, scale, 1, options.output.sample_rate_hz),
      [&](FigureFormat format) {
        return figure_of(motion, fmt::format("mass on a barrier: {}", design.material.name), format);
      });
  write_stdout(fmt::format(
      "{} contacts in {} s, largest contact force {:.4g} N\nfull scale of the sound: {:.4g} {} ({})\n{}",
      contacts_in(motion.force_n), options.duration_s, peak_of<double>(motion.force_n), 1 / scale,
      options.signal == "force" ? "N" : "m", options.signal == "force" ? "contact force" : "displacement", written));
}

}  // namespace contactspline
