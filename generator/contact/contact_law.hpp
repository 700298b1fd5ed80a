// SPDX-License-Identifier: MIT
// Contact laws: a power law, power laws in parallel or in series, a smoothed measurement.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace contactspline {

/// V(y) = stiffness/(exponent + 1) y^(exponent + 1) and F(y) = stiffness y^exponent for y > 0, else 0.
/// stiffness > 0 [N/m^exponent], exponent > 0.
struct PowerLaw {
  double stiffness;
  double exponent;

  [[nodiscard]] double energy(double compression_m) const;  ///< V(y) [J]
  [[nodiscard]] double force(double compression_m) const;   ///< dV/dy [N]

  /// Largest compression [m] of an impact: ym = ((a + 1) m v^2 / (2 k))^(1/(a + 1)). mass > 0, speed >= 0.
  [[nodiscard]] double max_compression(double mass_kg, double speed_m_per_s) const;

  /// Contact duration [s] of an impact: T = 2 zeta ym / v, zeta = sqrt(pi) Gamma(1 + 1/(a + 1)) / Gamma(1/2 +
  /// 1/(a + 1)). mass > 0, speed > 0.
  [[nodiscard]] double contact_duration(double mass_kg, double speed_m_per_s) const;
};

/// A power law that acts beyond a compression `offset_m` >= 0: F(y) = k (y - offset)^a.
struct PowerTerm {
  PowerLaw law;
  double offset_m = 0;
};

/// Layers in parallel: all have the same compression, and their forces add up. F(y) = sum of k_i (y - d_i)^a_i.
struct PowerSum {
  std::vector<PowerTerm> terms;  ///< one or more have the offset 0

  [[nodiscard]] double energy(double compression_m) const;
  [[nodiscard]] double force(double compression_m) const;
};

/// Layers in series: all carry the same force, and their compressions add up. y(F) = sum of (F/k_i)^(1/a_i).
struct PowerSeries {
  std::vector<PowerLaw> layers;  ///< one or more layers

  [[nodiscard]] double energy(double compression_m) const;
  [[nodiscard]] double force(double compression_m) const;
};

/// A force with F(0) = 0 whose slope is linear between the knots and constant beyond the last one: F is C1 and never
/// falls, V is convex.
struct ForceCurve {
  std::vector<double> knot_m;         ///< rising from 0
  std::vector<double> slope_n_per_m;  ///< dF/dy at the knots, >= 0
  std::vector<double> force_n;        ///< values at the knots
  std::vector<double> energy_j;       ///< values at the knots

  /// Computes force and energy from knots and slopes.
  ForceCurve(std::vector<double> knots, std::vector<double> slopes);

  [[nodiscard]] double energy(double compression_m) const;
  [[nodiscard]] double force(double compression_m) const;
};

/// A contact law of any kind. It is one-sided: energy and force are 0 for y <= 0. The force never falls.
class ContactLaw {
 public:
  using Law = std::variant<PowerLaw, PowerSum, PowerSeries, ForceCurve>;

  ContactLaw(double stiffness, double exponent) : law_(PowerLaw{stiffness, exponent}) {}
  template <typename Kind>
  requires std::is_constructible_v<Law, Kind> ContactLaw(Kind law) : law_(std::move(law)) {}

  [[nodiscard]] double energy(double compression_m) const;  ///< V(y) [J]
  [[nodiscard]] double force(double compression_m) const;   ///< dV/dy [N]

  /// The power law, or null for a law of another kind.
  [[nodiscard]] const PowerLaw* power_law() const { return std::get_if<PowerLaw>(&law_); }
  [[nodiscard]] const Law& law() const { return law_; }

  /// Compressions y > 0 [m] at which the law is not smooth, in rising order, each once.
  [[nodiscard]] std::vector<double> breaks() const;

 private:
  Law law_;
};

/// The formulas of the laws in any real type: double for use, Quad for what is emitted.
namespace formulas {

template <typename Real>
Real power_energy(const PowerLaw& law, const Real& y) {
  using std::pow;
  const Real power = Real(law.exponent) + 1;
  return y > 0 ? Real(Real(law.stiffness) / power * pow(y, power)) : Real(0);
}

template <typename Real>
Real energy_of(const PowerSum& sum, const Real& y) {
  Real energy = 0;
  for (const auto& [law, offset] : sum.terms) energy += power_energy(law, Real(y - Real(offset)));
  return energy;
}

/// Compression [m] of one layer under a force > 0, and its derivative with respect to the force.
template <typename Real>
std::pair<Real, Real> layer_compression(const PowerLaw& layer, const Real& force) {
  using std::pow;
  const Real y = pow(Real(force / Real(layer.stiffness)), Real(1 / Real(layer.exponent)));
  return {y, Real(y / (Real(layer.exponent) * force))};
}

/// The force that compresses layers in series by y. Newton's method for ln y(F) over ln F, which is convex. It starts
/// at the smallest force that compresses one layer alone by y, so the force falls from step to step, until rounding
/// ends that.
template <typename Real>
Real force_of(const PowerSeries& series, const Real& y) {
  using std::exp, std::log, std::pow;
  if (!(y > 0)) return 0;
  Real force = std::numeric_limits<Real>::max();
  for (const PowerLaw& layer : series.layers)
    force = std::min<Real>(force, Real(layer.stiffness) * pow(y, Real(layer.exponent)));
  constexpr int kMaxSteps = 100;  // some ten are needed
  for (int i = 0; i < kMaxSteps && force > 0; ++i) {
    Real sum = 0, slope = 0;
    for (const PowerLaw& layer : series.layers) {
      const auto [compression, derivative] = layer_compression(layer, force);
      sum += compression;
      slope += derivative;
    }
    const Real step = log(Real(sum / y)) * sum / (slope * force);
    force *= exp(Real(-step));
    if (!(step > 4 * std::numeric_limits<Real>::epsilon())) break;
  }
  return force;
}

template <typename Real>
Real energy_of(const PowerSeries& series, const Real& y) {
  const Real force = force_of(series, y);
  if (!(force > 0)) return 0;
  Real energy = 0;
  for (const PowerLaw& layer : series.layers)
    energy += force * layer_compression(layer, force).first / (Real(layer.exponent) + 1);
  return energy;
}

// Increase of the force, and the energy that belongs to it, over a distance t from a knot. s is the slope at the
// knot, `rate` its increase per metre.
template <typename Real>
Real force_gained(const Real& s, const Real& rate, const Real& t) {
  return t * (s + rate * t / 2);
}
template <typename Real>
Real energy_gained(const Real& s, const Real& rate, const Real& t) {
  return t * t * (s / 2 + rate * t / 6);
}

/// A compression as a distance from the last knot at or below it, with the slope there and its increase per metre.
template <typename Real>
struct CurvePosition {
  std::size_t index;
  Real distance, slope, rate;

  CurvePosition(const ForceCurve& curve, const Real& y) {
    const auto& knot = curve.knot_m;
    const auto above = std::ranges::upper_bound(knot, y, std::less<>(), [](double k) { return Real(k); });
    index = static_cast<std::size_t>(above - knot.begin()) - 1;
    distance = y - Real(knot[index]);
    slope = curve.slope_n_per_m[index];
    rate = 0;
    if (index + 1 < knot.size())
      rate = (Real(curve.slope_n_per_m[index + 1]) - slope) / (Real(knot[index + 1]) - Real(knot[index]));
  }
};

}  // namespace formulas

}  // namespace contactspline
