// SPDX-License-Identifier: MIT
// Emits a designed material as source text: Faust library, C++ header or JSON.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "generator/emit/emitter.hpp"
#include "generator/spline/design.hpp"

namespace contactspline {

/// The source text of a design. It quotes `command`, which must not contain an absolute path. Every number reads back
/// to the same bits; measured errors are rounded to four digits, and to 0 below 1e-12. The same input gives the same
/// bytes on every machine.
[[nodiscard]] std::string emit(const Emitter& emitter, const Design& design, std::string_view command);

/// The definitions of Faust that give a material its memories, empty for none.
[[nodiscard]] std::string faust_memory(std::span<const Memory> memories, std::string_view indent);

}  // namespace contactspline
