// SPDX-License-Identifier: MIT
#include "generator/collision.hpp"

#include <algorithm>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <boost/math/special_functions/lambert_w.hpp>
#include <boost/math/special_functions/log1p.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>

#include "contactspline/contact.hpp"
#include "generator/quad.hpp"

namespace contactspline {
namespace {

namespace quadrature = boost::math::quadrature;
namespace tools = boost::math::tools;

// d - ln(1 + d), also where the two nearly cancel.
double lost_share(double d) {
  return -boost::math::log1pmx(d);
}

// The inverse: d > 0 on the way in, -1 < d < 0 on the way out. Near 0 by its series in t = sqrt(2 s), else by the
// Lambert W function, -W(-exp(-1 - s)) - 1; one Newton step mends what either leaves.
double relative_speed(double s, bool inward) {
  const double t = inward ? std::sqrt(2 * s) : -std::sqrt(2 * s);
  double d = t * (1 + t * (1.0 / 3 + t * (1.0 / 36 - t / 270)));
  if (std::abs(t) > 0.3) {
    const double z = -std::exp(-1 - s);
    if (inward)
      d = z < 0 ? -boost::math::lambert_wm1(z) - 1 : s + std::log1p(s + std::log1p(s));
    else
      d = -boost::math::lambert_w0(z) - 1;
  }
  const double step = (lost_share(d) - s) * (1 + d) / d;
  return std::isfinite(step) ? d - step : d;
}

/// Speeds of the mass at a place from which `left_j` joules are still to be stored, or have been given back.
struct Speeds {
  double in, out;

  Speeds(double left_j, double mass_kg, double loss) {
    if (loss == 0) {
      in = out = std::sqrt(2 * left_j / mass_kg);
      return;
    }
    const double s = loss * loss * left_j / mass_kg;
    in = relative_speed(s, true) / loss;
    out = -relative_speed(s, false) / loss;
  }
};

// Energy between the turning point and a place `way` before it. Close to it the difference of two energies would
// cancel; there Simpson's rule for the force is exact to rounding.
double energy_left(const LawView& law, double deepest, double total, double way) {
  if (way > 1e-4 * deepest) return std::max(0.0, total - law.energy(deepest - way));
  return way * (law.force(deepest) + 4 * law.force(deepest - way / 2) + law.force(deepest - way)) / 6;
}

// Time in and out by y = ym (1 - x^2), which takes the root from the turning point, piece by smooth piece.
double duration(const LawView& law, double deepest, double mass_kg, double loss) {
  const double total = law.energy(deepest);
  const auto time_per_x = [&](double x) {
    const Speeds speed(energy_left(law, deepest, total, deepest * x * x), mass_kg, loss);
    if (!(speed.in > 0 && speed.out > 0)) return 2 * std::sqrt(2 * mass_kg * deepest / law.force(deepest));
    return 2 * deepest * x * (1 / speed.in + 1 / speed.out);
  };
  thread_local quadrature::tanh_sinh<double> rule(8);
  double sum = 0;
  double from = 0;
  for (auto at = std::ranges::lower_bound(law.breaks, deepest); at != law.breaks.begin();) {
    const double to = std::sqrt(1 - *--at / deepest);
    if (to > from) sum += rule.integrate(time_per_x, from, to, 1e-11);
    from = to;
  }
  return sum + rule.integrate(time_per_x, from, 1.0, 1e-11);
}

}  // namespace

LawView law_view(const Potential& potential) {
  return {[&](double y) { return potential.energy(y); }, [&](double y) { return potential.force(y); },
          potential.breaks()};
}

LawView law_view(const Spline& spline) {
  LawView law{{}, {}, {}};
  const auto table = segment_table(spline);
  law.energy = [table](double y) { return potential(std::span(table), y); };
  law.force = [table](double y) { return force(std::span(table), y); };
  for (const auto& segment : spline.segments)
    if (segment.knot > 0) law.breaks.push_back(segment.knot);
  return law;
}

double compression_storing(const LawView& law, double energy_j) {
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

Collision collide(const LawView& law, double mass_kg, double speed_m_per_s, double loss_s_per_m) {
  const double d = loss_s_per_m * speed_m_per_s;
  const double kinetic = mass_kg * speed_m_per_s * speed_m_per_s / 2;
  const double stored = d == 0 ? kinetic : kinetic * lost_share(d) / (d * d / 2);
  const double deepest = compression_storing(law, stored);
  return {deepest, duration(law, deepest, mass_kg, loss_s_per_m), Speeds(stored, mass_kg, loss_s_per_m).out};
}

double loss_for_restitution(double restitution, double speed_m_per_s) {
  if (restitution == 1) return 0;
  const Quad e = restitution;
  const auto balance = [&](const Quad& d) { return Quad(log((1 + d) / (1 - e * d)) - d * (1 + e)); };
  const Quad low = (1 - e * e) / (1 + e * e * e) / 2;  // a third of the root's first term in 1 - e
  const Quad high = (1 - Quad(1e-30)) / e;
  std::uintmax_t steps = 300;
  const auto [below, above] = tools::toms748_solve(balance, low, high, tools::eps_tolerance<Quad>(100), steps);
  return Quad((below + above) / 2 / speed_m_per_s).convert_to<double>();
}

}  // namespace contactspline
