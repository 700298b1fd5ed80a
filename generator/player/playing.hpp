// SPDX-License-Identifier: MIT
// Plays an instrument into arrays.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <functional>
#include <span>
#include <stdexcept>
#include <vector>

#include "contactspline/step/flush_denormals.hpp"
#include "generator/player/any_instrument.hpp"

namespace contactspline {

enum class Action : int { kStrike, kRelease, kPluck, kNoteOn, kNoteOff, kSet };

/// Thrown where a sound is not finite.
struct NotFinite : std::runtime_error {
  NotFinite() : std::runtime_error("the sound is not finite") {}
};

/// A timed event: at a sample an event of the instrument, a key or a parameter takes a value. A speed
/// or force that is NaN is the value that the parameter of the event has then.
struct Happening {
  std::size_t sample;
  Action action;
  std::size_t number;
  double value;
  double rise_s;  ///< of a pluck
};

/// The speed or force of a blow or pluck.
template <std::floating_point T>
[[nodiscard]] T value_of(const AnyInstrument<T>& instrument, const Happening& now) {
  if (std::isnan(now.value))
    for (const Event& event : instrument.events())
      if ((event.kind == EventKind::kStrike) == (now.action == Action::kStrike) && event.number == now.number)
        return static_cast<T>(instrument.value(event.parameter));
  return static_cast<T>(now.value);
}

template <std::floating_point T>
void play(AnyInstrument<T>& instrument, const Happening& now) {
  switch (now.action) {
    case Action::kStrike:
      return instrument.strike(now.number, value_of(instrument, now));
    case Action::kRelease:
      return instrument.release(now.number);
    case Action::kPluck:
      return instrument.pluck(now.number, value_of(instrument, now), now.rise_s);
    case Action::kNoteOn:
      return instrument.note_on(static_cast<int>(now.number), now.value);
    case Action::kNoteOff:
      return instrument.note_off(static_cast<int>(now.number));
    case Action::kSet:
      return instrument.set(now.number, now.value);
  }
}

/// Where a rendering goes: an array of the length of the sound for each output, empty where nobody wants it; the
/// contact force; the stored energy after every block of energy_step samples (0: never).
template <std::floating_point T>
struct Recording {
  std::vector<std::span<T>> outputs;
  std::span<T> force;
  std::span<double> energy = {};
  std::size_t energy_step = 0;
};

/// Renders a prepared instrument. happenings: by rising sample. `watch` is called in every block, and may throw to
/// stop. Throws NotFinite where a sample is not.
template <std::floating_point T>
void render(AnyInstrument<T>& instrument, std::span<const Happening> happenings, std::size_t samples,
            const Recording<T>& recording, const std::function<void()>& watch) {
  constexpr std::size_t kBlock = 1024;
  const FlushDenormals flushed;
  std::vector<std::span<T>> block(recording.outputs.size());
  std::size_t next = 0;
  for (std::size_t begin = 0; begin < samples;) {
    watch();
    for (; next < happenings.size() && happenings[next].sample <= begin; ++next) play(instrument, happenings[next]);
    std::size_t length = std::min(kBlock, samples - begin);
    if (next < happenings.size()) length = std::min(length, happenings[next].sample - begin);
    const std::size_t step = recording.energy_step;
    if (step > 0) length = std::min(length, step - begin % step);
    for (std::size_t o = 0; o < block.size(); ++o)
      block[o] = recording.outputs[o].empty() ? std::span<T>() : recording.outputs[o].subspan(begin, length);
    instrument.process(block, recording.force.empty() ? std::span<T>() : recording.force.subspan(begin, length));
    for (const std::span<T> part : block)
      for (const T sample : part)
        if (!std::isfinite(sample)) throw NotFinite();
    begin += length;
    if (step > 0 && begin % step == 0) recording.energy[begin / step - 1] = instrument.energy();
  }
}

}  // namespace contactspline
