// SPDX-License-Identifier: MIT
// The contact step: one sample of a collision on a piecewise-quadratic potential, solved in closed form.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>

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
  std::array<Segment<T>, Material::segments + 1> table{};
  for (std::size_t j = 0; j < Material::segments; ++j)
    table[j + 1] = {static_cast<T>(Material::knots[j]), static_cast<T>(Material::energies[j]),
                    static_cast<T>(Material::forces[j]), static_cast<T>(Material::half_curvatures[j])};
  return table;
}();

/// What the two bodies would do over one sample, and how they give way to a contact force f: the compression changes
/// by x = free_increment - admittance f.
template <std::floating_point T>
struct Approach {
  T compression;     ///< y0, at the beginning of the sample [m]; negative while apart
  T free_increment;  ///< xf, change of compression over the sample if no force acted [m]
  T admittance;      ///< xi > 0, loss of increment per unit of force [m/N]
};

namespace detail {

/// Number of leading indices 1..n for which the monotone predicate holds: ceil(log2(n + 1)) probes, whatever the
/// data.
template <typename Predicate>
[[nodiscard]] constexpr std::size_t count_leading(std::size_t n, Predicate holds) {
  std::size_t count = 0;
  for (std::size_t stride = std::bit_floor(n); stride > 0; stride >>= 1) {
    const std::size_t probe = std::min(count + stride, n);
    count = holds(probe) ? probe : count;
  }
  return count;
}

}  // namespace detail

/// Index of the segment that holds compression y [m]: 0 while y < 0, else 1 to N.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr std::size_t segment_index(SegmentTable<T, Extent> table, T y) {
  return detail::count_leading(table.size() - 1, [&](std::size_t k) { return table[k].knot <= y; });
}

/// Contact energy V(y) [J]; 0 out of contact.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr T potential(SegmentTable<T, Extent> table, T y) {
  return table[segment_index(table, y)].energy_at(y);
}

/// Contact force dV/dy [N]; 0 out of contact.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr T force(SegmentTable<T, Extent> table, T y) {
  return table[segment_index(table, y)].force_at(y);
}

/// What comes of an approach.
template <std::floating_point T>
struct ContactStep {
  T force;        ///< over the sample [N]
  T compression;  ///< y0 + x, at the end of the sample [m]; keeps its digits where y0 + (xf - xi f) would cancel
  std::size_t segment;  ///< that holds this compression: where the next step starts
};

namespace detail {

/// segment_index of y, which rounding may have put a hair beyond a segment.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr std::size_t settled(SegmentTable<T, Extent> table, std::size_t segment, T y) {
  while (segment > 0 && y < table[segment].knot) --segment;
  while (segment + 1 < table.size() && y >= table[segment + 1].knot) ++segment;
  return segment;
}

/// A step that leaves the segment `start` of y0, upwards or downwards.
template <std::floating_point T, std::size_t Extent>
struct Crossing {
  SegmentTable<T, Extent> table;
  std::size_t start;
  T y0, xf, xi;
  bool up;
  std::size_t first;  // first knot in the way
  T gain_to_first;    // V(knot) - V(y0) there

  constexpr Crossing(SegmentTable<T, Extent> segments, std::size_t from, const Approach<T>& approach, bool upwards)
      : table(segments),
        start(from),
        y0(approach.compression),
        xf(approach.free_increment),
        xi(approach.admittance),
        up(upwards),
        first(up ? std::min(start + 1, table.size() - 1) : start),
        gain_to_first((table[first].knot - y0) * (table[start].force_at(y0) + table[first].force) / 2) {}

  // Where xi times the slope of the discrete gradient is below this, the latter alone gives the force.
  static constexpr T kSoft = T(1) / 1024;

  [[nodiscard]] constexpr T gain_to(std::size_t k) const {
    const T from_first = table[k].energy - table[first].energy;
#ifdef __FAST_MATH__  // else this may become (gain_to_first - energy) + energy, which is not gain_to_first
    return k == first ? gain_to_first : gain_to_first + from_first;
#else
    return gain_to_first + from_first;
#endif
  }

  /// Does the root lie above this knot?
  [[nodiscard]] constexpr bool passes(std::size_t k) const {
    const T way = table[k].knot - y0;
    const T g = way * (way - xf) + xi * gain_to(k);
    return up ? !(way > 0) || g < 0 : way < 0 && g > 0;
  }

  /// The step, `knots_below` knots lying below the root. At least one knot is crossed.
  template <typename Machine>
  [[nodiscard, gnu::always_inline]] constexpr ContactStep<T> land(std::size_t knots_below,
                                                                  const Machine& machine) const {
    const std::size_t last = table.size() - 1;
    const std::size_t lowest = up ? first : 0, highest = up ? last : start - (start > 0);
    const std::size_t landing = std::min(std::max(knots_below, lowest), highest);
    const std::size_t entry = std::min(landing + !up, last);  // last knot passed
    const T origin = table[entry].knot;
    const T way = origin - y0;
    const T gain = gain_to(entry);
    const T entry_force = table[entry].force;
    const T c = table[landing].half_curvature;
    const T sign = T(2 * up - 1);

    const T a = 1 + xi * c;
    const T b = sign * (2 * way - xf + xi * entry_force);
    const T g = way * (way - xf) + xi * gain;                                    // <= 0, but for rounding
    const bool away = way != 0;                                                  // else f and s are linear in xf
    const T root = away ? std::sqrt(std::abs(b * b - 4 * a * g)) : std::abs(b);  // |x| times the slope of h there
    const T larger = root + std::abs(b);
    const T s = machine.choose(b, larger, -2 * sign * g) / machine.choose(b, 2 * sign * a, larger);

    const T x = way + s;
    const T work = sign * (gain + s * (entry_force + s * c));
    const T length = away ? std::abs(x) : T(1);
    const T whole = std::max(length, root * (1 - kSoft));
    const T numerator = away ? work + (whole - length) * machine.quotient(xf - x, xi) : entry_force + c * xf;
    const T y = origin + s;
    return {std::max(T(0), machine.quotient(numerator, away ? whole : a)), y, settled(table, landing, y)};
  }
};

/// The step from y0 in the segment `start` by x = (xf - xi f)/divisor, divisor >= 1, on a `machine` as PlainMachine.
template <std::floating_point T, std::size_t Extent, typename Machine>
[[nodiscard, gnu::always_inline]] constexpr ContactStep<T> contact_step(SegmentTable<T, Extent> table,
                                                                        std::size_t start,
                                                                        const Approach<T>& approach, T divisor,
                                                                        const Machine& machine) {
  const T y0 = approach.compression, xf = approach.free_increment, xi = approach.admittance;
  const Segment<T>& here = table[start];
  const std::size_t next = std::min(start + 1, table.size() - 1);
  // Within one segment the discrete gradient is linear: x = free/slope.
  const T f0 = here.force_at(y0);
  const T free = xf - xi * f0;
  const T slope = divisor + xi * here.half_curvature;
  const bool below = (start > 0) & (free < slope * (here.knot - y0));
  const bool above = (start < next) & (free >= slope * (table[next].knot - y0));
  if (!(below | above)) {
    const T y = y0 + machine.quotient(free, slope);
    const T force = machine.quotient(divisor * f0 + here.half_curvature * xf, slope);
    return {std::max(T(0), force), y, settled(table, start, y)};
  }
  const bool is_lossy = divisor != 1;
  const Approach<T> yielding{y0, is_lossy ? xf / divisor : xf, is_lossy ? xi / divisor : xi};
  const Crossing<T, Extent> crossing(table, start, yielding, above);
  return crossing.land(machine.knots_below_root(crossing), machine);
}

/// What a machine without vectors does.
struct PlainMachine {
  /// Binary search: ceil(log2(N + 1)) probes, whatever the data.
  template <std::floating_point T, std::size_t Extent>
  [[nodiscard]] constexpr std::size_t knots_below_root(const Crossing<T, Extent>& crossing) const {
    return count_leading(crossing.table.size() - 1, [&](std::size_t k) { return crossing.passes(k); });
  }

  template <std::floating_point T>
  [[nodiscard]] constexpr T choose(T test, T if_at_most_0, T otherwise) const {
    return test <= 0 ? if_at_most_0 : otherwise;
  }

  template <std::floating_point T>
  [[nodiscard]] constexpr T quotient(T dividend, T divisor) const {
    return dividend / divisor;
  }
};

}  // namespace detail

/// Force over one sample: the discrete gradient f = [V(y0 + x) - V(y0)] / x that solves x = xf - xi f. Never
/// negative; exactly 0 when y0 <= 0 and y0 + xf <= 0. No iteration; energy is exchanged without loss or gain.
/// start: the segment that holds y0, segment_index(table, y0), as the step before found it.
///
/// h(x) = x + xi [V(y0 + x) - V(y0)]/x - xf rises strictly, so its sign at the knots brackets the root, and in the
/// landing segment x h(x) is a quadratic. It is written in s, the way beyond the knot by which that segment is
/// entered: A s^2 + B s + g = 0 with g <= 0, whose wanted root has the sign of the motion. What is gained on the way
/// to a knot is the area below the force up to the first knot, and from there a difference of knot energies: nothing
/// cancels. (The first knot is a case of its own, so that even a compiler free to reassociate cannot make it a
/// difference.) The last lines weigh the two expressions of the force, (xf - x)/xi and the discrete gradient, by the
/// slope of h, so that errors of x drop out. (docs/contact-step.md)
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] ContactStep<T> contact_step(SegmentTable<T, Extent> table, const Approach<T>& approach,
                                          std::size_t start) {
  return detail::contact_step(table, start, approach, T(1), detail::PlainMachine());
}

/// The same from anywhere.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] ContactStep<T> contact_step(SegmentTable<T, Extent> table, const Approach<T>& approach) {
  return contact_step(table, approach, segment_index(table, approach.compression));
}

/// The force of contact_step [N].
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] T contact_force(SegmentTable<T, Extent> table, const Approach<T>& approach) {
  return contact_step(table, approach).force;
}

/// Stiffness and loss of a contact, live controls beside the material's table.
template <std::floating_point T>
struct ContactControls {
  T stiffness_ratio = 1;  ///< multiplies the material's stiffness; > 0
  T loss_s_per_m = 0;     ///< Hunt-Crossley loss lambda >= 0: viscous force lambda F(y) dy/dt
};

namespace detail {

template <std::floating_point T, std::size_t Extent, typename Machine>
[[nodiscard, gnu::always_inline]] constexpr ContactStep<T> contact_step(SegmentTable<T, Extent> table,
                                                                        const ContactControls<T>& controls,
                                                                        T time_step, const Approach<T>& approach,
                                                                        std::size_t start, const Machine& machine) {
  const T y0 = approach.compression, xf = approach.free_increment, xi = approach.admittance;
  const T ratio = controls.stiffness_ratio;
  if (controls.loss_s_per_m == 0) {
    const auto elastic = contact_step(table, start, Approach<T>{y0, xf, ratio * xi}, T(1), machine);
    return {ratio * elastic.force, elastic.compression, elastic.segment};
  }
  const T resistance = controls.loss_s_per_m * ratio / time_step * table[start].force_at(y0);  // [N/m]
  const T divisor = 1 + xi * resistance;
  const auto elastic = contact_step(table, start, Approach<T>{y0, xf, ratio * xi}, divisor, machine);
  const T total = (ratio * elastic.force + resistance * xf) / divisor;
  if (total >= 0) return {total, elastic.compression, elastic.segment};
  return {0, y0 + xf, segment_index(table, y0 + xf)};
}

}  // namespace detail

/// contact_step with the material's stiffness scaled and a viscous force lambda F(y0) x/dt added. Where the sum would
/// pull, the bodies part without force and what is stored beyond is lost: passive, and the force stays continuous.
/// time_step: dt [s]. start: the segment that holds y0.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] ContactStep<T> contact_step(SegmentTable<T, Extent> table, const ContactControls<T>& controls,
                                          T time_step, const Approach<T>& approach, std::size_t start) {
  return detail::contact_step(table, controls, time_step, approach, start, detail::PlainMachine());
}

/// The same from anywhere.
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
