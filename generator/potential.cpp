// SPDX-License-Identifier: MIT
#include "generator/potential.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/collision.hpp"
#include "generator/potential_quad.hpp"

namespace contactspline {
namespace {

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

// Force and energy gained over a way t from a knot with slope s that grows by `rate` per metre.
template <typename Real>
Real force_gained(const Real& s, const Real& rate, const Real& t) {
  return t * (s + rate * t / 2);
}
template <typename Real>
Real energy_gained(const Real& s, const Real& rate, const Real& t) {
  return t * t * (s / 2 + rate * t / 6);
}

/// Where a compression lies on a curve: beyond knot `index`, by `beyond`.
template <typename Real>
struct Place {
  std::size_t index;
  Real beyond, slope, rate;

  Place(const ForceCurve& curve, const Real& y) {
    const auto& knot = curve.knot_m;
    const auto above = std::ranges::upper_bound(knot, y, std::less<>(), [](double k) { return Real(k); });
    index = static_cast<std::size_t>(above - knot.begin()) - 1;
    beyond = y - Real(knot[index]);
    slope = curve.slope_n_per_m[index];
    rate = 0;
    if (index + 1 < knot.size())
      rate = (Real(curve.slope_n_per_m[index + 1]) - slope) / (Real(knot[index + 1]) - Real(knot[index]));
  }
};

// The knots' energies are added up anew: those of the curve are rounded.
Quad exact_energy(const ForceCurve& curve, const Quad& y) {
  if (!(y > 0)) return 0;
  Quad force = 0, energy = 0;
  const Place<Quad> place(curve, y);
  for (std::size_t j = 0; j < place.index; ++j) {
    const Place<Quad> here(curve, Quad(curve.knot_m[j]));
    const Quad width = Quad(curve.knot_m[j + 1]) - curve.knot_m[j];
    energy += force * width + energy_gained<Quad>(here.slope, here.rate, width);
    force += force_gained<Quad>(here.slope, here.rate, width);
  }
  return energy + force * place.beyond + energy_gained<Quad>(place.slope, place.rate, place.beyond);
}

}  // namespace

double PowerLaw::energy(double compression_m) const {
  return compression_m > 0 ? stiffness / (exponent + 1) * std::pow(compression_m, exponent + 1) : 0.0;
}

double PowerLaw::force(double compression_m) const {
  return compression_m > 0 ? stiffness * std::pow(compression_m, exponent) : 0.0;
}

double PowerLaw::max_compression(double mass_kg, double speed_m_per_s) const {
  const double energy_j = mass_kg * speed_m_per_s * speed_m_per_s / 2;
  return std::pow((exponent + 1) * energy_j / stiffness, 1 / (exponent + 1));
}

double PowerLaw::contact_duration(double mass_kg, double speed_m_per_s) const {
  const double root = 1 / (exponent + 1);
  const double zeta = std::sqrt(std::numbers::pi) * std::tgamma(1 + root) / std::tgamma(0.5 + root);
  return 2 * zeta * max_compression(mass_kg, speed_m_per_s) / speed_m_per_s;
}

double PowerSum::energy(double compression_m) const {
  return energy_of(*this, compression_m);
}

double PowerSum::force(double compression_m) const {
  double force = 0;
  for (const auto& [law, offset] : terms) force += law.force(compression_m - offset);
  return force;
}

ForceCurve::ForceCurve(std::vector<double> knots, std::vector<double> slopes)
    : knot_m(std::move(knots)), slope_n_per_m(std::move(slopes)), force_n{0}, energy_j{0} {
  for (std::size_t j = 0; j + 1 < knot_m.size(); ++j) {
    const double width = knot_m[j + 1] - knot_m[j];
    const double rate = (slope_n_per_m[j + 1] - slope_n_per_m[j]) / width;
    energy_j.push_back(energy_j[j] + force_n[j] * width + energy_gained(slope_n_per_m[j], rate, width));
    force_n.push_back(force_n[j] + force_gained(slope_n_per_m[j], rate, width));
  }
}

double ForceCurve::energy(double compression_m) const {
  if (!(compression_m > 0)) return 0;
  const Place<double> p(*this, compression_m);
  return energy_j[p.index] + force_n[p.index] * p.beyond + energy_gained(p.slope, p.rate, p.beyond);
}

double ForceCurve::force(double compression_m) const {
  if (!(compression_m > 0)) return 0;
  const Place<double> p(*this, compression_m);
  return force_n[p.index] + force_gained(p.slope, p.rate, p.beyond);
}

double Potential::energy(double compression_m) const {
  return std::visit([=](const auto& law) { return law.energy(compression_m); }, law_);
}

double Potential::force(double compression_m) const {
  return std::visit([=](const auto& law) { return law.force(compression_m); }, law_);
}

double Potential::max_compression(double mass_kg, double speed_m_per_s) const {
  if (const PowerLaw* law = power_law()) return law->max_compression(mass_kg, speed_m_per_s);
  return compression_storing(law_view(*this), mass_kg * speed_m_per_s * speed_m_per_s / 2);
}

double Potential::contact_duration(double mass_kg, double speed_m_per_s) const {
  if (const PowerLaw* law = power_law()) return law->contact_duration(mass_kg, speed_m_per_s);
  return collide(law_view(*this), mass_kg, speed_m_per_s, 0).contact_duration_s;
}

std::vector<double> Potential::breaks() const {
  std::vector<double> breaks;
  if (const auto* sum = std::get_if<PowerSum>(&law_))
    for (const PowerTerm& term : sum->terms) breaks.push_back(term.offset_m);
  if (const auto* curve = std::get_if<ForceCurve>(&law_)) breaks = curve->knot_m;
  std::ranges::sort(breaks);
  breaks.erase(std::ranges::unique(breaks).begin(), breaks.end());
  std::erase_if(breaks, [](double y) { return !(y > 0); });
  return breaks;
}

Quad exact_energy(const Potential& potential, const Quad& compression_m) {
  if (const auto* curve = std::get_if<ForceCurve>(&potential.law())) return exact_energy(*curve, compression_m);
  if (const auto* sum = std::get_if<PowerSum>(&potential.law())) return energy_of(*sum, compression_m);
  return power_energy(*potential.power_law(), compression_m);
}

Quad exact_max_compression(const Potential& potential, const Quad& energy_j) {
  if (const PowerLaw* law = potential.power_law()) {
    const Quad power = Quad(law->exponent) + 1;
    return pow(Quad(power * energy_j / law->stiffness), 1 / power);
  }
  Quad compression = compression_storing(law_view(potential), energy_j.convert_to<double>());
  for (int i = 0; i < 4; ++i)  // Newton's method; the slope is only as good as double, so each step gains 15 digits
    compression -=
        (exact_energy(potential, compression) - energy_j) / potential.force(compression.convert_to<double>());
  return compression;
}

}  // namespace contactspline
