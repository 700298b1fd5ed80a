// SPDX-License-Identifier: MIT
// contactspline render: an instrument to a sound file and a picture.
#include "generator/render.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "generator/cli/allowed.hpp"
#include "generator/cli/commands.hpp"
#include "generator/cli/material_argument.hpp"
#include "generator/cli/output.hpp"
#include "generator/cli/picture.hpp"
#include "generator/cli/render_output.hpp"
#include "generator/cli/wav.hpp"
#include "generator/error.hpp"

namespace contactspline {
namespace {

struct RenderOptions {
  std::string material = "rubber_on_wood";
  std::optional<double> mass_kg;
  std::optional<double> speed_m_per_s;
  double start_m = -0.001;
  double gravity_m_per_s2 = 9.81;
  double stiffness_ratio = 1;
  std::optional<double> loss_s_per_m;
  double duration_s = 5;
  int sample_rate_hz = 44100;
  std::string signal = "force";
  std::string output;
  std::string svg;
};

double given_or(std::optional<double> given, const Design& design, double Impact::*member,
                const RenderOptions& options, const char* option) {
  if (given) return *given;
  const auto& impact = design.material.impact;
  if (!impact)
    throw BadInput(
        fmt::format("{}: {}: missing, and the material has no impact; allowed: a number", options.material, option));
  return (*impact).*member;
}

MassBarrierScore score_of(const RenderOptions& options, const Design& design) {
  const double mass_kg = given_or(options.mass_kg, design, &Impact::mass_kg, options, "--mass");
  const double speed = given_or(options.speed_m_per_s, design, &Impact::max_speed_m_per_s, options, "--speed");
  return {{.mass_kg = mass_kg,
           .gravity_m_per_s2 = options.gravity_m_per_s2,
           .contact = {.stiffness_ratio = options.stiffness_ratio,
                       .loss_s_per_m = options.loss_s_per_m.value_or(design.material.loss_s_per_m)}},
          options.start_m,
          speed,
          options.duration_s,
          static_cast<double>(options.sample_rate_hz)};
}

double peak_of(std::span<const double> signal) {
  double peak = 0;
  for (const double value : signal) peak = std::max(peak, std::abs(value));
  return peak;
}

std::size_t contacts_in(std::span<const double> force) {
  std::size_t contacts = 0;
  for (std::size_t i = 0; i < force.size(); ++i) contacts += force[i] > 0 && (i == 0 || force[i - 1] == 0);
  return contacts;
}

void render_mass_barrier_command(const RenderOptions& options) {
  require_short("--duration", options.duration_s, options.sample_rate_hz);
  const Design design = design_argument(options.material);
  const std::string svg = picture_beside(options.output, options.svg);
  require_distinct({{options.output, svg}}, input_files(options.material, design.material));
  const auto motion = render_mass_barrier(segment_table(design.spline), score_of(options, design), show_progress);
  const auto& signal = options.signal == "force" ? motion.force_n : motion.displacement_m;
  const double peak = peak_of(signal);
  const std::vector<OutputFile> files = {
      {options.output, wav_bytes(signal, scale_to_peak(peak), 1, options.sample_rate_hz)},
      {svg, picture_of(motion, fmt::format("mass on a barrier: {}", design.material.name))}};
  write_files(files);
  write_stdout(fmt::format(
      "{} contacts in {} s, largest force {:.4g} N\nfull scale of the sound: {:.4g} {}\nsound:   {}\npicture: {}\n",
      contacts_in(motion.force_n), options.duration_s, peak_of(motion.force_n), peak / kPeak,
      options.signal == "force" ? "N" : "m", options.output, svg));
}

void add_mass_barrier(CLI::App& render) {
  const auto options = std::make_shared<RenderOptions>();
  CLI::App* command =
      render.add_subcommand("mass-barrier", "A mass thrown at a rigid barrier, with gravity: it bounces");
  const auto number = [&](const char* name, auto& value, const char* help, auto least, auto most) {
    return command->add_option(name, value, help)->check(number_from(least, most));
  };
  command->add_option("--material", options->material, kMaterialHelp)
      ->check(not_empty(kMaterialHelp))
      ->capture_default_str();
  number("--mass", options->mass_kg, "mass in kg (default: the material's)", 1e-9, 1e4);
  number("--speed", options->speed_m_per_s, "speed of the throw in m/s (default: the material's largest)", 0.0, 1e3);
  number("--start", options->start_m, "displacement at the throw in m, into the barrier", -1e3, 1.0)
      ->capture_default_str();
  number("--gravity", options->gravity_m_per_s2, "towards the barrier, in m/s^2", 0.0, 1e3)->capture_default_str();
  number("--stiffness-ratio", options->stiffness_ratio, "multiplies the material's stiffness", 1e-6, 1e6)
      ->capture_default_str();
  number("--loss", options->loss_s_per_m, "Hunt-Crossley loss in s/m (default: the material's)", 0.0, 1e3);
  number("--duration", options->duration_s, "in s", 1e-3, 3600.0)->capture_default_str();
  number("--rate", options->sample_rate_hz, "sample rate in Hz", 1000, 768000)->capture_default_str();
  command->add_option("--signal", options->signal, "what is heard")
      ->check(one_of({"force", "displacement"}))
      ->capture_default_str();
  add_outputs(*command, options->output, options->svg);
  command->footer(
      "Example:\n"
      "  contactspline render mass-barrier --material rubber_on_wood --loss 0.08 -o bounce.wav");
  command->callback([options] { render_mass_barrier_command(*options); });
}

}  // namespace

void add_render(CLI::App& app) {
  CLI::App* command = app.add_subcommand("render", "Play an instrument to a sound file and a picture");
  command->require_subcommand(1);
  add_mass_barrier(*command);
  add_render_score(*command);
}

}  // namespace contactspline
