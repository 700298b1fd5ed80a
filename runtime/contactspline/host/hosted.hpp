// SPDX-License-Identifier: MIT
// An instrument as every host plays it: sliders that glide, buttons, MIDI, presets, outputs at full scale.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "contactspline/data/pluck.hpp"
#include "contactspline/data/timed_event.hpp"
#include "contactspline/host/any_instrument.hpp"
#include "contactspline/host/sleeper.hpp"
#include "contactspline/host/tuned_keys.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/midi/midi_interpreter.hpp"
#include "contactspline/step/flush_denormals.hpp"

namespace contactspline {

/// Plays an instrument for Faust's dsp, for plug-ins and the like. prepare() allocates, all else is safe on an audio
/// thread. An instrument that rests sleeps (sleeper.hpp).
template <std::floating_point T>
class Hosted {
 public:
  explicit Hosted(Handle<T> handle)
      : sleeper_(std::move(handle)), midi_(midi_settings(instrument())), buttons_(instrument().events().size()) {
    targets_.resize(instrument().parameters().size(), std::numeric_limits<double>::quiet_NaN());
    now_.resize(targets_.size());
    rates_.resize(targets_.size());
    outputs_.resize(instrument().outputs().size());
    scratch_.resize(outputs_.size());
  }

  [[nodiscard]] const AnyInstrument<T>& instrument() const { return sleeper_.instrument(); }

  void prepare(double sample_rate_hz) {
    sleeper_.prepare(sample_rate_hz);
    for (std::size_t p = 0; p < rates_.size(); ++p) {
      const double time_s = instrument().parameters()[p].glide_s;
      rates_[p] = time_s > 0 ? -std::expm1(-1 / (time_s * sample_rate_hz)) : 1;
    }
    reset();
  }

  /// Moves a parameter to a value, as fast as it glides. A value that is not a number does nothing.
  void set(std::size_t parameter, double value) {
    if (parameter >= targets_.size() || !is_number(value)) return;
    const Parameter& p = instrument().parameters()[parameter];
    if (!is_set(parameter)) now_[parameter] = instrument().value(parameter);
    targets_[parameter] = held(targets_[parameter], value, p.allowed);
    if (rates_[parameter] < 1 && !is_new_)
      is_gliding_ = true;
    else
      set_now(parameter, targets_[parameter]);
  }
  [[nodiscard]] double target(std::size_t parameter) const {
    return is_set(parameter) ? targets_[parameter] : instrument().value(parameter);
  }

  /// Moves the button of an event: when it goes down, the event is played, when it goes up, a bow is lifted. Without
  /// a key the damper stays up.
  void press(std::size_t event, bool is_down) {
    if (event >= buttons_.size() || buttons_[event] == is_down) return;
    buttons_[event] = is_down;
    const Event& played = instrument().events()[event];
    if (!is_down && played.kind != EventKind::kBow) return;
    const double value = is_down ? target(played.parameter) : 0;
    sleeper_.play({0, action_of(played.kind), played.number, value, kPluckRise_s});
  }

  /// Takes bytes of MIDI, whole messages or pieces of a stream; damaged and unknown messages do nothing. What each
  /// does is listed in midi_meaning.hpp. A controller moves the parameter that has it; bends move the keys that their
  /// channel plays, and bend_cents of an instrument that cannot bend its keys alone.
  void midi(std::span<const std::uint8_t> bytes) {
    midi_.take(bytes, [this](const MidiEvent& event) { take(event); });
  }

  /// Notes of a host that names them, beside MIDI: begins, ends and expresses them as MidiInterpreter says.
  /// `move_note` moves a parameter of them alone, from where it is for all, where the instrument can. express: called
  /// before the note sounds; may express and move it.
  template <typename Express>
  void begin_note(const NoteName& name, double velocity, double cents, const Express& express) {
    midi_.begin(
        name, velocity, cents, [this](const MidiEvent& event) { take(event); }, express);
  }
  void begin_note(const NoteName& name, double velocity, double cents = 0) {
    begin_note(name, velocity, cents, [] {});
  }
  void end_note(const NoteName& name, double velocity, bool is_first_only = false) {
    midi_.end(name, velocity, is_first_only, [this](const MidiEvent& event) { take(event); });
  }
  /// Calls visit(key) for each key of the instrument that plays such a note, or has played it last.
  template <typename Visitor>
  void each_note(const NoteName& name, const Visitor& visit) const {
    midi_.each(name, visit);
  }
  /// Moves a parameter of one key of the instrument alone.
  void move_key(int key, std::size_t parameter, double by) {
    expressed_.set(static_cast<std::size_t>(key));
    sleeper_.play({0, Action::kMoveKey, static_cast<std::size_t>(key), by, 0, parameter});
  }
  void express(const NoteName& name, NoteExpression expression, double value) {
    midi_.express(name, expression, value, [this](const MidiEvent& event) { take(event); });
  }
  void move_note(const NoteName& name, std::size_t parameter, double by) {
    midi_.each(name, [&](int key) { move_key(key, parameter, by); });
  }

  /// Tunes the keys by a table for the notes that begin from now on; tuning messages of MIDI go on from there.
  void tune(const KeyCents& cents) {
    MidiSettings settings = tuned(midi_settings(instrument()), cents);
    settings.bend_range = midi_.settings().bend_range;
    midi_.tune(settings);
  }

  /// Tunes one key for the notes that begin from now on [cents above its own pitch]; not a number: it does not sound.
  void tune_key(int key, double cents) { midi_.tune_key(key, cents); }
  /// How far wheels bend [semitones], until messages say otherwise.
  void set_bend_range(double semitones) {
    midi_.set_bend_range(semitones, [this](const MidiEvent& event) { take(event); });
  }

  /// What is held, and how far it is tuned, as MidiInterpreter has it.
  template <typename Visitor>
  void each_held(Visitor&& visit) const {
    midi_.each_held(visit);
  }

  /// Moves all parameters to those of a preset.
  void load(std::size_t preset) {
    if (preset >= instrument().presets().size()) return;
    const Preset& loaded = instrument().presets()[preset];
    for (std::size_t p = 0; p < loaded.values.size(); ++p) set(p, loaded.values[p]);
  }

  /// Advances a block, also where nobody wants an output. outputs: one array for each output, null for one that
  /// nobody wants; full scale is 1. force: unless it is empty, so many contact forces are written [N]. input: null,
  /// or pushes the body, where the instrument has an input; full scale is 1. It may be the array of an output.
  template <typename Sample>
  void process(std::span<Sample* const> outputs, std::size_t samples, std::span<T> force = {},
               const Sample* input = nullptr) {
    const FlushDenormals flushed;
    is_new_ = false;
    for (std::size_t done = 0; done < samples;) {
      const std::size_t length = glide() ? 1 : (std::min)(samples - done, kBlock);
      play(outputs, done, length, detail::part_of(force, done, length), in_newtons(input, done, length));
      done += length;
    }
  }

  /// Brings the instrument to rest; parameters arrive where they glide to.
  void reset() {
    sleeper_.reset();
    midi_.drop_notes();
    std::fill(buttons_.begin(), buttons_.end(), false);
    for (std::size_t p = 0; p < targets_.size(); ++p)
      if (is_set(p)) set_now(p, targets_[p]);
    is_gliding_ = false;
    is_new_ = true;
  }

 private:
  static constexpr std::size_t kBlock = 256;  // samples

  void take(const MidiEvent& event) {
    using Kind = MidiEvent::Kind;
    const auto key = static_cast<std::size_t>(event.key);
    switch (event.kind) {
      case Kind::kNoteStart:
        bend(key, event.cents);
        return begin_key(event);
      case Kind::kNoteOn:
        return sleeper_.play({0, Action::kNoteOn, key, event.value});
      case Kind::kNoteOff:
        if (event.is_last) sleeper_.play({0, Action::kNoteOff, key, event.value});
        return;
      case Kind::kKeyBend:
        return bend(key, event.cents);
      case Kind::kController:
        if (midi_pedal(event.number) == kMidiPedals.size()) move(event.number, event);
        return;
      case Kind::kPedal:
        return move(event.number, event);
      case Kind::kChannelBend:
        if (!instrument().bends_keys()) bend(key, event.cents);
        return;
      case Kind::kSoundOff:
      case Kind::kReset:
        return reset();
      case Kind::kPressure:
      case Kind::kKeyPressure:
        return move(kPressureController, event);
      case Kind::kKeyController:
        return move(event.number, event);
      case Kind::kLevel:
      case Kind::kPan:
        expressed_.set(key);
        return sleeper_.play({0, event.kind == Kind::kPan ? Action::kPanKey : Action::kLevelKey, key, event.value});
      case Kind::kProgram:
        return load_program(static_cast<std::size_t>(event.number));
    }
  }

  // The preset of a program, but for pedals and bends, which the performance holds.
  void load_program(std::size_t preset) {
    if (preset >= instrument().presets().size()) return;
    const Preset& loaded = instrument().presets()[preset];
    for (std::size_t p = 0; p < loaded.values.size(); ++p)
      if (const Parameter& x = instrument().parameters()[p]; !is_of_performance(x.name, x.controller))
        set(p, loaded.values[p]);
  }

  // Moves the parameters of a controller to a part of their way, or to where they were at first: those of all, or of
  // some keys where the instrument can.
  void move(int controller, const MidiEvent& event) {
    const bool is_of_key =
        event.kind == MidiEvent::Kind::kKeyPressure || event.kind == MidiEvent::Kind::kKeyController;
    for (std::size_t p = 0; p < targets_.size(); ++p) {
      const Parameter& x = instrument().parameters()[p];
      if (controller == 0 || x.controller != controller) continue;
      const double value = event.is_first ? x.initial : value_at(x, event.value);
      const double by = event.is_first ? 0 : value - target(p);
      if (!instrument().moves_keys(p) || !(is_of_key || event.is_of_zone))
        set(p, value);
      else if (is_of_key)
        move_key(event.key, p, by);
      else
        move_note({.channel = event.channel}, p, by);
    }
  }

  // A note begins without what was expressed on its key before, but with what its channel of an MPE zone has.
  void begin_key(const MidiEvent& note) {
    const auto key = static_cast<std::size_t>(note.key);
    const bool is_expressed = is_number(note.pressure) || is_number(note.brightness);
    if (!expressed_[key] && !is_expressed) return;
    for (std::size_t p = 0; p < targets_.size(); ++p) {
      if (!instrument().moves_keys(p)) continue;
      const Parameter& x = instrument().parameters()[p];
      const double part = x.controller == kPressureController     ? note.pressure
                          : x.controller == kBrightnessController ? note.brightness
                                                                  : MidiChannel::kUnsent;
      move_key(note.key, p, is_number(part) ? value_at(x, part) - target(p) : 0);
    }
    sleeper_.play({0, Action::kLevelKey, key, 1});
    sleeper_.play({0, Action::kPanKey, key, 0});
    expressed_.set(key, is_expressed);
  }

  // Where keys are not bent alone, what MIDI bends last moves the parameter.
  void bend(std::size_t key, double cents) {
    if (instrument().bends_keys()) return sleeper_.play({0, Action::kBendKey, key, cents});
    if (cents == std::exchange(bend_cents_, cents)) return;
    for (std::size_t p = 0; p < targets_.size(); ++p)
      if (std::string_view(instrument().parameters()[p].name) == "bend_cents") set(p, cents);
  }

  [[nodiscard]] bool is_set(std::size_t parameter) const { return is_number(targets_[parameter]); }
  void set_now(std::size_t parameter, double value) {
    now_[parameter] = value;
    sleeper_.play({0, Action::kSet, parameter, value});
  }

  template <typename Sample>
  [[nodiscard]] std::span<const T> in_newtons(const Sample* input, std::size_t begin, std::size_t samples) {
    const double full_scale_n = instrument().input_scale_n();
    if (input == nullptr || !(full_scale_n > 0)) return {};
    std::transform(input + begin, input + begin + samples, input_.begin(),
                   [&](Sample sample) { return static_cast<T>(full_scale_n * static_cast<double>(sample)); });
    return std::span(input_).first(samples);
  }

  template <typename Sample>
  void play(std::span<Sample* const> outputs, std::size_t begin, std::size_t samples, std::span<T> force,
            std::span<const T> input) {
    const auto is_wanted = [&](std::size_t o) { return o < outputs.size() && outputs[o] != nullptr; };
    for (std::size_t o = 0; o < outputs_.size(); ++o)
      outputs_[o] = is_wanted(o) ? std::span(scratch_[o]).first(samples) : std::span<T>();
    sleeper_.process(outputs_, force, samples, input);
    for (std::size_t o = 0; o < outputs_.size(); ++o) {
      const T scale = static_cast<T>(instrument().outputs()[o].full_scale);
      for (std::size_t n = 0; is_wanted(o) && n < samples; ++n)
        outputs[o][begin + n] = static_cast<Sample>(outputs_[o][n] / scale);
    }
  }

  // Moves parameters by one sample; true while one of them is on its way.
  bool glide() {
    if (!is_gliding_) return false;
    is_gliding_ = false;
    for (std::size_t p = 0; p < targets_.size(); ++p) {
      if (!is_set(p) || now_[p] == targets_[p]) continue;
      const double next = now_[p] + rates_[p] * (targets_[p] - now_[p]);
      // What the instrument's precision no longer shows ends the glide.
      const bool arrives = static_cast<T>(next) == static_cast<T>(now_[p]);
      set_now(p, arrives ? targets_[p] : next);
      is_gliding_ |= !arrives;
    }
    return is_gliding_;
  }

  Sleeper<T> sleeper_;
  MidiInterpreter midi_;
  std::bitset<kMidiKeys> expressed_;  // keys that differ from the others by more than their bend
  double bend_cents_ = 0;             // by MIDI, of an instrument that bends as a whole
  std::vector<double> targets_;       // of the parameters; not a number: it was never set
  std::vector<double> now_, rates_;   // where their glides are, and by which part these advance in a sample
  std::vector<bool> buttons_;         // that are down
  std::vector<std::span<T>> outputs_;
  std::vector<std::array<T, kBlock>> scratch_;
  std::array<T, kBlock> input_;
  bool is_gliding_ = false;
  bool is_new_ = true;  // nothing has sounded since the reset: parameters jump
};

}  // namespace contactspline
