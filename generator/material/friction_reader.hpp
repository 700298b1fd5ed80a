// SPDX-License-Identifier: MIT
// Two surfaces that rub, as a friction file describes them (docs/reference/materials.md).
#pragma once

#include <string>
#include <string_view>

#include "contactspline/data/friction_materials.hpp"
#include "contactspline/step/controls.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {

struct RubbingSurfaces {
  std::string name;         ///< lower-case identifier
  std::string description;  ///< one line, may be empty
  FrictionMaterial friction;
  double width_m;  ///< across the motion

  [[nodiscard]] bool warms() const { return friction.heat.cold_coefficient > friction.heat.hot_coefficient; }
};

/// Surfaces that slide for so long that their temperature stays.
struct Sliding {
  double coefficient;
  double temperature_k;  ///< above ambient; infinite where nothing cools them
};

/// Parses the text of a friction file: JSON with comments, SI units in the key names. `file` stands in messages only.
/// Throws BadInput.
[[nodiscard]] RubbingSurfaces parse_friction(std::string_view text, std::string_view file);

/// The coefficient and the temperature at a speed > 0 [m/s] under a normal force > 0 [N]: the balance of
/// FrictionHeat, in which the coefficient falls with the temperature, so that there is one.
[[nodiscard]] Sliding steady_sliding(const RubbingSurfaces& surfaces, double speed_m_per_s, double normal_force_n);

/// The coefficient at a temperature above ambient [K].
[[nodiscard]] double coefficient_at(const RubbingSurfaces& surfaces, double temperature_k);

/// Ranges that instrument files have in common with these.
inline constexpr Range kFrictionCoefficient{ControlRanges<double>::friction_coefficient.min,
                                            ControlRanges<double>::friction_coefficient.max};
inline constexpr Range kBristleStiffness_per_m{1e3, 1e9};
inline constexpr Range kRubbingWidth_m{1e-4, 1};

}  // namespace contactspline
