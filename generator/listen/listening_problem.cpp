// SPDX-License-Identifier: MIT
#include "generator/listen/listening_problem.hpp"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace contactspline {
namespace {

constexpr double kMinPart = 1e-6;  // of the way between two bounds, from each
constexpr double kDerivativePart = 1e-3;

// kDerivativePart of the way between the bounds.
double step_at(double place) {
  const double part = std::clamp(part_at(place), 0.01, 0.99);
  return kDerivativePart / (part * (1 - part));
}

/// Some numbers of a problem as Ceres asks, with forward differences; the others stay.
class SomeNumbers {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  SomeNumbers(const ListeningProblem& problem, const Eigen::VectorXd& from, const std::vector<std::size_t>& numbers)
      : problem_(problem), from_(from), numbers_(numbers) {}

  // NOLINTBEGIN(readability-identifier-naming): names that Ceres asks for
  [[nodiscard]] int NumResiduals() const { return static_cast<int>(count_residuals(problem_.matched)); }
  [[nodiscard]] int NumParameters() const { return static_cast<int>(numbers_.size()); }
  // NOLINTEND(readability-identifier-naming)

  [[nodiscard]] Eigen::VectorXd place(const double* parameters) const {
    Eigen::VectorXd place = from_;
    for (std::size_t i = 0; i < numbers_.size(); ++i) place[static_cast<Eigen::Index>(numbers_[i])] = parameters[i];
    return place;
  }

  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
    constexpr double kRefused = 1e3;
    std::vector<Eigen::VectorXd> places{place(parameters)};
    for (std::size_t i = 0; jacobian != nullptr && i < numbers_.size(); ++i) {
      places.push_back(places.front());
      places.back()[static_cast<Eigen::Index>(numbers_[i])] += step_at(parameters[i]);
    }
    const auto all = problem_.residuals_at(places);
    const auto here = [&](std::size_t r) { return all[0] ? all[0]->values[r] : kRefused; };
    const auto count = static_cast<std::size_t>(NumResiduals());
    for (std::size_t r = 0; r < count; ++r) residuals[r] = here(r);
    for (std::size_t i = 0; i + 1 < places.size(); ++i)
      for (std::size_t r = 0; r < count; ++r)
        jacobian[i * count + r] = all[i + 1] ? (all[i + 1]->values[r] - here(r)) / step_at(parameters[i]) : 0;
    return true;
  }

 private:
  const ListeningProblem& problem_;
  const Eigen::VectorXd& from_;
  const std::vector<std::size_t>& numbers_;
};

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
      acts_on(recorded.open.size(), std::vector<bool>(notes.size(), true)),
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
  Eigen::VectorXd places(static_cast<Eigen::Index>(size()));
  for (std::size_t i = 0; i < recorded_.open.size(); ++i)
    places[static_cast<Eigen::Index>(i)] = place_of(recorded_.open[i].part_of(recorded_.open[i].start));
  return places;
}

bool ListeningProblem::act_together(std::size_t one, std::size_t other) const {
  for (std::size_t n = 0; n < notes_.size(); ++n)
    if (acts_on[one][n] && acts_on[other][n]) return true;
  return false;
}

std::vector<std::size_t> ListeningProblem::all_numbers() const {
  std::vector<std::size_t> numbers(size());
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

std::vector<std::size_t> ListeningProblem::numbers_between(const Eigen::VectorXd& from,
                                                           const Eigen::VectorXd& to) const {
  std::vector<std::size_t> numbers = all_numbers();
  std::vector<bool> is_heard(notes_.size());
  for (const std::size_t number : numbers) {
    if (from[static_cast<Eigen::Index>(number)] == to[static_cast<Eigen::Index>(number)]) continue;
    if (number >= open_in_text()) return numbers;
    for (std::size_t n = 0; n < notes_.size(); ++n) is_heard[n] = is_heard[n] || acts_on[number][n];
  }
  std::erase_if(numbers, [&](std::size_t number) {
    for (std::size_t n = 0; n < notes_.size(); ++n)
      if (acts_on[number][n] && !is_heard[n]) return true;
    return false;
  });
  return numbers;
}

std::vector<RenderedNotes> ListeningProblem::rendered_at(std::span<const Eigen::VectorXd> places) const {
  constexpr std::size_t kMaxKnown = 2000;
  if (known_.size() > kMaxKnown) known_.clear();
  std::vector<NoteToRender> to_render;
  std::vector<Known::iterator> of_places, unknown;
  for (const Eigen::VectorXd& place : places) {
    const std::vector<double> numbers = numbers_at(place);
    for (std::size_t n = 0; n < notes_.size(); ++n) {
      NoteToRender note{notes_[n], {}};
      for (std::size_t i = 0; i < numbers.size(); ++i)
        note.point.push_back(acts_on[i][n] ? numbers[i] : recorded_.open[i].start);
      const auto [at, is_new] = known_.try_emplace({n, note.point});
      of_places.push_back(at);
      if (!is_new) continue;
      unknown.push_back(at);
      to_render.push_back(std::move(note));
    }
  }
  std::vector<std::optional<NoteImpression>> impressions = renderer_.render(to_render);
  for (std::size_t i = 0; i < unknown.size(); ++i) unknown[i]->second = std::move(impressions[i]);
  std::vector<RenderedNotes> rendered(places.size());
  for (std::size_t p = 0; p < places.size(); ++p) {
    const auto of_place = std::span(of_places).subspan(p * notes_.size(), notes_.size());
    if (!std::ranges::all_of(of_place, [](const auto& at) { return at->second.has_value(); })) continue;
    rendered[p].emplace();
    for (const auto& at : of_place) rendered[p]->push_back(*at->second);
  }
  return rendered;
}

std::vector<std::optional<Residuals>> ListeningProblem::residuals_at(std::span<const Eigen::VectorXd> places) const {
  std::vector<std::optional<Residuals>> all;
  for (const RenderedNotes& rendered : rendered_at(places)) {
    all.emplace_back();
    if (rendered) all.back() = residuals_of(matched, *rendered);
  }
  return all;
}

std::vector<Candidate> ListeningProblem::with_costs(const std::vector<Eigen::VectorXd>& places) const {
  constexpr std::size_t kTogether = 128;  // residuals of more would fill the memory
  const std::vector<double> costs = steps.next(places.size(), [&] {
    std::vector<double> computed;
    for (std::size_t begin = 0; begin < places.size(); begin += kTogether)
      for (const auto& residuals :
           residuals_at(std::span(places).subspan(begin, std::min(kTogether, places.size() - begin))))
        computed.push_back(cost_of(residuals));
    return computed;
  });
  std::vector<Candidate> candidates;
  for (std::size_t p = 0; p < places.size(); ++p) candidates.push_back({costs[p], places[p]});
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
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count_residuals(matched)), at.size());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const auto &low = beside[static_cast<std::size_t>(2 * i)], &high = beside[static_cast<std::size_t>(2 * i + 1)];
    if (low && high)
      for (Eigen::Index r = 0; r < slopes.rows(); ++r)
        slopes(r, i) = (high->values[static_cast<std::size_t>(r)] - low->values[static_cast<std::size_t>(r)]) /
                       (2 * step_at(at[i]));
  }
  return slopes;
}

Eigen::VectorXd ListeningProblem::search(const Eigen::VectorXd& from, int max_steps,
                                         const std::vector<std::size_t>& numbers) const {
  const SomeNumbers some(*this, from, numbers);
  std::vector<double> parameters;
  for (const std::size_t number : numbers) parameters.push_back(from[static_cast<Eigen::Index>(number)]);
  ceres::TinySolver<SomeNumbers> solver;
  solver.options.max_num_iterations = max_steps;
  solver.options.initial_trust_region_radius = 10;
  solver.options.function_tolerance = 1e-3;  // of the sum of squares, absolute
  solver.options.parameter_tolerance = 1e-6;
  const std::vector<double> found = steps.next(numbers.size(), [&] {
    Eigen::VectorXd at = Eigen::VectorXd::Map(parameters.data(), std::ssize(parameters));
    solver.Solve(some, &at);
    return std::vector<double>(at.begin(), at.end());
  });
  return some.place(found.data());
}

Eigen::VectorXd ListeningProblem::settle(Eigen::VectorXd at) {
  constexpr double kFar = 4;
  constexpr int kTimes = 2, kMaxSteps = 30;
  for (int time = 0; time < kTimes; ++time) {
    set_scales(matched, renderer_.render_one(numbers_at(at), notes_));
    matched.scales.far_levels = kFar;
    at = search(at, kMaxSteps, all_numbers());
  }
  return at;
}

}  // namespace contactspline
