// SPDX-License-Identifier: MIT
// A modal string in contiguous arrays, advanced in one pass over its modes per sample: what every baseline stands on.
#pragma once

#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/modal.hpp"

namespace contactspline::bench {

/// What one pass over the modes adds up.
template <std::floating_point T>
struct PassSums {
  T increment;  ///< of the displacement where the string is struck, over the coming sample without force [m]
  T pickup;     ///< displacement at the pickup now [m]
};

namespace detail {

/// As many running sums as fill 64 bytes.
template <std::floating_point T>
inline constexpr std::size_t kLanes = 64 / sizeof(T);

template <std::floating_point T>
[[nodiscard]] inline T total(const T* lanes) {
  T sums[kLanes<T> / 2];
  for (std::size_t i = 0; i < kLanes<T> / 2; ++i) sums[i] = lanes[i] + lanes[i + kLanes<T> / 2];
  T sum = 0;
  for (const T value : sums) sum += value;
  return sum;
}

/// One sample of every mode, d = rest + gain F, q += d, and what d would be next without force, rest = keep d - pull q
/// (the delta form of docs/modal.md). modes: a multiple of kLanes.
template <std::floating_point T>
[[nodiscard]] inline PassSums<T> pass(std::size_t modes, T force, const T* __restrict keep, const T* __restrict pull,
                                      const T* __restrict gain, const T* __restrict strike, const T* __restrict pickup,
                                      T* __restrict rest, T* __restrict displacement) {
  T increments[kLanes<T>] = {}, pickups[kLanes<T>] = {};
  for (std::size_t i = 0; i < modes; i += kLanes<T>)
    for (std::size_t lane = 0; lane < kLanes<T>; ++lane) {
      const std::size_t mode = i + lane;
      const T d = rest[mode] + gain[mode] * force;
      const T q = displacement[mode] + d;
      const T next = keep[mode] * d - pull[mode] * q;
      rest[mode] = next;
      displacement[mode] = q;
      increments[lane] += strike[mode] * next;
      pickups[lane] += pickup[mode] * q;
    }
  return {total(increments), total(pickups)};
}

}  // namespace detail

/// Modes with exact poles z = exp((-decay + j w) dt), q(n+1) - 2 Re z q(n) + |z|^2 q(n-1) = dt^2 |1 + z|^2 / (8 m) F:
/// with F = shape (f + f_last) the one-step midpoint rule of ModalBank, with F = shape 2 f the two-step scheme whose
/// force belongs to the sample itself. No modes: a rigid barrier.
template <std::floating_point T>
class ModalString {
 public:
  ModalString(std::span<const Mode> modes, std::span<const double> strike_shapes, std::span<const double> pickup_shapes,
              double sample_rate_hz) {
    const std::size_t lanes = detail::kLanes<T>;
    const std::size_t padded = (modes.size() + lanes - 1) / lanes * lanes;
    for (std::vector<T>* values : {&keep_, &pull_, &gain_, &strike_, &pickup_, &rest_, &displacement_})
      values->resize(padded);
    double give_by_force = 0;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const auto constants = contactspline::detail::mode_constants(modes[i], sample_rate_hz);
      const bool audible = modes[i].angular_frequency_rad_per_s < std::numbers::pi * sample_rate_hz;  // as ModalBank
      const double give = audible ? constants.give : 0;
      keep_[i] = static_cast<T>(1 - 2 * constants.loss);
      pull_[i] = static_cast<T>(2 * constants.stiffness);
      gain_[i] = static_cast<T>(give * strike_shapes[i]);
      strike_[i] = static_cast<T>(strike_shapes[i]);
      pickup_[i] = static_cast<T>(pickup_shapes[i]);
      give_by_force += give * strike_shapes[i] * strike_shapes[i];
    }
    admittance_ = static_cast<T>(give_by_force);
  }

  /// Increment where it is struck, over the coming sample, per unit of F [m/N].
  [[nodiscard]] T admittance() const { return admittance_; }
  /// The same without force [m].
  [[nodiscard]] T increment() const { return increment_; }

  /// Advances one sample under F [N]; gives the displacement at the pickup [m].
  T advance(T force) {
    const auto sums = detail::pass(rest_.size(), force, keep_.data(), pull_.data(), gain_.data(), strike_.data(),
                                   pickup_.data(), rest_.data(), displacement_.data());
    increment_ = sums.increment;
    return sums.pickup;
  }

  /// Increment where it is struck over the sample just gone [m]; not for every sample.
  [[nodiscard]] T last_increment() const {
    T sum = 0;
    for (std::size_t i = 0; i < rest_.size(); ++i)
      if (keep_[i] > 0) sum += strike_[i] * (rest_[i] + pull_[i] * displacement_[i]) / keep_[i];
    return sum;
  }

  /// Of each mode, zeros behind the last [m].
  [[nodiscard]] std::span<const T> displacements() const { return displacement_; }

 private:
  std::vector<T> keep_, pull_, gain_, strike_, pickup_;
  std::vector<T> rest_, displacement_;
  T admittance_ = 0;
  T increment_ = 0;
};

}  // namespace contactspline::bench
