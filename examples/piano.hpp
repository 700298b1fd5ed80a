// SPDX-License-Identifier: MIT
// A piano as a plug-in would hold it: only the constructor allocates; `process` is for the audio callback.
#pragma once

#include <cstddef>
#include <span>

#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"

/// A key goes down or up, `time` samples after the beginning of a block.
struct KeyEvent {
  std::size_t time;
  int key;         ///< as MIDI counts them; keys that a piano lacks are ignored
  float velocity;  ///< 0: up; up to 1: down
};

/// The piano that ships, on its soundboard, with events and at the level of audio. Its pedals are those of
/// KeyboardOnBody.
class Piano : public contactspline::KeyboardInstrument<contactspline::keyboards::piano, float> {
 public:
  using Keys = contactspline::keyboards::piano;
  using Instrument = contactspline::KeyboardInstrument<Keys, float>;
  using Instrument::Instrument;

  static constexpr float kGain = 12;  ///< full scale per m/s of the soundboard

  /// Plays a block in stereo. No allocation, no lock, bounded time.
  void process(std::span<float> left, std::span<float> right) {
    Instrument::process(left, right);
    for (float& sample : left) sample *= kGain;
    for (float& sample : right) sample *= kGain;
  }

  /// Plays a block in mono, events in the order of their times, all within the block.
  void process(std::span<const KeyEvent> events, std::span<float> output) {
    std::size_t done = 0;
    for (const KeyEvent& event : events) {
      Instrument::process(output.subspan(done, event.time - done));
      done = event.time;
      event.velocity > 0 ? note_on(event.key, static_cast<double>(event.velocity)) : note_off(event.key);
    }
    Instrument::process(output.subspan(done));
    for (float& sample : output) sample *= kGain;
  }
};
