// SPDX-License-Identifier: MIT
// contactspline inspect: shows a spline or an instrument as a table and as a figure, or the modes of a resonator.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/inspect_json.hpp"
#include "generator/cli/instrument_page.hpp"
#include "generator/cli/parallel.hpp"
#include "generator/cli/waiting_line.hpp"
#include "generator/emit/emit_instrument.hpp"
#include "generator/spline/design_impact.hpp"
#include "generator/spline/exponent_family.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

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

std::string tolerance_line(const Material& material) {
  const SplineDesign& spline = material.spline;
  if (spline.tolerance == 0) return {};
  if (spline.minimise == ErrorOf::spectrum)
    return fmt::format("tolerance {} dB: worst error of the spectrum, and the contact duration within 1 %\n",
                       spline.tolerance);
  return fmt::format("tolerance {}, relative: at most {:.4g} % error of the {}\n", spline.tolerance,
                     100 * spline.tolerance, spline.minimise == ErrorOf::force ? "force" : "contact duration");
}

std::string memory_lines(const Material& material) {
  std::string lines;
  for (const Memory& memory : material.memories)
    lines += fmt::format("memory of weight {:.6g}, relaxation time {:.6g} us\n", memory.weight, 1e6 * memory.time_s);
  if (!lines.empty())
    lines += fmt::format("errors of impacts without memory, of {:.6g} kg: the mass that the slow stiffness stops\n",
                         material.impact ? elastic_impact(material).mass_kg : 0);
  return lines;
}

std::string loss_line(const Material& material) {
  if (material.loss_s_per_m == 0) return memory_lines(material);
  const bool fitted = material.measured && material.measured->impact_speed_m_per_s;
  return fmt::format("loss {:.6g} s/m{}\n{}", material.loss_s_per_m,
                     fitted ? ", fitted to loading and unloading" : "", memory_lines(material));
}

std::string measurement_line(const Material& material) {
  if (!material.measured) return {};
  const auto& samples = material.measured->samples;
  const PowerLaw law = nearest_power_law(samples, material.loss_s_per_m);
  return fmt::format(
      "scatter {:.2g} % of the largest force; nearest power law k = {:.4g} N/m^a, a = {:.4g}\n",
      100 * relative_scatter(samples, std::get<ForceCurve>(material.contact.law()), material.loss_s_per_m),
      law.stiffness, law.exponent);
}

std::string heading(const Design& design) {
  const Material& material = design.material;
  const double end_m = material.compensation ? design.spline.end_m : material.spline.max_compression_m;
  const std::string_view minimised = material.spline.minimise == ErrorOf::spectrum ? ", minimise spectrum"
                                     : material.spline.minimise == ErrorOf::force  ? ", minimise force"
                                                                                   : "";
  return fmt::format("{}{}{}\n{}, {} {} segments over 0 to {:.6g} m{}\n{}{}{}\n", material.name,
                     material.description.empty() ? "" : ": ", material.description, law_text(material),
                     material.spline.segments, name_of(material.spline.knots), end_m, minimised,
                     tolerance_line(material), loss_line(material), measurement_line(material));
}

std::string family_table(const Design& design) {
  if (!design.material.live_exponent) return {};
  const auto& [min, max, members] = *design.material.live_exponent;
  const auto family = exponent_family(design.material, static_cast<int>(design.spline.segments.size()));
  std::string table = fmt::format("\nlive exponent {} to {}, {} members over 0 to {:.6g} m\n", min, max, members,
                                  family.max_compression_m);
  if (const auto error = measure_family(family, design.material))
    table += fmt::format("{:<36} {:>10.4g} %\n{:<36} {:>10.4g} %\n  at any exponent, for the same impacts\n",
                         "contact duration", 100 * error->contact_duration, "max compression",
                         100 * error->max_compression);
  return table;
}

// What to do about a table that is poor for sound. Empty if it is not.
std::string sound_advice(const Design& design) {
  if (!design.spectrum || design.spectrum->worst_db <= kPoorSpectrumError_db) return {};
  const bool is_for_spectrum = design.material.spline.minimise == ErrorOf::spectrum;
  return fmt::format("  poor for sound: more than {:g} dB. Try {}\n", kPoorSpectrumError_db,
                     is_for_spectrum ? R"("segments": 48, or "tolerance_db": 3)"
                                     : R"("knots": "optimal", "minimise": "spectrum", "segments": 48)");
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
  if (design.spectrum)
    table += fmt::format(
        "{:<36} {:>10.4g} dB\n{:<36} {:>10.4g} dB\n  of the force of these impacts, up to {:g} Hz and down to {:g} "
        "dB\n",
        "spectrum, worst", design.spectrum->worst_db, "spectrum, on average", design.spectrum->mean_db,
        kMaxSpectrumFrequency_hz, kMinSpectrumLevel_db);
  const std::string too_short = short_contact(design.material, kDefaultRate);
  return table + sound_advice(design) + (too_short.empty() ? "" : "  " + too_short + "\n") + family_table(design);
}

/// A row of --compare.
struct Family {
  std::string_view name;
  Knots knots;
  ErrorOf minimise;
};
constexpr Family kFamilies[] = {{"uniform", Knots::uniform, ErrorOf::contact_duration},
                                {"graded", Knots::graded, ErrorOf::contact_duration},
                                {"optimal", Knots::optimal, ErrorOf::contact_duration},
                                {"spectrum", Knots::optimal, ErrorOf::spectrum}};

// The same material with other knots and the same number of segments, without compensation: uniform knots cannot have
// it.
Design with_knots(Material material, const Family& family, double tolerance) {
  SplineDesign& spline = material.spline;
  spline.knots = family.knots;
  spline.minimise = family.minimise;
  spline.tolerance = tolerance;
  if (family.knots == Knots::optimal) spline.segments = std::min(spline.segments, kMaxFittedSegments);
  material.compensation.reset();
  const std::string name = material.name;
  return design_material(std::move(material), name);
}

// The number of segments that a family needs for a tolerance of the contact duration. Nothing if the design refuses
// it or the family has another tolerance.
std::optional<std::size_t> segments_for(const Material& material, const Family& family, double tolerance) {
  if (family.minimise != ErrorOf::contact_duration) return std::nullopt;
  try {
    return with_knots(material, family, tolerance).spline.segments.size();
  } catch (const BadInput&) {
    return std::nullopt;
  }
}

std::string decibels(const std::optional<SpectrumError>& error, double SpectrumError::*member) {
  return error ? fmt::format("{:.4g} dB", (*error).*member) : "-";
}

std::string comparison(const std::string& argument, const InspectOptions& options, const Design& design) {
  const WaitingLine line("comparing knots for " + argument);
  Material material = design.material;
  if (!material.impact) refuse(argument, "impact", "missing", "an object, because --compare measures impacts");
  material.spline.max_compression_m =
      max_compression(material.contact, material.impact->mass_kg, material.impact->max_speed_m_per_s);
  std::vector<Design> families;
  std::string table = fmt::format(
      "{}\nworst errors for {} kg at {} to {} m/s on a rigid barrier\n\n"
      "{:<9} {:>8} {:>17} {:>17} {:>12} {:>12} {:>12} {:>18} {:>8}\n",
      material.name, material.impact->mass_kg, material.impact->min_speed_m_per_s, material.impact->max_speed_m_per_s,
      "knots", "segments", "contact duration", "max compression", "force", "spectrum", "its mean", "segments for 1 %",
      "0.1 %");
  std::vector<ComparedFamily> rows;
  const auto or_dash = [](std::optional<std::size_t> segments) {
    return segments ? fmt::format("{}", *segments) : "-";
  };
  for (const Family& family : kFamilies) {
    // nothing to design for where the spectra cannot be compared
    if (family.minimise == ErrorOf::spectrum && !families.front().spectrum) continue;
    const Design& made = families.emplace_back(with_knots(material, family, 0));
    const Quality& q = made.quality;
    const auto& row = rows.emplace_back(ComparedFamily{family.name, made.spline.segments.size(), q, made.spectrum,
                                                       segments_for(material, family, 0.01),
                                                       segments_for(material, family, 0.001)});
    table +=
        fmt::format("{:<9} {:>8} {:>15.4g} % {:>15.4g} % {:>10.4g} % {:>12} {:>12} {:>18} {:>8}\n", family.name,
                    made.spline.segments.size(), 100 * q.impact->contact_duration, 100 * q.impact->max_compression,
                    100 * q.force.worst, decibels(made.spectrum, &SpectrumError::worst_db),
                    decibels(made.spectrum, &SpectrumError::mean_db), or_dash(row.segments_for_1_percent),
                    or_dash(row.segments_for_01_percent));
  }
  if (!options.figure.empty()) {
    write_figure(options.figure, FigureKind::kKnots, input_files(argument, material), options.force,
                 [&](FigureFormat format) { return figure_of(families, format); });
    table += fmt::format("\nfigure: {}\n", options.figure);
  }
  return options.json ? json_of(material, rows) : table;
}

// Names the figure, except after JSON.
std::string figure_line(const InspectOptions& options) {
  return options.figure.empty() || options.json ? "" : fmt::format("\nfigure: {}\n", options.figure);
}

double frequency_hz(const ResonatorMode& mode) {
  return mode.mode.angular_frequency_rad_per_s / (2 * std::numbers::pi);
}

// The modes that a simulation at this rate keeps.
std::string resonator_table(const Resonator& resonator, double rate) {
  const ModeSet set = modes_of(resonator, rate / 2);
  if (set.modes.empty())
    refuse(resonator.name, "--rate", fmt::format("no mode lies below {} Hz", rate / 2), "a higher rate");
  return fmt::format("{}{}{}\n{} modes from {:.6g} to {:.6g} Hz at {} Hz{}\n", resonator.name,
                     resonator.description.empty() ? "" : ": ", resonator.description, set.modes.size(),
                     frequency_hz(set.modes.front()), frequency_hz(set.modes.back()), rate,
                     set.cut ? "; max_modes leaves out others" : "");
}

// The speeds and the normal forces at which surfaces slide in the table.
constexpr std::array kSlidingSpeeds_m_per_s = {0.01, 0.03, 0.1, 0.3, 1.0, 3.0};
constexpr std::array kPressed_n = {0.1, 1.0, 10.0};

std::string friction_table(const RubbingSurfaces& surfaces) {
  const auto& [bristles, heat] = surfaces.friction;
  std::string table = fmt::format(
      "{}\nbristles {:.6g} 1/m and {:.6g} s/m times the normal force; they yield at {:.4g} um\n", title_of(surfaces),
      bristles.stiffness_per_m, bristles.damping_s_per_m, 1e6 * heat.cold_coefficient / bristles.stiffness_per_m);
  if (!surfaces.warms()) return table + fmt::format("coefficient {:.6g}\n", heat.cold_coefficient);
  table += fmt::format(
      "coefficient {:.6g} cold, {:.6g} hot, halfway {:.6g} K above ambient\n\nsliding on and on, {:.6g} m wide: "
      "coefficient, K above ambient\n{:>12}",
      heat.cold_coefficient, heat.hot_coefficient, heat.softening_k, surfaces.width_m, "speed [m/s]");
  for (const double force : kPressed_n) table += fmt::format(" {:>15}", fmt::format("{:g} N", force));
  for (const double speed : kSlidingSpeeds_m_per_s) {
    table += fmt::format("\n{:>12g}", speed);
    for (const double force : kPressed_n) {
      const auto [coefficient, temperature_k] = steady_sliding(surfaces, speed, force);
      table += fmt::format(" {:>7.4f} {:>7.1f}", coefficient, temperature_k);
    }
  }
  return table + "\n";
}

std::string friction_page(const std::string& argument, const RubbingSurfaces& surfaces,
                          const InspectOptions& options) {
  if (options.compare || options.sample_rate_hz)
    refuse(argument, options.compare ? "--compare" : "--rate", "cannot be used with a friction",
           options.compare ? "with a material" : "with a resonator, a keyboard or an instrument");
  if (!options.figure.empty())
    write_figure(options.figure, FigureKind::kFriction, input_files(argument), options.force,
                 [&](FigureFormat format) { return figure_of(surfaces, format); });
  return options.json ? json_of(surfaces) : friction_table(surfaces) + figure_line(options);
}

std::string resonator_page(const std::string& argument, const Resonator& resonator, const InspectOptions& options) {
  if (options.compare) refuse(argument, "--compare", "cannot be used with a resonator", "with a material");
  const double rate = options.sample_rate_hz.value_or(kDefaultRate);
  const std::string page = [&] {
    const WaitingLine line("computing the modes of " + resonator.name);
    const std::string table = resonator_table(resonator, rate);
    return options.json ? json_of(resonator, rate) : table;
  }();
  if (!options.figure.empty())
    write_figure(options.figure, FigureKind::kResonator, input_files(argument), options.force,
                 [&](FigureFormat format) { return figure_of(resonator, rate / 2, format); });
  return page + figure_line(options);
}

// The keys of the published notes, and the first and the last of the keyboard.
std::vector<KeyRow> key_rows(const Keyboard& keyboard, double rate) {
  std::set<int> keys = {keyboard.first_key, keyboard.last_key};
  for (const PublishedNote& note : keyboard.notes) keys.insert(note.key);
  std::vector<KeyRow> rows;
  for (const int key : keys) rows.push_back(key_row(keyboard, key, rate));
  return rows;
}

std::string keyboard_table(const Keyboard& keyboard, const std::vector<KeyRow>& rows, double rate) {
  std::string table = fmt::format(
      "{}{}{}\n{} keys, {} to {}; two strings from key {} on, three from {} on; dampers up to key {}\n"
      "hammers of {} to {} m/s, felts of {} segments with a loss of {} s/m\n{}\n"
      "{:>4} {:>9} {:>13} {:>7} {:>6} {:>9} {:>10} {:>10} {:>11} {:>11} {:>9}\n"
      "{:>4} {:>9} {:>13} {:>7} {:>6} {:>9} {:>10} {:>10} {:>11} {:>11} {:>9}\n",
      keyboard.name, keyboard.description.empty() ? "" : ": ", keyboard.description,
      keyboard.last_key - keyboard.first_key + 1, keyboard.first_key, keyboard.last_key, keyboard.first_double_key,
      keyboard.first_triple_key, keyboard.last_damped_key, keyboard.min_speed_m_per_s, keyboard.max_speed_m_per_s,
      keyboard.segments, keyboard.felt_loss_s_per_m,
      keyboard.body ? fmt::format("body {}\n", keyboard.body->resonator) : "", "key", "pitch", "inharmonicity",
      "strings", "modes", "length", "mass", "tension", "hammer", "stiffness", "exponent", "", "[Hz]", "", "", "",
      "[m]", "[kg]", "[N]", "[kg]", "[N/m^a]", "");
  for (const auto& [key, note, pitch_hz, inharmonicity, modes] : rows) {
    const PowerLaw& felt = *note.felt.contact.power_law();
    table += fmt::format(
        "{:>4} {:>9.6g} {:>13.4g} {:>7} {:>6} {:>9.4g} {:>10.4g} {:>10.4g} {:>11.4g} {:>11.4g} {:>9.4g}\n", key,
        pitch_hz, inharmonicity, note.strings, modes, note.string.length_m, note.string.mass_kg,
        note.string.tension_n, note.strings * note.hammer_mass_kg, note.strings * felt.stiffness, felt.exponent);
  }
  return table + fmt::format("modes of one string at {} Hz; hammer and stiffness for all strings of the key\n", rate);
}

std::string keyboard_page(const std::string& argument, const Keyboard& keyboard, const InspectOptions& options) {
  if (options.compare || !options.figure.empty())
    refuse(argument, options.compare ? "--compare" : "--figure", "cannot be used with a keyboard",
           options.compare ? "with a material" : "with a material, a resonator or an instrument");
  const double rate = options.sample_rate_hz.value_or(kDefaultRate);
  const auto rows = key_rows(keyboard, rate);
  return options.json ? json_of(keyboard, rows, rate) : keyboard_table(keyboard, rows, rate);
}

// As JSON it is what `generate` writes.
std::string json_of(const InstrumentModel& model, double rate) {
  const auto json = std::ranges::find(emitters(), "json", &Emitter::name);
  return emit(*json, model, rate / 2, fmt::format("contactspline inspect {}.json --json", model.name));
}

std::string instrument_page(const std::string& argument, const InstrumentSource& source,
                            const InspectOptions& options) {
  if (options.compare) refuse(argument, "--compare", "cannot be used with an instrument", "with a material");
  const double rate = options.sample_rate_hz.value_or(kDefaultRate);
  if (!options.figure.empty())
    write_figure(options.figure, FigureKind::kInstrument, source.files, options.force,
                 [&](FigureFormat format) { return figure_of(source.model, format); });
  if (options.json) return json_of(source.model, rate);
  const std::vector<OutputPeak> peaks = [&] {
    const WaitingLine line("playing " + source.model.name);
    return output_peaks(source.model, rate);
  }();
  return instrument_table(source.model, rate, peaks) + figure_line(options);
}

std::string material_page(const std::string& argument, const InspectOptions& options) {
  const Design design = design_argument(argument, true);
  if (options.sample_rate_hz)
    refuse(argument, "--rate", "cannot be used with a material", "with a resonator, a keyboard or an instrument");
  if (options.compare) return comparison(argument, options, design);
  if (!options.figure.empty())
    write_figure(options.figure, FigureKind::kSpline, input_files(argument, design.material), options.force,
                 [&](FigureFormat format) { return figure_of(design, format); });
  if (options.json) return json_of(design);
  return heading(design) + coefficient_table(design.spline) + quality_table(design) + figure_line(options);
}

std::string page_of(const std::string& argument, const InspectOptions& options) {
  if (const auto friction = friction_argument(argument)) return friction_page(argument, *friction, options);
  if (const auto resonator = resonator_argument(argument)) return resonator_page(argument, *resonator, options);
  if (const auto instrument = instrument_argument(argument)) return instrument_page(argument, *instrument, options);
  if (const auto keyboard = keyboard_argument(argument)) return keyboard_page(argument, *keyboard, options);
  return material_page(argument, options);
}

// Several pages: one after the other, or an array of JSON.
std::string joined(const std::vector<std::string>& pages, bool json) {
  if (pages.size() == 1) return pages.front();
  const std::string text = fmt::format("{}", fmt::join(pages, json ? "," : "\n"));
  return json ? "[\n" + text + "]\n" : text;
}

}  // namespace

void inspect(const InspectOptions& options) {
  const std::size_t files = options.materials.size();
  if (!options.figure.empty()) (void)figure_format(options.figure);
  if (!options.figure.empty() && files > 1)
    throw BadInput(fmt::format("--figure: draws one file, not {}; allowed: one MATERIAL", files));
  std::vector<std::string> pages(files);
  in_parallel(files, options.jobs, "inspected",
              [&](std::size_t i) { pages[i] = page_of(options.materials[i], options); });
  write_stdout(joined(pages, options.json));
}

}  // namespace contactspline
