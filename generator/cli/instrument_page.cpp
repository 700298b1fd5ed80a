// SPDX-License-Identifier: MIT
#include "generator/cli/instrument_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {
namespace {

std::string_view place_name(const InstrumentModel& model, std::size_t place) {
  return place == kGround ? std::string_view("ground") : model.places[place].name;
}

// One number, or the range of several.
std::string range_text(std::vector<double> numbers) {
  const auto [min, max] = std::ranges::minmax(numbers);
  return min == max ? fmt::format("{:.6g}", min) : fmt::format("{:.6g} to {:.6g}", min, max);
}

std::string string_stretch_row(const StretchingString& string) {
  std::string row = fmt::format(", stretches with {:.6g} N", string.axial_stiffness_n);
  const auto hz = [](const Mode& mode) { return mode.angular_frequency_rad_per_s / (2 * std::numbers::pi); };
  if (const std::vector<Mode> modes = longitudinal_modes(string); !modes.empty())
    row += fmt::format(" and {} longitudinal modes from {:.6g} to {:.6g} Hz", modes.size(), hz(modes.front()),
                       hz(modes.back()));
  return row;
}

// A string by its axial stiffness, a membrane by that of its form, a plate by its Airy functions and what they leave
// out.
std::string stretch_row(const InstrumentBody& body, std::size_t modes) {
  if (body.axial_stiffness_n > 0) return string_stretch_row(body.as_stretching_string());
  if (body.airy_functions == 0)
    return body.stretches() ? fmt::format(", stretches with {:.6g} J", body.stretch_j) : "";
  const std::size_t lowest = std::min<std::size_t>(10, modes);
  std::size_t count = body.airy_functions;
  double kept = 0;
  if (const auto* plate = std::get_if<Plate>(&body.resonator.body)) {
    kept = kept_of_stretching(*plate, body.edges, lowest, count);
    count = form_count(*plate, body.edges, modes, count);
  } else {
    const auto& round = std::get<RoundPlate>(body.resonator.body);
    count = form_count(round, count);
    kept = kept_of_stretching(round, lowest, count);
  }
  return fmt::format(
      ", stretches by {} Airy functions, which hold {:.3g} % or more of the energy of each of its {} "
      "lowest modes",
      count, 100 * kept, lowest);
}

std::string body_row(const InstrumentBody& body, double sample_rate_hz) {
  if (body.is_mass)
    return fmt::format("{:.6g} kg", std::get<ModeTable>(body.resonator.body).rows.front().mode.mass_kg);
  const auto modes = modes_of(body.resonator, sample_rate_hz / 2).modes;
  if (modes.empty()) return "no mode";
  const auto hz = [](const ResonatorMode& mode) {
    return mode.mode.angular_frequency_rad_per_s / (2 * std::numbers::pi);
  };
  return fmt::format("{} modes from {:.6g} to {:.6g} Hz{}", modes.size(), hz(modes.front()), hz(modes.back()),
                     stretch_row(body, modes.size()));
}

// Of the diameter or radius on which a point lies, as position_of counts it [rad].
double angle_of(const Place& point) {
  return std::cos(point.angle_rad) < 0 ? point.angle_rad - std::numbers::pi : point.angle_rad;
}

// All points of a place lie on a line: across_m and the angle are the same for all of them.
std::string place_row(const decltype(Resonator::body)& body, const InstrumentPlace& place) {
  if (!place.shapes.empty()) return "given by shapes";
  if (const double radius = place.points.front().mean_radius_m; radius > 0)
    return fmt::format("mean over the disc of {:.6g} m about the middle", radius);
  std::vector<double> positions;
  for (const Place& point : place.points) positions.push_back(position_of(point));
  std::string row = fmt::format("{} m", range_text(positions));
  if (std::holds_alternative<Plate>(body)) row += fmt::format(", {:.6g} m across", place.points.front().across_m);
  if (is_round(body)) row += fmt::format(", {:.6g} rad", angle_of(place.points.front()));
  return positions.size() == 1 ? row : fmt::format("{}, {} points", row, positions.size());
}

std::string friction_row(const InstrumentModel& model, const InstrumentFriction& friction) {
  const auto& [cold, hot] =
      std::pair(friction.material.heat.cold_coefficient, friction.material.heat.hot_coefficient);
  const std::string falls = cold == hot ? "" : fmt::format(", {:g} where hot", hot);
  const std::string pressed =
      friction.pressed_by == kNoConnection ? "" : " and " + model.connections[friction.pressed_by].name;
  return fmt::format(", coefficient {:g}{}, bristles {:g} 1/m, {:g} N{}, {:g} m/s", cold, falls,
                     friction.material.bristles.stiffness_per_m, friction.normal_force_n, pressed,
                     friction.surface_speed_m_per_s);
}

std::string connection_row(const InstrumentModel& model, const ConnectionGroup& group) {
  std::string row =
      fmt::format("{} and {}", place_name(model, group.each.first), place_name(model, group.each.second));
  if (group.gaps_m.size() > 1) row += fmt::format(", {} points", group.gaps_m.size());
  if (group.each.kind == ConnectionKind::kFriction) return row + friction_row(model, group.each.friction);
  row += fmt::format(", gap {} m", range_text(group.gaps_m));
  if (group.each.kind == ConnectionKind::kContact)
    row += fmt::format(", {} times {}", model.tables[group.each.table].material, range_text(group.weights));
  if (const Roughness& rough = group.each.roughness; rough.height_m > 0)
    row += fmt::format(", {} heights of {:g} m over {:g} m, {:g} m/s", rough.is_periodic ? "periodic" : "random",
                       rough.height_m, rough.length_m, group.each.friction.surface_speed_m_per_s);
  if (group.each.kind == ConnectionKind::kSpring)
    row += fmt::format(", {:.6g} N/m, {:.6g} N s/m", group.each.stiffness_n_per_m, group.each.resistance_n_s_per_m);
  return row;
}

std::string key_row(const InstrumentModel& model, const KeyRange& range) {
  const std::string& event = model.events[range.event].name;
  if (range.tuned_key < 0) return event;
  std::vector<std::string_view> bodies;
  for (const std::vector<std::size_t>& tuned : model.keys.tuned)
    if (tuned.front() == range.string)
      for (const std::size_t body : tuned) bodies.push_back(model.bodies[body].name);
  return fmt::format("{}, tuned{}{}: {} has the pitch of the file{}", event, bodies.empty() ? "" : " on ",
                     fmt::join(bodies, ", "), range.tuned_key,
                     range.per_octave == 1 ? "" : fmt::format(", {:g} times as strong per octave", range.per_octave));
}

std::string damper_row(const InstrumentModel& model) {
  std::vector<std::string_view> bodies;
  for (const std::size_t body : model.keys.damped) bodies.push_back(model.bodies[body].name);
  return fmt::format("{:g} 1/s on {}", model.keys.damper_per_s, fmt::join(bodies, ", "));
}

// What differs from the first values.
std::string preset_row(const InstrumentModel& model, const ModelPreset& preset) {
  std::vector<std::string> values;
  for (std::size_t p = 0; p < preset.values.size(); ++p)
    if (preset.values[p] != model.parameters[p].initial)
      values.push_back(fmt::format("{} {:g}", model.parameters[p].name, preset.values[p]));
  return values.empty() ? "all parameters as at the beginning" : fmt::format("{}", fmt::join(values, ", "));
}

// The peak beside full scale, which plug-ins play as 1.
std::string level_row(const ModelOutput& output, const OutputPeak& peak) {
  std::string row = fmt::format("full scale {:.4g}", output.full_scale);
  if (peak.peak == 0) return row;
  const double part = peak.peak / output.full_scale;
  return fmt::format("{}, peak {:.4g} ({}){}", row, peak.peak, peak.event,
                     part > 1 ? fmt::format(": clips at {:.2g} times full scale", part) : "");
}

// The unit of an output, its level and, of a pressure, where it is taken.
std::string output_row(const InstrumentModel& model, const ModelOutput& output, const OutputPeak& peak) {
  std::string unit = fmt::format("{}, {}", unit_of(output.name), level_row(output, peak));
  if (output.quantity != OutputQuantity::kPressure) return unit;
  const InstrumentBody& body = model.bodies[output.targets.front()];
  const auto [nearest_m, farthest_m] = reach_of(body.resonator.body, output.listening);
  return fmt::format(
      "{}; at {:.6g} m from the middle of {}, {:.6g} rad off its normal; {:.6g} to {:.6g} m from its points", unit,
      output.listening.distance_m, body.name, output.listening.angle_rad, nearest_m, farthest_m);
}

}  // namespace

std::string instrument_table(const InstrumentModel& model, double sample_rate_hz,
                             const std::vector<OutputPeak>& peaks) {
  std::string table = fmt::format("{}{}{}\n", model.name, model.description.empty() ? "" : ": ", model.description);
  std::string next_heading;  // is left out where no row follows
  const auto heading = [&](std::string_view text) { next_heading = fmt::format("\n{}\n", text); };
  const auto row = [&](std::string_view name, std::string_view kind, const std::string& text) {
    table += std::exchange(next_heading, "");
    table += fmt::format("  {:<24} {:<9} {}\n", name, kind, text);
  };
  heading(fmt::format("bodies, at {:g} Hz", sample_rate_hz));
  for (const InstrumentBody& body : model.bodies) row(body.name, kind_of(body), body_row(body, sample_rate_hz));
  heading("places");
  for (const InstrumentPlace& place : model.places)
    if (!model.bodies[place.body].is_mass)
      row(place.name, "",
          fmt::format("{}: {}", model.bodies[place.body].name,
                      place_row(model.bodies[place.body].resonator.body, place)));
  heading("connections");
  for (const ConnectionGroup& group : model.connections)
    row(group.name, name_of(group.each.kind), connection_row(model, group));
  heading("parameters");
  for (const ModelParameter& parameter : model.parameters)
    row(parameter.name, "",
        fmt::format("{:g} to {:g}, at the beginning {:g}", parameter.allowed.min, parameter.allowed.max,
                    parameter.initial));
  heading("events");
  for (const ModelEvent& event : model.events)
    row(event.name, event_kind(event.kind).verb, model.parameters[event.parameter].name);
  heading(fmt::format("keys, on {} voices", model.keys.voices));
  for (const KeyRange& range : model.keys.ranges)
    row(range.first == range.last ? fmt::format("{}", range.first) : fmt::format("{} to {}", range.first, range.last),
        "", key_row(model, range));
  if (!model.keys.damped.empty()) row("damper", "", damper_row(model));
  heading("presets");
  for (const ModelPreset& preset : model.presets) row(preset.name, "", preset_row(model, preset));
  heading("outputs");
  for (std::size_t o = 0; o < model.outputs.size(); ++o)
    row(model.outputs[o].name, "", output_row(model, model.outputs[o], peaks.empty() ? OutputPeak() : peaks[o]));
  return table;
}

}  // namespace contactspline
