// SPDX-License-Identifier: MIT
// The energy of a bouncing mass, as this compiler and optimisation compile it. Exit 1 where it leaves its bound.
#include <cstdio>

#include "felt_c4.hpp"
#include "rubber_on_wood.hpp"
#include "runtime/bounce.hpp"
#include "steel_on_steel.hpp"

namespace contactspline::testing {
namespace {

int failures = 0;
long bounces = 0;

template <typename Material, typename T>
void check(const char* name, double mass_kg, double speed) {
  double worst = 0, worst_of_bound = 0;
  for (const double rate : {22050.0, 192000.0})
    for (const double ratio : {1.0, 1e6}) {
      const Drop drop{mass_kg, speed, ratio, rate, 5};
      const EnergyDrift drift = follow(SegmentTable<T>(segments_of<Material, T>), drop);
      const double of_bound = drift.worst / allowed_drift<T>(drop, drift);
      worst = std::max(worst, drift.worst);
      worst_of_bound = std::max(worst_of_bound, of_bound);
      bounces += drift.bounces;
      if (drift.is_finite && drift.bounces > 0 && of_bound <= 1) continue;
      std::printf("FAILED: ratio %g at %g Hz: finite %d, %ld bounces, energy off by %g, %g of its bound\n", ratio,
                  rate, drift.is_finite, drift.bounces, drift.worst, of_bound);
      ++failures;
    }
  std::printf("%s, %zu bits: energy within %.2g, %.2f of its bound\n", name, 8 * sizeof(T), worst, worst_of_bound);
}

template <typename T>
void check_all() {
  check<materials::felt_c4, T>("felt_c4", 0.00297, 6.0);
  check<materials::rubber_on_wood, T>("rubber_on_wood", 0.009, 0.5);
  check<materials::steel_on_steel, T>("steel_on_steel", 0.00411, 0.5);
}

}  // namespace
}  // namespace contactspline::testing

int main() {
  using namespace contactspline::testing;
  check_all<double>();
  check_all<float>();
  if (bounces < 100) std::printf("FAILED: missing data: %ld bounces\n", bounces);
  return failures == 0 && bounces >= 100 ? 0 : 1;
}
