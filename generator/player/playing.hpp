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

#include "contactspline/host/any_instrument.hpp"
#include "contactspline/step/flush_denormals.hpp"

namespace contactspline {

/// Thrown where a sound is not finite.
struct NotFinite : std::runtime_error {
  NotFinite() : std::runtime_error("the sound is not finite") {}
};

/// Where a rendering goes: an array of the length of the sound for each output, empty where nobody wants it; the
/// contact force; the stored energy after every block of energy_step samples (0: never).
template <std::floating_point T>
struct Recording {
  std::vector<std::span<T>> outputs;
  std::span<T> force;
  std::span<double> energy = {};
  std::size_t energy_step = 0;
};

/// Renders a prepared instrument. events: by rising sample. `watch` is called in every block, and may throw to
/// stop. Throws NotFinite where a sample is not.
template <std::floating_point T>
void render(AnyInstrument<T>& instrument, std::span<const TimedEvent> events, std::size_t samples,
            const Recording<T>& recording, const std::function<void()>& watch) {
  constexpr std::size_t kBlock = 1024;
  const FlushDenormals flushed;
  std::vector<std::span<T>> block(recording.outputs.size());
  std::size_t next = 0;
  for (std::size_t begin = 0; begin < samples;) {
    watch();
    for (; next < events.size() && events[next].sample <= begin; ++next) instrument.play(events[next]);
    std::size_t length = std::min(kBlock, samples - begin);
    if (next < events.size()) length = std::min(length, events[next].sample - begin);
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
