// SPDX-License-Identifier: MIT
// The concept of an instrument. What is written over it, plays every model: scores and MIDI, Faust's dsp, plug-ins,
// the page, the tests. A model of one's own that meets it has all of them (docs/how-to/model.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>

#include "contactspline/data/parameter.hpp"

namespace contactspline {

/// Arrays that a block of outputs is written to, one for each output; an empty one is not computed. All others have
/// the length of the block.
template <std::floating_point T>
using Outputs = std::span<const std::span<T>>;

/// name(), description()     text: identifier, one line
/// parameters(), events(), outputs(), presets()     the lists, which prepare() does not change
/// prepare(sample_rate_hz)   brings it to rest at a rate; allocates. All below is safe on an audio thread:
/// set(parameter, value)     moves the value into its range; one that is not a number does nothing
/// value(parameter)          what acts or will act at the next note
/// note_on(key, velocity)    a key of MIDI, velocity 0 to 1; keys that it lacks do nothing
/// note_off(key)
/// strike(number, speed)     [m/s]; 0 lifts the damper without a blow
/// release(number)           lowers the damper of a strike
/// pluck(number, force, rise)     [N], within a time [s]
/// process(outputs, force)   a block of any length; unless `force` is empty, also the force of its contacts [N]
/// reset()                   brings it to rest; parameters stay
/// is_silent(limit)          does nothing move on its own, and is the energy below a limit [J]?
/// energy()                  stored [J]
/// It may also have is_at_rest(limit): do loads hold all still, but for a kinetic energy below a limit [J]? And
/// event_of(key): the event that a key of MIDI plays, if it plays one; or, without events, has_key(key). And an
/// input, process(outputs, force, input): a force on its body over each sample [N], an empty span for none; and
/// input_scale_n(): the force that hosts play as 1 [N].
template <typename I>
concept Instrument = std::floating_point<typename I::value_type> &&
    requires(I& i, const I& c, typename I::value_type x, Outputs<typename I::value_type> outputs,
             std::span<typename I::value_type> force) {
  { c.name() } -> std::convertible_to<const char*>;
  { c.description() } -> std::convertible_to<const char*>;
  { c.parameters() } -> std::convertible_to<std::span<const Parameter>>;
  { c.events() } -> std::convertible_to<std::span<const Event>>;
  { c.outputs() } -> std::convertible_to<std::span<const Output>>;
  { c.presets() } -> std::convertible_to<std::span<const Preset>>;
  i.prepare(44100.0);
  i.set(std::size_t{}, 0.5);
  { c.value(std::size_t{}) } -> std::same_as<double>;
  i.note_on(60, 0.5);
  i.note_off(60);
  i.strike(std::size_t{}, x);
  i.release(std::size_t{});
  i.pluck(std::size_t{}, x, 0.004);
  i.process(outputs, force);
  i.reset();
  { c.is_silent(1e-14) } -> std::same_as<bool>;
  { c.energy() } -> std::same_as<double>;
};

/// Is motion as small beside what is stored as where loads hold all still? Where all decays to nothing it never is.
[[nodiscard]] constexpr bool is_held_by_loads(double kinetic_j, double energy_j) {
  return kinetic_j < 1e-6 * energy_j;
}

/// SPDX identifier of the licence of an instrument: its license(), MIT if it has none.
template <Instrument I>
[[nodiscard]] const char* license_of(const I& instrument) {
  if constexpr (requires { instrument.license(); })
    return instrument.license();
  else
    return "MIT";
}

/// Full scale of the input of an instrument [N]; 0: it has none.
template <Instrument I>
[[nodiscard]] double input_scale_of(const I& instrument) {
  if constexpr (requires { instrument.input_scale_n(); })
    return instrument.input_scale_n();
  else
    return 0;
}

/// Advances a block of an instrument under a force on its body [N], of a block's length or empty. One without an
/// input ignores it.
template <Instrument I>
void process_under(I& instrument, Outputs<typename I::value_type> outputs, std::span<typename I::value_type> force,
                   [[maybe_unused]] std::span<const typename I::value_type> input) {
  if constexpr (requires { instrument.process(outputs, force, input); })
    instrument.process(outputs, force, input);
  else
    instrument.process(outputs, force);
}

/// The event that a key of MIDI plays, if the instrument knows it.
template <Instrument I>
[[nodiscard]] std::optional<std::size_t> event_of(const I& instrument, int key) {
  if constexpr (requires { instrument.event_of(key); })
    return instrument.event_of(key);
  else
    return {};
}

/// Does a key of MIDI play? All do where the instrument does not say.
template <Instrument I>
[[nodiscard]] bool has_key(const I& instrument, int key) {
  if constexpr (requires { instrument.has_key(key); })
    return instrument.has_key(key);
  else if constexpr (requires { instrument.event_of(key); })
    return instrument.event_of(key).has_value();
  else
    return true;
}

}  // namespace contactspline
