// SPDX-License-Identifier: MIT
// What an instrument tells its hosts: parameters, events, outputs and presets. Scores, plug-ins, Faust programs,
// tables of docs and tests are all made from these lists.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/step/controls.hpp"

namespace contactspline {

enum class Scale : unsigned char { kLinear, kLogarithmic };

/// When a new value acts.
enum class Acts : unsigned char { kAtOnce, kAtNextNote };

/// Stands for the pressure on keys, of a key or a channel of MIDI, which is no controller.
inline constexpr unsigned char kPressureController = 128;

/// What can be set while an instrument plays. Text: const char*, or std::string where a file gives the name.
template <typename Text>
struct BasicParameter {
  Text name;                     ///< lower-case identifier that ends with the unit: hammer_mass_kg
  Text unit;                     ///< of SI; empty for a number
  ControlRange<double> allowed;  ///< Instrument::set() moves a value into it
  ControlRange<double> slider;   ///< where it is played, within `allowed`
  double initial;                ///< within `allowed`; NaN in the list of a class whose parts decide
  Scale scale = Scale::kLinear;
  Acts acts = Acts::kAtOnce;
  double glide_s = 0;            ///< time constant with which it follows a host; 0: it jumps
  unsigned char controller = 0;  ///< of MIDI, or kPressureController; 0: none
  std::size_t step_samples = 1;  ///< while it moves, a new value is of use after so many samples
};
using Parameter = BasicParameter<const char*>;

/// The value at a part of a slider's way, 0 to 1.
template <typename Text>
[[nodiscard]] double value_at(const BasicParameter<Text>& parameter, double part) {
  const auto& [min, max] = parameter.slider;
  return parameter.scale == Scale::kLogarithmic ? min * std::pow(max / min, part) : min + part * (max - min);
}

enum class EventKind : unsigned char { kStrike, kPluck, kBow };

/// A kind of events: the name of its enumerator, the verb of its function in Instrument, and what its value is.
struct EventKindRow {
  EventKind kind;
  const char *name, *verb, *value;
};

/// All kinds, in the order of EventKind.
inline constexpr EventKindRow kEventKinds[] = {{EventKind::kStrike, "kStrike", "strike", "speed_m_per_s"},
                                               {EventKind::kPluck, "kPluck", "pluck", "force_n"},
                                               {EventKind::kBow, "kBow", "bow", "acceleration_m_per_s2"}};

[[nodiscard]] constexpr const EventKindRow& event_kind(EventKind kind) {
  return kEventKinds[static_cast<std::size_t>(kind)];
}

/// What an instrument is played by: Instrument::strike(number, speed), pluck(number, force) or
/// bow(number, acceleration).
template <typename Text>
struct BasicEvent {
  Text name;  ///< lower-case identifier: strike_hammer
  EventKind kind;
  std::size_t number;     ///< among the events of its kind
  std::size_t parameter;  ///< holds the value; notes multiply it by their velocity
};
using Event = BasicEvent<const char*>;

struct Output {
  const char* name;       ///< lower-case identifier that ends with the unit: bridge_force_n
  const char* unit;       ///< of SI
  double full_scale = 1;  ///< the value that hosts play as 1
};

/// Outputs on the left and on the right; one output if they are equal.
struct Sides {
  std::size_t left, right;

  static constexpr std::string_view kLeft = "left_", kRight = "right_";
};

/// The first outputs whose names begin with `left_` and `right_`, if both are there and have one unit; else this one
/// on both sides.
[[nodiscard]] constexpr Sides sides_of(std::span<const Output> outputs, std::size_t otherwise) {
  const auto beginning = [&](std::string_view side) {
    std::size_t o = 0;
    while (o < outputs.size() && !std::string_view(outputs[o].name).starts_with(side)) ++o;
    return o;
  };
  const Sides sides{beginning(Sides::kLeft), beginning(Sides::kRight)};
  const bool are_there = sides.left < outputs.size() && sides.right < outputs.size();
  if (are_there && std::string_view(outputs[sides.left].unit) == outputs[sides.right].unit) return sides;
  return {otherwise, otherwise};
}

/// A value for each parameter.
struct Preset {
  const char* name;
  std::vector<double> values;
};

/// How a value is shown to people: its name in words, and a unit in which it has few digits.
struct Label {
  std::string text;  ///< hammer mass
  std::string unit;  ///< g
  double factor;     ///< shown value over value: 1000
};

namespace detail {

/// An ending of identifiers, its unit of SI, and how people read it.
struct UnitName {
  std::string_view ending, unit, shown;
  double factor;
};

// A longer ending stands before one that it ends with.
inline constexpr UnitName kUnitNames[] = {
    {"_n_s_per_m", "N s/m", "Ns/m", 1}, {"_n_per_m", "N/m", "N/m", 1}, {"_m_per_s2", "m/s2", "m/s2", 1},
    {"_m_per_s", "m/s", "m/s", 1},      {"_s_per_m", "s/m", "s/m", 1}, {"_per_s", "1/s", "1/s", 1},
    {"_cents", "cents", "cents", 1},    {"_hz", "Hz", "Hz", 1},        {"_pa", "Pa", "Pa", 1},
    {"_kg", "kg", "g", 1000},           {"_n", "N", "N", 1},           {"_m", "m", "mm", 1000}};

}  // namespace detail

/// The unit of SI that an identifier ends with; empty where it has none.
[[nodiscard]] constexpr std::string_view unit_of(std::string_view name) {
  for (const detail::UnitName& unit : detail::kUnitNames)
    if (name.ends_with(unit.ending)) return unit.unit;
  return {};
}

/// How people read a parameter or an output.
[[nodiscard]] inline Label label_of(std::string_view name) {
  Label label{std::string(name), {}, 1};
  for (const detail::UnitName& unit : detail::kUnitNames)
    if (name.ends_with(unit.ending)) {
      label = {std::string(name.substr(0, name.size() - unit.ending.size())), std::string(unit.shown), unit.factor};
      break;
    }
  for (char& c : label.text)
    if (c == '_') c = ' ';
  return label;
}

}  // namespace contactspline
