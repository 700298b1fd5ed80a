// SPDX-License-Identifier: MIT
// A modal string that nothing touches: what contact may cost is measured against it.
#pragma once

#include <concepts>
#include <span>
#include <vector>

#include "bench/baselines/modal_string.hpp"

namespace contactspline::bench {

/// The pass of ModalString without the force and without the sum that a hammer asks for.
template <std::floating_point T>
class LinearString {
 public:
  LinearString(std::span<const Mode> modes, std::span<const double> pickup_shapes, double sample_rate_hz) {
    modes_.resize((modes.size() + 2 * kLanes - 1) / (2 * kLanes) * 2);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const auto constants = contactspline::detail::mode_constants(modes[i], sample_rate_hz);
      Modes& mode = modes_[i / kLanes];
      mode.keep[i % kLanes] = static_cast<T>(1 - 2 * constants.loss);
      mode.pull[i % kLanes] = static_cast<T>(2 * constants.stiffness);
      mode.pickup[i % kLanes] = static_cast<T>(pickup_shapes[i]);
      mode.displacement[i % kLanes] = T(1e-3) / static_cast<T>(i + 1);  // a note that sounds
    }
  }

  void play(std::span<T> out) {
    for (T& sample : out) sample = tick();
  }

 private:
  using Lanes = typename detail::Modes<T>::Lanes;
  static constexpr std::size_t kLanes = Lanes::size();
  struct alignas(64) Modes {
    Lanes keep = 0, pull = 0, pickup = 0;
    Lanes rest = 0, displacement = 0;
  };

  T tick() {
    Lanes output[2] = {0, 0};
    for (std::size_t i = 0; i < modes_.size(); i += 2)
      for (std::size_t half = 0; half < 2; ++half) {
        Modes& mode = modes_[i + half];
        const Lanes d = mode.rest;
        const Lanes q = mode.displacement + d;
        mode.rest = mode.keep * d - mode.pull * q;
        mode.displacement = q;
        output[half] += mode.pickup * q;
      }
    return reduce(output[0] + output[1]);
  }

  std::vector<Modes> modes_;
};

}  // namespace contactspline::bench
