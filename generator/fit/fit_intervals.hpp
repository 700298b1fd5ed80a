// SPDX-License-Identifier: MIT
// The intervals that hold the true parameters of a law, of values that were found for them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "generator/fit/fit_problem.hpp"
#include "generator/fit/fit_result.hpp"

namespace contactspline {

/// Intervals of 95 % of an estimate with a robust norm (P. J. Huber, Robust Statistics, 1981, section 7.6), by
/// Student's distribution.
class FitIntervals {
 public:
  FitIntervals(const FitProblem& problem, const FitValues& values, const std::vector<FitParameter>& frees);

  /// That of a sum of parameters, each with a weight; infinite if the data do not tell all that is free.
  [[nodiscard]] Estimate of(const std::vector<std::pair<FitParameter, double>>& sum) const;

 private:
  [[nodiscard]] std::optional<Eigen::Index> column(FitParameter parameter) const;
  [[nodiscard]] Eigen::VectorXd half(const Eigen::VectorXd& weights) const;

  const FitProblem& problem_;
  const FitValues& values_;
  const std::vector<FitParameter>& frees_;
  Linearised linear_;
  std::optional<Eigen::MatrixXd> inverse_;  ///< of the normal matrix
  std::vector<double> freedoms_;            ///< with which the noise of each source is known
  double inflation_;                        ///< of the variance, by the robust norm
};

/// An estimate of e to the power, of a sum with a constant, and of a product with one.
[[nodiscard]] Estimate exponential(const Estimate& of);
[[nodiscard]] Estimate plus(const Estimate& of, double constant);
[[nodiscard]] Estimate times(const Estimate& of, double factor);

/// Without what a material may not have.
[[nodiscard]] Estimate within(Estimate of, Range range);

}  // namespace contactspline
