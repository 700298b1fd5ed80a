// SPDX-License-Identifier: MIT
// The shapes of modes at places, and their constants at a sample rate.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <new>
#include <span>
#include <vector>

#include "contactspline/data/mode.hpp"
#include "contactspline/simd/kernel_data.hpp"

namespace contactspline {

namespace detail {

/// Allocates memory that begins on a cache line, so that no aligned vector crosses a cache line.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kLine{64};

  CacheLineAllocator() = default;
  template <typename U>
  constexpr CacheLineAllocator(const CacheLineAllocator<U>&) {}

  [[nodiscard]] T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kLine)); }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, kLine); }
  friend bool operator==(CacheLineAllocator, CacheLineAllocator) { return true; }
};

/// One number for each mode, padded with zeros to whole cache lines, so that vector loops need no scalar remainder.
template <std::floating_point T, std::size_t Modes = std::dynamic_extent>
class ModalArray {
 public:
  ModalArray() = default;
  explicit constexpr ModalArray(std::size_t size) : size_(size), values_(in_whole_lines<T>(size)) {}

  [[nodiscard]] constexpr std::size_t size() const { return size_; }
  [[nodiscard]] constexpr std::size_t padded_size() const { return values_.size(); }
  [[nodiscard]] constexpr T operator[](std::size_t i) const { return values_[i]; }
  [[nodiscard]] constexpr T& operator[](std::size_t i) { return values_[i]; }
  [[nodiscard]] constexpr const T* data() const { return values_.data(); }
  [[nodiscard]] constexpr T* data() { return values_.data(); }
  constexpr void clear() { std::ranges::fill(values_, T(0)); }

 private:
  std::size_t size_ = 0;
  std::vector<T, CacheLineAllocator<T>> values_;
};

/// The same for a number of modes that is known at compile time: without the heap, and without padding.
template <std::floating_point T, std::size_t Modes>
requires(Modes != std::dynamic_extent) class ModalArray<T, Modes> : public std::array<T, Modes> {
 public:
  constexpr ModalArray() : std::array<T, Modes>{} {}
  explicit constexpr ModalArray(std::size_t) : ModalArray() {}
  constexpr void clear() { this->fill(T(0)); }
};

}  // namespace detail

/// Mode shapes at one place. The displacement there is the sum over all modes of shape times modal displacement.
template <std::floating_point T, std::size_t Modes = std::dynamic_extent>
class ModeShapes {
 public:
  ModeShapes() = default;
  explicit constexpr ModeShapes(std::size_t modes) : values_(modes) {}
  explicit constexpr ModeShapes(std::span<const double, Modes> values) : values_(values.size()) {
    for (std::size_t i = 0; i < values.size(); ++i) values_[i] = static_cast<T>(values[i]);
  }

  [[nodiscard]] constexpr std::size_t size() const { return values_.size(); }
  [[nodiscard]] constexpr T operator[](std::size_t mode) const { return values_[mode]; }
  [[nodiscard]] constexpr T& operator[](std::size_t mode) { return values_[mode]; }
  [[nodiscard]] constexpr const T* data() const { return values_.data(); }

 private:
  detail::ModalArray<T, Modes> values_;
};

namespace detail {

/// Constants of one mode at a sample rate (docs/how-it-works/modal.md), with p = -decay + j w and z = exp(p dt):
struct ModeConstants {
  double stiffness;         ///< |1 - z|^2
  double loss;              ///< 1 - |z|^2
  double receptance;        ///< |1 - z|^2/(2 m |p|^2), change of displacement over a sample per newton [m/N]
  double averaging_factor;  ///< |1 - z|^2/|p dt|^2, the part of an impulse's response that averaging the force leaves
  double one_plus_z_square;  ///< |1 + z|^2
  double velocity_gain;      ///< w/Im z [rad/s]
  double decay_per_s;
};

/// May a form have the spring of a mode of this stiffness and receptance (StretchForm)? Up to 0.45 times the sample
/// rate: 4 sin^2(0.45 pi).
[[nodiscard]] constexpr bool can_give_away_spring(double stiffness, double receptance) {
  return receptance > 0 && stiffness < 3.9;
}

// A template: compilers that cannot compute std::exp at compile time refuse it as a plain constexpr function.
template <std::same_as<double> Rate>
constexpr ModeConstants mode_constants(const Mode& mode, Rate sample_rate_hz) {
  const double w = mode.angular_frequency_rad_per_s, dt = 1 / sample_rate_hz;
  const double decay_factor = std::exp(-mode.decay_per_s * dt);
  const double decay_loss = -std::expm1(-mode.decay_per_s * dt);  // 1 - decay_factor, without cancellation
  const double sine = std::sin(w * dt / 2), cosine = std::cos(w * dt / 2);
  const double stiffness = decay_loss * decay_loss + 4 * decay_factor * sine * sine;
  const double phase_square = (w * w + mode.decay_per_s * mode.decay_per_s) * dt * dt;  // |p dt|^2
  const double averaging_factor = phase_square > 0 ? stiffness / phase_square : 1;      // 1 is the limit
  return {.stiffness = stiffness,
          .loss = -std::expm1(-2 * mode.decay_per_s * dt),
          .receptance = averaging_factor * dt * dt / (2 * mode.mass_kg),
          .averaging_factor = averaging_factor,
          .one_plus_z_square = decay_loss * decay_loss + 4 * decay_factor * cosine * cosine,
          .velocity_gain = (w > 0 ? w / (2 * sine * cosine) : sample_rate_hz) / decay_factor,
          .decay_per_s = mode.decay_per_s};
}

}  // namespace detail

}  // namespace contactspline
