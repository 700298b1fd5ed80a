// SPDX-License-Identifier: MIT
// A slide pressed on a string by a hand, moving along it.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "contactspline/contact.hpp"
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

  [[nodiscard]] std::size_t size() const { return wavenumbers_.size(); }

 private:
  std::vector<T> wavenumbers_;
};

/// Live controls of the slide-string model.
template <std::floating_point T>
struct SlideStringControls {
  T place_m;                        ///< of the slide along the string, within its length
  T slide_mass_kg;                  ///< > 0
  T hand_force_n = 0;               ///< presses the slide on the string
  T hand_stiffness_n_per_m = 0;     ///< holds the slide at height 0, >= 0
  T hand_resistance_n_s_per_m = 0;  ///< damps the slide, >= 0
  T rest_resistance_n_s_per_m =
      0;                ///< of the fingers that rest on the string between the slide and its end at 0, >= 0
  T pluck_force_n = 0;  ///< pushes the string at the place of the pluck
  ContactControls<T> contact = {};
};

/// A slide of some mass on a modal string. Displacements count towards the string: compression = slide - string. The
/// contact follows the place exactly: where the slide moves along a bent string, the hand does the work
/// -f sum(mean q, change of shape), so that energy is balanced to rounding (docs/slide-string.md).
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class SlideString {
 public:
  SlideString(SegmentTable<T, Extent> table, std::span<const Mode> modes, StringShapes<T> shapes, T pluck_place_m,
              double sample_rate_hz)
      : table_(table), string_(modes, sample_rate_hz), shapes_(std::move(shapes)), time_step_(T(1 / sample_rate_hz)) {
    for (auto* at : {&pluck_, &before_, &after_, &mean_, &change_, &rest_}) *at = ModeShapes<T>(shapes_.size());
    shapes_.at(pluck_place_m, pluck_);
  }

  /// Puts the slide at a place [m] along the string and a height [m] before it (0 touches the string at rest).
  void place(T place_m, T height_m) {
    place_ = place_m;
    is_still_ = false;
    shapes_.at(place_m, before_);
    slide_ = -height_m;
    velocity_ = 0;
    compression_ = slide_ - string_.displacement(before_);
  }

  /// Advances one sample. Safe in an audio thread: no allocation, no lock, bounded time.
  void tick(const SlideStringControls<T>& controls) {
    move_to(controls.place_m);
    string_.predict();
    string_.push(pluck_, controls.pluck_force_n);
    const Rest rest = rest_of(controls);
    const Slide slide = slide_of(controls);
    const T bend = string_.displacement(change_);
    const T free = string_.increment(after_) - rest.share * rest.increment * rest.at_slide_end;
    const T give = string_.admittance(after_, mean_) - rest.share * rest.at_slide_end * rest.at_slide;
    const Approach<T> approach{compression_, slide.free_increment - free - bend, slide.admittance + give};
    force_ = contact_force(table_, controls.contact, time_step_, approach);
    rest_force_ = -rest.share * (rest.increment + rest.at_slide * force_);
    string_.push(mean_, force_);
    string_.push(rest_, rest_force_);
    pull_ = string_.middle(change_);
    string_.commit();
    compression_ += approach.free_increment - approach.admittance * force_;
    advance_slide(controls, slide);
    std::swap(before_, after_);
  }

  [[nodiscard]] T force() const { return force_; }                ///< contact force over the last sample [N]
  [[nodiscard]] T compression() const { return compression_; }    ///< of the contact, negative while apart [m]
  [[nodiscard]] T slide() const { return slide_; }                ///< height of the slide, towards the string [m]
  [[nodiscard]] T slide_velocity() const { return velocity_; }    ///< towards the string [m/s]
  [[nodiscard]] T rest_force() const { return rest_force_; }      ///< of the fingers on the string [N]
  [[nodiscard]] T work_along() const { return -force_ * pull_; }  ///< of the hand along the string, last sample [J]
  [[nodiscard]] const ModalBank<T>& string() const { return string_; }

 private:
  /// The resting fingers, a viscous resistance condensed: force = -share (increment + at_slide f).
  struct Rest {
    T share, increment, at_slide, at_slide_end;
  };
  /// The slide between hand and string, midpoint rule: way over the sample = free_increment - admittance f.
  struct Slide {
    T free_increment, admittance;
  };

  void move_to(T place) {
    if (place == place_ && is_still_) return;
    is_still_ = place == place_;
    place_ = place;
    shapes_.at(place, after_);
    shapes_.at(place / 2, rest_);
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
      mean_[i] = (before_[i] + after_[i]) / 2;
      change_[i] = after_[i] - before_[i];
    }
    // once the slide has stood for a sample, before_ and after_ are the same and nothing needs to be computed again
  }

  Rest rest_of(const SlideStringControls<T>& controls) const {
    const T rate = controls.rest_resistance_n_s_per_m / time_step_;
    if (!(rate > 0)) return {};
    return {rate / (1 + rate * string_.admittance(rest_, rest_)), string_.increment(rest_),
            string_.admittance(rest_, mean_), string_.admittance(rest_, after_)};
  }

  Slide slide_of(const SlideStringControls<T>& controls) const {
    const T dt = time_step_;
    const T give = dt * dt / (2 * controls.slide_mass_kg);
    const T divisor = 1 + give * (controls.hand_stiffness_n_per_m / 2 + controls.hand_resistance_n_s_per_m / dt);
    const T press = controls.hand_force_n - controls.hand_stiffness_n_per_m * slide_;
    return {(dt * velocity_ + give * press) / divisor, give / divisor};
  }

  void advance_slide(const SlideStringControls<T>& controls, const Slide& slide) {
    const T way = slide.free_increment - slide.admittance * force_;
    const T pull =
        controls.hand_stiffness_n_per_m * (slide_ + way / 2) + controls.hand_resistance_n_s_per_m * way / time_step_;
    velocity_ += time_step_ / controls.slide_mass_kg * (controls.hand_force_n - pull - force_);
    slide_ += way;
  }

  SegmentTable<T, Extent> table_;
  ModalBank<T> string_;
  StringShapes<T> shapes_;
  ModeShapes<T> pluck_, before_, after_, mean_, change_, rest_;
  T time_step_;
  T place_ = 0;
  T slide_ = 0;
  T velocity_ = 0;
  T compression_ = 0;
  T force_ = 0;
  T rest_force_ = 0;
  T pull_ = 0;
  bool is_still_ = false;
};

}  // namespace contactspline
