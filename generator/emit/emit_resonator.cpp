// SPDX-License-Identifier: MIT
#include "generator/emit/emit_resonator.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "contactspline/step/version.hpp"
#include "generator/emit/mode_columns.hpp"
#include "generator/material/material.hpp"
#include "generator/support/number_literal.hpp"
#include "generator/support/text_template.hpp"

namespace contactspline {
namespace {

using ResonatorColumn = ModeColumn<ResonatorMode>;
constexpr std::array kColumns = {
    ResonatorColumn{"ANGULAR_FREQUENCIES", [](const ResonatorMode& m) { return m.mode.angular_frequency_rad_per_s; }},
    ResonatorColumn{"DECAYS", [](const ResonatorMode& m) { return m.mode.decay_per_s; }},
    ResonatorColumn{"MASSES", [](const ResonatorMode& m) { return m.mode.mass_kg; }},
    ResonatorColumn{"WAVENUMBERS", [](const ResonatorMode& m) { return m.wavenumber_per_m; }},
    ResonatorColumn{"STRIKE_SHAPES", [](const ResonatorMode& m) { return m.strike_shape; }},
    ResonatorColumn{"PICKUP_SHAPES", [](const ResonatorMode& m) { return m.pickup_shape; }}};

std::size_t strings_of(const Resonator& resonator) {
  const auto* strings = std::get_if<StiffString>(&resonator.body);
  return strings == nullptr ? 1 : strings->detuning_cents.size();
}

// The three constants of a mode share a rule.
std::string all_faust_rules(const std::vector<ResonatorMode>& modes) {
  const auto column = [&](std::size_t i) { return numbers_of(kColumns[i], modes); };
  return faust_rules("constants_of", {column(0), column(1), column(2)}) + faust_rules("wavenumber_of", {column(3)}) +
         faust_rules("strike_shape_of", {column(4)}) + faust_rules("pickup_shape_of", {column(5)});
}

TemplateValues resonator_values(const Emitter& emitter, const std::vector<ResonatorMode>& modes) {
  TemplateValues values;
  if (emitter.name == "faust") {
    values["RULES"] = all_faust_rules(modes);
  } else {
    for (const ResonatorColumn& column : kColumns)
      values.emplace(column.key, literal_rows(numbers_of(column, modes), 4));
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
