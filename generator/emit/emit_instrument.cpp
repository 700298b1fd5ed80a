// SPDX-License-Identifier: MIT
#include "generator/emit/emit_instrument.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <span>
#include <vector>

#include "contactspline/step/version.hpp"
#include "generator/emit/emit_instrument_faust.hpp"
#include "generator/material/material.hpp"
#include "generator/support/json_reader.hpp"
#include "generator/support/number_literal.hpp"
#include "generator/support/text_template.hpp"

namespace contactspline {
namespace {

constexpr std::array kKindNames = {"kContact", "kSpring", "kLink", "kFriction"};  // names of ConnectionKind
constexpr std::array kOutputNames = {"kDisplacement", "kVelocity", "kForce", "kPressure",
                                     "kTension"};  // names of OutputQuantity

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
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const ModelParameter& parameter = model.parameters[i];
    members += fmt::format(
        "\n  /// {:g} to {:g}, at the beginning {:g}.\n  void set_{}(T value) {{ this->set({}, double(value)); }}",
        parameter.allowed.min, parameter.allowed.max, parameter.initial, parameter.name, i);
  }
  for (const ModelEvent& event : model.events) {
    const auto& [kind, name, verb, value] = event_kind(event.kind);
    members += fmt::format("\n  void {0}(T {1}) {{ this->{2}({3}, {1}); }}", event.name, value, verb, event.number);
  }
  for (std::size_t i = 0; i < model.outputs.size(); ++i)
    members += fmt::format("\n  [[nodiscard]] T {}() const {{ return this->output({}); }}", model.outputs[i].name, i);
  return members + "\n";
}

std::string cpp_friction(const InstrumentFriction& friction) {
  const auto& [bristles, heat] = friction.material;
  const std::string pressed = friction.pressed_by == kNoConnection ? "" : fmt::format(", {}", friction.pressed_by);
  return fmt::format("{{{{{{{}, {}}}, {{{}, {}, {}, {}, {}, {}}}}}, {}, {}, {}{}}}",
                     literal(bristles.stiffness_per_m), literal(bristles.damping_s_per_m),
                     literal(heat.cold_coefficient), literal(heat.hot_coefficient), literal(heat.softening_k),
                     literal(heat.capacity_j_per_n_k), literal(heat.conduction_w_per_n_k),
                     literal(heat.renewal_w_per_m_k2), literal(friction.width_m), literal(friction.normal_force_n),
                     literal(friction.surface_speed_m_per_s), pressed);
}

std::string cpp_connection(const InstrumentConnection& c) {
  const bool is_friction = c.kind == ConnectionKind::kFriction, is_rough = c.roughness.height_m > 0;
  std::string more;
  if (is_friction) more = ", " + cpp_friction(c.friction);
  if (is_rough) more = fmt::format(", {{{{}}, 1, 0, {}}}", literal(c.friction.surface_speed_m_per_s));
  if (more.empty() && c.moved_m != 0) more = ", {}";
  if (is_rough || c.moved_m != 0) more += ", " + literal(c.moved_m);
  if (is_rough)
    more += fmt::format(", {{{}, {}, {}}}", literal(c.roughness.height_m), literal(c.roughness.length_m),
                        c.roughness.is_periodic);
  return fmt::format("{{ConnectionKind::{}, {}, {}, {}, {}, {}, {}, {}, {}{}}}", name_in(kKindNames, c.kind),
                     place_or("kGround", c.first), place_or("kGround", c.second), c.table, literal(c.gap_m),
                     literal(c.weight), literal(c.loss_s_per_m), literal(c.stiffness_n_per_m),
                     literal(c.resistance_n_s_per_m), more);
}

std::string cpp_parameter(const Parameter& p) {
  const std::string more =
      p.controller == 0 && p.step_samples == 1 ? "" : fmt::format(", {}, {}", int{p.controller}, p.step_samples);
  return fmt::format("{{\"{}\", \"{}\", {{{}, {}}}, {{{}, {}}}, {}, Scale::{}, Acts::{}, {}{}}}", p.name, p.unit,
                     literal(p.allowed.min), literal(p.allowed.max), literal(p.slider.min), literal(p.slider.max),
                     literal(p.initial), p.scale == Scale::kLinear ? "kLinear" : "kLogarithmic",
                     p.acts == Acts::kAtOnce ? "kAtOnce" : "kAtNextNote", literal(p.glide_s), more);
}

// The array of a member of the struct, in lines of its own.
std::string cpp_array(std::string_view type, std::size_t size, std::string_view name, const std::string& values) {
  return fmt::format("    static constexpr std::array<{}, {}> {} = {{{}}};\n", type, size, name, values);
}

std::string cpp_numbers(std::string_view name, const std::vector<double>& numbers) {
  return cpp_array("double", numbers.size(), name, numbers.empty() ? "" : "\n" + literal_rows(numbers, 8));
}

// Where a string without keys stretches, of its far ends alone.
std::string cpp_far_ends(const InstrumentArrays& arrays) {
  if (arrays.stretch_forms.empty() || arrays.far_ends == 0) return "{}";
  return fmt::format("{{{{}}, 1, {{}}, {}, {{}}, 0, kNoParameter, kNoParameter}}", arrays.far_ends);
}

// Adds the arrays of keys to the text. Returns the view of them.
std::string add_cpp_keys(const ModelKeys& keys, const InstrumentArrays& arrays, std::string& text) {
  text += cpp_array("KeyRange", keys.ranges.size(), "key_ranges",
                    "{\n" + rows_of(keys.ranges, "        ", [](const KeyRange& range, std::size_t) {
                      const bool is_even = range.per_octave == 1;
                      const std::string string =
                          range.string == kAllStrings && is_even ? "" : ", " + place_or("kAllStrings", range.string);
                      return fmt::format("{{{}, {}, {}, {}{}{}}}", range.first, range.last, range.event,
                                         range.tuned_key, string, is_even ? "" : ", " + literal(range.per_octave));
                    }) + "}");
  text += cpp_numbers("tension_squares", arrays.tension_squares);
  text += cpp_array("std::size_t", keys.damped.size(), "damped", whole_numbers(keys.damped));
  const auto parameter = [](std::size_t p) { return place_or("kNoParameter", p); };
  if (!arrays.tuned_with.empty())
    text += cpp_array("std::size_t", arrays.tuned_with.size(), "tuned_with", whole_numbers(arrays.tuned_with));
  return fmt::format("{{key_ranges, {}, tension_squares, {}, damped, {}, {}, {}{}}}", keys.voices, arrays.far_ends,
                     literal(keys.damper_per_s), parameter(keys.sustain), parameter(keys.bend),
                     arrays.tuned_with.empty() ? "" : ", tuned_with");
}

// Adds the arrays of listening places to the text and to the view of them.
void add_cpp_pressure(const InstrumentArrays& arrays, std::string& text, std::vector<std::string>& view) {
  if (arrays.pressure_paths.empty()) return;
  text += cpp_array("PressurePath", arrays.pressure_paths.size(), "pressure_paths",
                    "{\n" + rows_of(arrays.pressure_paths, "        ", [](const PressurePath& path, std::size_t) {
                      return fmt::format("{{{}, {}, {}}}", path.output, path.place, path.taps);
                    }) + "}");
  text += cpp_numbers("pressure_taps", arrays.pressure_taps);
  view[6] = literal(arrays.pressure_rate_hz);
  view[7] = "pressure_paths";
  view[8] = "pressure_taps";
}

// What only forms of strings have.
std::string cpp_string_form(const InstrumentForm& form) {
  if (form.end_tension_n == 0) return "";
  return fmt::format(", {{{}, {}}}, {}", form.linear.mode, literal(form.linear.factor_per_m),
                     literal(form.end_tension_n));
}

// Adds the forms of bodies that stretch to the text and to the view of them.
void add_cpp_forms(const InstrumentArrays& arrays, std::string& text, std::vector<std::string>& view) {
  if (arrays.stretch_forms.empty()) return;
  text += cpp_array("InstrumentForm", arrays.stretch_forms.size(), "stretch_forms",
                    "{\n" + rows_of(arrays.stretch_forms, "        ", [](const InstrumentForm& form, std::size_t) {
                      return fmt::format("{{{}, {}, {}{}}}", form.body, literal(form.stiffness_j), form.products,
                                         cpp_string_form(form));
                    }) + "}");
  text += cpp_numbers("stretch_squares", arrays.stretch_squares);
  view[10] = "stretch_forms";
  view[11] = "stretch_squares";
  if (arrays.stretch_products.empty()) return;
  text += cpp_array(
      "StretchForm::Product", arrays.stretch_products.size(), "stretch_products",
      "{\n" + rows_of(arrays.stretch_products, "        ", [](const StretchForm::Product& product, std::size_t) {
        return fmt::format("{{{}, {}, {}}}", product.first, product.second, literal(product.factor_per_m2));
      }) + "}");
  view[12] = "stretch_products";
}

// Adds the bows to the text and to the view of them.
void add_cpp_bows(const InstrumentModel& model, const InstrumentArrays& arrays, std::string& text,
                  std::vector<std::string>& view) {
  if (arrays.bows.empty()) return;
  text += cpp_array("InstrumentBow", arrays.bows.size(), "bows",
                    "{\n" + rows_of(arrays.bows, "        ", [](const InstrumentBow& bow, std::size_t) {
                      return fmt::format("{{{}, {}, {{{}, {}}}}}", bow.first, bow.count,
                                         literal(bow.limits.min_n_s_per_m), literal(bow.limits.max_n_s_per_m));
                    }) + "}");
  view[13] = "bows";
  view[14] = place_or("kNoParameter", model.assistance);
}

// Adds the places of the input to the text and to the view of them.
void add_cpp_input(const InstrumentModel& model, const InstrumentArrays& arrays, std::string& text,
                   std::vector<std::string>& view) {
  if (arrays.input_places.empty()) return;
  text += cpp_array("std::size_t", arrays.input_places.size(), "input_places", whole_numbers(arrays.input_places));
  view[15] = "input_places";
  view[16] = literal(model.input.full_scale_n);
}

// What keys, presets, places that move, memories, listening places, loads at rest, bodies that stretch, bows and the
// input add to the arrays, and to the view of them.
void add_cpp_options(const InstrumentModel& model, const InstrumentArrays& arrays, TemplateValues& values) {
  const ModelKeys& keys = model.keys;
  const bool has_keys = !keys.ranges.empty();
  values["BASE"] = has_keys ? "Voices<NetworkInstrument<T>>" : "NetworkInstrument<T>";
  values["VOICES"] = has_keys ? "\n#include \"contactspline/instrument/voices.hpp\"" : "";
  std::string& text = values["OPTIONS"] = "";
  std::vector<std::string> view(18, "{}");  // the last members of InstrumentData
  view[0] = has_keys ? add_cpp_keys(keys, arrays, text) : cpp_far_ends(arrays);
  if (!arrays.preset_names.empty()) {
    std::vector<std::string> names;
    for (const ModelPreset& preset : model.presets) names.push_back(preset.name);
    text += cpp_array("const char*", names.size(), "preset_names", quoted(names));
    text += cpp_numbers("preset_values", arrays.preset_values);
    view[1] = "preset_names";
    view[2] = "preset_values";
  }
  if (!arrays.wavenumbers.empty()) {
    text += cpp_numbers("wavenumbers", arrays.wavenumbers);
    view[3] = "wavenumbers";
  }
  if (!arrays.memories.empty()) {
    text += cpp_array("Memory", arrays.memories.size(), "memories",
                      "{\n" + rows_of(arrays.memories, "        ", [](const Memory& memory, std::size_t) {
                        return fmt::format("{{{}, {}}}", literal(memory.weight), literal(memory.time_s));
                      }) + "}");
    text += cpp_array("std::size_t", arrays.memory_ends.size(), "memory_ends", whole_numbers(arrays.memory_ends));
    view[4] = "memories";
    view[5] = "memory_ends";
  }
  add_cpp_pressure(arrays, text, view);
  if (!arrays.holds.empty()) {
    text += cpp_array("HoldingForce", arrays.holds.size(), "holds",
                      "{\n" + rows_of(arrays.holds, "        ", [](const HoldingForce& hold, std::size_t) {
                        return fmt::format("{{{}, {}}}", hold.place, literal(hold.force_n));
                      }) + "}");
    view[9] = "holds";
  }
  add_cpp_forms(arrays, text, view);
  add_cpp_bows(model, arrays, text, view);
  add_cpp_input(model, arrays, text, view);
  if (!arrays.offsets_m.empty()) {
    text += cpp_numbers("offsets_m", arrays.offsets_m);
    view[17] = "offsets_m";
  }
  while (!view.empty() && view.back() == "{}") view.pop_back();
  values["OPTIONS_VIEW"] = view.empty() ? "" : fmt::format(",\n              {}", fmt::join(view, ", "));
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
  count("PLUCKS", arrays.plucks.size());
  count("PARAMETERS", arrays.parameters.size());
  count("EVENTS", arrays.events.size());
  add_cpp_options(model, arrays, values);
  values["MEMBERS"] = members_of(model);
  values["DESCRIPTION"] = json_string(model.description);
  values["TARGETS"] = whole_numbers(arrays.targets);
  values["STRIKE_BODIES"] = whole_numbers(arrays.strikes);
  values["PLUCK_CONTROLS"] = whole_numbers(arrays.plucks);
  values["CONNECTION_ROWS"] = rows_of(arrays.connections, kIndent,
                                      [](const InstrumentConnection& c, std::size_t) { return cpp_connection(c); });
  values["CONTROL_ROWS"] = rows_of(arrays.controls, kIndent, [](const InstrumentControl& c, std::size_t) {
    return fmt::format("{{ControlQuantity::{}, {}, {}}}", control_quantity<double>(c.quantity).name, c.first_target,
                       c.count);
  });
  values["SOURCE_ROWS"] = rows_of(arrays.sources, kIndent, [](const InstrumentOutput& o, std::size_t) {
    return fmt::format("{{OutputQuantity::{}, {}, {}{}}}", name_in(kOutputNames, o.quantity), o.first_target, o.count,
                       o.at_rest_n == 0 ? "" : ", " + literal(o.at_rest_n));
  });
  values["PARAMETER_ROWS"] =
      rows_of(arrays.parameters, kIndent, [](const Parameter& p, std::size_t) { return cpp_parameter(p); });
  values["EVENT_ROWS"] = rows_of(arrays.events, kIndent, [](const Event& e, std::size_t) {
    return fmt::format("{{\"{}\", EventKind::{}, {}, {}}}", e.name, event_kind(e.kind).name, e.number, e.parameter);
  });
  values["OUTPUT_ROWS"] = rows_of(arrays.outputs, kIndent, [](const Output& o, std::size_t) {
    return fmt::format("{{\"{}\", \"{}\", {}}}", o.name, o.unit, literal(o.full_scale));
  });
  return values;
}

std::string json_string_form(const InstrumentForm& form) {
  if (form.end_tension_n == 0) return "";
  return fmt::format(", \"linear_mode\": {}, \"linear_per_m\": {}, \"end_tension_n\": {}", form.linear.mode,
                     literal(form.linear.factor_per_m), literal(form.end_tension_n));
}

std::string json_forms(const InstrumentArrays& arrays) {
  return fmt::format(
      ",\n  \"stretch_forms\": [\n{}\n  ],\n  \"stretch_squares_per_m2\": [\n{}\n  ],\n  \"stretch_products\": "
      "[\n{}\n  ]",
      rows_of(arrays.stretch_forms, "    ",
              [](const InstrumentForm& form, std::size_t) {
                return fmt::format("{{\"body\": {}, \"stiffness_j\": {}, \"products\": {}{}}}", form.body,
                                   literal(form.stiffness_j), form.products, json_string_form(form));
              }),
      literal_rows(arrays.stretch_squares, 4),
      rows_of(arrays.stretch_products, "    ", [](const StretchForm::Product& product, std::size_t) {
        return fmt::format("{{\"first\": {}, \"second\": {}, \"factor_per_m2\": {}}}", product.first, product.second,
                           literal(product.factor_per_m2));
      }));
}

// Keys, presets, places that move, bodies that stretch, bows and the input, of a file that has them.
std::string json_options_of(const InstrumentModel& model, const InstrumentArrays& arrays) {
  std::string text;
  if (!model.keys.ranges.empty()) {
    text += fmt::format(
        ",\n  \"keys\": [\n{}\n  ],\n  \"polyphony\": {}",
        rows_of(model.keys.ranges, "    ",
                [&](const KeyRange& range, std::size_t) {
                  const std::string tuned =
                      range.tuned_key < 0 ? "" : fmt::format(", \"tuned_key\": {}", range.tuned_key);
                  const std::string string =
                      range.string == kAllStrings ? "" : fmt::format(", \"string\": {}", range.string);
                  const std::string per_octave =
                      range.per_octave == 1 ? "" : fmt::format(", \"per_octave\": {}", literal(range.per_octave));
                  return fmt::format("{{\"first\": {}, \"last\": {}, \"event\": \"{}\"{}{}{}}}", range.first,
                                     range.last, model.events[range.event].name, tuned, per_octave, string);
                }),
        model.keys.voices);
    if (!arrays.tension_squares.empty())
      text += fmt::format(",\n  \"tension_squares_per_s2\": [\n{}\n  ]", literal_rows(arrays.tension_squares, 4));
    if (!arrays.tuned_with.empty())
      text += fmt::format(",\n  \"tuned_with\": [{}]", whole_numbers(arrays.tuned_with));
    if (!model.keys.damped.empty())
      text += fmt::format(",\n  \"damper\": {{\"bodies\": [{}], \"damping_per_s\": {}}}",
                          whole_numbers(model.keys.damped), literal(model.keys.damper_per_s));
  }
  if (!arrays.wavenumbers.empty())
    text += fmt::format(",\n  \"wavenumber_rad_per_m\": [\n{}\n  ]", literal_rows(arrays.wavenumbers, 4));
  if (!arrays.stretch_forms.empty()) text += json_forms(arrays);
  if (!arrays.bows.empty())
    text += fmt::format(
        ",\n  \"bows\": [\n{}\n  ]", rows_of(arrays.bows, "    ", [](const InstrumentBow& bow, std::size_t) {
          return fmt::format("{{\"first\": {}, \"count\": {}, \"min_n_s_per_m\": {}, \"max_n_s_per_m\": {}}}",
                             bow.first, bow.count, literal(bow.limits.min_n_s_per_m),
                             literal(bow.limits.max_n_s_per_m));
        }));
  if (!arrays.input_places.empty())
    text += fmt::format(",\n  \"input\": {{\"places\": [{}], \"full_scale_n\": {}}}",
                        whole_numbers(arrays.input_places), literal(model.input.full_scale_n));
  if (!arrays.offsets_m.empty())
    text += fmt::format(",\n  \"offsets_m\": [\n{}\n  ]", literal_rows(arrays.offsets_m, 4));
  if (model.presets.empty()) return text;
  return text + fmt::format(",\n  \"presets\": [\n{}\n  ]",
                            rows_of(model.presets, "    ", [&](const ModelPreset& preset, std::size_t) {
                              std::string row = fmt::format("{{\"name\": {}", json_string(preset.name));
                              for (std::size_t p = 0; p < preset.values.size(); ++p)
                                row +=
                                    fmt::format(", \"{}\": {}", model.parameters[p].name, literal(preset.values[p]));
                              return row + "}";
                            }));
}

// What forces do at once to the pressures, of a file that has them.
std::string json_pressures(const InstrumentArrays& arrays) {
  if (arrays.pressure_paths.empty()) return {};
  return fmt::format(
      ",\n  \"pressure_rate_hz\": {},\n  \"pressure_paths\": [\n{}\n  ],\n  \"pressure_taps\": [\n{}\n  ]",
      literal(arrays.pressure_rate_hz),
      rows_of(arrays.pressure_paths, "    ",
              [](const PressurePath& path, std::size_t) {
                return fmt::format("{{\"output\": {}, \"place\": {}, \"taps\": {}}}", path.output, path.place,
                                   path.taps);
              }),
      literal_rows(arrays.pressure_taps, 4));
}

// What holds bodies at rest, of a file that has loads.
std::string json_holds(const InstrumentArrays& arrays) {
  if (arrays.holds.empty()) return {};
  return fmt::format(",\n  \"holds\": [\n{}\n  ]",
                     rows_of(arrays.holds, "    ", [](const HoldingForce& hold, std::size_t) {
                       return fmt::format("{{\"place\": {}, \"force_n\": {}}}", hold.place, literal(hold.force_n));
                     }));
}

// The memories of the tables, one after the other, of a file that has them.
std::string json_memories(const InstrumentArrays& arrays) {
  if (arrays.memories.empty()) return {};
  return fmt::format(",\n  \"memories\": {},\n  \"memory_ends\": [{}]", json_of(arrays.memories),
                     whole_numbers(arrays.memory_ends));
}

std::string json_friction(const InstrumentFriction& friction) {
  const auto& [bristles, heat] = friction.material;
  return fmt::format(
      ", \"stiffness_per_m\": {}, \"damping_s_per_m\": {}, \"cold_coefficient\": {}, \"hot_coefficient\": {}, "
      "\"softening_k\": {}, \"capacity_j_per_n_k\": {}, \"conduction_w_per_n_k\": {}, "
      "\"renewal_w_per_m_k2\": {}, \"width_m\": {}, \"normal_force_n\": {}, \"surface_speed_m_per_s\": {}{}",
      literal(bristles.stiffness_per_m), literal(bristles.damping_s_per_m), literal(heat.cold_coefficient),
      literal(heat.hot_coefficient), literal(heat.softening_k), literal(heat.capacity_j_per_n_k),
      literal(heat.conduction_w_per_n_k), literal(heat.renewal_w_per_m_k2), literal(friction.width_m),
      literal(friction.normal_force_n), literal(friction.surface_speed_m_per_s),
      friction.pressed_by == kNoConnection ? "" : fmt::format(", \"pressed_by\": {}", friction.pressed_by));
}

std::string json_connection(const InstrumentConnection& c) {
  std::string row = fmt::format("{{\"kind\": \"{}\", \"first\": {}, \"second\": {}, \"gap_m\": {}", name_of(c.kind),
                                place_or("null", c.first), place_or("null", c.second), literal(c.gap_m));
  if (c.kind == ConnectionKind::kContact)
    row += fmt::format(", \"table\": {}, \"weight\": {}, \"loss_s_per_m\": {}", c.table, literal(c.weight),
                       literal(c.loss_s_per_m));
  if (c.roughness.height_m > 0)
    row += fmt::format(
        ", \"roughness_height_m\": {}, \"roughness_length_m\": {}, \"roughness_is_periodic\": {}, "
        "\"surface_speed_m_per_s\": {}",
        literal(c.roughness.height_m), literal(c.roughness.length_m), c.roughness.is_periodic,
        literal(c.friction.surface_speed_m_per_s));
  if (c.kind == ConnectionKind::kSpring)
    row += fmt::format(", \"stiffness_n_per_m\": {}, \"resistance_n_s_per_m\": {}", literal(c.stiffness_n_per_m),
                       literal(c.resistance_n_s_per_m));
  if (c.kind == ConnectionKind::kFriction) row += json_friction(c.friction);
  if (c.kind == ConnectionKind::kFriction && c.weight != 1) row += fmt::format(", \"weight\": {}", literal(c.weight));
  return row + "}";
}

TemplateValues json_values(const InstrumentModel& model, const InstrumentArrays& arrays) {
  constexpr auto kIndent = "    ";
  TemplateValues values = number_values(arrays, true);
  std::vector<std::string> bodies, materials, events;
  for (const InstrumentBody& body : model.bodies) bodies.push_back(body.name);
  for (const ContactTable& table : model.tables) materials.push_back(table.material);
  for (const ModelEvent& event : model.events) events.push_back(model.parameters[event.parameter].name);
  values["BODY_NAMES"] = quoted(bodies);
  values["TABLE_NAMES"] = quoted(materials);
  values["EVENT_NAMES"] = quoted(events);
  values["OPTIONS"] =
      json_options_of(model, arrays) + json_memories(arrays) + json_pressures(arrays) + json_holds(arrays);
  values["CONNECTION_ROWS"] = rows_of(arrays.connections, kIndent,
                                      [](const InstrumentConnection& c, std::size_t) { return json_connection(c); });
  values["CONTROL_ROWS"] = rows_of(arrays.controls, kIndent, [&](const InstrumentControl& c, std::size_t i) {
    const Parameter& p = arrays.parameters[i];
    return fmt::format("{{\"name\": \"{}\", \"targets\": [{}], \"initial\": {}, \"min\": {}, \"max\": {}}}", p.name,
                       whole_numbers(std::span(arrays.targets).subspan(c.first_target, c.count)), literal(p.initial),
                       literal(p.allowed.min), literal(p.allowed.max));
  });
  values["OUTPUT_ROWS"] = rows_of(arrays.sources, kIndent, [&](const InstrumentOutput& o, std::size_t i) {
    return fmt::format("{{\"name\": \"{}\", \"targets\": [{}], \"full_scale\": {}{}}}", arrays.outputs[i].name,
                       whole_numbers(std::span(arrays.targets).subspan(o.first_target, o.count)),
                       literal(arrays.outputs[i].full_scale),
                       o.at_rest_n == 0 ? "" : ", \"at_rest_n\": " + literal(o.at_rest_n));
  });
  return values;
}

}  // namespace

std::string emit(const Emitter& emitter, const InstrumentModel& model, double max_frequency_hz,
                 std::string_view command) {
  const bool is_faust = emitter.name == "faust";
  const InstrumentModel played = is_faust ? without_keys(model) : model;
  const InstrumentArrays arrays = arrays_of(played, max_frequency_hz);
  TemplateValues values = is_faust                 ? faust_instrument_values(played, arrays)
                          : emitter.name == "json" ? json_values(model, arrays)
                                                   : cpp_values(model, arrays);
  if (is_faust)
    values["KEYS"] =
        model.keys.ranges.empty() ? "" : "\n// Keys are left out: buttons play it, at the pitch of its file.";
  values["VERSION"] = CONTACTSPLINE_VERSION;
  values["COMMAND"] = command;
  values["NAME"] = model.name;
  // `reuse` would take what stands behind the tag in a template for the template's own licence.
  if (emitter.name != "json") values["SPDX"] = "SPDX-License-Identifier";
  values["LICENSE"] = model.license;
  values["TITLE"] = title_of(model);
  values["MAX_FREQUENCY"] = literal(max_frequency_hz);
  return fill_template(emitted_template("instrument", emitter.extension), values);
}

}  // namespace contactspline
