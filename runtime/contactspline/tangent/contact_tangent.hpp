// SPDX-License-Identifier: MIT
// Exact derivatives of the contact step: of its force and of the compression after it, with respect to whatever goes
// in (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/step/contact.hpp"
#include "contactspline/step/memory.hpp"
#include "contactspline/tangent/dual.hpp"

namespace contactspline {

/// One value for each number of a contact. As a direction: the derivative of that number with respect to a parameter.
/// As a gradient: the derivative of a sum with respect to that number.
template <std::floating_point T>
struct ContactNumbers {
  T stiffness_ratio = 0, loss_s_per_m = 0;
  std::vector<Segment<T>> table;  ///< of forces and half curvatures at constant knots; empty: all 0
  std::vector<Memory> memories;   ///< of weights and times; empty: all 0
};

namespace detail {

/// Returns a value whose slopes are a number of each direction.
template <std::floating_point T, typename Numbers, std::size_t P>
[[nodiscard]] Dual<T, P> with_slopes(T value, const std::array<Numbers, P>& directions, T Numbers::*number) {
  Dual<T, P> result(value);
  for (std::size_t p = 0; p < P; ++p) result.slopes[p] = directions[p].*number;
  return result;
}
/// Returns the contact of each direction.
template <std::floating_point T, typename Numbers, std::size_t P>
[[nodiscard]] std::array<ContactNumbers<T>, P> contacts_of(const std::array<Numbers, P>& directions,
                                                           ContactNumbers<T> Numbers::*contact) {
  std::array<ContactNumbers<T>, P> contacts;
  for (std::size_t p = 0; p < P; ++p) contacts[p] = directions[p].*contact;
  return contacts;
}

}  // namespace detail

/// A table with the knots of another, whose force is force_at(y) at the knots and at end_m, the end of the last
/// segment, and linear between.
template <std::floating_point T, typename ForceAt>
[[nodiscard]] std::vector<Segment<T>> table_through(SegmentTable<T> table, T end_m, ForceAt force_at) {
  std::vector<Segment<T>> through(table.begin(), table.end());
  for (std::size_t j = 1; j < table.size(); ++j) {
    const T from = table[j].knot, to = j + 1 < table.size() ? table[j + 1].knot : end_m;
    const T energy = j > 1 ? through[j - 1].energy_at(from) : T(0);
    through[j] = {from, energy, force_at(from), (force_at(to) - force_at(from)) / (2 * (to - from))};
  }
  return through;
}

/// The direction of the table of a power law for its exponent, at a constant force at reference_m > 0 (1 m: at a
/// constant stiffness): the force at each knot grows by F ln(y/reference_m), and is linear between knots. end_m: the
/// end of the last segment, Material::max_compression_m.
template <std::floating_point T>
[[nodiscard]] std::vector<Segment<T>> exponent_direction(SegmentTable<T> table, T end_m, T reference_m = 1) {
  return table_through(table, end_m, [&](T y) { return y > 0 ? force(table, y) * std::log(y / reference_m) : T(0); });
}

/// What the table of a material with `compensation` is made for (both > 0): the time step, and the mass of the free
/// body that meets a rigid one.
template <std::floating_point T>
struct CompensatedFor {
  T time_step_s, mass_kg;
};

namespace detail {

/// dF/dy of a table at a knot: the mean of both sides.
template <std::floating_point T>
[[nodiscard]] T slope_at_knot(SegmentTable<T> table, T knot) {
  const std::size_t j = segment_index(table, knot);
  return table[j].half_curvature + table[j > 1 && knot == table[j].knot ? j - 1 : j].half_curvature;
}

}  // namespace detail

/// The direction of a table G = F + h F F' with compensation, h = dt^2/(6 m), to second order in the time step: E + h
/// G E' - h G G' dm/m. `uncompensated` is E, the direction of G at constant compensation (empty: 0): for the
/// stiffness the table itself, for the exponent exponent_direction. of_mass_kg: the direction dm of the mass.
template <std::floating_point T>
[[nodiscard]] std::vector<Segment<T>> compensated_direction(SegmentTable<T> table, T end_m,
                                                            const CompensatedFor<T>& made_for,
                                                            std::span<const Segment<T>> uncompensated,
                                                            T of_mass_kg = 0) {
  const T h = made_for.time_step_s * made_for.time_step_s / (6 * made_for.mass_kg);
  return table_through(table, end_m, [&](T y) {
    T slope = -detail::slope_at_knot(table, y) * of_mass_kg / made_for.mass_kg;
    if (!uncompensated.empty()) slope += detail::slope_at_knot(SegmentTable<T>(uncompensated), y);
    return (uncompensated.empty() ? T(0) : force(SegmentTable<T>(uncompensated), y)) + h * force(table, y) * slope;
  });
}

namespace detail {

/// The part of the path of a contact over one sample on which the potential is not flat, in pieces that lie in one
/// segment each.
template <std::floating_point T>
class ContactPath {
 public:
  constexpr ContactPath() = default;
  /// line: what is remembered [N], 0 without memory. last_increment: x_last of the contact step [m].
  ContactPath(SegmentTable<T> table, T line, T before, T after, T last_increment)
      : table_(table), line_(line), before_(before), midway_(before + last_increment / 2) {
    length_ = after - before;
    low_ = (std::min)(before, after), high_ = (std::max)(before, after);
    surface_ = line > 0 ? TableLessLine<T>(table, line, segment_of_force(table, line)).surface() : T(0);
  }

  /// Calls visit(segment, from, to) for each piece: the parts 0 to 1 of the path where it lies, from < to.
  template <typename Visit>
  void for_pieces(Visit visit) const {
    if (high_ <= surface_) return;
    const std::size_t last = segment_index(table_, high_);
    if (!(low_ < high_)) return visit(last, T(0), T(1));
    const T low = (std::max)(low_, surface_);
    for (std::size_t j = segment_index(table_, low); j <= last; ++j) {
      const T a = part((std::max)(low, table_[j].knot)), b = part(j < last ? table_[j + 1].knot : high_);
      if (a != b) visit(j, (std::min)(a, b), (std::max)(a, b));
    }
  }

  /// The mean force along the path of a table with the same knots, such as a direction.
  [[nodiscard]] T mean_force(std::span<const Segment<T>> direction) const {
    T mean = 0;
    for_pieces([&](std::size_t j, T from, T to) { mean += (to - from) * direction[j].force_at(middle(from, to)); });
    return mean;
  }
  /// The compression in the middle of a piece.
  [[nodiscard]] T middle(T from, T to) const { return before_ + length_ * ((from + to) / 2); }

  [[nodiscard]] T length() const { return length_; }
  /// What force_midway is: `factor` times the force of a segment at a compression [m]. 0: there is no loss.
  struct Midway {
    std::size_t segment = 0;
    T compression = 0, factor = 0;
  };
  [[nodiscard]] Midway midway() const {
    const std::size_t first = segment_index(table_, before_), j = segment_index(table_, midway_);
    const T at_first = table_[first].force_at(before_) - line_, there = table_[j].force_at(midway_) - line_;
    if (!(at_first > 0) || !(there > 0)) return {};
    return 2 * at_first < there ? Midway{first, before_, 2} : Midway{j, midway_, 1};
  }
  [[nodiscard]] T line() const { return line_; }
  [[nodiscard]] SegmentTable<T> table() const { return table_; }

 private:
  [[nodiscard]] T part(T y) const { return std::clamp((y - before_) / length_, T(0), T(1)); }

  SegmentTable<T> table_;
  T line_ = 0, before_ = 0, midway_ = 0, length_ = 0, low_ = 0, high_ = 0, surface_ = 0;
};

/// The derivatives of the force of a contact step. Along its path the force is f(y0, y1, x_last, ...); the motion
/// makes y1 = y0 + xf - xi f. Everything follows from the derivatives of the former. df/dy1 >= 0, so the division is
/// safe.
template <std::floating_point T>
struct ContactSlopes {
  T before = 0, after = 0;  ///< df/dy0 at constant y1, df/dy1 at constant y0 [N/m]
  T ratio = 0;              ///< df/d(stiffness ratio) at constant y0 and y1, as all that follow [N]
  T loss = 0;               ///< df/d(loss) [N m/s]
  T line = 0;               ///< df/d(line), the memory's
  T table = 0;              ///< df/d(mean force of the table along the path)
  T table_midway = 0;       ///< df/d(force of the table at midway().compression), by the loss
  T last = 0;               ///< df/dx_last [N/m], by the loss
  T gain = 1;               ///< by which the motion divides a change of the force: 1 + xi df/dy1

  constexpr ContactSlopes() = default;

  /// controls: designed for the rate. force: the step's [N]; where it is 0 nothing acts.
  ContactSlopes(const ContactPath<T>& path, const ContactControls<T>& controls, T time_step, T receptance, T force) {
    if (!(force > 0)) return;
    T mean = 0, above = 0;
    path.for_pieces([&](std::size_t j, T from, T to) {
      const Segment<T>& s = path.table()[j];
      const T part = to - from, curvature = controls.stiffness_ratio * s.half_curvature * part;
      mean += part * (s.force_at(path.middle(from, to)) - path.line());
      above += part;
      before += curvature * (2 - from - to);
      after += curvature * (from + to);
    });
    ratio = mean;
    table = controls.stiffness_ratio;
    line = -controls.stiffness_ratio * above;
    const auto [j, compression, factor] = path.midway();
    const Segment<T>& s = path.table()[j];
    const T midway = factor * (s.force_at(compression) - path.line());
    const T resistance = controls.loss_s_per_m / time_step, scaled = controls.stiffness_ratio * resistance;
    ratio += resistance * midway * path.length();
    loss = controls.stiffness_ratio * midway * path.length() / time_step;
    table_midway = factor * scaled * path.length();
    line -= table_midway;
    if (factor == 1) last = table_midway * s.half_curvature;
    before += 2 * table_midway * s.half_curvature - scaled * midway;
    after += scaled * midway;
    gain = 1 + receptance * after;
  }

  /// df/dy0 at constant increments.
  [[nodiscard]] T moved() const { return before + after; }
};

/// Memories with the slopes of a direction each.
template <std::floating_point T, std::size_t P>
[[nodiscard]] MemoryDesign<Dual<T, P>> design_tangent(std::span<const Memory> memories, double sample_rate_hz,
                                                      std::span<const ContactNumbers<T>, P> directions) {
  std::array<Dual<T, P>, kMaxMemories> weights{}, times_s{};
  for (std::size_t i = 0; i < memories.size(); ++i) {
    weights[i].value = static_cast<T>(memories[i].weight);
    times_s[i].value = static_cast<T>(memories[i].time_s);
    for (std::size_t p = 0; p < P; ++p)
      if (i < directions[p].memories.size()) {
        weights[i].slopes[p] = static_cast<T>(directions[p].memories[i].weight);
        times_s[i].slopes[p] = static_cast<T>(directions[p].memories[i].time_s);
      }
  }
  return {{weights.data(), memories.size()}, {times_s.data(), memories.size()}, sample_rate_hz};
}

}  // namespace detail

/// Tangents of a contact with memory, beside the model that computes it: the derivatives of its force and its
/// compression with respect to P parameters. No allocation after construction.
template <std::floating_point T, std::size_t P>
class ContactTangent {
 public:
  using Number = Dual<T, P>;
  struct Step {
    Number force, compression;
  };

  /// table, memories: the model's. The table must outlive this. directions: one for each parameter.
  ContactTangent(SegmentTable<T> table, std::span<const Memory> memories, double sample_rate_hz,
                 std::array<ContactNumbers<T>, P> directions)
      : table_(table), time_step_(static_cast<T>(1 / sample_rate_hz)), directions_(std::move(directions)) {
    const auto design =
        detail::design_tangent<T, P>(memories, sample_rate_hz, std::span<const ContactNumbers<T>, P>(directions_));
    remembered_ = detail::RememberedForces<Number>(design, memories.size());
    stiffness_ = design.stiffness;
  }

  /// Forgets everything.
  void reset() {
    remembered_.set({});
    jump();
  }
  /// The compression has jumped: ContactMemory::set_last_increment of 0.
  void jump() { last_increment_ = T(0); }

  /// Follows a sample that the model has advanced from the compression `before` [m], with its controls.
  Step advance(const ContactControls<T>& controls, const Number& before, const Number& free_increment,
               const Number& receptance, T force, T compression) {
    const Response response = respond(controls, before, force, compression);
    Step step{force, compression};
    for (std::size_t p = 0; p < P; ++p) {
      const T pushed = free_increment.slopes[p] - force * receptance.slopes[p];
      step.force.slopes[p] =
          (response.force.slopes[p] + response.stiffness * pushed) / (1 + receptance.value * response.stiffness);
      step.compression.slopes[p] = before.slopes[p] + pushed - receptance.value * step.force.slopes[p];
    }
    relax(before, step.compression);
    return step;
  }

  /// How the force of a sample responds to its increment x: the derivative of the force is that of `force` plus
  /// stiffness [N/m] times that of x.
  struct Response {
    Number force;
    T stiffness;
  };
  /// The first half of advance(), for a contact whose increment follows from other forces, too. relax() is the
  /// second.
  [[nodiscard]] Response respond(const ContactControls<T>& controls, const Number& before, T force,
                                 T compression) const {
    const Number ratio =
        detail::with_slopes(controls.stiffness_ratio, directions_, &ContactNumbers<T>::stiffness_ratio) * stiffness_;
    const detail::ContactPath<T> path(table_, remembered_.line().value, before.value, compression,
                                      last_increment_.value);
    const detail::ContactSlopes<T> slopes(path, {ratio.value, controls.loss_s_per_m}, time_step_, T(0), force);
    const auto midway = path.midway();
    Response response{force, slopes.after};
    for (std::size_t p = 0; p < P; ++p) {
      T& change = response.force.slopes[p];
      change = slopes.moved() * before.slopes[p] + slopes.last * last_increment_.slopes[p] +
               slopes.ratio * ratio.slopes[p] + slopes.loss * directions_[p].loss_s_per_m +
               slopes.line * remembered_.line().slopes[p];
      if (const auto& table = directions_[p].table; force > 0 && !table.empty())
        change += slopes.table * path.mean_force(table) +
                  slopes.table_midway * table[midway.segment].force_at(midway.compression);
    }
    return response;
  }

  /// Does it remember a force?
  [[nodiscard]] bool remembers() const { return remembered_.line().value > 0; }

  /// The memory follows the force at the end of a sample from the compression `before` to this one.
  void relax(const Number& before, const Number& compression) {
    last_increment_ = compression - before;
    if (remembered_.count() == 0) return;
    const T y = compression.value;
    const std::size_t j = segment_index(table_, y);
    Number force(table_[j].force_at(y));
    for (std::size_t p = 0; p < P; ++p) {
      force.slopes[p] = 2 * table_[j].half_curvature * compression.slopes[p];
      if (!directions_[p].table.empty()) force.slopes[p] += directions_[p].table[j].force_at(y);
    }
    remembered_.relax(force);
  }

 private:
  SegmentTable<T> table_;
  T time_step_;
  std::array<ContactNumbers<T>, P> directions_;
  detail::RememberedForces<Number> remembered_;
  Number last_increment_, stiffness_ = T(1);
};

}  // namespace contactspline
