// SPDX-License-Identifier: MIT
#include "generator/listen/listening_problem.hpp"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace contactspline {
namespace {

constexpr double kMinPart = 1e-6;  // of the way between two bounds, from each
constexpr double kDerivativePart = 1e-3;

// kDerivativePart of the way between the bounds.
double step_at(double place) {
  const double part = std::clamp(part_at(place), 0.01, 0.99);
  return kDerivativePart / (part * (1 - part));
}

double cost_of(const std::optional<Residuals>& residuals) {
  if (!residuals) return std::numeric_limits<double>::infinity();
  return std::transform_reduce(residuals->values.begin(), residuals->values.end(), 0.0, std::plus(),
                               [](double value) { return value * value; });
}

}  // namespace

double part_at(double place) {
  return 1 / (1 + std::exp(-place));
}

double place_of(double part) {
  part = std::clamp(part, kMinPart, 1 - kMinPart);
  return std::log(part / (1 - part));
}

ListeningProblem::ListeningProblem(const RecordedInstrument& recorded, const NoteRenderer& renderer,
                                   std::vector<std::size_t> notes, std::vector<NoteImpression> impressions)
    : matched{std::move(impressions), recorded.has_common_gain},
      recorded_(recorded),
      renderer_(renderer),
      notes_(std::move(notes)) {}

std::vector<double> ListeningProblem::numbers_at(const Eigen::VectorXd& places) const {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < recorded_.open.size(); ++i)
    numbers.push_back(recorded_.open[i].at(part_at(places[static_cast<Eigen::Index>(i)])));
  return numbers;
}

Eigen::VectorXd ListeningProblem::start() const {
  Eigen::VectorXd places(NumParameters());
  for (std::size_t i = 0; i < recorded_.open.size(); ++i)
    places[static_cast<Eigen::Index>(i)] = place_of(recorded_.open[i].part_of(recorded_.open[i].start));
  return places;
}

std::vector<std::optional<Residuals>> ListeningProblem::residuals_at(
    const std::vector<Eigen::VectorXd>& places) const {
  std::vector<std::vector<double>> points;
  for (const Eigen::VectorXd& place : places) points.push_back(numbers_at(place));
  std::vector<std::optional<Residuals>> all;
  for (const RenderedNotes& rendered : renderer_.render(points, notes_)) {
    all.emplace_back();
    if (rendered) all.back() = residuals_of(matched, *rendered);
  }
  return all;
}

std::vector<Candidate> ListeningProblem::with_costs(const std::vector<Eigen::VectorXd>& places) const {
  std::vector<Candidate> candidates;
  for (const auto& residuals : residuals_at(places))
    candidates.push_back({cost_of(residuals), places[candidates.size()]});
  return candidates;
}

std::vector<Eigen::VectorXd> ListeningProblem::beside(const Eigen::VectorXd& at) {
  std::vector<Eigen::VectorXd> places;
  for (Eigen::Index i = 0; i < at.size(); ++i)
    for (const double sign : {-1, 1}) {
      places.push_back(at);
      places.back()[i] += sign * step_at(at[i]);
    }
  return places;
}

Eigen::MatrixXd ListeningProblem::slopes(const Eigen::VectorXd& at,
                                         std::span<const std::optional<Residuals>> beside) const {
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(NumResiduals(), NumParameters());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const auto &low = beside[static_cast<std::size_t>(2 * i)], &high = beside[static_cast<std::size_t>(2 * i + 1)];
    if (low && high)
      for (Eigen::Index r = 0; r < slopes.rows(); ++r)
        slopes(r, i) = (high->values[static_cast<std::size_t>(r)] - low->values[static_cast<std::size_t>(r)]) /
                       (2 * step_at(at[i]));
  }
  return slopes;
}

bool ListeningProblem::operator()(const double* parameters, double* residuals, double* jacobian) const {
  constexpr double kRefused = 1e3;
  const Eigen::VectorXd at = Eigen::Map<const Eigen::VectorXd>(parameters, NumParameters());
  std::vector<Eigen::VectorXd> places{at};
  for (Eigen::Index i = 0; jacobian != nullptr && i < at.size(); ++i) {
    places.push_back(at);
    places.back()[i] += step_at(at[i]);
  }
  const auto all = residuals_at(places);
  const auto here = [&](std::size_t r) { return all[0] ? all[0]->values[r] : kRefused; };
  const auto count = static_cast<std::size_t>(NumResiduals());
  for (std::size_t r = 0; r < count; ++r) residuals[r] = here(r);
  for (std::size_t i = 0; i + 1 < places.size(); ++i)
    for (std::size_t r = 0; r < count; ++r)
      jacobian[i * count + r] = all[i + 1] ? (all[i + 1]->values[r] - here(r)) / step_at(parameters[i]) : 0;
  return true;
}

Eigen::VectorXd ListeningProblem::search(Eigen::VectorXd from, int max_steps) const {
  ceres::TinySolver<ListeningProblem> solver;
  solver.options.max_num_iterations = max_steps;
  solver.options.initial_trust_region_radius = 10;
  solver.options.function_tolerance = 1e-3;  // of the sum of squares, absolute
  solver.options.parameter_tolerance = 1e-6;
  solver.Solve(*this, &from);
  return from;
}

Eigen::VectorXd ListeningProblem::settle(Eigen::VectorXd at) {
  constexpr double kFar = 4;
  constexpr int kTimes = 2, kMaxSteps = 30;
  for (int time = 0; time < kTimes; ++time) {
    set_scales(matched, renderer_.render_one(numbers_at(at), notes_));
    matched.scales.far_levels = kFar;
    at = search(at, kMaxSteps);
  }
  return at;
}

}  // namespace contactspline
