// SPDX-License-Identifier: MIT
// What surfaces rub with: bristles and the heat that weakens them.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include "contactspline/step/friction.hpp"
#include "contactspline/step/friction_heat.hpp"

namespace contactspline {

/// Two surfaces that rub on each other.
struct FrictionMaterial {
  Bristles bristles;
  FrictionHeat heat;
};

/// Rosin between hair and string (M. van Walstijn, V. Chatziioannou, M. Lampis and A. Matusiak, Acta Acustica 10,
/// 2026).
inline constexpr FrictionMaterial kRosin{.bristles = {.stiffness_per_m = 1e6},
                                         .heat = {.cold_coefficient = 1.05,
                                                  .hot_coefficient = 0.12,
                                                  .softening_k = 25,
                                                  .capacity_j_per_n_k = 1e-6,
                                                  .conduction_w_per_n_k = 1e-4,
                                                  .renewal_w_per_m_k2 = 0.22 * 0.22}};

/// Surfaces whose coefficient of friction is constant.
[[nodiscard]] constexpr FrictionMaterial coulomb_friction(double coefficient, const Bristles& bristles) {
  return {bristles, {.cold_coefficient = coefficient, .hot_coefficient = coefficient}};
}

}  // namespace contactspline
