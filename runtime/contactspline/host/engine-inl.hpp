// SPDX-License-Identifier: MIT
// The engine in one precision: engine_float.cpp and engine_double.cpp compile it.
#pragma once

#include <concepts>
#include <memory>
#include <utility>

#include "contactspline/host/engine.hpp"
#include "contactspline/instrument/hammer_string_instrument.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/instrument/mass_barrier_instrument.hpp"
#include "contactspline/instrument/network_instrument.hpp"
#include "contactspline/instrument/voices.hpp"

namespace contactspline {
namespace detail {

/// What lives at least as long as the instrument that only looks at it.
struct Owned {
  std::shared_ptr<const void> arrays;
};

/// An instrument of a file, with the owner of its arrays.
template <Instrument I>
class OfFile : private Owned, public I {
 public:
  OfFile(const InstrumentData& data, std::shared_ptr<const void> owner) : Owned{std::move(owner)}, I(data) {}
};

}  // namespace detail

template <std::floating_point T>
Handle<T> Engine<T>::hammer_string(HammerStringParts parts) {
  return handle_of<HammerStringInstrument<T>>(std::move(parts));
}
template <std::floating_point T>
Handle<T> Engine<T>::mass_barrier(MassBarrierParts parts) {
  return handle_of<MassBarrierInstrument<T>>(std::move(parts));
}
template <std::floating_point T>
Handle<T> Engine<T>::keyboard(std::shared_ptr<const KeyboardParts> parts) {
  return handle_of<PedaledKeyboard<T>>(std::move(parts));
}
template <std::floating_point T>
Handle<T> Engine<T>::network(const InstrumentData& data, std::shared_ptr<const void> arrays) {
  if (data.keyed.ranges.empty()) return handle_of<detail::OfFile<NetworkInstrument<T>>>(data, std::move(arrays));
  return handle_of<detail::OfFile<Voices<NetworkInstrument<T>>>>(data, std::move(arrays));
}

}  // namespace contactspline
