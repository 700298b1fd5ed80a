// SPDX-License-Identifier: MIT
// The open numbers of a recorded instrument as places of a least-squares problem.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "generator/listen/note_renderer.hpp"
#include "generator/listen/note_residuals.hpp"
#include "generator/listen/recorded_instrument.hpp"

namespace contactspline {

/// A place is the logit of the part of the way between the bounds of a number, and back.
[[nodiscard]] double part_at(double place);
[[nodiscard]] double place_of(double part);

/// A place to search from, and the cost there.
struct Candidate {
  double cost;
  Eigen::VectorXd place;
};

/// The notes that are fitted, as a function of places.
class ListeningProblem {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  /// recorded and renderer must outlive it. notes: those of the instrument that are fitted.
  ListeningProblem(const RecordedInstrument& recorded, const NoteRenderer& renderer, std::vector<std::size_t> notes,
                   std::vector<NoteImpression> impressions);

  NotesToMatch matched;

  // NOLINTBEGIN(readability-identifier-naming): names that Ceres asks for
  [[nodiscard]] int NumResiduals() const { return static_cast<int>(count_residuals(matched)); }
  [[nodiscard]] int NumParameters() const { return static_cast<int>(recorded_.open.size()); }
  // NOLINTEND(readability-identifier-naming)

  /// How many numbers stand in the instrument's file; the others are velocities.
  [[nodiscard]] std::size_t open_in_text() const { return recorded_.open_in_text; }
  [[nodiscard]] std::vector<double> numbers_at(const Eigen::VectorXd& places) const;
  [[nodiscard]] Eigen::VectorXd start() const;

  /// Residuals at each of the places; nothing where nothing can be rendered.
  [[nodiscard]] std::vector<std::optional<Residuals>> residuals_at(const std::vector<Eigen::VectorXd>& places) const;

  /// The places with the sums of squares there, infinite where nothing can be rendered.
  [[nodiscard]] std::vector<Candidate> with_costs(const std::vector<Eigen::VectorXd>& places) const;

  /// Both sides of each place, for central differences.
  [[nodiscard]] static std::vector<Eigen::VectorXd> beside(const Eigen::VectorXd& at);

  /// The derivatives from residuals there; 0 where there are none.
  [[nodiscard]] Eigen::MatrixXd slopes(const Eigen::VectorXd& at,
                                       std::span<const std::optional<Residuals>> beside) const;

  /// As Ceres asks, with forward differences.
  bool operator()(const double* parameters, double* residuals, double* jacobian) const;

  /// Where the method of Levenberg and Marquardt gets to in so many steps.
  [[nodiscard]] Eigen::VectorXd search(Eigen::VectorXd from, int max_steps) const;

  /// Sets the scales by the residuals at a place, and searches from there; twice.
  [[nodiscard]] Eigen::VectorXd settle(Eigen::VectorXd at);

 private:
  const RecordedInstrument& recorded_;
  const NoteRenderer& renderer_;
  std::vector<std::size_t> notes_;
};

}  // namespace contactspline
