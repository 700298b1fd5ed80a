// SPDX-License-Identifier: MIT
// The piano with a keyboard of one's own.
#pragma once

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
class OwnKeyboard : public KeyboardOfScore<T, OwnKeyboard<T>> {
 public:
  OwnKeyboard(std::shared_ptr<const OwnKeyboardParts> parts, double sample_rate_hz)
      : KeyboardOfScore<T, OwnKeyboard>(parts->score, sample_rate_hz, kMaxModes), parts_(std::move(parts)) {
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
  [[nodiscard]] int first_key() const { return parts_->keyboard.first_key; }
  [[nodiscard]] double speed_of(double velocity) const { return strike_speed(parts_->keyboard, velocity); }

 private:
  static constexpr std::size_t kMaxModes = 80;  // as KeyboardInstrument

  std::shared_ptr<const OwnKeyboardParts> parts_;
};

}  // namespace contactspline
