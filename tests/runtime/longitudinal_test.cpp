// SPDX-License-Identifier: MIT
// The longitudinal modes of strings: their drive against a quadrature, their force against driven oscillators, and
// what bounds them.
#include "contactspline/modal/longitudinal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

/// C2 of the piano that ships: steel of 1.24 mm in copper.
const StiffString kString{1.602, 0.03324, 911, 0.02335, {0.3274, 4.029e-5}};
const LongitudinalMotion kMotion{axial_stiffness(911, 16.4), {30, 0.02}, 1};

/// A transverse mode of one of several strings.
struct Row {
  Mode mode;
  double wavenumber_per_m;
};

std::vector<Row> rows_of(std::size_t strings, double below_hz) {
  std::vector<Row> rows;
  for (const StringMode& mode : modes_below(kString, below_hz))
    for (std::size_t s = 0; s < strings; ++s) rows.push_back({mode.mode, mode.wavenumber_per_m});
  return rows;
}

/// Displacements of modes, as LongitudinalModes takes them.
template <typename T>
struct Displacements : ModeShapes<T> {
  using ModeShapes<T>::ModeShapes;
  operator std::span<const T>() const { return {this->data(), this->size()}; }
};

/// Coefficient k of the cosines of a function of the angle pi x/L, by the trapezoidal rule, which is exact for sums
/// of cosines up to the number of points.
template <typename Function>
double cosine_coefficient(Function f, std::size_t k) {
  constexpr int kPoints = 256;
  double sum = 0;
  for (int i = 0; i <= kPoints; ++i) {
    const double angle = pi * i / kPoints;
    sum += f(angle) * std::cos(static_cast<double>(k) * angle) * (i == 0 || i == kPoints ? 0.5 : 1);
  }
  return sum / kPoints * (k == 0 ? 1 : 2);
}

// A string without bending stiffness: the first mode along it has so many times the frequency of the first one
// across.
TEST(AxialStiffness, GivesTheRatioOfFrequencies) {
  StiffString string = kString;
  string.bending_stiffness_n_m2 = 0;
  string.losses = {0, 0};
  const LongitudinalMotion motion{axial_stiffness(string.tension_n, 13.3), {0, 0}, 1};
  EXPECT_TRUE(relatively_within(longitudinal_modes(string, motion, 6000, 1).at(0).angular_frequency_rad_per_s,
                                13.3 * modes_below(string, 100).at(0).mode.angular_frequency_rad_per_s, 1e-14));
}

// All coefficients of two strings against a quadrature of the square of their slopes.
TEST(SlopeSquare, IsThatOfAQuadrature) {
  constexpr std::size_t kPartials = 37, kHighest = 13;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> slope(-1, 1);
  // Modes of two strings by turns. The slopes are 1 to 37 times the displacements.
  std::vector<double> per_m, slopes;
  for (std::size_t n = 1; n <= kPartials; ++n) per_m.insert(per_m.end(), 2, double(n));
  double sum = 0;
  Displacements<double> displacements(2 * kPartials);
  for (std::size_t i = 0; i < 2 * kPartials; ++i) {
    slopes.push_back(slope(random));
    displacements[i] = slopes[i] / per_m[i];
    sum += slopes[i] * slopes[i];
  }
  const auto square_at = [&](double angle) {
    double squares = 0;
    for (std::size_t string = 0; string < 2; ++string) {
      double total = 0;
      for (std::size_t n = 1; n <= kPartials; ++n)
        total += slopes[2 * (n - 1) + string] * std::cos(static_cast<double>(n) * angle);
      squares += total * total;
    }
    return squares;
  };
  detail::SlopeSquare<double> square(2, std::span<const double>(per_m), kHighest);
  const auto coefficients = square.coefficients(displacements);
  ASSERT_EQ(coefficients.size(), kHighest + 1);
  // Sums of less than 1,000 terms of at most 37 each, of which the terms sum up to less than 1,000 times the squares.
  for (std::size_t k = 0; k <= kHighest; ++k)
    EXPECT_TRUE(within(coefficients[k], cosine_coefficient(square_at, k), 1e-13 * sum)) << k;
}

/// Two transverse modes move as cosines; the force after all transients.
struct TwoModes {
  std::size_t m, n;
  double m_hz, n_hz, m_m, n_m;

  [[nodiscard]] std::vector<double> force(double rate_hz) const {
    const auto rows = rows_of(1, 2000);
    LongitudinalModes<double> modes(kString, kMotion, std::span<const Row>(rows), rate_hz);
    Displacements<double> displacements(rows.size());
    std::vector<double> forces;
    const int end = static_cast<int>(1.5 * rate_hz), begin = end - static_cast<int>(0.1 * rate_hz);
    for (int t = 0; t < end; ++t) {
      displacements[m - 1] = m_m * std::cos(2 * pi * m_hz * t / rate_hz);
      displacements[n - 1] = n_m * std::cos(2 * pi * n_hz * t / rate_hz);
      const double force = modes.tick(displacements);
      if (t >= begin) forces.push_back(force);
    }
    return forces;
  }

  /// Complex amplitude at a frequency by an independent solution: c D_k drives each mode as a damped oscillator. The
  /// largest part of the sum, too, for the bound.
  [[nodiscard]] std::pair<std::complex<double>, double> expected(double hz, double rate_hz) const {
    const double w = 2 * pi * hz, c = (kMotion.axial_stiffness_n - kString.tension_n) / 2;
    const double slope_m = m_m * static_cast<double>(m) * pi / kString.length_m;
    const double slope_n = n_m * static_cast<double>(n) * pi / kString.length_m;
    std::complex<double> sum = 0;
    double error = 0;
    for (std::size_t k = 0; k <= 16; ++k) {
      const double beta = static_cast<double>(k) * pi / kString.length_m;
      const double w0 = beta * std::sqrt(kMotion.axial_stiffness_n * kString.length_m / kString.mass_kg);
      if (w0 >= 2 * pi * 6000) break;
      const auto cosines = [](std::size_t i, std::size_t j) {
        return [=](double angle) {
          return std::cos(static_cast<double>(i) * angle) * std::cos(static_cast<double>(j) * angle);
        };
      };
      // cos^2 and the product of two cosines have these parts at hz.
      double amplitude = 0;
      if (hz == m_hz + n_hz || hz == n_hz - m_hz)
        amplitude += slope_m * slope_n * cosine_coefficient(cosines(m, n), k);
      if (hz == 2 * m_hz) amplitude += slope_m * slope_m / 2 * cosine_coefficient(cosines(m, m), k);
      if (hz == 2 * n_hz) amplitude += slope_n * slope_n / 2 * cosine_coefficient(cosines(n, n), k);
      const double decay = kMotion.losses.decay_per_s(beta);
      const std::complex<double> response =
          k == 0 ? 0 : w0 * w0 / (w0 * w0 - w * w + std::complex(0.0, 2 * decay * w));
      sum += (k % 2 == 0 ? 1.0 : -1.0) * c * amplitude * (1.0 - response);
      // Holding the mean of two squares over a sample changes the drive of a mode by a part of (w^2/8 + w^2/24) dt^2,
      // and the mode is exact but for the force between samples, a part of w0^2 dt^2/12.
      error += std::abs(c * amplitude * response) * (w * w / 6 + w0 * w0 / 12) / (rate_hz * rate_hz);
    }
    return {sum, error};
  }
};

std::complex<double> amplitude_at(const std::vector<double>& sound, double hz, double rate_hz) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < sound.size(); ++i)
    sum += sound[i] * std::polar(1.0, -2 * pi * hz * static_cast<double>(i) / rate_hz);
  return 2.0 * sum / static_cast<double>(sound.size());
}

// Sums and differences of the frequencies of two modes, near and far from the first longitudinal mode at 1066 Hz and
// the second one, with the amplitudes and phases of driven oscillators. Nothing else sounds.
TEST(LongitudinalModes, ArePhantomPartials) {
  const double rate_hz = 192000;
  for (const auto& [m, n, m_hz, n_hz] : {std::tuple{7, 8, 470.0, 590.0}, std::tuple{1, 3, 60.0, 200.0},
                                         std::tuple{15, 17, 1010.0, 1130.0}, std::tuple{2, 4, 130.0, 280.0}}) {
    const TwoModes two{static_cast<std::size_t>(m), static_cast<std::size_t>(n), m_hz, n_hz, 3e-4, 2e-4};
    const auto force = two.force(rate_hz);
    double all = 0;
    for (const double hz : {m_hz + n_hz, n_hz - m_hz, 2 * m_hz, 2 * n_hz}) {
      const auto [expected, error] = two.expected(hz, rate_hz);
      const std::complex<double> found = amplitude_at(force, hz, rate_hz);
      EXPECT_GT(std::abs(expected), 1e-4) << hz;
      EXPECT_TRUE(within(std::abs(found - expected), 0, error + 1e-9)) << m << " " << n << " " << hz;
      Measured() << hz << " Hz: " << std::abs(found) << " N, error " << std::abs(found - expected);
      all += std::norm(found) / 2;
    }
    const double mean = amplitude_at(force, 0, rate_hz).real() / 2;
    double square = 0;
    for (const double f : force) square += (f - mean) * (f - mean) / static_cast<double>(force.size());
    EXPECT_TRUE(relatively_within(square, all, 1e-6));
  }
}

// A string that is bent and stands still has the same tension everywhere, also where modes are left out.
TEST(LongitudinalModes, EndAtTheTensionOfAStringAtRest) {
  const auto rows = rows_of(1, 2000);
  LongitudinalModes<double> modes(kString, kMotion, std::span<const Row>(rows), 44100);
  Displacements<double> displacements(rows.size());
  double stretch = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    displacements[i] = 1e-3 / static_cast<double>((i + 1) * (i + 1));
    stretch += std::pow(displacements[i] * rows[i].wavenumber_per_m, 2) / 2;
  }
  const double tension = (kMotion.axial_stiffness_n - kString.tension_n) / 2 * stretch;
  EXPECT_TRUE(relatively_within(modes.begin(displacements), tension, 1e-12));
  // A mode that begins without velocity is off its rest by a part of decay dt/3, less than 3e-4.
  EXPECT_TRUE(relatively_within(modes.tick(displacements), tension, 3e-4));
  displacements[3] *= 2;
  EXPECT_FALSE(relatively_within(modes.tick(displacements), tension, 1e-3));
  for (int n = 0; n < 60000; ++n) (void)modes.tick(displacements);
  const double grown = std::pow(displacements[3] * rows[3].wavenumber_per_m, 2) * 3 / 8;
  EXPECT_TRUE(relatively_within(modes.tick(displacements),
                                tension + (kMotion.axial_stiffness_n - kString.tension_n) / 2 * grown, 1e-10));
}

// Strings side by side pull like the sum of each alone.
TEST(LongitudinalModes, AddUpStrings) {
  const auto one = rows_of(1, 2000), two = rows_of(2, 2000);
  LongitudinalModes<double> together(kString, kMotion, std::span<const Row>(two), 44100);
  LongitudinalModes<double> first(kString, kMotion, std::span<const Row>(one), 44100), second = first;
  EXPECT_EQ(together.size(), first.size());
  EXPECT_EQ(together.driving_modes(), 2 * first.driving_modes());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> moved(-1e-4, 1e-4);
  for (int n = 0; n < 2000; ++n) {
    Displacements<double> of_first(one.size()), of_second(one.size()), of_both(two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      of_both[2 * i] = of_first[i] = moved(random);
      of_both[2 * i + 1] = of_second[i] = moved(random);
    }
    const double sum = first.tick(of_first) + second.tick(of_second), both = together.tick(of_both);
    ASSERT_TRUE(within(both, sum, 1e-9 * (1 + std::abs(sum)))) << n;
  }
}

// No product of two transverse modes folds, and no longitudinal mode lies above the limit.
TEST(LongitudinalModes, LeaveOutWhatWouldFold) {
  for (const double rate_hz : {8000.0, 22050.0, 44100.0, 96000.0}) {
    const auto rows = rows_of(1, rate_hz / 2);
    LongitudinalModes<double> modes(kString, kMotion, std::span<const Row>(rows), rate_hz);
    const double limit_hz = std::min(6000.0, rate_hz / 2);
    EXPECT_EQ(modes.driving_modes(), modes_below(kString, limit_hz / 2).size()) << rate_hz;
    const double first_hz = std::sqrt(kMotion.axial_stiffness_n / kString.mass_kg / kString.length_m) / 2;
    EXPECT_EQ(modes.size(), static_cast<std::size_t>(limit_hz / first_hz)) << rate_hz;
  }
}

template <typename T>
class LongitudinalModesIn : public ::testing::Test {};
TYPED_TEST_SUITE(LongitudinalModesIn, Precisions);

// Whatever the strings do: each square of a slope is held between -1 and 1, so the place of rest of a mode moves by
// at most 2 c for each sample. From there a mode is at Re Z, and free motion multiplies Z by z. A move by b adds b to
// Re Z, and b sinh(decay dt)/sin(w dt) to Im Z. So |Z| is at most the sum of a geometric series.
TYPED_TEST(LongitudinalModesIn, AreBoundedWhateverDrivesThem) {
  const double rate_hz = 44100, c = (kMotion.axial_stiffness_n - kString.tension_n) / 2;
  const auto rows = rows_of(3, rate_hz / 2);
  LongitudinalModes<TypeParam> modes(kString, kMotion, std::span<const Row>(rows), rate_hz);
  double bound = c;
  for (const auto& [w, decay, mass] : longitudinal_modes(kString, kMotion, 6000, 16))
    bound +=
        2 * c * std::hypot(1, std::sinh(decay / rate_hz) / std::sin(w / rate_hz)) / -std::expm1(-decay / rate_hz);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-30, 38), part(0, 1);
  Displacements<TypeParam> displacements(rows.size());
  double largest = 0;
  for (int n = 0; n < 20000; ++n) {
    const double size = std::pow(10, exponent(random)), what = part(random);
    for (std::size_t i = 0; i < rows.size(); ++i)
      displacements[i] = static_cast<TypeParam>(size * (part(random) - 0.5));
    if (what < 0.1) displacements[n % 20] = std::numeric_limits<TypeParam>::quiet_NaN();
    if (what > 0.9) displacements[n % 20] = std::numeric_limits<TypeParam>::infinity();
    const double force = double(modes.tick(displacements));
    ASSERT_TRUE(is_finite(force)) << n;
    largest = std::max(largest, std::abs(force));
  }
  EXPECT_LT(largest, bound);
  EXPECT_GT(largest, c);
  modes.reset();
  EXPECT_EQ(modes.tick(Displacements<TypeParam>(rows.size())), 0);
}

// The numbers of modes follow from their places in the rows. So nothing drives where the first modes of all strings,
// or of one of them, are overdamped.
TEST(LongitudinalModes, RestWhereAFirstModeIsOverdamped) {
  const auto modes_of = [](const std::vector<Row>& rows) {
    return LongitudinalModes<double>(kString, kMotion, std::span<const Row>(rows), 44100).driving_modes();
  };
  std::vector<Row> rows = rows_of(3, 2000);
  const std::size_t all = modes_of(rows);
  EXPECT_GT(all, 60u);
  EXPECT_EQ(modes_of({rows.begin() + 1, rows.end()}), 0u);
  EXPECT_EQ(modes_of({rows.begin() + 3, rows.end()}), 0u);
  StiffString damped = kString;
  damped.losses.constant_per_s = 500;  // mode 1 has 411 rad/s
  rows.clear();
  for (const StringMode& mode : modes_below(damped, 2000)) rows.push_back({mode.mode, mode.wavenumber_per_m});
  ASSERT_TRUE(relatively_within(rows.at(0).wavenumber_per_m, 2 * pi / kString.length_m, 1e-12));
  EXPECT_EQ(modes_of(rows), 0u);
  rows = rows_of(3, 2000);
  rows.pop_back();  // a mode that two strings have
  EXPECT_EQ(modes_of(rows), all - 3);
}

// A string too stiff to have a mode below the limit, and one whose losses leave none, still stretch.
TEST(LongitudinalModes, MayBeNone) {
  for (const LongitudinalMotion& motion :
       {LongitudinalMotion{1e9, {30, 0}, 1}, LongitudinalMotion{2e5, {1e5, 0}, 1}}) {
    const auto rows = rows_of(1, 2000);
    LongitudinalModes<double> modes(kString, motion, std::span<const Row>(rows), 44100);
    EXPECT_EQ(modes.size(), 0u);
    Displacements<double> displacements(rows.size());
    displacements[0] = 1e-3;
    EXPECT_TRUE(relatively_within(
        modes.tick(displacements),
        (motion.axial_stiffness_n - kString.tension_n) / 4 * std::pow(1e-3 * pi / kString.length_m, 2), 1e-12));
    // The square of the slope ends at 1, and keeps its last value where it is not a number.
    const double largest = (motion.axial_stiffness_n - kString.tension_n) / 2;
    displacements[0] = 1e3;
    EXPECT_EQ(modes.tick(displacements), largest);
    displacements[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(modes.tick(displacements), largest);
  }
}

}  // namespace
}  // namespace contactspline::testing
