// SPDX-License-Identifier: MIT
// A modal string in contiguous arrays, advanced in one pass over its modes per sample. All baselines use it.
#pragma once

#include <concepts>
#include <cstddef>
#include <experimental/simd>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/modal/modal.hpp"

namespace contactspline::bench {

/// Modes that have the receptances with which the schemes were published, dt^2 |1 + z|^2/(8 m): the midpoint rule
/// with the modal mass kept instead of the stiffness (docs/how-it-works/modal.md).
inline std::vector<Mode> with_mass_kept(std::span<const Mode> modes, double sample_rate_hz) {
  std::vector<Mode> kept(modes.begin(), modes.end());
  for (Mode& mode : kept) {
    const auto constants = contactspline::detail::mode_constants(mode, sample_rate_hz);
    mode.mass_kg *= 4 * constants.averaging_factor / constants.one_plus_z_square;
  }
  return kept;
}

/// The sums of one pass over the modes.
template <std::floating_point T>
struct PassSums {
  T increment;  ///< free increment at the place of the strike, over the next sample without force [m]
  T pickup;     ///< displacement at the pickup [m]
};

namespace detail {

/// The modes in one vector register: all values that a pass reads and writes, side by side on their own cache lines.
template <std::floating_point T>
struct alignas(64) Modes {
  using Lanes = std::experimental::native_simd<T>;
  Lanes keep = 1, pull = 0, gain = 0, strike = 0, pickup = 0;  // keep is never 0, so it may be a divisor
  Lanes rest = 0, displacement = 0;
};

/// Advances every mode by one sample: d = rest + gain F, q += d, and the next free increment rest = keep d - pull q
/// (docs/how-it-works/modal.md, "In small changes"). It handles two vectors at a time, so that two chains of sums run
/// in parallel; the number of vectors must be even.
template <std::floating_point T>
[[nodiscard]] inline PassSums<T> pass(std::span<Modes<T>> modes, T force) {
  using Lanes = typename Modes<T>::Lanes;
  Lanes increment[2] = {0, 0}, output[2] = {0, 0};
  for (std::size_t i = 0; i < modes.size(); i += 2)
    for (std::size_t half = 0; half < 2; ++half) {
      Modes<T>& mode = modes[i + half];
      const Lanes d = mode.rest + mode.gain * force;
      const Lanes q = mode.displacement + d;
      const Lanes next = mode.keep * d - mode.pull * q;
      mode.rest = next;
      mode.displacement = q;
      increment[half] += mode.strike * next;
      output[half] += mode.pickup * q;
    }
  return {reduce(increment[0] + increment[1]), reduce(output[0] + output[1])};
}

/// The same without force and without the sum of the increments. Returns the displacement at the pickup.
template <typename SomeModes>
[[nodiscard]] inline auto ring(std::span<SomeModes> modes) {
  using Lanes = typename SomeModes::Lanes;
  Lanes output[2] = {0, 0};
  for (std::size_t i = 0; i < modes.size(); i += 2)
    for (std::size_t half = 0; half < 2; ++half) {
      SomeModes& mode = modes[i + half];
      const Lanes d = mode.rest;
      const Lanes q = mode.displacement + d;
      mode.rest = mode.keep * d - mode.pull * q;
      mode.displacement = q;
      output[half] += mode.pickup * q;
    }
  return reduce(output[0] + output[1]);
}

}  // namespace detail

/// Modes with exact poles z = exp((-decay + j w) dt): q(n+1) - 2 Re z q(n) + |z|^2 q(n-1) = receptance F, with the
/// receptance of ModalBank. The schemes were published with dt^2 |1 + z|^2/(8 m); the tests give modes such masses.
/// F = shape (f + f_last) gives the one-step midpoint rule of ModalBank. F = shape 2 f gives the two-step scheme,
/// whose force belongs to the sample itself. Without modes it is a rigid barrier.
template <std::floating_point T>
class ModalString {
 public:
  ModalString(std::span<const Mode> modes, std::span<const double> strike_shapes,
              std::span<const double> pickup_shapes, double sample_rate_hz) {
    const std::size_t pair = 2 * kLanes;
    modes_.resize((modes.size() + pair - 1) / pair * 2);
    double sum = 0;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const auto constants = contactspline::detail::mode_constants(modes[i], sample_rate_hz);
      const bool audible = modes[i].angular_frequency_rad_per_s < std::numbers::pi * sample_rate_hz;  // as ModalBank
      const double receptance = audible ? constants.receptance : 0;
      detail::Modes<T>& mode = modes_[i / kLanes];
      const std::size_t lane = i % kLanes;
      mode.keep[lane] = static_cast<T>(1 - constants.loss);
      mode.pull[lane] = static_cast<T>(constants.stiffness);
      mode.gain[lane] = static_cast<T>(receptance * strike_shapes[i]);
      mode.strike[lane] = static_cast<T>(strike_shapes[i]);
      mode.pickup[lane] = static_cast<T>(pickup_shapes[i]);
      sum += receptance * strike_shapes[i] * strike_shapes[i];
    }
    receptance_ = static_cast<T>(sum);
  }

  /// Increment at the place of the strike over the next sample, per unit of F [m/N].
  [[nodiscard]] T receptance() const { return receptance_; }
  /// Increment there over the next sample without force [m].
  [[nodiscard]] T increment() const { return increment_; }

  /// Advances one sample under F [N]. Returns the displacement at the pickup [m].
  T advance(T force) {
    const auto sums = detail::pass(std::span(modes_), force);
    increment_ = sums.increment;
    return sums.pickup;
  }

  /// Advances one sample without force. increment() is then invalid until listen() is called.
  T ring() { return detail::ring(std::span(modes_)); }

  /// Computes increment() again after ring().
  void listen() {
    typename detail::Modes<T>::Lanes sum = 0;
    for (const auto& mode : modes_) sum += mode.strike * mode.rest;
    increment_ = reduce(sum);
  }

  /// Increment at the place of the strike over the last sample [m].
  [[nodiscard]] T last_increment() const {
    typename detail::Modes<T>::Lanes sum = 0;
    for (const auto& mode : modes_) sum += mode.strike * (mode.rest + mode.pull * mode.displacement) / mode.keep;
    return reduce(sum);
  }

  /// Displacement of one mode [m]. Slow: do not call it for every sample.
  [[nodiscard]] T displacement(std::size_t mode) const { return modes_[mode / kLanes].displacement[mode % kLanes]; }

 private:
  static constexpr std::size_t kLanes = detail::Modes<T>::Lanes::size();

  std::vector<detail::Modes<T>> modes_;
  T receptance_ = 0;
  T increment_ = 0;
};

}  // namespace contactspline::bench
