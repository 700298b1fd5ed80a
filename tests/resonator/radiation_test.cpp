// SPDX-License-Identifier: MIT
// What the modes of plates and membranes weigh at listening places, against closed forms far away.
#include "generator/resonator/radiation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <vector>

#include "generator/resonator/ribbed_plate.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

constexpr double kRate = 44100;

const Plate kPlate{0.3, 0.2, 0.002, 450, 1e10, 1e10, 3.85e9, 0.3, {0, 0}};
const Membrane kHead{0.1, 0.4, 1500, {0, 0}};

Resonator of(const decltype(Resonator::body)& body) {
  return {.name = "body", .description = "", .body = body, .strike = {}, .pickup = {}, .max_modes = 12};
}

// Pressure of each mode per displacement [Pa/m], without loss: what velocity and displacement weigh, in quadrature.
std::vector<double> pressures(const Resonator& body, std::span<const NumberedMode> modes,
                              const ListeningPlace& place) {
  const Radiation radiation =
      radiation_of(body, modes, place, radiation_timing(reach_of(body.body, place).nearest_m, kRate), {});
  std::vector<double> pressures;
  for (std::size_t m = 0; m < modes.size(); ++m)
    pressures.push_back(std::hypot(radiation.of_displacement[m],
                                   modes[m].mode.angular_frequency_rad_per_s * radiation.of_velocity[m]));
  return pressures;
}

// The integral of sin(i pi x/L) exp(j k x) over 0 to L.
Complex along_side(int i, double length, double k) {
  const double a = i * pi / length;
  return a * (1.0 - std::polar(i % 2 == 0 ? 1.0 : -1.0, k * length)) / (a * a - k * k);
}

// Far away R is the distance less the part along the direction: w^2 rho/(2 pi R) times the product of two integrals
// (C. E. Wallace, JASA 51, 1972). What that leaves out is k a^2/(2 R) of the phase, a^2 = 0.18^2 from the middle to a
// corner, and a/R of 1/R, odd about the middle: below 0.8 % each at 20 m and 1.5 kHz. Values below a tenth of the
// largest, near a zero of the directivity, are not looked at.
TEST(Radiation, OfARectangularModeFarAwayIsTheClosedForm) {
  const Resonator body = of(kPlate);
  const auto modes = numbered_modes_of(body, 1500).modes;
  ASSERT_GT(modes.size(), 6u);
  std::size_t compared = 0;
  for (const double angle : {0.0, 0.5, -1.2})
    for (const double around : {0.0, 0.7, 2.9}) {
      const ListeningPlace place{.distance_m = 20, .angle_rad = angle, .around_rad = around};
      const auto found = pressures(body, modes, place);
      for (std::size_t m = 0; m < modes.size(); ++m) {
        const double w = modes[m].mode.angular_frequency_rad_per_s, k = w / 343 * std::sin(angle);
        const double expected = w * w * 1.2 / (2 * pi * 20) *
                                std::abs(along_side(modes[m].row, 0.3, k * std::cos(around)) *
                                         along_side(modes[m].number, 0.2, k * std::sin(around)));
        const double largest = w * w * 1.2 / (2 * pi * 20) * 4 * 0.06 / (pi * pi * modes[m].row * modes[m].number);
        if (expected < largest / 10) continue;
        EXPECT_TRUE(relatively_within(found[m], expected, 0.016)) << modes[m].row << ' ' << modes[m].number;
        ++compared;
      }
    }
  EXPECT_GT(compared, 40u);
}

// With a rib the same for the sum of the sines of each mode.
TEST(Radiation, OfARibbedPlateFarAwayIsTheSumOfItsSines) {
  Plate plate = kPlate;
  plate.ribbed = std::make_shared<const RibbedPlate>(plate, std::vector<Rib>{{0.05, 0.03, 0.25, 0.16, 0.02, 0.9}});
  const Resonator body = of(plate);
  const auto modes = numbered_modes_of(body, 1500).modes;
  ASSERT_GT(modes.size(), 6u);
  std::size_t compared = 0;
  for (const double angle : {0.0, 0.5, -1.2}) {
    const ListeningPlace place{.distance_m = 20, .angle_rad = angle, .around_rad = 0.7};
    const auto found = pressures(body, modes, place);
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const double w = modes[m].mode.angular_frequency_rad_per_s, k = w / 343 * std::sin(angle);
      const RibbedModes& ribbed = plate.ribbed->modes();
      Complex sum = 0;
      double largest = 0;
      for (std::size_t i = 0; i < ribbed.sines.size(); ++i) {
        const auto [along, across] = ribbed.sines[i];
        const double weight = ribbed.weights[static_cast<std::size_t>(modes[m].number)][i];
        sum += weight * along_side(along, 0.3, k * std::cos(0.7)) * along_side(across, 0.2, k * std::sin(0.7));
        largest = std::max(largest, std::abs(weight) * 4 * 0.06 / (pi * pi * along * across));
      }
      const double scale = w * w * 1.2 / (2 * pi * 20);
      if (std::abs(sum) < largest / 10) continue;
      EXPECT_TRUE(relatively_within(found[m], scale * std::abs(sum), 0.016)) << m;
      ++compared;
    }
  }
  EXPECT_GT(compared, 12u);
}

// The modes J_0 of a membrane on its axis, by the volume that they displace: 2 pi R^2 J_1(j)/j.
TEST(Radiation, OfRingsFarAwayIsTheirVolume) {
  const Resonator body = of(kHead);
  const auto modes = numbered_modes_of(body, 1500).modes;
  const auto found = pressures(body, modes, {.distance_m = 20});
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const double w = modes[m].mode.angular_frequency_rad_per_s, j = modes[m].wavenumber_per_m * 0.1;
    const double expected = w * w * 1.2 / (2 * pi * 20) * 2 * pi * 0.01 * std::abs(std::cyl_bessel_j(1, j)) / j;
    // k a^2/(2 R) = 0.7 %
    if (modes[m].row == 0)
      EXPECT_TRUE(relatively_within(found[m], expected, 0.007));
    else
      EXPECT_LT(found[m], 1e-9) << "a mode that is odd around the axis";
  }
}

// 1/R: half for twice the distance. From 5 m on a^2/R^2 is below 1e-3.
TEST(Radiation, FallsBySixDecibelsForEachDoublingFarAway) {
  for (const Resonator& body : {of(kPlate), of(kHead)}) {
    const auto modes = numbered_modes_of(body, 1500).modes;
    const auto at = [&](double distance_m) { return pressures(body, modes, {.distance_m = distance_m}); };
    const auto near = at(5), middle = at(10), far = at(20);
    for (std::size_t m = 0; m < modes.size(); ++m) {
      if (near[m] < 1e-3 * near[0]) continue;  // odd modes
      EXPECT_TRUE(within(20 * std::log10(near[m] / middle[m]), 20 * std::log10(2), 0.06)) << m;
      EXPECT_TRUE(within(20 * std::log10(middle[m] / far[m]), 20 * std::log10(2), 0.03)) << m;
    }
  }
}

TEST(Radiation, KnowsHowFarABodyReaches) {
  const Reach above = reach_of(kPlate, {.distance_m = 1});
  EXPECT_DOUBLE_EQ(above.nearest_m, 1);
  EXPECT_DOUBLE_EQ(above.farthest_m, std::hypot(0.15, 0.1, 1.0));
  // To the right of who stands at x > 0 and looks at the middle is y > 0.
  const Reach aside = reach_of(kHead, {.distance_m = 1, .angle_rad = pi / 6, .side_m = 0.75});
  const double x = 0.5, y = 0.75, z = std::cos(pi / 6);
  EXPECT_NEAR(aside.nearest_m, std::hypot(std::hypot(x, y) - 0.1, z), 1e-12);
  EXPECT_NEAR(aside.farthest_m, std::hypot(std::hypot(x, y) + 0.1, z), 1e-12);
}

}  // namespace
}  // namespace contactspline::testing
