// SPDX-License-Identifier: MIT
// An instrument as every host plays it: sliders that glide, buttons, MIDI, presets, outputs at full scale.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "contactspline/host/any_instrument.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/step/flush_denormals.hpp"

namespace contactspline {

/// A message of MIDI of three bytes.
struct MidiMessage {
  int status;         ///< without the channel
  int first, second;  ///< 0 to 127
};

/// The one place where bytes of MIDI are checked; nothing for damaged messages and those of other lengths.
[[nodiscard]] constexpr std::optional<MidiMessage> midi_message(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != 3 || bytes[0] < 0x80 || bytes[0] >= 0xf0 || (bytes[1] | bytes[2]) >= 0x80) return {};
  return MidiMessage{bytes[0] & 0xf0, bytes[1], bytes[2]};
}

/// The first output of a list whose name begins so, or another one.
[[nodiscard]] constexpr std::size_t output_beginning(std::span<const Output> outputs, std::string_view beginning,
                                                     std::size_t otherwise) {
  for (std::size_t o = 0; o < outputs.size(); ++o)
    if (std::string_view(outputs[o].name).starts_with(beginning)) return o;
  return otherwise;
}

/// Plays an instrument for Faust's dsp, for plug-ins and the like. prepare() allocates, all else is safe on an audio
/// thread. An instrument that is silent sleeps: its outputs are exactly 0 until it is played or set. One that
/// rests under a load, as a slide does that a hand presses, sleeps too: its outputs stay where they are.
template <std::floating_point T>
class Hosted {
 public:
  explicit Hosted(Handle<T> instrument) : instrument_(std::move(instrument)), buttons_(instrument_->events().size()) {
    for (std::size_t p = 0; p < instrument_->parameters().size(); ++p) targets_.push_back(instrument_->value(p));
    rates_.resize(targets_.size());
    outputs_.resize(instrument_->outputs().size());
    levels_.resize(outputs_.size());
    scratch_.resize(outputs_.size());
  }

  [[nodiscard]] AnyInstrument<T>& instrument() { return *instrument_; }
  [[nodiscard]] const AnyInstrument<T>& instrument() const { return *instrument_; }

  void prepare(double sample_rate_hz) {
    instrument_->prepare(sample_rate_hz);
    for (std::size_t p = 0; p < rates_.size(); ++p) {
      const double time_s = instrument_->parameters()[p].glide_s;
      rates_[p] = time_s > 0 ? -std::expm1(-1 / (time_s * sample_rate_hz)) : 1;
    }
    reset();
  }

  /// Moves a parameter to a value, as fast as it glides. A value that is not a number does nothing.
  void set(std::size_t parameter, double value) {
    if (parameter >= targets_.size() || !is_number(value)) return;
    const Parameter& p = instrument_->parameters()[parameter];
    const double target = held(targets_[parameter], value, p.allowed);
    if (target != targets_[parameter]) wake();
    targets_[parameter] = target;
    if (rates_[parameter] < 1 && !is_new_)
      is_gliding_ = true;
    else
      instrument_->set(parameter, targets_[parameter]);
  }
  [[nodiscard]] double target(std::size_t parameter) const { return targets_[parameter]; }

  /// Moves the button of an event: when it goes down, the event is played. Without a key the damper stays up.
  void press(std::size_t event, bool is_down) {
    if (event >= buttons_.size() || buttons_[event] == is_down) return;
    buttons_[event] = is_down;
    const Event& played = instrument_->events()[event];
    if (!is_down) return;
    wake();
    play_event(*instrument_, played, targets_[played.parameter]);
  }

  /// Takes a message of MIDI; damaged and unknown ones do nothing. Notes play; a controller moves the parameter that
  /// has it; controller 120 silences, 123 lets all keys go; the pitch wheel bends by two semitones.
  void midi(std::span<const std::uint8_t> bytes) {
    const auto message = midi_message(bytes);
    if (!message) return;
    const auto [status, first, second] = *message;
    wake();
    if (status == 0x90 && second > 0) {
      instrument_->note_on(first, second / 127.0);
    } else if (status == 0x80 || status == 0x90) {
      instrument_->note_off(first);
    } else if (status == 0xb0 && first == 120) {
      reset();
    } else if (status == 0xb0 && first == 123) {
      for (int key = 0; key < 128; ++key) instrument_->note_off(key);
    } else if (status == 0xb0) {
      for (std::size_t p = 0; p < targets_.size(); ++p)
        if (first != 0 && instrument_->parameters()[p].controller == first) set(p, from_part(p, second / 127.0));
    } else if (status == 0xe0) {
      bend(((second << 7 | first) - 8192) / 8192.0 * 200);
    }
  }

  /// Moves all parameters to those of a preset.
  void load(std::size_t preset) {
    if (preset >= instrument_->presets().size()) return;
    const Preset& loaded = instrument_->presets()[preset];
    for (std::size_t p = 0; p < loaded.values.size(); ++p) set(p, loaded.values[p]);
  }

  /// Advances a block, also where nobody wants an output. outputs: one array for each output, null for one that
  /// nobody wants; full scale is 1. force: unless it is empty, so many contact forces are written [N].
  template <typename Sample>
  void process(std::span<Sample* const> outputs, std::size_t samples, std::span<T> force = {}) {
    const FlushDenormals flushed;
    is_new_ = false;
    for (std::size_t done = 0; done < samples;) {
      const std::size_t length = glide() ? 1 : (std::min)(samples - done, kBlock);
      const std::span<T> forces = detail::part_of(force, done, length);
      if (is_asleep_ && !stay(outputs, done, length, forces)) wake();
      if (!is_asleep_) {
        play(outputs, done, length, forces);
        go_to_sleep(length);
      }
      done += length;
    }
  }

  /// Brings the instrument to rest; parameters arrive where they glide to.
  void reset() {
    instrument_->reset();
    std::fill(buttons_.begin(), buttons_.end(), false);
    for (std::size_t p = 0; p < targets_.size(); ++p) instrument_->set(p, targets_[p]);
    is_gliding_ = false;
    is_new_ = true;
    wake();
    since_check_ = 0;
  }

 private:
  static constexpr std::size_t kBlock = 256;  // samples
  // 160 dB below what models themselves take for silent. Without an end the smallest numbers go round for ever: the
  // losses of a sample are flushed to 0.
  static constexpr double kInaudible_J = 1e-30;
  // Part of full scale that counts as silent: a mass that rests away from 0 has no energy, but an output.
  static constexpr double kInaudible = 1e-9;
  // An instrument rests under a load if in kStillBlocks blocks in a row its outputs stay within kStill of full scale,
  // 108 dB below it, and its kinetic energy is below kStill_J. Single precision rounds loads and reaches no less.
  static constexpr double kStill_J = 1e-13, kStill = 0x1p-18;
  static constexpr int kStillBlocks = 8;

  // What an output has been in the blocks in which it was still, and what it is now, over full scale.
  struct Level {
    T low = 0, high = 0, now = 0;
    bool is_known = false;  // was it computed?
  };

  // A part of a slider's way, 0 to 1.
  [[nodiscard]] double from_part(std::size_t parameter, double part) const {
    const auto& [min, max] = instrument_->parameters()[parameter].slider;
    return instrument_->parameters()[parameter].scale == Scale::kLogarithmic ? min * std::pow(max / min, part)
                                                                             : min + part * (max - min);
  }

  // An instrument advances by the length of its outputs: where nobody wants one, it writes the first.
  template <typename Sample>
  void play(std::span<Sample* const> outputs, std::size_t begin, std::size_t samples, std::span<T> force) {
    const auto is_wanted = [&](std::size_t o) { return o < outputs.size() && outputs[o] != nullptr; };
    bool is_any_wanted = false;
    for (std::size_t o = 0; o < outputs_.size(); ++o) {
      outputs_[o] = is_wanted(o) ? std::span(scratch_[o]).first(samples) : std::span<T>();
      is_any_wanted |= is_wanted(o);
    }
    if (!is_any_wanted) outputs_.front() = std::span(scratch_.front()).first(samples);
    instrument_->process(outputs_, force);
    force_ = force.empty() ? std::nullopt : std::optional(force.back());
    for (std::size_t o = 0; o < outputs_.size(); ++o) {
      const T scale = full_scale(o);
      for (std::size_t n = 0; is_wanted(o) && n < samples; ++n)
        outputs[o][begin + n] = static_cast<Sample>(outputs_[o][n] / scale);
    }
  }

  // Looks once in a block: an energy is a sum over all modes.
  void go_to_sleep(std::size_t samples) {
    since_check_ += samples;
    if (since_check_ < kBlock) return;
    since_check_ = 0;
    if (is_gliding_) return;
    if (is_inaudible() && instrument_->is_silent(kInaudible_J)) {
      for (std::size_t o = 0; o < levels_.size(); ++o) levels_[o] = {.is_known = !outputs_[o].empty()};
      force_ = T(0);
      is_asleep_ = true;
    } else {
      if (!are_outputs_still() || !instrument_->is_at_rest(kStill_J)) still_blocks_ = 0;
      is_asleep_ = still_blocks_ == kStillBlocks;
    }
  }

  // Have all outputs stayed where they are, with those of the last block? Counts the blocks.
  bool are_outputs_still() {
    const bool is_first = still_blocks_++ == 0;
    for (std::size_t o = 0; o < outputs_.size(); ++o) {
      Level& level = levels_[o];
      level.is_known = !outputs_[o].empty();
      if (!level.is_known) continue;
      const auto [low, high] = std::ranges::minmax(outputs_[o]);
      level.low = is_first ? low : (std::min)(level.low, low);
      level.high = is_first ? high : (std::max)(level.high, high);
      level.now = outputs_[o].back() / full_scale(o);
      if (!(level.high - level.low <= static_cast<T>(kStill) * full_scale(o))) return false;
    }
    return true;
  }

  [[nodiscard]] T full_scale(std::size_t output) const {
    return static_cast<T>(instrument_->outputs()[output].full_scale);
  }

  // Writes what the outputs are while all rests; false if one was not computed when it fell asleep.
  template <typename Sample>
  bool stay(std::span<Sample* const> outputs, std::size_t begin, std::size_t samples, std::span<T> force) {
    if (!force.empty() && !force_) return false;
    std::ranges::fill(force, force_.value_or(T(0)));
    const auto wanted = outputs.first((std::min)(outputs.size(), levels_.size()));
    for (std::size_t o = 0; o < wanted.size(); ++o)
      if (wanted[o] != nullptr && !levels_[o].is_known) return false;
    for (std::size_t o = 0; o < wanted.size(); ++o)
      if (wanted[o] != nullptr) std::fill_n(wanted[o] + begin, samples, static_cast<Sample>(levels_[o].now));
    return true;
  }

  void wake() {
    is_asleep_ = false;
    still_blocks_ = 0;
  }

  // Does the last block have no sound?
  [[nodiscard]] bool is_inaudible() const {
    for (std::size_t o = 0; o < outputs_.size(); ++o)
      for (const T sample : outputs_[o])
        if (!(std::abs(double(sample)) <= kInaudible * instrument_->outputs()[o].full_scale)) return false;
    return true;
  }

  void bend(double cents) {
    for (std::size_t p = 0; p < targets_.size(); ++p)
      if (std::string_view(instrument_->parameters()[p].name) == "bend_cents") set(p, cents);
  }

  // Moves parameters by one sample; true while one of them is on its way.
  bool glide() {
    if (!is_gliding_) return false;
    is_gliding_ = false;
    for (std::size_t p = 0; p < targets_.size(); ++p) {
      const double now = instrument_->value(p);
      if (now == targets_[p]) continue;
      const double next = now + rates_[p] * (targets_[p] - now);
      // What the instrument's precision no longer shows ends the glide.
      const bool arrives = static_cast<T>(next) == static_cast<T>(now);
      instrument_->set(p, arrives ? targets_[p] : next);
      is_gliding_ |= !arrives;
    }
    return is_gliding_;
  }

  Handle<T> instrument_;
  std::vector<double> targets_, rates_;  // of the parameters; rates: of their glides over a sample
  std::vector<bool> buttons_;            // that are down
  std::vector<std::span<T>> outputs_;
  std::vector<std::array<T, kBlock>> scratch_;
  std::size_t since_check_ = 0;  // samples
  std::vector<Level> levels_;    // of the outputs
  std::optional<T> force_;       // of the contacts in the last sample, if it was computed
  int still_blocks_ = 0;
  bool is_asleep_ = false;
  bool is_gliding_ = false;
  bool is_new_ = true;  // nothing has sounded since the reset: parameters jump
};

}  // namespace contactspline
