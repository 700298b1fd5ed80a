// SPDX-License-Identifier: MIT
#include "generator/contact/contact_law_quad.hpp"

#include <variant>

namespace contactspline {
namespace {

using namespace formulas;

// The forces and energies stored in the curve are rounded, so this sums them again from the first knot.
Quad energy_of(const ForceCurve& curve, const Quad& y) {
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

Quad energy_of(const PowerLaw& law, const Quad& y) {
  return power_energy(law, y);
}

}  // namespace

Quad exact_energy(const ContactLaw& law, const Quad& compression_m) {
  return std::visit([&](const auto& kind) { return energy_of(kind, compression_m); }, law.law());
}

}  // namespace contactspline
