// SPDX-License-Identifier: MIT
// A keyboard as source text: Faust library, C++ header, JSON.
#pragma once

#include <string>
#include <string_view>

#include "generator/emit/emitter.hpp"
#include "generator/resonator/keyboard.hpp"

namespace contactspline {

/// Source text of a keyboard: the strings and felts of all its keys and, if it has a body, the body's modes below
/// `max_frequency_hz`. resonators: as resonators_of() reads them. Throws BadInput as note_of() does.
[[nodiscard]] std::string emit(const Emitter& emitter, const Keyboard& keyboard, const KeyboardResonators& resonators,
                               double max_frequency_hz, std::string_view command);

}  // namespace contactspline
