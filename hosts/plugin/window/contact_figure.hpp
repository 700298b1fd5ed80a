// SPDX-License-Identifier: MIT
// What a window shows of a running contact: the last motion, the force of the last blow, the energy.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "window/contact_ring.hpp"

namespace contactspline {

/// The smallest of 1, 2 and 5 times a power of 10 that is not below a value; 1 for 0.
[[nodiscard]] inline double round_up(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}

class ContactFigure {
 public:
  static constexpr double kMotion_s = 0.02, kBlow_s = 0.02, kEnergy_s = 5, kEnergyStep_s = 0.04;

  explicit ContactFigure(double sample_rate_hz) : rate_hz_(sample_rate_hz) {}

  void add(std::span<const ContactSample> samples) {
    for (const ContactSample& sample : samples) {
      add_motion(sample.motion);
      add_force(sample);
      add_energy(sample.energy);
    }
  }

  /// The motion of the last kMotion_s, from where it last rises through 0.
  [[nodiscard]] std::span<const float> motion() const {
    const std::size_t shown = samples_in(kMotion_s);
    if (motion_.size() < shown) return {};
    std::size_t begin = motion_.size() - shown;
    for (std::size_t n = begin; n > 0; --n)
      if (motion_[n - 1] <= 0 && motion_[n] > 0) {
        begin = n;
        break;
      }
    return std::span(motion_).subspan(begin, shown);
  }
  /// The largest magnitude of the motion lately.
  [[nodiscard]] float motion_peak() const { return motion_peak_; }

  /// The force [N] from the first contact after the last note on.
  [[nodiscard]] std::span<const float> blow() const { return blow_; }
  [[nodiscard]] double blow_s() const { return static_cast<double>(blow_.size()) / rate_hz_; }
  [[nodiscard]] float blow_peak() const { return blow_peak_; }

  /// The energy [J] of the last kEnergy_s in steps of kEnergyStep_s, oldest first.
  [[nodiscard]] const std::deque<float>& energies() const { return energies_; }

  /// Has anything been seen to move in the time that is shown?
  [[nodiscard]] bool is_moving() const { return since_motion_s_ < kEnergy_s + 1; }

 private:
  [[nodiscard]] std::size_t samples_in(double time_s) const { return static_cast<std::size_t>(time_s * rate_hz_); }

  void add_motion(float motion) {
    constexpr double kPeakTime_s = 0.5;
    constexpr float kNothing = 1e-7f;  // 140 dB below full scale
    motion_.push_back(motion);
    const std::size_t kept = 2 * samples_in(kMotion_s);
    if (motion_.size() > 2 * kept) motion_.erase(motion_.begin(), motion_.end() - static_cast<std::ptrdiff_t>(kept));
    motion_peak_ = std::max(std::abs(motion), motion_peak_ * static_cast<float>(1 - 1 / (kPeakTime_s * rate_hz_)));
    since_motion_s_ = std::abs(motion - last_motion_) > kNothing ? 0 : since_motion_s_ + 1 / rate_hz_;
    last_motion_ = motion;
  }

  // A blow ends when the force stays at nothing, or at the end of the time that is shown.
  void add_force(const ContactSample& sample) {
    constexpr double kFree_s = 0.002;
    if (sample.notes != notes_) {
      notes_ = sample.notes;
      state_ = Blow::kAwaited;
    }
    if (state_ == Blow::kAwaited && sample.force > 0) {
      state_ = Blow::kRunning;
      blow_.clear();
      blow_peak_ = 0;
      free_samples_ = 0;
    }
    if (state_ != Blow::kRunning) return;
    blow_.push_back(sample.force);
    blow_peak_ = std::max(blow_peak_, sample.force);
    free_samples_ = sample.force > 0 ? 0 : free_samples_ + 1;
    if (free_samples_ > samples_in(kFree_s) || blow_.size() >= samples_in(kBlow_s)) state_ = Blow::kOver;
  }

  void add_energy(float energy) {
    until_energy_s_ -= 1 / rate_hz_;
    if (until_energy_s_ > 0) return;
    until_energy_s_ += kEnergyStep_s;
    energies_.push_back(energy);
    if (energies_.size() > static_cast<std::size_t>(kEnergy_s / kEnergyStep_s)) energies_.pop_front();
  }

  enum class Blow { kAwaited, kRunning, kOver };

  double rate_hz_;
  std::vector<float> motion_, blow_;
  float motion_peak_ = 0, last_motion_ = 0, blow_peak_ = 0;
  double since_motion_s_ = 1e9, until_energy_s_ = 0;
  std::deque<float> energies_;
  std::uint32_t notes_ = 0;
  std::size_t free_samples_ = 0;
  Blow state_ = Blow::kOver;
};

}  // namespace contactspline
