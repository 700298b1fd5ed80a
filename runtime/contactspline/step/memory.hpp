// SPDX-License-Identifier: MIT
// A contact with memory, as felt, rubber and skin have it: its contact step, passive at any parameters
// (docs/how-it-works/memory.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <span>

#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// One memory of a contact: the force becomes F(y) - weight M, and M follows F(y) with the relaxation time. The
/// stiffness of the table is that of a fast blow; a slow press meets 1 - sum of the weights of it (A. Stulov, J.
/// Acoust. Soc. Am. 97, 1995).
struct Memory {
  double weight;  ///< 0 to 1; those of one contact add up to less than 1
  double time_s;  ///< relaxation time > 0 [s]
};

/// The largest number of memories of one contact.
inline constexpr std::size_t kMaxMemories = 4;

/// The memories of an emitted material; none if it was emitted without.
template <typename Material>
inline constexpr auto memories_of = [] {
  if constexpr (requires { Material::memory_weights; }) {
    static_assert(Material::memory_weights.size() <= kMaxMemories);
    std::array<Memory, Material::memory_weights.size()> memories{};
    for (std::size_t i = 0; i < memories.size(); ++i)
      memories[i] = {Material::memory_weights[i], Material::memory_times_s[i]};
    return memories;
  } else {
    return std::array<Memory, 0>{};
  }
}();

namespace detail {

/// The potential of a contact under a constant force `line` [N]: V(y) - line y, flat below the compression at which
/// that force holds the contact at rest. It has the indices of the table; entries below `split` are flat, and entry
/// `split` begins where the slope is 0.
template <std::floating_point T, std::size_t Extent = std::dynamic_extent>
class TableLessLine {
 public:
  constexpr TableLessLine() = default;

  /// line: a force >= 0 [N]. split: the last segment whose force at its knot is at most this, >= 1.
  constexpr TableLessLine(SegmentTable<T, Extent> table, T line, std::size_t split)
      : table_(table), line_(line), split_(split), surface_(table[split].knot), lowest_energy_(table[split].energy) {
    const Segment<T>& s = table[split];
    if (!(line > 0)) return;  // where nothing is remembered, the surface is the knot
    if (s.half_curvature > 0) surface_ += (line - s.force) / (2 * s.half_curvature);
    lowest_energy_ = s.energy_at(surface_) - line * surface_;
  }

  [[nodiscard]] constexpr std::size_t size() const { return table_.size(); }
  /// Is the line 0, so that this is the table?
  [[nodiscard]] constexpr bool is_whole() const { return !(line_ > 0); }
  [[nodiscard, gnu::always_inline]] constexpr Segment<T> operator[](std::size_t k) const {
    const Segment<T>& s = table_[k];
    if (k > split_) return {s.knot, s.energy - line_ * s.knot, s.force - line_, s.half_curvature};
    return {knot(k), lowest_energy_, T(0), half_curvature(k)};
  }
  [[nodiscard]] constexpr T knot(std::size_t k) const { return k == split_ ? surface_ : table_[k].knot; }
  [[nodiscard]] constexpr T half_curvature(std::size_t k) const {
    return k < split_ ? T(0) : table_[k].half_curvature;
  }

  [[nodiscard]] constexpr SegmentTable<T, Extent> table() const { return table_; }
  /// The compression below which the force is 0 [m].
  [[nodiscard]] constexpr T surface() const { return surface_; }
  /// The potential there and below [J], <= 0.
  [[nodiscard]] constexpr T lowest_energy() const { return lowest_energy_; }
  /// The segment here in which a compression lies that is in segment `start` of the table.
  [[nodiscard]] constexpr std::size_t segment_here(std::size_t start, T compression) const {
    return start == split_ && table_[start].force_at(compression) < line_ ? start - 1 : start;
  }

 private:
  SegmentTable<T, Extent> table_{};
  T line_ = 0;
  std::size_t split_ = 1;
  T surface_ = 0, lowest_energy_ = 0;
};

/// The last segment >= 1 whose force at the knot is at most `force` >= 0.
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr std::size_t segment_of_force(SegmentTable<T, Extent> table, T force) {
  return 1 + count_leading(table.size() - 2, [&](std::size_t k) { return table[k + 1].force <= force; });
}

}  // namespace detail

namespace detail {

/// Memories as a sample rate sees them, in any type of number: duals give derivatives.
template <typename Number>
struct MemoryDesign {
  std::array<Number, kMaxMemories> weights{}, kept{}, taken{};  ///< in a sample: kept of what is remembered, taken of
                                                                ///< the force
  Number stiffness = 1;  ///< in parts of the table's: a memory within half a sample stiffens less

  constexpr MemoryDesign() = default;
  constexpr MemoryDesign(std::span<const Number> memory_weights, std::span<const Number> times_s,
                         double sample_rate_hz) {
    for (std::size_t i = 0; i < memory_weights.size(); ++i)
      stiffness =
          stiffness - memory_weights[i] * (std::max)(Number(0), Number(1) - Number(2 * sample_rate_hz) * times_s[i]);
    for (std::size_t i = 0; i < memory_weights.size(); ++i) {
      const Number half_samples = Number(2 * sample_rate_hz) * times_s[i];
      weights[i] = memory_weights[i] * (std::min)(Number(1), half_samples) / stiffness;
      kept[i] = (std::max)(Number(0), (half_samples - Number(1)) / (half_samples + Number(1)));
      taken[i] = weights[i] * (Number(1) - kept[i]);
    }
  }
};

/// What a contact remembers, in any type of number: duals give derivatives.
template <typename Number>
class RememberedForces {
 public:
  using Forces = std::array<Number, kMaxMemories>;

  constexpr RememberedForces() = default;
  /// The memories of a design in another precision.
  template <typename Other>
  constexpr RememberedForces(const MemoryDesign<Other>& design, std::size_t count) : count_(count) {
    for (std::size_t i = 0; i < count; ++i) {
      weights_[i] = static_cast<Number>(design.weights[i]);
      kept_[i] = static_cast<Number>(design.kept[i]);
      taken_[i] = static_cast<Number>(design.taken[i]);
      sum_taken_ = sum_taken_ + taken_[i];
    }
  }

  [[nodiscard]] constexpr std::size_t count() const { return count_; }
  /// Weights as the rate sees them.
  [[nodiscard]] constexpr const Forces& weights() const { return weights_; }
  /// Weights times forces of the table [N].
  [[nodiscard]] constexpr const Forces& values() const { return values_; }
  /// Their sum [N].
  [[nodiscard]] constexpr const Number& line() const { return line_; }
  /// values() before the last relax().
  [[nodiscard]] constexpr const Forces& before() const { return before_; }

  /// Takes other values.
  constexpr void set(const Forces& values) {
    values_ = before_ = values;
    line_ = sum();
  }

  /// Follows the force of the table at the end of a sample [N].
  [[gnu::always_inline]] constexpr void relax(const Number& force) {
    if (count_ == 1) {  // by far the most frequent
      before_[0] = values_[0];
      const Number kept = kept_[0] * values_[0];
      values_[0] = taken_[0] * force + kept;
      return keep_line(values_[0]);
    }
    before_ = values_;
    if (force < line_) return relax_apart(force);
    Number sum_kept = 0;  // apart from the force, for which this would have to wait
    for (std::size_t i = 0; i < count_; ++i) {
      const Number kept = kept_[i] * values_[i];
      sum_kept = sum_kept + kept;
      values_[i] = taken_[i] * force + kept;
    }
    keep_line(sum_taken_ * force + sum_kept);
  }

 private:
  // Smaller forces are forgotten, before they become denormal [N].
  static constexpr double kForgotten_n = 1e-30;

  // Several memories, below the surface: one after the other moves towards the force, but not past where the energy
  // is least, or together they would add energy.
  constexpr void relax_apart(const Number& force) {
    for (std::size_t i = 0; i < count_; ++i) {
      const Number others = line_ - values_[i];
      const Number target = force < line_ ? (std::max)(force, others / (Number(1) - weights_[i])) : force;
      values_[i] = taken_[i] * target + kept_[i] * values_[i];
      line_ = others + values_[i];
    }
    keep_line(sum());
  }

  constexpr void keep_line(const Number& line) {
    line_ = line;
    if (!(Number(kForgotten_n) < line)) line_ = 0, values_ = {};
  }

  [[nodiscard]] constexpr Number sum() const {
    Number sum = 0;
    for (const Number& value : values_) sum = sum + value;
    return sum;
  }

  Forces weights_{}, kept_{}, taken_{}, values_{}, before_{};
  Number sum_taken_ = 0, line_ = 0;
  std::size_t count_ = 0;
};

}  // namespace detail

/// What a contact remembers, and its step at one sample rate. Each contact remembers its last increment, which
/// predicts the middle of the coming sample for a loss. Without memories the rest is the contact step alone.
///
/// Contact and memory take turns, half a sample apart: the contact moves at constant memory, on a potential that is
/// as convex as the table's; then the memory relaxes at constant compression. Neither adds energy, whatever the
/// weights and times. Weights and times are designed for the rate, so that memories shorter than a sample count as
/// much as a blow feels of them.
template <std::floating_point T>
class ContactMemory {
 public:
  constexpr ContactMemory() = default;

  /// At most kMaxMemories memories, weights > 0 with a sum below 1, times > 0.
  constexpr ContactMemory(std::span<const Memory> memories, double sample_rate_hz) {
    std::array<double, kMaxMemories> weights{}, times_s{};
    for (std::size_t i = 0; i < memories.size(); ++i)
      weights[i] = memories[i].weight, times_s[i] = memories[i].time_s;
    const detail::MemoryDesign<double> design({weights.data(), memories.size()}, {times_s.data(), memories.size()},
                                              sample_rate_hz);
    remembered_ = detail::RememberedForces<T>(design, memories.size());
    stiffness_ = static_cast<T>(design.stiffness);
  }

  [[nodiscard]] constexpr bool empty() const { return remembered_.count() == 0; }

  /// Forgets everything.
  constexpr void reset() {
    remembered_.set({});
    set_last_increment(0);
  }

  /// Change of the compression over the last sample [m]. Of a hammer in the kernels only with loss, and in reach.
  [[nodiscard]] constexpr T last_increment() const { return last_increment_; }
  /// Takes another one: 0 where the compression has jumped.
  constexpr void set_last_increment(T increment) { last_increment_ = increment_before_ = increment; }
  /// The compression has changed over a sample [m].
  constexpr void move_by(T increment) {
    increment_before_ = last_increment_;
    last_increment_ = increment;
  }

  /// Remembers a force of the table [N] that has acted for ever.
  constexpr void hold(T force) {
    typename detail::RememberedForces<T>::Forces values{};
    for (std::size_t i = 0; i < remembered_.count(); ++i) values[i] = remembered_.weights()[i] * force;
    remembered_.set(values);
  }

  /// The contact step at constant memory: as contact_step with these controls, whose loss is in parts of the force
  /// that the memory leaves. start: the segment of the table that holds y0.
  template <std::size_t Extent>
  [[nodiscard, gnu::always_inline]] constexpr ContactStep<T> step(SegmentTable<T, Extent> table,
                                                                  const ContactControls<T>& controls, T time_step,
                                                                  const Approach<T>& approach,
                                                                  std::size_t start) const {
    if (empty()) return detail::controlled_step(table, controls, time_step, approach, start, last_increment_);
    const T y0 = approach.compression, xf = approach.free_increment, xi = approach.receptance;
    if (y0 < 0 && y0 + xf < 0) return {0, y0 + xf, 0};
    if (controls.loss_s_per_m == 0 && table[start].force_at(y0) >= remembered_.line()) {
      // Above the surface the line is a force that presses the bodies together.
      const T ratio = controls.stiffness_ratio * stiffness_;
      const ContactStep<T> pressed =
          detail::contact_step(table, start, Approach<T>{y0, xf + ratio * xi * remembered_.line(), ratio * xi}, T(1));
      if (table[pressed.segment].force_at(pressed.compression) >= remembered_.line())
        return {ratio * (std::max)(T(0), pressed.force - remembered_.line()), pressed.compression, pressed.segment};
    }
    return step_through_surface(table, controls, time_step, approach, start);
  }

  /// The memory follows the force at the end of a sample, where the table's segment holds the compression [m].
  template <std::size_t Extent>
  [[gnu::always_inline]] constexpr void relax(SegmentTable<T, Extent> table, T compression, std::size_t segment) {
    if (!empty()) remembered_.relax(table[segment].force_at(compression));
  }

  /// One sample of the contact and of its memory.
  template <std::size_t Extent>
  [[nodiscard, gnu::always_inline]] constexpr ContactStep<T> advance(SegmentTable<T, Extent> table,
                                                                     const ContactControls<T>& controls, T time_step,
                                                                     const Approach<T>& approach, std::size_t start) {
    const ContactStep<T> result = step(table, controls, time_step, approach, start);
    move_by(result.compression - approach.compression);
    relax(table, result.compression, result.segment);
    return result;
  }

  /// The potential at constant memory, in parts of designed().stiffness_ratio.
  template <std::size_t Extent>
  [[nodiscard]] constexpr detail::TableLessLine<T, Extent> spring(SegmentTable<T, Extent> table) const {
    return {table, remembered_.line(), empty() ? 1 : detail::segment_of_force(table, remembered_.line())};
  }
  /// What is remembered now.
  [[nodiscard]] constexpr const detail::RememberedForces<T>& remembered() const { return remembered_; }
  /// The controls with the stiffness that the rate asks for.
  [[nodiscard]] constexpr ContactControls<T> designed(const ContactControls<T>& controls) const {
    return {controls.stiffness_ratio * stiffness_, controls.loss_s_per_m};
  }

  /// Compression at which the felt has its surface between two samples [m]: where the force is 0 by the mean of what
  /// was remembered before and is now.
  template <std::size_t Extent>
  [[nodiscard]] constexpr T surface(SegmentTable<T, Extent> table) const {
    const T line = (sum(remembered_.before()) + remembered_.line()) / 2;
    return detail::TableLessLine<T, Extent>(table, line, detail::segment_of_force(table, line)).surface();
  }

  /// Energy that contact and memory store [J]: above 0 also while the bodies are apart and the memory relaxes.
  template <std::size_t Extent>
  [[nodiscard]] constexpr T energy(SegmentTable<T, Extent> table, T compression, T stiffness_ratio = 1) const {
    return energy_with(remembered_.values(), table, compression, stiffness_ratio);
  }
  /// The same before the memory relaxed last.
  template <std::size_t Extent>
  [[nodiscard]] constexpr T energy_before(SegmentTable<T, Extent> table, T compression, T stiffness_ratio = 1) const {
    return energy_with(remembered_.before(), table, compression, stiffness_ratio);
  }
  /// The force midway of the last sample, which began at a compression [m], after advance() [N].
  template <std::size_t Extent>
  [[nodiscard]] constexpr T midway_force_before(SegmentTable<T, Extent> table, T compression) const {
    const T line = sum(remembered_.before());
    const detail::TableLessLine<T, Extent> spring(table, line, detail::segment_of_force(table, line));
    const std::size_t start = spring.segment_here(segment_index(table, compression), compression);
    return stiffness_ * detail::force_midway(spring, start, compression, increment_before_);
  }

 private:
  using Forces = typename detail::RememberedForces<T>::Forces;

  // A step that ends or begins below the surface, or that has a loss.
  template <std::size_t Extent>
  constexpr ContactStep<T> step_through_surface(SegmentTable<T, Extent> table, const ContactControls<T>& controls,
                                                T time_step, const Approach<T>& approach, std::size_t start) const {
    const auto potential = spring(table);
    const std::size_t from = potential.segment_here(start, approach.compression);
    ContactStep<T> step =
        detail::controlled_step(potential, designed(controls), time_step, approach, from, last_increment_);
    step.segment = detail::relocate_segment(table, step.segment, step.compression);
    return step;
  }

  static constexpr T sum(const Forces& forces) {
    T sum = 0;
    for (const T force : forces) sum += force;
    return sum;
  }

  template <std::size_t Extent>
  constexpr T energy_with(const Forces& remembered, SegmentTable<T, Extent> table, T compression,
                          T stiffness_ratio) const {
    if (empty()) return stiffness_ratio * potential(table, compression);
    const auto less_line = [&](T line) {
      return detail::TableLessLine<T, Extent>(table, line, detail::segment_of_force(table, line));
    };
    T energy = 0;
    for (std::size_t i = 0; i < remembered_.count(); ++i) {
      const T weight = remembered_.weights()[i];
      energy -= weight * less_line(remembered[i] / weight).lowest_energy();
    }
    const T line = sum(remembered);
    const auto spring = less_line(line);
    const bool touches = compression > spring.surface();
    energy += touches ? potential(table, compression) - line * compression : spring.lowest_energy();
    return stiffness_ratio * stiffness_ * energy;
  }

  detail::RememberedForces<T> remembered_;
  T stiffness_ = 1;                              // that the rate asks for, in parts of the table's
  T last_increment_ = 0, increment_before_ = 0;  // of the compression, over the last sample and the one before [m]
};

/// The contact controls of a model that is in contact at this compression [m].
template <std::floating_point T, std::size_t Extent>
[[nodiscard]] constexpr ContactControls<T> followed_contact(const ContactMemory<T>& memory,
                                                            SegmentTable<T, Extent> table, T compression_m,
                                                            const ContactControls<T>& now,
                                                            const ContactControls<T>& controls, T time_step_s) {
  ContactControls<T> next = held(now, controls);
  if (next.stiffness_ratio > now.stiffness_ratio)
    next.stiffness_ratio = followed_stiffness(now.stiffness_ratio, next.stiffness_ratio,
                                              memory.energy(table, compression_m), time_step_s);
  return next;
}

}  // namespace contactspline
