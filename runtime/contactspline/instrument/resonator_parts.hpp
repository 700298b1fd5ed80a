// SPDX-License-Identifier: MIT
// A resonator as instruments are built of it, at one sample rate.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/instrument/parameter.hpp"
#include "contactspline/modal/stiff_string.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline {

/// Modes and what is read from them. All vectors are empty or have one entry for each mode.
struct ResonatorParts {
  std::vector<Mode> modes;
  std::vector<double> wavenumbers_per_m;  ///< of a string: the shape is sin(wavenumber x)
  std::vector<double> pickup;             ///< shapes
  std::vector<double> bridge;             ///< force on the bridge per modal displacement [N/m]; empty: it has none
  double length_m = 0;                    ///< up to where a place may lie; 0: places have no meaning
  double strike_m = 0;                    ///< place of the first strike
  double pluck_m = 0;                     ///< place of the pluck
  /// Writes the shapes under a hammer at a place. Must not allocate if the place moves on an audio thread.
  std::function<void(double place_m, std::span<double> shapes)> strike_shapes;
  std::optional<StiffString> string = {};  ///< whose tension can be bent
};

/// What a slide-string or a fret-string is built of.
struct PluckedStringParts {
  ResonatorParts resonator;              ///< a string
  std::vector<Segment<double>> contact;  ///< segment table of slide or fret
  double loss_s_per_m = 0;
  double height_m = 0;                ///< distance of the slide from the string at rest, where it begins
  std::vector<Memory> memories = {};  ///< of the material of slide or fret
};

/// The string that modes belong to: tension and bending stiffness from the frequencies of the first and the last one.
[[nodiscard]] inline StiffString stiff_string_of(const ResonatorParts& parts) {
  const double mass_kg = 2 * parts.modes.front().mass_kg, length_m = parts.length_m;
  const auto square = [&](std::size_t i) { return parts.wavenumbers_per_m[i] * parts.wavenumbers_per_m[i]; };
  // mu w0^2/beta^2 = T + EI beta^2
  const auto tension_at = [&](std::size_t i) {
    const Mode& mode = parts.modes[i];
    const double w0_square =
        mode.angular_frequency_rad_per_s * mode.angular_frequency_rad_per_s + mode.decay_per_s * mode.decay_per_s;
    return mass_kg / length_m * w0_square / square(i);
  };
  const std::size_t last = parts.modes.size() - 1;
  const double stiffness = last == 0 ? 0 : (tension_at(last) - tension_at(0)) / (square(last) - square(0));
  return {length_m, mass_kg, tension_at(0) - stiffness * square(0), stiffness, {0, 0}};
}

/// An emitted string with the places of its file. Resonator: an emitted struct, such as resonators::string_c4.
template <typename Resonator>
[[nodiscard]] ResonatorParts string_parts() {
  const auto copy = [](const auto& values) { return std::vector<double>(values.begin(), values.end()); };
  ResonatorParts parts;
  for (const Mode& mode : modes_in<Resonator>) parts.modes.push_back(mode);
  parts.wavenumbers_per_m = copy(Resonator::wavenumbers);
  parts.pickup = copy(Resonator::pickup_shapes);
  parts.length_m = std::numbers::pi / Resonator::wavenumbers[0];
  parts.strike_m = parts.pluck_m = Resonator::strike_position_m;
  for (std::size_t i = 0; i < parts.modes.size(); ++i) {
    const StringMode row{parts.modes[i], parts.wavenumbers_per_m[i]};
    const double angle = row.wavenumber_per_m * parts.length_m;
    parts.bridge.push_back(-2 * stiffness_of(row.mode) / angle * std::cos(angle));
  }
  if (Resonator::strings == 1) parts.string = stiff_string_of(parts);
  parts.strike_shapes = [](double place_m, std::span<double> shapes) {
    for (std::size_t i = 0; i < shapes.size(); ++i)
      shapes[i] = std::sin(Resonator::wavenumbers[i] * place_m) / Resonator::strings;
  };
  return parts;
}

}  // namespace contactspline
