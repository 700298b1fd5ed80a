// SPDX-License-Identifier: MIT
// A keyboard on its body as an instrument: keys of MIDI and pedals.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/data/model_parameters.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/models/keyboard_on_body.hpp"

namespace contactspline {

/// A keyboard as hosts play it: hammers, pedals and the pitch wheel are parameters. Meets Instrument.
template <std::floating_point T>
class PedaledKeyboard : public KeyboardOnBody<T>, public KeyboardParameter {
 public:
  using value_type = T;
  static constexpr bool kSleeps = true;  ///< silent until a note

  /// Without keys until prepare().
  explicit PedaledKeyboard(std::shared_ptr<const KeyboardParts> parts)
      : KeyboardOnBody<T>({}, parts->body(kAnyRate_hz).board(parts->listening), kAnyRate_hz),
        parts_(std::move(parts)) {
    parameters_[kLoss].initial = parts_->felt_loss_s_per_m;
    for (std::size_t p = 0; p < kParameters; ++p) values_[p] = parameters_[p].initial;
    for (const KeyParts& key : parts_->keys) felts_.push_back(table_in<T>(key.felt));
    key_cents_.resize(parts_->keys.size());
    key_moves_.resize(parts_->keys.size());
  }
  /// Allocates.
  PedaledKeyboard(std::shared_ptr<const KeyboardParts> parts, double sample_rate_hz)
      : PedaledKeyboard(std::move(parts)) {
    prepare(sample_rate_hz);
  }

  [[nodiscard]] const char* name() const { return parts_->name.c_str(); }
  [[nodiscard]] const char* description() const { return parts_->description.c_str(); }
  [[nodiscard]] std::span<const Parameter> parameters() const { return parameters_; }
  static std::span<const Event> events() { return {}; }
  [[nodiscard]] std::span<const Output> outputs() const { return parts_->has_ears ? kPressureOutputs : kOutputs; }
  [[nodiscard]] std::span<const Preset> presets() const { return parts_->presets; }
  /// The input pushes the bridge, 1 by the force that an output of a force plays as 1.
  [[nodiscard]] static double input_scale_n() { return 50; }

  /// Brings it to rest at a sample rate; parameters stay. Allocates.
  void prepare(double sample_rate_hz) {
    const BodyArrays body = parts_->body(sample_rate_hz);
    static_cast<KeyboardOnBody<T>&>(*this) =
        KeyboardOnBody<T>(all_keys(), body.board(parts_->listening), sample_rate_hz, parts_->max_modes);
    this->set_soft_ratio(parts_->una_corda_stiffness_ratio);
    for (std::size_t parameter = 0; parameter < kParameters; ++parameter) apply(parameter);
  }

  /// Sets a parameter of all keys. A bend is added to those of the keys.
  void set(std::size_t parameter, double value) {
    const double next = held(values_[parameter], value, parameters_[parameter].allowed);
    if (next != std::exchange(values_[parameter], next)) apply(parameter);
  }
  [[nodiscard]] double value(std::size_t parameter) const { return values_[parameter]; }

  [[nodiscard]] bool has_key(int key) const { return index_of(key) < parts_->keys.size(); }
  /// velocity: 0 to 1, clamped. Keys that it lacks and velocities that are not a number do nothing.
  void note_on(int key, double velocity) {
    const std::size_t index = index_of(key);
    const bool is_moved = has_key(key) && key_moves_[index] != Moves{};
    if (is_moved) set_hammers_beside(key_moves_[index]);
    this->strike(index, static_cast<T>(parts_->speed_of(velocity)));
    if (is_moved) set_hammers_beside({});
  }
  /// Lowers the damper of a key, as far as the pedals allow. velocity: of the release, 0 to 1; 64/127, and 0 where
  /// none is known, take the damper's own time, 1 a quarter of it, 1/127 four times as long.
  void note_off(int key, double velocity = 0) {
    const double steps = 127 * std::clamp(velocity, 0.0, 1.0) - 64;
    this->release(index_of(key), steps == 0 || !(velocity > 0) ? 1 : std::exp2(2 * steps / 63));
  }
  void pluck(std::size_t, T, double = 0) {}
  /// Bend [cents], extra damping [1/s] and place of the next strike [m] of one key of MIDI.
  void bend_key(int key, double cents) {
    if (!has_key(key) || !is_number(cents)) return;
    key_cents_[index_of(key)] = cents;
    bend_with_all(index_of(key));
  }
  void damp_key(int key, double damping_per_s) { this->damp(index_of(key), static_cast<T>(damping_per_s)); }
  void place_key(int key, double place_m) { this->strike_at(index_of(key), place_m); }
  /// Hammer and felt of one key of MIDI, from its next strike on, beside those of all.
  [[nodiscard]] static bool moves_keys(std::size_t parameter) {
    return parameter == kMassRatio || parameter == kHardness || parameter == kLoss;
  }
  void move_key(int key, std::size_t parameter, double by) {
    if (has_key(key) && moves_keys(parameter) && is_number(by)) key_moves_[index_of(key)][parameter] = by;
  }

  using KeyboardOnBody<T>::process;
  void process(Outputs<T> outputs, std::span<T> force = {}, std::span<const T> input = {}) {
    constexpr std::size_t kBlock = 256;
    std::array<T, kBlock> left_scratch, right_scratch;
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (std::size_t done = 0; done < length; done += kBlock) {
      const std::size_t samples = (std::min)(kBlock, length - done);
      const auto part = [&](std::size_t output, std::array<T, kBlock>& otherwise) {
        return output < outputs.size() && !outputs[output].empty() ? outputs[output].subspan(done, samples)
                                                                   : std::span<T>(otherwise).first(samples);
      };
      process(part(0, left_scratch), part(1, right_scratch), detail::part_of(force, done, samples),
              detail::part_of(input, done, samples));
    }
  }

  /// Does nothing sound?
  [[nodiscard]] bool is_silent(double limit_j) const { return !this->is_hammer_flying() && this->energy() < limit_j; }

 private:
  static constexpr double kAnyRate_hz = 44100;
  using Moves = std::array<double, kParameters>;  // of one key

  // Of a key that the keyboard lacks: a number above all keys.
  [[nodiscard]] std::size_t index_of(int key) const {
    return static_cast<std::size_t>(key) - static_cast<std::size_t>(parts_->first_key);
  }

  [[nodiscard]] std::vector<KeyOnBody<T>> all_keys() const {
    std::vector<KeyOnBody<T>> keys;
    for (std::size_t k = 0; k < felts_.size(); ++k) {
      const KeyParts& key = parts_->keys[k];
      keys.push_back({key.strings,
                      key.strike_position_m,
                      felts_[k],
                      {.hammer_mass_kg = static_cast<T>(key.hammer_mass_kg)},
                      key.damper,
                      key.memories,
                      key.bridge_ratio,
                      key.output_ratio,
                      key.horizontal,
                      key.bridge_place,
                      key.longitudinal});
    }
    return keys;
  }

  void bend_with_all(std::size_t key) { this->bend(key, values_[kBend] + key_cents_[key]); }

  void apply(std::size_t parameter) {
    switch (parameter) {
      case kSustain:
        return this->sustain(values_[kSustain]);
      case kSostenuto:
        return this->sostenuto(values_[kSostenuto] >= 0.5);
      case kUnaCorda:
        return this->una_corda(values_[kUnaCorda]);
      case kKnock:
        return this->set_knock(static_cast<T>(values_[kKnock]));
      case kBend:
        for (std::size_t key = 0; key < this->keys(); ++key) bend_with_all(key);
        return;
      default:
        set_hammers_beside({});
    }
  }

  // How far the hammers of the next strikes are from those of all.
  void set_hammers_beside(const Moves& moves) {
    const auto moved = [&](std::size_t parameter) {
      const double value = values_[parameter];
      return static_cast<T>(held(value, value + moves[parameter], parameters_[parameter].allowed));
    };
    this->set_hammers(moved(kMassRatio), {moved(kHardness), moved(kLoss)});
  }

  std::shared_ptr<const KeyboardParts> parts_;
  std::array<Parameter, kParameters> parameters_ = kList;
  std::array<double, kParameters> values_{};
  std::vector<std::vector<Segment<T>>> felts_;
  std::vector<double> key_cents_;  // beside the bend of all
  std::vector<Moves> key_moves_;   // beside the values of all
};

namespace detail {

template <typename Values>
[[nodiscard]] std::vector<double> numbers_of(const Values& values) {
  return {values.begin(), values.end()};
}

/// The body of an emitted keyboard.
template <typename Board>
[[nodiscard]] BodyArrays emitted_body() {
  BodyArrays body{{modes_in<Board>.begin(), modes_in<Board>.end()},
                  numbers_of(Board::bridge_shapes),
                  numbers_of(Board::knock_shapes),
                  numbers_of(Board::left_shapes),
                  numbers_of(Board::right_shapes),
                  {},
                  0};
  if constexpr (requires { Board::pressure_rate_hz; }) {
    body.ears = {
        {numbers_of(Board::left_of_velocity), numbers_of(Board::left_of_displacement), numbers_of(Board::left_taps)},
        {numbers_of(Board::right_of_velocity), numbers_of(Board::right_of_displacement),
         numbers_of(Board::right_taps)}};
    body.sample_rate_hz = Board::pressure_rate_hz;
  }
  return body;
}

template <typename Board>
[[nodiscard]] LongitudinalMotion emitted_longitudinal([[maybe_unused]] int key, [[maybe_unused]] double tension_n) {
  if constexpr (requires { Board::longitudinal_last_key; })
    if (key <= Board::longitudinal_last_key)
      return {axial_stiffness(tension_n, Board::longitudinal_frequency_ratio),
              {Board::longitudinal_constant_loss_per_s, Board::longitudinal_quadratic_loss_m2_per_s},
              Board::longitudinal_output_ratio};
  return {};
}

/// Key k of an emitted keyboard.
template <typename Keyboard>
[[nodiscard]] KeyParts emitted_key(std::size_t k) {
  using Board = typename Keyboard::body;
  const int key = Keyboard::first_key + static_cast<int>(k);
  StiffString strings = string_of<Keyboard>(key);
  strings.losses.constant_per_s -= Keyboard::bridge_losses[k];
  if (Keyboard::strings[k] == 2) strings.detuning_cents.assign(Board::double_hz.begin(), Board::double_hz.end());
  if (Keyboard::strings[k] == 3) strings.detuning_cents.assign(Board::triple_hz.begin(), Board::triple_hz.end());
  const double pitch_hz = Keyboard::concert_pitch_hz * std::exp2((key - 69) / 12.0);
  for (double& detuning : strings.detuning_cents) detuning = 1200 * std::log2(1 + detuning / pitch_hz);
  return {.strings = std::move(strings),
          .strike_position_m = Keyboard::strike_positions[k],
          .felt = {felts_of<Keyboard, double>[k].begin(), felts_of<Keyboard, double>[k].end()},
          .hammer_mass_kg = Keyboard::hammer_masses[k],
          .damper = {key <= Keyboard::last_damped_key ? Keyboard::damper_per_s : 0.0, Keyboard::damper_time_s},
          .bridge_ratio = Keyboard::bridge_ratios[k],
          .output_ratio = Keyboard::output_ratios[k],
          .horizontal = {Board::horizontal_strike_ratio * Keyboard::horizontal_ratios[k],
                         Board::horizontal_bridge_ratio * Keyboard::horizontal_ratios[k], Board::horizontal_cents},
          .bridge_place = Keyboard::bridge_places[k],
          .longitudinal = emitted_longitudinal<Board>(key, Keyboard::tensions[k])};
}

}  // namespace detail

/// What the keyboard of an emitted struct on the body that its file names is built of.
template <typename Keyboard>
[[nodiscard]] KeyboardParts keyboard_parts() {
  using Board = typename Keyboard::body;
  KeyboardParts parts{
      .name = Keyboard::name,
      .description = "Keys of strings on a soundboard, contact without iteration",
      .first_key = Keyboard::first_key,
      .keys = {},
      .body = [](double) { return detail::emitted_body<Board>(); },
      .listening = {Board::pickup_ratio, Board::mobility_m_per_n_s, Board::output_above_hz, Board::output_quality},
      .has_ears = !detail::emitted_body<Board>().ears.empty(),
      .min_speed_m_per_s = Keyboard::min_speed_m_per_s,
      .max_speed_m_per_s = Keyboard::max_speed_m_per_s,
      .felt_loss_s_per_m = Keyboard::felt_loss_s_per_m,
      .una_corda_stiffness_ratio = Board::una_corda_stiffness_ratio};
  for (std::size_t k = 0; k < Keyboard::keys; ++k) parts.keys.push_back(detail::emitted_key<Keyboard>(k));
  parts.presets = {{"concert", {1, 1, 0.1, 0, 0, 0, 0, 1}},         {"una corda", {1, 1, 0.1, 0, 0, 1, 0, 1}},
                   {"soft felt", {0.2, 1, 0.3, 0, 0, 0, 0, 1}},     {"hard felt", {6, 1, 0.05, 0, 0, 0, 0, 1}},
                   {"heavy hammers", {1, 2.5, 0.1, 0, 0, 0, 0, 1}}, {"long sustain", {1, 1, 0.1, 1, 0, 0, 0, 1}}};
  return parts;
}

/// The keyboard of an emitted struct on the body that its file names, key by key as MIDI counts them.
template <typename Keyboard, std::floating_point T>
class KeyboardInstrument : public PedaledKeyboard<T> {
 public:
  /// Without keys until prepare().
  KeyboardInstrument() : PedaledKeyboard<T>(parts()) {}
  /// At most `max_modes` modes of each string. Allocates.
  explicit KeyboardInstrument(double sample_rate_hz, std::size_t max_modes = KeyboardParts{}.max_modes)
      : PedaledKeyboard<T>(parts(max_modes), sample_rate_hz) {}

  static const char* name() { return Keyboard::name; }
  static int first_key() { return Keyboard::first_key; }
  static double speed_of(double velocity) { return strike_speed<Keyboard>(velocity); }
  [[nodiscard]] static std::shared_ptr<const KeyboardParts> parts(std::size_t max_modes = KeyboardParts{}.max_modes) {
    auto parts = std::make_shared<KeyboardParts>(keyboard_parts<Keyboard>());
    parts->max_modes = max_modes;
    return parts;
  }
};

}  // namespace contactspline
