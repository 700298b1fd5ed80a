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

/// The parameters of a fret-string.
struct FretStringParameter {
  enum : std::size_t { kPlace, kGap, kPluckForce, kDamping, kStiffnessRatio, kLoss, kPluck, kParameters };
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  static constexpr std::array<Parameter, kParameters> kList = {
      {{"place_m", "m", {0, 100}, {0, 100}, kNaN, Scale::kLinear, Acts::kAtOnce, 0.02, 1},
       {"gap_m", "m", {-0.1, 0.1}, {-0.002, 0.005}, kNaN, Scale::kLinear, Acts::kAtOnce, 0.02},
       {"pluck_force_n", "N", {-1e3, 1e3}, {-10, 10}, 0, Scale::kLinear, Acts::kAtOnce, 0.005},
       {"damping_per_s", "1/s", {0, 1e5}, {0, 1000}, 0, Scale::kLinear, Acts::kAtOnce, 0.005},
       {"stiffness_ratio", "", {1e-6, 1e6}, {0.001, 1000}, 1, Scale::kLogarithmic, Acts::kAtOnce, 0.005},
       {"loss_s_per_m", "s/m", {0, 1e3}, {0, 2}, kNaN},
       {"pluck_n", "N", {-1e3, 1e3}, {0, 10}, 1.5, Scale::kLinear, Acts::kAtNextNote}}};
  static constexpr std::array<Event, 1> kEvents = {{{"pluck", EventKind::kPluck, 0, kPluck}}};
};

namespace detail {
template <typename T>
using DynamicFretString = FretString<T>;
}  // namespace detail

/// A plucked string over a fret (docs/how-to/fret-string.md). Meets Instrument.
template <std::floating_point T>
class FretStringInstrument : public FretStringParameter,
                             public PluckedStringInstrument<FretStringInstrument<T>, detail::DynamicFretString, T,
                                                            FretStringParameter::kParameters> {
  using Base = PluckedStringInstrument<FretStringInstrument, detail::DynamicFretString, T, kParameters>;
  friend Base;

 public:
  explicit FretStringInstrument(PluckedStringParts parts) : Base(std::move(parts), kList) {
    this->set_first(kGap, 0.0003);
  }

  static const char* name() { return "fret_string"; }
  static const char* description() { return "Plucked string that buzzes against a fret without iteration"; }
  static std::span<const Event> events() { return kEvents; }

 private:
  void put() { this->contact_model().place(this->value_of(kPlace), this->value_of(kGap)); }

  FretStringControls<T> controls() {
    return {.place_m = this->value_of(kPlace),
            .gap_m = this->value_of(kGap),
            .pluck_force_n = this->plucked(kPluckForce),
            .damping_per_s = this->value_of(kDamping),
            .contact = {this->value_of(kStiffnessRatio), this->value_of(kLoss)}};
  }
};

}  // namespace contactspline
