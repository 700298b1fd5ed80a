// SPDX-License-Identifier: MIT
// What the figures of a fit draw: data and model over what they were measured at.
#pragma once

#include "generator/fit/measurements.hpp"

namespace contactspline {

/// What data of one kind are drawn over, and how.
struct PanelOfFit {
  const char* quantity;  ///< FitQuality::quantity
  const char* at;
  const char* value;
  bool from_begin;   ///< each source from its own begin on
  bool is_relative;  ///< residuals in % of each value, else of the largest one; those of levels are in dB
  double at_scale, value_scale;
};

inline constexpr PanelOfFit kFitPanels[] = {
    {"force", "time [ms]", "force [N]", true, false, 1e3, 1},
    {"duration", "impact speed [m/s]", "contact duration [ms]", false, true, 1, 1e3},
    {"largest force", "impact speed [m/s]", "largest force [N]", false, true, 1, 1},
    {"restitution", "impact speed [m/s]", "restitution [1]", false, true, 1, 1},
    {kLevels, "frequency [kHz]", "level [dB]", false, false, 1e-3, 1},
    {"force over compression", "compression [mm]", "force [N]", false, false, 1e3, 1}};

}  // namespace contactspline
