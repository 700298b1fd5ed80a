// SPDX-License-Identifier: MIT
// The impact of a mass on a rigid wall, integrated in any real type: with dual numbers its derivatives with respect
// to all parameters come along.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

namespace contactspline {

/// f = F (g (1 + loss v) - weight m), at least 0, with g = u^exponent + core (u - depth)^1.5, u = y/reference, each
/// term where its base is positive, and time dm/dt = g - m: a power law over a hard core, with the viscous loss of
/// Hunt and Crossley (1975) and the memory of Stulov (1995). weight 0: no memory; core 0: the power law alone.
template <typename Real>
struct ViscoelasticLaw {
  Real log_force;  ///< ln of F [N], the force at the reference compression
  Real exponent, loss_s_per_m, weight, time_s;
  double reference_m;
  Real core = Real(0.0), depth = Real(0.0);
};

/// What is measured of a whole impact.
template <typename Real>
struct ImpactMeasures {
  Real duration_s, max_force_n, restitution, max_compression_m;
};

namespace impact_model {

inline double number(double value) {
  return value;
}
template <typename Dual>
requires requires(const Dual& value) {
  value.value;
}
double number(const Dual& value) {
  return value.value;
}

/// g of the law at a compression.
template <typename Real>
Real shape(const ViscoelasticLaw<Real>& law, const Real& y) {
  using std::exp, std::log, std::sqrt;
  if (!(number(y) > 0)) return Real(0.0);
  Real g = exp(law.exponent * log(y / law.reference_m));
  const Real beyond = y / law.reference_m - law.depth;
  if (number(law.core) > 0 && number(beyond) > 0) g += law.core * beyond * sqrt(beyond);
  return g;
}

/// The energy that it takes to compress a law without loss and memory so far [J].
inline double energy(const ViscoelasticLaw<double>& law, double y) {
  const double u = y / law.reference_m, beyond = std::max(0.0, u - law.depth);
  const double sum = std::pow(u, law.exponent + 1) / (law.exponent + 1) + law.core * std::pow(beyond, 2.5) / 2.5;
  return std::exp(law.log_force) * law.reference_m * sum;
}

template <typename Real>
struct State {
  Real y, v, m;
};

// a + h b
template <typename Real>
State<Real> moved(const State<Real>& a, const State<Real>& b, double h) {
  return {a.y + h * b.y, a.v + h * b.v, a.m + h * b.m};
}

/// The cubic through values and slopes at the ends of a step.
template <typename Real>
struct Cubic {
  Real value, slope, square, cube;

  Cubic(const Real& a, const Real& slope_a, const Real& b, const Real& slope_b, double h) : value(a), slope(slope_a) {
    const Real mean = (b - a) / h;
    square = (3.0 * mean - 2.0 * slope_a - slope_b) / h;
    cube = (slope_a + slope_b - 2.0 * mean) / (h * h);
  }
  [[nodiscard]] Real at(const Real& t) const { return value + t * (slope + t * (square + t * cube)); }
  [[nodiscard]] Real slope_at(const Real& t) const { return slope + t * (2.0 * square + 3.0 * t * cube); }
};

template <typename Real>
class Impact {
 public:
  Impact(const ViscoelasticLaw<Real>& law, double mass_kg)
      : law_(law), mass_kg_(mass_kg), force_(exp_of(law.log_force)) {}

  [[nodiscard]] bool remembers() const { return number(law_.weight) > 0; }

  [[nodiscard]] Real force(const State<Real>& s) const { return force(s, shape(law_, s.y)); }

  /// Positive in contact, 0 at its end.
  [[nodiscard]] Real touch(const State<Real>& s) const {
    return remembers() ? Real(shape(law_, s.y) - law_.weight * s.m) : s.y;
  }

  [[nodiscard]] State<Real> rate(const State<Real>& s) const {
    const Real g = shape(law_, s.y);
    return {s.v, -force(s, g) / mass_kg_, remembers() ? Real((g - s.m) / law_.time_s) : Real(0.0)};
  }

  [[nodiscard]] State<Real> step(const State<Real>& s, double h) const { return step(s, rate(s), h); }

  /// The same if the rate is known.
  [[nodiscard]] State<Real> step(const State<Real>& s, const State<Real>& k1, double h) const {
    const auto k2 = rate(moved(s, k1, h / 2)), k3 = rate(moved(s, k2, h / 2)), k4 = rate(moved(s, k3, h));
    const auto sum = [&](const Real& a, const Real& b, const Real& c, const Real& d) {
      return Real((a + 2.0 * (b + c) + d) / 6.0);
    };
    return moved(s, {sum(k1.y, k2.y, k3.y, k4.y), sum(k1.v, k2.v, k3.v, k4.v), sum(k1.m, k2.m, k3.m, k4.m)}, h);
  }

  /// A hundredth of the contact, and no longer than the memory: the Runge-Kutta method of order 4 is then right to
  /// 1e-6.
  [[nodiscard]] double longest_step(double speed) const {
    const double a = number(law_.exponent), force = number(force_);
    const double ym =
        law_.reference_m * std::pow((a + 1) * mass_kg_ * speed * speed / (2 * force * law_.reference_m), 1 / (a + 1));
    const double step = 3 * ym / speed / kSteps;
    return remembers() ? std::min(step, 1.5 * number(law_.time_s)) : step;
  }

 private:
  static constexpr double kSteps = 100;

  static Real exp_of(const Real& x) {
    using std::exp;
    return exp(x);
  }

  // g: of the law at this compression.
  [[nodiscard]] Real force(const State<Real>& s, const Real& g) const {
    const Real viscous = g * (1.0 + law_.loss_s_per_m * s.v);
    const Real f = force_ * (remembers() ? Real(viscous - law_.weight * s.m) : viscous);
    return number(f) > 0 ? f : Real(0.0);
  }

  ViscoelasticLaw<Real> law_;
  double mass_kg_;
  Real force_;
};

inline constexpr int kMaxSteps = 50000;

}  // namespace impact_model

/// The force [N] at rising times of an impact that begins at `begin_s`: of the motion between two steps, which is a
/// cubic. False if the motion cannot be computed.
template <typename Real>
[[nodiscard]] bool pulse_force(const ViscoelasticLaw<Real>& law, double mass_kg, const Real& speed,
                               const Real& begin_s, std::span<const double> times, std::span<Real> forces) {
  using impact_model::number;
  const impact_model::Impact<Real> impact(law, mass_kg);
  const double h = impact.longest_step(number(speed));
  impact_model::State<Real> before, rate_before, after{Real(0.0), speed, Real(0.0)}, rate = impact.rate(after);
  std::ranges::fill(forces, Real(0.0));
  std::size_t i = 0;
  while (i < times.size() && !(times[i] > number(begin_s))) ++i;
  for (int step = 0; i < times.size() && step < impact_model::kMaxSteps; ++step) {
    if (number(after.y) < 0) return true;  // it flies away, and the force stays 0
    before = after, rate_before = rate;
    after = impact.step(before, rate_before, h);
    rate = impact.rate(after);
    if (!std::isfinite(number(after.y))) return false;
    const impact_model::Cubic<Real> y(before.y, before.v, after.y, after.v, h),
        m(before.m, rate_before.m, after.m, rate.m, h);
    for (; i < times.size(); ++i) {
      const Real t = times[i] - begin_s - step * h;
      if (!(number(t) <= h)) break;
      forces[i] = impact.force({y.at(t), y.slope_at(t), m.at(t)});
    }
  }
  return i == times.size();
}

/// Duration, largest force, restitution and largest compression of an impact; nothing if it cannot be computed.
template <typename Real>
[[nodiscard]] std::optional<ImpactMeasures<Real>> measure_impact(const ViscoelasticLaw<Real>& law, double mass_kg,
                                                                 double speed) {
  using impact_model::number;
  const impact_model::Impact<Real> impact(law, mass_kg);
  const double step = impact.longest_step(speed);
  impact_model::State<Real> state{Real(0.0), Real(speed), Real(0.0)}, before = state;
  // The top of the parabola through three neighbours.
  const auto top_of = [](const Real& a, const Real& b, const Real& c) {
    return Real(b - (c - a) * (c - a) / (8.0 * (a - 2.0 * b + c)));
  };
  Real forces[3] = {Real(0.0), Real(0.0), Real(0.0)}, places[3] = {Real(0.0), Real(0.0), Real(0.0)};
  Real max_force(0.0), max_place(0.0);
  for (int i = 1; i < impact_model::kMaxSteps; ++i) {
    before = state;
    state = impact.step(before, step);
    if (!std::isfinite(number(state.y))) return std::nullopt;
    if (number(impact.touch(state)) <= 0 && number(state.v) < 0) {
      // Where touch is 0: found in the middle by halving, then once by Newton, which gives the derivatives.
      double low = 0, high = step;
      for (int n = 0; n < 40; ++n) {
        const double middle = (low + high) / 2;
        (number(impact.touch(impact.step(before, middle))) > 0 ? low : high) = middle;
      }
      const double h = (low + high) / 2, width = 1e-3 * step;
      const auto end = impact.step(before, h);
      const double slope = (number(impact.touch(impact.step(before, h + width))) -
                            number(impact.touch(impact.step(before, h - width)))) /
                           (2 * width);
      return ImpactMeasures<Real>{Real((i - 1) * step + h - impact.touch(end) / slope), max_force,
                                  Real(-end.v / speed), max_place};
    }
    const auto keep = [&](Real(&last)[3], const Real& next, Real& max) {
      last[0] = last[1], last[1] = last[2], last[2] = next;
      if (i > 1 && number(last[1]) >= number(last[0]) && number(last[1]) > number(last[2]) &&
          number(last[1]) > number(max))
        max = top_of(last[0], last[1], last[2]);
    };
    keep(forces, impact.force(state), max_force);
    keep(places, state.y, max_place);
  }
  return std::nullopt;
}

}  // namespace contactspline
