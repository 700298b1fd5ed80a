// SPDX-License-Identifier: MIT
// A keyboard as source text: Faust library, C++ header, JSON.
#pragma once

#include <string>
#include <string_view>

#include "generator/emit/emitter.hpp"
#include "generator/resonator/keyboard.hpp"

namespace contactspline {

/// Source text of a keyboard: the strings and felts of all its keys. Throws BadInput as note_of() does.
[[nodiscard]] std::string emit(const Emitter& emitter, const Keyboard& keyboard, std::string_view command);

}  // namespace contactspline
