// SPDX-License-Identifier: MIT
// What both ears hear of strings on a body.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <span>

#include "contactspline/modal/modal.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/step/high_pass.hpp"
#include "contactspline/step/splice.hpp"

namespace contactspline::detail {

/// The velocity of a body at both ears, and the force of the strings on its bridge, times a mobility, through a
/// high-pass (Listening, docs/how-it-works/body.md). No allocation after construction.
template <std::floating_point T>
class KeyboardSound {
 public:
  /// left, right: shapes of the body's modes at each ear.
  KeyboardSound(const ModalBank<T>& body, std::span<const double> left, std::span<const double> right,
                const Listening& listening, double sample_rate_hz)
      : left_(ear(body, left, listening.pickup_ratio)),
        right_(ear(body, right, listening.pickup_ratio)),
        mobility_(static_cast<T>(listening.mobility_m_per_n_s)),
        force_(kSplice_s, sample_rate_hz),
        high_pass_(listening.above_hz, sample_rate_hz, listening.quality) {}

  /// Strings join the bridge with a force [N], or leave it: this step does not sound.
  void begins(T force_n) { force_.begins(force_n); }
  void ended(T force_n) { force_.ended(force_n); }

  /// Advances one sample under the force of all strings on the bridge [N], and writes what each ear hears [m/s].
  void tick(T force_n, const ModalBank<T>& body, T& left, T& right) {
    const T direct = mobility_ * high_pass_.tick(force_.tick(force_n));
    left = direct + body.velocity(left_);
    right = direct + body.velocity(right_);
  }

  void reset() {
    force_.reset();
    high_pass_.reset();
  }

 private:
  using Ear = typename ModalBank<T>::VelocityShapes;
  static constexpr double kSplice_s = 0.01;  // shorter than the ear tells two sounds apart

  static Ear ear(const ModalBank<T>& body, std::span<const double> place, double ratio) {
    ModeShapes<T> shapes = body.sound_pickup(place);
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i] *= static_cast<T>(ratio);
    return body.velocity_shapes(shapes);
  }

  Ear left_, right_;
  T mobility_;
  Splice<T> force_;  // of strings, of which some join and leave
  HighPass<T> high_pass_;
};

}  // namespace contactspline::detail
