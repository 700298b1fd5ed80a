// SPDX-License-Identifier: MIT
// Designed contacts, resonators and keyboards as source text: Faust library, C++ header, JSON.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "generator/keyboard.hpp"
#include "generator/material.hpp"
#include "generator/quality.hpp"
#include "generator/resonator.hpp"
#include "generator/spline.hpp"

namespace contactspline {

/// A material with its spline and the measured quality: what is emitted, inspected and drawn.
struct Design {
  Material material;
  Spline spline;
  Quality quality;
};

/// Material to quality in one go; `read` gives the files a material names. Throws BadInput.
[[nodiscard]] Design design_contact(std::string_view material_text, std::string_view file,
                                    const ReadFile& read = shipped_file);

/// One output format of `generate`.
struct Emitter {
  std::string_view name;       ///< as in --emit
  std::string_view extension;  ///< of the written file, and of its template
};

/// faust, cpp and json.
[[nodiscard]] std::span<const Emitter> emitters();

/// Source text of a design. `command` is quoted in it and must hold no absolute path. Every number reads back to the
/// same bits; quality figures are rounded to four digits, below 1e-12 to zero. Same input, same bytes, on any
/// machine.
[[nodiscard]] std::string emit(const Emitter& emitter, const Design& design, std::string_view command);

/// Source text of a resonator's modes below `max_frequency_hz`, rounded to 13 digits for the same reason.
[[nodiscard]] std::string emit(const Emitter& emitter, const Resonator& resonator, double max_frequency_hz,
                               std::string_view command);

/// Source text of a keyboard: the strings and felts of all its keys. Throws BadInput as note_of() does.
[[nodiscard]] std::string emit(const Emitter& emitter, const Keyboard& keyboard, std::string_view command);

}  // namespace contactspline
