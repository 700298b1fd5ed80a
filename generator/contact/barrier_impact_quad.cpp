// SPDX-License-Identifier: MIT
// The parts of barrier_impact.hpp in 113 bits: what is emitted follows from them.
#include <boost/math/tools/roots.hpp>
#include <cstdint>

#include "generator/contact/barrier_impact.hpp"
#include "generator/contact/contact_law_quad.hpp"

namespace contactspline {

double exact_max_compression(const ContactLaw& law, double mass_kg, double speed_m_per_s) {
  const Quad energy = Quad(mass_kg) * speed_m_per_s * speed_m_per_s / 2;
  if (const PowerLaw* power = law.power_law()) {
    const Quad one_more = Quad(power->exponent) + 1;
    return pow(Quad(one_more * energy / power->stiffness), 1 / one_more).convert_to<double>();
  }
  Quad compression = compression_at_energy(law_view(law), energy.convert_to<double>());
  for (int i = 0; i < 4; ++i)  // Newton's method: the slope is good to double precision, so a step gains 15 digits
    compression -= (exact_energy(law, compression) - energy) / law.force(compression.convert_to<double>());
  return compression.convert_to<double>();
}

double loss_for_restitution(double restitution, double speed_m_per_s) {
  if (restitution == 1) return 0;
  const Quad e = restitution;
  const auto balance = [&](const Quad& d) { return Quad(log((1 + d) / (1 - e * d)) - d * (1 + e)); };
  const Quad low = (1 - e * e) / (1 + e * e * e) / 2;  // a third of the root's first term in 1 - e
  const Quad high = (1 - Quad(1e-30)) / e;
  std::uintmax_t steps = 300;
  const auto [below, above] =
      boost::math::tools::toms748_solve(balance, low, high, boost::math::tools::eps_tolerance<Quad>(100), steps);
  return Quad((below + above) / 2 / speed_m_per_s).convert_to<double>();
}

}  // namespace contactspline
