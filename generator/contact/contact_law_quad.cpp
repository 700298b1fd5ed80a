// SPDX-License-Identifier: MIT
#include "generator/contact/contact_law_quad.hpp"

namespace contactspline {
namespace {

using namespace formulas;

// The forces and energies stored in the curve are rounded, so this sums them again from the first knot.
Quad exact_energy(const ForceCurve& curve, const Quad& y) {
  if (!(y > 0)) return 0;
  Quad force = 0, energy = 0;
  const CurvePosition<Quad> place(curve, y);
  for (std::size_t j = 0; j < place.index; ++j) {
    const CurvePosition<Quad> here(curve, Quad(curve.knot_m[j]));
    const Quad width = Quad(curve.knot_m[j + 1]) - curve.knot_m[j];
    energy += force * width + energy_gained<Quad>(here.slope, here.rate, width);
    force += force_gained<Quad>(here.slope, here.rate, width);
  }
  return energy + force * place.distance + energy_gained<Quad>(place.slope, place.rate, place.distance);
}

}  // namespace

Quad exact_energy(const ContactLaw& law, const Quad& compression_m) {
  if (const auto* curve = std::get_if<ForceCurve>(&law.law())) return exact_energy(*curve, compression_m);
  if (const auto* sum = std::get_if<PowerSum>(&law.law())) return energy_of(*sum, compression_m);
  if (const auto* series = std::get_if<PowerSeries>(&law.law())) return energy_of(*series, compression_m);
  return power_energy(*law.power_law(), compression_m);
}

}  // namespace contactspline
