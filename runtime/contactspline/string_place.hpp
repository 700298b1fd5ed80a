// SPDX-License-Identifier: MIT
// Places on a string, and a place of contact that moves along it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal.hpp"

namespace contactspline {

/// Shapes sin(wavenumber x) of a string's modes at any place.
template <std::floating_point T>
class StringShapes {
 public:
  explicit StringShapes(std::span<const double> wavenumbers_per_m)
      : wavenumbers_(wavenumbers_per_m.begin(), wavenumbers_per_m.end()) {}

  /// Shapes at a place [m] from the end the wavenumbers count from.
  void at(T place_m, ModeShapes<T>& shapes) const {
    for (std::size_t i = 0; i < wavenumbers_.size(); ++i) shapes[i] = std::sin(wavenumbers_[i] * place_m);
  }

  /// How far a place may move in a sample [m] for the string to follow: an eighth of the shortest wave, and a tenth
  /// of the way that the slowest wave makes. modes: those of the wavenumbers.
  [[nodiscard]] T longest_step(std::span<const Mode> modes, double sample_rate_hz) const {
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < wavenumbers_.size(); ++i) {
      const double beta = wavenumbers_[i];
      const double speed = modes[i].angular_frequency_rad_per_s / beta;
      step = std::min({step, std::numbers::pi / 4 / beta, speed / sample_rate_hz / 10});
    }
    return static_cast<T>(step);
  }

  [[nodiscard]] std::size_t size() const { return wavenumbers_.size(); }

 private:
  std::vector<T> wavenumbers_;
};

/// The place of a contact that moves along a string, and how the string's shapes there change over a sample. A force
/// acts by the mean shapes; the string's displacement below the contact changes by sum(after dq) + sum(change q)
/// (docs/slide-string.md).
template <std::floating_point T>
class MovingPlace {
 public:
  /// longest_step_m: StringShapes::longest_step.
  MovingPlace(const StringShapes<T>& shapes, T place_m, T longest_step_m)
      : shapes_(shapes),
        most_(longest_step_m),
        before_(shapes.size()),
        after_(shapes.size()),
        mean_(shapes.size()),
        change_(shapes.size()) {
    put(place_m);
  }

  /// Puts the place somewhere else, without a way there.
  void put(T place_m) {
    place_ = place_m;
    shapes_.at(place_, after_);
    compare_with(after_);
    is_moving_ = false;
  }

  /// Moves towards a place over the coming sample, by the longest step at most: a leap becomes a fast slide, which
  /// the string can follow. Tells whether it moved.
  bool move_to(T place_m) {
    const T way = std::clamp(place_m - place_, -most_, most_);
    if (way == 0 && !is_moving_) return false;
    is_moving_ = way != 0;
    place_ = std::abs(way) < most_ ? place_m : place_ + way;
    std::swap(before_, after_);
    shapes_.at(place_, after_);
    compare_with(before_);
    return true;
  }

  [[nodiscard]] T place() const { return place_; }                       ///< [m]
  [[nodiscard]] const ModeShapes<T>& after() const { return after_; }    ///< shapes at the end of the sample
  [[nodiscard]] const ModeShapes<T>& mean() const { return mean_; }      ///< of the shapes before and after
  [[nodiscard]] const ModeShapes<T>& change() const { return change_; }  ///< of the shapes over the sample

 private:
  void compare_with(const ModeShapes<T>& before) {
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      mean_[i] = (before[i] + after_[i]) / 2;
      change_[i] = after_[i] - before[i];
    }
  }

  StringShapes<T> shapes_;
  T most_;
  ModeShapes<T> before_, after_, mean_, change_;
  T place_ = 0;
  bool is_moving_ = false;
};

/// A compression that is carried along by its increments, drawn a little towards what it is by the displacements
/// themselves: in single precision their roundings would add up over minutes. Little, because those displacements are
/// rounded too, and a stiff contact would make noise of it.
template <std::floating_point T>
[[nodiscard]] T anchored(T compression_m, T by_displacements_m) {
  return compression_m + T(1e-4) * (by_displacements_m - compression_m);
}

}  // namespace contactspline
