// SPDX-License-Identifier: MIT
// The strings and hammers of the reference (Chaigne and Askenfelt, JASA 1994), and splines for them.
#pragma once

#include <string>
#include <vector>

#include "contactspline/models/hammer_string.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/spline/contact_spline.hpp"

namespace contactspline::testing {

struct StruckString {
  std::string name;
  StiffString string;
  double hammer_kg;
  PowerLaw felt;
  double strike_m;
};

inline StruckString struck_string(std::string name, double length_m, double mass_kg, double tension_n, double epsilon,
                                  double hammer_kg, PowerLaw felt) {
  const double bending = epsilon * tension_n * length_m * length_m;
  return {std::move(name), {length_m, mass_kg, tension_n, bending, {0.5, 1e-4}}, hammer_kg, felt, 0.12 * length_m};
}

inline StruckString c2() {
  return struck_string("C2", 1.9, 0.035, 750, 7.5e-6, 0.0049, {4e8, 2.3});
}
inline StruckString c4() {
  return struck_string("C4", 0.62, 0.00393, 670, 3.82e-5, 0.00297, {4.5e9, 2.5});
}
inline StruckString c7() {
  return struck_string("C7", 0.09, 0.000467, 750, 8.67e-4, 0.0022, {5e11, 3.0});
}

inline std::vector<ResonatorMode> struck_modes(const StruckString& struck, double max_frequency_hz) {
  const Resonator resonator{struck.name, "", struck.string, {struck.strike_m}, {0.4 * struck.string.length_m}, 1000};
  return modes_of(resonator, max_frequency_hz).modes;
}

/// Modes below half of 44.1 kHz, whatever the rate they are run at.
inline std::vector<ResonatorMode> audible_modes(const StruckString& struck) {
  return struck_modes(struck, 22050);
}

inline std::vector<double> wavenumbers_of(const std::vector<ResonatorMode>& modes) {
  std::vector<double> values;
  for (const auto& mode : modes) values.push_back(mode.wavenumber_per_m);
  return values;
}

template <typename T>
ModeShapes<T> shapes(const std::vector<ResonatorMode>& modes, double ResonatorMode::*shape) {
  ModeShapes<T> shapes(modes.size());
  for (std::size_t i = 0; i < modes.size(); ++i) shapes[i] = static_cast<T>(modes[i].*shape);
  return shapes;
}

/// Spline of a felt up to what a hammer of its mass compresses at 6 m/s on a rigid barrier.
inline std::vector<Segment<double>> felt_table(const StruckString& struck, int segments) {
  const double range = struck.felt.max_compression(struck.hammer_kg, 6.0);
  return segment_table(uniform_spline({"felt", "", struck.felt, {}, {segments, range}}, "felt"));
}

}  // namespace contactspline::testing
