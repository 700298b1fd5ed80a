// SPDX-License-Identifier: MIT
// Hertz contact of two elastic bodies: a power law with exponent 3/2.
#pragma once

#include "generator/contact/contact_law.hpp"

namespace contactspline {

/// Sphere, plane or cylinder. youngs_modulus > 0 [Pa]; poisson_ratio -1 to 0.5; radius > 0 [m], infinite for a plane.
struct ElasticBody {
  enum class Shape { kSphere, kPlane, kCylinder } shape;
  double youngs_modulus_pa;
  double poisson_ratio;
  double radius_m;
};

/// True if the bodies touch at a point. A plane on a plane and a cylinder on a plane do not; they have no Hertz law.
[[nodiscard]] bool touch_at_a_point(const ElasticBody& one, const ElasticBody& other);

/// F = k y^1.5 of two bodies that touch at a point, without friction; y is the approach of points far from the
/// contact. Two cylinders are crossed at right angles. With principal relative curvatures 2A <= 2B and 1/E* = (1 -
/// nu1^2)/E1 + (1 - nu2^2)/E2: k = (2 pi/3) E*/K sqrt((K - E)/(A K e^2)), where K(e) and E(e) are complete elliptic
/// integrals and e is the eccentricity of the contact ellipse, from B/A = ((a/b)^2 E - K)/(K - E). For A = B, k =
/// (4/3) E* sqrt(R). (K. L. Johnson, Contact Mechanics, 1985, 4.2.) Computed in 113 bits and rounded once.
[[nodiscard]] PowerLaw hertz_law(const ElasticBody& one, const ElasticBody& other);

}  // namespace contactspline
