// SPDX-License-Identifier: MIT
// contactspline inspect: a spline as a table and a picture.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "generator/cli/allowed.hpp"
#include "generator/cli/commands.hpp"
#include "generator/cli/material_argument.hpp"
#include "generator/cli/output.hpp"
#include "generator/cli/picture.hpp"
#include "generator/cli/source_argument.hpp"
#include "generator/compensation.hpp"
#include "generator/design.hpp"
#include "generator/error.hpp"
#include "generator/live_exponent.hpp"

namespace contactspline {
namespace {

struct InspectOptions {
  std::string material;
  std::string svg;
  bool compare = false;
  std::optional<double> sample_rate_hz = {};
};

constexpr double kDefaultRate = 44100;

std::string coefficient_table(const Spline& spline) {
  std::string table = fmt::format("{:>5} {:>16} {:>16} {:>16} {:>16}\n{:>5} {:>16} {:>16} {:>16} {:>16}\n", "j",
                                  "knot", "energy", "force", "half curvature", "", "[m]", "[J]", "[N]", "[N/m]");
  for (std::size_t j = 0; j < spline.segments.size(); ++j) {
    const auto& s = spline.segments[j];
    table += fmt::format("{:>5} {:>16.9e} {:>16.9e} {:>16.9e} {:>16.9e}\n", j + 1, s.knot, s.energy, s.force,
                         s.half_curvature);
  }
  return table;
}

std::string loss_line(const Material& material) {
  return material.loss_s_per_m == 0 ? "" : fmt::format("loss {:.6g} s/m\n", material.loss_s_per_m);
}

std::string measurement_line(const Material& material) {
  if (!material.measured) return {};
  const auto& samples = material.measured->samples;
  const PowerLaw law = nearest_power_law(samples);
  return fmt::format("scatter {:.2g} % of the largest force; nearest power law k = {:.4g} N/m^a, a = {:.4g}\n",
                     100 * relative_scatter(samples, std::get<ForceCurve>(material.contact.law())), law.stiffness,
                     law.exponent);
}

std::string heading(const Design& design) {
  const Material& material = design.material;
  const double end_m = material.compensation ? design.spline.end_m : material.spline.max_compression_m;
  return fmt::format("{}{}{}\n{}, {} {} segments over 0 to {:.6g} m\n{}{}\n", material.name,
                     material.description.empty() ? "" : ": ", material.description, law_text(material),
                     material.spline.segments, name_of(material.spline.knots), end_m, loss_line(material),
                     measurement_line(material));
}

std::string family_table(const Design& design) {
  if (!design.material.live_exponent) return {};
  const auto& [least, most, members] = *design.material.live_exponent;
  const auto family = exponent_family(design.material, static_cast<int>(design.spline.segments.size()));
  std::string table = fmt::format("\nlive exponent {} to {}, {} members over 0 to {:.6g} m\n", least, most, members,
                                  family.max_compression_m);
  if (const auto error = measure_family(family, design.material))
    table += fmt::format("{:<36} {:>10.4g} %\n{:<36} {:>10.4g} %\n  at any exponent, for the same impacts\n",
                         "contact duration", 100 * error->contact_duration, "max compression",
                         100 * error->max_compression);
  return table;
}

std::string quality_table(const Design& design) {
  const Quality& q = design.quality;
  std::string table = fmt::format("\n{:<36} {:>12} {:>12}\n", "error", "worst", "rms");
  const auto row = [&](std::string_view what, const CurveError& error) {
    table += fmt::format("{:<36} {:>10.4g} % {:>10.4g} %\n", what, 100 * error.worst, 100 * error.rms);
  };
  row("force, of the largest force", q.force);
  row("energy, of the largest energy", q.energy);
  if (q.impact) {
    const Impact& impact = *design.material.impact;
    table += fmt::format("{:<36} {:>10.4g} %\n{:<36} {:>10.4g} %\n  for {} kg at {} to {} m/s on a rigid barrier\n",
                         "contact duration", 100 * q.impact->contact_duration, "max compression",
                         100 * q.impact->max_compression, impact.mass_kg, impact.min_speed_m_per_s,
                         impact.max_speed_m_per_s);
  }
  return table + family_table(design);
}

// The same material with other knots, as many of them; without compensation, which uniform ones do not have.
Design with_knots(Material material, Knots knots, double tolerance) {
  SplineDesign& spline = material.spline;
  spline.knots = knots;
  spline.minimise = ErrorOf::contact_duration;
  spline.tolerance = tolerance;
  if (knots == Knots::optimal) spline.segments = std::min(spline.segments, kMostFittedSegments);
  material.compensation.reset();
  const Spline found = design_spline(material, material.name);
  return {material, found, measure_quality(found, material)};
}

// Segments a family takes for a tolerance, or a dash where they would be too many.
std::string segments_for(const Material& material, Knots knots, double tolerance) {
  try {
    return fmt::format("{}", with_knots(material, knots, tolerance).spline.segments.size());
  } catch (const BadInput&) {
    return "-";
  }
}

void compare(const InspectOptions& options) {
  Design design = design_argument(options.material);
  Material& material = design.material;
  if (!material.impact)
    throw BadInput(
        fmt::format("{}: impact: missing; allowed: an object, for --compare measures impacts", options.material));
  material.spline.max_compression_m =
      material.contact.max_compression(material.impact->mass_kg, material.impact->max_speed_m_per_s);
  std::vector<Design> families;
  std::string table = fmt::format(
      "{}\nworst errors for {} kg at {} to {} m/s on a rigid barrier\n\n"
      "{:<9} {:>8} {:>17} {:>17} {:>12} {:>18} {:>8}\n",
      material.name, material.impact->mass_kg, material.impact->min_speed_m_per_s, material.impact->max_speed_m_per_s,
      "knots", "segments", "contact duration", "max compression", "force", "segments for 1 %", "0.1 %");
  for (const Knots knots : {Knots::uniform, Knots::graded, Knots::optimal}) {
    const Design& family = families.emplace_back(with_knots(material, knots, 0));
    const Quality& q = family.quality;
    table +=
        fmt::format("{:<9} {:>8} {:>15.4g} % {:>15.4g} % {:>10.4g} % {:>18} {:>8}\n", name_of(knots),
                    family.spline.segments.size(), 100 * q.impact->contact_duration, 100 * q.impact->max_compression,
                    100 * q.force.worst, segments_for(material, knots, 0.01), segments_for(material, knots, 0.001));
  }
  if (!options.svg.empty()) {
    require_distinct({{options.svg}}, input_files(options.material, material));
    write_files({{OutputFile{options.svg, picture_of(families)}}});
    table += fmt::format("\npicture: {}\n", options.svg);
  }
  write_stdout(table);
}

double frequency_hz(const ResonatorMode& mode) {
  return mode.mode.angular_frequency_rad_per_s / (2 * std::numbers::pi);
}

// What the modes that a simulation keeps lack against a steady force at the strike.
std::string resonator_table(const Resonator& resonator, double rate) {
  const ModeSet set = modes_of(resonator, rate / 2);
  if (set.modes.empty())
    throw BadInput(
        fmt::format("{}: --rate: no mode sounds below {} Hz; allowed: a higher rate", resonator.name, rate / 2));
  const double missing = missing_compliance(set.modes, rate);
  return fmt::format(
      "{}{}{}\n{} modes from {:.6g} to {:.6g} Hz{}\n\n"
      "compliance at the strike that they lack when simulated at {} Hz: {:.4g} m/N\n"
      "compensation.compliance_m_per_n for a felt that strikes here, four fifths of it: {:.4g}\n",
      resonator.name, resonator.description.empty() ? "" : ": ", resonator.description, set.modes.size(),
      frequency_hz(set.modes.front()), frequency_hz(set.modes.back()), set.cut ? ", max_modes leaves out others" : "",
      rate, missing, kServingShare * missing);
}

void inspect_resonator(const Resonator& resonator, const InspectOptions& options) {
  if (options.compare || !options.svg.empty())
    throw BadInput(fmt::format("{}: {}: says nothing of a resonator; allowed: with a material", options.material,
                               options.compare ? "--compare" : "--svg"));
  write_stdout(resonator_table(resonator, options.sample_rate_hz.value_or(kDefaultRate)));
}

void inspect(const InspectOptions& options) {
  if (const auto resonator = resonator_argument(options.material)) return inspect_resonator(*resonator, options);
  if (options.sample_rate_hz)
    throw BadInput(
        fmt::format("{}: --rate: says nothing of a material; allowed: with a resonator", options.material));
  if (options.compare) return compare(options);
  const Design design = design_argument(options.material);
  if (!options.svg.empty()) {
    require_distinct({{options.svg}}, input_files(options.material, design.material));
    write_files({{OutputFile{options.svg, picture_of(design)}}});
  }
  write_stdout(heading(design) + coefficient_table(design.spline) + quality_table(design) +
               (options.svg.empty() ? "" : fmt::format("\npicture: {}\n", options.svg)));
}

}  // namespace

void add_inspect(CLI::App& app) {
  const auto options = std::make_shared<InspectOptions>();
  CLI::App* command = app.add_subcommand("inspect", "Show a material's spline, or what a resonator's modes lack");
  command->add_option("MATERIAL", options->material, kMaterialHelp)->check(not_empty(kMaterialHelp))->required();
  command->add_option("--svg", options->svg, "also draw potential, force and their errors, and what was measured")
      ->check(file_name())
      ->type_name("FILE");
  command->add_flag("--compare", options->compare,
                    "uniform, graded and optimal knots side by side, also in the picture");
  command
      ->add_option("--rate", options->sample_rate_hz,
                   "of a resonator: sample rate in Hz at which it is simulated (44100 where left out)")
      ->check(number_from(1e3, 1e8));
  command->footer(
      "Examples:\n"
      "  contactspline inspect felt_c4 --svg felt_c4.svg\n"
      "  contactspline inspect felt_c4 --compare --svg families.svg\n"
      "  contactspline inspect string_c4 --rate 48000");
  command->callback([options] { inspect(*options); });
}

}  // namespace contactspline
