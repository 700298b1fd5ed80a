// SPDX-License-Identifier: MIT
// What instruments of one contact are built of: a resonator at one sample rate, its contact and its outputs.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/parameter.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline {

/// The outputs of instruments of one resonator and one contact: displacement and velocity at the pickup, contact
/// force, and, where there is a bridge, the force on it.
struct StringOutput {
  enum : std::size_t { kDisplacement, kForce, kVelocity, kBridge, kOutputs };
  static constexpr std::array<Output, kOutputs> kList = {{{"displacement_m", "m", 0.001},
                                                          {"contact_force_n", "N", 50},
                                                          {"velocity_m_per_s", "m/s", 1},
                                                          {"bridge_force_n", "N", 50}}};
  static constexpr std::size_t kOfHosts = 2;  ///< so many of them hosts have: the kernels compute these together
};

/// A damper: the extra decay of every mode while it is down [1/s], and the time constant with which it comes down
/// [s], > 0.
struct Damper {
  double damping_per_s = 60;
  double time_s = 0.005;
};

/// Modes and what is read from them. All vectors are empty or have one entry for each mode.
struct ResonatorParts {
  std::vector<Mode> modes;
  std::vector<double> wavenumbers_per_m;  ///< of a string: the shape is sin(wavenumber x)
  std::vector<double> pickup;             ///< shapes
  std::vector<double> bridge;             ///< force on the bridge per modal displacement [N/m]; empty: it has none
  double length_m = 0;                    ///< up to where a place may lie; 0: places have no meaning
  double strike_m = 0;                    ///< place of the first strike
  /// Writes the shapes under a hammer at a place. Must not allocate if the place moves on an audio thread.
  std::function<void(double place_m, std::span<double> shapes)> strike_shapes;
  std::optional<StiffString> string = {};            ///< whose tension can be bent
  std::size_t max_outputs = StringOutput::kOutputs;  ///< so many of StringOutput::kList are offered

  /// The outputs that it offers.
  [[nodiscard]] std::span<const Output> outputs() const {
    const std::size_t all = bridge.empty() ? StringOutput::kBridge : StringOutput::kOutputs;
    return std::span(StringOutput::kList).first((std::min)(all, max_outputs));
  }
};

/// What a hammer-string is built of.
struct HammerStringParts {
  ResonatorParts resonator;
  std::vector<Segment<double>> felt;  ///< segment table
  double hammer_mass_kg;
  double loss_s_per_m = 0;
  Damper damper = {};
  std::vector<Memory> memories = {};  ///< of the felt
};

/// What a mass-barrier is built of.
struct MassBarrierParts {
  std::vector<Segment<double>> contact;  ///< segment table
  double mass_kg;
  double loss_s_per_m = 0;
  std::vector<Memory> memories = {};  ///< of the material
};

/// The strings that modes belong to, from frequencies and decays of the first and the last mode of the string that is
/// tuned lowest, and from the first mode of each of the others.
[[nodiscard]] inline StiffString stiff_string_of(const ResonatorParts& parts) {
  const std::vector<double>& wavenumbers = parts.wavenumbers_per_m;
  const double mass_kg = 2 * parts.modes.front().mass_kg, length_m = parts.length_m;
  const auto square = [&](std::size_t i) { return wavenumbers[i] * wavenumbers[i]; };
  // mu w0^2/beta^2 = T + EI beta^2
  const auto tension_at = [&](std::size_t i) {
    return mass_kg / length_m * stiffness_of(parts.modes[i]) / parts.modes[i].mass_kg / square(i);
  };
  // The lowest string has the highest wavenumber, and of those that share it the lowest frequency.
  const auto last = static_cast<std::size_t>(std::ranges::max_element(wavenumbers) - wavenumbers.begin());
  const double squares = square(last) - square(0);  // [1/m^2]
  const double stiffness = last == 0 ? 0 : (tension_at(last) - tension_at(0)) / squares;
  const double quadratic = last == 0 ? 0 : (parts.modes[last].decay_per_s - parts.modes[0].decay_per_s) / squares;
  StiffString string{length_m,
                     mass_kg,
                     tension_at(0) - stiffness * square(0),
                     stiffness,
                     {parts.modes[0].decay_per_s - quadratic * square(0), quadratic},
                     {}};
  for (std::size_t i = 0; i < wavenumbers.size(); ++i)
    if (wavenumbers[i] == wavenumbers[0])
      string.detuning_cents.push_back(600 * std::log2((tension_at(i) - stiffness * square(0)) / string.tension_n));
  return string;
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
  parts.strike_m = Resonator::strike_position_m;
  for (std::size_t i = 0; i < parts.modes.size(); ++i) {
    const StringMode row{parts.modes[i], parts.wavenumbers_per_m[i]};
    const double angle = row.wavenumber_per_m * parts.length_m;
    parts.bridge.push_back(-2 * stiffness_of(row.mode) / angle * std::cos(angle));
  }
  parts.string = stiff_string_of(parts);
  parts.strike_shapes = [](double place_m, std::span<double> shapes) {
    for (std::size_t i = 0; i < shapes.size(); ++i)
      shapes[i] = std::sin(Resonator::wavenumbers[i] * place_m) / Resonator::strings;
  };
  return parts;
}

}  // namespace contactspline
