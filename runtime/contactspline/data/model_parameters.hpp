// SPDX-License-Identifier: MIT
// The parameters and events of the models that instruments are built of by hand.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <cstddef>
#include <limits>

#include "contactspline/data/parameter.hpp"

namespace contactspline {

/// The parameters of a hammer-string.
struct HammerStringParameter {
  enum : std::size_t { kHammerMass, kStiffnessRatio, kLoss, kDamping, kPlace, kBend, kSpeed, kSustain, kParameters };
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  // the parts decide
  static constexpr std::array<Parameter, kParameters> kList = {
      {{"hammer_mass_kg", "kg", {1e-6, 100}, {0.0005, 0.05}, kNaN, Scale::kLogarithmic, Acts::kAtNextNote},
       {"stiffness_ratio", "", {1e-6, 1e6}, {0.001, 1000}, 1, Scale::kLogarithmic, Acts::kAtNextNote, 0, 74},
       {"loss_s_per_m", "s/m", {0, 1e3}, {0, 2}, kNaN, Scale::kLinear, Acts::kAtNextNote},
       {"damping_per_s", "1/s", {0, 1e5}, {0, 1000}, 0, Scale::kLinear, Acts::kAtOnce, 0.005},
       {"strike_m", "m", {0, 100}, {0, 100}, kNaN, Scale::kLinear, Acts::kAtNextNote},
       {"bend_cents",
        "cents",
        ControlRanges<double>::bend_cents,
        {-200, 200},
        0,
        Scale::kLinear,
        Acts::kAtOnce,
        0,
        0,
        16},
       {"speed_m_per_s", "m/s", {1e-3, 100}, {0.05, 10}, 2.5, Scale::kLinear, Acts::kAtNextNote},
       {"sustain", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtOnce, 0, 64}}};
  static constexpr std::size_t kOfKeys = kSpeed;  ///< so many of them each key of a keyboard has, too
  static constexpr std::array<Event, 1> kEvents = {{{"strike", EventKind::kStrike, 0, kSpeed}}};
};

/// The parameters of a mass-barrier.
struct MassBarrierParameter {
  enum : std::size_t { kMass, kGravity, kStiffnessRatio, kLoss, kStart, kSpeed, kParameters };
  static constexpr std::array<Parameter, kParameters> kList = {
      {{"mass_kg", "kg", {1e-9, 1e4}, {1e-4, 1}, 0.003, Scale::kLogarithmic},
       {"gravity_m_per_s2", "m/s2", {-1e3, 1e3}, {0, 1e3}, 0},
       {"stiffness_ratio", "", {1e-6, 1e6}, {0.01, 100}, 1, Scale::kLogarithmic},
       {"loss_s_per_m", "s/m", {0, 1e3}, {0, 2}, 0},
       {"start_m", "m", {-1e3, 1e3}, {-0.1, 0}, -0.001, Scale::kLinear, Acts::kAtNextNote},
       {"speed_m_per_s", "m/s", {-1e3, 1e3}, {0, 10}, 2, Scale::kLinear, Acts::kAtNextNote}}};
  static constexpr std::array<Event, 1> kEvents = {{{"throw", EventKind::kStrike, 0, kSpeed}}};
};

/// The parameters of a keyboard on its body, for all keys.
struct KeyboardParameter {
  enum : std::size_t { kHardness, kMassRatio, kLoss, kSustain, kSostenuto, kUnaCorda, kBend, kKnock, kParameters };
  static constexpr std::array<Parameter, kParameters> kList = {
      {{"stiffness_ratio", "", {1e-6, 1e6}, {0.05, 20}, 1, Scale::kLogarithmic, Acts::kAtNextNote, 0, 74},
       {"mass_ratio", "", {1e-6, 1e6}, {0.25, 4}, 1, Scale::kLogarithmic, Acts::kAtNextNote},
       {"loss_s_per_m", "s/m", {0, 1e3}, {0, 2}, 0, Scale::kLinear, Acts::kAtNextNote},
       {"sustain", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtOnce, 0, 64, 16},
       {"sostenuto", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtOnce, 0, 66, 16},
       {"una_corda", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtNextNote, 0, 67, 16},
       {"bend_cents",
        "cents",
        ControlRanges<double>::bend_cents,
        {-200, 200},
        0,
        Scale::kLinear,
        Acts::kAtOnce,
        0,
        0,
        16},
       {"knock_ratio", "", {0, 1000}, {0, 4}, 1, Scale::kLinear, Acts::kAtNextNote}}};
  static constexpr std::array<Output, 2> kOutputs = {
      {{"left_velocity_m_per_s", "m/s", 1.0 / 12}, {"right_velocity_m_per_s", "m/s", 1.0 / 12}}};
  /// With ears in the room.
  static constexpr std::array<Output, 2> kPressureOutputs = {
      {{"left_pressure_pa", "Pa", 20}, {"right_pressure_pa", "Pa", 20}}};
};

}  // namespace contactspline
