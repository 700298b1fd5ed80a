// SPDX-License-Identifier: MIT
// The longitudinal modes of strings, which the square of the slope drives (docs/how-it-works/longitudinal.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/stiff_string.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// How strings move along themselves. They do not if axial_stiffness_n is 0.
struct LongitudinalMotion {
  double axial_stiffness_n = 0;  ///< E A: modulus times cross-section of the core; above the tension
  Losses losses = {0, 0};        ///< of the longitudinal modes
  double output_ratio = 1;       ///< weight of their force on the bridge in the sound
};

/// E A [N] of a round wire from its bending stiffness E I [N m^2] and its modulus E [Pa]: 2 sqrt(pi E EI), because
/// A^2 = 4 pi I.
[[nodiscard]] inline double axial_stiffness(double bending_stiffness_n_m2, double youngs_modulus_pa) {
  return 2 * std::sqrt(std::numbers::pi * youngs_modulus_pa * bending_stiffness_n_m2);
}

/// The longitudinal modes k = 1, 2, ... of a string between rigid ends, of a wave speed sqrt(EA/mu), below a limit
/// and at most `max_modes`; without the first that does not oscillate and those above it. Their unit of displacement
/// is a newton of force on the bridge.
[[nodiscard]] inline std::vector<Mode> longitudinal_modes(const StiffString& string, const LongitudinalMotion& motion,
                                                          double max_frequency_hz, std::size_t max_modes) {
  std::vector<Mode> modes;
  const double speed = std::sqrt(motion.axial_stiffness_n * string.length_m / string.mass_kg);
  while (modes.size() < max_modes) {
    const double beta = static_cast<double>(modes.size() + 1) * std::numbers::pi / string.length_m;
    if (!(speed * beta < 2 * std::numbers::pi * max_frequency_hz)) break;
    const auto mode = UndampedMode{speed * beta, beta, 1}.with(motion.losses);
    if (!mode) break;
    modes.push_back(*mode);
  }
  return modes;
}

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
  /// Slopes n up to `partials`, coefficients k up to `highest`. Allocates.
  SlopeSquare(std::size_t strings, std::size_t partials, std::size_t highest)
      : strings_(strings),
        highest_(highest),
        stride_(std::max(partials, highest) + highest + 1),
        slopes_(in_lines(strings * stride_) + in_lines(highest + 1)),
        sums_(highest + 1) {}

  /// Where the slope a_n of a string stands.
  [[nodiscard]] std::size_t index(std::size_t string, std::size_t n) const { return string * stride_ + n; }
  [[nodiscard]] T* slopes() { return slopes_.data(); }

  /// D_0, D_1, ... of all strings together.
  [[nodiscard]] std::span<const T> coefficients() {
    const T* const slopes = slopes_.data();
#ifdef CONTACTSPLINE_SIMD
    sum_shifted_products(strings_ * stride_, slopes, sums_);
#else
    for (std::size_t k = 0; k <= highest_; ++k)
      sums_[k] = sum_of<T>(strings_ * stride_, [slopes, k](std::size_t i) { return slopes[i] * slopes[i + k]; });
#endif
    sums_[0] /= 2;
    for (std::size_t string = 0; string < strings_; ++string) add_sums(slopes + index(string, 0));
    return sums_;
  }

 private:
  // The next multiple of a cache line.
  static std::size_t in_lines(std::size_t count) {
    constexpr std::size_t kLine = ModalArray<T>::kLine;
    return (count + kLine - 1) / kLine * kLine;
  }

  // The products whose numbers add up to k.
  void add_sums(const T* slope) {
    for (std::size_t k = 2; k <= highest_; ++k) {
      T sum = k % 2 == 0 ? slope[k / 2] * slope[k / 2] / 2 : T(0);
      for (std::size_t m = 1; 2 * m < k; ++m) sum += slope[m] * slope[k - m];
      sums_[k] += sum;
    }
  }

  std::size_t strings_, highest_, stride_;
  // String after string, slope 0 of each is 0. So many zeros follow each that no product joins two strings.
  ModalArray<T> slopes_;
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

  /// rows: transverse modes by rising frequency, each with a number of its `string`, from 0. Those above a quarter of
  /// the rate are left out, for their products would fold. Allocates.
  template <typename Row>
  LongitudinalModes(const StiffString& string, const LongitudinalMotion& motion, std::span<const Row> rows,
                    double sample_rate_hz)
      : LongitudinalModes(string, motion, rows.first(driving(rows, limit_hz(sample_rate_hz) / 2)),
                          longitudinal_modes(string, motion, limit_hz(sample_rate_hz), kMaxModes), sample_rate_hz) {}

  /// Begins while the strings may sound: the modes rest under the square of the slope. Takes what tick() takes, and
  /// returns the force [N].
  T begin(std::span<const T> displacements) {
    take(displacements);
    for (std::size_t i = 0; i < size(); ++i) bank_.set_motion(i, -tension_part_ * coefficients_[i + 1], T(0));
    return force();
  }

  /// Follows the transverse modes over a sample to these displacements [m] of the lowest ones; the others are at
  /// rest. Returns the force on the bridge [N].
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
  [[nodiscard]] std::size_t driving_modes() const { return drives_.size(); }

  void reset() {
    bank_.reset();
    coefficients_.fill(0);
  }

 private:
  // A string whose slope is larger is outside all that this model describes.
  static constexpr ControlRange<T> kCoefficients{-1, 1};

  struct Drive {
    std::uint32_t index;  // of its slope
    T per_m;              // slope per displacement
  };

  template <typename Row>
  LongitudinalModes(const StiffString& string, const LongitudinalMotion& motion, std::span<const Row> rows,
                    const std::vector<Mode>& modes, double sample_rate_hz)
      : slopes_(strings_of(rows), partials_of(string, rows), modes.size()),
        bank_(modes, sample_rate_hz),
        signs_(modes.size()),
        drives_n_(modes.size()),
        tension_part_(static_cast<T>((motion.axial_stiffness_n - string.tension_n) / 2)) {
    for (std::size_t i = 0; i < modes.size(); ++i) {
      signs_[i] = i % 2 == 0 ? T(-1) : T(1);  // cos(k pi)
      stiffness_.push_back(static_cast<T>(stiffness_of(modes[i])));
    }
    for (const Row& row : rows)
      drives_.push_back({static_cast<std::uint32_t>(slopes_.index(row.string, number_of(string, row))),
                         static_cast<T>(row.wavenumber_per_m)});
  }

  static double limit_hz(double sample_rate_hz) { return std::min(kHighest_hz, sample_rate_hz / 2); }

  template <typename Row>
  static std::size_t driving(std::span<const Row> rows, double below_hz) {
    std::size_t count = 0;
    while (count < rows.size() && rows[count].mode.angular_frequency_rad_per_s < 2 * std::numbers::pi * below_hz)
      ++count;
    return count;
  }
  template <typename Row>
  static std::size_t number_of(const StiffString& string, const Row& row) {
    return static_cast<std::size_t>(std::lround(row.wavenumber_per_m * string.length_m / std::numbers::pi));
  }
  template <typename Row>
  static std::size_t strings_of(std::span<const Row> rows) {
    std::size_t strings = 0;
    for (const Row& row : rows) strings = std::max(strings, row.string + 1);
    return strings;
  }
  template <typename Row>
  static std::size_t partials_of(const StiffString& string, std::span<const Row> rows) {
    std::size_t highest = 0;
    for (const Row& row : rows) highest = std::max(highest, number_of(string, row));
    return highest;
  }

  // Takes the squares of the slopes, and the means of their coefficients over the sample as forces.
  void take(std::span<const T> displacements) {
    T* const slopes = slopes_.slopes();
    const std::span<const Drive> drives = drives_,
                                 moving = drives.first(std::min(displacements.size(), drives.size()));
    const T* q = displacements.data();
    for (const Drive& drive : moving) slopes[drive.index] = drive.per_m * *q++;
    for (const Drive& drive : drives.subspan(moving.size())) slopes[drive.index] = 0;
    const std::span<const T> next = slopes_.coefficients();
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
  T tension_part_;  // (E A - T)/2
  std::vector<Drive> drives_;
  std::array<T, kMaxModes + 1> coefficients_{};  // D_0, D_1, ..., held
};

}  // namespace contactspline
