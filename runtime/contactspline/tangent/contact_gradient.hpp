// SPDX-License-Identifier: MIT
// A contact with memory backwards, sample by sample: what the adjoint of its force does to its numbers, its
// compression and its memory (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/mode.hpp"
#include "contactspline/tangent/contact_tangent.hpp"

namespace contactspline {

namespace detail {

template <std::floating_point T>
[[nodiscard]] T product(const ModeShapes<T>& a, const ModeShapes<T>& b) {
  T sum = 0;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) sum += a[i] * b[i];
  return sum;
}

template <typename Row, typename Product>
[[nodiscard]] auto sum_over(const std::vector<Row>& a, const std::vector<Row>& b, Product product) {
  decltype(product(a[0], b[0])) sum = 0;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) sum += product(a[i], b[i]);
  return sum;
}

[[nodiscard]] inline double product(const std::vector<Mode>& a, const std::vector<Mode>& b) {
  return sum_over(a, b, [](const Mode& x, const Mode& y) {
    return x.angular_frequency_rad_per_s * y.angular_frequency_rad_per_s + x.decay_per_s * y.decay_per_s +
           x.mass_kg * y.mass_kg;
  });
}

}  // namespace detail

/// The derivative in a direction of the sum whose gradient is given: the sum of all products.
template <std::floating_point T>
[[nodiscard]] T derivative(const ContactNumbers<T>& gradient, const ContactNumbers<T>& direction) {
  const double memories =
      detail::sum_over(gradient.memories, direction.memories,
                       [](const Memory& x, const Memory& y) { return x.weight * y.weight + x.time_s * y.time_s; });
  const T table = detail::sum_over(gradient.table, direction.table, [](const Segment<T>& x, const Segment<T>& y) {
    return x.force * y.force + x.half_curvature * y.half_curvature;
  });
  return gradient.stiffness_ratio * direction.stiffness_ratio + gradient.loss_s_per_m * direction.loss_s_per_m +
         table + static_cast<T>(memories);
}

namespace detail {

/// What a sample of a contact is differentiated at.
template <std::floating_point T>
struct ContactSample {
  T before = 0, after = 0, force = 0;        // compression before and after [m], force over the sample [N]
  T last_increment = 0;                      // x_last of the contact step [m]
  std::array<T, kMaxMemories> remembered{};  // before the sample
};

/// A contact backwards. The adjoint of a value is the derivative of the sum with respect to it. For each sample, from
/// the last to the first: relax(), linearise(), then push() with the adjoint of the force.
template <std::floating_point T>
class ContactBackwards {
 public:
  using Sample = ContactSample<T>;

  /// How the force of a sample follows compressions and numbers.
  struct Step {
    ContactPath<T> path;
    ContactSlopes<T> slopes;
  };

  /// Table and memories must outlive this. controls: of the whole time.
  ContactBackwards(SegmentTable<T> table, std::span<const Memory> memories, const ContactControls<T>& controls,
                   double sample_rate_hz)
      : table_(table),
        memories_(memories),
        controls_(controls),
        time_step_(static_cast<T>(1 / sample_rate_hz)),
        table_adjoint_(table.begin(), table.end()) {
    const std::array<ContactNumbers<T>, kDesignSeeds> seeds = design_seeds();
    design_ = design_tangent<T, kDesignSeeds>(memories, sample_rate_hz,
                                              std::span<const ContactNumbers<T>, kDesignSeeds>(seeds));
    for (Segment<T>& s : table_adjoint_) s.energy = s.force = s.half_curvature = 0;
  }

  /// Adjoints of the compressions before and after a sample.
  struct Ends {
    T before, after;
  };
  /// The increment, as the loss of the next sample sees it, and the memory back. Returns what this adds to the
  /// adjoints.
  [[nodiscard]] Ends relax(const Sample& sample) {
    const T last = std::exchange(last_increment_, T(0));
    return {-last, last + relax_memory(sample)};
  }

  /// Between the two, the compression jumped: ContactMemory::set_last_increment of 0.
  void jump() { last_increment_ = 0; }

  /// receptance: of all that moves the contact [m/N], for the slopes' gain.
  [[nodiscard]] Step linearise(const Sample& sample, T receptance) const {
    T line = 0;
    for (const T value : sample.remembered) line += value;
    const ContactPath<T> path(table_, line, sample.before, sample.after, sample.last_increment);
    const ContactControls<T> designed{controls_.stiffness_ratio * design_.stiffness.value, controls_.loss_s_per_m};
    return {path, ContactSlopes<T>(path, designed, time_step_, receptance, sample.force)};
  }

  /// Adds what the adjoint of the force, at constant compressions, does to all numbers and to what is remembered.
  void push(const Sample& sample, const Step& step, T adjoint) {
    const ContactPath<T>& path = step.path;
    const ContactSlopes<T>& slopes = step.slopes;
    ratio_ += slopes.ratio * adjoint;
    loss_ += slopes.loss * adjoint;
    last_increment_ = slopes.last * adjoint;
    for (std::size_t i = 0; i < memories_.size(); ++i) remembered_[i] += slopes.line * adjoint;
    if (!(sample.force > 0)) return;
    path.for_pieces([&](std::size_t j, T from, T to) {
      add_to_table(j, path.middle(from, to), (to - from) * slopes.table * adjoint);
    });
    const auto midway = path.midway();
    add_to_table(midway.segment, midway.compression, slopes.table_midway * adjoint);
  }

  /// After the first sample: the gradient.
  [[nodiscard]] ContactNumbers<T> gradient() const {
    ContactNumbers<T> numbers{design_.stiffness.value * ratio_, loss_, table_adjoint_, {}};
    for (std::size_t i = 0; i < memories_.size(); ++i) numbers.memories.push_back({design(2 * i), design(2 * i + 1)});
    return numbers;
  }

 private:
  static constexpr std::size_t kDesignSeeds = 2 * kMaxMemories;  // weight and time of each memory
  // Seeds of a relaxation: the force, then for each memory its value, weight, kept and taken.
  static constexpr std::size_t kRelaxSeeds = 1 + 4 * kMaxMemories;
  using Relaxed = Dual<T, kRelaxSeeds>;

  [[nodiscard]] std::array<ContactNumbers<T>, kDesignSeeds> design_seeds() const {
    std::array<ContactNumbers<T>, kDesignSeeds> seeds;
    for (std::size_t i = 0; i < memories_.size(); ++i) {
      for (const std::size_t k : {2 * i, 2 * i + 1}) seeds[k].memories.resize(memories_.size());
      seeds[2 * i].memories[i].weight = 1;
      seeds[2 * i + 1].memories[i].time_s = 1;
    }
    return seeds;
  }

  // Returns the adjoint of the compression after the sample.
  [[nodiscard]] T relax_memory(const Sample& sample) {
    if (std::ranges::all_of(remembered_, [](T value) { return value == 0; })) return 0;
    const std::size_t j = segment_index(table_, sample.after);
    const std::array<T, kRelaxSeeds> adjoint = relaxed(sample, table_[j].force_at(sample.after));
    for (std::size_t i = 0; i < memories_.size(); ++i) remembered_[i] = adjoint[1 + i];
    for (std::size_t k = 0; k < design_adjoint_.size(); ++k) design_adjoint_[k] += adjoint[1 + kMaxMemories + k];
    add_to_table(j, sample.after, adjoint[0]);
    return 2 * table_[j].half_curvature * adjoint[0];
  }

  // The adjoint of each seed of a relaxation: its derivatives by duals, read in the other direction.
  [[nodiscard]] std::array<T, kRelaxSeeds> relaxed(const Sample& sample, T force) const {
    const auto seed = [](T value, std::size_t k) {
      Relaxed number(value);
      number.slopes[k] = 1;
      return number;
    };
    const std::size_t count = memories_.size();
    MemoryDesign<Relaxed> design;
    std::array<Relaxed, kMaxMemories> values{};
    for (std::size_t i = 0; i < count; ++i) {
      values[i] = seed(sample.remembered[i], 1 + i);
      design.weights[i] = seed(design_.weights[i].value, 1 + kMaxMemories + i);
      design.kept[i] = seed(design_.kept[i].value, 1 + 2 * kMaxMemories + i);
      design.taken[i] = seed(design_.taken[i].value, 1 + 3 * kMaxMemories + i);
    }
    RememberedForces<Relaxed> forces(design, count);
    forces.set(values);
    forces.relax(seed(force, 0));
    std::array<T, kRelaxSeeds> adjoint{};
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < kRelaxSeeds; ++k) adjoint[k] += remembered_[i] * forces.values()[i].slopes[k];
    return adjoint;
  }

  // The gradient with respect to a weight or a time.
  [[nodiscard]] double design(std::size_t seed) const {
    T total = controls_.stiffness_ratio * ratio_ * design_.stiffness.slopes[seed];
    for (std::size_t k = 0; k < memories_.size(); ++k)
      total += design_adjoint_[k] * design_.weights[k].slopes[seed] +
               design_adjoint_[kMaxMemories + k] * design_.kept[k].slopes[seed] +
               design_adjoint_[2 * kMaxMemories + k] * design_.taken[k].slopes[seed];
    return double(total);
  }

  // adjoint: of a force of the table at compression y in segment j.
  void add_to_table(std::size_t j, T y, T adjoint) {
    table_adjoint_[j].force += adjoint;
    table_adjoint_[j].half_curvature += 2 * (y - table_[j].knot) * adjoint;
  }

  SegmentTable<T> table_;
  std::span<const Memory> memories_;
  ContactControls<T> controls_;
  T time_step_;
  std::vector<Segment<T>> table_adjoint_;
  std::array<T, kMaxMemories> remembered_{};  // adjoint of each remembered force
  T last_increment_ = 0;                      // its adjoint
  T ratio_ = 0, loss_ = 0;
  std::array<T, 3 * kMaxMemories> design_adjoint_{};  // weights, kept, taken
  MemoryDesign<Dual<T, kDesignSeeds>> design_;
};

}  // namespace detail

}  // namespace contactspline
