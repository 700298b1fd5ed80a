// SPDX-License-Identifier: MIT
// Instruments of emitted materials and resonators, which are built without arguments, as hosts ask for.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/instrument/ensemble_instrument.hpp"
#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/instrument/mass_barrier_instrument.hpp"

namespace contactspline {

namespace detail {

template <typename Material>
[[nodiscard]] std::vector<Segment<double>> table_of() {
  return {segments_of<Material, double>.begin(), segments_of<Material, double>.end()};
}

template <typename Material>
[[nodiscard]] std::vector<Memory> memories_in() {
  return {memories_of<Material>.begin(), memories_of<Material>.end()};
}

/// Strings under a hammer of an emitted felt.
template <typename Felt>
[[nodiscard]] HammerStringParts under_felt(ResonatorParts strings, double hammer_mass_kg, const Damper& damper = {}) {
  strings.max_outputs = StringOutput::kOfHosts;
  return {std::move(strings), table_of<Felt>(), hammer_mass_kg, Felt::loss_s_per_m, damper, memories_in<Felt>()};
}

}  // namespace detail

/// A mass at a barrier of an emitted material.
template <typename Material, std::floating_point T>
class MassBarrierOf : public MassBarrierInstrument<T> {
 public:
  explicit MassBarrierOf(double mass_kg = 0.003) : MassBarrierInstrument<T>(parts(mass_kg)) {}
  static MassBarrierParts parts(double mass_kg = 0.003) {
    return {detail::table_of<Material>(), mass_kg, Material::loss_s_per_m, detail::memories_in<Material>()};
  }
};

/// A hammer of an emitted felt on an emitted string.
template <typename Felt, typename String, std::floating_point T>
class HammerStringOf : public HammerStringInstrument<T> {
 public:
  explicit HammerStringOf(double hammer_mass_kg = 0.00297) : HammerStringInstrument<T>(parts(hammer_mass_kg)) {}
  static HammerStringParts parts(double hammer_mass_kg = 0.00297) {
    return detail::under_felt<Felt>(string_parts<String>(), hammer_mass_kg);
  }
};

/// Hammers of an emitted felt on strings at the keys 48 to 72. The emitted one is that of key 60; the others have its
/// length and another tension. It may be a course of several strings.
template <typename Felt, typename String, std::floating_point T>
class EnsembleOf : public EnsembleInstrument<T> {
 public:
  explicit EnsembleOf(double hammer_mass_kg = 0.00297) : EnsembleInstrument<T>(parts(hammer_mass_kg)) {}

 private:
  static EnsembleParts parts(double hammer_mass_kg) {
    EnsembleParts parts{.strings = {}, .first_key = 48};
    for (int key = parts.first_key; key <= 72; ++key) {
      ResonatorParts string = string_parts<String>();
      for (std::size_t i = 0; i < string.modes.size(); ++i) {
        const StringMode row{string.modes[i], string.wavenumbers_per_m[i]};
        string.modes[i] = retuned(*string.string, row, 100 * (key - 60));
      }
      parts.strings.push_back(detail::under_felt<Felt>(std::move(string), hammer_mass_kg));
    }
    return parts;
  }
};

}  // namespace contactspline
