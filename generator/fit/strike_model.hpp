// SPDX-License-Identifier: MIT
// The blow of a hammer on a resonator of known modes, integrated in any real type as impact_model.hpp does it.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "generator/fit/impact_model.hpp"

namespace contactspline {

/// A mode under a hammer: q'' + 2 decay q' + (w^2 + decay^2) q = shape f/mass, and shape q is what the hammer meets.
struct StruckMode {
  double w_rad_per_s, decay_per_s, mass_kg, shape;

  [[nodiscard]] double frequency_hz() const { return w_rad_per_s / (2 * std::numbers::pi); }
};

namespace strike_model {

/// Hammer and modes from the first touch on. A mode is q = e^(-decay t) (a cos(w t) + b sin(w t)), with a and b
/// turned and damped once a step, exactly. The force acts once a step, as a blow h f: for a force that begins at 0
/// the error is of order 2 in the step.
template <typename Real>
class Strike {
 public:
  Strike(const ViscoelasticLaw<Real>& law, const Real& mass_kg, const Real& speed, std::span<const StruckMode> modes)
      : law_(law),
        force_(exp_of(law.log_force)),
        inverse_mass_(1.0 / mass_kg),
        speed_(speed),
        modes_(modes),
        a_(modes.size(), Real(0.0)),
        b_(modes.size(), Real(0.0)),
        h_(step_of(impact_model::number(mass_kg))),
        inverse_masses_(inverse_mass_) {
    for (const StruckMode& mode : modes) {
      turns_.push_back({std::exp(-mode.decay_per_s * h_) * std::cos(mode.w_rad_per_s * h_),
                        std::exp(-mode.decay_per_s * h_) * std::sin(mode.w_rad_per_s * h_),
                        mode.shape / (mode.mass_kg * mode.w_rad_per_s)});
      inverse_masses_ += mode.shape * mode.shape / mode.mass_kg;
    }
    if (remembers()) memory_decay_ = exp_of(Real(-h_ / law.time_s));
  }

  /// Until the hammer is out of reach. False if that takes too long, or the motion is not finite.
  [[nodiscard]] bool play() {
    using impact_model::number;
    constexpr int kMaxSteps = 20000, kBetween = 16;
    for (steps_ = 1; steps_ <= kMaxSteps; ++steps_) {
      fly();
      if (!std::isfinite(number(place_) + number(speed_))) return false;
      if (!push() && steps_ % kBetween == 0 && number(speed_) < 0 && number(place_) < -reach()) return true;
    }
    return false;
  }

  /// The force [N] at rising times of a blow that begins at `begin_s`, on lines between its steps.
  [[nodiscard]] bool play_pulse(const Real& begin_s, std::span<const double> times, std::span<Real> forces) {
    using impact_model::number;
    constexpr int kMaxSteps = 20000;
    std::ranges::fill(forces, Real(0.0));
    std::size_t i = 0;
    while (i < times.size() && !(times[i] > number(begin_s))) ++i;
    Real before(0.0);
    for (steps_ = 1; i < times.size(); ++steps_, before = last_force_) {
      if (steps_ > kMaxSteps) return false;
      fly();
      if (!std::isfinite(number(place_) + number(speed_))) return false;
      (void)push();
      for (; i < times.size(); ++i) {
        const Real t = (times[i] - begin_s) / h_ - (steps_ - 1.0);
        if (number(t) > 1) break;
        forces[i] = before + t * (last_force_ - before);
      }
    }
    return true;
  }

  /// ln of the amplitude of q of each mode [m], counted back to the first touch.
  [[nodiscard]] Real log_amplitude(std::size_t i) const {
    using std::log;
    return 0.5 * log(a_[i] * a_[i] + b_[i] * b_[i]) + modes_[i].decay_per_s * (h_ * steps_);
  }

  [[nodiscard]] double max_compression_m() const { return max_compression_m_; }

  /// From the first touch to the last.
  [[nodiscard]] double contact_s() const { return h_ * last_touch_; }

 private:
  struct Turn {
    double cosine, sine, per_force;
  };

  static Real exp_of(const Real& x) {
    using std::exp;
    return exp(x);
  }

  [[nodiscard]] bool remembers() const { return impact_model::number(law_.weight) > 0; }

  // A hundredth of the contact with a wall, and a twelfth of the period of the highest mode.
  [[nodiscard]] double step_of(double mass_kg) const {
    using impact_model::number;
    constexpr double kSteps = 100, kAngle = 0.5;
    const double a = number(law_.exponent), v = number(speed_), r = law_.reference_m;
    const double ym = r * std::pow((a + 1) * mass_kg * v * v / (2 * number(force_) * r), 1 / (a + 1));
    double step = 3 * ym / v / kSteps;
    for (const StruckMode& mode : modes_) step = std::min(step, kAngle / mode.w_rad_per_s);
    return remembers() ? std::min(step, number(law_.time_s)) : step;
  }

  void fly() {
    place_ += h_ * speed_;
    for (std::size_t i = 0; i < turns_.size(); ++i) {
      const auto& [cosine, sine, per_force] = turns_[i];
      const Real a = a_[i];
      a_[i] = cosine * a + sine * b_[i];
      b_[i] = cosine * b_[i] - sine * a;
    }
  }

  // Applies the force of this step to hammer and modes. Returns whether they touch.
  bool push() {
    using impact_model::number;
    Real y = place_, v = speed_;
    for (std::size_t i = 0; i < turns_.size(); ++i) {
      const auto& [w, decay, mass, shape] = modes_[i];
      y -= shape * a_[i];
      v -= (shape * w) * b_[i] - (shape * decay) * a_[i];
    }
    max_compression_m_ = std::max(max_compression_m_, number(y));
    const bool touches = number(y) > 0;
    last_force_ = Real(0.0);
    const Real shape = impact_model::shape(law_, y);
    if (remembers()) {
      memory_ = memory_decay_ * memory_ + (1.0 - memory_decay_) * 0.5 * (shape + last_shape_);
      last_shape_ = shape;
    }
    if (!touches) return false;
    last_touch_ = steps_;
    // The speed in the middle of the blow is v - (sum of inverse masses) h f/2.
    const Real f = force_ * (shape * (1.0 + law_.loss_s_per_m * v) - law_.weight * memory_) /
                   (1.0 + force_ * shape * law_.loss_s_per_m * inverse_masses_ * (h_ / 2));
    if (!(number(f) > 0)) return true;
    last_force_ = f;
    speed_ -= h_ * f * inverse_mass_;
    for (std::size_t i = 0; i < turns_.size(); ++i) b_[i] += (h_ * turns_[i].per_force) * f;
    return true;
  }

  // No displacement under the hammer is larger.
  [[nodiscard]] double reach() const {
    using impact_model::number;
    double sum = 0;
    for (std::size_t i = 0; i < turns_.size(); ++i)
      sum += std::abs(modes_[i].shape) * std::hypot(number(a_[i]), number(b_[i]));
    return sum;
  }

  ViscoelasticLaw<Real> law_;
  Real force_, inverse_mass_, speed_;
  Real place_{0.0}, memory_{0.0}, last_shape_{0.0}, memory_decay_{0.0}, last_force_{0.0};
  std::span<const StruckMode> modes_;
  std::vector<Real> a_, b_;
  double h_;
  Real inverse_masses_;
  std::vector<Turn> turns_;
  double max_compression_m_ = 0;
  int steps_ = 0, last_touch_ = 0;
};

}  // namespace strike_model

}  // namespace contactspline
