// SPDX-License-Identifier: MIT
// Many hammer-strings together, of which those that are silent cost nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/flush_denormals.hpp"
#include "contactspline/hammer_string.hpp"

namespace contactspline {

/// How a voice goes into the sum; steady over a block.
template <std::floating_point T>
struct VoiceMix {
  T gain = 1;        ///< full scale per metre at the pickup
  T pan = T(1) / 2;  ///< 0 left to 1 right, at equal power; in mono without effect
};

/// Runs task(0) to task(tasks - 1) one after the other. Threads (threads.hpp) runs them on many cores.
struct OneThread {
  template <typename Task>
  void operator()(std::size_t tasks, const Task& task) const {
    for (std::size_t i = 0; i < tasks; ++i) task(i);
  }
};

/// OneThread, or what does the same in another order or at once, and returns when all is done.
template <typename Run>
concept Runner = std::invocable<Run, std::size_t, void (*)(std::size_t)>;

/// Hammer-strings, each with a felt, modes, places and controls of its own. A voice whose hammer is caught and whose
/// string has lost all energy but `inaudible_j` sleeps until it is struck. The sum is taken in one order whatever the
/// number of threads: the voices that are awake by rising number, in groups of kGroup, then the groups.
template <std::floating_point T>
class Ensemble {
 public:
  static constexpr std::size_t kBlock = 128;  ///< samples that a voice plays at a time
  static constexpr std::size_t kGroup = 8;    ///< voices that one thread plays at a time

  /// inaudible_j [J]: the default is 90 dB below a C4 hammer at 0.1 m/s.
  explicit Ensemble(double sample_rate_hz, double inaudible_j = 1e-14)
      : sample_rate_hz_(sample_rate_hz), inaudible_j_(inaudible_j) {}

  /// Adds a voice, asleep, and returns its number: 0, 1, ... felt must outlive the ensemble. Allocates: not for the
  /// audio thread.
  std::size_t add(SegmentTable<T> felt, std::span<const Mode> modes, ModeShapes<T> strike, ModeShapes<T> pickup,
                  const HammerStringControls<T>& controls) {
    voices_.push_back({{felt, modes, std::move(strike), sample_rate_hz_}, std::move(pickup), controls});
    awake_.reserve(voices_.size());
    buses_.resize((voices_.size() + kGroup - 1) / kGroup);
    return voices_.size() - 1;
  }

  /// Throws the hammer of a voice, as HammerString::strike, and wakes it. Safe in an audio thread, as all below.
  void strike(std::size_t voice, T velocity_m_per_s, T distance_m) {
    Voice& struck = voices_[voice];
    struck.model.strike(velocity_m_per_s, distance_m);
    struck.until_look = kLook + voice * kBlock % kLook;  // chords are not looked at all in one block
    if (!std::exchange(struck.is_awake, true))
      awake_.insert(std::ranges::lower_bound(awake_, voice), voice);  // there is room: add() reserved it
  }

  [[nodiscard]] HammerStringControls<T>& controls(std::size_t voice) { return voices_[voice].controls; }
  [[nodiscard]] VoiceMix<T>& mix(std::size_t voice) { return voices_[voice].mix; }
  [[nodiscard]] const HammerString<T>& model(std::size_t voice) const { return voices_[voice].model; }
  [[nodiscard]] std::size_t voices() const { return voices_.size(); }
  [[nodiscard]] std::size_t awake() const { return awake_.size(); }  ///< voices that cost time

  /// Advances out.size() samples and writes the sum of all voices, gain times displacement at the pickup. run: what
  /// runs the groups, OneThread or Threads. No allocation, no lock (but see Threads), bounded time.
  template <Runner Run = OneThread>
  void play(std::span<T> out, Run&& run = {}) {
    play(out, std::span<T>(), run);
  }

  /// The same in stereo; left and right of one size.
  template <Runner Run = OneThread>
  void play(std::span<T> left, std::span<T> right, Run&& run = {}) {
    for (std::size_t done = 0; done < left.size(); done += kBlock) {
      const std::size_t samples = std::min(kBlock, left.size() - done);
      play_block(left.subspan(done, samples), right.empty() ? right : right.subspan(done, samples), run);
    }
  }

 private:
  static constexpr std::size_t kLook = 32 * kBlock;  // samples between two looks at a voice's energy

  // On cache lines of their own: neighbours may be played by different threads.
  struct alignas(64) Voice {
    HammerString<T> model;
    ModeShapes<T> pickup;
    HammerStringControls<T> controls;
    VoiceMix<T> mix = {};
    std::size_t until_look = 0;  // samples
    bool is_awake = false;
  };
  struct alignas(64) Bus {
    T left[kBlock], right[kBlock];
  };

  template <typename Run>
  void play_block(std::span<T> left, std::span<T> right, Run&& run) {
    const std::size_t groups = (awake_.size() + kGroup - 1) / kGroup;
    run(groups, [&](std::size_t group) { play_group(group, left.size(), !right.empty()); });
    const FlushDenormals flushed;
    std::ranges::fill(left, T(0));
    std::ranges::fill(right, T(0));
    for (std::size_t group = 0; group < groups; ++group) {
      add(T(1), buses_[group].left, left);
      add(T(1), buses_[group].right, right);
    }
    std::erase_if(awake_, [&](std::size_t voice) { return !voices_[voice].is_awake; });
  }

  void play_group(std::size_t group, std::size_t samples, bool is_stereo) {
    const FlushDenormals flushed;
    Bus& bus = buses_[group];
    const std::span<T> left(bus.left, samples), right(bus.right, is_stereo ? samples : 0);
    std::ranges::fill(left, T(0));
    std::ranges::fill(right, T(0));
    alignas(64) T sound[kBlock];
    const std::size_t end = std::min((group + 1) * kGroup, awake_.size());
    for (std::size_t i = group * kGroup; i < end; ++i) {
      Voice& voice = voices_[awake_[i]];
      voice.model.play(voice.controls, voice.pickup, {sound, samples});
      const auto [gain, pan] = voice.mix;
      add(is_stereo ? gain * std::sqrt(1 - pan) : gain, sound, left);
      add(gain * std::sqrt(pan), sound, right);
      look_at(voice, samples);
    }
  }

  static void add(T gain, const T* __restrict sound, std::span<T> sum) {
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += gain * sound[n];
  }

  void look_at(Voice& voice, std::size_t samples) const {
    if (voice.until_look > samples) {
      voice.until_look -= samples;
      return;
    }
    voice.until_look = kLook;
    voice.is_awake = voice.model.is_hammer_flying() || voice.model.string().energy() >= inaudible_j_;
  }

  double sample_rate_hz_, inaudible_j_;
  std::vector<Voice> voices_;
  std::vector<std::size_t> awake_;  // numbers of voices, rising
  std::vector<Bus> buses_;          // sums of groups
};

}  // namespace contactspline
