// SPDX-License-Identifier: MIT
// The modes of all bodies of a network, for its derivatives, and the motion of the derivatives forwards
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/mode.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/dual.hpp"
#include "contactspline/tangent/mode_tangent.hpp"
#include "contactspline/tangent/network_numbers.hpp"

namespace contactspline::detail {

/// The constants of all modes of a plan, one body after the other.
template <std::floating_point T>
struct NetworkModes {
  std::vector<std::size_t> begins = {0};  // of each body, and the number of all
  std::vector<T> stiffness, loss, admittance;

  NetworkModes(const NetworkPlan<T>& plan, double sample_rate_hz) {
    for (const auto& modes : plan.bodies()) {
      for (const Mode& mode : modes) {
        const ModeStep step = step_of(mode, sample_rate_hz);
        stiffness.push_back(static_cast<T>(step.stiffness));
        loss.push_back(static_cast<T>(step.loss));
        admittance.push_back(static_cast<T>(step.admittance));
      }
      begins.push_back(stiffness.size());
    }
  }
  [[nodiscard]] std::size_t size() const { return stiffness.size(); }
};

/// change[i] += admittance[i] shapes[i] force: what a force does to modes over a sample. A function of its own,
/// because compilers respect __restrict on parameters.
template <std::floating_point T>
void add_push(std::size_t modes, T force, const T* __restrict admittance, const T* __restrict shapes,
              T* __restrict change) {
  for (std::size_t i = 0; i < modes; ++i) change[i] += admittance[i] * shapes[i] * force;
}

/// The shapes of the modes of a body at a place, with their slopes with respect to P parameters.
template <std::floating_point T, std::size_t P>
struct ShapeSlopes {
  ModeShapes<T> values;
  std::array<ModeShapes<T>, P> slopes = {};
  bool is_constant = true;  ///< are all slopes 0? Then they do not count.

  explicit ShapeSlopes(const ModeShapes<T>& shapes) : values(shapes) { slopes.fill(ModeShapes<T>(shapes.size())); }

  /// Becomes by_a a + by_b b.
  void combine(T by_a, const ShapeSlopes& a, T by_b, const ShapeSlopes& b) {
    is_constant = a.is_constant && b.is_constant;
    combine(by_a, a.values, by_b, b.values, values);
    for (std::size_t p = 0; p < P && !is_constant; ++p) combine(by_a, a.slopes[p], by_b, b.slopes[p], slopes[p]);
  }

 private:
  static void combine(T by_a, const ModeShapes<T>& a, T by_b, const ModeShapes<T>& b, ModeShapes<T>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = by_a * a[i] + by_b * b[i];
  }
};

/// How the motion of all modes follows P parameters. With constants that do not depend on them, slopes move as the
/// modes do, under the slopes of the forces; each other term is a push on each mode. The motion itself is the
/// model's.
template <std::floating_point T, std::size_t P>
class ModeSlopes {
 public:
  using Number = Dual<T, P>;
  using Slopes = std::array<T, P>;
  using Shapes = ShapeSlopes<T, P>;

  ModeSlopes(const NetworkPlan<T>& plan, double sample_rate_hz, const std::array<NetworkNumbers<T>, P>& directions) {
    for (std::size_t b = 0; b < plan.bodies().size(); ++b) {
      const std::span<const Mode> modes(plan.bodies()[b]);
      bodies_.emplace_back();
      for (std::size_t p = 0; p < P; ++p) {
        bodies_[b].slopes.push_back({ModalBank<T>(modes, sample_rate_hz), {}, std::vector<T>(modes.size()), {}});
        const auto& all = directions[p].bodies;
        if (!all.empty() && !all[b].empty()) add_direction(bodies_[b].slopes[p], modes, all[b], sample_rate_hz);
      }
    }
    for (const auto& place : plan.places()) ++bodies_[place.body].places;
    for (Body& body : bodies_) {
      body.pushed.reserve(body.places);
      for (auto& forces : body.forces) forces.reserve(body.places);
    }
  }

  /// Keeps ready what free_increment() tells of a place of a body with these shapes, which must stay. Returns its
  /// number at this body.
  std::size_t watch(std::size_t body, const ModeShapes<T>& shapes) {
    Body& b = bodies_[body];
    b.watched.push_back(shapes.data());
    for (BodySlopes& s : b.slopes) s.free_increments.push_back(T(0));
    return b.watched.size() - 1;
  }

  /// Puts a free mass elsewhere [m], with a velocity [m/s].
  void set_motion(std::size_t mass, const Number& displacement, const Number& velocity) {
    for (std::size_t p = 0; p < P; ++p) {
      BodySlopes& s = bodies_[mass].slopes[p];
      s.bank.set_motion(0, displacement.slopes[p], velocity.slopes[p]);
      s.bank.free_increments(std::span<const T* const>(bodies_[mass].watched), s.free_increments.data());
    }
  }

  /// Pushes at a place of a body in the coming sample, by a force that does not wait for others.
  void push(std::size_t body, const Shapes& shapes, const Number& force) {
    const std::size_t n = shapes.values.size();
    for (std::size_t p = 0; p < P; ++p) {
      BodySlopes& s = bodies_[body].slopes[p];
      const T* admittance = s.bank.arrays().admittance;
      const auto add = [&](T factor, const T* admittances, const ModeShapes<T>& at) {
        if (factor == 0) return;
        s.is_pushed = true;
        add_push(n, factor, admittances, at.data(), s.pushed.data());
      };
      add(force.slopes[p], admittance, shapes.values);
      if (!shapes.is_constant) add(force.value, admittance, shapes.slopes[p]);
      if (!s.constants.admittance.empty()) add(force.value, s.constants.admittance.data(), shapes.values);
    }
  }

  /// Adds to the derivatives of the force at a place of a body, over the coming sample. shapes must stay.
  void push_slopes(std::size_t body, const Shapes& shapes, const Slopes& slopes) {
    if (slopes == Slopes{}) return;
    bodies_[body].pushed.push_back(shapes.values.data());
    for (std::size_t p = 0; p < P; ++p) bodies_[body].forces[p].push_back(slopes[p]);
  }

  /// Ends the sample of a body. displacements, changes: of the model's modes, after and over the sample.
  void advance(std::size_t body, std::span<const T> displacements, std::span<const T> changes) {
    Body& b = bodies_[body];
    for (std::size_t p = 0; p < P; ++p) {
      BodySlopes& s = b.slopes[p];
      const std::span<const T*const> pushed(b.pushed), watched(b.watched);
      T* increment = s.bank.arrays().free_increment;
      if (s.is_pushed) add_scaled(0, s.pushed.size(), T(1), s.pushed.data(), increment);
      s.bank.advance(T(0), pushed, b.forces[p].data(), watched, s.free_increments.data());
      const Constants& c = s.constants;
      if (s.is_pushed || !c.stiffness.empty()) {
        // The bank takes what was added for a part of the increment before.
        if (s.is_pushed) add_scaled(0, s.pushed.size(), T(1), s.pushed.data(), increment);
        if (std::exchange(s.is_pushed, false)) std::ranges::fill(s.pushed, T(0));
        for (std::size_t i = 0; i < c.stiffness.size(); ++i)
          increment[i] -= c.loss[i] * changes[i] + c.stiffness[i] * displacements[i];
        s.bank.free_increments(watched, s.free_increments.data());
      }
      b.forces[p].clear();
    }
    b.pushed.clear();
  }

  /// The slopes of the displacement at a place of a body [m]. displacements: of the model's modes.
  [[nodiscard]] Slopes displacement(std::size_t body, const Shapes& shapes, std::span<const T> displacements) const {
    return sum(body, shapes, displacements, [&](const BodySlopes& s) { return s.bank.displacement(shapes.values); });
  }
  /// The same for the change over the last sample. changes: of the model's modes.
  [[nodiscard]] Slopes change(std::size_t body, const Shapes& shapes, std::span<const T> changes) const {
    return sum(body, shapes, changes, [&](const BodySlopes& s) { return s.bank.increment(shapes.values); });
  }
  /// The same for the coming sample, which the model has played, without push_slopes(). watched: of watch(), for a
  /// place without slopes.
  [[nodiscard]] Slopes free_increment(std::size_t body, const Shapes& shapes, std::size_t watched) const {
    Slopes increments{};
    for (std::size_t p = 0; p < P; ++p) {
      const BodySlopes& s = bodies_[body].slopes[p];
      increments[p] = s.free_increments[watched];
      if (s.is_pushed) increments[p] += product(s.pushed.size(), shapes.values.data(), s.pushed.data());
    }
    return increments;
  }
  [[nodiscard]] Slopes free_increment(std::size_t body, const Shapes& shapes, std::span<const T> changes) const {
    const T* at = shapes.values.data();
    return sum(body, shapes, changes, [&](const BodySlopes& s) {
      T increment = 0;
      s.bank.free_increments({&at, 1}, &increment);
      return s.is_pushed ? increment + product(s.pushed.size(), at, s.pushed.data()) : increment;
    });
  }

 private:
  // Slopes of the constants of the modes of a body; empty if they are 0.
  struct Constants {
    std::vector<T> stiffness = {}, loss = {}, admittance = {};
  };
  // The slopes of a body with respect to one parameter. pushed: by push(), over the coming sample. free_increments:
  // at the places that are watched.
  struct BodySlopes {
    ModalBank<T> bank;
    Constants constants;
    std::vector<T> pushed, free_increments;
    bool is_pushed = false;
  };
  // pushed, forces: by push_slopes().
  struct Body {
    std::vector<BodySlopes> slopes = {};
    std::size_t places = 0;
    std::vector<const T*> pushed = {}, watched = {};
    std::array<std::vector<T>, P> forces = {};
  };

  static void add_direction(BodySlopes& slopes, std::span<const Mode> modes, std::span<const Mode> direction,
                            double sample_rate_hz) {
    Constants& c = slopes.constants;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const ModeStep tangent = step_tangent(modes[i], direction[i], sample_rate_hz);
      c.stiffness.push_back(static_cast<T>(tangent.stiffness));
      c.loss.push_back(static_cast<T>(tangent.loss));
      c.admittance.push_back(static_cast<T>(tangent.admittance));
    }
  }

  template <typename OfSlopes>
  [[nodiscard]] Slopes sum(std::size_t body, const Shapes& shapes, std::span<const T> motion, OfSlopes of) const {
    Slopes sums{};
    for (std::size_t p = 0; p < P; ++p) {
      sums[p] = of(bodies_[body].slopes[p]);
      if (!shapes.is_constant) sums[p] += product(motion.size(), shapes.slopes[p].data(), motion.data());
    }
    return sums;
  }

  static T product(std::size_t n, const T* a, const T* b) {
    return sum_of<T>(n, [&](std::size_t i) { return a[i] * b[i]; });
  }

  std::vector<Body> bodies_;
};

}  // namespace contactspline::detail
