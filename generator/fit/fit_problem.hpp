// SPDX-License-Identifier: MIT
// The least-squares problem of one set of measurements: its residuals, their noise, and a search from given values.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "generator/fit/residuals.hpp"

namespace contactspline {

/// Of each source, until residuals tell: 2 % of the largest force, or of a value.
inline constexpr double kFirstNoise = 0.02;

/// Values of all unknowns, and of the noise of each source.
struct FitValues {
  std::array<double, kFitParameters> parameters;
  std::vector<std::array<double, kPulseUnknowns>> pulses;
  std::vector<double> noise;
  double cost = 0;
};

/// One source of data: a pulse, a column of a table, a curve.
struct FitSource {
  std::string file, quantity;
  Noise noise;
  std::vector<double> at, measured;
  std::vector<double> scale;  ///< of a residual of 1, in the unit of `measured`
};

/// Residuals in parts of their noise, without the robust norm, and their derivatives with respect to what is free,
/// the parameters first.
struct Linearised {
  Eigen::VectorXd residuals;
  Eigen::MatrixXd jacobian;
};

class FitProblem {
 public:
  explicit FitProblem(const Measurements& measured);
  ~FitProblem();
  FitProblem(const FitProblem&) = delete;
  FitProblem& operator=(const FitProblem&) = delete;

  /// Values to begin a search from, at a given exponent, with `loss` = loss times largest speed, and a memory.
  [[nodiscard]] FitValues begin(double exponent, double loss, double weight, double time_ratio) const;

  /// Searches from `values` with at most so many steps; `frees` in the order of FitParameter.
  [[nodiscard]] FitValues search(FitValues values, const std::vector<FitParameter>& frees, int max_steps) const;

  /// The same values with the noise that their residuals show.
  [[nodiscard]] FitValues with_noise(FitValues values, const std::vector<FitParameter>& frees) const;

  [[nodiscard]] Linearised linearised(const FitValues& at, const std::vector<FitParameter>& frees) const;

  [[nodiscard]] const std::vector<FitSource>& sources() const { return sources_; }
  [[nodiscard]] const std::vector<std::size_t>& source_of_residual() const { return source_of_residual_; }
  [[nodiscard]] double reference_m() const { return scales_.reference_m; }

 private:
  struct Posed;
  [[nodiscard]] std::unique_ptr<Posed> pose(FitValues& values, const std::vector<FitParameter>& frees) const;
  [[nodiscard]] std::pair<double, double> anchor(double exponent) const;
  void add_sources();
  std::size_t source_called(const std::string& file, const std::string& quantity);
  void add_sample(std::size_t source, double at, double measured, double scale);

  const Measurements& measured_;
  mutable FitScales scales_;
  std::vector<FitSource> sources_;
  std::vector<std::size_t> source_of_residual_;
  std::vector<RowResidual> rows_;
  double max_speed_m_per_s_ = 0, duration_s_ = 0;
};

}  // namespace contactspline
