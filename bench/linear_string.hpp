// SPDX-License-Identifier: MIT
// A modal string without contact: the reference for the cost of a contact.
#pragma once

#include <concepts>
#include <span>
#include <vector>

#include "bench/baselines/modal_string.hpp"

namespace contactspline::bench {

/// The modes of ModalString and a pickup, with nonzero displacements.
template <std::floating_point T>
class LinearString {
 public:
  LinearString(std::span<const Mode> modes, std::span<const double> pickup_shapes, double sample_rate_hz) {
    modes_.resize((modes.size() + 2 * kLanes - 1) / (2 * kLanes) * 2);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const auto constants = contactspline::detail::mode_constants(modes[i], sample_rate_hz);
      Modes& mode = modes_[i / kLanes];
      mode.keep[i % kLanes] = static_cast<T>(1 - constants.loss);
      mode.pull[i % kLanes] = static_cast<T>(constants.stiffness);
      mode.pickup[i % kLanes] = static_cast<T>(pickup_shapes[i]);
      mode.displacement[i % kLanes] = T(1e-3) / static_cast<T>(i + 1);  // a sounding note
    }
  }

  void process(std::span<T> out) {
    for (T& sample : out) sample = detail::ring(std::span(modes_));
  }

 private:
  static constexpr std::size_t kLanes = detail::Modes<T>::Lanes::size();

  // The values of detail::Modes that a string without hammer needs.
  struct alignas(64) Modes {
    using Lanes = typename detail::Modes<T>::Lanes;
    Lanes keep = 0, pull = 0, pickup = 0;
    Lanes rest = 0, displacement = 0;
  };

  std::vector<Modes> modes_;
};

}  // namespace contactspline::bench
