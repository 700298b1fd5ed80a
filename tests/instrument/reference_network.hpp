// SPDX-License-Identifier: MIT
// An independent solution of the equations of docs/reference/instruments.md in long double. It shares the
// numbers of an instrument with the runtime, and no code: modes move by exact propagators between two kicks, forces
// are integrals of the piecewise linear law, and the increments come from Newton's method with Gaussian elimination,
// helped by Gauss-Seidel sweeps of bisection.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/data/instrument_data.hpp"

namespace contactspline::testing {

using Real = long double;

/// A force that never falls with the increment x of its compression over a sample.
class ReferenceLaw {
 public:
  ReferenceLaw() = default;

  /// A contact: energies are not used, but the forces at the knots and the curvatures.
  ReferenceLaw(std::span<const double> knots, std::span<const double> forces, std::span<const double> half_curvatures,
               Real weight, Real loss_s_per_m, Real rate)
      : knots_(knots),
        forces_(forces),
        half_curvatures_(half_curvatures),
        weight_(weight),
        loss_rate_(loss_s_per_m * rate) {}

  /// A spring; resistance: N s/m times the rate.
  ReferenceLaw(Real stiffness, Real resistance) : stiffness_(stiffness), resistance_(resistance) {}

  void begin(Real compression) {
    const Real last = has_begun_ ? compression - y_ : Real(0);
    has_begun_ = true;
    y_ = compression;
    if (!knots_.empty()) resistance_ = loss_rate_ * weight_ * std::min(force_at(y_ + last / 2), 2 * force_at(y_));
  }

  /// The mean of the force over the way from y to y + x, with the viscous force. A contact does not pull.
  [[nodiscard]] Real force(Real x) const {
    if (knots_.empty()) return stiffness_ * (y_ + x / 2) + resistance_ * x;
    return std::max(Real(0), weight_ * mean(x) + resistance_ * x);
  }

  [[nodiscard]] Real slope(Real x) const {
    if (knots_.empty()) return stiffness_ / 2 + resistance_;
    if (force(x) == 0) return 0;
    const bool is_one_piece = piece(y_) == piece(y_ + x);
    const Real elastic = is_one_piece ? curvature(y_) / 2 : (force_at(y_ + x) - mean(x)) / x;
    return weight_ * std::max(Real(0), elastic) + resistance_;
  }

 private:
  // 0 below the first knot; piece j begins at knot j - 1.
  [[nodiscard]] std::size_t piece(Real y) const {
    return static_cast<std::size_t>(std::ranges::count_if(knots_, [y](double knot) { return knot <= y; }));
  }
  [[nodiscard]] Real curvature(Real y) const {
    const std::size_t j = piece(y);
    return j == 0 ? Real(0) : 2 * Real(half_curvatures_[j - 1]);
  }
  [[nodiscard]] Real force_at(Real y) const { return force_in(piece(y), y); }
  [[nodiscard]] Real force_in(std::size_t j, Real y) const {
    return j == 0 ? Real(0) : forces_[j - 1] + 2 * Real(half_curvatures_[j - 1]) * (y - knots_[j - 1]);
  }

  // Trapezoids from knot to knot.
  [[nodiscard]] Real mean(Real x) const {
    if (x == 0) return force_at(y_);
    const Real low = std::min(y_, y_ + x), high = std::max(y_, y_ + x);
    const std::size_t first = piece(low), last = piece(high);
    if (first == last) return (force_in(first, low) + force_in(first, high)) / 2;  // however small x is beside y
    Real area = 0;
    for (std::size_t j = first; j <= last; ++j) {
      const Real from = j == 0 ? low : std::max(low, Real(knots_[j - 1]));
      const Real to = j == knots_.size() ? high : std::min(high, Real(knots_[j]));
      area += (to - from) * (force_in(j, from) + force_in(j, to)) / 2;
    }
    return area / std::abs(x);
  }

  std::span<const double> knots_, forces_, half_curvatures_;
  Real weight_ = 1, loss_rate_ = 0, stiffness_ = 0, resistance_ = 0, y_ = 0;
  bool has_begun_ = false;
};

class ReferenceNetwork {
 public:
  ReferenceNetwork(const InstrumentData& data, double rate) : data_(data), time_step_(1 / Real(rate)) {
    for (std::size_t i = 0; i < data.masses.size(); ++i) modes_.push_back(propagator(i));
    for (std::size_t b = 0, begin = 0; b < data.body_ends.size(); begin = data.body_ends[b++])
      bodies_.push_back({begin, data.body_ends[b]});
    const double* shapes = data.shapes.data();
    for (const std::size_t b : data.place_bodies) {
      shapes_.push_back({shapes, bodies_[b].end - bodies_[b].begin});
      shapes += shapes_.back().size();
    }
    pushes_.resize(shapes_.size());
    connections_.assign(data.connections.begin(), data.connections.end());
    ratios_.assign(connections_.size(), 1);
    for (std::size_t i = 0; i < data.controls.size(); ++i)
      for (const std::size_t target : data.targets.subspan(data.controls[i].first_target, data.controls[i].count))
        set_first(data.controls[i].quantity, data.parameters[i].initial, target);
    couple();
    for (std::size_t k = 0; k < data.connections.size(); ++k) laws_.push_back(law_of(k));
    increments_.resize(laws_.size());
    forces_.resize(laws_.size());
  }

  /// Throws the mass of a strike.
  void strike(std::size_t strike, Real speed) {
    Mode& mode = modes_[bodies_[data_.strikes[strike]].begin];
    mode.q = 0;
    mode.v = speed;
  }

  /// Puts a mode of a body at a displacement with a velocity in free motion.
  void set_motion(std::size_t body, std::size_t mode, Real displacement, Real velocity) {
    modes_[bodies_[body].begin + mode].q = displacement;
    modes_[bodies_[body].begin + mode].v = velocity;
  }

  /// Pushes at a place in the next sample [N].
  void push(std::size_t place, Real force) { pushes_[place] += force; }

  /// Advances a sample.
  void tick() {
    // Free motion, with the pushes.
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (std::size_t i = bodies_[b].begin; i < bodies_[b].end; ++i) {
        Mode& mode = modes_[i];
        mode.free = (mode.qq - 1) * mode.q + mode.qv * mode.v;
        mode.force = 0;
      }
    for (const auto& [place, force_n] : data_.holds) add_force(place, force_n);
    for (std::size_t p = 0; p < pushes_.size(); ++p) add_force(p, pushes_[p]);
    std::ranges::fill(pushes_, Real(0));
    const std::size_t n = laws_.size();
    std::vector<Real> free(n);
    for (std::size_t k = 0; k < n; ++k) {
      const InstrumentConnection& c = connections_[k];
      laws_[k].begin(displacement(c.first) - displacement(c.second) - Real(c.gap_m));
      free[k] = free_increment(c.first) - free_increment(c.second);
    }
    solve(free);
    for (std::size_t k = 0; k < n; ++k) {
      if (connections_[k].first != kGround) add_force(connections_[k].first, -forces_[k]);
      if (connections_[k].second != kGround) add_force(connections_[k].second, forces_[k]);
    }
    // Half of the momentum before the free motion and half after it.
    for (const Body& body : bodies_)
      for (std::size_t i = body.begin; i < body.end; ++i) {
        Mode& mode = modes_[i];
        const Real change = (mode.free + mode.receptance * mode.force) / (1 + body.damping);
        const Real kick = (change - mode.free) / mode.qv, q = mode.q;
        mode.q += change;
        mode.v = mode.vq * q + mode.vv * (mode.v + kick) + kick;
      }
  }

  [[nodiscard]] Real output(std::size_t output) const {
    const InstrumentOutput& of = data_.sources[output];
    Real sum = 0 - Real(of.at_rest_n);
    for (const std::size_t target : data_.targets.subspan(of.first_target, of.count))
      sum += of.quantity == OutputQuantity::kForce ? forces_[target] : sound(target, of.quantity);
    return sum;
  }

  [[nodiscard]] Real displacement(std::size_t place) const {
    return over_modes(place, [](const Mode& mode) { return mode.q; });
  }

  /// The largest residual so far: metres that increments and forces disagree, of the sum of both.
  [[nodiscard]] Real residual() const { return largest_residual_; }

 private:
  struct Mode {
    Real qq, qv, vq, vv;  // what displacement and velocity become in free motion over a sample
    Real receptance, averaging;
    Real decay, w;
    Real q = 0, v = 0, free = 0, force = 0;
  };
  struct Body {
    std::size_t begin, end;
    Real damping = 0;
  };

  // The first value of a control. Forces are pushed from outside.
  void set_first(ControlQuantity quantity, double initial, std::size_t target) {
    switch (quantity) {
      case ControlQuantity::kForce:
        return;
      case ControlQuantity::kDamping:
        bodies_[target].damping = initial * time_step_;
        return;
      case ControlQuantity::kStiffnessRatio:
        ratios_[target] = initial;
        return;
      case ControlQuantity::kLoss:
        connections_[target].loss_s_per_m = initial;
        return;
      case ControlQuantity::kGapShift:
        connections_[target].gap_m += initial;
        return;
      case ControlQuantity::kStiffness:
        connections_[target].stiffness_n_per_m = initial;
        return;
      case ControlQuantity::kResistance:
        connections_[target].resistance_n_s_per_m = initial;
        return;
      case ControlQuantity::kPlace:
      case ControlQuantity::kMass:
        return;  // that of the file
      case ControlQuantity::kNormalForce:
      case ControlQuantity::kSurfaceSpeed:
        return;  // 0
    }
  }

  // q'' + 2 s q' + (w^2 + s^2) q = 0 over a sample, and the displacement per newton that gives the static compliance.
  [[nodiscard]] Mode propagator(std::size_t i) const {
    const Real w = data_.angular_frequencies[i], s = data_.decays[i], m = data_.masses[i], dt = time_step_;
    const Real e = std::exp(-s * dt), c = std::cos(w * dt), sine_over_w = w > 0 ? std::sin(w * dt) / w : dt;
    const Real square = w * w + s * s;
    Mode mode{};
    mode.qq = e * (c + s * sine_over_w);
    mode.qv = e * sine_over_w;
    mode.vq = -e * square * sine_over_w;
    mode.vv = e * (c - s * sine_over_w);
    // A constant force f kicks v by receptance f/qv before and after each sample. Then q = f/(m square) stays at
    // rest.
    const Real determinant = (1 - mode.qq) * (1 - mode.vv) - mode.qv * mode.vq;  // |1 - z|^2
    mode.receptance = square > 0 ? determinant / (2 * m * square) : dt * dt / (2 * m);
    if (w * dt >= std::numbers::pi_v<Real>) mode.receptance = 0;  // above half the rate, where lower keys need it
    mode.averaging = square > 0 ? determinant / (square * dt * dt) : Real(1);
    mode.decay = s;
    mode.w = w;
    return mode;
  }

  [[nodiscard]] ReferenceLaw law_of(std::size_t k) const {
    const InstrumentConnection& c = connections_[k];
    const Real rate = 1 / time_step_;
    if (c.kind == ConnectionKind::kFriction) return {0, 0};  // of a bow that is lifted
    if (c.kind == ConnectionKind::kSpring) return {c.stiffness_n_per_m, c.resistance_n_s_per_m * rate};
    if (c.kind == ConnectionKind::kLink) {
      const Real stiffness = 1e3L / coupling_[k * connections_.size() + k];
      return {stiffness, stiffness / 2};
    }
    const std::size_t begin = c.table == 0 ? 0 : data_.table_ends[c.table - 1],
                      count = data_.table_ends[c.table] - begin;
    return {data_.knots.subspan(begin, count),
            data_.forces.subspan(begin, count),
            data_.half_curvatures.subspan(begin, count),
            c.weight * ratios_[k],
            c.loss_s_per_m,
            rate};
  }

  template <typename Quantity>
  [[nodiscard]] Real over_modes(std::size_t place, Quantity quantity) const {
    if (place == kGround) return 0;
    Real sum = 0;
    const Body& body = bodies_[data_.place_bodies[place]];
    for (std::size_t i = body.begin; i < body.end; ++i) sum += shapes_[place][i - body.begin] * quantity(modes_[i]);
    return sum;
  }

  [[nodiscard]] Real free_increment(std::size_t place) const {
    if (place == kGround) return 0;
    const Real damping = bodies_[data_.place_bodies[place]].damping;
    return over_modes(place, [&](const Mode& m) { return (m.free + m.receptance * m.force) / (1 + damping); });
  }

  void add_force(std::size_t place, Real force) {
    if (force == 0) return;
    const Body& body = bodies_[data_.place_bodies[place]];
    for (std::size_t i = body.begin; i < body.end; ++i) modes_[i].force += shapes_[place][i - body.begin] * force;
  }

  // Motion of each connection per newton in each other one.
  void couple() {
    const std::size_t n = connections_.size();
    coupling_.assign(n * n, 0);
    const auto mutual = [&](std::size_t p, std::size_t q) -> Real {
      if (p == kGround || q == kGround || data_.place_bodies[p] != data_.place_bodies[q]) return 0;
      const Body& body = bodies_[data_.place_bodies[p]];
      Real sum = 0;
      for (std::size_t i = body.begin; i < body.end; ++i)
        sum += modes_[i].receptance * shapes_[p][i - body.begin] * shapes_[q][i - body.begin];
      return sum / (1 + body.damping);
    };
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t l = 0; l < n; ++l) {
        const InstrumentConnection &a = connections_[k], &b = connections_[l];
        coupling_[k * n + l] = mutual(a.first, b.first) - mutual(a.first, b.second) - mutual(a.second, b.first) +
                               mutual(a.second, b.second);
      }
  }

  // The differences of both sides of x + Xi f(x) = free, and the largest one as a part of the largest sum of terms.
  Real residuals(std::span<const Real> free, std::span<const Real> x, std::vector<Real>& r,
                 std::vector<Real>& f) const {
    const std::size_t n = x.size();
    for (std::size_t k = 0; k < n; ++k) f[k] = laws_[k].force(x[k]);
    Real norm = 0, largest = 0;
    for (std::size_t k = 0; k < n; ++k) {
      Real sum = x[k] - free[k], size = std::abs(x[k]) + std::abs(free[k]);
      for (std::size_t l = 0; l < n; ++l) {
        sum += coupling_[k * n + l] * f[l];
        size += std::abs(coupling_[k * n + l] * f[l]);
      }
      r[k] = sum;
      const Real scale = std::sqrt(coupling_[k * n + k]);  // in roots of joules
      norm = std::max(norm, std::abs(sum) / scale);
      largest = std::max(largest, size / scale);
    }
    if (norm > 0) norm /= largest;
    return norm;
  }

  void solve(std::span<const Real> free) {
    const std::size_t n = free.size();
    std::vector<Real>& x = increments_;
    std::vector<Real> r(n), trial(n), trial_r(n), trial_f(n);
    Real norm = residuals(free, x, r, forces_);
    for (int round = 0; round < 200 && norm > 1e-18L; ++round) {
      const std::vector<Real> step = newton_step(x, r);
      bool better = false;
      for (Real length = 1; length > 1e-3L && !better; length /= 2) {
        for (std::size_t k = 0; k < n; ++k) trial[k] = x[k] - length * step[k];
        const Real found = residuals(free, trial, trial_r, trial_f);
        better = found < norm * (1 - length / 4);
        if (!better) continue;
        norm = found;
        x = trial;
        r = trial_r;
        forces_ = trial_f;
      }
      if (better) continue;
      if (norm < 1e-15L) break;  // rounding
      for (int i = 0; i < 30; ++i) sweep(free);
      norm = residuals(free, x, r, forces_);
    }
    largest_residual_ = std::max(largest_residual_, norm);
  }

  // (1 + Xi f') step = r by elimination with row exchanges.
  [[nodiscard]] std::vector<Real> newton_step(std::span<const Real> x, std::vector<Real> r) const {
    const std::size_t n = x.size();
    std::vector<Real> a(n * n);
    for (std::size_t l = 0; l < n; ++l) {
      const Real slope = laws_[l].slope(x[l]);
      for (std::size_t k = 0; k < n; ++k) a[k * n + l] = coupling_[k * n + l] * slope + (k == l);
    }
    for (std::size_t j = 0; j < n; ++j) {
      std::size_t pivot = j;
      for (std::size_t k = j + 1; k < n; ++k)
        if (std::abs(a[k * n + j]) > std::abs(a[pivot * n + j])) pivot = k;
      for (std::size_t l = 0; l < n; ++l) std::swap(a[j * n + l], a[pivot * n + l]);
      std::swap(r[j], r[pivot]);
      for (std::size_t k = j + 1; k < n; ++k) {
        const Real factor = a[k * n + j] / a[j * n + j];
        if (factor == 0) continue;
        for (std::size_t l = j; l < n; ++l) a[k * n + l] -= factor * a[j * n + l];
        r[k] -= factor * r[j];
      }
    }
    for (std::size_t j = n; j-- > 0;) {
      for (std::size_t l = j + 1; l < n; ++l) r[j] -= a[j * n + l] * r[l];
      r[j] /= a[j * n + j];
    }
    return r;
  }

  // Solves each equation for its own increment while the other forces hold. This lowers a convex function.
  void sweep(std::span<const Real> free) {
    const std::size_t n = free.size();
    std::vector<Real> f(n);
    for (std::size_t k = 0; k < n; ++k) f[k] = laws_[k].force(increments_[k]);
    for (std::size_t k = 0; k < n; ++k) {
      Real target = free[k];
      for (std::size_t l = 0; l < n; ++l)
        if (l != k) target -= coupling_[k * n + l] * f[l];
      const Real xi = coupling_[k * n + k];
      // x + xi f(x) rises strictly.
      Real low = target - xi * std::max(Real(0), laws_[k].force(target)) - 1e-12L, high = target + 1e-12L;
      while (high + xi * laws_[k].force(high) < target) high += 2 * (high - low);
      while (low + xi * laws_[k].force(low) > target) low -= 2 * (high - low);
      for (int i = 0; i < 90; ++i) {
        const Real middle = (low + high) / 2;
        (middle + xi * laws_[k].force(middle) < target ? low : high) = middle;
      }
      increments_[k] = (low + high) / 2;
      f[k] = laws_[k].force(increments_[k]);
    }
  }

  // A displacement or a velocity as sound: each mode is raised by what averaging the force takes away from it.
  [[nodiscard]] Real sound(std::size_t place, OutputQuantity quantity) const {
    constexpr Real kMin = 4 / (std::numbers::pi_v<Real> * std::numbers::pi_v<Real>);
    return over_modes(place, [&](const Mode& mode) -> Real {
      if (quantity == OutputQuantity::kDisplacement) return mode.q / std::max(mode.averaging, kMin);
      return mode.decay * time_step_ > 0.105L ? 0 : mode.v / std::max(mode.averaging, kMin);  // decays by a tenth
    });
  }

  InstrumentData data_;
  Real time_step_;
  std::vector<Mode> modes_;
  std::vector<Body> bodies_;
  std::vector<std::span<const double>> shapes_;
  std::vector<InstrumentConnection> connections_;
  std::vector<Real> ratios_;  // one for each control
  std::vector<ReferenceLaw> laws_;
  std::vector<Real> coupling_, pushes_, increments_, forces_;
  Real largest_residual_ = 0;
};

}  // namespace contactspline::testing
