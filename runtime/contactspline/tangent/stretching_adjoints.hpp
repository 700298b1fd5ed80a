// SPDX-License-Identifier: MIT
// The adjoints of modes that move over two samples, and of the forms by which they stretch
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/mode.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/mode_tangent.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/stretching_body_tangent.hpp"
#include "contactspline/tangent/stretching_record.hpp"

namespace contactspline::detail {

/// A form of a body at displacements of its modes, backwards. The adjoint of a value is the derivative of the sum
/// with respect to it.
template <std::floating_point T>
struct FormBackwards {
  const StretchForm& form;
  std::size_t body, begin, modes;    ///< where it is, and the modes of this
  std::vector<T> gradient, adjoint;  ///< A q, and its adjoint
  StretchForm sum;                   ///< adjoints of the numbers of the form
  bool acts = true;                  ///< at the sample rate

  FormBackwards(const StretchForm& of_form, std::size_t of_body, std::size_t first_mode, std::size_t count)
      : form(of_form),
        body(of_body),
        begin(first_mode),
        modes(count),
        gradient(count),
        adjoint(count),
        sum{0, std::vector<double>(count), of_form.products, {of_form.linear.mode, 0}} {
    for (auto& product : sum.products) product.factor_per_m2 = 0;
  }

  [[nodiscard]] T stiffness() const { return acts ? static_cast<T>(form.stiffness_j) : T(0); }
  /// displacements: of all modes of the network.
  void take(const std::vector<T>& displacements) { take_form_gradient(form, displacements.data() + begin, gradient); }
  /// Gradient times values, of all modes of the network.
  [[nodiscard]] T stretch(const std::vector<T>& values) const {
    T sum_of_products = 0;
    for (std::size_t i = 0; i < modes; ++i) sum_of_products += gradient[i] * values[begin + i];
    return sum_of_products;
  }
  /// What of the stretch stands in no product with the gradient, and its adjoint back.
  [[nodiscard]] T beside_gradient(const std::vector<T>& displacements) const {
    return stretch_beside_gradient(form, displacements.data() + begin);
  }
  void add_beside_gradient(T of_it, const std::vector<T>& displacements, std::vector<T>& of_displacements) {
    if (form.linear.factor_per_m == 0) return;
    const std::size_t m = begin + form.linear.mode;
    of_displacements[m] += of_it * static_cast<T>(form.linear.factor_per_m / 2);
    sum.linear.factor_per_m += double(of_it * displacements[m]) / 2;
  }
  /// The adjoint of the gradient becomes that of the displacements and the form.
  void finish(const std::vector<T>& displacements, std::vector<T>& of_displacements) {
    const T* q = displacements.data() + begin;
    add_form_product(form, adjoint.data(), of_displacements.data() + begin);
    for (std::size_t i = 0; i < modes; ++i) sum.squares_per_m2[i] += double(adjoint[i]) * double(q[i]);
    if (form.linear.factor_per_m != 0) sum.linear.factor_per_m += double(adjoint[form.linear.mode]) / 2;
    for (auto& [first, second, factor] : sum.products)
      factor += double(adjoint[first]) * double(q[second]) + double(adjoint[second]) * double(q[first]);
    std::ranges::fill(adjoint, T(0));
  }
};

/// A place on which a force acts, by its sign: the modes from `begin` on, their shapes there and the adjoints of
/// these.
template <std::floating_point T>
struct StretchingArm {
  std::size_t begin, modes;
  const T* shapes;
  T* of_shapes;
  T sign;
};

/// All modes of a network in a sample, with names as in TwoStepMotion: q in its middle, c after it and last_c before
/// it; and the adjoints of these and of the constants. The adjoint of a value is the derivative of the sum with
/// respect to it.
template <std::floating_point T>
struct TwoStepAdjoints {
  using Arms = std::span<const StretchingArm<T>>;
  struct Start {
    T displacement, velocity;
  };

  const NetworkPlan<T>& plan;
  double rate;
  NetworkModes<T> modes;
  std::vector<FormBackwards<T>> forms;  ///< of all bodies
  std::vector<T> q, c, last_c;
  std::vector<T> of_q, of_c, of_last_c, of_d;
  std::vector<T> of_stiffness, of_loss, of_receptance, of_decay, of_travel;

  TwoStepAdjoints(const NetworkPlan<T>& of_plan, double sample_rate_hz)
      : plan(of_plan), rate(sample_rate_hz), modes(of_plan, sample_rate_hz) {
    for (auto* values : {&q, &c, &last_c, &of_q, &of_c, &of_last_c, &of_d, &of_stiffness, &of_loss, &of_receptance,
                         &of_decay, &of_travel})
      values->resize(modes.size());
    for (std::size_t b = 0; b < plan.bodies().size(); ++b)
      for (const StretchForm& form : plan.forms(b))
        forms.emplace_back(form, b, modes.begins[b], plan.bodies()[b].size()).acts = modes.acts(b, form);
  }

  /// The forms are where q is.
  void take_forms() {
    for (FormBackwards<T>& form : forms) form.take(q);
  }
  /// Begins a sample back: d = c - (loss c + stiffness (q + c)) after it.
  void begin() {
    for (std::size_t i = 0; i < q.size(); ++i) {
      of_c[i] += (1 - modes.loss[i]) * of_d[i];
      of_loss[i] -= c[i] * of_d[i];
      of_q[i] -= modes.stiffness[i] * of_d[i];
      of_stiffness[i] -= (q[i] + c[i]) * of_d[i];
      of_c[i] += of_q[i];
      of_last_c[i] = 0;
    }
  }
  /// Ends it: c was d and what forces did.
  void end() {
    for (FormBackwards<T>& form : forms) form.finish(q, of_q);
    std::swap(of_d, of_c);
    std::swap(of_c, of_last_c);
  }

  /// Adds to the adjoint of a compression after the sample, S(q + c) - gap, or before it, S(q - c-) - gap.
  void press_after(const Arms& arms, T adjoint) {
    for (const StretchingArm<T>& arm : arms)
      for (std::size_t i = 0; i < arm.modes; ++i) {
        const std::size_t m = arm.begin + i;
        const T by_mode = arm.sign * arm.shapes[i] * adjoint;
        of_q[m] += by_mode;
        of_c[m] += by_mode;
        arm.of_shapes[i] += arm.sign * adjoint * (q[m] + c[m]);
      }
  }
  void press_before(const Arms& arms, T adjoint) {
    for (const StretchingArm<T>& arm : arms)
      for (std::size_t i = 0; i < arm.modes; ++i) {
        const std::size_t m = arm.begin + i;
        const T by_mode = arm.sign * arm.shapes[i] * adjoint;
        of_q[m] += by_mode;
        of_last_c[m] -= by_mode;
        arm.of_shapes[i] += arm.sign * adjoint * (q[m] - last_c[m]);
      }
  }
  /// The adjoint of a force on an arm: c = ... + 2 receptance S f.
  [[nodiscard]] T pushed(const StretchingArm<T>& arm) const {
    T sum = 0;
    for (std::size_t i = 0; i < arm.modes; ++i)
      sum += arm.shapes[i] * modes.receptance[arm.begin + i] * of_c[arm.begin + i];
    return 2 * arm.sign * sum;
  }
  /// What a force did through receptances and shapes.
  void drive(const StretchingArm<T>& arm, T force) {
    for (std::size_t i = 0; i < arm.modes; ++i) {
      const std::size_t m = arm.begin + i;
      const T twice = 2 * arm.sign * force * of_c[m];
      of_receptance[m] += arm.shapes[i] * twice;
      arm.of_shapes[i] += modes.receptance[m] * twice;
    }
  }
  /// The change of the increment of a per newton of b [m/N].
  [[nodiscard]] T coupling(const Arms& a, const Arms& b) const {
    T sum = 0;
    for (const StretchingArm<T>& x : a)
      for (const StretchingArm<T>& y : b)
        for (std::size_t i = 0; x.begin == y.begin && i < (std::min)(x.modes, y.modes); ++i)
          sum += 2 * x.sign * y.sign * x.shapes[i] * y.shapes[i] * modes.receptance[x.begin + i];
    return sum;
  }

  /// c and d of a body from its free increments, as TwoStepMotion::take_motion finds them, back.
  void settle(std::size_t body, const std::vector<T>& changes) {
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const std::size_t m = modes.begins[body] + i;
      if (double(modes.loss[m]) > kMaxLoss) {
        of_q[m] -= modes.stiffness[m] * of_d[m];
        of_stiffness[m] -= q[m] * of_d[m];
        of_d[m] = of_c[m] = 0;
        continue;
      }
      const T adjoint = std::exchange(of_c[m], T(0)) / (1 - modes.loss[m]);
      of_d[m] += adjoint;
      of_q[m] += modes.stiffness[m] * adjoint;
      of_stiffness[m] += q[m] * adjoint;
      of_loss[m] += changes[i] * adjoint;
    }
  }
  /// What the forms add to d, times a factor, back.
  void pull(std::size_t body, T factor) {
    for (FormBackwards<T>& form : forms) {
      if (form.body != body) continue;
      const T stretched = form.stretch(q) + form.beside_gradient(q);
      T sum = 0;
      for (std::size_t i = 0; i < form.modes; ++i) {
        const std::size_t m = form.begin + i;
        const T by_motion = factor * form.stiffness() * stretched * of_d[m];
        sum += factor * of_d[m] * modes.receptance[m] * form.gradient[i];
        of_receptance[m] += by_motion * form.gradient[i];
        form.adjoint[i] += by_motion * modes.receptance[m];
      }
      if (form.acts) form.sum.stiffness_j += double(stretched * sum);
      form.add_beside_gradient(form.stiffness() * sum, q, of_q);
      for (std::size_t i = 0; i < form.modes; ++i) {
        form.adjoint[i] += form.stiffness() * sum * q[form.begin + i];
        of_q[form.begin + i] += form.stiffness() * sum * form.gradient[i];
      }
      form.finish(q, of_q);
    }
  }
  /// The mode of a body that was put somewhere: its free increment is (v + decay q) travel - (loss + stiffness)/2 q.
  /// Returns the derivatives by both.
  [[nodiscard]] Start leave_start(std::size_t body, std::size_t mode, T displacement, T velocity) {
    const std::size_t m = modes.begins[body] + mode;
    const Mode& numbers = plan.bodies()[body][mode];
    const T travel = static_cast<T>(travel_of(numbers, rate)), decay = static_cast<T>(numbers.decay_per_s);
    const T by_d = std::exchange(of_d[m], T(0)), by_q = std::exchange(of_q[m], T(0));
    if (modes.receptance[m] == 0) return {0, 0};
    of_travel[m] += (velocity + decay * displacement) * by_d;
    of_decay[m] += displacement * travel * by_d;
    of_loss[m] -= displacement / 2 * by_d;
    of_stiffness[m] -= displacement / 2 * by_d;
    return {by_q + (decay * travel - (modes.loss[m] + modes.stiffness[m]) / 2) * by_d, travel * by_d};
  }

  /// At the end: where forms have springs of modes, the adjoints of these and of the modes' own constants
  /// (ModalBank::give_away_spring).
  void give_springs_back() {
    for (FormBackwards<T>& form : forms) {
      if (!modes.has_spring(form.body, form.form)) continue;
      const std::size_t m = form.begin + form.form.linear.mode;
      const T spring = modes.spring_of(form.form), gain = modes.gain_of(m, spring);
      const T receptance = modes.own_receptance[m], rest = modes.own_stiffness[m] - 2 * receptance * spring;
      const T by_gain =
          gain * gain / 2 * (rest * of_stiffness[m] + modes.own_loss[m] * of_loss[m] + receptance * of_receptance[m]);
      const double of_spring = double(receptance * (by_gain - 2 * gain * of_stiffness[m]));
      of_receptance[m] = gain * of_receptance[m] + spring * (by_gain - 2 * gain * of_stiffness[m]);
      of_stiffness[m] *= gain;
      of_loss[m] *= gain;
      const double factor = form.form.linear.factor_per_m;
      form.sum.stiffness_j += of_spring * factor * factor / 2;
      form.sum.linear.factor_per_m += of_spring * form.form.stiffness_j * factor;
    }
  }
  /// Then the adjoint of a mode's numbers.
  [[nodiscard]] Mode mode_numbers(std::size_t b, std::size_t i) const {
    const std::size_t m = modes.begins[b] + i;
    const Mode& mode = plan.bodies()[b][i];
    const auto by = [&](const Mode& direction) {
      const ModeStep step = step_tangent(mode, direction, rate);
      return double(of_stiffness[m]) * step.stiffness + double(of_loss[m]) * step.loss +
             double(of_receptance[m]) * step.receptance + double(of_decay[m]) * direction.decay_per_s +
             double(of_travel[m]) * travel_tangent(mode, direction, rate);
    };
    return {by({1, 0, 0}), by({0, 1, 0}), by({0, 0, 1})};
  }
};

}  // namespace contactspline::detail
