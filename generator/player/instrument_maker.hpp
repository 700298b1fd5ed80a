// SPDX-License-Identifier: MIT
// Instruments of scores and of files, made at run time.
#pragma once

#include <concepts>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "contactspline/host/any_instrument.hpp"
#include "generator/material/contact_reader.hpp"
#include "generator/player/score.hpp"
#include "generator/spline/designed_materials.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

/// Makes instruments, always the same one, in either precision. prepare() at the rate comes next. Throws BadInput
/// where a body has no mode below half the rate.
struct InstrumentMaker {
  std::function<Handle<float>(double sample_rate_hz)> in_single;
  std::function<Handle<double>(double sample_rate_hz)> in_double;

  template <std::floating_point T>
  [[nodiscard]] Handle<T> make(double sample_rate_hz) const {
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
[[nodiscard]] InstrumentMaker maker_of_voice(Voice voice);

/// An instrument that can be made of other parts than those that ship.
struct MadeOfParts {
  std::string_view name;          ///< hammer_string, mass_barrier or piano
  std::vector<std::string> keys;  ///< of its parts: resonator, material and keyboard are names, paths or objects

  /// parts: an object with these keys; `read` reads what it names. Throws BadInput.
  InstrumentMaker (*make)(const JsonObject& parts, const ReadFile& read);
};

[[nodiscard]] std::span<const MadeOfParts> all_made_of_parts();

/// The one of that name, or null.
[[nodiscard]] const MadeOfParts* made_of_parts(std::string_view name);

/// The instrument of the text of a file. `file` stands in messages; `read` reads what the text names. Throws
/// BadInput.
[[nodiscard]] InstrumentMaker maker_of_text(std::string_view text, const std::string& file, const ReadFile& read);

/// The same with materials that several files have in common.
[[nodiscard]] InstrumentMaker maker_of_text(std::string_view text, const std::string& file, const ReadFile& read,
                                            DesignedMaterials& materials);

/// One key of the keyboard on a body in the text of a file, which plays it as the whole keyboard does while nothing
/// else sounds. Throws BadInput.
[[nodiscard]] InstrumentMaker maker_of_key(std::string_view text, const std::string& file, const ReadFile& read,
                                           int key);

/// The instrument that ships under a name, or nothing.
[[nodiscard]] std::optional<InstrumentMaker> maker_of_shipped(const std::string& name);

}  // namespace contactspline
