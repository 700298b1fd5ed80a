// SPDX-License-Identifier: MIT
#include "generator/potential.hpp"

#include <cmath>
#include <numbers>

namespace contactspline {

double PowerLaw::energy(double compression_m) const {
  return compression_m > 0 ? stiffness / (exponent + 1) * std::pow(compression_m, exponent + 1) : 0.0;
}

double PowerLaw::force(double compression_m) const {
  return compression_m > 0 ? stiffness * std::pow(compression_m, exponent) : 0.0;
}

double PowerLaw::max_compression(double mass_kg, double speed_m_per_s) const {
  const double energy_j = mass_kg * speed_m_per_s * speed_m_per_s / 2;
  return std::pow((exponent + 1) * energy_j / stiffness, 1 / (exponent + 1));
}

double PowerLaw::contact_duration(double mass_kg, double speed_m_per_s) const {
  const double root = 1 / (exponent + 1);
  const double zeta = std::sqrt(std::numbers::pi) * std::tgamma(1 + root) / std::tgamma(0.5 + root);
  return 2 * zeta * max_compression(mass_kg, speed_m_per_s) / speed_m_per_s;
}

}  // namespace contactspline
