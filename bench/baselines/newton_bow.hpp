// SPDX-License-Identifier: MIT
// A bowed string with the friction law and the heat of contactspline/step/friction.hpp. Newton's method solves all
// points of the bow together, as authors of bristle models do.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "bench/bowed_string.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/step/friction_heat.hpp"

namespace contactspline::bench {

template <std::floating_point T>
class NewtonBow {
 public:
  static constexpr std::size_t kMaxPoints = 8;

  NewtonBow(const bowing::BowedProblem& problem, double rate)
      : string_(problem.string, rate),
        hair_(problem.hair, rate),
        body_(problem.body, rate),
        at_bridge_(problem.string_at_bridge),
        of_body_(problem.body_at_bridge),
        rate_(static_cast<T>(rate)) {
    for (std::size_t p = 0; p < problem.points.size(); ++p) {
      Point& point = points_.emplace_back();
      point.shapes = ModeShapes<T>(problem.points[p]);
      point.at_hair = ModeShapes<T>(problem.at_hair(p));
      point.surfaces = FrictionTemperature<T>(kRosin.heat, bowing::kHairWidth_m * problem.share(), rate);
    }
    if (!problem.body.empty()) join_body();
    couple();
  }

  /// One sample under a force on all points together [N] and the speed of the bow [m/s].
  void tick(T force_n, T speed_m_per_s) {
    string_.predict();
    hair_.predict();
    const T bridge = begin_bridge();
    for (Point& point : points_) {
      point.press(force_n / static_cast<T>(points_.size()));
      point.free = speed_m_per_s / rate_ + hair_.increment(point.at_hair) - string_.increment(point.shapes) +
                   point.to_bridge * bridge;
    }
    solve();
    advance(bridge);
  }

  [[nodiscard]] T force(std::size_t p) const { return points_[p].force; }  ///< over the last sample [N]
  [[nodiscard]] T temperature(std::size_t p) const { return points_[p].surfaces.temperature(); }  ///< [K]
  [[nodiscard]] double iterations() const { return iterations_ / samples_; }                      ///< mean per sample
  [[nodiscard]] std::size_t given_up() const { return given_up_; }  ///< samples in which they did not converge

 private:
  static constexpr int kMaxIterations = 50;
  static constexpr T kTolerance = 16 * std::numeric_limits<T>::epsilon();

  using Vector = std::array<T, kMaxPoints>;
  using Matrix = std::array<Vector, kMaxPoints>;

  struct Spring {
    T stiffness = 0, resistance = 0, rate = 0;
    [[nodiscard]] T slope() const { return stiffness / 2 + resistance * rate; }  // of its force over the increment
  };

  struct Point {
    ModeShapes<T> shapes, at_hair;
    FrictionTemperature<T> surfaces;
    T normal = 0, stiffness = 0, yield = 0, strain = 0;  // of the bristles
    T free = 0, increment = 0, force = 0, slope = 0;
    T to_bridge = 0, bridge_share = 0;  // receptance to the bridge, force there per newton here

    void press(T normal_n) {
      if (normal_n > normal) strain *= normal / normal_n;
      normal = normal_n;
      stiffness = normal * T(kRosin.bristles.stiffness_per_m);
      yield = surfaces.coefficient() / T(kRosin.bristles.stiffness_per_m);
      strain = std::clamp(strain, -yield, yield);
    }
    // [W(z + x) - W(z)]/x and its slope.
    void follow(T x) {
      const T end = std::clamp(strain + x, -yield, yield), over = std::abs(strain + x - end);
      if (over == 0) {
        force = stiffness * (strain + x / 2), slope = stiffness / 2;
      } else {
        force = stiffness * ((end - strain) * (end + strain) / 2 + yield * over) / x;
        slope = std::max(T(0), (stiffness * end - force) / x);
      }
    }
    void end() {
      const T last = std::clamp(strain + increment, -yield, yield), slip = std::abs(strain + increment - last);
      surfaces.advance(normal, increment, stiffness * yield * slip);
      strain = last;
    }
  };

  void join_body() {
    bridge_ = {T(bowing::BowedProblem::kBridge_n_per_m), T(bowing::BowedProblem::kBridge_kg_per_s), rate_};
    const T receptance = string_.receptance(at_bridge_, at_bridge_) + body_.receptance(of_body_, of_body_);
    bridge_divisor_ = 1 + bridge_.slope() * receptance;
    for (Point& point : points_) {
      point.to_bridge = string_.receptance(at_bridge_, point.shapes);
      point.bridge_share = bridge_.slope() * point.to_bridge / bridge_divisor_;
    }
  }

  // Increments of all points per newton at each, with the springs.
  void couple() {
    const std::size_t n = points_.size();
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = 0; q < n; ++q)
        receptance_[p][q] = string_.receptance(points_[p].shapes, points_[q].shapes) +
                            hair_.receptance(points_[p].at_hair, points_[q].at_hair) -
                            points_[p].to_bridge * points_[q].bridge_share;
    for (std::size_t p = 0; p < n; ++p) {
      Vector unit = {};
      unit[p] = 1;
      inverse_[p] = quotient(receptance_, unit);  // symmetric
    }
  }

  // Force at the bridge if no point has one.
  T begin_bridge() {
    if (body_.size() == 0) return 0;
    body_.predict();
    const T stretch = string_.displacement(at_bridge_) - body_.displacement(of_body_);
    const T free = string_.increment(at_bridge_) - body_.increment(of_body_);
    return (bridge_.stiffness * stretch + bridge_.slope() * free) / bridge_divisor_;
  }

  // Residual x - free + A f(x), and its largest value.
  T residual(Vector& found) {
    T largest = 0;
    for (Point& point : points_) point.follow(point.increment);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      found[p] = points_[p].increment - points_[p].free;
      for (std::size_t q = 0; q < points_.size(); ++q) found[p] += receptance_[p][q] * points_[q].force;
      largest = std::max(largest, std::abs(found[p]));
    }
    return largest;
  }

  // The residual is A times the gradient of a convex function: its derivative along a step.
  [[nodiscard]] T derivative(const Vector& step, const Vector& found) const {
    T sum = 0;
    for (std::size_t p = 0; p < points_.size(); ++p)
      for (std::size_t q = 0; q < points_.size(); ++q) sum += step[p] * inverse_[p][q] * found[q];
    return sum;
  }

  // From the increments of the last sample. A step that is much too long is halved.
  void solve() {
    Vector found;
    T scale = 0;
    for (const Point& point : points_) scale = std::max({scale, std::abs(point.free), std::abs(point.increment)});
    T error = residual(found);
    samples_ += 1;
    for (int i = 0; i < kMaxIterations && error > kTolerance * scale; ++i) {
      iterations_ += 1;
      const Vector step = newton_step(found);
      const T before = derivative(step, found);
      T part = 1, taken = 0;
      do {
        for (std::size_t p = 0; p < points_.size(); ++p) points_[p].increment -= (part - taken) * step[p];
        taken = part, part /= 2;
        error = residual(found);
      } while (derivative(step, found) < -before / 2 && part > T(1e-3));
    }
    given_up_ += error > 1000 * kTolerance * scale;
  }

  [[nodiscard]] Vector newton_step(const Vector& found) const {
    Matrix matrix;
    for (std::size_t p = 0; p < points_.size(); ++p)
      for (std::size_t q = 0; q < points_.size(); ++q)
        matrix[p][q] = T(p == q) + receptance_[p][q] * points_[q].slope;
    return quotient(matrix, found);
  }

  // By elimination with pivots.
  [[nodiscard]] Vector quotient(Matrix matrix, Vector right) const {
    const std::size_t n = points_.size();
    for (std::size_t c = 0; c < n; ++c) {
      std::size_t pivot = c;
      for (std::size_t r = c + 1; r < n; ++r)
        if (std::abs(matrix[r][c]) > std::abs(matrix[pivot][c])) pivot = r;
      std::swap(matrix[c], matrix[pivot]);
      std::swap(right[c], right[pivot]);
      for (std::size_t r = c + 1; r < n; ++r) {
        const T factor = matrix[r][c] / matrix[c][c];
        for (std::size_t q = c; q < n; ++q) matrix[r][q] -= factor * matrix[c][q];
        right[r] -= factor * right[c];
      }
    }
    for (std::size_t r = n; r-- > 0;) {
      for (std::size_t q = r + 1; q < n; ++q) right[r] -= matrix[r][q] * right[q];
      right[r] /= matrix[r][r];
    }
    return right;
  }

  void advance(T bridge) {
    for (Point& point : points_) {
      string_.push(point.shapes, point.force);
      hair_.push(point.at_hair, -point.force);
      bridge += point.bridge_share * point.force;
      point.end();
    }
    hair_.commit();
    if (body_.size() > 0) {
      string_.push(at_bridge_, -bridge);
      body_.push(of_body_, bridge);
      body_.commit();
    }
    string_.commit();
  }

  ModalBank<T> string_, hair_, body_;
  ModeShapes<T> at_bridge_, of_body_;
  T rate_, bridge_divisor_ = 1;
  Spring bridge_;
  std::vector<Point> points_;
  Matrix receptance_ = {}, inverse_ = {};
  double samples_ = 0, iterations_ = 0;
  std::size_t given_up_ = 0;
};

}  // namespace contactspline::bench
