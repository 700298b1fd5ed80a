// SPDX-License-Identifier: MIT
// contactspline render mass-barrier: a bouncing mass to a sound file and a figure.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "contactspline/host/engine.hpp"
#include "generator/cli/commands.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/render_output.hpp"
#include "generator/cli/sound_file.hpp"
#include "generator/player/score_player.hpp"
#include "generator/spline/design_impact.hpp"
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

MassBarrierMotion play(const MassBarrierOptions& options, const Design& design) {
  using P = MassBarrierParameter;
  const auto barrier = Engine<double>::mass_barrier(
      {.contact = segment_table(design.spline),
       .mass_kg = option_or(options.mass_kg, design, &Impact::mass_kg, options, "--mass"),
       .loss_s_per_m = options.loss_s_per_m.value_or(design.material.loss_s_per_m),
       .memories = design.material.memories});
  barrier->set(P::kGravity, options.gravity_m_per_s2);
  barrier->set(P::kStiffnessRatio, options.stiffness_ratio);
  barrier->set(P::kStart, options.start_m);
  const auto rate = static_cast<double>(options.output.model_rate_hz());
  const auto samples = static_cast<std::size_t>(std::llround(options.duration_s * rate));
  MassBarrierMotion motion{rate, std::vector<double>(samples), std::vector<double>(samples)};
  barrier->prepare(rate);
  barrier->strike(0, option_or(options.speed_m_per_s, design, &Impact::max_speed_m_per_s, options, "--speed"));
  const std::size_t block = std::max<std::size_t>(1, samples / 100);
  for (std::size_t begin = 0; begin < samples; begin += block) {
    show_progress(static_cast<double>(begin) / static_cast<double>(samples));
    const std::size_t length = std::min(block, samples - begin);
    const std::array outputs = {std::span(motion.displacement_m).subspan(begin, length),
                                std::span(motion.force_n).subspan(begin, length)};
    barrier->process(outputs, {});
  }
  show_progress(1);
  return motion;
}

std::size_t contacts_in(std::span<const double> force) {
  std::size_t contacts = 0;
  for (std::size_t i = 0; i < force.size(); ++i) contacts += force[i] > 0 && (i == 0 || force[i - 1] == 0);
  return contacts;
}

// A line where a contact at this speed is too short for the rate.
std::string short_contact_line(const MassBarrierOptions& options, const Design& design) {
  const double speed = option_or(options.speed_m_per_s, design, &Impact::max_speed_m_per_s, options, "--speed");
  if (!(speed > 0)) return {};
  const double mass_kg = option_or(options.mass_kg, design, &Impact::mass_kg, options, "--mass");
  const double duration_s =
      exact_impact(design.material, mass_kg / options.stiffness_ratio, speed).contact_duration_s;
  const std::string text = short_contact(duration_s, options.output.model_rate_hz());
  return text.empty() ? text : "a contact " + text + "\n";
}

}  // namespace

void render_mass_barrier(const MassBarrierOptions& given) {
  MassBarrierOptions options = given;
  if (options.output.sound.empty()) options.output.sound = default_sound(given.material);
  require_short("--duration", options.duration_s, options.output.model_rate_hz());
  const Design design = design_argument(options.material);
  require_outputs(options.output, 1, input_files(options.material, design.material));
  const auto motion = play(options, design);
  std::vector<double> signal = decimated(options.signal == "force" ? motion.force_n : motion.displacement_m,
                                         options.output.oversampling.value_or(1));
  fade_end(signal, options.output.sample_rate_hz);
  const double scale = scale_of(options.output, signal);
  const std::string title =
      fmt::format("{}: {:g} g thrown at {:g} m/s", title_of(design.material),
                  1e3 * option_or(options.mass_kg, design, &Impact::mass_kg, options, "--mass"),
                  option_or(options.speed_m_per_s, design, &Impact::max_speed_m_per_s, options, "--speed"));
  const std::string written = write_outputs(options.output,
                                            sound_bytes(options.output.sound, std::span<const double>(signal), scale,
                                                        1, options.output.sample_rate_hz, options.output.bits),
                                            [&](FigureFormat format) { return figure_of(motion, title, format); });
  write_stdout(fmt::format(
      "{} contacts in {} s, largest contact force {:.4g} N\n{}full scale of the sound: {:.4g} {} ({})\n{}",
      contacts_in(motion.force_n), options.duration_s, peak_of<double>(motion.force_n),
      short_contact_line(options, design), 1 / scale, options.signal == "force" ? "N" : "m",
      options.signal == "force" ? "contact force" : "displacement", written));
}

}  // namespace contactspline
