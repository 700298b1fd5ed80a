// SPDX-License-Identifier: MIT
// The search for the lowest of many minima.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "generator/listen/listening_problem.hpp"

namespace contactspline {

using Tell = std::function<void(const std::string&)>;

/// The best of searches from the start and from the two best of places all over the bounds.
[[nodiscard]] Eigen::VectorXd find_place(const ListeningProblem& problem);

struct FoundPlaces {
  Candidate best;
  std::vector<Candidate> others;  ///< minima beside it, some of them the same
};

/// The level of a partial rises and falls as a contact becomes longer or moves, so the cost has many minima: from one
/// of them, one or two numbers may lead to a lower one. Goes there as long as there is one, each time with scales by
/// the residuals. `tell` hears what is done now.
[[nodiscard]] FoundPlaces find_best(ListeningProblem& problem, const Eigen::VectorXd& start, const Tell& tell);

}  // namespace contactspline
