// SPDX-License-Identifier: MIT
// A plucked string that buzzes against a fret.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>
#include <utility>

#include "contactspline/models/contact_on_string.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline {

/// Live controls of the fret-string model. Their ranges are those of ControlRanges (docs/reference/controls.md).
template <std::floating_point T>
struct FretStringControls {
  T place_m;  ///< place of the fret on the string, 0 to its length (MovingPlace::move_to)
  T gap_m;    ///< distance from the string at rest to the fret, which follows at 1 m/s; negative: the fret lifts the
              ///< string
  T pluck_force_n = 0;  ///< pushes the string at the pluck, towards the fret
  T damping_per_s = 0;  ///< a hand that damps the string: extra decay of every mode
  ContactControls<T> contact = {};
};

/// A modal string over a fret on a rigid neck. Displacements are positive towards the fret: compression = string -
/// gap. Moving the fret, along the string or towards it, does the work work_of_fret(). With this work the energy
/// balance is exact up to rounding (docs/how-to/fret-string.md).
/// Modes: their number, if it is known at compile time: then the model needs no heap
/// (docs/how-to/microcontrollers.md).
template <std::floating_point T, std::size_t Extent = std::dynamic_extent, std::size_t Modes = std::dynamic_extent>
class FretString : public detail::ContactOnString<T, Extent, Modes> {
  using Base = detail::ContactOnString<T, Extent, Modes>;

 public:
  using Base::Base;  // FretString(fret, modes, shapes, pluck_place_m, sample_rate_hz, memories)
  using Base::place;

  /// Sets the fret at a place [m] along the string, at a distance [m], -0.1 to 0.1, from the string at rest. Does
  /// nothing if one of them is not a number. The contact forgets what it remembers.
  void place(T place_m, T gap_m) {
    if (!is_number(place_m) || !is_number(gap_m)) return;
    place_.put(place_m);
    gap_ = held(gap_, gap_m, Ranges::gap_m);
    compression_ = string_.displacement(place_.after()) - gap_;
    force_ = work_of_fret_ = 0;
    memory_.reset();
    is_placed_ = true;
  }

  /// Brings the string to rest. The fret stays where it is, and so do the last controls. Does not allocate.
  void reset() {
    string_.reset();
    place(place_.place(), gap_);
  }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick(const FretStringControls<T>& controls) {
    compression_ = anchored(compression_, string_.displacement(place_.after()) - gap_);
    follow(controls);
    place_.move_to(controls.place_m);
    const T lift = move_gap(controls.gap_m);
    const T damping = damping_per_s_ * time_step_;
    const T damping_gain = 1 / (1 + damping);
    if (damping > 0)
      string_.predict(damping);
    else
      string_.predict();
    string_.push(pluck_, damping_gain * pluck_force_);
    const T receptance = damping_gain * string_.receptance(place_.after(), place_.mean());
    const Approach<T> approach{compression_,
                               string_.increment(place_.after()) + string_.displacement(place_.change()) + lift,
                               (std::max)(receptance, kMinReceptance)};
    const auto step = memory_.advance(table_, contact_, time_step_, approach, segment_index(table_, compression_));
    force_ = step.force;
    string_.push(place_.mean(), -damping_gain * force_);
    work_of_fret_ = force_ * (string_.middle(place_.change()) + lift);
    string_.commit();
    compression_ = step.compression;
  }

  /// Work that the moving fret did on the string over the last sample [J].
  [[nodiscard]] T work_of_fret() const { return work_of_fret_; }
  [[nodiscard]] T gap() const { return gap_; }  ///< at the end of the last sample [m]
  /// The ratio in effect. While the contact is loaded it lags behind a control that rises.
  [[nodiscard]] T stiffness_ratio() const { return contact_.stiffness_ratio; }
  /// Energy of string and contact [J].
  [[nodiscard]] double energy() const { return this->energy_with(contact_); }

 private:
  using Ranges = ControlRanges<T>;
  using Base::compression_, Base::force_, Base::is_placed_, Base::memory_, Base::place_, Base::pluck_, Base::string_,
      Base::table_, Base::time_step_;
  static constexpr T kGapSpeed_m_per_s = 1;

  void follow(const FretStringControls<T>& controls) {
    pluck_force_ = held(pluck_force_, controls.pluck_force_n, Ranges::force_n);
    damping_per_s_ = held(damping_per_s_, controls.damping_per_s, Ranges::damping_per_s);
    contact_ = std::exchange(is_placed_, false)
                   ? held(contact_, controls.contact)
                   : followed_contact(memory_, table_, compression_, contact_, controls.contact, time_step_);
  }

  // Returns by how much the fret rises towards the string [m]. A fret that jumped would do work without bound.
  T move_gap(T gap_m) {
    const T before = gap_, target = held(gap_, gap_m, Ranges::gap_m), max_step = kGapSpeed_m_per_s * time_step_;
    gap_ = std::abs(target - gap_) < max_step ? target : target > gap_ ? gap_ + max_step : gap_ - max_step;
    return before - gap_;
  }

  // [m/N]. At the very end of the string the receptance is 0; the contact step needs one > 0.
  static constexpr T kMinReceptance = T(1e-18);

  T pluck_force_ = 0, damping_per_s_ = 0;
  ContactControls<T> contact_;
  T gap_ = 0;
  T work_of_fret_ = 0;
};

}  // namespace contactspline
