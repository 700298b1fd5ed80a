// SPDX-License-Identifier: MIT
// The modes of a body over two samples, with the forms by which it stretches and the derivatives of both
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <functional>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/tangent/dual.hpp"
#include "contactspline/tangent/mode_tangent.hpp"

namespace contactspline::detail {

/// As in TwoStepMotion: modes that lose more of their energy in a sample have no velocity.
inline constexpr double kMaxLoss = 0.19;

/// By how much 1 m/s moves a mode in free motion over a sample [s].
[[nodiscard]] inline double travel_of(const Mode& mode, double sample_rate_hz) {
  return 1 / mode_constants(mode, sample_rate_hz).velocity_gain;
}
/// The derivative of travel_of(mode) in a direction: of exp(-decay dt) sin(w dt)/w.
[[nodiscard]] inline double travel_tangent(const Mode& mode, const Mode& direction, double sample_rate_hz) {
  const double w = mode.angular_frequency_rad_per_s, dt = 1 / sample_rate_hz;
  const double by_decay = -dt * direction.decay_per_s * travel_of(mode, sample_rate_hz);
  if (!(w > 0)) return by_decay;
  const double by_w = std::exp(-mode.decay_per_s * dt) * (dt * std::cos(w * dt) - std::sin(w * dt) / w) / w;
  return by_decay + by_w * direction.angular_frequency_rad_per_s;
}

/// The sum of all products of numbers with slopes, as many of each.
template <std::floating_point T, std::size_t P>
[[nodiscard]] Dual<T, P> product(const std::vector<Dual<T, P>>& a, const std::vector<Dual<T, P>>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), Dual<T, P>());
}

/// A StretchForm with slopes, at displacements q of the modes.
template <std::floating_point T, std::size_t P>
class FormTangent {
 public:
  using Number = Dual<T, P>;
  using Numbers = std::vector<Number>;

  /// directions: of the form; what is missing at the end of their lists is 0.
  FormTangent(const StretchForm& form, std::size_t modes, const std::array<StretchForm, P>& directions)
      : stiffness_(form.stiffness_j),
        linear_mode_(form.linear.mode),
        half_linear_(form.linear.factor_per_m / 2),
        squares_(modes),
        gradient_(modes) {
    for (std::size_t i = 0; i < form.squares_per_m2.size(); ++i) squares_[i] = Number(form.squares_per_m2[i]);
    for (const auto& [first, second, factor] : form.products) products_.push_back({first, second, Number(factor)});
    for (std::size_t p = 0; p < P; ++p) {
      const StretchForm& direction = directions[p];
      stiffness_.slopes[p] = static_cast<T>(direction.stiffness_j);
      half_linear_.slopes[p] = static_cast<T>(direction.linear.factor_per_m / 2);
      for (std::size_t i = 0; i < (std::min)(modes, direction.squares_per_m2.size()); ++i)
        squares_[i].slopes[p] = static_cast<T>(direction.squares_per_m2[i]);
      for (std::size_t i = 0; i < (std::min)(products_.size(), direction.products.size()); ++i)
        products_[i].factor.slopes[p] = static_cast<T>(direction.products[i].factor_per_m2);
    }
  }

  /// Computes the gradient A q, with half of what is linear [1/m].
  void take(const Numbers& displacements) {
    std::ranges::transform(squares_, displacements, gradient_.begin(), std::multiplies<>());
    for (const auto& [first, second, factor] : products_) {
      gradient_[first] = gradient_[first] + factor * displacements[second];
      gradient_[second] = gradient_[second] + factor * displacements[first];
    }
    if (has_linear()) gradient_[linear_mode_] = gradient_[linear_mode_] + half_linear_;
  }
  /// As those of StretchingForm.
  [[nodiscard]] Number stretch_beside_gradient(const Numbers& displacements) const {
    return has_linear() ? half_linear_ * displacements[linear_mode_] : Number();
  }
  void stop() { stiffness_ = Number(); }

  [[nodiscard]] bool has_linear() const { return half_linear_.value != 0; }
  [[nodiscard]] std::size_t linear_mode() const { return linear_mode_; }
  /// The spring of the mode that stretches the body by itself [N/m].
  [[nodiscard]] Number spring() const { return Number(2) * stiffness_ * half_linear_ * half_linear_; }
  [[nodiscard]] const Numbers& gradient() const { return gradient_; }
  [[nodiscard]] const Number& stiffness() const { return stiffness_; }  ///< [J]

 private:
  struct Product {
    std::size_t first, second;
    Number factor;
  };

  Number stiffness_;
  std::size_t linear_mode_;
  Number half_linear_;
  Numbers squares_, gradient_;
  std::vector<Product> products_;
};

/// The motion of TwoStepMotion without a damper, with slopes. For each sample begin(), then push() for each force,
/// also those of the forms, then end().
template <std::floating_point T, std::size_t P>
class StretchingBodyTangent {
 public:
  using Number = Dual<T, P>;
  using Numbers = std::vector<Number>;

  /// modes, directions: of each mode its numbers and those of each direction. Both must be as long as the body's.
  StretchingBodyTangent(std::span<const Mode> modes, double sample_rate_hz,
                        const std::array<std::vector<Mode>, P>& directions, std::vector<FormTangent<T, P>> forms)
      : forms_(std::move(forms)),
        displacement_(modes.size()),
        change_(modes.size()),
        free_(modes.size()),
        moved_(modes.size()) {
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const ModeStep step = step_of(modes[i], sample_rate_hz);
      stiffness_.emplace_back(step.stiffness);
      loss_.emplace_back(step.loss);
      receptance_.emplace_back(step.receptance);
      decay_.emplace_back(modes[i].decay_per_s);
      travel_.emplace_back(travel_of(modes[i], sample_rate_hz));
      for (std::size_t p = 0; p < P; ++p) {
        const ModeStep tangent = step_tangent(modes[i], directions[p][i], sample_rate_hz);
        stiffness_[i].slopes[p] = static_cast<T>(tangent.stiffness);
        loss_[i].slopes[p] = static_cast<T>(tangent.loss);
        receptance_[i].slopes[p] = static_cast<T>(tangent.receptance);
        decay_[i].slopes[p] = static_cast<T>(directions[p][i].decay_per_s);
        travel_[i].slopes[p] = static_cast<T>(travel_tangent(modes[i], directions[p][i], sample_rate_hz));
      }
    }
    for (FormTangent<T, P>& form : forms_)
      if (form.has_linear()) take_spring(form);
    take();
  }

  /// ModalBank::set_motion and TwoStepMotion::take_motion.
  void set_motion(std::size_t mode, const Number& displacement_m, const Number& velocity_m_per_s) {
    pull(Number(-1), free_);  // what the bank has
    displacement_[mode] = displacement_m;
    free_[mode] = (velocity_m_per_s + decay_[mode] * displacement_m) * travel_[mode] -
                  Number(T(0.5)) * (loss_[mode] + stiffness_[mode]) * displacement_m;
    for (std::size_t i = 0; i < free_.size(); ++i)
      if (receptance_[i].value == 0) displacement_[i] = free_[i] = Number();
    take();
    pull(Number(1), free_);
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const Number back = stiffness_[i] * displacement_[i];
      const bool has_velocity = double(loss_[i].value) <= kMaxLoss;
      change_[i] = has_velocity ? (free_[i] + back) / (Number(1) - loss_[i]) : Number();
      if (!has_velocity) free_[i] = Number() - back;
    }
  }

  /// Begins a sample without forces.
  void begin() { moved_ = free_; }
  /// Adds a force [N] by the shapes of its place, which may have slopes.
  void push(const Numbers& shapes, const Number& force) {
    const Number twice = Number(2) * force;
    for (std::size_t i = 0; i < moved_.size(); ++i) moved_[i] = moved_[i] + receptance_[i] * shapes[i] * twice;
  }
  /// Change of displacement at a place over the last sample and this one [m], under the forces pushed so far.
  [[nodiscard]] Number increment(const Numbers& shapes) const {
    return product(shapes, moved_) + product(shapes, change_);
  }
  /// Ends the sample. displacements: of the model after it.
  void end(std::span<const T> displacements) {
    for (std::size_t i = 0; i < moved_.size(); ++i) {
      moved_[i].value = displacements[i] - displacement_[i].value;
      change_[i] = moved_[i];
      displacement_[i] = displacement_[i] + change_[i];
      displacement_[i].value = displacements[i];
      free_[i] = change_[i] - (loss_[i] * change_[i] + stiffness_[i] * displacement_[i]);
    }
    take();
  }

  /// Displacement at a place between two samples [m], and a sample before.
  [[nodiscard]] Number displacement(const Numbers& shapes) const { return product(shapes, displacement_); }
  [[nodiscard]] Number displacement_before(const Numbers& shapes) const {
    return displacement(shapes) - product(shapes, change_);
  }
  [[nodiscard]] const std::vector<FormTangent<T, P>>& forms() const { return forms_; }
  /// How much a form is stretched by the displacements, and was a sample before.
  [[nodiscard]] Number stretch(const FormTangent<T, P>& form) const {
    return displacement(form.gradient()) + form.stretch_beside_gradient(displacement_);
  }
  [[nodiscard]] Number stretch_before(const FormTangent<T, P>& form) const {
    return displacement_before(form.gradient()) + form.stretch_beside_gradient(displacement_);
  }

 private:
  // ModalBank::give_away_spring.
  void take_spring(FormTangent<T, P>& form) {
    const std::size_t i = form.linear_mode();
    if (!can_give_away_spring(double(stiffness_[i].value), double(receptance_[i].value))) return form.stop();
    const Number spring = receptance_[i] * form.spring();
    const Number gain = Number(1) / (Number(1) - Number(T(0.5)) * spring);
    stiffness_[i] = gain * (stiffness_[i] - Number(2) * spring);
    for (Numbers* constants : {&loss_, &receptance_}) (*constants)[i] = gain * (*constants)[i];
  }
  void take() {
    for (FormTangent<T, P>& form : forms_) form.take(displacement_);
  }
  // Adds to the increments what the forms do at the displacements, times a factor.
  void pull(const Number& factor, Numbers& increments) const {
    for (const FormTangent<T, P>& form : forms_) {
      const Number force = factor * form.stiffness() * stretch(form);
      for (std::size_t i = 0; i < increments.size(); ++i)
        increments[i] = increments[i] + receptance_[i] * form.gradient()[i] * force;
    }
  }

  std::vector<FormTangent<T, P>> forms_;
  Numbers stiffness_, loss_, receptance_, decay_, travel_;
  Numbers displacement_, change_, free_;  // q, c and d of TwoStepMotion
  Numbers moved_;                         // c of this sample
};

}  // namespace contactspline::detail
