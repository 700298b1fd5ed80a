// SPDX-License-Identifier: MIT
// The contact step: one sample of a collision on a piecewise-quadratic potential, solved in closed form.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/step/version.hpp"

namespace contactspline {

/// One quadratic piece of the contact potential, V(y) = energy + force t + half_curvature t^2 with t = y - knot.
template <std::floating_point T>
struct Segment {
  T knot;            ///< compression at the left end [m]
  T energy;          ///< contact energy at the knot [J]
  T force;           ///< contact force at the knot [N]
  T half_curvature;  ///< half the stiffness of the segment [N/m]

  /// Contact energy [J] at compression y [m].
  [[nodiscard]] constexpr T energy_at(T y) const {
    const T t = y - knot;
    return energy + t * (force + t * half_curvature);
  }
  /// Contact force dV/dy [N] at compression y [m].
  [[nodiscard]] constexpr T force_at(T y) const { return force + 2 * half_curvature * (y - knot); }
};

/// A contact potential: entry 0 is "out of contact" (all zero), entries 1 to N the segments by rising knot; the first
/// segment begins at knot 0 with no energy and no force, the last one extends to infinity. Convex: half_curvature >=
/// 0.
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
using SegmentTable = std::span<const Segment<T>, Extent>;

/// The table of an emitted material (or of its `normalised` member) in precision T, a compile-time constant.
template <typename Material, std::floating_point T>
inline constexpr auto segments_of = [] {
  static_assert(fits_runtime<Material>, "generated for another version: run `contactspline generate` again");
  std::array<Segment<T>, Material::segments + 1> table{};
  for (std::size_t j = 0; j < Material::segments; ++j)
    table[j + 1] = {static_cast<T>(Material::knots[j]), static_cast<T>(Material::energies[j]),
                    static_cast<T>(Material::forces[j]), static_cast<T>(Material::half_curvatures[j])};
  return table;
}();

/// A table that is known at run time, in precision T.
template <std::floating_point T>
[[nodiscard]] std::vector<Segment<T>> table_in(std::span<const Segment<double>> table) {
  std::vector<Segment<T>> rounded;
  rounded.reserve(table.size());
  for (const Segment<double>& s : table)
    rounded.push_back({static_cast<T>(s.knot), static_cast<T>(s.energy), static_cast<T>(s.force),
                       static_cast<T>(s.half_curvature)});
  return rounded;
}

/// What the two bodies do over one sample: under a contact force f the compression changes by
/// x = free_increment - receptance f.
template <std::floating_point T>
struct Approach {
  T compression;     ///< y0, at the beginning of the sample [m]; negative while apart
  T free_increment;  ///< xf, change of compression over the sample if no force acted [m]
  T receptance;      ///< xi > 0, decrease of the increment per unit of force [m/N]
};

namespace detail {

/// Number of leading indices 1..n for which a monotone predicate holds. Always takes ceil(log4(n + 1)) rounds of
/// three independent probes.
template <typename Predicate>
[[nodiscard]] constexpr std::size_t count_leading(std::size_t n, Predicate holds) {
  std::size_t count = 0;
  for (int shift = (static_cast<int>(std::bit_width(n)) + 1) / 2 * 2 - 2; shift >= 0; shift -= 2) {
    std::size_t held = 0;
    for (std::size_t i = 1; i <= 3; ++i) {
      const std::size_t probe = count + (i << shift);
      held += std::size_t((probe <= n) & holds((std::min)(probe, n)));
    }
    count += held << shift;
  }
  return count;
}

/// segment_index on any table with size() and operator[].
template <typename Table, std::floating_point T>
[[nodiscard]] constexpr std::size_t segment_holding(const Table& table, T y) {
  return count_leading(table.size() - 1, [&](std::size_t k) { return table[k].knot <= y; });
}

}  // namespace detail

/// Index of the segment that holds compression y [m]: 0 while y < 0, else 1 to N.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr std::size_t segment_index(SegmentTable<T, Extent> table, T y) {
  return detail::segment_holding(table, y);
}

/// Contact energy V(y) [J]; 0 out of contact.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr T potential(SegmentTable<T, Extent> table, T y) {
  return y < 0 ? T(0) : table[segment_index(table, y)].energy_at(y);  // also at -infinity
}

/// Contact force dV/dy [N]; 0 out of contact.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr T force(SegmentTable<T, Extent> table, T y) {
  return y < 0 ? T(0) : table[segment_index(table, y)].force_at(y);
}

/// The result of a contact step.
template <std::floating_point T>
struct ContactStep {
  T force;              ///< over the sample [N]
  T compression;        ///< y0 + x, at the end of the sample [m]; precise where y0 + (xf - xi f) would cancel
  std::size_t segment;  ///< that holds this compression: the next step starts here
};

namespace detail {

// gnu::always_inline, here and in the other headers of the step: compilers take these functions for too large to be
// inlined, and the calls would cost more than the arithmetic.
#define CONTACTSPLINE_STEP_INLINE [[nodiscard, gnu::always_inline]] constexpr
#include "contactspline/step/step_coefficients-inl.hpp"
#undef CONTACTSPLINE_STEP_INLINE

/// The arithmetic of step_coefficients for one number.
template <std::floating_point T>
struct ScalarArithmetic {
  static constexpr T number(T value) { return value; }
  static constexpr T add(T a, T b) { return a + b; }
  static constexpr T sub(T a, T b) { return a - b; }
  static constexpr T mul(T a, T b) { return a * b; }
  static constexpr T mul_add(T a, T b, T c) { return a * b + c; }
  static constexpr T neg_mul_add(T a, T b, T c) { return c - a * b; }
};

/// Corrects the segment index when rounding moved y across a knot. This and what follows takes any table with size()
/// and operator[], such as a SegmentTable.
template <typename Table, std::floating_point T>
[[nodiscard]] constexpr std::size_t relocate_segment(const Table& table, std::size_t segment, T y) {
  while (segment > 0 && y < table[segment].knot) --segment;
  while (segment + 1 < table.size() && y >= table[segment + 1].knot) ++segment;
  return segment;
}

/// A sum that the compiler must not reassociate with others: otherwise it would cancel.
template <std::floating_point T>
[[nodiscard]] constexpr T whole(T sum) {
#ifndef __FAST_MATH__
  return sum;
#elif __has_builtin(__builtin_assoc_barrier)
  return __builtin_assoc_barrier(sum);
#elif __has_builtin(__arithmetic_fence) && defined(__SSE2__)
  return __arithmetic_fence(sum);
#else
  const volatile T stored = sum;
  return stored;
#endif
}

/// The way along the potential from y0 in the segment `start` to the knots above it, or to those below.
template <std::floating_point T, typename Table = SegmentTable<T>>
struct PotentialWalk {
  Table table;
  std::size_t start;
  T y0;
  bool up;
  std::size_t first;  // knot that is crossed first
  T gain_to_first;    // V(first knot) - V(y0), the area below the force

  [[gnu::always_inline]] constexpr PotentialWalk(const Table& segments, std::size_t from, T compression, bool upwards)
      : table(segments),
        start(from),
        y0(compression),
        up(upwards),
        first(start + up),
        gain_to_first((table[first].knot - y0) * (table[start].force_at(y0) + table[first].force) / 2) {}

  /// V(knot) - V(y0).
  [[nodiscard]] constexpr T gain_to(std::size_t k) const {
    return gain_to_first + whole(table[k].energy - table[first].energy);
  }
};

/// A step that leaves the segment `start` of y0, upwards or downwards.
template <std::floating_point T, typename Table>
struct Crossing : PotentialWalk<T, Table> {
  using Walk = PotentialWalk<T, Table>;
  using Walk::gain_to, Walk::start, Walk::table, Walk::up, Walk::y0;
  T xf, xi;

  constexpr Crossing(const Table& segments, std::size_t from, const Approach<T>& approach, bool upwards)
      : Walk(segments, from, approach.compression, upwards), xf(approach.free_increment), xi(approach.receptance) {}

  /// Does the root lie beyond this knot, one of those that may be crossed?
  [[nodiscard]] constexpr bool crosses(std::size_t k) const {
    const T distance = table[k].knot - y0;
    const T g = distance * (distance - xf) + xi * gain_to(k);
    return g < 0;
  }

  /// Segment of the root. A step crosses few knots as a rule, so the nearest are tried one after the other, which
  /// processors predict well; then all others.
  [[nodiscard]] constexpr std::size_t last_segment() const {
    constexpr std::size_t kNearest = 8;
    const std::size_t knots = up ? table.size() - 1 - start : start;  // ahead
    const auto crosses_knot = [this](std::size_t i) { return crosses(up ? start + i : start + 1 - i); };
    std::size_t crossed = 1;
    while (crossed < (std::min)(knots, kNearest) && crosses_knot(crossed + 1)) ++crossed;
    if (crossed == kNearest)
      crossed += count_leading(knots - kNearest, [&](std::size_t i) { return crosses_knot(kNearest + i); });
    return up ? start + crossed : start - crossed;
  }

  [[nodiscard, gnu::always_inline]] constexpr ContactStep<T> step() const {
    const std::size_t last = last_segment();
    const std::size_t entry = last + !up;  // last knot crossed
    const T origin = table[entry].knot;
    const T distance = whole(origin - y0), remaining = whole(xf - distance);
    const T gain = gain_to(entry), entry_force = table[entry].force, c = table[last].half_curvature;
    constexpr ScalarArithmetic<T> math;
    const auto step = step_coefficients(math, distance, xi * gain, xi * entry_force, remaining, xi * c);
    // b, p and q count along the motion, and q is that of the force itself. The root of the discriminant is |x| times
    // the slope of h there.
    const T lead = 1 + xi * c, sign = T(2 * up - 1), b = sign * step.b, p = sign * step.p;
    const T q = sign * force_coefficient(math, gain, entry_force, remaining, c);
    const T root = distance != 0 ? std::sqrt(std::abs(step.discriminant)) : std::abs(b);  // may be too small a square
    const T b_and_root = root + std::abs(b), p_and_root = root + std::abs(p);
    const T s = (b <= 0 ? b_and_root : -2 * sign * step.g) / (b <= 0 ? 2 * sign * lead : b_and_root);
    const T f = (p <= 0 ? p_and_root : 2 * q) / (p <= 0 ? 2 * xi * lead : p_and_root);
    const T y = origin + s;
    return {(std::max)(T(0), f), y, relocate_segment(table, last, y)};
  }
};

/// The step from y0 in the segment `start` under x = (xf - xi f)/divisor, divisor >= 1.
template <typename Table, std::floating_point T>
[[nodiscard, gnu::always_inline]] constexpr ContactStep<T> contact_step(const Table& table, std::size_t start,
                                                                        const Approach<T>& approach, T divisor) {
  const T y0 = approach.compression, xf = approach.free_increment, xi = approach.receptance;
  const Segment<T>& here = table[start];
  const std::size_t next = (std::min)(start + 1, table.size() - 1);
  // Within one segment the discrete gradient is linear: x = free/slope.
  const T f0 = here.force_at(y0);
  const T free = xf - xi * f0;
  const T slope = divisor + xi * here.half_curvature;
  const bool below = (start > 0) & (free < slope * (here.knot - y0));
  const bool above = (start < next) & (free >= slope * (table[next].knot - y0));
  if (!(below | above)) {
    const T y = y0 + free / slope;
    const T force = (divisor * f0 + here.half_curvature * xf) / slope;
    return {(std::max)(T(0), force), y, relocate_segment(table, start, y)};
  }
  const bool is_lossy = divisor != 1;
  const Approach<T> yielding{y0, is_lossy ? xf / divisor : xf, is_lossy ? xi / divisor : xi};
  return Crossing<T, Table>(table, start, yielding, above).step();
}

}  // namespace detail

/// Force over one sample: the discrete gradient f = [V(y0 + x) - V(y0)] / x that solves x = xf - xi f. Never
/// negative; exactly 0 when y0 <= 0 and y0 + xf <= 0. No iteration; energy is exchanged without loss or gain.
/// start: the segment that holds y0, segment_index(table, y0), as the step before found it.
///
/// h(x) = x + xi [V(y0 + x) - V(y0)]/x - xf rises strictly, so its sign at the knots brackets the root. In the last
/// segment, x h(x) is a quadratic in the distance beyond the last knot crossed, and the force is a root of another
/// quadratic with the same discriminant. The energy gained is an area up to the first knot and differences of knot
/// energies beyond: nothing cancels. (docs/how-it-works/contact-step.md)
template <std::floating_point T, std::size_t Extent>
[[nodiscard, gnu::always_inline]] inline ContactStep<T> contact_step(SegmentTable<T, Extent> table,
                                                                     const Approach<T>& approach, std::size_t start) {
  return detail::contact_step(table, start, approach, T(1));
}

/// The same without a known segment.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] ContactStep<T> contact_step(SegmentTable<T, Extent> table, const Approach<T>& approach) {
  return contact_step(table, approach, segment_index(table, approach.compression));
}

/// The force of contact_step [N].
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] T contact_force(SegmentTable<T, Extent> table, const Approach<T>& approach) {
  return contact_step(table, approach).force;
}

/// Live controls of a contact, beside the material's table.
template <std::floating_point T>
struct ContactControls {
  T stiffness_ratio = 1;  ///< multiplies the material's stiffness; > 0
  T loss_s_per_m = 0;     ///< Hunt-Crossley loss lambda >= 0: viscous force lambda F(y) dy/dt
};

namespace detail {

/// Force [N] by which lambda is multiplied, min(F(y0 + last_increment/2), 2 F(y0)): that in the middle of the sample,
/// if it goes on as the last one, which changed the compression by last_increment. The bound lets it grow from 0 at
/// the first touch. start: the segment that holds y0.
template <typename Table, std::floating_point T>
[[nodiscard, gnu::always_inline]] constexpr T force_midway(const Table& table, std::size_t start, T y0,
                                                           T last_increment) {
  const T y = y0 + last_increment / 2;
  const bool leaves = y < table[start].knot || (start + 1 < table.size() && y >= table[start + 1].knot);
  return (std::min)(2 * table[start].force_at(y0), table[leaves ? segment_holding(table, y) : start].force_at(y));
}

/// contact_step under live controls, on any table.
template <typename Table, std::floating_point T>
[[nodiscard, gnu::always_inline]] constexpr ContactStep<T> controlled_step(const Table& table,
                                                                           const ContactControls<T>& controls,
                                                                           T time_step, const Approach<T>& approach,
                                                                           std::size_t start, T last_increment) {
  const T y0 = approach.compression, xf = approach.free_increment, xi = approach.receptance;
  const T ratio = controls.stiffness_ratio;
  if (controls.loss_s_per_m == 0) {
    const auto elastic = contact_step(table, start, Approach<T>{y0, xf, ratio * xi}, T(1));
    return {ratio * elastic.force, elastic.compression, elastic.segment};
  }
  const T resistance =
      controls.loss_s_per_m * ratio / time_step * force_midway(table, start, y0, last_increment);  // [N/m]
  const T divisor = 1 + xi * resistance;
  const auto elastic = contact_step(table, start, Approach<T>{y0, xf, ratio * xi}, divisor);
  const T total = (ratio * elastic.force + resistance * xf) / divisor;
  if (total >= 0) return {total, elastic.compression, elastic.segment};
  return {0, y0 + xf, segment_holding(table, y0 + xf)};
}

}  // namespace detail

/// contact_step with the material's stiffness scaled and a viscous force R x added, R = lambda/dt F(y0 + x_last/2),
/// but at most 2 lambda/dt F(y0): it is of second order, and passive, since R >= 0. If the sum would pull, the force
/// is 0 and the stored energy beyond is lost: this is passive, too, and the force stays continuous. time_step: dt
/// [s]. start: the segment that holds y0. last_increment: x_last, change of compression over the sample before [m]; 0
/// at first and after a jump.
template <std::floating_point T, std::size_t Extent>
[[nodiscard, gnu::always_inline]] inline ContactStep<T> contact_step(SegmentTable<T, Extent> table,
                                                                     const ContactControls<T>& controls, T time_step,
                                                                     const Approach<T>& approach, std::size_t start,
                                                                     T last_increment = 0) {
  return detail::controlled_step(table, controls, time_step, approach, start, last_increment);
}

/// The same without a known segment, after a jump.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] ContactStep<T> contact_step(SegmentTable<T, Extent> table, const ContactControls<T>& controls,
                                          T time_step, const Approach<T>& approach) {
  return contact_step(table, controls, time_step, approach, segment_index(table, approach.compression));
}

/// The force of contact_step with stiffness and loss [N].
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] T contact_force(SegmentTable<T, Extent> table, const ContactControls<T>& controls, T time_step,
                              const Approach<T>& approach) {
  return contact_step(table, controls, time_step, approach).force;
}

}  // namespace contactspline
