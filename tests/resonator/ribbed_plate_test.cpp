// SPDX-License-Identifier: MIT
// Modes of plates with ribs against equations of their own for one rib, against the plate without ribs, against the
// energies of their shapes, and against a plate with the stiffness of many ribs.
#include "generator/resonator/ribbed_plate.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <vector>

#include "generator/resonator/resonator.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

const Plate kBoard{1.4, 0.9, 0.008, 400, 11e9, 0.6e9, 0.7e9, 0.4, {7, 0.03}};
constexpr double kMass = 400 * 0.008 * 1.4 * 0.9 / 4;  // of each sine [kg]

struct Wave {
  double kx, ky, stiffness_n_per_m;
};

Wave wave(const PlateSine& sine) {
  const double kx = sine.along * pi / 1.4, ky = sine.across * pi / 0.9;
  const auto [along, across, mixed] = bending_stiffness(kBoard);
  return {kx, ky,
          (along * std::pow(kx, 4) + 2 * mixed * kx * kx * ky * ky + across * std::pow(ky, 4)) * 1.4 * 0.9 / 4};
}

Resonator board(std::vector<Rib> ribs) {
  Plate plate = kBoard;
  plate.ribbed = std::make_shared<const RibbedPlate>(plate, std::move(ribs));
  return {.name = "board",
          .description = "",
          .body = plate,
          .strike = {0.31, 0, 0.17},
          .pickup = {0.9, 0, 0.71},
          .max_modes = 4096};
}

/// What one rib adds: a and b times the square of the sum of s q, to twice the potential and the kinetic energy.
struct OneRib {
  double a, b;
  std::vector<double> s, stiffness;

  // Its roots are the squares of the frequencies. It rises between its poles.
  [[nodiscard]] double operator()(double square) const {
    double sum = 1 / (a - square * b);
    for (std::size_t i = 0; i < s.size(); ++i) sum += s[i] * s[i] / (stiffness[i] - square * kMass);
    return sum;
  }
  // One root between any two poles that follow each other, by halves of the interval.
  [[nodiscard]] std::vector<double> roots() const {
    std::vector<double> poles{a / b}, roots;
    for (const double k : stiffness) poles.push_back(k / kMass);
    std::ranges::sort(poles);
    for (std::size_t i = 0; i + 1 < poles.size(); ++i) {
      double low = poles[i], high = poles[i + 1];
      for (int halving = 0; halving < 100; ++halving) {
        const double middle = low + (high - low) / 2;
        ((*this)(middle) < 0 ? low : high) = middle;
      }
      roots.push_back(low);
    }
    return roots;
  }
};

// A rib from edge to edge across the plate keeps the sines across apart. Each of them sees a point that is stiff by
// EI ky^4 W/2 and weighs rho A W/2. The same sines give the same frequencies except for rounding: 1e-16 of the
// largest 1/w0^2, which is 1e5 times the smallest that is kept, and more for the sum of the 400 products.
TEST(RibbedPlate, OneRibFromEdgeToEdgeSolvesItsOwnEquation) {
  const Rib rib{0.53, 0, 0.53, 0.9, 0.3, 250};
  const RibbedModes found = ribbed_modes(kBoard, {rib}, 400);
  const int most = std::ranges::max(found.sines, {}, &PlateSine::across).across;
  std::vector<double> expected;
  for (int across = 1; across <= most; ++across) {
    const double ky = across * pi / 0.9;
    OneRib one{250 * std::pow(ky, 4) * 0.45, 0.3 * 0.45, {}, {}};
    for (const PlateSine& sine : found.sines)
      if (sine.across == across) {
        one.s.push_back(std::sin(wave(sine).kx * 0.53));
        one.stiffness.push_back(wave(sine).stiffness_n_per_m);
      }
    for (const double root : one.roots()) expected.push_back(std::sqrt(root));
  }
  std::ranges::sort(expected);
  ASSERT_EQ(found.modes.size(), 200u);
  ASSERT_EQ(expected.size(), 400u);
  for (std::size_t m = 0; m < found.modes.size(); ++m)
    EXPECT_TRUE(relatively_within(found.modes[m].angular_frequency_rad_per_s, expected[m], 1e-9)) << m;
}

// A short rib that only weighs is a mass at a point. What is left is its length l: the mean of a product of two sines
// over it differs from the value in the middle by at most (k l)^2/12, k up to 60 1/m.
TEST(RibbedPlate, AShortRibIsAMassAtAPoint) {
  const RibbedModes found = ribbed_modes(kBoard, {{0.4995, 0.37, 0.5005, 0.37, 200, 0}}, 300);
  OneRib one{0, 0.2, {}, {}};
  for (const PlateSine& sine : found.sines) {
    const Wave of = wave(sine);
    one.s.push_back(std::sin(of.kx * 0.5) * std::sin(of.ky * 0.37));
    one.stiffness.push_back(of.stiffness_n_per_m);
  }
  const std::vector<double> roots = one.roots();
  for (std::size_t m = 0; m < 40; ++m)
    EXPECT_TRUE(relatively_within(found.modes[m].angular_frequency_rad_per_s, std::sqrt(roots[m]), 3e-4)) << m;
}

TEST(RibbedPlate, RibsOfNothingLeaveThePlateAsItIs) {
  Resonator bare = board({});
  std::get<Plate>(bare.body).ribbed = nullptr;
  const auto expected = modes_of(bare, 3000).modes,
             found = modes_of(board({{0.2, 0.1, 0.9, 0.8, 0, 0}, {0.3, 0, 0.3, 0.9, 0, 0}}), 3000).modes;
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_GT(found.size(), 200u);
  for (std::size_t m = 0; m < found.size(); ++m) {
    EXPECT_TRUE(relatively_within(found[m].mode.angular_frequency_rad_per_s,
                                  expected[m].mode.angular_frequency_rad_per_s, 1e-11));
    EXPECT_TRUE(relatively_within(found[m].mode.decay_per_s, expected[m].mode.decay_per_s, 1e-11));
    EXPECT_TRUE(relatively_within(found[m].mode.mass_kg, expected[m].mode.mass_kg, 1e-12));
    EXPECT_TRUE(within(found[m].strike_shape, expected[m].strike_shape, 1e-9));
    EXPECT_TRUE(within(found[m].pickup_shape, expected[m].pickup_shape, 1e-9));
  }
}

// The potential and the kinetic energy of a mode are equal: that of the plate by its sines, that of the rib by its
// shape along the rib in steps of h. Simpson's rule and the second difference are wrong by (k h)^2/12, k up to 60
// 1/m.
TEST(RibbedPlate, EnergiesOfASlantedRibAreThoseOfItsShape) {
  const Rib rib{0.21, 0.08, 1.1, 0.83, 0.4, 300};
  const RibbedPlate plate(kBoard, {rib});
  const double length = std::hypot(rib.to_m - rib.from_m, rib.to_across_m - rib.from_across_m);
  constexpr int kSteps = 2000;
  const double h = length / kSteps;
  for (std::size_t m = 0; m < 60; m += 7) {
    const auto shape = [&](double along) {
      const double part = along / length;
      return plate.shape_at(m, rib.from_m + part * (rib.to_m - rib.from_m),
                            rib.from_across_m + part * (rib.to_across_m - rib.from_across_m));
    };
    double potential = 0, kinetic = 0;
    for (std::size_t i = 0; i < plate.modes().sines.size(); ++i) {
      const double square = std::pow(plate.modes().weights[m][i], 2);
      potential += square * wave(plate.modes().sines[i]).stiffness_n_per_m;
      kinetic += square * kMass;
    }
    for (int i = 0; i <= kSteps; ++i) {
      const double weight = h / 3 * (i == 0 || i == kSteps ? 1 : i % 2 == 0 ? 2 : 4), at = i * h, here = shape(at);
      const double curved = (shape(at - h) - 2 * here + shape(at + h)) / (h * h);
      potential += weight * 300 * curved * curved;
      kinetic += weight * 0.4 * here * here;
    }
    const UndampedMode& mode = plate.modes().modes[m];
    EXPECT_TRUE(relatively_within(std::sqrt(potential / kinetic), mode.angular_frequency_rad_per_s, 1e-4)) << m;
    EXPECT_TRUE(relatively_within(kinetic, mode.mass_kg, 1e-4)) << m;
  }
}

// Modes do not drive each other: no product of two of them is left in either energy.
TEST(RibbedPlate, ModesAreOrthogonal) {
  const std::vector<Rib> ribs{{0.1, 0.2, 1.3, 0.6, 0.5, 400}, {0.6, 0, 0.6, 0.9, 0.3, 200}};
  const RibbedModes found = ribbed_modes(kBoard, ribs, 150);
  const auto along = [&](const Rib& rib, std::size_t m, double part) {
    double shape = 0;
    for (std::size_t i = 0; i < found.sines.size(); ++i)
      shape += found.weights[m][i] * std::sin(wave(found.sines[i]).kx * std::lerp(rib.from_m, rib.to_m, part)) *
               std::sin(wave(found.sines[i]).ky * std::lerp(rib.from_across_m, rib.to_across_m, part));
    return shape;
  };
  for (std::size_t m = 0; m < 6; ++m)
    for (std::size_t other = 0; other < m; ++other) {
      double product = kMass * std::inner_product(found.weights[m].begin(), found.weights[m].end(),
                                                  found.weights[other].begin(), 0.0);
      for (const Rib& rib : ribs) {  // Simpson's rule in 200 steps, to (k h)^4/180, k up to 30 1/m
        const double h = std::hypot(rib.to_m - rib.from_m, rib.to_across_m - rib.from_across_m) / 200;
        for (int i = 0; i <= 200; ++i)
          product += rib.mass_per_length_kg_m * h / 3 *
                     (i == 0 || i == 200 ? 1
                      : i % 2 == 0       ? 2
                                         : 4) *
                     along(rib, m, i / 200.0) * along(rib, other, i / 200.0);
      }
      EXPECT_TRUE(within(product, 0, 1e-5 * kMass)) << m << ' ' << other;
    }
}

// Many ribs across the grain act like a plate that is stiffer across and heavier. For a wave of half a length of 8
// ribs and more the difference is far below 1 %.
TEST(RibbedPlate, ManyRibsActLikeAStifferPlate) {
  constexpr int kRibs = 35;
  const double apart = 1.4 / kRibs;
  std::vector<Rib> ribs;
  for (int i = 0; i < kRibs; ++i) ribs.push_back({(i + 0.5) * apart, 0, (i + 0.5) * apart, 0.9, 0.05, 60});
  const auto [stiff_along, stiff_across, mixed] = bending_stiffness(kBoard);
  std::vector<double> expected;
  for (int m = 1; m < 20; ++m)
    for (int n = 1; n < 20; ++n) {
      const double kx = m * pi / 1.4, ky = n * pi / 0.9;
      expected.push_back(std::sqrt((stiff_along * std::pow(kx, 4) + 2 * mixed * kx * kx * ky * ky +
                                    (stiff_across + 60 / apart) * std::pow(ky, 4)) /
                                   (400 * 0.008 + 0.05 / apart)));
    }
  std::ranges::sort(expected);
  const RibbedModes found = ribbed_modes(kBoard, ribs, 800);
  for (std::size_t m = 0; m < 12; ++m)
    EXPECT_TRUE(relatively_within(found.modes[m].angular_frequency_rad_per_s, expected[m], 0.002)) << m;
}

// As stiff and as heavy as the reader allows, 1e6 times the plate: a bar that the plate hangs on. The low modes are
// those of the bar and of what it leaves of the plate, and all are there.
TEST(RibbedPlate, HasItsModesUnderTheLargestRibs) {
  for (const auto& [mass, stiffness] : {std::pair(1e6, 0.0), std::pair(0.0, 1e6), std::pair(1e6, 1e6)}) {
    const double width_m = 1.4 * 0.9 / 0.8;
    const double of_plate_kg_m = 400 * 0.008 * width_m, of_plate_n_m2 = bending_stiffness(kBoard).across * width_m;
    const RibbedModes found =
        ribbed_modes(kBoard, {{0.2, 0.3, 1.0, 0.3, mass * of_plate_kg_m, stiffness * of_plate_n_m2}}, 300);
    ASSERT_EQ(found.modes.size(), 150u);
    double before = 0;
    for (const UndampedMode& mode : found.modes) {
      EXPECT_TRUE(is_finite(mode.mass_kg) && is_finite(mode.wavenumber_per_m) && mode.mass_kg > 0);
      EXPECT_GE(mode.angular_frequency_rad_per_s, before);
      before = mode.angular_frequency_rad_per_s;
    }
    EXPECT_GT(found.modes.front().angular_frequency_rad_per_s, 0);
    EXPECT_LT(before, 1e5);
  }
}

TEST(RibbedPlate, SaysThatItsHighestModesAreMissing) {
  const Resonator ribbed = board({{0.3, 0, 0.3, 0.9, 0.3, 200}});
  EXPECT_TRUE(numbered_modes_of(ribbed, 22050).cut);
  EXPECT_EQ(numbered_modes_of(ribbed, 22050).modes.size(), RibbedPlate::kModes);
  EXPECT_FALSE(numbered_modes_of(ribbed, 500).cut);
}

}  // namespace
}  // namespace contactspline::testing
