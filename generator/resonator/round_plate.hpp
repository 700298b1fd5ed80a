// SPDX-License-Identifier: MIT
// The modes of a circular plate with a free or a clamped rim, and how it stretches where it moves far: a gong, a
// cymbal.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/data/stretch_form.hpp"

namespace contactspline {

/// How the rim of a circular plate is held: not at all, or in its place and its direction.
enum class PlateRim { kFree, kClamped };

/// Circular plate of one material, thin (Kirchhoff): w0 = beta^2 sqrt(D/(density thickness)), D = E h^3/(12 (1 -
/// nu^2)). The shapes are (J_m(beta r) + c I_m(beta r)) cos(m angle), with beta and c from the conditions at the rim
/// (A. W. Leissa, Vibration of Plates, 1969); the modal mass is density thickness times the integral of the squared
/// shape. As on a membrane the modes are those that are symmetric about the angle 0, unless the other ones, sin(m
/// angle), are asked for, too. The rigid motions of a plate with a free rim are no modes here. Place: radius [m] and
/// angle [rad].
struct RoundPlate {
  double radius_m;
  double thickness_m;
  double density_kg_m3;
  double youngs_modulus_pa;
  double poisson_ratio;  ///< 0 to 0.499
  Losses losses;
  PlateRim rim = PlateRim::kFree;
  bool has_both_symmetries = false;  ///< modes with sin(m angle), too
};

/// Mode i = 1, 2, ... with m = `order` nodal diameters, without losses.
[[nodiscard]] UndampedMode undamped_mode(const RoundPlate& plate, int order, int i);

/// Angular frequency of a mode with this root beta R.
[[nodiscard]] double frequency_at(const RoundPlate& plate, double root);

/// A value of beta R below which any plate has more than so many modes: of the symmetric ones there are about (beta
/// R)^2/8 (H. Weyl).
[[nodiscard]] double root_above(std::size_t modes);

/// J_m(beta r) + c I_m(beta r) at a radius [m], for the wavenumber of a mode of this order.
[[nodiscard]] double radial_shape(const RoundPlate& plate, int order, double wavenumber_per_m, double radius_m);

/// A mode of a circular plate: cos(order angle), or sin, and its wavenumber.
struct RoundPlateMode {
  int order;
  double wavenumber_per_m;
  bool is_sine = false;
};

/// How a plate stretches by von Karman's equations, one form for each of the `count` lowest Airy functions: of those
/// that are symmetric about the angle 0 or, with both symmetries, of all, but one less than half a pair. The rim is
/// free in the plane of the plate, so the Airy functions are the shapes P_k of a clamped plate with the wavenumbers
/// zeta_k. The displacement w stores
///
///     E h/8 sum over k of (integral of P_k L(w, w))^2/(zeta_k^4 integral of P_k^2)
///
/// L(f, g) = f_xx g_yy + f_yy g_xx - 2 f_xy g_xy (C. Touze, O. Thomas and A. Chaigne, J. Sound Vib. 258, 2002). Its
/// terms are right to about 1e-10 of the largest.
[[nodiscard]] std::vector<StretchForm> stretch_forms(const RoundPlate& plate, std::span<const RoundPlateMode> modes,
                                                     std::size_t count);

/// How many forms that makes.
[[nodiscard]] std::size_t form_count(const RoundPlate& plate, std::size_t count);

/// The least share of the energy by which one of the lowest `modes` symmetric modes alone stretches that the `count`
/// lowest Airy functions hold, of what 400 symmetric ones hold; 0 to 1. Those with sin(m angle) stretch as theirs do.
[[nodiscard]] double kept_of_stretching(const RoundPlate& plate, std::size_t modes, std::size_t count);

}  // namespace contactspline
