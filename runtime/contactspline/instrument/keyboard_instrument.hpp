// SPDX-License-Identifier: MIT
// A keyboard on its body as an instrument: keys of MIDI and pedals.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/models/keyboard_on_body.hpp"

namespace contactspline {

/// The parameters of a keyboard on its body, for all keys.
struct KeyboardParameter {
  enum : std::size_t { kHardness, kMassRatio, kLoss, kSustain, kSostenuto, kUnaCorda, kBend, kKnock, kParameters };
  static constexpr std::array<Parameter, kParameters> kList = {
      {{"stiffness_ratio", "", {1e-6, 1e6}, {0.05, 20}, 1, Scale::kLogarithmic, Acts::kAtNextNote, 0, 74},
       {"mass_ratio", "", {1e-6, 1e6}, {0.25, 4}, 1, Scale::kLogarithmic, Acts::kAtNextNote},
       {"loss_s_per_m", "s/m", {0, 1e3}, {0, 2}, 0, Scale::kLinear, Acts::kAtNextNote},
       {"sustain", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtOnce, 0, 64, 16},
       {"sostenuto", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtOnce, 0, 66, 16},
       {"una_corda", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtNextNote, 0, 67, 16},
       {"bend_cents", "cents", {-1200, 1200}, {-200, 200}, 0, Scale::kLinear, Acts::kAtOnce, 0, 0, 16},
       {"knock_ratio", "", {0, 1000}, {0, 4}, 1, Scale::kLinear, Acts::kAtNextNote}}};
  static constexpr std::array<Output, 2> kOutputs = {
      {{"left_velocity_m_per_s", "m/s", 1.0 / 12}, {"right_velocity_m_per_s", "m/s", 1.0 / 12}}};
  /// With ears in the room.
  static constexpr std::array<Output, 2> kPressureOutputs = {
      {{"left_pressure_pa", "Pa", 20}, {"right_pressure_pa", "Pa", 20}}};
};

/// A keyboard as hosts play it: hammers, pedals and the pitch wheel are parameters. Derived has first_key() and
/// speed_of(velocity), the speed of a hammer. Meets Instrument.
template <typename Derived, std::floating_point T>
class PedaledKeyboard : public KeyboardOnBody<T>, public KeyboardParameter {
 public:
  using value_type = T;
  static std::span<const Parameter> parameters() { return kList; }
  static std::span<const Event> events() { return {}; }
  static std::span<const Output> outputs() { return kOutputs; }
  static constexpr bool kSleeps = true;  ///< silent until a note

  /// Sets a parameter of all keys. A bend is added to none: it replaces those of the keys.
  void set(std::size_t parameter, double value) {
    const double next = held(values_[parameter], value, kList[parameter].allowed);
    if (next != std::exchange(values_[parameter], next)) apply(parameter);
  }
  [[nodiscard]] double value(std::size_t parameter) const { return values_[parameter]; }

  /// velocity: 0 to 1, clamped. Keys that it lacks and velocities that are not a number do nothing.
  void note_on(int key, double velocity) { this->strike(index_of(key), static_cast<T>(self().speed_of(velocity))); }
  /// Lowers the damper of a key, as far as the pedals allow.
  void note_off(int key) { this->release(index_of(key)); }
  void pluck(std::size_t, T, double = 0) {}

  using KeyboardOnBody<T>::process;
  void process(Outputs<T> outputs, std::span<T> force = {}) {
    constexpr std::size_t kBlock = 256;
    std::array<T, kBlock> left_scratch, right_scratch;
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (std::size_t done = 0; done < length; done += kBlock) {
      const std::size_t samples = (std::min)(kBlock, length - done);
      const auto part = [&](std::size_t output, std::array<T, kBlock>& otherwise) {
        return output < outputs.size() && !outputs[output].empty() ? outputs[output].subspan(done, samples)
                                                                   : std::span<T>(otherwise).first(samples);
      };
      process(part(0, left_scratch), part(1, right_scratch), detail::part_of(force, done, samples));
    }
  }

  /// Does nothing sound?
  [[nodiscard]] bool is_silent(double limit_j) const { return !this->is_hammer_flying() && this->energy() < limit_j; }

 protected:
  using KeyboardOnBody<T>::KeyboardOnBody;

  /// Brings all parameters to the keys, which are new.
  void apply_all() {
    for (std::size_t parameter = 0; parameter < kParameters; ++parameter) apply(parameter);
  }
  void set_first(std::size_t parameter, double value) { values_[parameter] = value; }

 private:
  [[nodiscard]] const Derived& self() const { return static_cast<const Derived&>(*this); }

  // Of a key that the keyboard lacks: a number above all keys.
  [[nodiscard]] std::size_t index_of(int key) const {
    return static_cast<std::size_t>(key) - static_cast<std::size_t>(self().first_key());
  }

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
        for (std::size_t key = 0; key < this->keys(); ++key) this->bend(key, values_[kBend]);
        return;
      default:
        this->set_hammers(static_cast<T>(values_[kMassRatio]),
                          {static_cast<T>(values_[kHardness]), static_cast<T>(values_[kLoss])});
    }
  }

  std::array<double, kParameters> values_ = [] {
    std::array<double, kParameters> values{};
    for (std::size_t i = 0; i < kParameters; ++i) values[i] = kList[i].initial;
    return values;
  }();
};

/// The keyboard of an emitted struct on the body that its file names, key by key as MIDI counts them.
template <typename Keyboard, std::floating_point T>
class KeyboardInstrument : public PedaledKeyboard<KeyboardInstrument<Keyboard, T>, T> {
  using Base = PedaledKeyboard<KeyboardInstrument, T>;

 public:
  /// Without keys until prepare().
  KeyboardInstrument() : Base(std::vector<KeyOnBody<T>>(), kBoard, 44100) {
    this->set_first(KeyboardParameter::kLoss, Keyboard::felt_loss_s_per_m);
  }
  /// At most `max_modes` modes of each string. Allocates.
  explicit KeyboardInstrument(double sample_rate_hz, std::size_t max_modes = kMaxModes) : KeyboardInstrument() {
    max_modes_ = max_modes;
    prepare(sample_rate_hz);
  }

  static const char* name() { return Keyboard::name; }
  static std::span<const Parameter> parameters() { return kParameterList; }
  static std::span<const Output> outputs() {
    return kBoard.pressure.rate_hz > 0 ? KeyboardParameter::kPressureOutputs : KeyboardParameter::kOutputs;
  }
  static const char* description() { return "Keys of strings on a soundboard, contact without iteration"; }
  [[nodiscard]] std::span<const Preset> presets() const { return presets_; }

  void prepare(double sample_rate_hz) {
    static_cast<KeyboardOnBody<T>&>(*this) = KeyboardOnBody<T>(all_keys(), kBoard, sample_rate_hz, max_modes_);
    this->set_soft_ratio(Board::una_corda_stiffness_ratio);
    this->apply_all();
  }

  static int first_key() { return Keyboard::first_key; }
  static bool has_key(int key) {
    return key >= Keyboard::first_key && key < Keyboard::first_key + static_cast<int>(Keyboard::keys);
  }
  static double speed_of(double velocity) { return strike_speed<Keyboard>(velocity); }

 private:
  using Board = typename Keyboard::body;

  static constexpr BodyPressure pressure() {
    if constexpr (requires { Board::pressure_rate_hz; })
      return {{Board::left_of_velocity, Board::left_of_displacement, Board::left_taps},
              {Board::right_of_velocity, Board::right_of_displacement, Board::right_taps},
              Board::pressure_rate_hz};
    else
      return {};
  }
  static LongitudinalMotion longitudinal([[maybe_unused]] int key, [[maybe_unused]] double tension_n) {
    if constexpr (requires { Board::longitudinal_last_key; })
      if (key <= Board::longitudinal_last_key)
        return {axial_stiffness(tension_n, Board::longitudinal_frequency_ratio),
                {Board::longitudinal_constant_loss_per_s, Board::longitudinal_quadratic_loss_m2_per_s},
                Board::longitudinal_output_ratio};
    return {};
  }
  static constexpr BoardOfKeyboard kBoard{
      modes_in<Board>,
      Board::bridge_shapes,
      Board::left_shapes,
      Board::right_shapes,
      {Board::pickup_ratio, Board::mobility_m_per_n_s, Board::output_above_hz, Board::output_quality},
      Board::knock_shapes,
      pressure()};

  static constexpr std::size_t kMaxModes = 80;
  static constexpr auto kParameterList = [] {
    auto list = KeyboardParameter::kList;
    list[KeyboardParameter::kLoss].initial = Keyboard::felt_loss_s_per_m;
    return list;
  }();

  static std::vector<KeyOnBody<T>> all_keys() {
    std::vector<KeyOnBody<T>> keys;
    for (std::size_t k = 0; k < Keyboard::keys; ++k) {
      const int key = Keyboard::first_key + static_cast<int>(k);
      StiffString strings = string_of<Keyboard>(key);
      strings.losses.constant_per_s -= Keyboard::bridge_losses[k];
      if (Keyboard::strings[k] == 2) strings.detuning_cents.assign(Board::double_hz.begin(), Board::double_hz.end());
      if (Keyboard::strings[k] == 3) strings.detuning_cents.assign(Board::triple_hz.begin(), Board::triple_hz.end());
      const double pitch_hz = Keyboard::concert_pitch_hz * std::exp2((key - 69) / 12.0);
      for (double& detuning : strings.detuning_cents) detuning = 1200 * std::log2(1 + detuning / pitch_hz);
      keys.push_back({std::move(strings),
                      Keyboard::strike_positions[k],
                      SegmentTable<T>(felts_of<Keyboard, T>[k]),
                      {.hammer_mass_kg = static_cast<T>(Keyboard::hammer_masses[k])},
                      {key <= Keyboard::last_damped_key ? Keyboard::damper_per_s : 0.0, Keyboard::damper_time_s},
                      {},
                      Keyboard::bridge_ratios[k],
                      Keyboard::output_ratios[k],
                      {Board::horizontal_strike_ratio * Keyboard::horizontal_ratios[k],
                       Board::horizontal_bridge_ratio * Keyboard::horizontal_ratios[k], Board::horizontal_cents},
                      Keyboard::bridge_places[k],
                      longitudinal(key, Keyboard::tensions[k])});
    }
    return keys;
  }

  std::size_t max_modes_ = kMaxModes;
  std::vector<Preset> presets_ = {
      {"concert", {1, 1, 0.1, 0, 0, 0, 0, 1}},         {"una corda", {1, 1, 0.1, 0, 0, 1, 0, 1}},
      {"soft felt", {0.2, 1, 0.3, 0, 0, 0, 0, 1}},     {"hard felt", {6, 1, 0.05, 0, 0, 0, 0, 1}},
      {"heavy hammers", {1, 2.5, 0.1, 0, 0, 0, 0, 1}}, {"long sustain", {1, 1, 0.1, 1, 0, 0, 0, 1}}};
};

}  // namespace contactspline
