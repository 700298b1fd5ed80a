// SPDX-License-Identifier: MIT
// The piano with a keyboard of one's own.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "generator/player/instrument_parts.hpp"
#include "generator/resonator/keyboard.hpp"

namespace contactspline {

/// What an OwnKeyboard is built of. score: has a voice for each key, and a body.
struct OwnKeyboardParts {
  OwnKeyboardParts(Keyboard its_keyboard, Score its_score)
      : keyboard(std::move(its_keyboard)), score(std::move(its_score)) {
    parameters[KeyboardParameter::kLoss].initial = keyboard.felt_loss_s_per_m;
  }

  Keyboard keyboard;
  Score score;
  std::array<Parameter, KeyboardParameter::kParameters> parameters = KeyboardParameter::kList;
};

/// Plays a keyboard as KeyboardInstrument plays that of an emitted struct. Meets Instrument.
template <std::floating_point T>
class OwnKeyboard : public KeyboardOfScore<T> {
 public:
  OwnKeyboard(std::shared_ptr<const OwnKeyboardParts> parts, double sample_rate_hz)
      : KeyboardOfScore<T>(parts->score, sample_rate_hz, kMaxModes), parts_(std::move(parts)) {
    this->set_first(KeyboardParameter::kLoss, parts_->keyboard.felt_loss_s_per_m);
    this->apply_all();
  }

  void prepare(double sample_rate_hz) {
    OwnKeyboard rested(parts_, sample_rate_hz);
    for (std::size_t p = 0; p < KeyboardParameter::kParameters; ++p) rested.set(p, this->value(p));
    *this = std::move(rested);
  }

  [[nodiscard]] const char* name() const { return parts_->keyboard.name.c_str(); }
  [[nodiscard]] const char* description() const { return parts_->keyboard.description.c_str(); }
  [[nodiscard]] std::span<const Parameter> parameters() const { return parts_->parameters; }
  [[nodiscard]] std::span<const Output> outputs() const {
    return parts_->score.ears.empty() ? KeyboardParameter::kOutputs : KeyboardParameter::kPressureOutputs;
  }
  void note_on(int key, double velocity) {
    if (!is_number(velocity)) return;
    this->strike(index_of(key), static_cast<T>(strike_speed(parts_->keyboard, std::clamp(velocity, 0.0, 1.0))));
  }
  void note_off(int key) { this->release(index_of(key)); }

 private:
  static constexpr std::size_t kMaxModes = 80;  // as KeyboardInstrument

  // Of a key that the keyboard lacks: a number above all keys.
  [[nodiscard]] std::size_t index_of(int key) const {
    return static_cast<std::size_t>(key) - static_cast<std::size_t>(parts_->keyboard.first_key);
  }

  std::shared_ptr<const OwnKeyboardParts> parts_;
};

}  // namespace contactspline
