// SPDX-License-Identifier: MIT
#include "generator/emit/emit_resonator.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "contactspline/step/version.hpp"
#include "generator/material/material.hpp"
#include "generator/support/number_literal.hpp"
#include "generator/support/text_template.hpp"

namespace contactspline {
namespace {

// The digits on which sin() and sqrt() of all machines agree.
double thirteen_digits(double value) {
  return rounded_to(value, 13);
}

std::vector<double> column(const std::vector<ResonatorMode>& modes, double (*member)(const ResonatorMode&)) {
  std::vector<double> values;
  for (const auto& mode : modes) values.push_back(thirteen_digits(member(mode)));
  return values;
}

/// A key of the templates and the member of a mode for it.
struct ModeColumn {
  std::string_view key;
  double (*member)(const ResonatorMode&);
};

constexpr std::array kModeColumns = {
    ModeColumn{"ANGULAR_FREQUENCIES", [](const ResonatorMode& m) { return m.mode.angular_frequency_rad_per_s; }},
    ModeColumn{"DECAYS", [](const ResonatorMode& m) { return m.mode.decay_per_s; }},
    ModeColumn{"MASSES", [](const ResonatorMode& m) { return m.mode.mass_kg; }},
    ModeColumn{"WAVENUMBERS", [](const ResonatorMode& m) { return m.wavenumber_per_m; }},
    ModeColumn{"STRIKE_SHAPES", [](const ResonatorMode& m) { return m.strike_shape; }},
    ModeColumn{"PICKUP_SHAPES", [](const ResonatorMode& m) { return m.pickup_shape; }}};

std::size_t strings_of(const Resonator& resonator) {
  const auto* strings = std::get_if<StiffString>(&resonator.body);
  return strings == nullptr ? 1 : strings->detuning_cents.size();
}

// The Faust compiler looks up pattern-matching rules much faster than list entries, and few rules faster than many;
// so the three constants of a mode share one rule.
std::string faust_rules(const std::vector<ResonatorMode>& modes) {
  std::string constants, wavenumbers, strikes, pickups;
  const auto number = [](double value) { return literal(thirteen_digits(value)); };
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const auto& [mode, wavenumber, strike, pickup] = modes[i];
    constants += fmt::format("constants_of({}) = {}, {}, {};\n", i, number(mode.angular_frequency_rad_per_s),
                             number(mode.decay_per_s), number(mode.mass_kg));
    wavenumbers += fmt::format("wavenumber_of({}) = {};\n", i, number(wavenumber));
    strikes += fmt::format("strike_shape_of({}) = {};\n", i, number(strike));
    pickups += fmt::format("pickup_shape_of({}) = {};\n", i, number(pickup));
  }
  return constants + wavenumbers + strikes + pickups;
}

TemplateValues resonator_values(const Emitter& emitter, const std::vector<ResonatorMode>& modes) {
  TemplateValues values;
  if (emitter.name == "faust") {
    values["RULES"] = faust_rules(modes);
  } else {
    for (const auto& [key, member] : kModeColumns) values.emplace(key, literal_rows(column(modes, member), 4));
  }
  if (emitter.name != "json") values["MODES"] = fmt::format("{}", modes.size());
  if (emitter.name == "cpp") values["FORMAT_VERSION"] = fmt::format("{}", kFormatVersion);
  return values;
}

}  // namespace

std::string emit(const Emitter& emitter, const Resonator& resonator, double max_frequency_hz,
                 std::string_view command) {
  TemplateValues values = resonator_values(emitter, modes_of(resonator, max_frequency_hz).modes);
  values["VERSION"] = CONTACTSPLINE_VERSION;
  values["COMMAND"] = command;
  values["NAME"] = resonator.name;
  values["TITLE"] = title_of(resonator);
  values["MAX_FREQUENCY"] = literal(max_frequency_hz);
  values["STRINGS"] = fmt::format("{}", strings_of(resonator));
  if (emitter.name == "cpp") values["STRIKE_POSITION"] = literal(resonator.strike.position_m);
  return fill_template(emitted_template("resonator", emitter.extension), values);
}

}  // namespace contactspline
