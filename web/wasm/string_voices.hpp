// SPDX-License-Identifier: MIT
// The strings that ship, of which a voice of a score may have one of its own.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <utility>

#include "contactspline/instrument/instruments_of.hpp"
#include "generated/guitar_a2.hpp"
#include "generated/guitar_b3.hpp"
#include "generated/guitar_d3.hpp"
#include "generated/guitar_e2.hpp"
#include "generated/guitar_e4.hpp"
#include "generated/guitar_g3.hpp"
#include "generated/steel_on_steel.hpp"

namespace contactspline::web {

struct NamedString {
  const char* name;
  ResonatorParts (*parts)();
};

inline constexpr std::array kStrings = {NamedString{"guitar_e2", string_parts<resonators::guitar_e2>},
                                        NamedString{"guitar_a2", string_parts<resonators::guitar_a2>},
                                        NamedString{"guitar_d3", string_parts<resonators::guitar_d3>},
                                        NamedString{"guitar_g3", string_parts<resonators::guitar_g3>},
                                        NamedString{"guitar_b3", string_parts<resonators::guitar_b3>},
                                        NamedString{"guitar_e4", string_parts<resonators::guitar_e4>}};

/// A string that meets steel, as slide and frets are in all scores.
inline PluckedStringParts at_steel(ResonatorParts string) {
  using Steel = materials::steel_on_steel;
  return {std::move(string), detail::table_of<Steel>(), Steel::loss_s_per_m, 0, detail::memories_in<Steel>()};
}

/// Tunes a string by its tension, and leaves out modes that are too high for the sample rate then.
inline void tune(ResonatorParts& string, double cents, double sample_rate_hz) {
  for (std::size_t i = 0; i < string.modes.size(); ++i) {
    const double before = stiffness_of(string.modes[i]);
    const StringMode row{string.modes[i], string.wavenumbers_per_m[i]};
    string.modes[i] = retuned(*string.string, row, cents);
    string.bridge[i] *= stiffness_of(string.modes[i]) / before;
  }
  const auto is_too_high = [&](const Mode& mode) {
    return mode.angular_frequency_rad_per_s >= std::numbers::pi * sample_rate_hz;
  };
  const auto count = static_cast<std::size_t>(std::ranges::find_if(string.modes, is_too_high) - string.modes.begin());
  string.modes.resize(count);
  for (auto* const values : {&string.wavenumbers_per_m, &string.pickup, &string.bridge}) values->resize(count);
}

}  // namespace contactspline::web
