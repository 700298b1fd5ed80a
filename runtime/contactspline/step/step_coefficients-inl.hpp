// SPDX-License-Identifier: MIT
// The coefficients of a contact step that crosses a knot (docs/how-it-works/contact-step.md): one text for scalars
// (contact.hpp) and for the vectors of each instruction set (simd/contact-inl.hpp), which include it in a namespace
// of their own, after defining CONTACTSPLINE_STEP_INLINE. faust/contactspline.lib has the same names in the same
// order. No include guard.

/// Two quadratics with one discriminant, in displacements [m]. The distance s beyond the knot is a root of
/// lead s^2 + b s + g, the force displacement m = xi f a root of lead m^2 - p m + q, with lead = 1 + stiffness.
template <typename V>
struct StepCoefficients {
  V b, g, p, q, discriminant;
};

/// The coefficient q: work + remaining (force + stiffness remaining). In displacements for the quadratic in m; with
/// work in joules, a force and a half curvature, q/xi for the force itself, whose product with xi may be too small
/// for a number.
template <typename Arithmetic, typename V>
CONTACTSPLINE_STEP_INLINE V force_coefficient(Arithmetic math, V work, V force, V remaining, V stiffness) {
  return math.mul_add(remaining, math.mul_add(stiffness, remaining, force), work);
}

/// distance: from y0 to the last knot crossed, knot - y0 [m]. work: xi times the energy gained up to there [m^2].
/// force_displacement: xi times the force at the knot [m]. remaining: what is left of the free increment beyond the
/// knot, xf - distance [m]. stiffness: xi times the half curvature of the segment entered.
template <typename Arithmetic, typename V>
CONTACTSPLINE_STEP_INLINE StepCoefficients<V> step_coefficients(Arithmetic math, V distance, V work,
                                                                V force_displacement, V remaining, V stiffness) {
  const V one = math.number(1), two = math.number(2);
  const V slope = math.mul_add(two, stiffness, one);
  const V entry = math.add(distance, force_displacement);
  const V b = math.sub(entry, remaining);
  const V g = math.neg_mul_add(distance, remaining, work);
  const V p = math.mul_add(slope, remaining, entry);
  const V q = force_coefficient(math, work, force_displacement, remaining, stiffness);
  const V discriminant = math.neg_mul_add(math.mul_add(two, slope, two), g, math.mul(b, b));  // b^2 - 4 lead g
  return {b, g, p, q, discriminant};
}
