// SPDX-License-Identifier: MIT
// The longitudinal modes of strings, which the square of the slope drives (docs/how-it-works/longitudinal.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/simd/kernels.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

namespace detail {

/// The square of the slope of strings, as a sum D_k cos(k pi x/L). A string's slope is the sum of a_n cos(n pi x/L)
/// with n from 1, so
///
///     D_0 = sum a_n^2/2,    D_k = sum a_n a_(n+k) + (sum of a_m a_(k-m) over 0 < m < k)/2
///
/// No allocation after construction.
template <std::floating_point T>
class SlopeSquare {
 public:
  /// per_m: slope per displacement of mode 1 of each string, then of mode 2 of each, and so on. Coefficients up to
  /// `highest`. Allocates.
  SlopeSquare(std::size_t strings, std::span<const T> per_m, std::size_t highest)
      : strings_(strings),
        modes_(per_m.size()),
        per_m_(per_m.size()),
        slopes_(in_whole_lines<T>((std::max)(per_m.size(), highest * strings)) +
                in_whole_lines<T>(highest * strings + 1)),
        sums_(highest + 1) {
    std::ranges::copy(per_m, per_m_.data());
  }

  [[nodiscard]] std::size_t modes() const { return modes_; }

  /// D_0, D_1, ... of all strings together. displacements: of the lowest modes [m], in whole cache lines or all; the
  /// others are at rest.
  [[nodiscard]] std::span<const T> coefficients(std::span<const T> displacements) {
    T* const slopes = slopes_.data();
    const std::size_t moving = (std::min)(displacements.size(), modes_);
    std::fill(slopes + moving, slopes + modes_, T(0));
    kernels<T>.sum_shifted_products(moving, per_m_.data(), displacements.data(), slopes, strings_, sums_);
    sums_[0] /= 2;
    add_sums();
    return sums_;
  }

 private:
  // The products whose numbers m and k - m add up to k.
  void add_sums() {
    for (std::size_t k = 2; k < sums_.size(); ++k) {
      T sum = 0;
      for (std::size_t m = 1; 2 * m <= k; ++m) {
        const T *a = slopes_.data() + (m - 1) * strings_, *b = slopes_.data() + (k - m - 1) * strings_;
        T of_strings = 0;
        for (std::size_t s = 0; s < strings_; ++s) of_strings += a[s] * b[s];
        sum += 2 * m == k ? of_strings / 2 : of_strings;
      }
      sums_[k] += sum;
    }
  }

  std::size_t strings_, modes_;
  ModalArray<T> per_m_, slopes_;  // zeros follow the slopes, at least highest coefficient times strings
  std::vector<T> sums_;
};

}  // namespace detail

/// The longitudinal force of the strings of a key on their bridge. The square of the slope drives the modes, and
/// these do not act back. All strings of a key have the same longitudinal modes, so one bank sums them up. The
/// displacement of a mode is counted as the force by which it pulls at the bridge. Safe on an audio thread after
/// construction.
template <std::floating_point T>
class LongitudinalModes {
 public:
  /// Longitudinal modes end here, and transverse ones at half of it: no product of two of them lies above.
  static constexpr double kHighest_hz = 6000;
  static constexpr std::size_t kMaxModes = 16;

  /// rows: mode 1 of each string, then mode 2 of each, and so on, with members `mode` and `wavenumber_per_m`. The
  /// modes 1, 2, 3, ... drive, as long as every string has them and they lie below half of kHighest_hz and a quarter
  /// of the rate, above which products would fold. So nothing drives if mode 1 of a string is overdamped. Allocates.
  template <typename Row>
  LongitudinalModes(const StiffString& string, const LongitudinalMotion& motion, std::span<const Row> rows,
                    double sample_rate_hz)
      : LongitudinalModes(string, motion, strings_of(rows), driving(string, rows, limit_hz(sample_rate_hz) / 2),
                          longitudinal_modes(string, motion, limit_hz(sample_rate_hz), kMaxModes), sample_rate_hz) {}

  /// Begins while the strings may sound: the modes rest under the square of the slope. Takes what tick() takes, and
  /// returns the force [N].
  T begin(std::span<const T> displacements) {
    take(displacements);
    for (std::size_t i = 0; i < size(); ++i) bank_.set_motion(i, -tension_part_ * coefficients_[i + 1], T(0));
    return force();
  }

  /// Follows the transverse modes over a sample to these displacements [m] of the lowest ones; the others are at
  /// rest. They begin on a cache line and fill whole ones, as those of a ModalBank. Returns the force on the bridge
  /// [N].
  T tick(std::span<const T> displacements) {
    take(displacements);
    bank_.predict();
    bank_.push(drives_n_, T(1));
    bank_.commit();
    return force();
  }

  /// After tick() [N].
  [[nodiscard]] T force() const {
    T force = tension_part_ * coefficients_[0];
    for (std::size_t i = 0; i < size(); ++i)
      force += signs_[i] * (bank_.displacement(i) + tension_part_ * coefficients_[i + 1]);
    return force;
  }

  [[nodiscard]] std::size_t size() const { return bank_.size(); }
  /// Transverse modes that drive.
  [[nodiscard]] std::size_t driving_modes() const { return slopes_.modes(); }

  void reset() {
    bank_.reset();
    coefficients_.fill(0);
  }

 private:
  // A string whose slope is larger is outside all that this model describes.
  static constexpr ControlRange<T> kCoefficients{-1, 1};

  LongitudinalModes(const StiffString& string, const LongitudinalMotion& motion, std::size_t strings,
                    const std::vector<T>& per_m, const std::vector<Mode>& modes, double sample_rate_hz)
      : slopes_(strings, per_m, modes.size()),
        bank_(modes, sample_rate_hz),
        signs_(modes.size()),
        drives_n_(modes.size()),
        tension_part_(static_cast<T>((motion.axial_stiffness_n - string.tension_n) / 2)) {
    for (std::size_t i = 0; i < modes.size(); ++i) {
      signs_[i] = i % 2 == 0 ? T(-1) : T(1);  // cos(k pi)
      stiffness_.push_back(static_cast<T>(stiffness_of(modes[i])));
    }
  }

  static double limit_hz(double sample_rate_hz) { return (std::min)(kHighest_hz, sample_rate_hz / 2); }

  // Rows from `first` on that have its wavenumber.
  template <typename Row>
  static std::size_t count_alike(std::span<const Row> rows, std::size_t first) {
    std::size_t end = first;
    while (end < rows.size() && rows[end].wavenumber_per_m == rows[first].wavenumber_per_m) ++end;
    return end - first;
  }
  template <typename Row>
  static std::size_t strings_of(std::span<const Row> rows) {
    std::size_t strings = 0;
    for (std::size_t first = 0; first < rows.size();) {
      const std::size_t alike = count_alike(rows, first);
      strings = (std::max)(strings, alike);
      first += alike;
    }
    return strings;
  }
  // Slopes per displacement [1/m].
  template <typename Row>
  static std::vector<T> driving(const StiffString& string, std::span<const Row> rows, double below_hz) {
    std::vector<T> per_m;
    const std::size_t strings = strings_of(rows);
    const auto is_below = [&](const Row& row) {
      return row.mode.angular_frequency_rad_per_s < 2 * std::numbers::pi * below_hz;
    };
    for (long number = 1; per_m.size() < rows.size(); ++number) {
      const double wavenumber_per_m = rows[per_m.size()].wavenumber_per_m;
      if (std::lround(wavenumber_per_m * string.length_m / std::numbers::pi) != number) break;
      if (count_alike(rows, per_m.size()) != strings) break;
      if (!std::ranges::all_of(rows.subspan(per_m.size(), strings), is_below)) break;
      per_m.insert(per_m.end(), strings, static_cast<T>(wavenumber_per_m));
    }
    return per_m;
  }

  // Takes the squares of the slopes, and the means of their coefficients over the sample as forces.
  void take(std::span<const T> displacements) {
    const std::span<const T> next = slopes_.coefficients(displacements);
    for (std::size_t k = 0; k < next.size(); ++k) {
      const T next_k = held(coefficients_[k], next[k], kCoefficients);
      if (k > 0) drives_n_[k - 1] = -stiffness_[k - 1] * tension_part_ * ((next_k + coefficients_[k]) / 2);
      coefficients_[k] = next_k;
    }
  }

  detail::SlopeSquare<T> slopes_;
  ModalBank<T> bank_;
  ModeShapes<T> signs_, drives_n_;
  std::vector<T> stiffness_;
  T tension_part_;                               // (E A - T)/2
  std::array<T, kMaxModes + 1> coefficients_{};  // D_0, D_1, ..., held
};

}  // namespace contactspline
