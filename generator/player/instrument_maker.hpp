// SPDX-License-Identifier: MIT
// Instruments of scores and of files, made at run time.
#pragma once

#include <concepts>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

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
[[nodiscard]] InstrumentMaker maker_of_voice(Model model, Voice voice);

/// A mass before a rigid barrier, of the material's impact, or of 3 g where it has none. parts: an object whose key
/// `material` is the name of one that ships, a path or an object. `read` reads what it names. Throws BadInput.
[[nodiscard]] InstrumentMaker maker_of_mass_barrier(const JsonObject& parts, const ReadFile& read);

/// A keyboard on its body, with all keys; designs their felts, which takes some seconds. keyboard: as JSON, the name
/// of one that ships, a path or an object. `file` stands in messages; `read` reads what it names. Throws BadInput.
[[nodiscard]] InstrumentMaker maker_of_keyboard(const std::string& keyboard, const std::string& file,
                                                const ReadFile& read);

/// The instrument of the text of a file. `file` stands in messages; `read` reads what the text names. Throws
/// BadInput.
[[nodiscard]] InstrumentMaker maker_of_text(std::string_view text, const std::string& file, const ReadFile& read);

/// The same with materials that several files have in common.
[[nodiscard]] InstrumentMaker maker_of_text(std::string_view text, const std::string& file, const ReadFile& read,
                                            DesignedMaterials& materials);

/// The instrument that ships under a name, or nothing.
[[nodiscard]] std::optional<InstrumentMaker> maker_of_shipped(const std::string& name);

}  // namespace contactspline
