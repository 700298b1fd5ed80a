// SPDX-License-Identifier: MIT
#include "generator/fit/measurements_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>

#include "generator/fit/data_file.hpp"
#include "generator/fit/models.hpp"
#include "generator/fit/pulse_window.hpp"
#include "generator/fit/struck_reader.hpp"
#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/json_syntax.hpp"

namespace contactspline {
namespace {

// Wide enough for every collision in an instrument, narrow enough to catch a wrong unit.
constexpr Range kRestitution{0.01, 1};
constexpr std::size_t kMaxFiles = 64;
constexpr std::size_t kMinRows = 3;
constexpr Range kSensitivity{1e-3, 1e6};  // mV/N
constexpr Range kLowPass{10, 1e6};
const std::vector<std::string> kPulseKeys{
    "file", "speed_m_per_s", "columns", "skip_lines", "sensitivity_mv_per_n", "low_pass_hz", "low_pass_order"};

// The force of a pulse: measured, or the mass times the acceleration.
std::vector<double> force_of(const DataFile& data, const DataTable& table, double mass_kg) {
  if (table.has(Quantity::kForce) && table.has(Quantity::kAcceleration))
    refuse(data.path, "force", "is there beside an acceleration", "one of the two; the key columns chooses it");
  if (table.has(Quantity::kForce)) return table.at(Quantity::kForce);
  if (!table.has(Quantity::kAcceleration))
    refuse_missing(data, table, Quantity::kForce, "it, nor an acceleration",
                   fmt::format("{}, {}", units_text(Quantity::kForce), units_text(Quantity::kAcceleration)));
  std::vector<double> force = table.at(Quantity::kAcceleration);
  for (double& value : force) value *= mass_kg;
  return force;
}

// Of volts from a sensor, its sensitivity makes newtons.
void take_sensitivity(const JsonObject& entry, const DataFile& data, DataTable& table) {
  constexpr auto kKey = "sensitivity_mv_per_n";
  const bool has_volts = table.has(Quantity::kVoltage);
  if (entry.has(kKey) && !has_volts)
    entry.fail(entry.key(kKey), "stands beside a force that is in newtons already", "a column in V or mV");
  if (!has_volts) return;
  if (table.has(Quantity::kForce)) refuse(data.path, "force", "is there beside a voltage", "one of the two");
  if (!entry.has(kKey))
    refuse(data.path, "force", "is in volts", fmt::format("newtons, or the key {} beside file", kKey));
  std::vector<double> force = table.at(Quantity::kVoltage);
  const double mv_per_n = entry.number(kKey, kSensitivity);
  for (double& value : force) value *= 1e3 / mv_per_n;
  table.columns[Quantity::kForce] = std::move(force);
}

int read_order(const JsonObject& entry) {
  constexpr int kMaxOrder = 8;
  if (!entry.has("low_pass_hz")) entry.fail(entry.key("low_pass_order"), "stands without low_pass_hz", "both");
  return entry.integer("low_pass_order", 1, kMaxOrder);
}

void read_pulse(const JsonObject& entry, std::string_view file, const ReadFile& read, bool is_struck,
                Measurements& measured) {
  const DataFile data = read_data(entry, file, read, measured.files);
  constexpr std::array kWanted = {Quantity::kTime, Quantity::kForce, Quantity::kAcceleration, Quantity::kVoltage};
  DataTable table = read_table(data, kWanted);
  require(data, table, std::array{Quantity::kTime});
  take_sensitivity(entry, data, table);
  Pulse pulse{data.path, table.at(Quantity::kTime), force_of(data, table, measured.mass_kg), {}, is_struck};
  if (entry.has("speed_m_per_s")) pulse.speed_m_per_s = entry.number("speed_m_per_s", kFitSpeed);
  if (entry.has("low_pass_hz")) pulse.low_pass_hz = entry.number("low_pass_hz", kLowPass);
  if (entry.has("low_pass_order")) pulse.low_pass_order = read_order(entry);
  measured.pulses.push_back(contact_window(pulse, table.lines, measured.mass_kg));
}

std::optional<double> value_of(const DataFile& data, const DataTable& table, std::size_t row, Quantity quantity,
                               Range range) {
  if (!table.has(quantity)) return std::nullopt;
  const double value = table.at(quantity)[row];
  if (!(value >= range.min && value <= range.max))
    refuse(
        data.path, fmt::format("line {}", table.lines[row]),
        fmt::format("a {} of {:.6g} in SI units: a wrong unit, or two columns exchanged?", name_of(quantity), value),
        fmt::format("{} to {}", range.min, range.max));
  return value;
}

void read_rows(const JsonObject& entry, std::string_view file, const ReadFile& read, Measurements& measured) {
  const DataFile data = read_data(entry, file, read, measured.files);
  constexpr std::array kWanted = {Quantity::kSpeed, Quantity::kDuration, Quantity::kForce, Quantity::kRestitution};
  const DataTable table = read_table(data, kWanted);
  require(data, table, std::array{Quantity::kSpeed});
  if (table.columns.size() < 2)
    refuse(data.path, "columns", "there is nothing but speeds", "contact durations, largest forces or restitution");
  for (std::size_t i = 0; i < table.lines.size(); ++i)
    measured.rows.push_back({data.path, *value_of(data, table, i, Quantity::kSpeed, kFitSpeed),
                             value_of(data, table, i, Quantity::kDuration, kMeasuredDuration),
                             value_of(data, table, i, Quantity::kForce, kMeasuredForce),
                             value_of(data, table, i, Quantity::kRestitution, kRestitution)});
}

void read_curve(const JsonObject& entry, std::string_view file, const ReadFile& read, Measurements& measured) {
  const DataFile data = read_data(entry, file, read, measured.files);
  constexpr std::array kWanted = {Quantity::kCompression, Quantity::kForce, Quantity::kVoltage};
  DataTable table = read_table(data, kWanted);
  take_sensitivity(entry, data, table);
  require(data, table, std::array{Quantity::kCompression, Quantity::kForce});
  MeasuredForce curve{data.path, {}, {}};
  if (entry.has("impact_speed_m_per_s")) curve.impact_speed_m_per_s = entry.number("impact_speed_m_per_s", kFitSpeed);
  for (std::size_t i = 0; i < table.lines.size(); ++i)
    curve.samples.push_back({table.at(Quantity::kCompression)[i], table.at(Quantity::kForce)[i]});
  curve.samples = checked_curve(std::move(curve.samples), table.lines, data.path, curve.impact_speed_m_per_s);
  measured.curves.push_back(std::move(curve));
}

std::vector<std::string> read_choice(const JsonObject& fit, const char* key, const std::vector<std::string>& known) {
  if (!fit.has(key)) return known;
  const std::string allowed = fmt::format("one or more of {}", fmt::join(known, ", "));
  std::vector<std::string> chosen = fit.texts(key, allowed, known.size());
  for (const std::string& name : chosen)
    if (std::ranges::find(known, name) == known.end())
      fit.fail(key, fmt::format("'{}' is unknown", shown(name)), allowed);
  if (std::set(chosen.begin(), chosen.end()).size() < chosen.size())
    fit.fail(key, "names one of them twice", allowed);
  return chosen;
}

// 0 if it is to be fitted, to levels: a pulse or a table would need it to be known.
double read_mass(const JsonObject& fit) {
  constexpr auto kFit = "fit";
  const std::string allowed = fmt::format("a number from {} to {}, or \"{}\"", kFitMass.min, kFitMass.max, kFit);
  if (!fit.has("mass_kg")) fit.fail("mass_kg", "missing", allowed);
  if (fit.json("mass_kg") != fmt::format("\"{}\"", kFit)) return fit.number("mass_kg", kFitMass);
  if (!fit.has("struck") || fit.has("pulses") || fit.has("tables") || fit.object("struck", kStruckKeys).has("pulses"))
    fit.fail("mass_kg", "can be fitted to a struck resonator and to curves alone",
             fmt::format("a number from {} to {}", kFitMass.min, kFitMass.max));
  return 0;
}

// Stiffness and exponent follow from forces, durations and curves, at two speeds or more.
void require_enough(const JsonObject& fit, const Measurements& measured) {
  if (!measured.pulses.empty() || !measured.curves.empty() || measured.struck) return;
  std::set<double> speeds;
  std::size_t rows = 0;
  for (const ImpactRow& row : measured.rows)
    if (row.duration_s || row.max_force_n) {
      speeds.insert(row.speed_m_per_s);
      ++rows;
    }
  if (rows == 0)
    fit.fail("tables", "tell nothing of the stiffness", "contact durations or largest forces beside the restitution");
  constexpr double kMinRatio = 1.2;
  if (rows < kMinRows || *speeds.rbegin() < kMinRatio * *speeds.begin())
    fit.fail(
        "tables",
        fmt::format("has {} impacts at speeds from {:.4g} to {:.4g} m/s", rows, *speeds.begin(), *speeds.rbegin()),
        fmt::format("{} or more, the fastest at least {} times as fast as the slowest", kMinRows, kMinRatio));
}

}  // namespace

Measurements parse_measurements(std::string_view text, std::string_view file, const ReadFile& read) {
  if (is_something_else(text))
    refuse(file, "file", "is no fit file",
           fmt::format("a JSON file that names the data and the mass, such as {}",
                       R"({ "name": "my_felt", "mass_kg": 0.003, "pulses": [ { "file": "data.csv" } ] })"));
  const JsonObject fit =
      parse_json(text, file, "fit",
                 {"name", "description", "mass_kg", "pulses", "tables", "curves", "struck", "laws", "losses"});
  Measurements measured{read_name(fit, {}), read_description(fit), read_mass(fit), {}, {}, {}, {}, {}, {}};
  measured.laws = read_choice(fit, "laws", names_of_laws());
  const auto allows = [&](const char* law) { return std::ranges::count(measured.laws, law) > 0; };
  if (allows(kLayers) && !allows("power"))
    fit.fail("laws", "layers stand without the power law, with which their fit begins", "power beside layers");
  measured.losses = read_choice(fit, "losses", names_of_losses());
  if (!fit.has("pulses") && !fit.has("tables") && !fit.has("curves") && !fit.has("struck"))
    fit.fail("fit", "has no data", "pulses, tables, curves or struck");
  if (fit.has("pulses"))
    for (const JsonObject& entry : fit.objects("pulses", kPulseKeys, kMaxFiles))
      read_pulse(entry, file, read, false, measured);
  if (fit.has("tables"))
    for (const JsonObject& entry : fit.objects("tables", {"file", "columns", "skip_lines"}, kMaxFiles))
      read_rows(entry, file, read, measured);
  if (fit.has("curves"))
    for (const JsonObject& entry : fit.objects(
             "curves", {"file", "impact_speed_m_per_s", "columns", "skip_lines", "sensitivity_mv_per_n"}, kMaxFiles))
      read_curve(entry, file, read, measured);
  if (fit.has("struck")) {
    const JsonObject object = fit.object("struck", kStruckKeys);
    measured.struck = read_struck(object, read, measured.files);
    if (object.has("pulses"))
      for (const JsonObject& entry : object.objects("pulses", kPulseKeys, kMaxFiles))
        read_pulse(entry, file, read, true, measured);
  }
  if (measured.has_blows()) require_enough_levels(fit, measured);
  require_enough(fit, measured);
  return measured;
}

}  // namespace contactspline
