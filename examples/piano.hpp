// SPDX-License-Identifier: MIT
// A piano as a plug-in would hold it: only the constructor allocates; `process` is for the audio callback.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
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
  using Keys = contactspline::keyboards::piano;

  /// Allocates everything: not for the audio thread.
  explicit Piano(double sample_rate_hz) {
    keys_.reserve(Keys::keys);
    for (int key = Keys::first_key; key < kEnd; ++key) {
      const float side = 0.2f + 0.6f * static_cast<float>(key - Keys::first_key) / (Keys::keys - 1);
      keys_.push_back({Voice(key, sample_rate_hz, kModes), std::sqrt(1 - side), std::sqrt(side)});
    }
  }

  /// Throws the hammer of a key; velocity from 0 to 1.
  void note_on(int key, float velocity) {
    if (Key* const struck = find(key)) {
      struck->is_down = struck->sounds = true;
      struck->voice.strike(static_cast<float>(contactspline::strike_speed<Keys>(static_cast<double>(velocity))));
    }
  }

  /// Lowers the damper of a key, unless the pedal is down.
  void note_off(int key) {
    if (Key* const released = find(key)) {
      released->is_down = false;
      if (!is_pedal_down_) released->voice.release();
    }
  }

  /// The sustain pedal: while it is down no damper is lowered.
  void set_pedal(bool is_down) {
    is_pedal_down_ = is_down;
    if (is_down) return;
    for (Key& key : keys_)
      if (!key.is_down) key.voice.release();
  }

  /// Hammers and felts of all keys, from the next strike on: mass and stiffness as ratios, loss [s/m].
  void set_hammers(float mass_ratio, contactspline::ContactControls<float> felt) {
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      auto& controls = keys_[k].voice.controls();
      controls.hammer_mass_kg = mass_ratio * static_cast<float>(Keys::hammer_masses[k]);
      controls.felt = felt;
    }
  }

  /// Brings all strings to rest.
  void reset() {
    for (Key& key : keys_) {
      key.voice.reset();
      key.is_down = key.sounds = false;
    }
  }

  /// Plays a block, low keys on the left, or in mono if `right` is empty. No allocation, no lock, bounded time.
  void process(std::span<float> left, std::span<float> right = {}) {
    std::ranges::fill(left, 0.0f);
    std::ranges::fill(right, 0.0f);
    for (Key& key : keys_) {
      if (!key.sounds) continue;
      for (std::size_t begin = 0; begin < left.size(); begin += kBlock) {
        std::array<float, kBlock> block;
        const auto sound = std::span(block).first(std::min(kBlock, left.size() - begin));
        key.voice.process(sound);
        add(right.empty() ? kGain : kGain * key.left, sound, left.subspan(begin));
        if (!right.empty()) add(kGain * key.right, sound, right.subspan(begin));
      }
      if (!key.is_down && key.voice.is_silent()) key.sounds = false;
    }
  }

  /// Plays a block in mono, events in the order of their times, all within the block.
  void process(std::span<const KeyEvent> events, std::span<float> output) {
    std::size_t done = 0;
    for (const KeyEvent& event : events) {
      process(output.subspan(done, event.time - done));
      done = event.time;
      event.velocity > 0 ? note_on(event.key, event.velocity) : note_off(event.key);
    }
    process(output.subspan(done));
  }

 private:
  using Voice = contactspline::KeyboardVoice<Keys, float>;

  struct Key {
    Voice voice;
    float left, right;  // gains, equal power
    bool is_down = false;
    bool sounds = false;  // a silent key costs nothing
  };

  static constexpr int kEnd = Keys::first_key + static_cast<int>(Keys::keys);
  static constexpr std::size_t kBlock = 128;  // samples
  static constexpr std::size_t kModes = 80;   // of a string, at most
  static constexpr float kGain = 0.02f;       // full scale per newton

  // Null for a key that a piano lacks.
  Key* find(int key) {
    if (key < Keys::first_key || key >= kEnd) return nullptr;
    return &keys_[static_cast<std::size_t>(key - Keys::first_key)];
  }

  static void add(float gain, std::span<const float> sound, std::span<float> sum) {
    for (std::size_t n = 0; n < sound.size(); ++n) sum[n] += gain * sound[n];
  }

  std::vector<Key> keys_;
  bool is_pedal_down_ = false;
};
