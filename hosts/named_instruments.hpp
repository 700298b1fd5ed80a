// SPDX-License-Identifier: MIT
// Every instrument that ships, and those of files, made at run time.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "generator/player/any_instrument.hpp"

namespace contactspline {

/// Makes instruments, always the same one, in either precision. prepare() at the rate comes next. Throws BadInput
/// where a body has no mode below half the rate.
struct InstrumentMaker {
  std::function<std::unique_ptr<AnyInstrument<float>>(double sample_rate_hz)> in_single;
  std::function<std::unique_ptr<AnyInstrument<double>>(double sample_rate_hz)> in_double;

  template <std::floating_point T>
  [[nodiscard]] std::unique_ptr<AnyInstrument<T>> make(double sample_rate_hz) const {
    if constexpr (std::same_as<T, float>)
      return in_single(sample_rate_hz);
    else
      return in_double(sample_rate_hz);
  }

  /// make: called with a number of the precision and with the sample rate.
  template <typename Make>
  [[nodiscard]] static InstrumentMaker of(const Make& make) {
    return {[make](double rate) { return make(float(), rate); },
            [make](double rate) { return make(double(), rate); }};
  }
};

/// A voice of a score, with its first values.
[[nodiscard]] InstrumentMaker maker_of_voice(Model model, Voice voice);

/// Names of what ships: the models of the runtime, the keyboard, the instruments of files.
[[nodiscard]] std::vector<std::string> instrument_names();

/// The instrument that ships under a name, or that the file at a path describes. Throws BadInput.
[[nodiscard]] InstrumentMaker maker_of_name(const std::string& name);

/// The instrument of the text of a file. `file` stands in messages; what the text names is read beside it. Throws
/// BadInput.
[[nodiscard]] InstrumentMaker maker_of_text(std::string_view text, const std::string& file);

}  // namespace contactspline
