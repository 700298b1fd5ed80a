// SPDX-License-Identifier: MIT
#include "generator/resonator/plate.hpp"

#include <cmath>

namespace contactspline {

PlateStiffness bending_stiffness(const Plate& plate) {
  const double other_ratio = plate.poisson_ratio * plate.youngs_modulus_across_pa / plate.youngs_modulus_pa;
  const double cube = std::pow(plate.thickness_m, 3) / 12;
  const double along = plate.youngs_modulus_pa * cube / (1 - plate.poisson_ratio * other_ratio);
  return {along, along * plate.youngs_modulus_across_pa / plate.youngs_modulus_pa,
          other_ratio * along + 2 * plate.shear_modulus_pa * cube};
}

}  // namespace contactspline
