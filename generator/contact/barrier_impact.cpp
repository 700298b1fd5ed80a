// SPDX-License-Identifier: MIT
#include "generator/contact/barrier_impact.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <boost/math/special_functions/lambert_w.hpp>
#include <boost/math/special_functions/log1p.hpp>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>

namespace contactspline {
namespace {

namespace quadrature = boost::math::quadrature;
namespace tools = boost::math::tools;

// d - ln(1 + d), accurate also near d = 0, where the terms cancel. For d = loss v this is the energy that the contact
// still takes up, in units of m/loss^2.
double scaled_energy(double d) {
  return -boost::math::log1pmx(d);
}

// Inverse of scaled_energy: d > 0 on the way in, -1 < d < 0 on the way out. Near 0 it uses a series in sqrt(2 s),
// elsewhere the Lambert W function: d = -W(-exp(-1 - s)) - 1. One Newton step removes the remaining error of both.
double scaled_speed(double s, bool inward) {
  const double t = inward ? std::sqrt(2 * s) : -std::sqrt(2 * s);
  double d = t * (1 + t * (1.0 / 3 + t * (1.0 / 36 - t / 270)));
  if (std::abs(t) > 0.3) {
    const double z = -std::exp(-1 - s);
    if (inward)
      d = z < 0 ? -boost::math::lambert_wm1(z) - 1 : s + std::log1p(s + std::log1p(s));
    else
      d = -boost::math::lambert_w0(z) - 1;
  }
  const double step = (scaled_energy(d) - s) * (1 + d) / d;
  return std::isfinite(step) ? d - step : d;
}

/// Speeds of the mass on the way in and on the way out, at the compression where the contact has `remaining_j` joules
/// to store before the turning point.
struct Speeds {
  double in, out;

  Speeds(double remaining_j, double mass_kg, double loss) {
    if (loss == 0) {
      in = out = std::sqrt(2 * remaining_j / mass_kg);
      return;
    }
    const double s = loss * loss * remaining_j / mass_kg;
    in = scaled_speed(s, true) / loss;
    out = -scaled_speed(s, false) / loss;
  }
};

// Energy that the contact stores at the turning point.
double stored_energy(double mass_kg, double speed, double loss) {
  const double d = loss * speed;
  const double kinetic = mass_kg * speed * speed / 2;
  return d == 0 ? kinetic : kinetic * scaled_energy(d) / (d * d / 2);
}

// Energy that the contact stores over the last `distance` metres before the turning point ym. Very close to ym the
// difference of the two energies would cancel; there Simpson's rule for the force is exact to rounding.
double remaining_energy(const LawView& law, double ym, double total, double distance) {
  if (distance > 1e-4 * ym) return std::max(0.0, total - law.energy(ym - distance));
  return distance * (law.force(ym) + 4 * law.force(ym - distance / 2) + law.force(ym - distance)) / 6;
}

// Integral of dy (1/v_in + 1/v_out). The substitution y = ym (1 - x^2) removes the singularity at the turning point
// ym; each piece between two breaks of the law is integrated on its own.
double duration(const LawView& law, double ym, double mass_kg, double loss) {
  const double total = law.energy(ym);
  const auto time_per_x = [&](double x) {
    const Speeds speed(remaining_energy(law, ym, total, ym * x * x), mass_kg, loss);
    if (!(speed.in > 0 && speed.out > 0)) return 2 * std::sqrt(2 * mass_kg * ym / law.force(ym));
    return 2 * ym * x * (1 / speed.in + 1 / speed.out);
  };
  thread_local quadrature::tanh_sinh<double> rule(8);
  // Shifted to 0: near a lower end of 0.5 or more, Boost 1.74 rounds places to that end, which its assertion forbids.
  const auto time_between = [&](double from, double to) {
    return rule.integrate([&](double x) { return time_per_x(from + x); }, 0.0, to - from, 1e-11);
  };
  double sum = 0;
  double from = 0;
  for (auto at = std::ranges::lower_bound(law.breaks, ym); at != law.breaks.begin();) {
    const double to = std::sqrt(1 - *--at / ym);
    if (to > from) sum += time_between(from, to);
    from = to;
  }
  return sum + time_between(from, 1);
}

// The largest of F(y) (1 + loss v) on the way in: the best of a grid, refined between its neighbours. In x with
// y = ym (1 - x^2) the speed is smooth up to the turning point.
double max_force(const LawView& law, double ym, double mass_kg, double loss) {
  if (loss == 0) return law.force(ym);
  constexpr int kGrid = 64;
  constexpr int kHalfOfTheBits = 26;  // more would be lost in rounding at a minimum
  const double total = law.energy(ym);
  const auto negative_force = [&](double x) {
    const Speeds speed(remaining_energy(law, ym, total, ym * x * x), mass_kg, loss);
    return -law.force(ym * (1 - x * x)) * (1 + loss * speed.in);
  };
  double best = 0, min = -law.force(ym);
  for (int i = 1; i < kGrid; ++i)
    if (const double x = static_cast<double>(i) / kGrid, value = negative_force(x); value < min) {
      min = value;
      best = x;
    }
  const auto found =
      tools::brent_find_minima(negative_force, std::max(best - 1.0 / kGrid, 0.0), best + 1.0 / kGrid, kHalfOfTheBits);
  return std::max(-found.second, -min);
}

}  // namespace

LawView law_view(const ContactLaw& law) {
  return {[&](double y) { return law.energy(y); }, [&](double y) { return law.force(y); }, law.breaks()};
}

double compression_at_energy(const LawView& law, double energy_j) {
  const auto excess = [&](double y) { return law.energy(y) - energy_j; };
  double high = 1e-6;
  while (excess(high) < 0) high *= 4;
  double low = high;
  while (excess(low) > 0) low /= 4;
  if (low == high) return high;
  std::uintmax_t steps = 200;
  const auto [below, above] = tools::toms748_solve(excess, low, high, tools::eps_tolerance<double>(), steps);
  return below + (above - below) / 2;
}

double max_compression(const ContactLaw& law, double mass_kg, double speed_m_per_s) {
  if (const PowerLaw* power = law.power_law()) return power->max_compression(mass_kg, speed_m_per_s);
  return compression_at_energy(law_view(law), mass_kg * speed_m_per_s * speed_m_per_s / 2);
}

double contact_duration(const ContactLaw& law, double mass_kg, double speed_m_per_s) {
  if (const PowerLaw* power = law.power_law()) return power->contact_duration(mass_kg, speed_m_per_s);
  return barrier_impact(law_view(law), mass_kg, speed_m_per_s, 0).contact_duration_s;
}

BarrierImpact barrier_impact(const LawView& law, double mass_kg, double speed_m_per_s, double loss_s_per_m) {
  const double stored = stored_energy(mass_kg, speed_m_per_s, loss_s_per_m);
  const double ym = compression_at_energy(law, stored);
  return {ym, duration(law, ym, mass_kg, loss_s_per_m), Speeds(stored, mass_kg, loss_s_per_m).out,
          max_force(law, ym, mass_kg, loss_s_per_m)};
}

std::vector<ImpactMoment> barrier_motion(const LawView& law, double mass_kg, double speed_m_per_s,
                                         double loss_s_per_m, int steps) {
  const double stored = stored_energy(mass_kg, speed_m_per_s, loss_s_per_m);
  const double ym = compression_at_energy(law, stored);
  const auto speeds = [&](double x) {
    return Speeds(remaining_energy(law, ym, stored, ym * x * x), mass_kg, loss_s_per_m);
  };
  // dy = 2 ym x dx: the speed falls like x towards the turning point, so the integrand stays smooth.
  const auto time_between = [&](double from, double to, double Speeds::*speed) {
    const auto time_per_x = [&](double x) { return 2 * ym * x / (speeds(x).*speed); };
    return quadrature::gauss<double, 15>::integrate(time_per_x, from, to);
  };
  const auto at = [&](int step) { return static_cast<double>(step) / steps; };
  const auto moment = [&](double time, int step, double Speeds::*speed, double sign) {
    const double x = at(step), y = ym * (1 - x * x);
    return ImpactMoment{time, y, law.force(y) * (1 + sign * loss_s_per_m * (speeds(x).*speed))};
  };
  std::vector<ImpactMoment> motion;
  double time = 0;
  for (int step = steps; step >= 0; --step) {
    motion.push_back(moment(time, step, &Speeds::in, 1));
    if (step > 0) time += time_between(at(step - 1), at(step), &Speeds::in);
  }
  for (int step = 1; step <= steps; ++step) {
    time += time_between(at(step - 1), at(step), &Speeds::out);
    motion.push_back(moment(time, step, &Speeds::out, -1));
  }
  return motion;
}

}  // namespace contactspline
