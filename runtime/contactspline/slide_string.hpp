// SPDX-License-Identifier: MIT
// A slide pressed on a string by a hand, moving along it.
#pragma once

#include "contactspline/contact.hpp"
#include "contactspline/modal.hpp"
#include "contactspline/string_place.hpp"

namespace contactspline {

/// Live controls of the slide-string model.
template <std::floating_point T>
struct SlideStringControls {
  T place_m;                        ///< of the slide along the string, within its length (MovingPlace::move_to)
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
  SlideString(SegmentTable<T, Extent> table, std::span<const Mode> modes, const StringShapes<T>& shapes,
              T pluck_place_m, double sample_rate_hz)
      : table_(table),
        string_(modes, sample_rate_hz),
        shapes_(shapes),
        place_(shapes, pluck_place_m, shapes.longest_step(modes, sample_rate_hz)),
        pluck_(shapes.size()),
        rest_(shapes.size()),
        time_step_(T(1 / sample_rate_hz)) {
    shapes_.at(pluck_place_m, pluck_);
  }

  /// Puts the slide at a place [m] along the string and a height [m] before it (0 touches the string at rest).
  void place(T place_m, T height_m) {
    place_.put(place_m);
    shapes_.at(place_m / 2, rest_);
    slide_ = -height_m;
    velocity_ = 0;
    compression_ = slide_ - string_.displacement(place_.after());
  }

  /// Advances one sample. Safe in an audio thread: no allocation, no lock, bounded time.
  void tick(const SlideStringControls<T>& controls) {
    compression_ = anchored(compression_, slide_ - string_.displacement(place_.after()));
    if (place_.move_to(controls.place_m)) shapes_.at(place_.place() / 2, rest_);
    string_.predict();
    string_.push(pluck_, controls.pluck_force_n);
    const Rest rest = rest_of(controls);
    const Slide slide = slide_of(controls);
    const T bend = string_.displacement(place_.change());
    const T free = string_.increment(place_.after()) - rest.share * rest.increment * rest.at_slide_end;
    const T give = string_.admittance(place_.after(), place_.mean()) - rest.share * rest.at_slide_end * rest.at_slide;
    const Approach<T> approach{compression_, slide.free_increment - free - bend, slide.admittance + give};
    force_ = contact_force(table_, controls.contact, time_step_, approach);
    rest_force_ = -rest.share * (rest.increment + rest.at_slide * force_);
    string_.push(place_.mean(), force_);
    string_.push(rest_, rest_force_);
    pull_ = string_.middle(place_.change());
    string_.commit();
    compression_ += approach.free_increment - approach.admittance * force_;
    advance_slide(controls, slide);
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

  Rest rest_of(const SlideStringControls<T>& controls) const {
    const T rate = controls.rest_resistance_n_s_per_m / time_step_;
    if (!(rate > 0)) return {};
    return {rate / (1 + rate * string_.admittance(rest_, rest_)), string_.increment(rest_),
            string_.admittance(rest_, place_.mean()), string_.admittance(rest_, place_.after())};
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
  MovingPlace<T> place_;
  ModeShapes<T> pluck_, rest_;
  T time_step_;
  T slide_ = 0;
  T velocity_ = 0;
  T compression_ = 0;
  T force_ = 0;
  T rest_force_ = 0;
  T pull_ = 0;
};

}  // namespace contactspline
