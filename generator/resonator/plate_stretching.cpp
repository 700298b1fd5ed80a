// SPDX-License-Identifier: MIT
#include "generator/resonator/plate_stretching.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <span>
#include <utility>

#include "generator/resonator/form_terms.hpp"

namespace contactspline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using std::numbers::pi;

// Integrals of P(x, y) cos(n pi x/length) cos(m pi y/width) over a plate, in row n and column m, for a P whose
// integral of (laplacian P)^2 is the area of the plate.
using AiryFunction = MatrixXd;

// What free edges leave differs by rounding from machine to machine by up to 3e-10 of the largest term of a form.
constexpr int kRitzDigits = 9, kClosedFormDigits = 11;

struct Size {
  double length, width;
  Index along, across;  ///< the numbers n and m begin at 0 and end before these
};

// A polynomial of degree a + 2, by Legendre's: phi_a'' = P_a on -1 to 1, with phi and phi' 0 at both ends, a >= 2.
struct Legendre {
  // Of P_(a+2), P_a, P_(a-2) in phi_a, and of P_(a+1), P_(a-1) in phi_a'.
  static double term(int a, int of) {
    const double last = 2 * a - 1, here = 2 * a + 1, next = 2 * a + 3;
    if (of == a + 2) return 1 / (here * next);
    if (of == a) return -2 / (last * next);
    return of == a - 2 ? 1 / (here * last) : 0;
  }
  static double slope_term(int a, int of) {
    return of == a + 1 ? 1.0 / (2 * a + 1) : of == a - 1 ? -1.0 / (2 * a + 1) : 0;
  }
  // Integral of cos(n pi (t + 1)/2) phi_a(t): twice in parts, then that of a plane wave in spherical Bessel
  // functions.
  static double cosine(int a, int n) {
    if ((a + n) % 2 != 0) return 0;
    if (n == 0) return a == 2 ? 2.0 / 15 : 0;
    const double k = n * pi / 2;
    const double sign = (a + n) / 2 % 2 == 0 ? 1 : -1;
    return -2 * sign * boost::math::sph_bessel(static_cast<unsigned>(a), k) / (k * k);
  }
};

// One direction of a plate: polynomials a = first, first + 2, ... with the integrals of their products, of those of
// their slopes and of their second derivatives over 0 to length, and those with cosines.
struct Direction {
  Direction(int first, Index count, double length, Index cosine_count)
      : values(count, count), slopes(count, count), bends(count, count), cosines(count, cosine_count) {
    const double half = length / 2;
    for (Index i = 0; i < count; ++i) {
      const int a = first + 2 * static_cast<int>(i);
      for (Index j = 0; j < count; ++j) {
        const int b = first + 2 * static_cast<int>(j);
        double value = 0, slope = 0;
        for (int n = a - 2; n <= a + 2; ++n) {
          value += Legendre::term(a, n) * Legendre::term(b, n) * 2 / (2 * n + 1);
          slope += Legendre::slope_term(a, n) * Legendre::slope_term(b, n) * 2 / (2 * n + 1);
        }
        values(i, j) = half * value;
        slopes(i, j) = slope / half;
        bends(i, j) = i == j ? 2.0 / (2 * a + 1) / (half * half * half) : 0;
      }
      for (Index n = 0; n < cosine_count; ++n) cosines(i, n) = half * Legendre::cosine(a, static_cast<int>(n));
    }
  }
  MatrixXd values, slopes, bends, cosines;
};

MatrixXd kronecker(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd product(a.rows() * b.rows(), a.cols() * b.cols());
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = 0; j < a.cols(); ++j) product.block(i * b.rows(), j * b.cols(), b.rows(), b.cols()) = a(i, j) * b;
  return product;
}

struct RankedFunction {
  double inverse_square;  // 1/zeta^4
  std::size_t number;     // among those of equal zeta
  AiryFunction function;
};

// By falling 1/zeta^4. Those that differ by rounding only get the same, and stand by their numbers.
template <typename Ranked>
void rank(std::vector<Ranked>& functions) {
  constexpr double kAlike = 1e-9;
  std::ranges::sort(functions, std::ranges::greater(), &Ranked::inverse_square);
  for (std::size_t i = 1; i < functions.size(); ++i)
    if (const double last = functions[i - 1].inverse_square; functions[i].inverse_square > (1 - kAlike) * last)
      functions[i].inverse_square = last;
  std::ranges::sort(functions, {}, [](const Ranked& f) { return std::pair(-f.inverse_square, f.number); });
}

// Keeps at most `count`, without a part of those of equal zeta at the end.
template <typename Ranked>
void keep_whole(std::vector<Ranked>& functions, std::size_t count) {
  if (count >= functions.size()) return;
  while (count > 0 && functions[count - 1].inverse_square == functions[count].inverse_square) --count;
  functions.erase(functions.begin() + static_cast<std::ptrdiff_t>(count), functions.end());
}

// The clamped shapes of one symmetry.
void add_clamped_shapes(std::vector<RankedFunction>& to, const Direction& x, const Direction& y, double area) {
  const MatrixXd bending =
      kronecker(x.bends, y.values) + kronecker(x.values, y.bends) + 2 * kronecker(x.slopes, y.slopes);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(kronecker(x.values, y.values), bending);
  for (Index k = 0; k < bending.cols(); ++k) {
    const MatrixXd weights = std::sqrt(area) * Eigen::Map<const MatrixXd>(solver.eigenvectors().col(k).data(),
                                                                          y.values.rows(), x.values.rows());
    AiryFunction function = x.cosines.transpose() * weights.transpose() * y.cosines;
    // The sign by the first of the large ones, as two may be equally large.
    const double large = function.cwiseAbs().maxCoeff() / 2;
    const std::span<const double> all(function.data(), static_cast<std::size_t>(function.size()));
    const double first = *std::ranges::find_if(all, [&](double c) { return std::abs(c) > large; });
    to.push_back({solver.eigenvalues()[k], to.size(), function * (first < 0 ? -1 : 1)});
  }
}

// The `count` lowest shapes of a clamped plate, of a basis that resolves so many. By Weyl's law their highest
// wavenumber is sqrt(4 pi count/area); polynomials of one symmetry need a degree of a half of the phase and some.
std::vector<AiryFunction> of_free_edges(const Size& size, std::size_t count, std::size_t resolved) {
  const double area = size.length * size.width, highest = std::sqrt(4 * pi * static_cast<double>(resolved) / area);
  const auto count_along = [&](double length) { return static_cast<Index>(0.33 * highest * length) + 6; };
  std::vector<RankedFunction> found;
  for (const int odd_x : {0, 1})
    for (const int odd_y : {0, 1})
      add_clamped_shapes(found, Direction(2 + odd_x, count_along(size.length), size.length, size.along),
                         Direction(2 + odd_y, count_along(size.width), size.width, size.across), area);
  rank(found);
  keep_whole(found, count);
  std::vector<AiryFunction> functions;
  for (RankedFunction& ranked : found) functions.push_back(std::move(ranked.function));
  return functions;
}

// The `count` lowest products of cosines, of which these modes need no higher ones.
std::vector<AiryFunction> of_fixed_edges(const Size& size, std::size_t count) {
  struct Cosines {
    double inverse_square;  // 1/zeta^4
    std::size_t number;
    Index along, across;
  };
  const auto square_of = [&](Index i, Index j) {  // zeta^2
    return std::pow(static_cast<double>(i) * pi / size.length, 2) +
           std::pow(static_cast<double>(j) * pi / size.width, 2);
  };
  std::vector<Cosines> lowest;
  for (Index i = 0; i < size.along; ++i)
    for (Index j = i == 0 ? 1 : 0; j < size.across; ++j)
      lowest.push_back({std::pow(square_of(i, j), -2), lowest.size(), i, j});
  rank(lowest);
  keep_whole(lowest, count);
  std::vector<AiryFunction> functions;
  const double area = size.length * size.width;
  for (const auto& [inverse_square, number, i, j] : lowest) {
    const double mean = (i == 0 ? 1 : 0.5) * (j == 0 ? 1 : 0.5);  // of P^2
    AiryFunction& function = functions.emplace_back(AiryFunction::Zero(size.along, size.across));
    function(i, j) = area * std::sqrt(mean) / square_of(i, j);
  }
  return functions;
}

// The integral of P L(f, g) for two modes: products of sines and cosines are sums of two cosines.
double coupling(const AiryFunction& function, const Size& size, const PlateSine& f, const PlateSine& g) {
  const Index less_x = std::abs(f.along - g.along), more_x = f.along + g.along;
  const Index less_y = std::abs(f.across - g.across), more_y = f.across + g.across;
  const double alike = function(less_x, less_y) + function(more_x, more_y);
  const double other = function(less_x, more_y) + function(more_x, less_y);
  const double fx = f.along * pi / size.length, fy = f.across * pi / size.width;
  const double gx = g.along * pi / size.length, gy = g.across * pi / size.width;
  return (fx * fx * gy * gy + fy * fy * gx * gx) * (alike - other) / 4 - 2 * fx * fy * gx * gy * (alike + other) / 4;
}

constexpr std::size_t kEvenTensions = 2;

// The two even tensions between fixed edges, of e = mean of (w_x^2 + w_y^2)/2 and of the difference of the two.
std::vector<StretchForm> of_even_tensions(const Plate& plate, std::span<const PlateSine> modes) {
  const double stiffness = plate.youngs_modulus_pa * plate.thickness_m * plate.length_m * plate.width_m / 64;
  std::vector<StretchForm> forms = {{stiffness / (1 - plate.poisson_ratio), {}},
                                    {stiffness / (1 + plate.poisson_ratio), {}}};
  for (const auto& [along, across] : modes) {
    const double x = std::pow(along * pi / plate.length_m, 2), y = std::pow(across * pi / plate.width_m, 2);
    forms[0].squares_per_m2.push_back(x + y);
    forms[1].squares_per_m2.push_back(x - y);
  }
  return forms;
}

StretchForm form_of(const AiryFunction& function, const Size& size, double stiffness_j,
                    std::span<const PlateSine> modes, int digits) {
  const double area = size.length * size.width;
  StretchForm form{stiffness_j, {}};
  for (std::size_t p = 0; p < modes.size(); ++p) {
    form.squares_per_m2.push_back(coupling(function, size, modes[p], modes[p]) / area);
    for (std::size_t q = 0; q < p; ++q)
      if (const double product = coupling(function, size, modes[p], modes[q]); product != 0)
        form.products.push_back({q, p, product / area});
  }
  round_terms(form, digits);
  return form;
}

Size size_of(const Plate& plate, std::span<const PlateSine> modes) {
  Size size{plate.length_m, plate.width_m, 0, 0};
  for (const auto& [along, across] : modes) {
    size.along = std::max<Index>(size.along, 2 * along + 1);
    size.across = std::max<Index>(size.across, 2 * across + 1);
  }
  return size;
}

// Those that `count` forms have beside the even tensions.
std::vector<AiryFunction> functions_of(const Size& size, PlateEdges edges, std::size_t count, std::size_t resolved) {
  if (edges == PlateEdges::kFree) return of_free_edges(size, count, resolved);
  return of_fixed_edges(size, count - std::min(count, kEvenTensions));
}

std::vector<StretchForm> forms_of(const Plate& plate, PlateEdges edges, std::span<const PlateSine> modes,
                                  std::size_t count, std::size_t resolved) {
  const Size size = size_of(plate, modes);
  const int digits = edges == PlateEdges::kFixed ? kClosedFormDigits : kRitzDigits;
  std::vector<StretchForm> forms;
  if (edges == PlateEdges::kFixed) forms = of_even_tensions(plate, modes);
  if (forms.size() > count) forms.resize(count);
  const double stiffness = plate.youngs_modulus_pa * plate.thickness_m * size.length * size.width / 2;
  for (const AiryFunction& function : functions_of(size, edges, count, resolved))
    forms.push_back(form_of(function, size, stiffness, modes, digits));
  return forms;
}

// By rising frequency.
std::vector<PlateSine> lowest_modes(const Plate& plate, std::size_t count) {
  const auto square = [&](const PlateSine& mode) {
    return std::pow(mode.along / plate.length_m, 2) + std::pow(mode.across / plate.width_m, 2);
  };
  std::vector<PlateSine> modes;
  for (int along = 1; along <= static_cast<int>(count); ++along)
    for (int across = 1; along * across <= static_cast<int>(count); ++across) modes.push_back({along, across});
  std::ranges::stable_sort(modes, {}, square);
  modes.resize(count);
  return modes;
}

}  // namespace

std::vector<StretchForm> stretch_forms(const Plate& plate, PlateEdges edges, std::span<const PlateSine> modes,
                                       std::size_t count) {
  return forms_of(plate, edges, modes, count, count);
}

std::size_t form_count(const Plate& plate, PlateEdges edges, std::size_t modes, std::size_t count) {
  const std::size_t tensions = edges == PlateEdges::kFixed ? std::min(count, kEvenTensions) : 0;
  return tensions + functions_of(size_of(plate, lowest_modes(plate, modes)), edges, count, count).size();
}

double kept_of_stretching(const Plate& plate, PlateEdges edges, std::size_t modes, std::size_t count) {
  constexpr std::size_t kAll = 4000, kResolved = 100;
  const auto forms = forms_of(plate, edges, lowest_modes(plate, modes), kAll, std::max(kResolved, count));
  return least_share(forms, form_count(plate, edges, modes, count));
}

}  // namespace contactspline
