// SPDX-License-Identifier: MIT
// A felt in long double whose numbers can be moved by a little: a power law's table, its loss and its memories.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/step/memory.hpp"
#include "contactspline/tangent/contact_tangent.hpp"
#include "power_table.hpp"
#include "support/random.hpp"

namespace contactspline::testing {

using Real = long double;

/// A table of a power law, and what of it is differentiated.
struct Felt {
  explicit Felt(Random& random, std::size_t memory_count)
      : mass(random.log_between(1e-3, 1e-1)),
        speed(random.log_between(0.2, 8)),
        exponent(random.between(1.3, 4)),
        end(random.log_between(2e-4, 3e-3)),
        ratio(random.log_between(0.5, 2)),
        loss(random.once_in(2) ? random.between(0.01, 4) / speed : 0.0) {
    const double stiffness = mass * speed * speed * (exponent + 1) / 2 / std::pow(end / 2, exponent + 1);
    table = power_table(stiffness, exponent, end, 12 + static_cast<int>(random.below(40)));
    for (std::size_t i = 0; i < memory_count; ++i)
      memories.push_back(
          {random.between(0.1, 0.9) / static_cast<double>(memory_count), random.log_between(3e-6, 3e-4)});
  }

  double mass, speed;  // of a blow that compresses it by about half of `end`
  double exponent, end, ratio, loss;
  Table table;
  std::vector<Memory> memories;
};

/// What the numbers of a felt become: times their value, but the exponent, which grows by it.
struct FeltChange {
  Real ratio = 1, loss = 1, exponent = 0;
  Real weight[kMaxMemories] = {1, 1, 1, 1}, time[kMaxMemories] = {1, 1, 1, 1};
};

/// The contact of such a felt, step by step.
class ExactContact {
 public:
  ExactContact(const Felt& felt, const FeltChange& change, Real rate)
      : controls_{felt.ratio * change.ratio, felt.loss * change.loss}, time_step_(1 / rate) {
    const auto force_at = [&](Real y) {
      if (!(y > 0)) return Real(0);
      Real force = 0;
      for (const Segment<double>& s : felt.table)
        if (s.knot <= double(y)) force = s.force + 2 * Real(s.half_curvature) * (y - s.knot);
      return force * std::pow(y / Real(felt.end), change.exponent);
    };
    table_.assign(1, {0, 0, 0, 0});
    Real energy = 0;
    for (std::size_t j = 1; j < felt.table.size(); ++j) {
      const Real from = felt.table[j].knot, to = j + 1 < felt.table.size() ? felt.table[j + 1].knot : felt.end;
      const Real f0 = force_at(from), f1 = force_at(to);
      table_.push_back({from, energy, f0, (f1 - f0) / (to - from) / 2});
      energy += (f0 + f1) / 2 * (to - from);
    }
    Real weights[kMaxMemories], times[kMaxMemories];
    const std::size_t count = felt.memories.size();
    for (std::size_t i = 0; i < count; ++i) {
      weights[i] = felt.memories[i].weight * change.weight[i];
      times[i] = felt.memories[i].time_s * change.time[i];
    }
    const detail::MemoryDesign<Real> design({weights, count}, {times, count}, double(rate));
    remembered_ = detail::RememberedForces<Real>(design, count);
    controls_.stiffness_ratio *= design.stiffness;
  }

  ContactStep<Real> advance(const Approach<Real>& approach) {
    const SegmentTable<Real> table(table_);
    const Real line = remembered_.line();
    const detail::TableLessLine<Real> spring(table, line, detail::segment_of_force(table, line));
    const std::size_t start = detail::segment_holding(spring, approach.compression);
    const auto step = detail::controlled_step(spring, controls_, time_step_, approach, start, last_increment_);
    last_increment_ = step.compression - approach.compression;
    if (remembered_.count() > 0) remembered_.relax(force(table, step.compression));
    return step;
  }

 private:
  std::vector<Segment<Real>> table_;
  ContactControls<Real> controls_;
  Real time_step_, last_increment_ = 0;
  detail::RememberedForces<Real> remembered_;
};

/// Directions of a felt: its stiffness, its loss, its exponent, then weight and time of each memory, as FeltChange
/// moves them.
inline std::vector<ContactNumbers<double>> felt_directions(const Felt& felt) {
  std::vector<ContactNumbers<double>> directions(3);
  directions[0].stiffness_ratio = felt.ratio;
  directions[1].loss_s_per_m = felt.loss;
  directions[2].table = exponent_direction(SegmentTable<double>(felt.table), felt.end, felt.end);
  for (std::size_t i = 0; i < felt.memories.size(); ++i)
    for (const bool is_time : {false, true}) {
      ContactNumbers<double> direction;
      direction.memories.resize(felt.memories.size());
      (is_time ? direction.memories[i].time_s : direction.memories[i].weight) =
          is_time ? felt.memories[i].time_s : felt.memories[i].weight;
      directions.push_back(direction);
    }
  return directions;
}

/// The number of a FeltChange that belongs to the direction of this index.
inline Real& number_of(FeltChange& change, std::size_t direction) {
  if (direction == 0) return change.ratio;
  if (direction == 1) return change.loss;
  if (direction == 2) return change.exponent;
  const std::size_t i = (direction - 3) / 2;
  return direction % 2 == 1 ? change.weight[i] : change.time[i];
}

/// The central difference of samples that `play` computes from a change of one number by +-h.
template <typename Play>
std::vector<double> central_difference(Play play, Real h = 1e-7L) {
  const std::vector<Real> above = play(h), below = play(-h);
  std::vector<double> slopes;
  for (std::size_t n = 0; n < above.size(); ++n) slopes.push_back(double((above[n] - below[n]) / (2 * h)));
  return slopes;
}

}  // namespace contactspline::testing
