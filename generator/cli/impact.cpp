// SPDX-License-Identifier: MIT
// contactspline impact: compares exact, spline and simulated impacts, as text, a table, CSV or JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/file_ending.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/spline/design_impact.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

/// One motion: exact, of the spline, or simulated at a sample rate.
struct Motion {
  std::string model;
  double sample_rate_hz;  ///< 0 unless simulated
  BarrierImpact impact;
};

/// All motions of one material at one speed; the first is exact.
struct Comparison {
  const Design* design;
  double mass_kg, speed;
  std::vector<Motion> motions;

  [[nodiscard]] const Material& material() const { return design->material; }
  [[nodiscard]] const BarrierImpact& exact() const { return motions.front().impact; }
  [[nodiscard]] double error(const Motion& motion, double BarrierImpact::*member) const {
    return motion.impact.*member / (exact().*member) - 1;
  }
  /// Duration of the exact contact in samples.
  [[nodiscard]] double samples(const Motion& motion) const {
    return exact().contact_duration_s * motion.sample_rate_hz;
  }
  [[nodiscard]] bool is_in_range() const {
    const Impact& impact = *material().impact;
    return speed >= impact.min_speed_m_per_s && speed <= impact.max_speed_m_per_s;
  }
};

constexpr auto kTraceHeader = "material,speed_m_per_s,model,sample_rate_hz,time_s,compression_m,force_n\n";

constexpr auto kDuration = &BarrierImpact::contact_duration_s;
constexpr auto kCompression = &BarrierImpact::max_compression_m;
constexpr auto kForce = &BarrierImpact::max_force_n;
constexpr auto kExitSpeed = &BarrierImpact::exit_speed_m_per_s;

const Impact& impact_of(const Material& material, const std::string& argument) {
  if (!material.impact) refuse(argument, "impact", "missing", "an object with the mass of the impacts");
  return *material.impact;
}

Comparison compare(const Design& design, double mass_kg, double speed, const std::vector<double>& rates,
                   const std::string& argument) {
  Comparison comparison{&design, mass_kg, speed, {}};
  comparison.motions.push_back({"exact", 0, exact_impact(design.material, mass_kg, speed)});
  comparison.motions.push_back({"spline", 0, spline_impact(design, mass_kg, speed)});
  for (const double rate : rates)
    comparison.motions.push_back({"simulated", rate, simulated_impact(design, mass_kg, speed, rate, argument)});
  return comparison;
}

std::string loss_text(const Comparison& c) {
  const Material& material = c.material();
  std::string text;
  if (material.loss_s_per_m > 0) text += fmt::format(", loss {:.4g} s/m", material.loss_s_per_m);
  if (!material.memories.empty()) text += ", with memory";
  if (text.empty()) return {};
  return text + fmt::format(": restitution {:.4g}", c.exact().exit_speed_m_per_s / c.speed);
}

std::string range_line(const Comparison& c) {
  const Impact& impact = *c.material().impact;
  if (c.is_in_range()) return {};
  return fmt::format("  out of the material's range, {} to {} m/s: the spline is not designed for this speed\n",
                     impact.min_speed_m_per_s, impact.max_speed_m_per_s);
}

// The lowest of the rates, where the contact is too short for it.
std::string short_line(const Comparison& c) {
  double rate = 0;
  for (const Motion& motion : c.motions)
    if (motion.sample_rate_hz > 0 && (rate == 0 || motion.sample_rate_hz < rate)) rate = motion.sample_rate_hz;
  const std::string text = rate > 0 ? short_contact(c.exact().contact_duration_s, rate) : "";
  return text.empty() ? text : "  the contact " + text + "\n";
}

std::string row_label(const Comparison& c, const Motion& motion) {
  if (motion.model == "spline") return fmt::format("spline {:>3}", c.design->spline.segments.size());
  return motion.model == "exact" ? "exact" : fmt::format("{:>6.1f} kHz", motion.sample_rate_hz / 1000);
}

std::string text_row(const Comparison& c, const Motion& motion) {
  std::string row =
      fmt::format("  {:<10} {:>9.3f} us ", row_label(c, motion), 1e6 * motion.impact.contact_duration_s);
  if (motion.model == "exact")
    return row + fmt::format("{:>9} {:>11.4f} um\n", "", 1e6 * motion.impact.max_compression_m);
  row += fmt::format("{:>7.3f} % {:>11.4f} um {:>7.3f} %", 100 * c.error(motion, kDuration),
                     1e6 * motion.impact.max_compression_m, 100 * c.error(motion, kCompression));
  if (motion.sample_rate_hz > 0)
    row += fmt::format(" {:>14.1e} % {:>8.2f}", 100 * c.error(motion, kExitSpeed), c.samples(motion));
  return row + "\n";
}

std::string text_of(const Comparison& c) {
  std::string text =
      fmt::format("{}, {} kg at {} m/s{}\n{}", c.material().name, c.mass_kg, c.speed, loss_text(c), range_line(c));
  text += fmt::format("             {:>12} {:>9} {:>14} {:>9} {:>16} {:>8}\n", "duration", "error", "compression",
                      "error", "exit speed error", "samples");
  for (const Motion& motion : c.motions) text += text_row(c, motion);
  return text + short_line(c);
}

/// A column of the table of speeds: three lines of heading, then a cell for each speed.
struct Column {
  std::size_t width;
  std::array<std::string, 3> heading;
  std::vector<std::string> cells;
};

template <typename Cell>
Column column(std::size_t width, std::array<std::string, 3> heading, const std::vector<Comparison>& comparisons,
              Cell cell) {
  Column made{width, std::move(heading), {}};
  for (const Comparison& c : comparisons) made.cells.push_back(cell(c));
  return made;
}

// A number of at most nine characters.
std::string fixed(double number, int decimals) {
  const std::string text = fmt::format("{:.{}f}", number, decimals);
  return text.size() <= 9 ? text : fmt::format("{:.3g}", number);
}

// The exact motion, the errors of the spline, and those of each simulation; the first column is the speed.
std::vector<Column> columns_of(const std::vector<Comparison>& comparisons) {
  const auto of = [&](std::size_t width, std::array<std::string, 3> heading, auto cell) {
    return column(width, std::move(heading), comparisons, cell);
  };
  std::vector<Column> columns{
      of(9, {"", "speed", "[m/s]"},
         [](const Comparison& c) { return fmt::format("{:.5g}{}", c.speed, c.is_in_range() ? " " : "*"); }),
      of(13, {"exact", "duration", "[us]"},
         [](const Comparison& c) { return fixed(1e6 * c.exact().contact_duration_s, 3); }),
      of(13, {"exact", "compression", "[um]"},
         [](const Comparison& c) { return fixed(1e6 * c.exact().max_compression_m, 4); }),
      of(10, {"spline", "duration", "error [%]"},
         [](const Comparison& c) { return fixed(100 * c.error(c.motions[1], kDuration), 3); }),
      of(12, {"spline", "compression", "error [%]"},
         [](const Comparison& c) { return fixed(100 * c.error(c.motions[1], kCompression), 3); })};
  for (std::size_t i = 2; i < comparisons.front().motions.size(); ++i)
    columns.push_back(
        of(10,
           {fmt::format("{:.4g} kHz", comparisons.front().motions[i].sample_rate_hz / 1000), "duration", "error [%]"},
           [=](const Comparison& c) { return fixed(100 * c.error(c.motions[i], kDuration), 3); }));
  return columns;
}

std::string lines_of(std::span<const Column* const> columns) {
  std::string lines;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const Column* shown : columns) lines += fmt::format("{:>{}}", shown->heading[i], shown->width);
    lines += '\n';
  }
  for (std::size_t i = 0; i < columns.front()->cells.size(); ++i) {
    for (const Column* shown : columns) lines += fmt::format("{:>{}}", shown->cells[i], shown->width);
    lines += '\n';
  }
  return lines;
}

// One line for each speed, of at most 100 columns: where there are more, the speeds come again with the next ones.
std::string table_of(const std::vector<Comparison>& comparisons) {
  constexpr std::size_t kMaxWidth = 100;
  const Comparison& first = comparisons.front();
  const std::vector<Column> columns = columns_of(comparisons);
  std::string table = fmt::format("{}, {} kg\n", first.material().name, first.mass_kg);
  std::vector<const Column*> shown{&columns.front()};
  std::size_t width = columns.front().width;
  for (std::size_t i = 1; i < columns.size(); ++i) {
    if (width + columns[i].width > kMaxWidth) {
      table += lines_of(shown) + '\n';
      shown.resize(1);
      width = columns.front().width;
    }
    shown.push_back(&columns[i]);
    width += columns[i].width;
  }
  table += lines_of(shown);
  if (std::ranges::all_of(comparisons, &Comparison::is_in_range)) return table;
  const Impact& impact = *first.material().impact;
  return table + fmt::format("* out of the material's range, {} to {} m/s\n", impact.min_speed_m_per_s,
                             impact.max_speed_m_per_s);
}

std::string csv_of(const std::vector<Comparison>& comparisons) {
  std::string csv =
      "material,mass_kg,loss_s_per_m,speed_m_per_s,in_range,model,sample_rate_hz,contact_duration_s,max_compression_"
      "m,"
      "exit_speed_m_per_s,max_force_n,contact_duration_error,max_compression_error,exit_speed_error,"
      "max_force_error,samples\n";
  for (const Comparison& c : comparisons)
    for (const Motion& m : c.motions)
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", c.material().name, c.mass_kg,
                         c.material().loss_s_per_m, c.speed, c.is_in_range() ? 1 : 0, m.model, m.sample_rate_hz,
                         m.impact.contact_duration_s, m.impact.max_compression_m, m.impact.exit_speed_m_per_s,
                         m.impact.max_force_n, c.error(m, kDuration), c.error(m, kCompression),
                         c.error(m, kExitSpeed), c.error(m, kForce), c.samples(m));
  return csv;
}

std::vector<ImpactMoment> trace_of(const Comparison& c, const Motion& motion, const std::string& argument) {
  if (motion.model == "exact") return exact_motion(c.material(), c.mass_kg, c.speed);
  if (motion.model == "spline") return spline_motion(*c.design, c.mass_kg, c.speed);
  return simulated_motion(*c.design, c.mass_kg, c.speed, motion.sample_rate_hz, argument);
}

// The rows of --trace for one impact.
std::string trace_of(const Comparison& c, const std::string& argument) {
  std::string rows;
  for (const Motion& motion : c.motions)
    for (const auto& [time_s, compression_m, force_n] : trace_of(c, motion, argument))
      rows += fmt::format("{},{},{},{},{},{},{}\n", c.material().name, c.speed, motion.model, motion.sample_rate_hz,
                          time_s, compression_m, force_n);
  return rows;
}

std::string json_of(const Comparison& c, const Motion& m) {
  return fmt::format(
      "      {{\"model\": \"{}\", \"sample_rate_hz\": {}, \"contact_duration_s\": {}, \"max_compression_m\": {}, "
      "\"exit_speed_m_per_s\": {}, \"max_force_n\": {},\n       \"contact_duration_error\": {}, "
      "\"max_compression_error\": {}, \"exit_speed_error\": {}, \"max_force_error\": {}, \"samples\": {}}}",
      m.model, m.sample_rate_hz, m.impact.contact_duration_s, m.impact.max_compression_m, m.impact.exit_speed_m_per_s,
      m.impact.max_force_n, c.error(m, kDuration), c.error(m, kCompression), c.error(m, kExitSpeed),
      c.error(m, kForce), c.samples(m));
}

std::string json_of(const std::vector<Comparison>& comparisons) {
  std::vector<std::string> objects;
  for (const Comparison& c : comparisons) {
    std::vector<std::string> motions;
    for (const Motion& motion : c.motions) motions.push_back(json_of(c, motion));
    objects.push_back(fmt::format(
        "  {{\n    \"material\": \"{}\", \"mass_kg\": {}, \"loss_s_per_m\": {}, \"speed_m_per_s\": {}, \"in_range\": "
        "{}, \"segments\": {},\n    \"motions\": [\n{}\n    ]\n  }}",
        c.material().name, c.mass_kg, c.material().loss_s_per_m, c.speed, c.is_in_range(),
        c.design->spline.segments.size(), fmt::join(motions, ",\n")));
  }
  return fmt::format("[\n{}\n]\n", fmt::join(objects, ",\n"));
}

// A motion in the key of a figure.
std::string model_name(const Comparison& c, const Motion& motion) {
  if (motion.model == "spline") return fmt::format("spline, {} segments", c.design->spline.segments.size());
  return motion.sample_rate_hz > 0 ? fmt::format("{} kHz", motion.sample_rate_hz / 1000) : motion.model;
}

// The impacts of one material, for a figure. Among others its name states the mass, which the title does of one.
ImpactSweep sweep_of(const std::vector<Comparison>& comparisons, bool is_single) {
  const Comparison& first = comparisons.front();
  const std::string& name = first.material().name;
  ImpactSweep sweep{is_single ? name : fmt::format("{}, {:.3g} g", name, 1e3 * first.mass_kg), {}, {}, {}};
  for (const Motion& motion : first.motions) {
    sweep.models.push_back(model_name(first, motion));
    sweep.sample_rates_hz.push_back(motion.sample_rate_hz);
  }
  for (const Comparison& c : comparisons) {
    ImpactPoint& point = sweep.points.emplace_back(ImpactPoint{c.speed, {}});
    for (const Motion& motion : c.motions) point.impacts.push_back(motion.impact);
  }
  return sweep;
}

// What the figure is over.
std::string axis_of(const ImpactOptions& options) {
  if (!options.over.empty()) return options.over;
  return !options.speed_range.empty() ? "speed" : options.rates.size() > 1 ? "rate" : "time";
}

// The key of the figure has room for some entries only.
void require_room(const std::vector<ImpactSweep>& sweeps, const std::string& over) {
  constexpr std::size_t kMaxEntries = 12;
  const std::size_t models = sweeps.front().models.size();
  std::size_t entries = over == "speed" ? models + (sweeps.size() > 1 ? sweeps.size() : 0) : 0;
  if (over != "speed")
    for (const ImpactSweep& sweep : sweeps) entries += sweep.points.size() * (over == "time" ? models : 1);
  if (entries > kMaxEntries)
    throw BadInput(fmt::format("--figure: its key has {} entries; allowed: at most {}: fewer materials, or fewer {}",
                               entries, kMaxEntries, over == "rate" ? "--speed" : "--rate"));
}

// Speed and energies from time and force: the simulation's by the momentum that each sample's force takes, exactly;
// the others' by the trapezoidal rule.
ImpactCourse course_of(const Comparison& c, const Motion& motion, const std::string& name,
                       const std::string& argument) {
  ImpactCourse course{name, motion.model == "exact", {}, {}, {}, {}, {}};
  const bool is_simulated = motion.sample_rate_hz > 0;
  const LawView law = motion.model == "exact" ? law_view(c.material().contact) : law_view(c.design->spline);
  double speed = c.speed, last_time = 0, last_force = 0;
  for (const auto& [time_s, compression_m, force_n] : trace_of(c, motion, argument)) {
    const double lost = is_simulated ? force_n / motion.sample_rate_hz / c.mass_kg
                                     : (time_s - last_time) * (last_force + force_n) / 2 / c.mass_kg;
    const double now = is_simulated ? speed - lost / 2 : speed - lost;  // in the middle of the sample
    course.time_s.push_back(time_s);
    course.force_n.push_back(force_n);
    course.speed_m_per_s.push_back(now);
    course.kinetic_j.push_back(c.mass_kg * now * now / 2);
    if (c.material().memories.empty()) course.stored_j.push_back(law.energy(std::max(0.0, compression_m)));
    speed -= lost;
    last_time = time_s;
    last_force = force_n;
  }
  return course;
}

std::vector<ImpactCourse> courses_of(const std::vector<Comparison>& all, const std::vector<std::string>& arguments) {
  std::vector<ImpactCourse> courses;
  const std::size_t speeds = all.size() / arguments.size();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string which =
        all.size() == 1 ? "" : fmt::format("{}, {:.3g} m/s: ", all[i].material().name, all[i].speed);
    for (const Motion& motion : all[i].motions)
      courses.push_back(course_of(all[i], motion, which + model_name(all[i], motion), arguments[i / speeds]));
  }
  return courses;
}

// The title names one material and its mass, or nothing that the key names.
std::string figure_of(const std::vector<Comparison>& all, const std::vector<ImpactSweep>& sweeps,
                      const ImpactOptions& options, FigureFormat format) {
  const Comparison& first = all.front();
  const std::string over = axis_of(options);
  const std::string speed = over == "time" && all.size() == 1 ? fmt::format(" at {:g} m/s", first.speed) : "";
  const std::string title =
      sweeps.size() == 1 ? fmt::format("{}: impact{} of {:g} g on a rigid barrier{}", title_of(first.material()),
                                       speed.empty() ? "s" : "", 1e3 * first.mass_kg, speed)
                         : "impacts on a rigid barrier";
  if (over == "time") return figure_over_time(courses_of(all, options.materials), title, format);
  return over == "speed" ? figure_over_speed(sweeps, title, format) : figure_over_rate(sweeps, title, format);
}

// Speeds at equal ratios.
std::vector<double> speeds_between(const std::vector<double>& range) {
  const auto count = static_cast<std::size_t>(range[2]);
  std::vector<double> speeds;
  for (std::size_t i = 0; i + 1 < count; ++i)
    speeds.push_back(range[0] *
                     std::pow(range[1] / range[0], static_cast<double>(i) / static_cast<double>(count - 1)));
  speeds.push_back(range[1]);
  return speeds;
}

void require_consistent(const ImpactOptions& options) {
  if (options.csv && options.json) throw BadInput("--csv: cannot be combined with --json; allowed: one of the two");
  if (!options.figure.empty()) (void)figure_format(options.figure);
  if (!options.over.empty() && options.figure.empty())
    throw BadInput("--over: draws nothing; allowed: with --figure");
  if (options.over == "speed" && options.speed_range.empty())
    throw BadInput("--over: speed needs several speeds; allowed: with --speeds");
  if (options.over == "rate" && (!options.speed_range.empty() || options.rates.size() < 2))
    throw BadInput("--over: rate needs several sample rates; allowed: with two --rate, without --speeds");
  if (!options.trace.empty() && file_ending(options.trace) != ".csv")
    refuse(options.trace, "--trace", "its ending is not that of a table", ".csv");
  if (options.speed_range.empty()) return;
  if (!options.speeds.empty()) throw BadInput("--speeds: cannot be combined with --speed; allowed: one of the two");
  const auto& range = options.speed_range;
  if (!(range[0] >= 1e-6 && range[1] <= 1e3 && range[0] < range[1]))
    throw BadInput("--speeds: these speeds are refused; allowed: MIN below MAX, from 1e-06 to 1000 m/s");
  if (!(range[2] >= 2 && range[2] <= 1000 && range[2] == std::floor(range[2])))
    throw BadInput(fmt::format("--speeds: {} is refused; allowed: a COUNT from 2 to 1000", range[2]));
}

std::vector<double> speeds_of(const ImpactOptions& options, const Impact& impact) {
  if (!options.speed_range.empty()) return speeds_between(options.speed_range);
  return options.speeds.empty() ? std::vector{impact.max_speed_m_per_s} : options.speeds;
}

}  // namespace

void compare_impacts(const ImpactOptions& options) {
  require_consistent(options);
  std::vector<Design> designs;
  designs.reserve(options.materials.size());
  std::vector<Comparison> all;
  std::vector<ImpactSweep> sweeps;
  std::vector<std::filesystem::path> inputs;
  std::string text, trace;
  for (const std::string& argument : options.materials) {
    const Design& design = designs.emplace_back(design_argument(argument));
    const Impact& impact = impact_of(design.material, argument);
    std::vector<Comparison> comparisons;
    for (const double speed : speeds_of(options, impact))
      comparisons.push_back(compare(design, impact.mass_kg, speed, options.rates, argument));
    if (!options.speed_range.empty())
      text += table_of(comparisons);
    else
      for (const Comparison& comparison : comparisons) text += text_of(comparison);
    if (!options.trace.empty())
      for (const Comparison& comparison : comparisons) trace += trace_of(comparison, argument);
    sweeps.push_back(sweep_of(comparisons, options.materials.size() == 1));
    std::ranges::copy(input_files(argument, design.material), std::back_inserter(inputs));
    all.insert(all.end(), comparisons.begin(), comparisons.end());
  }
  if (!options.trace.empty()) require_writable({{options.trace}}, inputs, options.force);
  if (!options.figure.empty()) {
    require_room(sweeps, axis_of(options));
    write_figure(options.figure, FigureKind::kImpacts, inputs, options.force,
                 [&](FigureFormat format) { return figure_of(all, sweeps, options, format); });
    text += fmt::format("\nfigure: {}\n", options.figure);
  }
  if (!options.trace.empty()) {
    write_files({{OutputFile{options.trace, fmt::format("# {}\n{}{}", mark(), kTraceHeader, trace)}}});
    text += fmt::format("{}trace: {}\n", options.figure.empty() ? "\n" : "", options.trace);
  }
  write_stdout(options.json ? json_of(all) : options.csv ? csv_of(all) : text);
}

}  // namespace contactspline
