// SPDX-License-Identifier: MIT
// Plays one sample of a plan after the other with one instrument.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "contactspline/host/any_instrument.hpp"
#include "generator/dataset/plan.hpp"

namespace contactspline {

/// Where a sample goes: an array of Plan::length_of() values for each thing that is kept, in `energy` for the energy
/// and in `sounds` for all others, which have an empty array in its place.
struct SampleArrays {
  std::vector<std::span<float>> sounds;
  std::span<double> energy;
};

/// Makes the plan's instrument once and plays samples with it. What a sample is does not depend on those before it,
/// bit by bit. For one thread.
class SamplePlayer {
 public:
  /// The plan must outlive it. Throws BadInput where the instrument cannot be made at its rate.
  explicit SamplePlayer(const Plan& plan);
  ~SamplePlayer();
  SamplePlayer(SamplePlayer&&) noexcept;

  /// values: of the plan's columns. `watch` is called many times a sample, and may throw to stop. Throws
  /// std::runtime_error where the sound is not finite.
  void play(std::span<const double> values, const SampleArrays& into, const std::function<void()>& watch);

 private:
  class Interface;
  template <std::floating_point T>
  class In;
  std::unique_ptr<Interface> player_;
};

}  // namespace contactspline
