// SPDX-License-Identifier: MIT
// What both ears hear of strings on a body.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <optional>
#include <span>

#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/pressure_sound.hpp"
#include "contactspline/step/high_pass.hpp"
#include "contactspline/step/splice.hpp"

namespace contactspline {

namespace detail {

/// The velocity of a body at both ears, and the force of the strings on its bridge, times a mobility, through a
/// high-pass (Listening, docs/how-it-works/body.md); or the sound pressure at both ears. No allocation after
/// construction.
template <std::floating_point T>
class KeyboardSound {
 public:
  KeyboardSound(const Body<T>& body, const BoardOfKeyboard& board, double sample_rate_hz)
      : left_(ear(body.modes(), board.left, board.listening.pickup_ratio)),
        right_(ear(body.modes(), board.right, board.listening.pickup_ratio)),
        mobility_(static_cast<T>(board.listening.mobility_m_per_n_s)),
        force_(kSplice_s, sample_rate_hz),
        high_pass_(board.listening.above_hz, sample_rate_hz, board.listening.quality) {
    if (board.pressure.rate_hz > 0) pressure_.emplace(body, board.pressure, sample_rate_hz);
  }

  /// Strings join the bridge with a force [N], or leave it: this step does not sound.
  void begins(T force_n) { force_.begins(force_n); }
  void ended(T force_n) { force_.ended(force_n); }

  /// Advances one sample under the force of all strings on the bridge [N], and writes what each ear hears: [m/s], or
  /// [Pa] in the room.
  void tick(T force_n, const Body<T>& body, T& left, T& right) {
    if (pressure_) return pressure_->tick(body, left, right);
    const T direct = mobility_ * high_pass_.tick(force_.tick(force_n));
    left = direct + body.modes().velocity(left_);
    right = direct + body.modes().velocity(right_);
  }

  void reset() {
    force_.reset();
    high_pass_.reset();
    if (pressure_) pressure_->reset();
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
  std::optional<PressureSound<T>> pressure_;
};

}  // namespace detail

}  // namespace contactspline
