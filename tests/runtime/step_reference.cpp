// SPDX-License-Identifier: MIT
// Writes random contact steps with their 113-bit answers and the bounds that a backward stable step keeps.
//
//   step_reference double|float CASES SHARD SHARDS FILE
//
// The bounds. u is the unit roundoff; the reference is the C1 potential of the table as stored (ExactContact).
//
// 1. The quadratic of the last segment p(s) = A s^2 + B s + g, s beyond the last knot passed at a distance w, x = w +
// s, is computed
//    with w to (1 rounding), f0 to 3, the gain G of energy up to that knot to 9 and the rounding of the table
//    energies (4.), A to 2, xi G to 11, and the terms of B and g each by a few roundings of |w|, |xf| and xi F.
//    Summed up,
//      |dp| <= u {|w| (5|w| + 4|xf|) + 11 xi |G| + |s| (6|w| + 2|xf| + 5 xi F) + 2 s^2 (1 + xi c)}.
//    The root formula does not cancel: 5 roundings of s, as much as another 5 u |s| p'(s) = 5 u (A s^2 - g).
//    w and s have one sign, so w^2, w s and s^2 are at most parts of x^2. Upwards G, s F and c s^2 are parts of the
//    work W; downwards c |s| <= F / 2, for the force stays >= 0, so |s| F <= 2 (|s| F - c s^2), and all is within 17
//    |W|. Hence
//      |dp| <= u |x| (10|x| + 9|xf|) + 17 u xi |W|:
//    the root is the exact one for xf moved by D, |D| <= u (10|x| + 9|xf|), and forces changed by 17 u.
// 2. The force is a root of xi A f^2 - b f + q, b = xf + xi F + 2 xi c t, q = G + t (F + c t), t = xf - w: the
//    quadratic of 1 with s = t - xi f. Its slope there is r = sqrt(B^2 - 4 A g) = |x| h' >= |x|, so an error of q
//    alone moves f by |dq| / r. That of G, in q and g alike, makes 9 u f. That of w, u |w| and in all terms alike,
//    makes u F1 |w| / r, F1 being the force at the end: upwards F1 = f + (h' - 1) |x| / xi, so that this is u f and
//    what xf moved by D = u |x| does; downwards F1 <= f. All others, in u, with L = |b| + r:
//    - Upwards f = 2 q / L, and q and b are sums of positive terms: q to 6, b to 5, B to 3 (xf + xi F), r to 3 beside
//      errors of g. These are 3 w t, as xi G <= w t, and A w t <= r L / 2: L = 2 (r + xi A f), A t = A s + xi A f,
//      and f <= F + c s^2 / x makes A s <= r - w. So 3 L more, 2 at the end; 32 with those of G and w.
//    - Downwards force stays >= 0, so c |s| <= F / 2, F <= 2 f, and t = s + xi f lies between -|s| and xi f.
//      Where b >= 0, f = L / (2 xi A): xi F, |t| and 2 xi c |t| are at most L, so b is good to 8 L, B to 5 L, r to 3;
//      g to 3 |g| or, where t > 0, to 3 |w| t + 2 |g|, and A t <= L / 2: 4 L; 5 at the end; 35 in all.
//      Where b < 0, f = 2 |q| / L: |xf|, xi F <= r and xi A f <= r / 2. Where t > 0, t (F + c t) <= |G| <= f |x|, so
//      q makes 11 f; b is good to 5 L, B to 5 L, r to 3, g to 4 L as before, 2 at the end; 40 in all. Where t < 0, q
//      makes 6 f, b 7 L and g 2 L; 35 in all.
//    Within one segment f = (F0 + c xf) / A is good to 12. Hence D = u |x|, forces 40 u.
// 3. h rises with slope >= 1, so the force for xf + D has sure bounds (ExactApproach::force_at_shift), whatever kinks
//    lie between: no linearisation. Its part of the bound is (1 - 1/h') D/xi, at most D/xi; x moves by D at most.
// 4. Of the table, knots, forces and the last half_curvature define the reference. Other half_curvatures deviate by
//    slope_error() relative to the force at the right end of their segment, which is to say relative to the work done
//    in it. Energies deviate by energy_error(), and are subtracted (one rounding more of V(y0)) where more than one
//    knot is passed: (E_k + E_l) / |W| times that is added to the fraction of the force. The step may take itself to
//    have passed one knot more or less when it lands at one; so the step lengthened by 2^-10 is asked.
//
// So |dx| <= D + fraction xi f, where xi f <= |x| + |xf|: up to (E_k + E_l)/|W| every step is well conditioned
// relative to max(|x|, |xf|). That is what 1e-12 max(|x|, |xf|) is asked of: |dx| <= 1e-12 max, 9007 u in double and
// the same in float. With uniform knots (E_k + E_l)/|W| is largest for two knots passed at the far end, 2 N /
// (exponent + 1).
#include <cstring>
#include <iostream>
#include <string>

#include "runtime/exact_contact.hpp"
#include "runtime/random_steps.hpp"
#include "runtime/step_cases.hpp"

namespace contactspline::testing {
namespace {

// Rounding of the increment and of the force.
template <typename T>
constexpr double kIncrementRoundoff = 12 * kRoundoff<T>;
template <typename T>
constexpr double kForceRoundoff = kRoundoff<T>;
template <typename T>
constexpr double kForces = 40 * kRoundoff<T>;

template <typename T>
Wide force_fraction(const ExactContact& contact, const ExactApproach& approach, Wide increment) {
  const Wide fraction = kForces<T> + contact.slope_error();
  const Wide longer = increment * (1 + Wide(0x1p-10));
  const std::size_t end_segment = approach.end_segment(longer);
  const auto [low, high] = std::minmax({approach.start(), end_segment});
  if (high <= low + 1) return fraction;
  const Wide energies = contact.knot_energy(high) + contact.knot_energy(low + 1);
  return fraction + (contact.energy_error() + kRoundoff<T>)*energies / magnitude(approach.work(longer, end_segment));
}

template <typename T>
StepCase<T> answered(const RandomStep<T>& step, const ExactContact& contact) {
  const Wide xf = step.free_increment;
  const ExactApproach approach(contact, step.compression, xf, step.receptance);
  const ExactStep exact =
      step.increment ? approach.solve_near(*step.increment, 4 * kRoundoff<T> * magnitude(xf)) : approach.solve();
  const Wide increment_shift = kIncrementRoundoff<T> * (magnitude(exact.increment) + magnitude(xf));
  const Wide fraction = force_fraction<T>(contact, approach, exact.increment);
  const Wide force_shift = kForceRoundoff<T> * magnitude(exact.increment);
  return {step.table,
          step.compression,
          step.free_increment,
          step.receptance,
          static_cast<double>(exact.increment),
          static_cast<double>(increment_shift + fraction * step.receptance * exact.force),
          static_cast<double>(exact.force),
          static_cast<double>(approach.force_at_shift(exact, -force_shift) * (1 - fraction)),
          static_cast<double>(approach.force_at_shift(exact, force_shift) * (1 + fraction))};
}

// Rounding each entry of a table of a power law leaves 2 c h within (4 exponent + 4) u of the rise of force, relative
// to the force, and energies within (2 exponent + 4) u; graded tables are summed in rounded arithmetic.
template <typename T>
void require_consistent(const TestTable<T>& table, const ExactContact& contact) {
  const double allowed = (4 * table.exponent + 4) * kRoundoff<T>;
  if (!(contact.slope_error() <= allowed && contact.energy_error() <= allowed))
    throw std::runtime_error("a table is not the rounded table of a C1 potential");
}

template <typename T>
void write(std::size_t count, std::size_t shard, std::size_t shards, const std::string& path) {
  const auto tables = test_tables<T>();
  std::vector<ExactContact> contacts;
  StepCases<T> set;
  for (const auto& table : tables) {
    set.tables.push_back(table.segments);
    contacts.emplace_back(table.segments);
    require_consistent(table, contacts.back());
  }
  RandomSteps<T> steps(tables);
  for (std::size_t i = 0; i < count; ++i)
    if (const auto step = steps.next(); i % shards == shard)
      set.cases.push_back(answered(step, contacts[step.table]));
  for (std::size_t i = 0; i < count / 10; ++i)
    if (const auto [table, y0, xf, xi, root] = steps.next_extreme(); i % shards == shard)
      set.extremes.push_back({table, y0, xf, xi});
  write_step_cases(path, set);
}

}  // namespace
}  // namespace contactspline::testing

int main(int argc, char** argv) try {
  using namespace contactspline::testing;
  const std::vector<std::string> words(argv, argv + argc);
  if (words.size() != 6) throw std::runtime_error("usage: step_reference double|float CASES SHARD SHARDS FILE");
  const auto run = words[1] == "float" ? write<float> : write<double>;
  run(std::stoul(words[2]), std::stoul(words[3]), std::stoul(words[4]), words[5]);
} catch (const std::exception& error) {
  std::cerr << "step_reference: " << error.what() << '\n';
  return 2;
}
