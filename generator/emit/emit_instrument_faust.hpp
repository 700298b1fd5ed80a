// SPDX-License-Identifier: MIT
// An instrument as a Faust program.
#pragma once

#include <optional>
#include <string>

#include "generator/instrument/instrument.hpp"
#include "generator/support/text_template.hpp"

namespace contactspline {

/// Why an instrument cannot be written in Faust, or nothing if it can: no program plays a part of it, or it would
/// take too long to compile (docs/reference/instruments.md).
[[nodiscard]] std::optional<std::string> faust_obstacle(const InstrumentModel& model, const InstrumentArrays& arrays);

/// The values of templates/instrument.lib.in that are not those of every format. Expects no faust_obstacle.
[[nodiscard]] TemplateValues faust_instrument_values(const InstrumentModel& model, const InstrumentArrays& arrays);

}  // namespace contactspline
