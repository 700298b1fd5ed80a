// SPDX-License-Identifier: MIT
// Instruments of emitted materials and resonators, which are built without arguments, as hosts ask for.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <span>
#include <vector>

#include "contactspline/instrument/fret_string_instrument.hpp"
#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/instrument/mass_barrier_instrument.hpp"
#include "contactspline/instrument/slide_string_instrument.hpp"

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

/// The outputs that hosts have of a string.
[[nodiscard]] constexpr std::span<const Output> outputs_for_hosts() {
  return std::span(StringOutputs<double>::kList).first(StringOutputs<double>::kOfHosts);
}

}  // namespace detail

/// A mass at a barrier of an emitted material.
template <typename Material, std::floating_point T>
class MassBarrierOf : public MassBarrierInstrument<T> {
 public:
  explicit MassBarrierOf(double mass_kg = 0.003)
      : MassBarrierInstrument<T>(
            {detail::table_of<Material>(), mass_kg, Material::loss_s_per_m, detail::memories_in<Material>()}) {}
};

/// A hammer of an emitted felt on an emitted string.
template <typename Felt, typename String, std::floating_point T>
class HammerStringOf : public HammerStringInstrument<T> {
 public:
  explicit HammerStringOf(double hammer_mass_kg = 0.00297)
      : HammerStringInstrument<T>({string_parts<String>(),
                                   detail::table_of<Felt>(),
                                   hammer_mass_kg,
                                   Felt::loss_s_per_m,
                                   {},
                                   detail::memories_in<Felt>()}) {}
  static std::span<const Output> outputs() { return detail::outputs_for_hosts(); }
};

/// A slide of an emitted material on an emitted string.
template <typename Slide, typename String, std::floating_point T>
class SlideStringOf : public SlideStringInstrument<T> {
 public:
  SlideStringOf()
      : SlideStringInstrument<T>({string_parts<String>(), detail::table_of<Slide>(), Slide::loss_s_per_m, 0,
                                  detail::memories_in<Slide>()}) {}
  static std::span<const Output> outputs() { return detail::outputs_for_hosts(); }
};

/// An emitted string over a fret of an emitted material.
template <typename Fret, typename String, std::floating_point T>
class FretStringOf : public FretStringInstrument<T> {
 public:
  FretStringOf()
      : FretStringInstrument<T>(
            {string_parts<String>(), detail::table_of<Fret>(), Fret::loss_s_per_m, 0, detail::memories_in<Fret>()}) {}
  static std::span<const Output> outputs() { return detail::outputs_for_hosts(); }
};

}  // namespace contactspline
