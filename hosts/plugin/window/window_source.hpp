// SPDX-License-Identifier: MIT
// What a window shows: the table of an instrument, its values, and what its contacts do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "contactspline/instrument/instrument.hpp"
#include "host_values.hpp"
#include "tuning_parameters.hpp"
#include "window/contact_ring.hpp"
#include "window/held_keys.hpp"

namespace contactspline {

/// A parameter in the unit for people.
struct WindowParameter {
  std::string name, unit;
  double initial;
  HostScale scale;
  std::vector<std::string> entries = {};  ///< of a list, whose values count them
  double step = 0;                        ///< between values that the mouse moves it to; 0: to any

  [[nodiscard]] static WindowParameter of(const Parameter& parameter) {
    const auto& [name, unit, factor] = label_of(parameter.name);
    const auto& [min, max] = parameter.slider;
    return {
        name, unit, factor * parameter.initial, {factor * min, factor * max, parameter.scale == Scale::kLogarithmic}};
  }
};

struct WindowPreset {
  std::string name;
  std::vector<double> values;  ///< of the first parameters, in their units
};

struct WindowKey {
  int number;         ///< of MIDI
  std::string event;  ///< that it plays, in words; empty where the instrument has none
};

struct WindowTable {
  std::string title, description;
  std::vector<WindowParameter> parameters = {};
  std::vector<WindowParameter> tuning = {};  ///< parameters, too: the host counts them behind the others
  std::vector<WindowPreset> presets = {};
  std::vector<WindowKey> keys = {};  ///< of a piano's 88 those that play
  std::string motion, motion_unit;   ///< name and unit of ContactSample::motion
  double motion_full_scale = 1;      ///< in the unit
  bool has_buttons = false;          ///< does each key play an event of its own?
};

/// The parameters that tune a plug-in.
[[nodiscard]] inline std::vector<WindowParameter> window_tuning() {
  std::vector<WindowParameter> tuning;
  for (std::uint32_t number = 0; number < kTuningParameters.size(); ++number) {
    const auto& [name, symbol, unit, min, max, initial] = kTuningParameters[number];
    tuning.push_back({name, unit, initial, {min, max, false}, tuning_entries(number), 1});
  }
  return tuning;
}

/// The table of an instrument. numbers: which of its parameters a window shows; motion: which of its outputs.
template <Instrument I>
[[nodiscard]] WindowTable window_table_of(const I& instrument, const std::vector<std::size_t>& numbers,
                                          std::size_t motion) {
  const auto parameters = instrument.parameters();
  const Output& output = instrument.outputs()[motion];
  const Label label = label_of(output.name);
  WindowTable table{.title = instrument.name(),
                    .description = instrument.description(),
                    .motion = label.text,
                    .motion_unit = label.unit,
                    .motion_full_scale = output.full_scale * label.factor};
  for (const std::size_t p : numbers) table.parameters.push_back(WindowParameter::of(parameters[p]));
  for (const Preset& preset : instrument.presets()) {
    table.presets.push_back({preset.name, {}});
    for (const std::size_t p : numbers)
      table.presets.back().values.push_back(preset.values[p] * label_of(parameters[p].name).factor);
  }
  constexpr int kFirst = 21, kLast = 108;  // of a piano
  for (int key = kFirst; key <= kLast; ++key) {
    if (!has_key(instrument, key)) continue;
    const auto event = event_of(instrument, key);
    table.keys.push_back({key, event ? label_of(instrument.events()[*event].name).text : ""});
  }
  const std::size_t events = instrument.events().size();
  table.has_buttons = events > 1 && table.keys.size() <= events && !table.keys.front().event.empty();
  return table;
}

/// A plug-in as its window sees it. All functions on the thread of the window.
class WindowSource {
 public:
  [[nodiscard]] virtual WindowTable window_table() const = 0;
  /// What a host sees, of the parameters and, behind them, of the tuning.
  [[nodiscard]] virtual double window_value(std::size_t parameter) const = 0;
  [[nodiscard]] virtual double window_rate_hz() const = 0;
  /// While it is watched, the held keys and who tunes are up to date, too.
  [[nodiscard]] virtual ContactRing& ring() = 0;
  [[nodiscard]] virtual const HeldKeys& held_keys() const = 0;
  /// Does MTS-ESP tune?
  [[nodiscard]] virtual bool is_tuned_outside() const = 0;

 protected:
  ~WindowSource() = default;
};

/// What a window asks of its host.
class WindowHost {
 public:
  /// Begins and ends a movement of a parameter.
  virtual void edit(std::size_t parameter, bool is_moving) = 0;
  virtual void set(std::size_t parameter, double value) = 0;
  /// velocity: 0 to 127; 0 lets the key go.
  virtual void play(int key, int velocity) = 0;

 protected:
  ~WindowHost() = default;
};

}  // namespace contactspline
