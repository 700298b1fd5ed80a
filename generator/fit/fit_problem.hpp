// SPDX-License-Identifier: MIT
// The least-squares problem of one set of measurements: its residuals, their noise, and a search from given values.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "generator/fit/residuals.hpp"

namespace contactspline {

/// Of each source, until residuals tell: 2 % of the largest force, or of a value.
inline constexpr double kFirstNoise = 0.02;

/// No noise is taken to be less.
inline constexpr double kMinNoise = 1e-7;

/// Values of all unknowns, and of the noise of each source.
struct FitValues {
  std::array<double, kFitParameters> parameters;
  std::vector<std::array<double, kPulseUnknowns>> pulses;
  std::vector<std::array<double, kBlowUnknowns>> blows;
  std::vector<double> noise;
  std::vector<double> together;  ///< samples of each source that tell as much as an independent one
  double cost = 0;
  int low_pass_order = 0;  ///< of a low-pass that is fitted, 0: none
};

/// One source of data: a pulse, a column of a table, a curve, the levels of a blow.
struct FitSource {
  std::string file, quantity;
  Noise noise;  ///< sources that have it in common are taken together
  std::vector<double> at, measured;
  std::vector<double> scale;  ///< of a residual of 1, in the unit of `measured`
};

/// What one source adds to the normal matrix: in these columns.
struct SourceNormal {
  std::vector<Eigen::Index> columns;
  Eigen::MatrixXd normal;
};

/// Residuals in parts of their noise, without the robust norm, and the normal matrix of what is free, the parameters
/// first.
struct Linearised {
  std::vector<double> residuals;
  Eigen::MatrixXd normal;  ///< the products of the derivatives with respect to each two free values
  std::vector<SourceNormal> sources;

  /// Nothing if they do not tell all values.
  [[nodiscard]] std::optional<Eigen::MatrixXd> inverse() const;
};

/// The least noise that a source is taken to have, in the unit of its residuals.
[[nodiscard]] double min_noise(const FitSource& source);

/// Of pulses: some show where the values lie, all show them as exactly as they can be known.
enum class Samples { kSome, kAll };

class FitProblem {
 public:
  explicit FitProblem(const Measurements& measured);
  ~FitProblem();
  FitProblem(const FitProblem&) = delete;
  FitProblem& operator=(const FitProblem&) = delete;

  /// Values to begin a search from, at a given exponent, with `loss` = loss times largest speed, and a memory.
  [[nodiscard]] FitValues begin(double exponent, double loss, double weight, double time_ratio) const;

  /// The same with a core from a depth on, in parts of the largest compression that they reach, where law and core
  /// press equally.
  [[nodiscard]] FitValues with_core(FitValues values, double depth) const;

  /// Searches from `values` with at most so many steps; `frees` in the order of FitParameter.
  [[nodiscard]] FitValues search(FitValues values, const std::vector<FitParameter>& frees, int max_steps,
                                 Samples samples) const;

  /// Degrees of freedom of each source: its samples less what they determine of the free values; of sources that have
  /// their noise in common together.
  [[nodiscard]] std::vector<double> freedoms_of(const Linearised& linear) const;

  /// ln of the frequency [Hz] of which a contact lasts so many periods.
  [[nodiscard]] double log_frequency(double periods) const;

  /// How many values a search moves: these, and what is unknown of each pulse and blow.
  [[nodiscard]] std::size_t free_values(const std::vector<FitParameter>& frees) const;

  /// The same values with the noise that their residuals show.
  [[nodiscard]] FitValues with_noise(FitValues values, const std::vector<FitParameter>& frees) const;

  /// Exponents to begin a search from.
  [[nodiscard]] const std::vector<double>& likely_exponents() const { return likely_exponents_; }

  [[nodiscard]] Linearised linearised(const FitValues& at, const std::vector<FitParameter>& frees) const;

  [[nodiscard]] const std::vector<FitSource>& sources() const { return sources_; }
  [[nodiscard]] const std::vector<std::size_t>& source_of_residual() const { return source_of_residual_; }
  [[nodiscard]] double reference_m() const { return scales_.reference_m; }
  [[nodiscard]] ViscoelasticLaw<double> law(const FitValues& values) const;

 private:
  struct Posed;
  [[nodiscard]] std::unique_ptr<Posed> pose(FitValues& values, const std::vector<FitParameter>& frees,
                                            Samples samples) const;
  [[nodiscard]] DenseTimes dense_for(const Pulse& pulse, std::size_t number) const;
  [[nodiscard]] std::pair<double, double> anchor(double exponent) const;
  [[nodiscard]] double speed_of(const Blow& blow) const;
  double set_gains(FitValues& values) const;
  void take_contact(double mass_kg, double duration_s);
  [[nodiscard]] std::vector<FitValues> scanned_contacts();
  void find_contact();
  [[nodiscard]] FitValues contact_from(std::size_t partials, const std::vector<double>& frequencies);
  [[nodiscard]] FitValues search_contact(const FitValues& from) const;
  [[nodiscard]] FitValues best_beside(FitValues best) const;
  void add_sources();
  void add_levels();
  std::size_t source_called(const std::string& file, const std::string& quantity);
  void add_sample(std::size_t source, double at, double measured, double scale);

  const Measurements& measured_;
  mutable FitScales scales_;
  std::vector<PulseMeasures> pulse_measures_;
  std::vector<Pulse> some_samples_;
  std::vector<FitSource> sources_;
  std::vector<std::size_t> source_of_residual_;
  std::vector<RowResidual> rows_;
  std::size_t first_curve_ = 0;  ///< among the sources; the blows follow the curves
  double max_speed_m_per_s_ = 0, duration_s_ = 0;
  std::optional<std::pair<double, double>> contact_;  ///< compression and force of blows on a resonator
  std::vector<double> likely_exponents_{1.5, 2.5, 3.5};
};

}  // namespace contactspline
