// SPDX-License-Identifier: MIT
// Modes of strings, bars, membranes and plates against closed forms, tables and quadrature.
#include "generator/resonator/resonator.hpp"

#include <numbers>

#include "runtime/strings.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

double frequency_hz(const ResonatorMode& mode) {
  const double w = mode.mode.angular_frequency_rad_per_s, s = mode.mode.decay_per_s;
  return std::sqrt(w * w + s * s) / (2 * pi);  // without losses
}

// f_i = i f_0 sqrt(1 + B i^2), B = pi^2 eps, f_0 = sqrt(T/mu)/(2 L).
TEST(StiffString, PartialsAreStretched) {
  const auto struck = c4();
  const auto modes = audible_modes(struck);
  const double f0 = std::sqrt(670 * 0.62 / 0.00393) / (2 * 0.62);
  ASSERT_EQ(modes.size(), 56u);
  for (std::size_t i = 1; i <= modes.size(); ++i) {
    const double n = static_cast<double>(i);
    EXPECT_TRUE(
        relatively_within(frequency_hz(modes[i - 1]), n * f0 * std::sqrt(1 + pi * pi * 3.82e-5 * n * n), 1e-12));
    EXPECT_TRUE(relatively_within(modes[i - 1].mode.decay_per_s, 0.5 + 1e-4 * std::pow(n * pi / 0.62, 2), 1e-12));
    EXPECT_TRUE(within(modes[i - 1].strike_shape, std::sin(n * pi * 0.12), 1e-13));
  }
  EXPECT_EQ(audible_modes(c2()).size(), 204u);  // the reference's count
}

// Losses above the limit: no mode sounds, and none of the 1e10 overdamped ones is visited.
TEST(Resonators, WithoutASoundingModeHaveNone) {
  const Losses losses{1e6, 0};
  const Resonator bodies[] = {{"membrane", "", Membrane{100, 1e4, 1e-3, losses}, {1}, {2}, 4096},
                              {"string", "", StiffString{100, 1e4, 1e-3, 0, losses}, {1}, {2}, 4096},
                              {"bar", "", Bar{100, 1e4, 1e-9, losses}, {1}, {2}, 4096}};
  for (const Resonator& body : bodies) EXPECT_TRUE(modes_of(body, 22050).modes.empty()) << body.name;
}

// A string whose first two million partials are overdamped: w_i = i v pi/L sounds from i > c L/(v pi) on. With a
// second loss, the first one is the first above the smaller root of w - c - b w^2/v^2.
TEST(Resonators, BeginWithTheFirstModeThatSounds) {
  const double step = pi / 100 * std::sqrt(1e-3 * 100 / 1e3);  // w_1
  const double constant = 2e6 * step + 0.3 * step;
  for (const double quadratic : {0.0, 1e-9}) {
    const Resonator string{"string", "", StiffString{100, 1e3, 1e-3, 0, {constant, quadratic}}, {1}, {2}, 10};
    const double b = quadratic / (1e-3 * 100 / 1e3);
    const double root = b == 0 ? constant : (1 - std::sqrt(1 - 4 * b * constant)) / (2 * b);
    const auto modes = modes_of(string, 22050).modes;
    ASSERT_EQ(modes.size(), 10u);
    EXPECT_TRUE(relatively_within(modes[0].wavenumber_per_m, (std::floor(root / step) + 1) * pi / 100, 1e-12));
  }
  const Resonator drum{"drum", "", Membrane{10, 100, 0.1, {2000.5 * std::sqrt(0.1 / 100), 0}}, {1}, {2}, 3};
  const auto modes = modes_of(drum, 22050).modes;
  ASSERT_EQ(modes.size(), 3u);
  for (const auto& mode : modes) EXPECT_GT(mode.wavenumber_per_m, 2000.5);
  EXPECT_LT(modes[0].wavenumber_per_m, 2000.5 + pi / 10);  // the zeros of J_m lie pi apart
}

// Classical frequency ratios of the free-free bar (Rossing, Fletcher): 1, 2.7565, 5.4039, 8.9330.
TEST(FreeBar, FrequenciesStandInTheClassicalRatios) {
  const Resonator bar{"bar", "", Bar{0.3, 0.4, 60, {1, 0}}, {0.15}, {0.0}, 100};
  const auto modes = modes_of(bar, 20000).modes;
  const double ratios[] = {1, 2.7565, 5.4039, 8.9330};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_TRUE(within(frequency_hz(modes[i]) / frequency_hz(modes[0]), ratios[i], 1e-4));
  EXPECT_TRUE(relatively_within(frequency_hz(modes[0]),
                                std::pow(4.730040744862704 / 0.3, 2) * std::sqrt(60 * 0.3 / 0.4) / (2 * pi), 1e-12));
}

// Shape 1 at the end, integral of the shape squared a quarter of the length: by the midpoint rule over 2,000 places.
TEST(FreeBar, ShapesAreNormalised) {
  constexpr int kPlaces = 2000;
  std::vector<double> integrals(6);
  for (int p = 0; p < kPlaces; ++p) {
    const Resonator bar{"bar", "", Bar{0.3, 0.4, 60, {1, 0}}, {0.3 * (p + 0.5) / kPlaces}, {0.0}, 6};
    const auto modes = modes_of(bar, 1e6).modes;
    for (std::size_t i = 0; i < 6; ++i) {
      integrals[i] += modes[i].strike_shape * modes[i].strike_shape / kPlaces;
      EXPECT_TRUE(within(modes[i].pickup_shape, 1, 1e-12));
    }
  }
  for (const double integral : integrals) EXPECT_TRUE(within(integral, 0.25, 1e-5));
}

// sinh(beta L) leaves the range of double at beta L = 710; the shapes must not.
TEST(FreeBar, OfManyModesKeepsItsShapes) {
  const Resonator wire{"wire", "", Bar{10, 1, 0.01, {1, 0}}, {9.9}, {10}, 4096};
  const auto modes = modes_of(wire, 22050).modes;
  ASSERT_GT(modes.size(), 1000u);
  for (const auto& mode : modes) {
    EXPECT_LE(std::abs(mode.strike_shape), 1);
    EXPECT_TRUE(within(std::abs(mode.pickup_shape), 1, 1e-9));  // beta L is right to 2^-53 of up to 6600
  }
}

// Zeros of J_m over that of J_0 (Rossing, Fletcher): 1, 1.593, 2.135, 2.295, 2.653, 2.917.
TEST(Membrane, FrequenciesStandInTheClassicalRatios) {
  const Resonator drum{"drum", "", Membrane{0.16, 0.26, 1850, {2, 0}}, {0.05}, {0.08, 0.5}, 500};
  const auto modes = modes_of(drum, 10000).modes;
  const double ratios[] = {1, 1.5933, 2.1355, 2.2954, 2.6531, 2.9173};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_TRUE(within(frequency_hz(modes[i]) / frequency_hz(modes[0]), ratios[i], 1e-4));
}

// Modal mass of the first two modes by quadrature over radius and angle.
TEST(Membrane, MassesAreIntegralsOfTheShape) {
  constexpr int kPlaces = 400;
  double masses[2] = {0, 0};
  for (int p = 0; p < kPlaces; ++p) {
    const double r = 0.16 * (p + 0.5) / kPlaces;
    const Resonator drum{"drum", "", Membrane{0.16, 0.26, 1850, {2, 0}}, {r}, {r}, 2};
    const auto modes = modes_of(drum, 10000).modes;
    const double ring = 0.26 * r * 0.16 / kPlaces;
    masses[0] += 2 * pi * ring * modes[0].strike_shape * modes[0].strike_shape;
    masses[1] += pi * ring * modes[1].strike_shape * modes[1].strike_shape;
    if (p + 1 < kPlaces) continue;
    EXPECT_TRUE(relatively_within(modes[0].mode.mass_kg, masses[0], 1e-5));
    EXPECT_TRUE(relatively_within(modes[1].mode.mass_kg, masses[1], 1e-5));
  }
}

Plate aluminium() {
  return {0.4, 0.29, 0.002, 2700, 70e9, 70e9, 70e9 / (2 * 1.33), 0.33, {3, 0}};
}

// f = pi/2 sqrt(D/(rho h)) (m^2/a^2 + n^2/b^2) with D = E h^3/(12 (1 - nu^2)) (Leissa, Vibration of Plates, 1969):
// all of them below 5 kHz, in order, with a quarter of the plate's mass and the product of two sines.
TEST(Plate, OfOneMaterialHasTheClassicalModes) {
  const Resonator plate{"plate", "", aluminium(), {0.13, 0, 0.08}, {0.31, 0, 0.22}, 4096};
  const double d = 70e9 * std::pow(0.002, 3) / (12 * (1 - 0.33 * 0.33));
  struct Expected {
    double frequency, strike, pickup;
  };
  std::vector<Expected> expected;
  for (int m = 1; m < 40; ++m)
    for (int n = 1; n < 40; ++n) {
      const double f = pi / 2 * std::sqrt(d / (2700 * 0.002)) * (m * m / 0.16 + n * n / 0.0841);
      const auto shape = [&](double x, double y) { return std::sin(m * pi * x / 0.4) * std::sin(n * pi * y / 0.29); };
      if (f < 5000) expected.push_back({f, shape(0.13, 0.08), shape(0.31, 0.22)});
    }
  std::ranges::sort(expected, {}, &Expected::frequency);
  const auto modes = modes_of(plate, 5000).modes;
  ASSERT_EQ(modes.size(), expected.size());
  ASSERT_GT(modes.size(), 75u);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    EXPECT_TRUE(relatively_within(frequency_hz(modes[i]), expected[i].frequency, 1e-12));
    EXPECT_TRUE(relatively_within(modes[i].mode.mass_kg, 2700 * 0.002 * 0.4 * 0.29 / 4, 1e-14));
    EXPECT_TRUE(within(modes[i].strike_shape, expected[i].strike, 1e-12));
    EXPECT_TRUE(within(modes[i].pickup_shape, expected[i].pickup, 1e-12));
  }
}

// Spruce, narrow along the grain: long waves across it are those of a beam, EI = Ey h^3/12 per width without
// Poisson's ratio. Turned by a right angle it has the same modes.
TEST(Plate, OfSpruceHasTwoStiffnesses) {
  const Losses losses{5, 0};
  const Plate strip{100, 0.5, 0.008, 400, 11e9, 0.6e9, 0.7e9, 0, losses};
  const Resonator wide{"strip", "", strip, {1, 0, 0.1}, {1, 0, 0.1}, 1};
  const double beam = pi / (2 * 0.25) * std::sqrt(0.6e9 * std::pow(0.008, 3) / 12 / (400 * 0.008));
  EXPECT_TRUE(relatively_within(frequency_hz(modes_of(wide, 1000).modes[0]), beam, 1e-3));

  const Plate board{1.4, 0.9, 0.008, 400, 11e9, 0.6e9, 0.7e9, 0.4, losses};
  const Plate turned{0.9, 1.4, 0.008, 400, 0.6e9, 11e9, 0.7e9, 0.4 * 0.6 / 11, losses};
  const auto one = modes_of({"board", "", board, {0.3, 0, 0.2}, {0.5, 0, 0.6}, 60}, 22050).modes;
  const auto other = modes_of({"turned", "", turned, {0.2, 0, 0.3}, {0.6, 0, 0.5}, 60}, 22050).modes;
  ASSERT_EQ(one.size(), 60u);
  ASSERT_EQ(other.size(), 60u);
  for (std::size_t i = 0; i < 60; ++i) {
    EXPECT_TRUE(relatively_within(frequency_hz(one[i]), frequency_hz(other[i]), 1e-12));
    EXPECT_TRUE(
        within(one[i].pickup_shape * one[i].strike_shape, other[i].pickup_shape * other[i].strike_shape, 1e-12));
  }
}

// A plate of 100 m and 10 um has some 10^12 modes below the limit; only the lowest are looked for.
TEST(Plate, FindsTheLowestModesWithoutListingAll) {
  const Resonator foil{"foil", "", Plate{100, 90, 1e-5, 2700, 70e9, 70e9, 70e9 / 2.66, 0.33, {0, 0}}, {5}, {9}, 300};
  const auto set = modes_of(foil, 22050);
  EXPECT_TRUE(set.cut);
  ASSERT_EQ(set.modes.size(), 300u);
  std::vector<double> sums;
  for (int m = 1; m <= 300; ++m)
    for (int n = 1; n <= 300; ++n) sums.push_back(m * m / 1e4 + n * n / 8.1e3);
  std::ranges::sort(sums);
  for (std::size_t i = 0; i < 300; ++i)
    EXPECT_TRUE(relatively_within(frequency_hz(set.modes[i]) / frequency_hz(set.modes[0]), sums[i] / sums[0], 1e-12));
}

TEST(Resonator, TheLimitCutsAndSaysSo) {
  Resonator string{"c4", "", c4().string, {0.1}, {0.2}, 10};
  EXPECT_TRUE(modes_of(string, 22050).cut);
  EXPECT_EQ(modes_of(string, 22050).modes.size(), 10u);
  string.max_modes = 56;
  EXPECT_FALSE(modes_of(string, 22050).cut);
}

// A membrane of 100 m has some 10^9 modes below the limit; only the lowest are looked for. The lowest of all are
// overdamped (decay 6/s against 1.6 rad/s) and left out.
TEST(Resonator, FindsTheLowestModesWithoutListingAll) {
  const Resonator lake{"lake", "", Membrane{100, 0.353, 1500, {6, 0}}, {5}, {9, 0.7}, 200};
  const auto set = modes_of(lake, 22050);
  EXPECT_TRUE(set.cut);
  ASSERT_EQ(set.modes.size(), 200u);
  EXPECT_GT(set.modes.front().mode.angular_frequency_rad_per_s, 0);
  for (std::size_t i = 1; i < set.modes.size(); ++i)
    EXPECT_LE(frequency_hz(set.modes[i - 1]), frequency_hz(set.modes[i]));
  // the same lowest modes as where more are kept
  Resonator more = lake;
  more.max_modes = 600;
  const auto larger = modes_of(more, 22050);
  for (std::size_t i = 0; i < set.modes.size(); ++i)
    EXPECT_EQ(set.modes[i].wavenumber_per_m, larger.modes[i].wavenumber_per_m);
}

TEST(Resonator, ATableOfModesIsSortedAndKept) {
  const ModeTable table{{{{2000, 1, 0.1}, 0.5, 0.6}, {{1000, 2, 0.2}, 0.7, 0.8}, {{1e6, 2, 0.2}, 0.7, 0.8}}};
  const auto modes = modes_of({"table", "", table, {}, {}, 10}, 22050).modes;
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_EQ(modes[0].mode.angular_frequency_rad_per_s, 1000);
  EXPECT_EQ(modes[0].pickup_shape, 0.8);
  EXPECT_EQ(modes[1].strike_shape, 0.5);
}

}  // namespace
}  // namespace contactspline::testing
