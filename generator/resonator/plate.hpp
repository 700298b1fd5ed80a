// SPDX-License-Identifier: MIT
// A rectangular plate of one material or of wood, and the ribs that it may have.
#pragma once

#include <memory>

#include "contactspline/data/stiff_string.hpp"

namespace contactspline {

/// A straight bar that is glued on a plate between two places, seen from a corner: it bends with the plate and moves
/// with its mass. Its torsion and the inertia of its rotation are left out.
struct Rib {
  double from_m, from_across_m, to_m, to_across_m;
  double mass_per_length_kg_m;    ///< >= 0
  double bending_stiffness_n_m2;  ///< what it adds to the plate along its line; >= 0
};

class RibbedPlate;  // ribbed_plate.hpp

/// Simply supported rectangular plate of an orthotropic material, thin (Kirchhoff): w0^2 = (Dx kx^4 + 2 H kx^2 ky^2 +
/// Dy ky^4)/(density thickness), kx = m pi/length, ky = n pi/width. Dx = Ex h^3/(12 (1 - nu_xy nu_yx)), Dy likewise,
/// nu_yx = nu_xy Ey/Ex, H = nu_yx Dx + G h^3/6 (S. G. Lekhnitskii, Anisotropic Plates, 1968). Shapes sin(kx x) sin(ky
/// y), modal mass a quarter of the plate's. beta^2 = kx^2 + ky^2 counts for the losses. Place: x and y [m] from a
/// corner.
struct Plate {
  double length_m, width_m;  ///< along x and y
  double thickness_m;
  double density_kg_m3;
  double youngs_modulus_pa;         ///< along x
  double youngs_modulus_across_pa;  ///< along y
  double shear_modulus_pa;
  double poisson_ratio;  ///< nu_xy: shortening along y per stretch along x; nu_xy^2 Ey/Ex < 1, H >= 0
  Losses losses;
  std::shared_ptr<const RibbedPlate> ribbed = {};  ///< with ribs glued on it, if it has any
};

/// Bending stiffnesses of a plate [N m]: along x, along y, and H of the mixed term.
struct PlateStiffness {
  double along, across, mixed;
};
[[nodiscard]] PlateStiffness bending_stiffness(const Plate& plate);

}  // namespace contactspline
