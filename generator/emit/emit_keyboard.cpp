// SPDX-License-Identifier: MIT
#include "generator/emit/emit_keyboard.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <bit>
#include <vector>

#include "contactspline/step/version.hpp"
#include "generator/emit/mode_columns.hpp"
#include "generator/spline/design.hpp"
#include "generator/support/number_literal.hpp"
#include "generator/support/text_template.hpp"

namespace contactspline {
namespace {

std::vector<KeyboardNote> all_notes(const Keyboard& keyboard) {
  std::vector<KeyboardNote> notes;
  for (int key = keyboard.first_key; key <= keyboard.last_key; ++key) notes.push_back(note_of(keyboard, key));
  return notes;
}

template <typename NumberOf>
std::string column(const std::vector<KeyboardNote>& notes, NumberOf number_of) {
  std::vector<double> values;
  for (const KeyboardNote& note : notes) values.push_back(number_of(note));
  return literal_rows(values, 4);
}

void add_strings(TemplateValues& values, const std::vector<KeyboardNote>& notes) {
  values["LENGTHS"] = column(notes, [](const KeyboardNote& n) { return n.string.length_m; });
  values["MASSES"] = column(notes, [](const KeyboardNote& n) { return n.string.mass_kg; });
  values["TENSIONS"] = column(notes, [](const KeyboardNote& n) { return n.string.tension_n; });
  values["BENDING_STIFFNESSES"] =
      column(notes, [](const KeyboardNote& n) { return n.string.bending_stiffness_n_m2; });
  values["CONSTANT_LOSSES"] = column(notes, [](const KeyboardNote& n) { return n.string.losses.constant_per_s; });
  values["QUADRATIC_LOSSES"] =
      column(notes, [](const KeyboardNote& n) { return n.string.losses.quadratic_m2_per_s; });
  values["STRIKE_POSITIONS"] = column(notes, [](const KeyboardNote& n) { return n.strike_position_m; });
  values["HAMMER_MASSES"] = column(notes, [](const KeyboardNote& n) { return n.hammer_mass_kg; });
  values["OUTPUT_RATIOS"] = column(notes, [](const KeyboardNote& n) { return n.output_ratio; });
}

// Whole numbers, as Faust and C++ read them.
template <typename Number>
std::string whole_numbers(const std::vector<KeyboardNote>& notes, Number KeyboardNote::*member) {
  std::vector<Number> numbers;
  for (const KeyboardNote& note : notes) numbers.push_back(note.*member);
  return fmt::format("    {}", fmt::join(numbers, ", "));
}

void add_felts(TemplateValues& values, const Keyboard& keyboard, const std::vector<KeyboardNote>& notes) {
  std::vector<double> knots, energies, forces, half_curvatures;
  for (KeyboardNote note : notes)
    for (const Segment<double>& segment : segment_table(design_spline(note.felt, keyboard.name))) {
      knots.push_back(segment.knot);
      energies.push_back(segment.energy);
      forces.push_back(segment.force);
      half_curvatures.push_back(segment.half_curvature);
    }
  values["KNOTS"] = literal_rows(knots, 4);
  values["ENERGIES"] = literal_rows(energies, 4);
  values["FORCES"] = literal_rows(forces, 4);
  values["HALF_CURVATURES"] = literal_rows(half_curvatures, 4);
}

std::string in_one_row(const std::vector<double>& values) {
  std::vector<std::string> literals;
  for (const double value : values) literals.push_back(literal(value));
  return fmt::format("{}", fmt::join(literals, ", "));
}

using BodyColumn = ModeColumn<BodyMode>;
constexpr std::array kBodyColumns = {
    BodyColumn{"ANGULAR_FREQUENCIES", [](const BodyMode& m) { return m.mode.angular_frequency_rad_per_s; }},
    BodyColumn{"DECAYS", [](const BodyMode& m) { return m.mode.decay_per_s; }},
    BodyColumn{"MASSES", [](const BodyMode& m) { return m.mode.mass_kg; }},
    BodyColumn{"LEFT_SHAPES", [](const BodyMode& m) { return m.left_shape; }},
    BodyColumn{"RIGHT_SHAPES", [](const BodyMode& m) { return m.right_shape; }},
    BodyColumn{"KNOCK_SHAPES", [](const BodyMode& m) { return m.knock_shape; }}};

// Place after place, in the digits of numbers_of().
std::vector<double> bridge_numbers(const std::vector<BodyMode>& modes) {
  std::vector<double> numbers = bridge_shapes_of(modes);
  for (double& number : numbers) number = rounded_to(number, 13);
  return numbers;
}

// The three constants of a mode share a rule. In Faust keys do not knock.
std::string all_faust_rules(const std::vector<BodyMode>& modes) {
  const auto column = [&](std::size_t i) { return numbers_of(kBodyColumns[i], modes); };
  return faust_rules("body_constants", {column(0), column(1), column(2)}) +
         faust_rules("body_bridge_shape", {bridge_numbers(modes)}) + faust_rules("body_left_shape", {column(3)}) +
         faust_rules("body_right_shape", {column(4)});
}

// What all templates have of a keyboard's body.
TemplateValues body_values(const KeyboardBody& body) {
  return {{"DOUBLE_HZ", in_one_row(body.double_hz)},
          {"TRIPLE_HZ", in_one_row(body.triple_hz)},
          {"UNA_CORDA", literal(body.una_corda_stiffness_ratio)},
          {"PICKUP_RATIO", literal(body.listening.pickup_ratio)},
          {"MOBILITY", literal(body.listening.mobility_m_per_n_s)},
          {"OUTPUT_ABOVE", literal(body.listening.above_hz)},
          {"OUTPUT_QUALITY", literal(rounded_to(body.listening.quality, 13))}};
}

// The part of Faust's template. Without a body the strings are in tune, and no mode follows. All strings drive the
// body where it is struck.
std::string faust_body_text(const Keyboard& keyboard, const std::optional<Resonator>& body, double max_frequency_hz) {
  const auto modes = body_modes({body, {}}, max_frequency_hz);
  TemplateValues values = body_values(keyboard.body.value_or(KeyboardBody{"", {0, 0}, {0, 0, 0}, 1, {}}));
  values["BODY_TITLE"] = body ? title_of(*body) : "of which this keyboard has none";
  values["MODES"] = fmt::format("{}", modes.size());
  values["RULES"] = all_faust_rules(modes);
  return fill_template(emitted_template("keyboard_body", "lib"), values);
}

// What is added for ears in the room.
std::string pressure_text(const Emitter& emitter, const std::vector<BodyArrays::Ear>& ears, double sample_rate_hz) {
  if (ears.empty()) return "";
  TemplateValues values{{"RATE", literal(sample_rate_hz)}};
  for (std::size_t e = 0; e < ears.size(); ++e) {
    const std::string name = e == 0 ? "LEFT" : "RIGHT";
    values[name + "_OF_VELOCITY"] = literal_rows(ears[e].of_velocity, 4);
    values[name + "_OF_DISPLACEMENT"] = literal_rows(ears[e].of_displacement, 4);
    values[name + "_TAPS"] = literal_rows(ears[e].taps, 4);
    if (emitter.name == "cpp") values[name + "_COUNT"] = fmt::format("{}", ears[e].taps.size());
  }
  return fill_template(emitted_template("keyboard_pressure", emitter.extension), values);
}

// What is added for strings that move along themselves.
std::string longitudinal_text(const Emitter& emitter, const KeyboardBody& body) {
  if (!body.longitudinal) return "";
  const auto& [frequency_ratio, losses, output_ratio, last_key] = *body.longitudinal;
  return fill_template(emitted_template("keyboard_longitudinal", emitter.extension),
                       {{"FREQUENCY_RATIO", literal(frequency_ratio)},
                        {"CONSTANT_LOSS", literal(losses.constant_per_s)},
                        {"QUADRATIC_LOSS", literal(losses.quadratic_m2_per_s)},
                        {"OUTPUT_RATIO", literal(output_ratio)},
                        {"LAST_KEY", fmt::format("{}", last_key)}});
}

// The part of the other templates for keyboards with a body.
std::string body_text(const Emitter& emitter, const KeyboardBody& body, const KeyboardResonators& resonators,
                      double max_frequency_hz) {
  const std::vector<BodyMode> modes = body_modes(resonators, max_frequency_hz);
  TemplateValues values = body_values(body);
  values["PRESSURE"] =
      pressure_text(emitter, radiation_at_ears(resonators, modes, 2 * max_frequency_hz), 2 * max_frequency_hz);
  values["LONGITUDINAL"] = longitudinal_text(emitter, body);
  values["HORIZONTAL_STRIKE"] = literal(body.horizontal.strike_ratio);
  values["HORIZONTAL_BRIDGE"] = literal(body.horizontal.bridge_ratio);
  values["HORIZONTAL_CENTS"] = literal(body.horizontal.cents);
  for (const BodyColumn& column : kBodyColumns)
    values.emplace(column.key, literal_rows(numbers_of(column, modes), 4));
  values["BRIDGE_SHAPES"] = literal_rows(bridge_numbers(modes), 4);
  if (emitter.name == "cpp") {
    values["MODES"] = fmt::format("{}", modes.size());
    values["PLACES"] = fmt::format("{}", modes.empty() ? 1 : modes.front().bridge_shapes.size());
  }
  return fill_template(emitted_template("keyboard_body", emitter.extension), values);
}

}  // namespace

std::string emit(const Emitter& emitter, const Keyboard& keyboard, const KeyboardResonators& resonators,
                 double max_frequency_hz, std::string_view command) {
  const auto notes = all_notes(keyboard);
  TemplateValues values{{"VERSION", CONTACTSPLINE_VERSION},
                        {"COMMAND", std::string(command)},
                        {"NAME", keyboard.name},
                        {"TITLE", title_of(keyboard)},
                        {"FIRST_KEY", fmt::format("{}", keyboard.first_key)},
                        {"LAST_KEY", fmt::format("{}", keyboard.last_key)},
                        {"LAST_DAMPED_KEY", fmt::format("{}", keyboard.last_damped_key)},
                        {"CONCERT_PITCH", literal(keyboard.concert_pitch_hz)},
                        {"MIN_SPEED", literal(keyboard.min_speed_m_per_s)},
                        {"MAX_SPEED", literal(keyboard.max_speed_m_per_s)},
                        {"FELT_LOSS", literal(keyboard.felt_loss_s_per_m)},
                        {"DAMPER", literal(keyboard.damper_per_s)},
                        {"DAMPER_TIME", literal(keyboard.damper_time_s)},
                        {"SEGMENTS", fmt::format("{}", keyboard.segments)}};
  if (emitter.name != "faust") {  // where strings end at rest
    values["BRIDGE_LOSSES"] = column(notes, [](const KeyboardNote& n) { return n.bridge_loss_per_s; });
    values["BRIDGE_RATIOS"] = column(notes, [](const KeyboardNote& n) { return n.bridge_ratio; });
    values["HORIZONTAL_RATIOS"] = column(notes, [](const KeyboardNote& n) { return n.horizontal_ratio; });
    values["BRIDGE_PLACES"] = whole_numbers(notes, &KeyboardNote::bridge_place);
  }
  if (emitter.name != "json") values["KEYS"] = fmt::format("{}", notes.size());
  if (emitter.name == "cpp") values["FORMAT_VERSION"] = fmt::format("{}", kFormatVersion);
  if (emitter.name == "faust")
    values["PROBES"] = fmt::format("{}", std::bit_width(static_cast<unsigned>(keyboard.segments)));
  values["STRINGS"] = whole_numbers(notes, &KeyboardNote::strings);
  add_strings(values, notes);
  add_felts(values, keyboard, notes);
  if (emitter.name == "faust")
    values["BODY"] = faust_body_text(keyboard, resonators.body, max_frequency_hz);
  else
    values["BODY"] = resonators.body ? body_text(emitter, *keyboard.body, resonators, max_frequency_hz) : "";
  return fill_template(emitted_template("keyboard", emitter.extension), values);
}

}  // namespace contactspline
