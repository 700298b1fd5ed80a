// SPDX-License-Identifier: MIT
#include "generator/resonator/ribbed_plate.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "generator/resonator/quadrature.hpp"

namespace contactspline {
namespace {

using std::numbers::pi;

/// A rib as a line of length l from (x, y) in the direction (cx, cy).
struct Line {
  explicit Line(const Rib& rib)
      : x(rib.from_m),
        y(rib.from_across_m),
        length_m(std::hypot(rib.to_m - rib.from_m, rib.to_across_m - rib.from_across_m)),
        cx((rib.to_m - rib.from_m) / length_m),
        cy((rib.to_across_m - rib.from_across_m) / length_m) {}
  double x, y, length_m, cx, cy;
};

struct Wavenumbers {
  double x, y;
};

Wavenumbers wavenumbers_of(const Plate& plate, const PlateSine& sine) {
  return {sine.along * pi / plate.length_m, sine.across * pi / plate.width_m};
}

/// Stiffness and mass of a sine without ribs: w0^2 is their ratio.
struct Oscillator {
  double stiffness_n_per_m, mass_kg;
};

Oscillator bare(const Plate& plate, const PlateSine& sine) {
  const auto [kx, ky] = wavenumbers_of(plate, sine);
  const auto [along, across, mixed] = bending_stiffness(plate);
  const double x = kx * kx, y = ky * ky, area = plate.length_m * plate.width_m / 4;
  return {(along * x * x + 2 * mixed * x * y + across * y * y) * area,
          plate.density_kg_m3 * plate.thickness_m * area};
}

// As if the ribs were spread evenly over the plate, each in its direction.
Oscillator with_spread_ribs(const Plate& plate, const std::vector<Rib>& ribs, const PlateSine& sine) {
  Oscillator all = bare(plate, sine);
  const auto [kx, ky] = wavenumbers_of(plate, sine);
  for (const Rib& rib : ribs) {
    const Line line(rib);
    const double straight = std::pow(line.cx * kx, 2) + std::pow(line.cy * ky, 2),
                 turned = 2 * line.cx * line.cy * kx * ky;
    all.stiffness_n_per_m += rib.bending_stiffness_n_m2 * line.length_m * (straight * straight + turned * turned) / 4;
    all.mass_kg += rib.mass_per_length_kg_m * line.length_m / 4;
  }
  return all;
}

// The sines with the lowest frequencies under ribs that are spread evenly. These frequencies rise with both numbers,
// so the product of the numbers is at most the count.
std::vector<PlateSine> lowest_sines(const Plate& plate, const std::vector<Rib>& ribs, std::size_t count) {
  std::vector<std::pair<double, PlateSine>> found;
  const int max_product = static_cast<int>(count);
  for (int along = 1; along <= max_product; ++along)
    for (int across = 1; along * across <= max_product; ++across) {
      const auto [stiffness, mass] = with_spread_ribs(plate, ribs, {along, across});
      found.push_back({stiffness / mass, {along, across}});
    }
  std::ranges::stable_sort(found, {}, [](const auto& sine) { return sine.first; });
  std::vector<PlateSine> sines;
  for (const auto& [square, sine] : found)
    if (sines.size() < count) sines.push_back(sine);
  return sines;
}

/// Stiffness and mass between the sines.
struct Matrices {
  Eigen::MatrixXd stiffness, mass;
};

// Adds the integrals of a rib: of the product of the second derivatives along it, and of the product of the shapes.
void add_rib(const Plate& plate, const std::vector<PlateSine>& sines, const Rib& rib, Matrices& matrices) {
  const Line line(rib);
  double phase = 0;
  for (const PlateSine& sine : sines) {
    const auto [kx, ky] = wavenumbers_of(plate, sine);
    phase = std::max(phase, (kx * std::abs(line.cx) + ky * std::abs(line.cy)) * line.length_m);
  }
  // A product of two sines has twice the phase; twice that makes the error that of rounding.
  const QuadratureRule rule = gauss_rule(line.length_m, 4 * phase);
  const auto points = static_cast<Eigen::Index>(rule.points.size()), count = static_cast<Eigen::Index>(sines.size());
  Eigen::MatrixXd curved(points, count), moved(points, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto [kx, ky] = wavenumbers_of(plate, sines[static_cast<std::size_t>(i)]);
    const double straight = std::pow(line.cx * kx, 2) + std::pow(line.cy * ky, 2),
                 turned = 2 * line.cx * line.cy * kx * ky;
    for (Eigen::Index p = 0; p < points; ++p) {
      const double at = rule.points[static_cast<std::size_t>(p)],
                   root = std::sqrt(rule.weights[static_cast<std::size_t>(p)]);
      const double x = kx * (line.x + at * line.cx), y = ky * (line.y + at * line.cy);
      const double shape = std::sin(x) * std::sin(y);
      moved(p, i) = root * shape;
      curved(p, i) = root * (turned * std::cos(x) * std::cos(y) - straight * shape);
    }
  }
  matrices.stiffness.selfadjointView<Eigen::Lower>().rankUpdate(curved.transpose(), rib.bending_stiffness_n_m2);
  matrices.mass.selfadjointView<Eigen::Lower>().rankUpdate(moved.transpose(), rib.mass_per_length_kg_m);
}

Matrices matrices_of(const Plate& plate, const std::vector<Rib>& ribs, const std::vector<PlateSine>& sines) {
  const auto count = static_cast<Eigen::Index>(sines.size());
  Matrices matrices{Eigen::MatrixXd::Zero(count, count), Eigen::MatrixXd::Zero(count, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto [stiffness, mass] = bare(plate, sines[static_cast<std::size_t>(i)]);
    matrices.stiffness(i, i) = stiffness;
    matrices.mass(i, i) = mass;
  }
  for (const Rib& rib : ribs) add_rib(plate, sines, rib, matrices);
  return matrices;
}

// A mode from the solution, whose weights are made to have the sum of squares 1 and a positive largest one.
void add_mode(const Plate& plate, double square, Eigen::VectorXd weights, const Matrices& matrices,
              RibbedModes& modes) {
  weights /= weights.norm();
  Eigen::Index largest = 0;
  weights.cwiseAbs().maxCoeff(&largest);
  if (weights[largest] < 0) weights = -weights;
  double beta_square = 0;
  for (std::size_t i = 0; i < modes.sines.size(); ++i) {
    const auto [kx, ky] = wavenumbers_of(plate, modes.sines[i]);
    beta_square += std::pow(weights[static_cast<Eigen::Index>(i)], 2) * (kx * kx + ky * ky);
  }
  const double mass = weights.dot(matrices.mass.selfadjointView<Eigen::Lower>() * weights);
  modes.modes.push_back({std::sqrt(square), std::sqrt(beta_square), mass});
  modes.weights.emplace_back(weights.begin(), weights.end());
}

}  // namespace

RibbedModes ribbed_modes(const Plate& plate, const std::vector<Rib>& ribs, std::size_t sines) {
  RibbedModes modes{lowest_sines(plate, ribs, sines), {}, {}};
  const Matrices matrices = matrices_of(plate, ribs, modes.sines);
  // Scaled so that each sine alone has the stiffness 1, and solved for 1/w0^2: so the low modes are the accurate
  // ones.
  const Eigen::VectorXd scale = matrices.stiffness.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd mass = scale.asDiagonal() * matrices.mass * scale.asDiagonal(),
                        stiffness = scale.asDiagonal() * matrices.stiffness * scale.asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(mass, stiffness);
  if (solver.info() != Eigen::Success) throw std::runtime_error("the modes of a plate with ribs were not found");
  const auto count = static_cast<Eigen::Index>(modes.sines.size());
  for (Eigen::Index m = 0; m < count / 2; ++m) {
    const Eigen::Index column = count - 1 - m;
    add_mode(plate, 1 / solver.eigenvalues()[column], scale.asDiagonal() * solver.eigenvectors().col(column),
             matrices, modes);
  }
  return modes;
}

RibbedPlate::RibbedPlate(Plate plate, std::vector<Rib> ribs) : plate_(std::move(plate)), ribs_(std::move(ribs)) {}

const RibbedModes& RibbedPlate::modes() const {
  std::call_once(once_, [&] { modes_ = ribbed_modes(plate_, ribs_, kSines); });
  return modes_;
}

double RibbedPlate::shape_at(std::size_t mode, double position_m, double across_m) const {
  double shape = 0;
  for (std::size_t i = 0; i < modes().sines.size(); ++i) {
    const auto [kx, ky] = wavenumbers_of(plate_, modes().sines[i]);
    shape += modes().weights[mode][i] * std::sin(kx * position_m) * std::sin(ky * across_m);
  }
  return shape;
}

}  // namespace contactspline
