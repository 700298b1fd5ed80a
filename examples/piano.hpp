// SPDX-License-Identifier: MIT
// A piano as a plug-in would hold it: all that allocates is in the constructor, `process` is the audio callback.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/keyboard.hpp"
#include "contactspline/keyboards/piano.hpp"

/// A key goes down or up, so many samples after the beginning of a block.
struct KeyEvent {
  std::size_t time;
  int key;         ///< as MIDI counts them; keys that a piano lacks are ignored
  float velocity;  ///< 0: up; up to 1: down
};

class Piano {
 public:
  /// Allocates everything: not for the audio thread.
  explicit Piano(double sample_rate_hz) {
    keys_.reserve(Keys::keys);
    for (int key = Keys::first_key; key < kEnd; ++key) keys_.push_back({Voice(key, sample_rate_hz, kModes)});
  }

  /// Plays a block, events in the order of their times, all within the block. No allocation, no lock, bounded time.
  void process(std::span<const KeyEvent> events, std::span<float> output) {
    std::size_t done = 0;
    for (const KeyEvent& event : events) {
      process(output.subspan(done, event.time - done));
      done = event.time;
      take(event);
    }
    process(output.subspan(done));
    for (Key& key : keys_)
      if (!key.is_down && key.voice.is_silent()) key.sounds = false;
  }

 private:
  using Keys = contactspline::keyboards::piano;
  using Voice = contactspline::KeyboardVoice<Keys, float>;

  struct Key {
    Voice voice;
    bool is_down = false;
    bool sounds = false;  // a silent key costs nothing
  };

  static constexpr int kEnd = Keys::first_key + static_cast<int>(Keys::keys);
  static constexpr std::size_t kBlock = 128;  // samples
  static constexpr std::size_t kModes = 80;   // of a string, at most
  static constexpr float kGain = 0.02f;       // full scale per newton

  void take(const KeyEvent& event) {
    if (event.key < Keys::first_key || event.key >= kEnd) return;
    Key& key = keys_[static_cast<std::size_t>(event.key - Keys::first_key)];
    key.is_down = event.velocity > 0;
    if (!key.is_down) return key.voice.release();
    key.sounds = true;
    key.voice.strike(static_cast<float>(contactspline::strike_speed<Keys>(event.velocity)));
  }

  void process(std::span<float> output) {
    std::ranges::fill(output, 0.0f);
    for (; !output.empty(); output = output.subspan(std::min(kBlock, output.size()))) {
      const auto block = output.first(std::min(kBlock, output.size()));
      std::array<float, kBlock> sound;
      for (Key& key : keys_) {
        if (!key.sounds) continue;
        key.voice.process(std::span(sound).first(block.size()));
        for (std::size_t n = 0; n < block.size(); ++n) block[n] += kGain * sound[n];
      }
    }
  }

  std::vector<Key> keys_;
};
