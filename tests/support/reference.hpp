// SPDX-License-Identifier: MIT
// The spline in 266 bits by the plainest recursion, in SI units throughout: shares no step with the generator.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "generator/spline/contact_spline.hpp"

namespace contactspline::testing {

using Real = boost::multiprecision::number<
    boost::multiprecision::mpfr_float_backend<80, boost::multiprecision::allocate_stack>,
    boost::multiprecision::et_off>;
static_assert(std::numeric_limits<Real>::digits >= 256);

/// u = 2^-53: rounding to double moves a value by at most this part of itself.
inline constexpr double kUnitRoundoff = 0x1p-53;

/// V(y) = k/(a + 1) y^(a + 1) [J].
inline Real exact_energy(const PowerLaw& law, const Real& y) {
  return y > 0 ? Real(Real(law.stiffness) / (Real(law.exponent) + 1) * pow(y, Real(law.exponent) + 1)) : Real(0);
}

/// F(y) = k y^a [N].
inline Real exact_force(const PowerLaw& law, const Real& y) {
  return y > 0 ? Real(Real(law.stiffness) * pow(y, Real(law.exponent))) : Real(0);
}

/// The same of a potential that is a power law.
inline Real exact_energy(const ContactLaw& contact, const Real& y) {
  return exact_energy(*contact.power_law(), y);
}
inline Real exact_force(const ContactLaw& contact, const Real& y) {
  return exact_force(*contact.power_law(), y);
}

/// What uniform_spline() should hold, unrounded.
struct ReferenceSpline {
  struct Powers {
    std::vector<Real> a, b, c;
  };
  Real width, energy_scale;
  std::vector<Real> knot, energy, force, half_curvature;
  Powers regular, normalised;

  /// Number, from 1, of the first segment with negative curvature.
  [[nodiscard]] std::optional<std::size_t> first_concave_segment() const {
    const auto found = std::ranges::find_if(half_curvature, [](const Real& c) { return c < 0; });
    if (found == half_curvature.end()) return std::nullopt;
    return static_cast<std::size_t>(found - half_curvature.begin()) + 1;
  }
};

/// The slope at a knot is twice the mean slope of the segment before less the slope before; no system of equations.
inline ReferenceSpline reference_spline(const Material& material) {
  const PowerLaw& law = *material.contact.power_law();
  ReferenceSpline s;
  const int n = material.spline.segments;
  s.width = Real(material.spline.max_compression_m) / n;
  s.energy_scale = Real(law.stiffness) * pow(s.width, Real(law.exponent) + 1);
  Real energy = 0, force = 0;
  for (int j = 0; j < n; ++j) {
    const Real y = s.width * j;
    const Real next_energy = exact_energy(law, s.width * (j + 1));
    const Real mean_slope = (next_energy - energy) / s.width;
    const Real half_curvature = (mean_slope - force) / s.width;
    s.knot.push_back(y);
    s.energy.push_back(energy);
    s.force.push_back(force);
    s.half_curvature.push_back(half_curvature);
    s.regular.a.push_back(half_curvature);
    s.regular.b.push_back(force - 2 * half_curvature * y);
    s.regular.c.push_back(energy - force * y + half_curvature * y * y);
    s.normalised.a.push_back(half_curvature * s.width * s.width / s.energy_scale);
    s.normalised.b.push_back(force * s.width / s.energy_scale);
    s.normalised.c.push_back(energy / s.energy_scale);
    energy = next_energy;
    force = 2 * mean_slope - force;
  }
  return s;
}

/// Passes where the sum of `terms` is `exact`. Each term is a coefficient rounded to double, times exact factors, so
/// it is off by at most u of itself and the sum by u times the sum of magnitudes; 2^-20 of that is left for the
/// second order and for the 113 bits before rounding. Fails on NaN.
inline ::testing::AssertionResult balances(std::initializer_list<Real> terms, const Real& exact) {
  Real sum = 0, magnitude = 0;
  for (const Real& term : terms) {
    sum += term;
    magnitude += abs(term);
  }
  const Real error = abs(sum - exact);
  const Real bound = magnitude * kUnitRoundoff * (1 + 0x1p-20);
  if (error <= bound) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "sum " << sum.str(20) << " is not " << exact.str(20) << " (error "
                                       << error.str(5) << ", bound " << bound.str(5) << ")";
}

/// Uniform in [0, 1), the same on every machine and standard library.
inline double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

inline double uniform(std::mt19937_64& random, double min, double max) {
  return min + (max - min) * uniform(random);
}

inline double log_uniform(std::mt19937_64& random, double min, double max) {
  return min * std::pow(max / min, uniform(random));
}

/// Exponent 1 to 5, stiffness 1e3 to 1e12, compression 1 um to 1 cm, 1 to 200 segments, no range of impacts.
inline Material random_material(std::mt19937_64& random) {
  const PowerLaw law{log_uniform(random, 1e3, 1e12), uniform(random, 1, 5)};
  const int segments = 1 + static_cast<int>(200 * uniform(random));
  return {"random", "", law, {}, {segments, log_uniform(random, 1e-6, 1e-2)}};
}

}  // namespace contactspline::testing
