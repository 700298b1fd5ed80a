// SPDX-License-Identifier: MIT
#include "generator/spline/piecewise_linear_force.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace contactspline {
namespace {

// atan(sqrt x)/sqrt x and its derivative.
double arc(double x) {
  return x < 1e-4 ? 1 - x / 3 + x * x / 5 : std::atan(std::sqrt(x)) / std::sqrt(x);
}
double arc_slope(double x) {
  return x < 1e-3 ? -1.0 / 3 + 2 * x / 5 - 3 * x * x / 7 : (1 / (1 + x) - arc(x)) / (2 * x);
}

// The width of a piece, and force and speed at its two ends.
struct Piece {
  double width, f0, f1, v0, v1;
};

// A time with its derivatives with respect to the members of a piece.
struct Time {
  double value;
  Piece derivative;
};

// Time to cross a piece: 2/w atan(w dy/(v0 + v1)), w^2 = (f1 - f0)/dy.
Time transit(const Piece& p) {
  const double v = p.v0 + p.v1, rise = p.f1 - p.f0;
  const double x = rise * p.width / (v * v);
  const double time = 2 * p.width / v * arc(x), by_x = 2 * p.width / v * arc_slope(x);
  const double by_rise = by_x * p.width / (v * v), by_v = -(time + 2 * x * by_x) / v;
  return {time, {2 / v * arc(x) + by_x * rise / (v * v), -by_rise, by_rise, by_v, by_v}};
}

// Time from the beginning of the last piece to the turning point: 1/w atan(w v0/f0).
Time turning(const Piece& p) {
  const double stiffness = (p.f1 - p.f0) / p.width;
  if (p.f0 == 0) {
    const double time = std::numbers::pi / 2 / std::sqrt(stiffness);
    const double by_rise = -time / (2 * stiffness * p.width);
    return {time, {-by_rise * stiffness, 0, by_rise, 0, 0}};
  }
  const double x = stiffness * p.v0 * p.v0 / (p.f0 * p.f0);
  const double time = p.v0 / p.f0 * arc(x), by_x = p.v0 / p.f0 * arc_slope(x);
  const double by_rise = by_x * p.v0 * p.v0 / (p.f0 * p.f0 * p.width);
  return {time,
          {-by_rise * stiffness, -(time + 2 * x * by_x) / p.f0 - by_rise, by_rise,
           arc(x) / p.f0 + by_x * 2 * x / p.v0, 0}};
}

/// Collects derivatives of pieces. Derivatives with respect to the stored energies are propagated back to the points.
class Adjoint {
 public:
  Adjoint(const PiecewiseLinearForce& force, PiecewiseLinearForce& gradient)
      : force_(force), gradient_(gradient), by_energy_(force.y.size()) {
    gradient.y.assign(force.y.size(), 0);
    gradient.f.assign(force.y.size(), 0);
  }
  void add(std::size_t j, const Piece& p, const Piece& derivative) {
    add_width(j, derivative.width);
    gradient_.f[j] += derivative.f0;
    gradient_.f[j + 1] += derivative.f1;
    // v = sqrt(2 (energy - stored)); at a turning point the contributions of both sides cancel
    by_energy_[j] -= derivative.v0 / std::max(p.v0, kSlow);
    by_energy_[j + 1] -= derivative.v1 / std::max(p.v1, kSlow);
  }
  void finish(std::size_t last) {
    for (std::size_t j = last; j-- > 0;) {
      const double by_energy = by_energy_[j + 1], width = force_.y[j + 1] - force_.y[j];
      add_width(j, by_energy * (force_.f[j] + force_.f[j + 1]) / 2);
      gradient_.f[j] += by_energy * width / 2;
      gradient_.f[j + 1] += by_energy * width / 2;
      by_energy_[j] += by_energy;
    }
  }

 private:
  static constexpr double kSlow = 1e-9;

  void add_width(std::size_t j, double derivative) {
    gradient_.y[j + 1] += derivative;
    gradient_.y[j] -= derivative;
  }

  const PiecewiseLinearForce& force_;
  PiecewiseLinearForce& gradient_;
  std::vector<double> by_energy_;
};

}  // namespace

bool PiecewiseLinearForce::rises() const {
  for (std::size_t j = 0; j < segments(); ++j)
    if (!(y[j + 1] > y[j] && f[j + 1] >= f[j])) return false;
  return f[1] > 0 && std::isfinite(f.back());
}

std::vector<double> PiecewiseLinearForce::energies() const {
  std::vector<double> stored{0};
  for (std::size_t j = 0; j < segments(); ++j)
    stored.push_back(stored.back() + (f[j] + f[j + 1]) / 2 * (y[j + 1] - y[j]));
  return stored;
}

double half_duration(const PiecewiseLinearForce& force, double energy, PiecewiseLinearForce* gradient) {
  std::optional<Adjoint> adjoint;
  if (gradient != nullptr) adjoint.emplace(force, *gradient);
  double duration = 0, stored = 0, v0 = std::sqrt(2 * energy);
  for (std::size_t j = 0;; ++j) {
    const double width = force.y[j + 1] - force.y[j], f0 = force.f[j], f1 = force.f[j + 1];
    stored += (f0 + f1) / 2 * width;
    const bool turns = j + 1 == force.segments() || stored >= energy;
    const Piece piece{width, f0, f1, v0, turns ? 0 : std::sqrt(2 * (energy - stored))};
    const Time time = turns ? turning(piece) : transit(piece);
    duration += time.value;
    if (adjoint) adjoint->add(j, piece, time.derivative);
    if (turns) {
      if (adjoint) adjoint->finish(j);
      return duration;
    }
    v0 = piece.v1;
  }
}

double turning_point(const PiecewiseLinearForce& force, double energy, PiecewiseLinearForce* gradient) {
  double stored = 0;
  std::size_t last = 0;
  const auto area = [&](std::size_t j) { return (force.f[j] + force.f[j + 1]) / 2 * (force.y[j + 1] - force.y[j]); };
  while (last + 1 < force.segments() && stored + area(last) < energy) stored += area(last++);
  const auto stiffness = [&](std::size_t j) { return (force.f[j + 1] - force.f[j]) / (force.y[j + 1] - force.y[j]); };
  const double f = force.f[last];
  const double beyond = 2 * (energy - stored) / (f + std::sqrt(f * f + 2 * stiffness(last) * (energy - stored)));
  if (gradient == nullptr) return force.y[last] + beyond;
  gradient->y.assign(force.y.size(), 0);
  gradient->f.assign(force.y.size(), 0);
  const double turning_force = f + stiffness(last) * beyond;
  for (std::size_t j = 0; j <= last; ++j) {  // moving a point changes the stored energy, the area below the force
    const double width = force.y[j + 1] - force.y[j], crossed = j < last ? width : beyond;
    const double right = crossed * crossed / (2 * width), left = crossed - right;
    gradient->f[j] -= left / turning_force;
    gradient->f[j + 1] -= right / turning_force;
    gradient->y[j] += stiffness(j) * left / turning_force;
    gradient->y[j + 1] += stiffness(j) * right / turning_force;
  }
  return force.y[last] + beyond;
}

}  // namespace contactspline
