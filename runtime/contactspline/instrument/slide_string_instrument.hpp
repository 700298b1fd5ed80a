// SPDX-License-Identifier: MIT
// A slide on a string as an instrument.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "contactspline/instrument/plucked_string_instrument.hpp"
#include "contactspline/models/slide_string.hpp"

namespace contactspline {

/// A plucked string under a slide with vibrato (docs/how-to/slide-string.md). Meets Instrument.
template <std::floating_point T>
class SlideStringInstrument
    : public PluckedStringInstrument<SlideStringInstrument<T>, SlideString<T>, T, SlideStringParameter> {
  using Base = PluckedStringInstrument<SlideStringInstrument, SlideString<T>, T, SlideStringParameter>;
  friend Base;
  using P = SlideStringParameter;

 public:
  explicit SlideStringInstrument(PluckedStringParts parts) : Base(std::move(parts)) {
    this->set_initial(P::kSlideMass, 0.02);
    this->set_initial(P::kVibratoRate, 5.5);
  }

  static const char* name() { return "slide_string"; }
  static const char* description() { return "Slide on a string: glissando, vibrato and rattling without iteration"; }

 private:
  void put() {
    this->contact_model().place(this->value_of(P::kPlace), static_cast<T>(this->parts().height_m));
    phase_ = 0;
  }

  SlideStringControls<T> controls() {
    return {.place_m = static_cast<T>(place()),
            .slide_mass_kg = this->value_of(P::kSlideMass),
            .hand_force_n = this->value_of(P::kHandForce),
            .hand_stiffness_n_per_m = this->value_of(P::kHandStiffness),
            .hand_resistance_n_s_per_m = this->value_of(P::kHandResistance),
            .rest_resistance_n_s_per_m = this->value_of(P::kRestResistance),
            .pluck_force_n = this->plucked(P::kPluckForce),
            .contact = {this->value_of(P::kStiffnessRatio), this->value_of(P::kLoss)}};
  }

  // A vibrato at rest moves nothing.
  [[nodiscard]] bool is_contact_at_rest(double limit_j) const {
    const double velocity = double(this->model().slide_velocity()), height_m = double(this->model().slide());
    const double energy_j =
        (this->value(P::kSlideMass) * velocity * velocity + this->value(P::kHandStiffness) * height_m * height_m) / 2;
    return this->value(P::kHandForce) == 0 && energy_j < limit_j && this->has_arrived(this->value(P::kVibratoDepth));
  }

  [[nodiscard]] bool is_contact_held(double limit_j) const {
    const auto& acting = this->model().controls();
    const double velocity = double(this->model().slide_velocity());
    return this->value(P::kSlideMass) * velocity * velocity / 2 < limit_j && this->has_arrived() &&
           (this->value(P::kVibratoDepth) == 0 || this->value(P::kVibratoRate) == 0) &&
           acting.hand_stiffness_n_per_m == this->value_of(P::kHandStiffness) &&
           acting.contact.stiffness_ratio == this->value_of(P::kStiffnessRatio);
  }

  double place() {
    phase_ += this->value(P::kVibratoRate) / this->sample_rate_hz();
    phase_ -= std::floor(phase_);
    const double vibrato_m = this->value(P::kVibratoDepth) * std::sin(2 * std::numbers::pi * phase_);
    return std::clamp(this->value(P::kPlace) + vibrato_m, 0.0, this->parts().resonator.length_m);
  }

  double phase_ = 0;  // periods of the vibrato
};

}  // namespace contactspline
