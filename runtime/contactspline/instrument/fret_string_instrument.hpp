// SPDX-License-Identifier: MIT
// A plucked string that buzzes against a fret, as an instrument.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

#include "contactspline/instrument/plucked_string_instrument.hpp"
#include "contactspline/models/fret_string.hpp"

namespace contactspline {

/// A plucked string over a fret (docs/how-to/fret-string.md). Meets Instrument.
template <std::floating_point T>
class FretStringInstrument
    : public PluckedStringInstrument<FretStringInstrument<T>, FretString<T>, T, FretStringParameter> {
  using Base = PluckedStringInstrument<FretStringInstrument, FretString<T>, T, FretStringParameter>;
  friend Base;
  using P = FretStringParameter;

 public:
  explicit FretStringInstrument(PluckedStringParts parts) : Base(std::move(parts)) {
    this->set_initial(P::kGap, 0.0003);
  }

  static const char* name() { return "fret_string"; }
  static const char* description() { return "Plucked string that buzzes against a fret without iteration"; }

 private:
  void put() { this->contact_model().place(this->value_of(P::kPlace), this->value_of(P::kGap)); }

  [[nodiscard]] bool is_contact_at_rest(double) const {
    return this->model().gap() == this->value_of(P::kGap) && this->has_arrived();
  }

  [[nodiscard]] bool is_contact_held(double limit_j) const {
    return is_contact_at_rest(limit_j) && this->model().stiffness_ratio() == this->value_of(P::kStiffnessRatio);
  }

  FretStringControls<T> controls() {
    return {.place_m = this->value_of(P::kPlace),
            .gap_m = this->value_of(P::kGap),
            .pluck_force_n = this->plucked(P::kPluckForce),
            .damping_per_s = this->value_of(P::kDamping),
            .contact = {this->value_of(P::kStiffnessRatio), this->value_of(P::kLoss)}};
  }
};

}  // namespace contactspline
