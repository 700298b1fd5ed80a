// SPDX-License-Identifier: MIT
// What both ears hear of a body in the room (docs/how-it-works/listening.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/modal/force_history.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/models/body.hpp"

namespace contactspline {

namespace detail {

/// Computes it sample by sample. No allocation after construction.
template <std::floating_point T>
class PressureSound {
 public:
  PressureSound(const Body<T>& body, const BodyPressure& pressure, double sample_rate_hz)
      : left_(ear(body, pressure.left, pressure.rate_hz, sample_rate_hz)),
        right_(ear(body, pressure.right, pressure.rate_hz, sample_rate_hz)),
        forces_(body.places(), ForceHistory<T>((std::max)(left_.taps.front().size(), right_.taps.front().size()))) {}

  /// After each sample of the body [Pa].
  void tick(const Body<T>& body, T& left, T& right) {
    for (std::size_t p = 0; p < forces_.size(); ++p) forces_[p].add(body.force(p));
    left = pressure_at(left_, body);
    right = pressure_at(right_, body);
  }

  void reset() {
    for (ForceHistory<T>& forces : forces_) forces.reset();
  }

 private:
  struct Ear {
    typename ModalBank<T>::VelocityShapes shapes;
    std::vector<std::vector<T>> taps;  // of each place
  };

  static Ear ear(const Body<T>& body, const EarPressure& pressure, double rate_hz, double sample_rate_hz) {
    const ModalBank<T>& modes = body.modes();
    Ear ear{modes.velocity_shapes(modes.sound_pickup(pressure.of_velocity)), {}};
    const ModeShapes<T> of_displacement = modes.sound_pickup(pressure.of_displacement);
    for (std::size_t i = 0; i < of_displacement.size(); ++i) ear.shapes.of_displacement[i] += of_displacement[i];
    const std::size_t length = pressure.taps.size() / body.places();
    for (std::size_t p = 0; p < body.places(); ++p)
      ear.taps.push_back(taps_in<T>(pressure.taps.subspan(p * length, length), rate_hz, sample_rate_hz));
    return ear;
  }

  [[nodiscard]] T pressure_at(const Ear& ear, const Body<T>& body) const {
    T pressure = body.modes().velocity(ear.shapes);
    for (std::size_t p = 0; p < forces_.size(); ++p) pressure += forces_[p].filtered(ear.taps[p]);
    return pressure;
  }

  Ear left_, right_;
  std::vector<ForceHistory<T>> forces_;  // at each place of the bridge
};

}  // namespace detail

}  // namespace contactspline
