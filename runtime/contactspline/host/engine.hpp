// SPDX-License-Identifier: MIT
// Instruments compiled once, in float and in double: what links ContactSpline::engine, compiles none of their parts.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <memory>
#include <type_traits>
#include <utility>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/data/string_parts.hpp"
#include "contactspline/host/any_instrument.hpp"

namespace contactspline {

/// Instruments of plain data, to be prepared. T: float or double.
template <std::floating_point T>
struct Engine {
  static Handle<T> hammer_string(HammerStringParts parts);
  static Handle<T> mass_barrier(MassBarrierParts parts);
  static Handle<T> keyboard(std::shared_ptr<const KeyboardParts> parts);
  /// What an instrument file describes, on voices where it has keys. `arrays` owns what `data` views, or is null
  /// where that lives for ever.
  static Handle<T> network(const InstrumentData& data, std::shared_ptr<const void> arrays = nullptr);
};

template <typename Keyboard, std::floating_point T>
class KeyboardInstrument;
template <typename Felt, typename String, std::floating_point T>
class HammerStringOf;
template <typename Material, std::floating_point T>
class MassBarrierOf;

namespace detail {

template <typename I>
struct Compiled {
  static Handle<typename I::value_type> make() {
    if constexpr (requires { I::data::view(); })  // an emitted class of an instrument file
      return Engine<typename I::value_type>::network(I::data::view());
    else
      return handle_of<I>();
  }
};
template <typename Keyboard, std::floating_point T>
struct Compiled<KeyboardInstrument<Keyboard, T>> {
  static auto make() { return Engine<T>::keyboard(KeyboardInstrument<Keyboard, T>::parts()); }
};
template <typename Felt, typename String, std::floating_point T>
struct Compiled<HammerStringOf<Felt, String, T>> {
  static auto make() { return Engine<T>::hammer_string(HammerStringOf<Felt, String, T>::parts()); }
};
template <typename Material, std::floating_point T>
struct Compiled<MassBarrierOf<Material, T>> {
  static auto make() { return Engine<T>::mass_barrier(MassBarrierOf<Material, T>::parts()); }
};

}  // namespace detail

/// The engine's instrument with the data of a class that the program emits, or of one of instruments_of.hpp and
/// keyboard_instrument.hpp. It plays the samples of the class. Any other class is compiled here.
template <typename I>
[[nodiscard]] Handle<typename I::value_type> compiled() {
  return detail::Compiled<I>::make();
}

}  // namespace contactspline
