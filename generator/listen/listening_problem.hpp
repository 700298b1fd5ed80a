// SPDX-License-Identifier: MIT
// The open numbers of a recorded instrument as places of a least-squares problem.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "generator/listen/note_renderer.hpp"
#include "generator/listen/note_residuals.hpp"
#include "generator/listen/recorded_instrument.hpp"
#include "generator/listen/search_steps.hpp"

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
  /// recorded and renderer must outlive it. notes: those of the instrument that are fitted.
  ListeningProblem(const RecordedInstrument& recorded, const NoteRenderer& renderer, std::vector<std::size_t> notes,
                   std::vector<NoteImpression> impressions);

  NotesToMatch matched;
  /// Of each number and each fitted note: does the note depend on it? At first all do. A note is rendered with the
  /// starts of the others.
  std::vector<std::vector<bool>> acts_on;
  mutable SearchSteps steps;  ///< each call of with_costs() and of search() is one

  [[nodiscard]] std::size_t size() const { return recorded_.open.size(); }
  /// Is there a note that both numbers act on?
  [[nodiscard]] bool act_together(std::size_t one, std::size_t other) const;
  [[nodiscard]] std::vector<std::size_t> all_numbers() const;
  /// The numbers that act on no other notes than those that differ between two places do; all if a velocity differs.
  [[nodiscard]] std::vector<std::size_t> numbers_between(const Eigen::VectorXd& from,
                                                         const Eigen::VectorXd& to) const;

  /// How many numbers stand in the instrument's file; the others are velocities.
  [[nodiscard]] std::size_t open_in_text() const { return recorded_.open_in_text; }
  [[nodiscard]] std::vector<double> numbers_at(const Eigen::VectorXd& places) const;
  [[nodiscard]] Eigen::VectorXd start() const;

  /// Residuals at each of the places; nothing where nothing can be rendered.
  [[nodiscard]] std::vector<std::optional<Residuals>> residuals_at(std::span<const Eigen::VectorXd> places) const;

  /// The places with the sums of squares there, infinite where nothing can be rendered.
  [[nodiscard]] std::vector<Candidate> with_costs(const std::vector<Eigen::VectorXd>& places) const;

  /// Both sides of each place, for central differences.
  [[nodiscard]] static std::vector<Eigen::VectorXd> beside(const Eigen::VectorXd& at);

  /// The derivatives from residuals there; 0 where there are none.
  [[nodiscard]] Eigen::MatrixXd slopes(const Eigen::VectorXd& at,
                                       std::span<const std::optional<Residuals>> beside) const;

  /// Where the method of Levenberg and Marquardt gets to in so many steps of these numbers, with forward differences.
  [[nodiscard]] Eigen::VectorXd search(const Eigen::VectorXd& from, int max_steps,
                                       const std::vector<std::size_t>& numbers) const;

  /// Sets the scales by the residuals at a place, and searches from there; twice.
  [[nodiscard]] Eigen::VectorXd settle(Eigen::VectorXd at);

 private:
  using Known = std::map<std::pair<std::size_t, std::vector<double>>, std::optional<NoteImpression>>;

  [[nodiscard]] std::vector<RenderedNotes> rendered_at(std::span<const Eigen::VectorXd> places) const;

  const RecordedInstrument& recorded_;
  const NoteRenderer& renderer_;
  std::vector<std::size_t> notes_;
  mutable Known known_;  ///< what was rendered of late: of a fitted note with these numbers
};

}  // namespace contactspline
