// SPDX-License-Identifier: MIT
// Mode shapes at any place of a string, and a contact that moves along the string.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <type_traits>
#include <utility>

#include "contactspline/modal/modal.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// Shapes sin(wavenumber x) of the modes of a string, at any place x. Modes: their number, if it is known at compile
/// time.
template <std::floating_point T, std::size_t Modes = std::dynamic_extent>
class StringShapes {
 public:
  using Shapes = ModeShapes<T, Modes>;

  explicit constexpr StringShapes(std::span<const double, Modes> wavenumbers_per_m)
      : wavenumbers_(wavenumbers_per_m), off_(wavenumbers_per_m), of_first_(first_of_multiples(wavenumbers_per_m)) {
    for (std::size_t i = 0; i < size(); ++i)
      off_[i] = static_cast<T>(wavenumbers_per_m[i] - static_cast<double>(i + 1) * double(of_first_));
  }

  /// Computes the shapes at a place [m], measured from the end where all shapes are sin(0). Where the wavenumbers are
  /// multiples of one, up to rounding, each shape comes from that of four modes before by a rotation, in at least
  /// double precision: within a few roundings per rotation, and many times as fast as a sine for each mode.
  constexpr void at(T place_m, Shapes& shapes) const {
    if (of_first_ > 0) return at_multiples(static_cast<Wide>(place_m), shapes);
    for (std::size_t i = 0; i < size(); ++i) shapes[i] = std::sin(wavenumbers_[i] * place_m);
  }

  /// Maximum movement of a contact per sample that the string can follow [m]: 1/8 of the shortest wavelength, and
  /// 1/10 of the distance that the slowest wave travels. modes: the modes of these wavenumbers, in the same order.
  [[nodiscard]] constexpr T longest_step(std::span<const Mode, Modes> modes, double sample_rate_hz) const {
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < size(); ++i) {
      const double beta = double(wavenumbers_[i]);
      const double speed = modes[i].angular_frequency_rad_per_s / beta;
      step = (std::min)({step, std::numbers::pi / 4 / beta, speed / sample_rate_hz / 10});
    }
    return static_cast<T>(step);
  }

  /// Length of the string [m]: half the longest wave. 0 without modes.
  [[nodiscard]] constexpr T length() const {
    if (size() == 0) return 0;
    T smallest = wavenumbers_[0];
    for (std::size_t i = 1; i < size(); ++i) smallest = (std::min)(smallest, wavenumbers_[i]);
    return std::numbers::pi_v<T> / smallest;
  }

  [[nodiscard]] constexpr std::size_t size() const { return wavenumbers_.size(); }

 private:
  using Wide = std::conditional_t<(std::numeric_limits<T>::digits < std::numeric_limits<double>::digits), double, T>;

  static constexpr double kRounding = 1e-12;  // of numbers with 13 digits

  // The first wavenumber [rad/m], if the others are its multiples 2, 3, ... up to rounding; else 0.
  [[nodiscard]] static constexpr Wide first_of_multiples(std::span<const double, Modes> wavenumbers_per_m) {
    if (wavenumbers_per_m.empty()) return 0;
    double sum = 0, multiples = 0;
    for (std::size_t i = 0; i < wavenumbers_per_m.size(); ++i) {
      sum += wavenumbers_per_m[i];
      multiples += static_cast<double>(i + 1);
    }
    const double first = sum / multiples;
    for (std::size_t i = 0; i < wavenumbers_per_m.size(); ++i) {
      const double ratio = wavenumbers_per_m[i] / (static_cast<double>(i + 1) * first);
      if (!(ratio > 1 - kRounding && ratio < 1 + kRounding)) return 0;
    }
    return first;
  }

  // The sines of the multiples, and what the wavenumbers are off from these, times the cosines.
  constexpr void at_multiples(Wide place_m, Shapes& shapes) const {
    constexpr std::size_t kLanes = 4;
    const Wide angle = of_first_ * place_m;
    const Wide sine = std::sin(angle), cosine = std::cos(angle);
    const Wide sine_4 = std::sin(4 * angle), cosine_4 = std::cos(4 * angle);
    const Wide sine_2 = 2 * sine * cosine, cosine_2 = (cosine - sine) * (cosine + sine);
    Wide sines[kLanes] = {sine, sine_2, sine_2 * cosine + cosine_2 * sine, sine_4};
    Wide cosines[kLanes] = {cosine, cosine_2, cosine_2 * cosine - sine_2 * sine, cosine_4};
    for (std::size_t i = 0; i < size(); i += kLanes) {
      for (std::size_t lane = 0; lane < kLanes && i + lane < size(); ++lane)
        shapes[i + lane] = static_cast<T>(sines[lane] + cosines[lane] * place_m * static_cast<Wide>(off_[i + lane]));
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const Wide s = sines[lane], c = cosines[lane];
        sines[lane] = s * cosine_4 + c * sine_4;
        cosines[lane] = c * cosine_4 - s * sine_4;
      }
    }
  }

  Shapes wavenumbers_, off_;  // only their numbers
  Wide of_first_;
};

/// The place of a contact that moves along a string, and the change of the mode shapes there over one sample. A force
/// acts through the mean shapes. The displacement of the string at the contact changes by sum(after dq) +
/// sum(change q) (docs/how-to/slide-string.md).
template <std::floating_point T, std::size_t Modes = std::dynamic_extent>
class MovingPlace {
 public:
  using Shapes = ModeShapes<T, Modes>;

  /// longest_step_m: StringShapes::longest_step.
  constexpr MovingPlace(const StringShapes<T, Modes>& shapes, T place_m, T longest_step_m)
      : shapes_(shapes),
        range_{0, shapes.length()},
        max_step_(longest_step_m),
        before_(shapes.size()),
        after_(shapes.size()),
        mean_(shapes.size()),
        change_(shapes.size()) {
    put(place_m);
  }

  /// Sets the place without moving there: the shapes do not change over the sample. place_m: from 0 to the length of
  /// the string, clamped; the place stays if it is not a number.
  constexpr void put(T place_m) {
    place_ = held(place_, place_m, range_);
    shapes_.at(place_, after_);
    compare_with(after_);
    is_moving_ = false;
  }

  /// Moves towards a place over the next sample, by the longest step at most. A jump of the control becomes a fast
  /// slide that the string can follow. place_m: as for put(). Returns whether the shapes changed.
  bool move_to(T place_m) {
    const T target = held(place_, place_m, range_);
    const T step = std::clamp(target - place_, -max_step_, max_step_);
    if (step == 0 && !is_moving_) return false;
    is_moving_ = step != 0;
    place_ = std::abs(step) < max_step_ ? target : place_ + step;
    std::swap(before_, after_);
    shapes_.at(place_, after_);
    compare_with(before_);
    return true;
  }

  [[nodiscard]] T place() const { return place_; }                        ///< [m]
  [[nodiscard]] constexpr const Shapes& after() const { return after_; }  ///< shapes at the end of the sample
  [[nodiscard]] const Shapes& mean() const { return mean_; }              ///< mean of the shapes before and after
  [[nodiscard]] const Shapes& change() const { return change_; }          ///< change of the shapes over the sample

 private:
  constexpr void compare_with(const Shapes& before) {
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      mean_[i] = (before[i] + after_[i]) / 2;
      change_[i] = after_[i] - before[i];
    }
  }

  StringShapes<T, Modes> shapes_;
  ControlRange<T> range_;
  T max_step_;
  Shapes before_, after_, mean_, change_;
  T place_ = 0;
  bool is_moving_ = false;
};

/// Corrects a compression that is updated by increments, whose rounding errors add up. While the contact is open by
/// both values it holds no energy and is `by_displacements_m`: a body that comes back from afar must not be pressed
/// into the contact by the errors of its flight. While it touches, it moves by 1e-4 of the difference: the
/// displacements are rounded too, and a stiff contact would turn that rounding into audible noise.
template <std::floating_point T>
[[nodiscard]] T anchored(T compression_m, T by_displacements_m) {
  if (compression_m < 0 && by_displacements_m < 0) return by_displacements_m;
  return compression_m + T(1e-4) * (by_displacements_m - compression_m);
}

}  // namespace contactspline
