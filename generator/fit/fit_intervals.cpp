// SPDX-License-Identifier: MIT
#include "generator/fit/fit_intervals.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace contactspline {
namespace {

double inflation_of(const Linearised& linear) {
  const auto n = static_cast<double>(linear.residuals.size());
  const auto free = static_cast<double>(linear.normal.cols());
  double squares = 0, slope = 0, square_of_slope = 0;  // of the norm's first derivative, and means of its second
  for (const double r : linear.residuals) {
    const double u = 1 + r * r / (kRobust * kRobust), second = 1 / (u * std::sqrt(u));
    squares += r * r / u;
    slope += second / n;
    square_of_slope += second * second / n;
  }
  const double few = 1 + free / n * (square_of_slope / (slope * slope) - 1);
  return few * few * squares / std::max(0.25, n - free) / (slope * slope);
}

// Durations and largest forces are powers of the speed, v^-b and v^(1 + b) with b = (a - 1)/(a + 1): b is as
// uncertain upwards as downwards, and the exponent is not.
double exponent_moved(double exponent, double by) {
  constexpr double kMost = 0.999;
  const double b = (exponent - 1) / (exponent + 1), slope = 2 / ((exponent + 1) * (exponent + 1));
  const double moved = std::clamp(b + slope * by, -kMost, kMost);
  return (1 + moved) / (1 - moved);
}

}  // namespace

FitIntervals::FitIntervals(const FitProblem& problem, const FitValues& values, const std::vector<FitParameter>& frees)
    : problem_(problem),
      values_(values),
      frees_(frees),
      linear_(problem.linearised(values, frees)),
      inverse_(linear_.inverse()),
      freedoms_(problem.freedoms_of(linear_)),
      inflation_(inflation_of(linear_)) {
  for (std::size_t s = 0; s < freedoms_.size(); ++s) freedoms_[s] /= values.together[s];
}

std::optional<Eigen::Index> FitIntervals::column(FitParameter parameter) const {
  const auto found = std::ranges::find(frees_, parameter);
  if (found == frees_.end()) return std::nullopt;
  return found - frees_.begin();
}

// By how much each free value moves to the upper end of a sum with these weights. The noise of each source is known
// with degrees of freedom of its own; what that leaves for the sum is F. E. Satterthwaite's approximation (Biometrics
// Bulletin 2, 1946).
Eigen::VectorXd FitIntervals::half(const Eigen::VectorXd& weights) const {
  const Eigen::VectorXd gain = *inverse_ * weights;
  struct Part {
    const double* noise;
    double variance, freedom;
  };
  std::vector<Part> parts;  // one for each noise, in the order of the sources: sums do not depend on addresses
  for (std::size_t s = 0; s < linear_.sources.size(); ++s) {
    const auto& [columns, normal] = linear_.sources[s];
    const double* const noise = problem_.sources()[s].noise.get();
    auto part = std::ranges::find(parts, noise, &Part::noise);
    if (part == parts.end()) part = parts.insert(part, {noise, 0, 0});
    part->variance += gain(columns).dot(normal * gain(columns)) * inflation_ * values_.together[s];
    part->freedom = freedoms_[s];
  }
  double variance = 0, squares = 0;
  for (const Part& part : parts) {
    variance += part.variance;
    squares += part.variance * part.variance / part.freedom;
  }
  if (!(variance > 0)) return Eigen::VectorXd::Zero(weights.size());
  const boost::math::students_t student(std::max(1.0, variance * variance / squares));
  return quantile(student, 0.975) * std::sqrt(variance) / weights.dot(gain) * gain;
}

Estimate FitIntervals::of(const std::vector<std::pair<FitParameter, double>>& sum) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(linear_.normal.cols());
  double value = 0;
  for (const auto& [parameter, weight] : sum) {
    value += weight * values_.parameters[parameter];
    if (const auto at = column(parameter)) weights[*at] += weight;
  }
  if (!inverse_) return {value, -kInfinity, kInfinity};
  const Eigen::VectorXd to_end = half(weights);
  const auto end = [&](double sign) {
    double moved = 0;
    for (const auto& [parameter, weight] : sum) {
      const auto at = column(parameter);
      const double from = values_.parameters[parameter], by = at ? sign * to_end[*at] : 0;
      moved += weight * (parameter == kExponent ? exponent_moved(from, by) : from + by);
    }
    return moved;
  };
  return {value, end(-1), end(1)};
}

Estimate exponential(const Estimate& of) {
  return {std::exp(of.value), std::exp(of.low), std::exp(of.high)};
}

Estimate plus(const Estimate& of, double constant) {
  return {of.value + constant, of.low + constant, of.high + constant};
}

Estimate times(const Estimate& of, double factor) {
  return {factor * of.value, factor * of.low, factor * of.high};
}

Estimate within(Estimate of, Range range) {
  of.low = std::clamp(std::min(of.low, of.high), range.min, std::max(range.min, of.value));
  of.high = std::clamp(std::max(of.low, of.high), std::min(of.value, range.max), range.max);
  return of;
}

}  // namespace contactspline
