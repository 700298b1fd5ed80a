// SPDX-License-Identifier: MIT
// The friction step: one sample of two surfaces that rub on each other, solved in closed form.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>

#include "contactspline/step/controls.hpp"

namespace contactspline {

/// What joins two surfaces that are pressed together and yields where they slip: shear of rosin, skin or of the
/// surfaces themselves. Both constants are per newton of the normal force.
struct Bristles {
  double stiffness_per_m;      ///< sigma0 > 0: a normal force N makes them N sigma0 stiff [1/m]
  double damping_s_per_m = 0;  ///< sigma1 >= 0: their strain moves against a resistance N sigma1 [s/m]
};

/// How the surfaces are pressed together over a sample. Held to ControlRanges.
template <std::floating_point T>
struct FrictionControls {
  T normal_force_n = 0;
  T coefficient = 0;  ///< mu: they yield at the force mu N
};

/// The result of a friction step.
template <std::floating_point T>
struct FrictionStep {
  T force;      ///< over the sample, against the motion of the surfaces along each other [N]
  T increment;  ///< x, of this motion over the sample [m]
  T strain;     ///< of the bristles at its end [m]
  T slip;       ///< by how much the bristles slipped [m], >= 0
};

namespace detail {

/// Force of a connection over a sample and its slope, as functions of the increment.
template <std::floating_point T>
struct ForceAndSlope {
  T force, slope;
};

/// Bristles over one sample: stiffness k, strain z and the strain L at which they yield. With W(u) = k u^2/2 up to
/// |u| = L and k (L |u| - L^2/2) beyond, the force over an increment x is
///
///     f(x) = [W(z + x) - W(z)]/x + rho (z' - z),    z' = z + x, held between -L and L
///
/// It never falls with x, and f x = change of k z^2/2 + k L slip + rho (z' - z) x.
template <std::floating_point T>
struct BristleLaw {
  T stiffness = 0;   ///< k [N/m]
  T resistance = 0;  ///< rho, viscous force per metre of strain [N/m]
  T yield = 0;       ///< L [m]
  T strain = 0;      ///< z at the beginning of the sample [m], -L to L

  [[nodiscard]] constexpr T slope() const { return stiffness / 2 + resistance; }  ///< of the force until they yield
  [[nodiscard]] constexpr T force_at_rest() const { return stiffness * strain; }  ///< for x = 0 [N]
  [[nodiscard]] constexpr bool holds(T x) const { return std::abs(strain + x) <= yield; }

  /// Force of an increment x [N] and its slope.
  [[nodiscard, gnu::always_inline]] constexpr ForceAndSlope<T> at(T x) const {
    if (holds(x)) return {force_at_rest() + slope() * x, slope()};
    const Yielding end(*this, x);
    const T part = end.held_part(std::abs(x));
    return {end.sign * end.force_at(part), stiffness / 2 * part * part};
  }
  /// The step with an increment x and its force, whatever that is.
  [[nodiscard]] constexpr FrictionStep<T> end_of(T x, T force) const {
    if (holds(x)) return {force, x, strain + x, 0};
    const Yielding end(*this, x);
    return {force, x, end.sign * yield, (std::max)(T(0), std::abs(x) - end.distance)};
  }

  /// Solves x = xf - xi f(x): a linear equation while the bristles hold, a quadratic one where they yield.
  [[nodiscard, gnu::always_inline]] constexpr FrictionStep<T> step(T xf, T xi) const {
    const T divisor = 1 + xi * slope(), x = (xf - xi * force_at_rest()) / divisor;
    if (holds(x)) return {(force_at_rest() + slope() * xf) / divisor, x, strain + x, 0};
    const Yielding end(*this, x);
    const T increment = end.increment(end.sign * xf, xi);
    return {end.sign * end.force_at(end.held_part(increment)), end.sign * increment, end.sign * yield,
            increment - end.distance};
  }

  /// Energy that the bristles store [J].
  [[nodiscard]] double energy(T at_strain) const {
    return double(stiffness) / 2 * double(at_strain) * double(at_strain);
  }
  /// Energy that slip and damping turn into heat in a step [J].
  [[nodiscard]] double heat(const FrictionStep<T>& step) const {
    return double(stiffness) * double(yield) * double(step.slip) +
           double(resistance) * (double(step.strain) - double(strain)) * double(step.increment);
  }

 private:
  /// The law beyond the end at which the bristles yield, in the direction of the motion. There
  /// f = limit - k distance^2/(2 |x|).
  struct Yielding {
    T sign, distance, limit, stiffness;

    constexpr Yielding(const BristleLaw& law, T x)
        : sign(law.strain + x < 0 ? T(-1) : T(1)),
          distance((std::max)(T(0), law.yield - sign * law.strain)),
          limit(law.stiffness * law.yield + law.resistance * distance),
          stiffness(law.stiffness) {}

    /// What of |x| the bristles hold, 0 to 1.
    [[nodiscard]] constexpr T held_part(T x) const { return distance < x ? distance / x : T(distance > 0); }
    [[nodiscard]] constexpr T force_at(T part) const { return limit - stiffness / 2 * distance * part; }

    /// The root of x^2 - (xf - xi limit) x - xi k distance^2/2 beyond the end.
    [[nodiscard]] constexpr T increment(T xf, T xi) const {
      const T p = xf - xi * limit, product = xi * stiffness * distance * distance;
      const T root = std::sqrt(p * p + 2 * product);
      return (std::max)(distance, p >= 0 ? (p + root) / 2 : product / (root - p));
    }
  };
};

}  // namespace detail

/// Friction at one point. Its force over a sample solves x = xf - xi f, as that of contact_step does, in closed form
/// and for any normal force, stiffness and rate. The energy of the surfaces never rises by themselves: what they do
/// not store is heat. Normal force and coefficient may jump between any two samples.
template <std::floating_point T>
class Friction {
 public:
  constexpr Friction() = default;
  constexpr Friction(const Bristles& bristles, double sample_rate_hz)
      : stiffness_per_m_(static_cast<T>(bristles.stiffness_per_m)),
        damping_(static_cast<T>(bristles.damping_s_per_m * sample_rate_hz)) {}

  /// Begins a sample. Bristles that a rising normal force adds are not strained, so the force stays; those that a
  /// falling one takes away, and those that yield to a falling coefficient, lose their energy.
  constexpr void press(const FrictionControls<T>& controls) {
    const T normal = held(normal_force_, controls.normal_force_n, ControlRanges<T>::normal_force_n);
    coefficient_ = held(coefficient_, controls.coefficient, ControlRanges<T>::friction_coefficient);
    const double before = energy();
    if (normal > normal_force_) strain_ *= normal_force_ / normal;
    normal_force_ = normal;
    strain_ = std::clamp(strain_, -yield(), yield());
    heat_ = before - energy();
  }

  /// The law of the sample that has begun.
  [[nodiscard]] constexpr detail::BristleLaw<T> law() const {
    return {normal_force_ * stiffness_per_m_, normal_force_ * damping_, yield(), strain_};
  }

  /// Ends a sample by a step of law().
  constexpr void advance(const FrictionStep<T>& step) {
    slip_heat_ = law().heat(step);
    heat_ += slip_heat_;
    strain_ = step.strain;
  }

  /// One sample. free_increment: xf, motion of the surfaces along each other over the sample without friction, that
  /// of a place that moves by itself included [m]. receptance: xi > 0 [m/N].
  constexpr FrictionStep<T> tick(const FrictionControls<T>& controls, T free_increment, T receptance) {
    press(controls);
    const FrictionStep<T> step = law().step(free_increment, receptance);
    advance(step);
    return step;
  }

  constexpr void reset() { strain_ = 0, heat_ = slip_heat_ = 0; }

  [[nodiscard]] constexpr T normal_force() const { return normal_force_; }  ///< that acts [N]
  [[nodiscard]] constexpr T strain() const { return strain_; }              ///< of the bristles [m]
  [[nodiscard]] double energy() const { return law().energy(strain_); }     ///< that they store [J]
  [[nodiscard]] double heat() const { return heat_; }                       ///< of the last sample [J]
  [[nodiscard]] double slip_heat() const { return slip_heat_; }             ///< of this, what slip and damping gave

 private:
  [[nodiscard]] constexpr T yield() const { return stiffness_per_m_ > 0 ? coefficient_ / stiffness_per_m_ : T(0); }

  T stiffness_per_m_ = 0, damping_ = 0;  // the latter for increments in place of velocities [1/m]
  T normal_force_ = 0, coefficient_ = 0, strain_ = 0;
  double heat_ = 0, slip_heat_ = 0;
};

}  // namespace contactspline
