// SPDX-License-Identifier: MIT
// Modes of bars with all pairs of ends: textbook values, textbook shapes in long double, orthogonality by quadrature.
#include "generator/resonator/bar.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/resonator/resonator_reader.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr BarEnd kFree = BarEnd::kFree, kClamped = BarEnd::kClamped, kSupported = BarEnd::kSupported;
constexpr double kLength = 0.3, kMass = 0.4;

Bar bar_with(BarEnd first, BarEnd second) {
  return {kLength, kMass, 60, {1, 0}, {first, second}};
}

std::vector<Bar> all_bars() {
  std::vector<Bar> bars;
  for (const BarEnd first : {kFree, kClamped, kSupported})
    for (const BarEnd second : {kFree, kClamped, kSupported}) bars.push_back(bar_with(first, second));
  return bars;
}

std::ptrdiff_t supports_of(const Bar& bar) {
  return std::ranges::count(bar.ends, kSupported);
}

double shape(const Bar& bar, int i, double x) {
  return shape_at(bar, i, wavenumber_times_length(bar, i) / kLength, x);
}

struct Roots {
  BarEnd first, second;
  double beta_length[4];
};

// R. D. Blevins, Formulas for Natural Frequency and Mode Shape, 1979, table 8-1, with more digits of the same
// equations.
TEST(Bar, WavenumbersAreThoseOfTextbooks) {
  constexpr double kPi = std::numbers::pi;
  const Roots textbook[] = {
      {kFree, kFree, {4.730040744862704, 7.853204624095838, 10.995607838001671, 14.137165491257464}},
      {kClamped, kClamped, {4.730040744862704, 7.853204624095838, 10.995607838001671, 14.137165491257464}},
      {kClamped, kFree, {1.875104068711961, 4.694091132974175, 7.854757438237613, 10.995540734875467}},
      {kClamped, kSupported, {3.926602312047919, 7.068582745628732, 10.210176122813031, 13.351768777754093}},
      {kFree, kSupported, {3.926602312047919, 7.068582745628732, 10.210176122813031, 13.351768777754093}},
      {kSupported, kSupported, {kPi, 2 * kPi, 3 * kPi, 4 * kPi}}};
  for (const Roots& row : textbook)
    for (int i = 1; i <= 4; ++i) {
      EXPECT_TRUE(within(wavenumber_times_length(bar_with(row.first, row.second), i), row.beta_length[i - 1], 1e-12));
      EXPECT_TRUE(within(wavenumber_times_length(bar_with(row.second, row.first), i), row.beta_length[i - 1], 1e-12));
    }
}

// w0 = (beta L)^2 sqrt(EI/(M L^3)).
TEST(Bar, FrequenciesFollowFromWavenumbers) {
  for (const Bar& bar : all_bars()) {
    const double factor = std::sqrt(60 / (kMass * std::pow(kLength, 3)));
    const UndampedMode mode = undamped_mode(bar, 3);
    EXPECT_TRUE(relatively_within(mode.angular_frequency_rad_per_s,
                                  std::pow(wavenumber_times_length(bar, 3), 2) * factor, 1e-14));
  }
}

// The textbook shape of a bar whose first end is free or clamped: (cosh +- cos - k (sinh +- sin))/2, with k so that
// the conditions at the other end hold. It cancels for higher modes; so long double, and four modes.
double textbook_shape(const Bar& bar, long double end, long double x) {
  const long double sign = bar.ends[0] == kFree ? 1 : -1;
  const auto even = [&](long double at, long double s) { return std::cosh(at) + s * std::cos(at); };
  const auto odd = [&](long double at, long double s) { return std::sinh(at) + s * std::sin(at); };
  const long double there = bar.ends[1] == kFree ? -sign : sign;  // the shape or its second derivative is 0
  return static_cast<double>((even(x, sign) - even(end, there) / odd(end, there) * odd(x, sign)) / 2);
}

TEST(Bar, ShapesAreThoseOfTextbooks) {
  for (const Bar& bar : all_bars()) {
    if (bar.ends[0] == kSupported) continue;
    for (int i = 1; i <= 4; ++i)
      for (double x = 0; x <= kLength; x += kLength / 64) {
        const double end = wavenumber_times_length(bar, i);
        // The wavenumber is rounded to 2^-53, and textbooks' form multiplies that by up to exp(end).
        EXPECT_TRUE(within(shape(bar, i, x), textbook_shape(bar, end, end * x / kLength), 1e-15 * std::exp(end)));
      }
  }
}

TEST(Bar, TurnedRoundIsTheSameBar) {
  for (const Bar& bar : all_bars()) {
    const Bar turned = bar_with(bar.ends[1], bar.ends[0]);
    for (const int i : {1, 2, 3, 30, 3001}) {
      const double sign = supports_of(bar) == 1 || i % 2 != 0 ? 1 : -1;
      for (double x = 0; x <= kLength; x += kLength / 50)
        EXPECT_TRUE(within(shape(turned, i, kLength - x), sign * shape(bar, i, x), 1e-15 * i + 1e-15));
    }
  }
}

// The integral of the product of two shapes is 0, that of a square M/4 or M/2 per mass and length: by Simpson's rule
// over 20,000 parts, whose error for two of the 41 first modes is (2 beta h)^4/180 < 1.3e-10.
TEST(Bar, ShapesAreOrthogonalAndBelongToTheModalMasses) {
  constexpr int kParts = 20000;
  const int indices[] = {1, 2, 3, 4, 5, 8, 40, 41};
  for (const Bar& bar : all_bars()) {
    std::vector<std::vector<double>> shapes;
    for (const int i : indices) {
      shapes.emplace_back();
      for (int p = 0; p <= kParts; ++p) shapes.back().push_back(shape(bar, i, kLength * p / kParts));
    }
    for (std::size_t a = 0; a < shapes.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b) {
        double sum = 0;
        for (std::size_t p = 0; p <= kParts; ++p)
          sum += (p == 0 || p == kParts ? 1 : p % 2 == 0 ? 2 : 4) * shapes[a][p] * shapes[b][p];
        const double modal_mass = kMass * sum / (3 * kParts);
        EXPECT_TRUE(within(modal_mass, a == b ? undamped_mode(bar, indices[a]).mass_kg : 0, 1e-10 * kMass));
      }
  }
}

// What the ends hold: a support the shape, a clamp its slope too. A free end moves with the shape 1.
TEST(Bar, EndsAreHeldAtAllModes) {
  for (const Bar& bar : all_bars())
    for (const int i : {1, 2, 3, 10, 100, 1000, 4096}) {
      const double step = 1e-7 * kLength / i;
      for (const int e : {0, 1}) {
        const double end = e == 0 ? 0 : kLength;
        const double at_end = shape(bar, i, end);
        const BarEnd held = bar.ends[static_cast<std::size_t>(e)];
        EXPECT_TRUE(within(std::abs(at_end), held == kFree ? 1 : 0, held == kSupported ? 0 : 1e-15));
        if (held != kClamped) continue;
        const double beta_step = wavenumber_times_length(bar, i) / kLength * step;
        EXPECT_TRUE(within(shape(bar, i, std::abs(end - step)), beta_step * beta_step / 2, 1e-12));
      }
    }
}

// Both halves are computed from their own end. Where they meet they agree but for the rounding of beta.
TEST(Bar, HalvesOfHighModesMeet) {
  for (const Bar& bar : all_bars())
    for (const int i : {1, 2, 7, 100, 1001, 4096}) {
      const double middle = kLength / 2, beyond = std::nextafter(middle, 1.0);
      EXPECT_TRUE(within(shape(bar, i, beyond), shape(bar, i, middle), 2e-15 * i + 1e-14));
    }
}

std::string file_with(const std::string& ends) {
  return R"({ "name": "probe", "bar": { "length_m": 0.3, "mass_kg": 0.4, "bending_stiffness_n_m2": 60,
              "constant_loss_per_s": 1, "quadratic_loss_m2_per_s": 0)" +
         ends + R"( }, "strike": { "position_m": 0.1 }, "pickup": { "position_m": 0.3 } })";
}

TEST(Bar, EndsAreReadFromItsFile) {
  const auto ends_of = [](const std::string& ends) {
    return std::get<Bar>(parse_resonator(file_with(ends), "probe.json").body).ends;
  };
  EXPECT_EQ(ends_of(""), (std::array{kFree, kFree}));
  EXPECT_EQ(ends_of(R"(, "ends": ["clamped", "free"])"), (std::array{kClamped, kFree}));
  EXPECT_EQ(ends_of(R"(, "ends": ["supported", "clamped"])"), (std::array{kSupported, kClamped}));
}

// The places are counted from the first end: a tine is still at its clamp and moves at its tip.
TEST(Bar, PlacesAreCountedFromTheFirstEnd) {
  Resonator tine = parse_resonator(file_with(R"(, "ends": ["clamped", "free"])"), "probe.json");
  tine.strike.position_m = 0;
  for (const ResonatorMode& mode : modes_of(tine, 20000).modes) {
    EXPECT_EQ(mode.strike_shape, 0);
    EXPECT_TRUE(within(std::abs(mode.pickup_shape), 1, 1e-14));
  }
}

}  // namespace
}  // namespace contactspline::testing
