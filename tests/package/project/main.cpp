// SPDX-License-Identifier: MIT
// A mass thrown at a barrier in single precision: contact duration against the closed form of the power law.
#include <cmath>
#include <cstdio>
#include <numbers>

#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "cork.hpp"
#include "drop.hpp"

namespace {

constexpr float kRateHz = 192000;
constexpr float kMassKg = 0.004f;
constexpr float kSpeedMPerS = 2;
// Over 100 samples a contact: the midpoint rule is within (pi/100)^2/12 = 0.008 %, the splines within 0.02 % at this
// speed. A stiffness wrong by 0.2 % would change the duration by 0.06 %.
constexpr double kBound = 5e-4;

/// T = 2 sqrt(pi) Gamma(1 + 1/(a+1)) / Gamma(1/2 + 1/(a+1)) ym / v with ym = ((a+1) m v^2 / (2k))^(1/(a+1)), in s.
template <typename Material>
double exact_duration_s() {
  const double power = Material::exponent + 1;
  const double energy_j = kMassKg * kSpeedMPerS * kSpeedMPerS / 2;
  const double depth_m = std::pow(power * energy_j / Material::stiffness_n_per_m_alpha, 1 / power);
  return 2 * std::sqrt(std::numbers::pi) * std::tgamma(1 + 1 / power) / std::tgamma(0.5 + 1 / power) * depth_m /
         kSpeedMPerS;
}

/// From the barrier to the barrier, the free motion before and after drawn back to it, in s.
template <typename Material>
double simulated_duration_s() {
  constexpr auto& table = contactspline::segments_of<Material, float>;
  contactspline::MassBarrier<float, table.size()> mass(table, kRateHz);
  mass.throw_from(-0.5f * kSpeedMPerS / kRateHz, kSpeedMPerS);
  int samples = 0;
  for (; samples == 0 || mass.displacement() > 0; ++samples) mass.tick({.mass_kg = kMassKg});
  return (samples - 0.5) / kRateHz - mass.displacement() / mass.velocity();
}

/// The part of a sample, in which a displacement moves evenly, that it is beyond a limit.
double fraction(double before, double now, double limit) {
  const double crossing = (limit - before) / (now - before);
  return now > before ? 1 - crossing : crossing;
}

/// The same from an instrument file: from the floor to the floor.
double simulated_drop_s() {
  constexpr double kFloor = 0.001;
  contactspline::instruments::drop<double> drop(kRateHz);
  drop.strike_mass(kSpeedMPerS);
  double inside = 0, before = 0;
  for (bool has_met = false; !has_met || drop.mass_displacement_m() > kFloor;) {
    before = drop.mass_displacement_m();
    drop.tick();
    const double now = drop.mass_displacement_m();
    has_met = has_met || now > kFloor;
    inside += now > kFloor && before > kFloor   ? 1
              : now > kFloor || before > kFloor ? fraction(before, now, kFloor)
                                                : 0;
  }
  return inside / kRateHz;
}

bool lasts_as_long_as_the_closed_form(const char* name, double exact, double simulated) {
  const double error = simulated / exact - 1;
  std::printf("%s: contact lasts %.4f ms, closed form %.4f ms, error %.4f %%, allowed %.4f %%\n", name,
              1e3 * simulated, 1e3 * exact, 100 * error, 100 * kBound);
  return std::abs(error) <= kBound;
}

}  // namespace

int main() {
  using namespace contactspline::materials;
  const bool shipped = lasts_as_long_as_the_closed_form("felt_c4, which ships", exact_duration_s<felt_c4>(),
                                                        simulated_duration_s<felt_c4>());
  const bool own = lasts_as_long_as_the_closed_form("cork, the project's own", exact_duration_s<cork>(),
                                                    simulated_duration_s<cork>());
  const bool instrument =
      lasts_as_long_as_the_closed_form("cork in an instrument", exact_duration_s<cork>(), simulated_drop_s());
  return shipped && own && instrument ? 0 : 1;
}
