// SPDX-License-Identifier: MIT
// How the audio thread tells a window what the running contact does. The one exchange between them, without a lock.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace contactspline {

/// A sample of what an instrument does.
struct ContactSample {
  float motion;         ///< of the output that is heard on the left, over its full scale
  float force;          ///< of all contacts [N]
  float energy;         ///< stored [J]
  std::uint32_t notes;  ///< that have begun so far
};

/// The last samples. One thread writes, one reads; neither waits. Nothing is written while nobody watches.
class ContactRing {
 public:
  static constexpr std::size_t kSize = 8192;  // samples

  [[nodiscard]] bool is_watched() const { return is_watched_.load(std::memory_order_relaxed); }

  // Audio thread.

  /// motion, force: of the same length, at most kSize.
  void write(std::span<const float> motion, std::span<const float> force, float energy, std::uint32_t notes) {
    const std::uint64_t begin = written_.load(std::memory_order_relaxed);
    begun_.store(begin + motion.size(), std::memory_order_relaxed);
    for (std::size_t n = 0; n < motion.size(); ++n) {
      Slot& slot = slots_[(begin + n) % kSize];
      // Who reads one of these values also reads `begun_` as it was set above.
      slot.motion.store(motion[n], std::memory_order_release);
      slot.force.store(force[n], std::memory_order_release);
      slot.energy.store(energy, std::memory_order_release);
      slot.notes.store(notes, std::memory_order_release);
    }
    written_.store(begin + motion.size(), std::memory_order_release);
  }

  // Thread of the window.

  void watch(bool is_watched) {
    is_watched_.store(is_watched, std::memory_order_relaxed);
    read_ = written_.load(std::memory_order_acquire);
  }

  /// What was written since the last call and is not yet overwritten, oldest first.
  void read(std::vector<ContactSample>& samples) {
    samples.clear();
    const std::uint64_t end = written_.load(std::memory_order_acquire);
    const std::uint64_t begin = end - read_ > kSize ? end - kSize : read_;
    for (std::uint64_t n = begin; n < end; ++n) {
      const Slot& slot = slots_[n % kSize];
      samples.push_back({slot.motion.load(std::memory_order_acquire), slot.force.load(std::memory_order_acquire),
                         slot.energy.load(std::memory_order_acquire), slot.notes.load(std::memory_order_acquire)});
    }
    // What the other thread has begun to overwrite meanwhile is of two times.
    const std::uint64_t begun = begun_.load(std::memory_order_relaxed);
    const std::uint64_t lost = begun > begin + kSize ? begun - begin - kSize : 0;
    samples.erase(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(std::min(lost, end - begin)));
    read_ = end;
  }

 private:
  struct Slot {
    std::atomic<float> motion = 0, force = 0, energy = 0;
    std::atomic<std::uint32_t> notes = 0;
  };

  std::array<Slot, kSize> slots_;
  std::atomic<std::uint64_t> begun_ = 0, written_ = 0;  // samples
  std::atomic<bool> is_watched_ = false;
  std::uint64_t read_ = 0;
};

}  // namespace contactspline
