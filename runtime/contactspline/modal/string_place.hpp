// SPDX-License-Identifier: MIT
// Mode shapes at any place of a string, and a contact that moves along the string.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
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
      : wavenumbers_(wavenumbers_per_m) {}

  /// Computes the shapes at a place [m], measured from the end where all shapes are sin(0).
  constexpr void at(T place_m, Shapes& shapes) const {
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
  Shapes wavenumbers_;  // only their numbers
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
