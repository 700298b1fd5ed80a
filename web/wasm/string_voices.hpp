// SPDX-License-Identifier: MIT
// The strings that ship, of which a voice of a score may have one of its own.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/instrument/instruments_of.hpp"
#include "generated/dulcimer_g4.hpp"
#include "generated/guitar_a2.hpp"
#include "generated/guitar_b3.hpp"
#include "generated/guitar_d3.hpp"
#include "generated/guitar_e2.hpp"
#include "generated/guitar_e4.hpp"
#include "generated/guitar_g3.hpp"

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
                                        NamedString{"guitar_e4", string_parts<resonators::guitar_e4>},
                                        NamedString{"dulcimer_g4", string_parts<resonators::dulcimer_g4>}};

/// Emitted strings with another tension: all modes below half the sample rate, and what the bridge reads of them.
inline ResonatorParts tuned(const ResonatorParts& emitted, double cents, double sample_rate_hz) {
  StiffString string = *emitted.string;
  for (double& detuning : string.detuning_cents) detuning += cents;
  ResonatorParts parts{.length_m = emitted.length_m, .strike_m = emitted.strike_m, .string = string};
  for (const StringMode& row : modes_below(string, sample_rate_hz / 2)) {
    parts.modes.push_back(row.mode);
    parts.wavenumbers_per_m.push_back(row.wavenumber_per_m);
    parts.bridge.push_back(bridge_shape(string, row));
  }
  parts.pickup.resize(parts.modes.size());
  parts.strike_shapes = [wavenumbers = parts.wavenumbers_per_m,
                         strings = static_cast<double>(string.detuning_cents.size())](double place_m,
                                                                                      std::span<double> shapes) {
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i] = std::sin(wavenumbers[i] * place_m) / strings;
  };
  return parts;
}

}  // namespace contactspline::web
