// SPDX-License-Identifier: MIT
#include "generator/contact/contact_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace contactspline {

using namespace formulas;

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

double PowerSeries::energy(double compression_m) const {
  return energy_of(*this, compression_m);
}

double PowerSeries::force(double compression_m) const {
  return force_of(*this, compression_m);
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
  const CurvePosition<double> p(*this, compression_m);
  return energy_j[p.index] + force_n[p.index] * p.distance + energy_gained(p.slope, p.rate, p.distance);
}

double ForceCurve::force(double compression_m) const {
  if (!(compression_m > 0)) return 0;
  const CurvePosition<double> p(*this, compression_m);
  return force_n[p.index] + force_gained(p.slope, p.rate, p.distance);
}

double ContactLaw::energy(double compression_m) const {
  return std::visit([=](const auto& law) { return law.energy(compression_m); }, law_);
}

double ContactLaw::force(double compression_m) const {
  return std::visit([=](const auto& law) { return law.force(compression_m); }, law_);
}

std::vector<double> ContactLaw::breaks() const {
  std::vector<double> breaks;
  if (const auto* sum = std::get_if<PowerSum>(&law_))
    for (const PowerTerm& term : sum->terms) breaks.push_back(term.offset_m);
  if (const auto* curve = std::get_if<ForceCurve>(&law_)) breaks = curve->knot_m;
  std::ranges::sort(breaks);
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  std::erase_if(breaks, [](double y) { return !(y > 0); });
  return breaks;
}

}  // namespace contactspline
