// SPDX-License-Identifier: MIT
// Circular plates: frequencies of tables, shapes by Rayleigh's quotient, and the energy of stretching against
// polynomial Airy functions.
#include "generator/resonator/round_plate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "form_energy.hpp"
#include "generator/resonator/quadrature.hpp"
#include "generator/resonator/resonator.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kModulus = 1.1e11, kPoisson = 0.33, kRadius = 0.15, kThickness = 1.2e-3, kDensity = 8700;

RoundPlate plate_with(PlateRim rim) {
  return {kRadius, kThickness, kDensity, kModulus, kPoisson, {1, 0}, rim};
}

double square_root_of(PlateRim rim, int order, int i) {
  return std::pow(undamped_mode(plate_with(rim), order, i).wavenumber_per_m * kRadius, 2);
}

struct TableRow {
  int order;
  double squares[3];  // (beta R)^2
};

// A. W. Leissa, Vibration of Plates, NASA SP-160, 1969, tables 2.1 (clamped) and 2.5 (free, Poisson's ratio 0.33).
// The second has three or four digits.
TEST(RoundPlate, FrequenciesAreThoseOfTables) {
  const TableRow clamped[] = {
      {0, {10.2158, 39.771, 89.104}}, {1, {21.26, 60.82, 120.08}}, {2, {34.88, 84.58, 153.81}}};
  for (const auto& [order, squares] : clamped)
    for (int i = 1; i <= 3; ++i)
      EXPECT_TRUE(within(square_root_of(PlateRim::kClamped, order, i), squares[i - 1], 0.01)) << order << ' ' << i;
  const TableRow free[] = {{0, {9.084, 38.55, 87.80}}, {1, {20.52, 59.86, 119.0}}, {2, {5.253, 35.25, 84.38}}};
  for (const auto& [order, squares] : free)
    for (int i = 1; i <= 3; ++i)
      EXPECT_TRUE(within(square_root_of(PlateRim::kFree, order, i), squares[i - 1], 2e-3 * squares[i - 1]))
          << order << ' ' << i;
}

// As many modes as are asked for, and the lowest: all roots below one that is twice as far are sought for comparison.
TEST(RoundPlate, FindsTheLowestModes) {
  for (const PlateRim rim : {PlateRim::kFree, PlateRim::kClamped})
    for (const int count : {1, 2, 3, 10, 100, 1000}) {
      const Resonator plate{"plate", "", plate_with(rim), {}, {}, count};
      const auto [modes, cut] = numbered_modes_of(plate, 1e9);
      ASSERT_EQ(modes.size(), static_cast<std::size_t>(count));
      EXPECT_TRUE(cut);
      const double last = modes.back().wavenumber_per_m * kRadius;
      int below = 0;
      for (int order = 0; order < 2 * last + 4; ++order)
        for (int i = 1; undamped_mode(plate_with(rim), order, i).wavenumber_per_m * kRadius <= last; ++i) ++below;
      EXPECT_EQ(below, count);
    }
}

// A displacement of the plate, whose derivatives are found by differences in Cartesian coordinates.
class Displacement {
 public:
  Displacement(PlateRim rim, std::vector<RoundPlateMode> modes, std::vector<double> amounts)
      : plate_(plate_with(rim)), modes_(std::move(modes)), amounts_(std::move(amounts)) {}

  [[nodiscard]] double at(double x, double y) const {
    double sum = 0;
    for (std::size_t i = 0; i < modes_.size(); ++i)
      sum += amounts_[i] * radial_shape(plate_, modes_[i].order, modes_[i].wavenumber_per_m, std::hypot(x, y)) *
             angular_shape({{}, 0, modes_[i].order, 1, modes_[i].is_sine}, std::atan2(y, x));
    return sum;
  }
  struct Curvatures {
    double xx, yy, xy;
  };
  // Errors: (h beta)^2/12 of the largest curvature, and rounding, 1e-8.
  [[nodiscard]] Curvatures curvatures(double x, double y) const {
    constexpr double h = 2e-4 * kRadius;
    const double middle = at(x, y);
    return {(at(x + h, y) - 2 * middle + at(x - h, y)) / (h * h),
            (at(x, y + h) - 2 * middle + at(x, y - h)) / (h * h),
            (at(x + h, y + h) - at(x + h, y - h) - at(x - h, y + h) + at(x - h, y - h)) / (4 * h * h)};
  }

 private:
  RoundPlate plate_;
  std::vector<RoundPlateMode> modes_;
  std::vector<double> amounts_;
};

// use(x, y, area) at points of the plate, equal steps around and Gauss's along the radius.
template <typename Use>
void over_plate(int steps, Use use) {
  const QuadratureRule rule = gauss_rule(kRadius, 30);
  for (std::size_t p = 0; p < rule.points.size(); ++p)
    for (int i = 0; i < steps; ++i) {
      const double r = rule.points[p], angle = 2 * kPi * (i + 0.5) / steps;
      use(r * std::cos(angle), r * std::sin(angle), rule.weights[p] * r * 2 * kPi / steps);
    }
}

// beta^4 = [integral of (w_xx + w_yy)^2 - 2 (1 - nu) (w_xx w_yy - w_xy^2)]/integral of w^2: true of a mode with this
// rim alone, and it fixes the mass as well.
TEST(RoundPlate, ShapesHaveTheEnergyOfTheirFrequencies) {
  for (const PlateRim rim : {PlateRim::kFree, PlateRim::kClamped})
    for (const int order : {0, 1, 2, 5})
      for (const int i : {1, 3}) {
        const UndampedMode mode = undamped_mode(plate_with(rim), order, i);
        const Displacement w(rim, {{order, mode.wavenumber_per_m}}, {1});
        double bending = 0, square = 0;
        over_plate(24, [&](double x, double y, double area) {
          const auto [xx, yy, xy] = w.curvatures(x, y);
          bending += area * (std::pow(xx + yy, 2) - 2 * (1 - kPoisson) * (xx * yy - xy * xy));
          square += area * std::pow(w.at(x, y), 2);
        });
        EXPECT_TRUE(within(std::pow(bending / square, 0.25), mode.wavenumber_per_m, 1e-5 * mode.wavenumber_per_m))
            << order << ' ' << i;
        EXPECT_TRUE(within(kDensity * kThickness * square, mode.mass_kg, 1e-9 * mode.mass_kg)) << order << ' ' << i;
      }
}

// r^(order + 2 j) (R^2 - r^2)^2 cos(order angle) or sin(order angle), for r in parts of R, its Laplacian and its
// value.
struct Polynomial {
  int order, power;
  bool is_sine;
  [[nodiscard]] double value(double r, double angle) const {
    return std::pow(r, power) * std::pow(1 - r * r, 2) * around(angle);
  }
  [[nodiscard]] double laplacian(double r, double angle) const {
    const auto term = [&](int n) { return (n * n - order * order) * std::pow(r, n - 2); };
    return (term(power) - 2 * term(power + 2) + term(power + 4)) * around(angle);
  }
  [[nodiscard]] double around(double angle) const {
    return is_sine ? std::sin(order * angle) : std::cos(order * angle);
  }
};

// The stress function F minimises the integral of (laplacian F)^2/2 + F E L(w, w)/2; the least value is minus the
// energy over thickness and modulus. Among polynomials, which are complete, too.
double energy_by_polynomials(const Displacement& w, bool has_sines = false) {
  std::vector<Polynomial> basis;
  for (int order = 0; order <= 10; ++order)
    for (int j = 0; j < 9; ++j) {
      basis.push_back({order, order + 2 * j, false});
      if (has_sines && order > 0) basis.push_back({order, order + 2 * j, true});
    }
  const auto size = static_cast<Eigen::Index>(basis.size());
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(size), laplacians(size), values(size);
  over_plate(48, [&](double x, double y, double area) {
    const auto [xx, yy, xy] = w.curvatures(x, y);
    const double r = std::hypot(x, y) / kRadius, angle = std::atan2(y, x), bent = 2 * (xx * yy - xy * xy);
    for (Eigen::Index k = 0; k < size; ++k) {
      laplacians[k] = basis[static_cast<std::size_t>(k)].laplacian(r, angle) / (kRadius * kRadius);
      values[k] = basis[static_cast<std::size_t>(k)].value(r, angle);
    }
    stiffness += area * laplacians * laplacians.transpose();
    load += area * bent / 2 * values;
  });
  // Scaled to ones on the diagonal: the powers differ by orders of magnitude.
  const Eigen::VectorXd scale = stiffness.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
  const Eigen::VectorXd right = scale.asDiagonal() * load;
  return kModulus * kThickness / 2 * right.dot(scaled.colPivHouseholderQr().solve(right));
}

// The differences are those of the curvatures, (h beta)^2/12 with h beta up to 2e-3, and the Airy functions above the
// 400 lowest.
TEST(RoundPlate, StretchesWithTheEnergyOfPolynomialStressFunctions) {
  for (const PlateRim rim : {PlateRim::kFree, PlateRim::kClamped}) {
    const RoundPlate plate = plate_with(rim);
    std::vector<RoundPlateMode> modes;
    for (const auto& [order, i] : {std::pair{2, 1}, {0, 1}, {3, 1}, {1, 1}, {4, 1}})
      modes.push_back({order, undamped_mode(plate, order, i).wavenumber_per_m});
    const std::vector<StretchForm> forms = stretch_forms(plate, modes, 400);
    const std::vector<std::vector<double>> motions = {
        {1e-3, 0, 0, 0, 0}, {0, 1e-3, 0, 0, 0}, {0, 0, 0, 1e-3, 0}, {1e-3, -7e-4, 4e-4, 5e-4, -3e-4}};
    for (const std::vector<double>& q : motions) {
      const double expected = energy_by_polynomials({rim, modes, q}), actual = energy_of(forms, q);
      Measured() << "energy of stretching " << actual << " J, by polynomials " << expected << " J, "
                 << (1 - actual / expected) << " less";
      EXPECT_TRUE(within(actual, expected, 2e-6 * expected));
    }
  }
}

// Modes of both symmetries, which have no diameter in common.
TEST(RoundPlate, StretchesInBothSymmetriesWithTheEnergyOfPolynomialStressFunctions) {
  RoundPlate plate = plate_with(PlateRim::kFree);
  plate.has_both_symmetries = true;
  std::vector<RoundPlateMode> modes;
  for (const auto& [order, is_sine] : {std::pair{2, false}, {2, true}, {0, false}, {3, true}, {1, false}})
    modes.push_back({order, undamped_mode(plate, order, 1).wavenumber_per_m, is_sine});
  const std::vector<double> q = {1e-3, -7e-4, 4e-4, 5e-4, -3e-4};
  const double expected = energy_by_polynomials({plate.rim, modes, q}, true);
  const double actual = energy_of(stretch_forms(plate, modes, 700), q);
  Measured() << "energy of both symmetries " << actual << " J, by polynomials " << (1 - actual / expected) << " less";
  EXPECT_TRUE(within(actual, expected, 2e-6 * expected));
}

// A plate has no first diameter: turned by any angle it stores the same, by Airy functions whose pairs are whole.
TEST(RoundPlate, StretchesAlikeAtAnyAngle) {
  RoundPlate plate = plate_with(PlateRim::kFree);
  plate.has_both_symmetries = true;
  const auto modes = numbered_modes_of({"plate", "", plate, {}, {}, 40}, 1e6).modes;
  EXPECT_EQ(std::ranges::count(modes, true, &NumberedMode::is_sine),
            std::ranges::count_if(modes, [](const NumberedMode& mode) { return !mode.is_sine && mode.row > 0; }));
  std::vector<RoundPlateMode> of_forms;
  for (const NumberedMode& mode : modes) of_forms.push_back({mode.row, mode.wavenumber_per_m, mode.is_sine});
  for (const std::size_t count : {1, 2, 3, 8, 20, 33}) {
    const std::vector<StretchForm> forms = stretch_forms(plate, of_forms, count);
    EXPECT_EQ(forms.size(), form_count(plate, count));
    EXPECT_LE(forms.size(), count);
    EXPECT_GE(forms.size() + 1, count);
    const auto turned_by = [&](double angle) {
      std::vector<double> q;
      for (const NumberedMode& mode : modes)
        q.push_back(1e-3 / double(mode.number + mode.row) * angular_shape(mode, 0.3 + double(mode.number) + angle));
      return energy_of(forms, q);
    };
    for (const double angle : {0.1, 1.0, 2.5}) EXPECT_TRUE(relatively_within(turned_by(angle), turned_by(0), 1e-9));
  }
}

// More functions hold more, and all of them everything.
TEST(RoundPlate, SaysHowMuchItsAiryFunctionsHold) {
  const RoundPlate plate = plate_with(PlateRim::kFree);
  double last = 0;
  for (const std::size_t count : {1, 5, 20, 64, 400}) {
    const double kept = kept_of_stretching(plate, 10, count);
    Measured() << count << " Airy functions hold " << kept;
    EXPECT_GE(kept, last);
    last = kept;
  }
  EXPECT_EQ(last, 1);
}

// With both symmetries 8 functions are 5 cosines and 3 sines, and 400 have half as many cosines as without.
TEST(RoundPlate, HoldsWithBothSymmetriesWhatItsCosinesHold) {
  const RoundPlate plate = plate_with(PlateRim::kFree);
  RoundPlate both = plate;
  both.has_both_symmetries = true;
  EXPECT_EQ(kept_of_stretching(both, 10, 8), kept_of_stretching(plate, 10, 5));
  EXPECT_LT(kept_of_stretching(both, 10, 400), 1);
}

}  // namespace
}  // namespace contactspline::testing
