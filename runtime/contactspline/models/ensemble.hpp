// SPDX-License-Identifier: MIT
// Many hammer-strings played together. Silent ones cost no time.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/models/hammer_string.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/flush_denormals.hpp"

namespace contactspline {

/// Level and position of a voice in the sum. Constant over a block. Their ranges are those of ControlRanges
/// (docs/reference/controls.md).
template <std::floating_point T>
struct VoiceMix {
  T gain = 1;        ///< output per metre of displacement at the pickup
  T pan = T(1) / 2;  ///< 0 left to 1 right, equal power; ignored in mono
};

/// Runs task(0) to task(tasks - 1) one after the other. Threads (threads.hpp) runs them on several cores.
struct OneThread {
  template <typename Task>
  void operator()(std::size_t tasks, const Task& task) const {
    for (std::size_t i = 0; i < tasks; ++i) task(i);
  }
};

/// Calls task(0) to task(tasks - 1) in any order, possibly at the same time, and returns when all are done. OneThread
/// and Threads are runners.
template <typename Run>
concept Runner = std::invocable<Run, std::size_t, void (*)(std::size_t)>;

/// Hammer-strings, each with its own felt, modes, places and controls. A voice sleeps when its hammer has stopped and
/// the energy of its string is below `inaudible_j`; a strike wakes it. The order of summation does not depend on the
/// number of threads: awake voices by rising number in groups of kGroup, then the groups. A voice whose sound is not
/// finite, as that of modes that are no numbers, is left out of the sum, brought to rest and put to sleep.
template <std::floating_point T>
class Ensemble {
 public:
  static constexpr std::size_t kBlock = 256;  ///< samples that a voice computes at a time
  static constexpr std::size_t kGroup =
      HammerString<T>::kMaxTogether;  ///< voices that one thread computes as one task

  /// inaudible_j [J]: the default is 90 dB below the energy of a C4 hammer at 0.1 m/s.
  explicit Ensemble(double sample_rate_hz, double inaudible_j = 1e-14)
      : sample_rate_hz_(sample_rate_hz), inaudible_j_(inaudible_j) {}

  /// Adds a sleeping voice and returns its number: 0, 1, ... The felt must outlive the ensemble. Allocates memory: do
  /// not call on the audio thread.
  std::size_t add(SegmentTable<T> felt, std::span<const Mode> modes, ModeShapes<T> strike,
                  const ModeShapes<T>& pickup, const HammerStringControls<T>& controls,
                  std::span<const Memory> memories = {}) {
    HammerString<T> model(felt, modes, std::move(strike), sample_rate_hz_, memories);
    ModeShapes<T> shapes = model.string().sound_pickup(pickup);
    voices_.push_back({std::move(model), std::move(shapes), controls});
    awake_.reserve(voices_.size());
    buses_.resize((voices_.size() + kGroup - 1) / kGroup);
    return voices_.size() - 1;
  }

  /// Throws the hammer of a voice as HammerString::strike does, and wakes the voice. This function and all below are
  /// safe on an audio thread.
  void strike(std::size_t voice, T velocity_m_per_s, T distance_m) {
    if (!is_number(velocity_m_per_s) || !is_number(distance_m)) return;
    Voice& struck = voices_[voice];
    struck.model.strike(velocity_m_per_s, distance_m);
    // Different delays, so that the voices of a chord are not all checked in the same block.
    struck.until_check = kCheckInterval + voice * kBlock % kCheckInterval;
    if (!std::exchange(struck.is_awake, true))
      awake_.insert(std::ranges::lower_bound(awake_, voice), voice);  // does not allocate: add() reserved space
  }

  /// Brings a voice to rest and puts it to sleep.
  void reset(std::size_t voice) {
    rest(voices_[voice]);
    std::erase(awake_, voice);
  }
  /// The same for all voices.
  void reset() {
    for (Voice& voice : voices_) rest(voice);
    awake_.clear();
  }

  [[nodiscard]] HammerStringControls<T>& controls(std::size_t voice) { return voices_[voice].controls; }
  [[nodiscard]] VoiceMix<T>& mix(std::size_t voice) { return voices_[voice].mix; }
  [[nodiscard]] const HammerString<T>& model(std::size_t voice) const { return voices_[voice].model; }
  /// Energy of all strings, hammers and felts [J].
  [[nodiscard]] double energy() const {
    double sum = 0;
    for (const Voice& voice : voices_) sum += voice.model.energy(voice.controls);
    return sum;
  }
  [[nodiscard]] std::size_t voices() const { return voices_.size(); }
  [[nodiscard]] std::size_t awake() const { return awake_.size(); }  ///< number of voices that are computed

  /// Advances out.size() samples and writes the sum of all voices: gain times displacement at the pickup, as
  /// ModalBank::sound_pickup gives it. run: OneThread or Threads, computes the groups. No allocation, no lock (see
  /// Threads for its own), bounded time. Takes less than 96 KB of stack on each thread.
  template <Runner Run = OneThread>
  void process(std::span<T> out, Run&& run = {}) {
    process(out, std::span<T>(), run);
  }

  /// The same in stereo. left and right must have the same size. Unless it is empty, `forces` has that size, too, and
  /// receives the sum of the contact forces [N].
  template <Runner Run = OneThread>
  void process(std::span<T> left, std::span<T> right, Run&& run = {}, std::span<T> forces = {}) {
    for (std::size_t done = 0; done < left.size(); done += kBlock) {
      const auto part = [&](std::span<T> sum) {
        return sum.empty() ? sum : sum.subspan(done, (std::min)(kBlock, left.size() - done));
      };
      process_block({part(left), part(right), part(forces)}, run);
    }
  }

 private:
  static constexpr std::size_t kCheckInterval = 16 * kBlock;  // samples between two checks of a voice's energy

  // Each voice starts on a cache line, because different threads may write to neighbouring voices.
  struct alignas(64) Voice {
    HammerString<T> model;
    ModeShapes<T> pickup;
    HammerStringControls<T> controls;
    VoiceMix<T> mix = {}, held_mix = {};
    std::size_t until_check = 0;  // samples
    bool is_awake = false;
  };
  // Left, right and forces, of which all but the first may be empty.
  using Sums = std::array<std::span<T>, 3>;
  struct alignas(64) Bus {
    T sums[3][kBlock];
  };

  template <typename Run>
  void process_block(const Sums& sums, Run&& run) {
    const std::size_t groups = (awake_.size() + kGroup - 1) / kGroup;
    run(groups, [&](std::size_t group) {
      Sums of_group;
      for (std::size_t i = 0; i < sums.size(); ++i)
        of_group[i] = std::span(buses_[group].sums[i]).first(sums[i].size());
      process_group(group, of_group);
    });
    const FlushDenormals flushed;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      std::ranges::fill(sums[i], T(0));
      for (std::size_t group = 0; group < groups; ++group) add(T(1), buses_[group].sums[i], sums[i]);
    }
    std::erase_if(awake_, [&](std::size_t voice) { return !voices_[voice].is_awake; });
  }

  void process_group(std::size_t group, const Sums& sums) {
    const FlushDenormals flushed;
    const auto& [left, right, forces] = sums;
    const std::size_t samples = left.size();
    for (const std::span<T> sum : sums) std::ranges::fill(sum, T(0));
    alignas(64) T sounds[kGroup][kBlock], contact_forces[kGroup][kBlock];
    typename HammerString<T>::Part parts[kGroup];
    const std::size_t first = group * kGroup, size = (std::min)(kGroup, awake_.size() - first);
    for (std::size_t i = 0; i < size; ++i) {
      Voice& voice = voices_[awake_[first + i]];
      parts[i] = {&voice.model,
                  &voice.controls,
                  &voice.pickup,
                  {sounds[i], samples},
                  forces.empty() ? nullptr : contact_forces[i]};
    }
    HammerString<T>::process_together({parts, size});
    for (std::size_t i = 0; i < size; ++i) {
      Voice& voice = voices_[awake_[first + i]];
      const T* sound = sounds[i];
      if (!all_finite(std::span<const T>(sound, samples).last(1))) {  // modes that are not finite stay so
        rest(voice);
        continue;
      }
      const auto [gain, pan] = voice.held_mix = {held(voice.held_mix.gain, voice.mix.gain, ControlRanges<T>::gain),
                                                 held(voice.held_mix.pan, voice.mix.pan, ControlRanges<T>::pan)};
      add(right.empty() ? gain : gain * std::sqrt(1 - pan), sound, left);
      add(gain * std::sqrt(pan), sound, right);
      add(T(1), contact_forces[i], forces);
      check_energy(voice, samples);
    }
  }

  static void rest(Voice& voice) {
    voice.model.reset();
    voice.is_awake = false;
  }

  static void add(T gain, const T* __restrict sound, std::span<T> sum) {
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += gain * sound[n];
  }

  void check_energy(Voice& voice, std::size_t samples) const {
    if (voice.until_check > samples) {
      voice.until_check -= samples;
      return;
    }
    voice.until_check = kCheckInterval;
    voice.is_awake = voice.model.is_hammer_flying() || voice.model.string().energy() >= inaudible_j_;
  }

  double sample_rate_hz_, inaudible_j_;
  std::vector<Voice> voices_;
  std::vector<std::size_t> awake_;  // numbers of the awake voices, rising
  std::vector<Bus> buses_;          // sum of each group
};

}  // namespace contactspline
