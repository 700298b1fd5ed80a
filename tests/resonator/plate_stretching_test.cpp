// SPDX-License-Identifier: MIT
// Rectangular plates that stretch: the energy of their forms against displacements in the plane and against
// polynomial Airy functions, and the published rise of frequency with amplitude.
#include "generator/resonator/plate_stretching.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <vector>

#include "contactspline/modal/stretching_bank.hpp"
#include "form_energy.hpp"
#include "generator/resonator/quadrature.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using Eigen::Index;

constexpr double kPi = std::numbers::pi;
constexpr double kModulus = 2e11, kPoisson = 0.3, kThickness = 1e-3, kDensity = 7800;

Plate plate_of(double length, double width) {
  return {length, width, kThickness, kDensity, kModulus, kModulus, kModulus / (2 * (1 + kPoisson)), kPoisson, {0, 0}};
}

// A displacement, and what the equations of a plate need of it.
struct Motion {
  const Plate& plate;
  std::vector<PlateSine> modes;
  std::vector<double> amounts;

  struct Derivatives {
    double x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  };
  [[nodiscard]] Derivatives at(double x, double y) const {
    Derivatives sum;
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const double kx = modes[i].along * kPi / plate.length_m, ky = modes[i].across * kPi / plate.width_m;
      const double q = amounts[i], sx = std::sin(kx * x), cx = std::cos(kx * x), sy = std::sin(ky * y),
                   cy = std::cos(ky * y);
      sum.x += q * kx * cx * sy;
      sum.y += q * ky * sx * cy;
      sum.xx -= q * kx * kx * sx * sy;
      sum.yy -= q * ky * ky * sx * sy;
      sum.xy += q * kx * ky * cx * cy;
    }
    return sum;
  }
};

template <typename Use>
void over_plate(const Plate& plate, Use use) {
  const QuadratureRule along = gauss_rule(plate.length_m, 100), across = gauss_rule(plate.width_m, 100);
  for (std::size_t i = 0; i < along.points.size(); ++i)
    for (std::size_t j = 0; j < across.points.size(); ++j)
      use(along.points[i], across.points[j], along.weights[i] * across.weights[j]);
}

// The least energy over the displacements in the plane, without stress functions: u = sum of sin(i pi x/length) cos(j
// pi y/width) and v likewise keep the edges at their distance and let them slide, and hold all that these modes need.
double energy_by_displacements(const Motion& w, int highest) {
  const auto side = static_cast<Index>(highest) + 1, size = 2 * side * side;
  Eigen::MatrixXd stiffness = 1e-9 * Eigen::MatrixXd::Identity(size, size);  // of what is 0 everywhere
  Eigen::VectorXd load = Eigen::VectorXd::Zero(size), along(size), across(size), shear(size);
  double alone = 0;
  over_plate(w.plate, [&](double x, double y, double area) {
    const auto slopes = w.at(x, y);
    const double e_x = slopes.x * slopes.x / 2, e_y = slopes.y * slopes.y / 2, g = slopes.x * slopes.y;
    along.setZero(), across.setZero();
    for (Index i = 0; i < side; ++i)
      for (Index j = 0; j < side; ++j) {
        const double kx = static_cast<double>(i) * kPi / w.plate.length_m,
                     ky = static_cast<double>(j) * kPi / w.plate.width_m;
        const Index u = i * side + j, v = u + side * side;
        along[u] = kx * std::cos(kx * x) * std::cos(ky * y);
        shear[u] = -ky * std::sin(kx * x) * std::sin(ky * y);
        across[v] = ky * std::cos(kx * x) * std::cos(ky * y);
        shear[v] = -kx * std::sin(kx * x) * std::sin(ky * y);
      }
    const double half = (1 - kPoisson) / 2;
    stiffness += area * (along * along.transpose() + across * across.transpose() +
                         kPoisson * (along * across.transpose() + across * along.transpose()) +
                         half * shear * shear.transpose());
    load += area * ((e_x + kPoisson * e_y) * along + (e_y + kPoisson * e_x) * across + half * g * shear);
    alone += area * (e_x * e_x + e_y * e_y + 2 * kPoisson * e_x * e_y + half * g * g);
  });
  const double least = alone - load.dot(stiffness.ldlt().solve(load));
  return kModulus * kThickness / (2 * (1 - kPoisson * kPoisson)) * least;
}

// The same by stress functions (x (length - x) y (width - y))^2 times polynomials, which leave the edges free.
double energy_by_polynomials(const Motion& w, int degree) {
  const auto side = static_cast<Index>(degree), size = side * side;
  const auto bases = [&](double at, double length) {  // value and second derivative of (1 - t^2)^2 P_n(t)
    const double t = 2 * at / length - 1, c = 1 - t * t;
    std::vector<std::array<double, 2>> all;
    double last = 0, now = 1, slope_last = 0, slope = 0, bend_last = 0, bend = 0;
    for (Index n = 0; n < side; ++n) {
      all.push_back(
          {c * c * now, (c * c * bend - 8 * t * c * slope + (12 * t * t - 4) * now) * 4 / (length * length)});
      const auto next = [&](double a, double b) { return (double(2 * n + 1) * a - double(n) * b) / double(n + 1); };
      const double value = next(t * now, last), first = next(now + t * slope, slope_last),
                   second = next(2 * slope + t * bend, bend_last);
      last = now, slope_last = slope, bend_last = bend;
      now = value, slope = first, bend = second;
    }
    return all;
  };
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(size), values(size), laplacians(size);
  over_plate(w.plate, [&](double x, double y, double area) {
    const auto along = bases(x, w.plate.length_m), across = bases(y, w.plate.width_m);
    const auto [sx, sy, xx, yy, xy] = w.at(x, y);
    for (Index i = 0; i < side; ++i)
      for (Index j = 0; j < side; ++j) {
        const auto [f, f_bent] = along[static_cast<std::size_t>(i)];
        const auto [g, g_bent] = across[static_cast<std::size_t>(j)];
        values[i * side + j] = f * g;
        laplacians[i * side + j] = f_bent * g + f * g_bent;
      }
    stiffness += area * laplacians * laplacians.transpose();
    load += area * (xx * yy - xy * xy) * values;
  });
  return kModulus * kThickness / 2 * load.dot(stiffness.ldlt().solve(load));
}

const std::vector<PlateSine> kModes = {{1, 1}, {2, 1}, {1, 2}, {3, 1}, {2, 2}};
const std::vector<std::vector<double>> kMotions = {
    {1e-3, 0, 0, 0, 0}, {0, 0, 1e-3, 0, 0}, {0, 0, 0, 1e-3, 0}, {1e-3, -7e-4, 4e-4, 5e-4, -3e-4}};

TEST(PlateStretching, BetweenFixedEdgesHasTheLeastEnergyOfDisplacements) {
  const Plate plate = plate_of(0.4, 0.3);
  const auto forms = stretch_forms(plate, PlateEdges::kFixed, kModes, 100);
  EXPECT_LT(forms.size(), 50U) << "no more cosines than the modes need";
  for (const auto& q : kMotions) {
    const double actual = energy_of(forms, q), expected = energy_by_displacements({plate, kModes, q}, 6);
    Measured() << "energy " << actual << " J, by displacements in the plane " << (1 - actual / expected) << " less";
    EXPECT_TRUE(relatively_within(actual, expected, 1e-9));
  }
}

// Polynomials hold all but 1e-6. What the Airy functions above the lowest leave out falls with the square of their
// number, to 8e-5 above 200.
TEST(PlateStretching, WithFreeEdgesHasTheEnergyOfPolynomialStressFunctions) {
  for (const double width : {0.4, 0.15}) {
    const Plate plate = plate_of(0.4, width);
    const auto few = stretch_forms(plate, PlateEdges::kFree, kModes, 50),
               many = stretch_forms(plate, PlateEdges::kFree, kModes, 200);
    for (const auto& q : kMotions) {
      const double expected = energy_by_polynomials({plate, kModes, q}, 14);
      const double less = 1 - energy_of(many, q) / expected, fewer_less = 1 - energy_of(few, q) / expected;
      Measured() << width << " m wide: " << less << " less than " << expected << " J by polynomials";
      EXPECT_TRUE(within(less, 4e-5, 4e-5));
      EXPECT_GT(fewer_less / less, 16);
    }
  }
}

// Frequency of the lowest mode of a square plate, in parts of that of small motion, at an amplitude in parts of the
// thickness: from rest, counted over 100 periods.
double frequency_ratio(double amplitude) {
  constexpr double kRate = 192000;
  constexpr int kPeriods = 100;
  const Plate plate = plate_of(0.3, 0.3);
  const auto stiffness = bending_stiffness(plate).along;
  const double w0 = 2 * std::pow(kPi / 0.3, 2) * std::sqrt(stiffness / (kDensity * kThickness));
  const std::vector<Mode> modes{{w0, 0, kDensity * kThickness * 0.09 / 4}};
  const std::vector<PlateSine> sines{{1, 1}};
  StretchingBank<double> bank(modes, stretch_forms(plate, PlateEdges::kFixed, sines, 9), kRate);
  bank.set_motion(0, amplitude * kThickness, 0);
  double first = 0, last = bank.displacement(std::size_t{0});
  for (int n = 1, crossings = 0;; ++n) {
    bank.predict();
    bank.commit();
    const double now = bank.displacement(std::size_t{0});
    if (last < 0 && now >= 0) {
      const double at = n - now / (now - last);
      if (crossings == 0) first = at;
      if (crossings++ == kPeriods) return kPeriods * kRate / (at - first) * 2 * kPi / w0;
    }
    last = now;
  }
}

// H. N. Chu and G. Herrmann, J. Applied Mechanics 23, 1956, Poisson's ratio 0.3, four decimals.
TEST(PlateStretching, RaisesTheFrequencyAsPublished) {
  for (const auto& [amplitude, published] :
       {std::pair{0.2, 1.0195}, {0.4, 1.0757}, {0.6, 1.1625}, {0.8, 1.2734}, {1.0, 1.4024}}) {
    const double found = frequency_ratio(amplitude);
    Measured() << "at " << amplitude << " thicknesses " << found << " times the frequency, published " << published;
    EXPECT_TRUE(within(found, published, 6e-5));
  }
}

// More functions hold more. With fixed edges nine hold all that one mode needs.
TEST(PlateStretching, SaysHowMuchItsAiryFunctionsHold) {
  const Plate plate = plate_of(0.4, 0.3);
  for (const PlateEdges edges : {PlateEdges::kFree, PlateEdges::kFixed}) {
    double last = 0;
    for (const std::size_t count : {1, 2, 4, 16, 64}) {
      const double kept = kept_of_stretching(plate, edges, 10, count);
      Measured() << count << " Airy functions hold " << kept;
      EXPECT_GE(kept, last);
      last = kept;
    }
    EXPECT_GT(last, 0.99);
  }
  EXPECT_EQ(kept_of_stretching(plate, PlateEdges::kFixed, 1, 9), 1);
}

// The mode sin(pi x/length) sin(pi y/width) alone between fixed edges, with X = 1/length^2 and Y = 1/width^2: the two
// tensions hold E h (pi q)^4 length width/256 times T = (X + Y)^2/(1 - nu) + (X - Y)^2/(1 + nu), and the cosines of 2
// pi x/length and of 2 pi y/width the same times X^2 + Y^2.
TEST(PlateStretching, HoldsInItsTensionsTheShareOfTheClosedForm) {
  for (const double width : {0.4, 0.3, 0.1}) {
    const double x = 1 / (0.4 * 0.4), y = 1 / (width * width);
    const double tensions = std::pow(x + y, 2) / (1 - kPoisson) + std::pow(x - y, 2) / (1 + kPoisson);
    const double kept = kept_of_stretching(plate_of(0.4, width), PlateEdges::kFixed, 1, 2);
    Measured() << width << " m wide: two tensions hold " << kept;
    EXPECT_TRUE(relatively_within(kept, tensions / (tensions + x * x + y * y), 1e-10));
  }
}

std::vector<PlateSine> exchanged(std::vector<PlateSine> modes) {
  for (auto& [along, across] : modes) std::swap(along, across);
  return modes;
}

// A square plate has no first side: with length and width exchanged a motion stores the same, by any number of Airy
// functions, as pairs of them are whole.
TEST(PlateStretching, OnASquareIsTheSameAlongBothSides) {
  const Plate plate = plate_of(0.3, 0.3);
  for (const PlateEdges edges : {PlateEdges::kFree, PlateEdges::kFixed})
    for (std::size_t count = 1; count <= 40; ++count) {
      const auto forms = stretch_forms(plate, edges, kModes, count);
      EXPECT_LE(forms.size(), count);
      if (edges == PlateEdges::kFree) {
        EXPECT_GE(forms.size() + 1, count);
        EXPECT_EQ(forms.size(), form_count(plate, edges, kModes.size(), count));
      }
      const auto mirrored = stretch_forms(plate, edges, exchanged(kModes), count);
      ASSERT_EQ(mirrored.size(), forms.size());
      for (const auto& q : kMotions)
        EXPECT_TRUE(relatively_within(energy_of(mirrored, q), energy_of(forms, q), 1e-8)) << count << " functions";
    }
}

std::vector<double> terms_of(const StretchForm& form, std::size_t modes) {
  std::vector<double> terms(modes * modes);
  for (std::size_t i = 0; i < modes; ++i) terms[i * modes + i] = form.squares_per_m2[i];
  for (const auto& [first, second, factor] : form.products) terms[first * modes + second] = factor;
  return terms;
}

// With length and width exchanged only rounding differs, so that the last digit may, of 1e-8 of the largest or less.
TEST(PlateStretching, FindsTheSameFormsWithItsSidesExchanged) {
  double worst = 0;
  std::vector<PlateSine> modes;
  for (int i = 0; i < 64; ++i) modes.push_back({1 + i / 8, 1 + i % 8});
  for (const auto& [length, width] : {std::pair{0.4, 0.3}, {0.5, 0.15}, {0.31, 0.3}, {2.0, 0.1}}) {
    const auto forms = stretch_forms(plate_of(length, width), PlateEdges::kFree, modes, 128);
    const auto others = stretch_forms(plate_of(width, length), PlateEdges::kFree, exchanged(modes), 128);
    ASSERT_EQ(forms.size(), others.size());
    for (std::size_t k = 0; k < forms.size(); ++k) {
      const auto terms = terms_of(forms[k], modes.size()), same = terms_of(others[k], modes.size());
      double largest = 0, product = 0;
      for (std::size_t i = 0; i < terms.size(); ++i) {
        largest = std::max(largest, std::abs(terms[i]));
        product += terms[i] * same[i];
      }
      for (std::size_t i = 0; i < terms.size(); ++i)
        worst = std::max(worst, std::abs(terms[i] - std::copysign(same[i], same[i] * product)) / largest);
    }
  }
  Measured() << "terms of forms differ by up to " << worst << " of the largest";
  EXPECT_LT(worst, 1.01e-8);
}

}  // namespace
}  // namespace contactspline::testing
