// SPDX-License-Identifier: MIT
// Emitted structs of the format version that this runtime reads plus OFFSET, and one use of them, USE.
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_live.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/models/keyboard.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "contactspline/step/live_exponent.hpp"

namespace contactspline {
namespace {

template <typename Emitted>
struct Versioned : Emitted {
  static constexpr int format_version = kFormatVersion + OFFSET;
};
using Material = Versioned<materials::felt_live>;
using Resonator = Versioned<resonators::string_c4>;
using Keyboard = Versioned<keyboards::piano>;

[[maybe_unused]] void use() {
  static_cast<void>(USE);
}

}  // namespace
}  // namespace contactspline
