// SPDX-License-Identifier: MIT
#include "generator/force_line.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace contactspline {
namespace {

// atan(sqrt x)/sqrt x, and its derivative.
double arc(double x) {
  return x < 1e-4 ? 1 - x / 3 + x * x / 5 : std::atan(std::sqrt(x)) / std::sqrt(x);
}
double arc_slope(double x) {
  return x < 1e-3 ? -1.0 / 3 + 2 * x / 5 - 3 * x * x / 7 : (1 / (1 + x) - arc(x)) / (2 * x);
}

// The ends of a piece, and the speeds there.
struct Piece {
  double width, f0, f1, v0, v1;
};

// A function of a piece with its derivatives by all of that.
struct Time {
  double value;
  Piece slope;
};

// 2/w atan(w dy/(v0 + v1)), w^2 = (f1 - f0)/dy.
Time transit(const Piece& p) {
  const double v = p.v0 + p.v1, rise = p.f1 - p.f0;
  const double x = rise * p.width / (v * v);
  const double time = 2 * p.width / v * arc(x), by_x = 2 * p.width / v * arc_slope(x);
  const double by_rise = by_x * p.width / (v * v), by_v = -(time + 2 * x * by_x) / v;
  return {time, {2 / v * arc(x) + by_x * rise / (v * v), -by_rise, by_rise, by_v, by_v}};
}

// Up to the turning point: 1/w atan(w v0/f0).
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

/// Derivatives by the stored energies on the way, brought back to those by the points.
class Adjoint {
 public:
  Adjoint(const ForceLine& line, ForceLine& slopes) : line_(line), slopes_(slopes), by_energy_(line.y.size()) {
    slopes.y.assign(line.y.size(), 0);
    slopes.f.assign(line.y.size(), 0);
  }
  void add(std::size_t j, const Piece& p, const Piece& slope) {
    add_width(j, slope.width);
    slopes_.f[j] += slope.f0;
    slopes_.f[j + 1] += slope.f1;
    // v = sqrt(2 (energy - stored)); at a turning point the parts of both sides cancel
    by_energy_[j] -= slope.v0 / std::max(p.v0, kSlow);
    by_energy_[j + 1] -= slope.v1 / std::max(p.v1, kSlow);
  }
  void finish(std::size_t last) {
    for (std::size_t j = last; j-- > 0;) {
      const double by_energy = by_energy_[j + 1], width = line_.y[j + 1] - line_.y[j];
      add_width(j, by_energy * (line_.f[j] + line_.f[j + 1]) / 2);
      slopes_.f[j] += by_energy * width / 2;
      slopes_.f[j + 1] += by_energy * width / 2;
      by_energy_[j] += by_energy;
    }
  }

 private:
  static constexpr double kSlow = 1e-9;

  void add_width(std::size_t j, double slope) {
    slopes_.y[j + 1] += slope;
    slopes_.y[j] -= slope;
  }

  const ForceLine& line_;
  ForceLine& slopes_;
  std::vector<double> by_energy_;
};

}  // namespace

bool ForceLine::rises() const {
  for (std::size_t j = 0; j < segments(); ++j)
    if (!(y[j + 1] > y[j] && f[j + 1] >= f[j])) return false;
  return f[1] > 0 && std::isfinite(f.back());
}

std::vector<double> ForceLine::energies() const {
  std::vector<double> stored{0};
  for (std::size_t j = 0; j < segments(); ++j)
    stored.push_back(stored.back() + (f[j] + f[j + 1]) / 2 * (y[j + 1] - y[j]));
  return stored;
}

double half_duration(const ForceLine& line, double energy, ForceLine* slopes) {
  std::optional<Adjoint> adjoint;
  if (slopes != nullptr) adjoint.emplace(line, *slopes);
  double duration = 0, stored = 0, v0 = std::sqrt(2 * energy);
  for (std::size_t j = 0;; ++j) {
    const double width = line.y[j + 1] - line.y[j], f0 = line.f[j], f1 = line.f[j + 1];
    stored += (f0 + f1) / 2 * width;
    const bool turns = j + 1 == line.segments() || stored >= energy;
    const Piece piece{width, f0, f1, v0, turns ? 0 : std::sqrt(2 * (energy - stored))};
    const Time time = turns ? turning(piece) : transit(piece);
    duration += time.value;
    if (adjoint) adjoint->add(j, piece, time.slope);
    if (turns) {
      if (adjoint) adjoint->finish(j);
      return duration;
    }
    v0 = piece.v1;
  }
}

double turning_point(const ForceLine& line, double energy, ForceLine* slopes) {
  double stored = 0;
  std::size_t last = 0;
  const auto area = [&](std::size_t j) { return (line.f[j] + line.f[j + 1]) / 2 * (line.y[j + 1] - line.y[j]); };
  while (last + 1 < line.segments() && stored + area(last) < energy) stored += area(last++);
  const auto stiffness = [&](std::size_t j) { return (line.f[j + 1] - line.f[j]) / (line.y[j + 1] - line.y[j]); };
  const double f = line.f[last];
  const double beyond = 2 * (energy - stored) / (f + std::sqrt(f * f + 2 * stiffness(last) * (energy - stored)));
  if (slopes == nullptr) return line.y[last] + beyond;
  slopes->y.assign(line.y.size(), 0);
  slopes->f.assign(line.y.size(), 0);
  const double force = f + stiffness(last) * beyond;
  for (std::size_t j = 0; j <= last; ++j) {  // V at the turning point, by what a point moves of the area before it
    const double width = line.y[j + 1] - line.y[j], way = j < last ? width : beyond;
    const double right = way * way / (2 * width), left = way - right;
    slopes->f[j] -= left / force;
    slopes->f[j + 1] -= right / force;
    slopes->y[j] += stiffness(j) * left / force;
    slopes->y[j + 1] += stiffness(j) * right / force;
  }
  return line.y[last] + beyond;
}

}  // namespace contactspline
