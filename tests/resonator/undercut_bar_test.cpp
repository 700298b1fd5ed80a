// SPDX-License-Identifier: MIT
// Bars with an arch: against the uniform bar, against the equation of the bar step by step, and their shapes.
#include "generator/resonator/undercut_bar.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "generator/resonator/resonator_reader.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using Real = long double;

const Bar kBar{0.33, 0.33, 64.05, {0, 0}};

TEST(UndercutBar, IsTheUniformBarWithoutAnArch) {
  const UndercutBar bar(kBar, {0.2, 1});
  for (int i = 0; i < 20; ++i) {
    const UndampedMode expected = undamped_mode(kBar, i + 1);
    const auto& [w, beta, mass] = bar.modes()[static_cast<std::size_t>(i)];
    EXPECT_TRUE(relatively_within(w, expected.angular_frequency_rad_per_s, 1e-8)) << i;
    EXPECT_TRUE(relatively_within(beta, expected.wavenumber_per_m, 1e-8)) << i;
    EXPECT_TRUE(relatively_within(mass, expected.mass_kg, 1e-8)) << i;
    for (const double x : {0.0, 0.07, 0.165, 0.3})
      EXPECT_TRUE(within(bar.shape_at(static_cast<std::size_t>(i), x), shape_at(kBar, i + 1, beta, x), 1e-7)) << i;
  }
}

Real thickness_at(const Undercut& arch, Real x) {
  const Real s = 2 * (x - Real(kBar.length_m) / 2) / Real(arch.length_m);
  return std::abs(s) < 1 ? 1 - (1 - Real(arch.thickness_ratio)) * (1 - s * s) : Real(1);
}

// u' = slope, slope' = M/EI, M' = Q, Q' = w^2 mu u by Runge and Kutta's method of order 4, from a free end with two
// motions. Where both leave moment and shear at the other end, their determinant is 0 at a frequency of the bar.
Real determinant_at(const Undercut& arch, Real w) {
  using State = std::array<Real, 4>;
  const Real length = kBar.length_m, mass_per_m = Real(kBar.mass_kg) / length;
  const auto slope_of = [&](const State& s, Real x) {
    const Real ratio = thickness_at(arch, x);
    return State{s[1], s[2] / (Real(kBar.bending_stiffness_n_m2) * ratio * ratio * ratio), s[3],
                 w * w * mass_per_m * ratio * s[0]};
  };
  const auto moved = [](State s, const State& by, Real h) {
    for (std::size_t i = 0; i < 4; ++i) s[i] += h * by[i];
    return s;
  };
  const Real end = (length - Real(arch.length_m)) / 2;
  std::array<State, 2> states = {State{1, 0, 0, 0}, State{0, 1, 0, 0}};
  for (State& s : states)
    for (const auto& [from, to] :
         {std::pair(Real(0), end), std::pair(end, length - end), std::pair(length - end, length)}) {
      constexpr int kSteps = 4000;
      const Real h = (to - from) / kSteps;
      for (int n = 0; n < kSteps; ++n) {
        // At a border the side that is being integrated counts.
        const Real x = from + n * h, inside = h * 1e-9L;
        const State a = slope_of(s, x + inside), b = slope_of(moved(s, a, h / 2), x + h / 2),
                    c = slope_of(moved(s, b, h / 2), x + h / 2), d = slope_of(moved(s, c, h), x + h - inside);
        for (std::size_t i = 0; i < 4; ++i) s[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
      }
    }
  return states[0][2] * states[1][3] - states[0][3] * states[1][2];
}

// The frequencies lie above those of the equation, by less than a bound: the determinant changes its sign between
// that and 1e-8 beyond, for what the steps err. Of higher modes rounding hides the determinant.
TEST(UndercutBar, HasTheFrequenciesOfTheEquation) {
  struct Case {
    Undercut arch;
    Real bound;
  };
  for (const auto& [arch, bound] : {Case{{0.18, 0.43}, 1e-6L}, Case{{0.3, 0.2}, 1e-6L}, Case{{0.33, 0.6}, 1e-6L},
                                    Case{{0.05, 0.3}, 2e-4L}, Case{{0.0165, 0.05}, 2e-4L}}) {
    const UndercutBar bar(kBar, arch);
    for (std::size_t m = 0; m < 8; ++m) {
      const Real w = bar.modes()[m].angular_frequency_rad_per_s;
      const bool is_below = std::signbit(determinant_at(arch, w * (1 - bound)));
      EXPECT_NE(is_below, std::signbit(determinant_at(arch, w * (1 + 1e-8L)))) << arch.length_m << " m, mode " << m;
    }
  }
}

// Shapes of different modes move no mass together, and the modal mass is that of the shape. Midpoints of 1,000 parts.
TEST(UndercutBar, HasOrthogonalShapes) {
  const Undercut arch{0.165, 0.4};
  const UndercutBar bar(kBar, arch);
  constexpr int kParts = 1000;
  for (std::size_t m = 0; m < 5; ++m) {
    EXPECT_TRUE(relatively_within(bar.shape_at(m, 0), 1, 1e-8));
    EXPECT_TRUE(relatively_within(std::abs(bar.shape_at(m, kBar.length_m)), 1, 1e-7));
    for (std::size_t n = 0; n <= m; ++n) {
      double sum = 0;
      for (int p = 0; p < kParts; ++p) {
        const double x = (p + 0.5) / kParts * kBar.length_m;
        sum += double(thickness_at(arch, x)) * bar.shape_at(m, x) * bar.shape_at(n, x) * kBar.mass_kg / kParts;
      }
      const double mass = bar.modes()[m].mass_kg;
      EXPECT_TRUE(within(sum, m == n ? mass : 0, 1e-4 * mass)) << m << ' ' << n;
    }
  }
}

// As marimbas are: the arch makes the second partial the double octave, and the third ten times the first or less.
TEST(UndercutBar, TunesAMarimba) {
  const auto ratios_of = [](double thickness_ratio) {
    const UndercutBar bar(kBar, {0.18, thickness_ratio});
    const double first = bar.modes()[0].angular_frequency_rad_per_s;
    return std::array{bar.modes()[1].angular_frequency_rad_per_s / first,
                      bar.modes()[2].angular_frequency_rad_per_s / first};
  };
  const auto [second, third] = ratios_of(0.438);
  Measured() << "partials at " << second << " and " << third;
  EXPECT_TRUE(within(second, 4, 0.01));
  EXPECT_TRUE(within(third, 9.5, 0.3));
}

std::string file_with(const std::string& more) {
  return R"({ "name": "probe", "bar": { "length_m": 0.33, "mass_kg": 0.33, "bending_stiffness_n_m2": 64.05,
              "constant_loss_per_s": 2.5, "quadratic_loss_m2_per_s": 0.008)" +
         more + R"( }, "strike": { "position_m": 0.165 }, "pickup": { "position_m": 0 } })";
}

TEST(UndercutBar, IsReadFromItsFile) {
  const Resonator bar =
      parse_resonator(file_with(R"(, "undercut": { "length_m": 0.18, "thickness_ratio": 0.438 })"), "probe.json");
  const UndercutBar direct(kBar, {0.18, 0.438});
  const ModeSet set = modes_of(bar, 22050);
  ASSERT_GT(set.modes.size(), 5U);
  for (std::size_t m = 0; m < set.modes.size(); ++m) {
    const double decay = 2.5 + 0.008 * std::pow(direct.modes()[m].wavenumber_per_m, 2);
    EXPECT_TRUE(relatively_within(set.modes[m].mode.decay_per_s, decay, 1e-12));
    EXPECT_TRUE(relatively_within(std::hypot(set.modes[m].mode.angular_frequency_rad_per_s, decay),
                                  direct.modes()[m].angular_frequency_rad_per_s, 1e-12));
    EXPECT_TRUE(within(set.modes[m].strike_shape, direct.shape_at(m, 0.165), 1e-8));
    EXPECT_TRUE(within(set.modes[m].pickup_shape, 1, 1e-8));
  }
}

}  // namespace
}  // namespace contactspline::testing
