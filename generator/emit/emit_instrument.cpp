// SPDX-License-Identifier: MIT
#include "generator/emit/emit_instrument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <span>
#include <vector>

#include "contactspline/version.hpp"
#include "generator/emit/emit_instrument_faust.hpp"
#include "generator/material/material.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/number_literal.hpp"
#include "generator/support/text_template.hpp"

namespace contactspline {
namespace {

constexpr std::array kKindNames = {"kContact", "kSpring", "kLink"};  // of ConnectionKind
constexpr std::array kQuantityNames = {"kForce",    "kDamping",   "kStiffnessRatio", "kLoss",
                                       "kGapShift", "kStiffness", "kResistance"};  // of ControlQuantity
constexpr std::array kOutputNames = {"kDisplacement", "kVelocity", "kForce"};      // of OutputQuantity

template <typename Enum, std::size_t N>
const char* name_in(const std::array<const char*, N>& names, Enum value) {
  return names[static_cast<std::size_t>(value)];
}

// Whole numbers, wrapped.
std::string whole_numbers(std::span<const std::size_t> numbers) {
  std::string text;
  std::size_t column = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::string number = fmt::format("{}{}", numbers[i], i + 1 < numbers.size() ? ", " : "");
    const bool wraps = column + number.size() > 70;
    text += (wraps ? "\n        " : "") + number;
    column = (wraps ? 0 : column) + number.size();
  }
  return text;
}

std::string quoted(const std::vector<std::string>& names) {
  std::vector<std::string> quoted;
  for (const std::string& name : names) quoted.push_back(json_string(name));
  return fmt::format("{}", fmt::join(quoted, ", "));
}

// Names, one in a row.
std::string name_rows(const std::vector<std::string>& names) {
  std::string rows;
  for (const std::string& name : names)
    rows += fmt::format("{}\n        {}", rows.empty() ? "" : ",", json_string(name));
  return rows;
}

std::string place_or(std::string_view ground, std::size_t place) {
  return place == kGround ? std::string(ground) : fmt::format("{}", place);
}

// One row for each of `items`, by text_of(item, index).
template <typename Items, typename TextOf>
std::string rows_of(const Items& items, std::string_view indent, TextOf text_of) {
  std::string rows;
  for (std::size_t i = 0; i < items.size(); ++i)
    rows += fmt::format("{}{}{}", i == 0 ? "" : ",\n", indent, text_of(items[i], i));
  return rows;
}

TemplateValues number_values(const InstrumentArrays& arrays, bool json) {
  const int indent = json ? 4 : 8;
  TemplateValues values;
  for (const auto& [key, numbers] : {std::pair("ANGULAR_FREQUENCIES", &arrays.angular_frequencies),
                                     {"DECAYS", &arrays.decays},
                                     {"MASSES", &arrays.masses},
                                     {"SHAPES", &arrays.shapes},
                                     {"KNOTS", &arrays.knots},
                                     {"ENERGIES", &arrays.energies},
                                     {"FORCES", &arrays.forces},
                                     {"HALF_CURVATURES", &arrays.half_curvatures}})
    values[key] = literal_rows(*numbers, indent);
  for (const auto& [key, numbers] : {std::pair("BODY_ENDS", &arrays.body_ends),
                                     {"PLACE_BODIES", &arrays.place_bodies},
                                     {"TABLE_ENDS", &arrays.table_ends}})
    values[key] = whole_numbers(*numbers);
  return values;
}

// The named members of the class.
std::string members_of(const InstrumentModel& model) {
  std::string members;
  for (std::size_t i = 0; i < model.controls.size(); ++i) {
    const ModelControl& control = model.controls[i];
    const auto [min, max] = control.range;
    members += fmt::format(
        "\n  /// {:g} to {:g}, at the beginning {:g}.\n  void set_{}(T value) {{ this->set_control({}, value); }}",
        min, max, control.initial, control.name, i);
  }
  for (std::size_t i = 0; i < model.strikes.size(); ++i)
    members += fmt::format("\n  void strike_{}(T speed_m_per_s) {{ this->strike({}, speed_m_per_s); }}",
                           model.bodies[model.strikes[i]].name, i);
  for (std::size_t i = 0; i < model.outputs.size(); ++i)
    members += fmt::format("\n  [[nodiscard]] T {}() const {{ return this->output({}); }}", model.outputs[i].name, i);
  return members + "\n";
}

std::string cpp_connection(const InstrumentConnection& c) {
  return fmt::format("{{ConnectionKind::{}, {}, {}, {}, {}, {}, {}, {}, {}}}", name_in(kKindNames, c.kind),
                     place_or("kGround", c.first), place_or("kGround", c.second), c.table, literal(c.gap_m),
                     literal(c.weight), literal(c.loss_s_per_m), literal(c.stiffness_n_per_m),
                     literal(c.resistance_n_s_per_m));
}

TemplateValues cpp_values(const InstrumentModel& model, const InstrumentArrays& arrays) {
  constexpr auto kIndent = "        ";
  TemplateValues values = number_values(arrays, false);
  const auto count = [&](const char* key, std::size_t n) { values[key] = fmt::format("{}", n); };
  count("FORMAT_VERSION", kFormatVersion);
  count("MODES", arrays.masses.size());
  count("BODIES", arrays.body_ends.size());
  count("PLACES", arrays.place_bodies.size());
  count("SHAPE_COUNT", arrays.shapes.size());
  count("SEGMENTS", arrays.knots.size());
  count("TABLES", arrays.table_ends.size());
  count("CONNECTIONS", arrays.connections.size());
  count("CONTROLS", arrays.controls.size());
  count("TARGET_COUNT", arrays.targets.size());
  count("STRIKES", arrays.strikes.size());
  count("OUTPUTS", arrays.outputs.size());
  values["MEMBERS"] = members_of(model);
  std::vector<std::string> controls, strikes, outputs;
  for (const ModelControl& control : model.controls) controls.push_back(control.name);
  for (const std::size_t body : model.strikes) strikes.push_back(model.bodies[body].name);
  for (const ModelOutput& output : model.outputs) outputs.push_back(output.name);
  values["CONTROL_NAMES"] = name_rows(controls);
  values["STRIKE_NAMES"] = name_rows(strikes);
  values["OUTPUT_NAMES"] = name_rows(outputs);
  values["TARGETS"] = whole_numbers(arrays.targets);
  values["STRIKE_BODIES"] = whole_numbers(arrays.strikes);
  values["CONNECTION_ROWS"] = rows_of(arrays.connections, kIndent,
                                      [](const InstrumentConnection& c, std::size_t) { return cpp_connection(c); });
  values["CONTROL_ROWS"] = rows_of(arrays.controls, kIndent, [](const InstrumentControl& c, std::size_t) {
    return fmt::format("{{ControlQuantity::{}, {}, {}, {}, {}, {}, {}}}", name_in(kQuantityNames, c.quantity),
                       c.first_target, c.count, literal(c.initial), literal(c.min), literal(c.max),
                       literal(c.release_n));
  });
  values["OUTPUT_ROWS"] = rows_of(arrays.outputs, kIndent, [](const InstrumentOutput& o, std::size_t) {
    return fmt::format("{{OutputQuantity::{}, {}, {}, {}}}", name_in(kOutputNames, o.quantity), o.first_target,
                       o.count, literal(o.full_scale));
  });
  return values;
}

std::string json_connection(const InstrumentConnection& c) {
  std::string row = fmt::format("{{\"kind\": \"{}\", \"first\": {}, \"second\": {}, \"gap_m\": {}", name_of(c.kind),
                                place_or("null", c.first), place_or("null", c.second), literal(c.gap_m));
  if (c.kind == ConnectionKind::kContact)
    row += fmt::format(", \"table\": {}, \"weight\": {}, \"loss_s_per_m\": {}", c.table, literal(c.weight),
                       literal(c.loss_s_per_m));
  if (c.kind == ConnectionKind::kSpring)
    row += fmt::format(", \"stiffness_n_per_m\": {}, \"resistance_n_s_per_m\": {}", literal(c.stiffness_n_per_m),
                       literal(c.resistance_n_s_per_m));
  return row + "}";
}

TemplateValues json_values(const InstrumentModel& model, const InstrumentArrays& arrays) {
  constexpr auto kIndent = "    ";
  TemplateValues values = number_values(arrays, true);
  std::vector<std::string> bodies, materials, strikes;
  for (const InstrumentBody& body : model.bodies) bodies.push_back(body.name);
  for (const ContactTable& table : model.tables) materials.push_back(table.material);
  for (std::size_t i = 0; i < model.strikes.size(); ++i) strikes.push_back(strike_name(model, i));
  values["BODY_NAMES"] = quoted(bodies);
  values["TABLE_NAMES"] = quoted(materials);
  values["STRIKE_ROWS"] = quoted(strikes);
  values["CONNECTION_ROWS"] = rows_of(arrays.connections, kIndent,
                                      [](const InstrumentConnection& c, std::size_t) { return json_connection(c); });
  values["CONTROL_ROWS"] = rows_of(arrays.controls, kIndent, [&](const InstrumentControl& c, std::size_t i) {
    return fmt::format(
        "{{\"name\": \"{}\", \"targets\": [{}], \"initial\": {}, \"min\": {}, \"max\": {}, \"release_n\": {}}}",
        model.controls[i].name, whole_numbers(std::span(arrays.targets).subspan(c.first_target, c.count)),
        literal(c.initial), literal(c.min), literal(c.max), literal(c.release_n));
  });
  values["OUTPUT_ROWS"] = rows_of(arrays.outputs, kIndent, [&](const InstrumentOutput& o, std::size_t i) {
    return fmt::format("{{\"name\": \"{}\", \"targets\": [{}], \"full_scale\": {}}}", model.outputs[i].name,
                       whole_numbers(std::span(arrays.targets).subspan(o.first_target, o.count)),
                       literal(o.full_scale));
  });
  return values;
}

}  // namespace

std::string emit(const Emitter& emitter, const InstrumentModel& model, double max_frequency_hz,
                 std::string_view command) {
  const InstrumentArrays arrays = arrays_of(model, max_frequency_hz);
  TemplateValues values = emitter.name == "cpp"    ? cpp_values(model, arrays)
                          : emitter.name == "json" ? json_values(model, arrays)
                                                   : faust_instrument_values(model, arrays);
  values["VERSION"] = CONTACTSPLINE_VERSION;
  values["COMMAND"] = command;
  values["NAME"] = model.name;
  values["TITLE"] = title_of(model);
  values["MAX_FREQUENCY"] = literal(max_frequency_hz);
  return fill_template(emitted_template("instrument", emitter.extension), values);
}

}  // namespace contactspline
