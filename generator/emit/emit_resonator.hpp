// SPDX-License-Identifier: MIT
// Emits the modes of a resonator as source text: Faust library, C++ header or JSON.
#pragma once

#include <string>
#include <string_view>

#include "generator/emit/emitter.hpp"
#include "generator/resonator/resonator.hpp"

namespace contactspline {

/// The source text of the modes below `max_frequency_hz`. It quotes `command`, which must not contain an absolute
/// path. Numbers are rounded to 13 digits, so the same input gives the same bytes on every machine.
[[nodiscard]] std::string emit(const Emitter& emitter, const Resonator& resonator, double max_frequency_hz,
                               std::string_view command);

}  // namespace contactspline
