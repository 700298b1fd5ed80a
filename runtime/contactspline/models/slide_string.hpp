// SPDX-License-Identifier: MIT
// A slide that a hand presses on a string and moves along it.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <span>
#include <type_traits>
#include <utility>

#include "contactspline/models/contact_on_string.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline {

/// Live controls of the slide-string model. Their ranges are those of ControlRanges (docs/reference/controls.md).
template <std::floating_point T>
struct SlideStringControls {
  T place_m;  ///< place of the slide on the string, 0 to its length (MovingPlace::move_to)
  T slide_mass_kg;
  T hand_force_n = 0;               ///< presses the slide on the string
  T hand_stiffness_n_per_m = 0;     ///< spring that pulls the slide to height 0
  T hand_resistance_n_s_per_m = 0;  ///< damps the slide
  T rest_resistance_n_s_per_m = 0;  ///< of fingers that rest on the string, halfway from end 0 to the slide
  T pluck_force_n = 0;              ///< pushes the string at the pluck
  ContactControls<T> contact = {};
};

/// A slide with mass on a modal string. Displacements are positive towards the string: compression = slide - string.
/// When the slide moves along a bent string, the hand does the work -f sum(mean q, change of shape). With this work
/// the energy balance is exact up to rounding (docs/how-to/slide-string.md). The hand moves the slide at 1000 m/s at
/// most. Modes: their number, if it is known at compile time: then the model needs no heap
/// (docs/how-to/microcontrollers.md).
template <std::floating_point T, std::size_t Extent = std::dynamic_extent, std::size_t Modes = std::dynamic_extent>
class SlideString : public detail::ContactOnString<T, Extent, Modes> {
  using Base = detail::ContactOnString<T, Extent, Modes>;

 public:
  constexpr SlideString(SegmentTable<T, Extent> slide, std::type_identity_t<std::span<const Mode, Modes>> modes,
                        const StringShapes<T, Modes>& shapes, T pluck_place_m, double sample_rate_hz,
                        std::span<const Memory> memories = {})
      : Base(slide, modes, shapes, pluck_place_m, sample_rate_hz, memories), shapes_(shapes), rest_(shapes.size()) {}
  using Base::place;

  /// Sets the slide at a place [m] along the string, at a distance [m], -0.1 to 0.1, from the string at rest (0: it
  /// touches). Does nothing if one of them is not a number. The contact forgets what it remembers.
  void place(T place_m, T height_m) {
    if (!is_number(place_m) || !is_number(height_m)) return;
    place_.put(place_m);
    shapes_.at(place_.place() / 2, rest_);
    height_ = held(height_, height_m, Ranges::height_m);
    slide_ = -height_;
    velocity_ = 0;
    force_ = rest_force_ = mean_shape_change_ = 0;
    compression_ = slide_ - string_.displacement(place_.after());
    memory_.reset();
    is_placed_ = true;
  }

  /// Brings the string to rest, and the slide at the height of the last place(). The last controls stay. Does not
  /// allocate.
  void reset() {
    string_.reset();
    place(place_.place(), height_);
  }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick(const SlideStringControls<T>& controls) {
    compression_ = anchored(compression_, slide_ - string_.displacement(place_.after()));
    follow(controls);
    if (place_.move_to(controls.place_m)) shapes_.at(place_.place() / 2, rest_);
    string_.predict();
    string_.push(pluck_, controls_.pluck_force_n);
    const Fingers fingers = fingers_now();
    const Slide slide = slide_now();
    const T shape_change = string_.displacement(place_.change());
    const T increment =
        string_.increment(place_.after()) - fingers.stiffness * fingers.increment * fingers.receptance_to_end;
    const T receptance = string_.receptance(place_.after(), place_.mean()) -
                         fingers.stiffness * fingers.receptance_to_end * fingers.receptance_to_mean;
    const Approach<T> approach{compression_, slide.free_increment - increment - shape_change,
                               slide.receptance + receptance};
    const auto step =
        memory_.advance(table_, controls_.contact, time_step_, approach, segment_index(table_, compression_));
    force_ = step.force;
    rest_force_ = -fingers.stiffness * (fingers.increment + fingers.receptance_to_mean * force_);
    string_.push(place_.mean(), force_);
    string_.push(rest_, rest_force_);
    mean_shape_change_ = string_.middle(place_.change());
    string_.commit();
    compression_ = step.compression;
    advance_slide(slide);
  }

  [[nodiscard]] T slide() const { return slide_; }              ///< height, positive towards the string [m]
  [[nodiscard]] T slide_velocity() const { return velocity_; }  ///< positive towards the string [m/s]
  [[nodiscard]] T rest_force() const { return rest_force_; }    ///< of the resting fingers on the string [N]
  /// Work of the hand that moved the slide along the string in the last sample [J].
  [[nodiscard]] T work_along() const { return -force_ * mean_shape_change_; }
  /// The controls that act, but for the place: those of the last sample, in their ranges. A stiffness that rises
  /// under load is behind its control.
  [[nodiscard]] const SlideStringControls<T>& controls() const { return controls_; }
  /// Energy of string, contact, slide and of the hand's stiffness [J].
  [[nodiscard]] double energy() const {
    const double v = double(velocity_), u = double(slide_);
    return this->energy_with(controls_.contact) +
           (double(controls_.slide_mass_kg) * v * v + double(controls_.hand_stiffness_n_per_m) * u * u) / 2;
  }

 private:
  using Ranges = ControlRanges<T>;
  using Base::compression_, Base::force_, Base::is_placed_, Base::memory_, Base::place_, Base::pluck_, Base::string_,
      Base::table_, Base::time_step_;

  /// The resting fingers over one sample: a viscous resistance R moves by dq under the force -R/dt dq. Solved for dq,
  /// their force is -stiffness (increment + receptance_to_mean f), where f is the contact force.
  struct Fingers {
    T stiffness;           ///< [N/m]
    T increment;           ///< of the string at the fingers, without f and without the fingers [m]
    T receptance_to_mean;  ///< between the fingers and the slide's mean place in the sample [m/N]
    T receptance_to_end;   ///< between the fingers and the slide's place at the end of the sample [m/N]
  };
  /// The slide over one sample by the midpoint rule: its displacement changes by free_increment - receptance f.
  struct Slide {
    T free_increment, receptance;
  };

  void follow(const SlideStringControls<T>& controls) {
    SlideStringControls<T>& now = controls_;
    const T mass = held(now.slide_mass_kg, controls.slide_mass_kg, Ranges::mass_kg);
    if (mass != now.slide_mass_kg) velocity_ *= velocity_factor(std::exchange(now.slide_mass_kg, mass), mass);
    now.hand_force_n = held(now.hand_force_n, controls.hand_force_n, Ranges::force_n);
    const T hand_stiffness =
        held(now.hand_stiffness_n_per_m, controls.hand_stiffness_n_per_m, Ranges::hand_stiffness_n_per_m);
    now.hand_resistance_n_s_per_m =
        held(now.hand_resistance_n_s_per_m, controls.hand_resistance_n_s_per_m, Ranges::resistance_n_s_per_m);
    now.rest_resistance_n_s_per_m =
        held(now.rest_resistance_n_s_per_m, controls.rest_resistance_n_s_per_m, Ranges::resistance_n_s_per_m);
    now.pluck_force_n = held(now.pluck_force_n, controls.pluck_force_n, Ranges::force_n);
    if (std::exchange(is_placed_, false)) {
      now.hand_stiffness_n_per_m = hand_stiffness;
      now.contact = held(now.contact, controls.contact);
    } else {
      now.hand_stiffness_n_per_m =
          followed_stiffness(now.hand_stiffness_n_per_m, hand_stiffness, slide_ * slide_ / 2, time_step_);
      now.contact = followed_contact(memory_, table_, compression_, now.contact, controls.contact, time_step_);
    }
  }

  Fingers fingers_now() const {
    const T rate = controls_.rest_resistance_n_s_per_m / time_step_;
    if (!(rate > 0)) return {};
    return {rate / (1 + rate * string_.receptance(rest_, rest_)), string_.increment(rest_),
            string_.receptance(rest_, place_.mean()), string_.receptance(rest_, place_.after())};
  }

  Slide slide_now() const {
    const T dt = time_step_;
    const T receptance = dt * dt / (2 * controls_.slide_mass_kg);
    const T divisor =
        1 + receptance * (controls_.hand_stiffness_n_per_m / 2 + controls_.hand_resistance_n_s_per_m / dt);
    const T hand_force = controls_.hand_force_n - controls_.hand_stiffness_n_per_m * slide_;
    return {(dt * velocity_ + receptance * hand_force) / divisor, receptance / divisor};
  }

  void advance_slide(const Slide& slide) {
    const T increment = slide.free_increment - slide.receptance * force_;
    const T reaction = controls_.hand_stiffness_n_per_m * (slide_ + increment / 2) +
                       controls_.hand_resistance_n_s_per_m * increment / time_step_;
    velocity_ += time_step_ / controls_.slide_mass_kg * (controls_.hand_force_n - reaction - force_);
    velocity_ = std::clamp(velocity_, Ranges::speed_m_per_s.min, Ranges::speed_m_per_s.max);
    slide_ += increment;
  }

  StringShapes<T, Modes> shapes_;
  ModeShapes<T, Modes> rest_;  // at the resting fingers
  SlideStringControls<T> controls_{.place_m = 0, .slide_mass_kg = 1};
  T height_ = 0;  // of the last place() [m]
  T slide_ = 0;
  T velocity_ = 0;
  T rest_force_ = 0;
  // Change of the string's displacement below the slide that is due to the change of place, at mid-sample [m].
  T mean_shape_change_ = 0;
};

}  // namespace contactspline
