// SPDX-License-Identifier: MIT
// One-sided power-law contact potential and its closed forms for a mass on a rigid barrier.
#pragma once

namespace contactspline {

/// V(y) = stiffness/(exponent + 1) y^(exponent + 1) and F(y) = stiffness y^exponent for y > 0, else 0.
/// stiffness > 0 [N/m^exponent], exponent > 0.
struct PowerLaw {
  double stiffness;
  double exponent;

  [[nodiscard]] double energy(double compression_m) const;  ///< V(y) [J]
  [[nodiscard]] double force(double compression_m) const;   ///< dV/dy [N]

  /// ym = ((a + 1) m v^2 / (2 k))^(1/(a + 1)) [m]: all of m v^2/2 stored. mass > 0, speed >= 0.
  [[nodiscard]] double max_compression(double mass_kg, double speed_m_per_s) const;

  /// T = 2 zeta ym / v [s], zeta = sqrt(pi) Gamma(1 + 1/(a + 1)) / Gamma(1/2 + 1/(a + 1)). speed > 0.
  [[nodiscard]] double contact_duration(double mass_kg, double speed_m_per_s) const;
};

}  // namespace contactspline
