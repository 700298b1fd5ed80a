// SPDX-License-Identifier: MIT
#include "generator/listen/instrument_fit.hpp"

#include <ceres/tiny_solver.h>
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>

#include "generator/listen/note_renderer.hpp"
#include "generator/listen/note_residuals.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr double kMinPart = 1e-6;  // of the way between two bounds, from each
constexpr double kDerivativePart = 1e-3;
constexpr int kFewSteps = 8, kManySteps = 30;

double part_at(double place) {
  return 1 / (1 + std::exp(-place));
}

double place_of(double part) {
  part = std::clamp(part, kMinPart, 1 - kMinPart);
  return std::log(part / (1 - part));
}

/// The notes that are fitted, as a function of places: a place is the logit of the part of the way between two
/// bounds.
class ListeningProblem {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  ListeningProblem(const RecordedInstrument& recorded, const NoteRenderer& renderer, std::vector<std::size_t> notes,
                   std::vector<NoteImpression> impressions)
      : matched{std::move(impressions), recorded.has_common_gain},
        recorded_(recorded),
        renderer_(renderer),
        notes_(std::move(notes)) {}

  NotesToMatch matched;

  // NOLINTBEGIN(readability-identifier-naming): names that Ceres asks for
  [[nodiscard]] int NumResiduals() const { return static_cast<int>(count_residuals(matched)); }
  [[nodiscard]] int NumParameters() const { return static_cast<int>(recorded_.open.size()); }
  // NOLINTEND(readability-identifier-naming)

  [[nodiscard]] std::vector<double> numbers_at(const Eigen::VectorXd& places) const {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < recorded_.open.size(); ++i)
      numbers.push_back(recorded_.open[i].at(part_at(places[static_cast<Eigen::Index>(i)])));
    return numbers;
  }

  [[nodiscard]] Eigen::VectorXd start() const {
    Eigen::VectorXd places(NumParameters());
    for (std::size_t i = 0; i < recorded_.open.size(); ++i)
      places[static_cast<Eigen::Index>(i)] = place_of(recorded_.open[i].part_of(recorded_.open[i].start));
    return places;
  }

  /// Residuals at each of the places; nothing where nothing can be rendered.
  [[nodiscard]] std::vector<std::optional<Residuals>> residuals_at(const std::vector<Eigen::VectorXd>& places) const {
    std::vector<std::vector<double>> points;
    for (const Eigen::VectorXd& place : places) points.push_back(numbers_at(place));
    std::vector<std::optional<Residuals>> all;
    for (const RenderedNotes& rendered : renderer_.render(points, notes_)) {
      all.emplace_back();
      if (rendered) all.back() = residuals_of(matched, *rendered);
    }
    return all;
  }

  [[nodiscard]] static double cost_of(const std::optional<Residuals>& residuals) {
    if (!residuals) return std::numeric_limits<double>::infinity();
    return std::transform_reduce(residuals->values.begin(), residuals->values.end(), 0.0, std::plus(),
                                 [](double value) { return value * value; });
  }

  /// Both sides of each place, for central differences.
  [[nodiscard]] static std::vector<Eigen::VectorXd> beside(const Eigen::VectorXd& at) {
    std::vector<Eigen::VectorXd> places;
    for (Eigen::Index i = 0; i < at.size(); ++i)
      for (const double sign : {-1, 1}) {
        places.push_back(at);
        places.back()[i] += sign * step_at(at[i]);
      }
    return places;
  }

  /// The derivatives from residuals there; 0 where there are none.
  [[nodiscard]] Eigen::MatrixXd slopes(const Eigen::VectorXd& at,
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

  /// With forward differences.
  bool operator()(const double* parameters, double* residuals, double* jacobian) const {
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

  [[nodiscard]] Eigen::VectorXd search(Eigen::VectorXd from, int max_steps) const {
    ceres::TinySolver<ListeningProblem> solver;
    solver.options.max_num_iterations = max_steps;
    solver.options.initial_trust_region_radius = 10;
    solver.options.function_tolerance = 1e-3;  // of the sum of squares, absolute
    solver.options.parameter_tolerance = 1e-6;
    solver.Solve(*this, &from);
    return from;
  }

 private:
  // kDerivativePart of the way between the bounds.
  [[nodiscard]] static double step_at(double place) {
    const double part = std::clamp(part_at(place), 0.01, 0.99);
    return kDerivativePart / (part * (1 - part));
  }

  const RecordedInstrument& recorded_;
  const NoteRenderer& renderer_;
  std::vector<std::size_t> notes_;
};

// The radical inverse: numbers of this base fill 0 to 1 evenly (J. H. Halton, Numerische Mathematik 2, 1960).
double halton(std::size_t number, std::size_t base) {
  double part = 0, digit = 1;
  for (; number > 0; number /= base)
    part += (digit /= static_cast<double>(base)) * static_cast<double>(number % base);
  return part;
}

std::vector<std::size_t> first_primes(std::size_t count) {
  std::vector<std::size_t> primes;
  for (std::size_t n = 2; primes.size() < count; ++n)
    if (std::ranges::none_of(primes, [&](std::size_t prime) { return n % prime == 0; })) primes.push_back(n);
  return primes;
}

// Places all over the box, the start first. Velocities stay at their start.
std::vector<Eigen::VectorXd> scattered(const RecordedInstrument& recorded, const Eigen::VectorXd& start) {
  constexpr std::size_t kEach = 24, kMost = 240;
  const std::size_t open = recorded.open_in_text;
  const std::vector<std::size_t> bases = first_primes(open);
  std::vector<Eigen::VectorXd> places{start};
  for (std::size_t k = 1; k <= std::min(kMost, kEach * open); ++k) {
    places.push_back(start);
    for (std::size_t i = 0; i < open; ++i)
      places.back()[static_cast<Eigen::Index>(i)] = place_of(halton(k, bases[i]));
  }
  return places;
}

/// A place to search from, and the cost there.
struct Candidate {
  double cost;
  Eigen::VectorXd place;
};

std::vector<Candidate> with_costs(const ListeningProblem& problem, const std::vector<Eigen::VectorXd>& places) {
  std::vector<Candidate> candidates;
  for (const auto& residuals : problem.residuals_at(places))
    candidates.push_back({ListeningProblem::cost_of(residuals), places[candidates.size()]});
  return candidates;
}

// The best of searches from the start and from the two best of places all over the box.
Eigen::VectorXd find_place(const RecordedInstrument& recorded, const ListeningProblem& problem) {
  constexpr std::size_t kBest = 2;
  std::vector<Eigen::VectorXd> places = scattered(recorded, problem.start());
  std::vector<Candidate> candidates = with_costs(problem, places);
  std::vector<Eigen::VectorXd> found{problem.search(places[0], kFewSteps)};
  std::ranges::sort(candidates, {}, &Candidate::cost);
  candidates.resize(std::min(kBest, candidates.size()));
  for (const Candidate& candidate : candidates) found.push_back(problem.search(candidate.place, kFewSteps));
  return std::ranges::min(with_costs(problem, found), {}, &Candidate::cost).place;
}

// Where one number alone moves over its bounds, and by little. Adds those that have another place almost as good to
// `loose`.
std::vector<Candidate> along_each(const ListeningProblem& problem, const Candidate& from,
                                  std::vector<Eigen::Index>& loose) {
  constexpr int kScanned = 24;
  constexpr std::array kNear = {0.0025, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06};  // of the way between bounds
  constexpr std::size_t kEach = kScanned + 2 * kNear.size();
  constexpr double kLoose = 5;
  std::vector<Eigen::VectorXd> places;
  for (Eigen::Index i = 0; i < from.place.size(); ++i) {
    std::vector<double> parts;
    for (int k = 0; k < kScanned; ++k) parts.push_back((k + 0.5) / kScanned);
    for (const double near : kNear)
      for (const double sign : {-1, 1}) parts.push_back(part_at(from.place[i]) + sign * near);
    for (const double part : parts) {
      places.push_back(from.place);
      places.back()[i] = place_of(part);
    }
  }
  std::vector<Candidate> all = with_costs(problem, places);
  for (Eigen::Index i = 0; i < from.place.size(); ++i) {
    const auto of_number = std::span(all).subspan(static_cast<std::size_t>(i) * kEach, kEach);
    const auto is_near = [&](const Candidate& candidate) {
      return std::abs(part_at(candidate.place[i]) - part_at(from.place[i])) < 1.0 / kScanned;
    };
    if (std::ranges::any_of(of_number, [&](const Candidate& candidate) {
          return !is_near(candidate) && candidate.cost < kLoose * from.cost;
        }))
      loose.push_back(i);
  }
  return all;
}

// Where each two of these numbers move at once.
std::vector<Candidate> along_pairs(const ListeningProblem& problem, const Candidate& from,
                                   const std::vector<Eigen::Index>& loose) {
  constexpr std::size_t kEach = 32, kMost = 640;
  std::vector<Eigen::VectorXd> places;
  for (std::size_t k = 1; k <= kEach; ++k)
    for (std::size_t i = 0; i < loose.size(); ++i)
      for (std::size_t j = 0; j < i && places.size() < kMost; ++j) {
        places.push_back(from.place);
        places.back()[loose[i]] = place_of(halton(k, 2));
        places.back()[loose[j]] = place_of(halton(k, 3));
      }
  return with_costs(problem, places);
}

// The best of these that are not near a better one, nor, unless they are better, where the search is.
std::vector<Eigen::VectorXd> best_apart(std::vector<Candidate> candidates, const Candidate& at) {
  constexpr std::size_t kTried = 6;
  constexpr double kApart = 0.08;  // of the way between bounds
  std::ranges::sort(candidates, {}, &Candidate::cost);
  std::vector<Eigen::VectorXd> best;
  for (const Candidate& candidate : candidates) {
    const auto is_near = [&](const Eigen::VectorXd& other) {
      return (candidate.place.unaryExpr(&part_at) - other.unaryExpr(&part_at)).cwiseAbs().maxCoeff() < kApart;
    };
    if (candidate.cost >= at.cost && is_near(at.place)) continue;
    if (best.size() < kTried && std::ranges::none_of(best, is_near)) best.push_back(candidate.place);
  }
  return best;
}

// The level of a partial rises and falls as a contact becomes longer or moves, so the cost has many minima: from one
// of them, one or two numbers may lead to a lower one. Goes there as long as there is one.
Eigen::VectorXd find_lower(const ListeningProblem& problem, const Eigen::VectorXd& start) {
  constexpr int kTimes = 6;
  constexpr double kLower = 0.98;
  Candidate at = with_costs(problem, {start}).front();
  for (int time = 0; time < kTimes; ++time) {
    std::vector<Eigen::Index> loose;
    std::vector<Candidate> candidates = along_each(problem, at, loose);
    std::ranges::move(along_pairs(problem, at, loose), std::back_inserter(candidates));
    std::vector<Eigen::VectorXd> found;
    for (const Eigen::VectorXd& place : best_apart(std::move(candidates), at))
      found.push_back(problem.search(place, kFewSteps));
    const std::vector<Candidate> lower = with_costs(problem, found);
    const auto best = std::ranges::min_element(lower, {}, &Candidate::cost);
    if (best == lower.end() || best->cost > kLower * at.cost) break;
    at = *best;
  }
  return at.place;
}

/// Half widths of 95 % intervals of the places, infinite where the recordings tell nothing. Of two estimates of the
/// variance the larger one: that of independent residuals, of eight levels one, and the sandwich estimate with groups
/// of residuals that may depend on each other (P. J. Huber, Proc. 5th Berkeley Symp., 1967; K.-Y. Liang and S. L.
/// Zeger, Biometrika 73, 1986).
Eigen::VectorXd half_widths(const Residuals& residuals, const Eigen::MatrixXd& slopes) {
  constexpr double kLeastTold = 1e-6;  // of an eigenvalue, where all are 1 if no two numbers act alike
  const Eigen::Index open = slopes.cols();
  Eigen::VectorXd scale = slopes.colwise().norm();
  const Eigen::VectorXd told = scale;
  for (double& norm : scale) norm = norm > 0 ? norm : 1;
  const Eigen::MatrixXd scaled = slopes * scale.cwiseInverse().asDiagonal();
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(residuals.group_count), open);
  for (Eigen::Index r = 0; r < scaled.rows(); ++r)
    scores.row(static_cast<Eigen::Index>(residuals.groups[static_cast<std::size_t>(r)])) +=
        residuals.values[static_cast<std::size_t>(r)] * scaled.row(r);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled.transpose() * scaled);
  const double groups = static_cast<double>(residuals.group_count), freedom = std::max(1.0, groups - double(open));
  const Eigen::VectorXd inverse =
      eigen.eigenvalues().unaryExpr([](double value) { return value > kLeastTold ? 1 / value : 0.0; });
  const Eigen::MatrixXd bread = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  const Eigen::MatrixXd covariance = bread * (scores.transpose() * scores) * bread * (groups / freedom);
  const double quantile = boost::math::quantile(boost::math::students_t(freedom), 0.975);
  const Eigen::VectorXd variance = covariance.diagonal().cwiseMax(bread.diagonal());
  Eigen::VectorXd widths = quantile * variance.cwiseSqrt().cwiseQuotient(scale);
  for (Eigen::Index i = 0; i < open; ++i)
    for (Eigen::Index e = 0; e < open; ++e)
      if (told[i] == 0 || (eigen.eigenvalues()[e] <= kLeastTold && std::abs(eigen.eigenvectors()(i, e)) > 0.1))
        widths[i] = std::numeric_limits<double>::infinity();
  return widths;
}

std::vector<FoundNumber> found_numbers(const RecordedInstrument& recorded, const ListeningProblem& problem,
                                       const Eigen::VectorXd& at) {
  constexpr double kAtBound = 0.005;  // of the way
  std::vector<Eigen::VectorXd> places{at};
  for (Eigen::VectorXd& place : ListeningProblem::beside(at)) places.push_back(std::move(place));
  const auto residuals = problem.residuals_at(places);
  const Eigen::VectorXd widths =
      half_widths(residuals[0].value(), problem.slopes(at, std::span(residuals).subspan(1)));
  std::vector<FoundNumber> numbers;
  for (std::size_t i = 0; i < recorded.open.size(); ++i) {
    const double place = at[static_cast<Eigen::Index>(i)], width = widths[static_cast<Eigen::Index>(i)];
    const OpenNumber& open = recorded.open[i];
    numbers.push_back({open.at(part_at(place)), open.at(part_at(place - width)), open.at(part_at(place + width)),
                       std::abs(part_at(place) - 0.5) > 0.5 - kAtBound, std::isfinite(width)});
  }
  return numbers;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  for (double& value : values) value = std::abs(value);
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

// Of each note; a common one is that of the fitted notes.
std::vector<double> shown_gains(const std::vector<NoteImpression>& recorded,
                                const std::vector<NoteImpression>& rendered, const RecordedInstrument& fit) {
  if (!fit.has_common_gain) return gains_of({recorded}, rendered);
  std::vector<NoteImpression> theirs, ours;
  for (std::size_t n = 0; n < recorded.size(); ++n)
    if (!fit.notes[n].is_kept) theirs.push_back(recorded[n]), ours.push_back(rendered[n]);
  return std::vector<double>(recorded.size(), gains_of({theirs, true}, ours).front());
}

// The rendered notes get their gain.
std::vector<NoteDistance> distances_of(const std::vector<NoteImpression>& recorded,
                                       std::vector<NoteImpression>& rendered, const RecordedInstrument& fit) {
  const std::vector<double> gains = shown_gains(recorded, rendered, fit);
  std::vector<NoteDistance> distances;
  for (std::size_t n = 0; n < recorded.size(); ++n) {
    const LevelDistance levels = level_distance(recorded[n], rendered[n], gains[n]);
    distances.push_back(
        {levels.all_db, levels.noise_db, median_of(compare(recorded[n], rendered[n], gains[n]).cents)});
    for (double& power : rendered[n].power) power *= std::pow(10, gains[n] / 10);
  }
  return distances;
}

std::vector<NoteImpression> recorded_impressions(const RecordedInstrument& recorded) {
  constexpr double kDepth_db = 40;
  constexpr std::size_t kMaxPartials = 10;
  std::vector<NoteImpression> impressions;
  for (const RecordedNote& note : recorded.notes) {
    impressions.push_back(impression_of(note.recording.samples, note.recording.sample_rate_hz, recorded.seconds,
                                        kDepth_db, kMaxPartials));
    if (impressions.back().power.empty())
      refuse(note.file, "samples", "end less than 0.05 s after the onset", "0.1 s or more of a note");
  }
  return impressions;
}

void require_pitch(const RecordedInstrument& recorded, const std::vector<FittedNote>& notes) {
  constexpr double kFarthest_cents = 80;
  for (std::size_t n = 0; n < notes.size(); ++n) {
    if (recorded.notes[n].is_kept || notes[n].recorded.partials.empty()) continue;
    const double cents = compare(notes[n].recorded, notes[n].found, 0).cents.front();
    if (std::abs(cents) >= kFarthest_cents)
      refuse(recorded.notes[n].file, "samples",
             fmt::format("the strongest partial, of {:.5g} Hz, is {:.0f} cents from the nearest of key {} within the "
                         "bounds",
                         notes[n].recorded.partials.front().frequency_hz, std::abs(cents), recorded.notes[n].key),
             "a recording of this key, or wider bounds");
  }
}

}  // namespace

InstrumentFit fit_instrument(const RecordedInstrument& recorded, const ReadFile& read,
                             const std::function<void(const std::string&)>& tell) {
  constexpr double kNear_cents = 40, kNear = 4;
  const std::vector<NoteImpression> impressions = recorded_impressions(recorded);
  const NoteRenderer renderer(recorded, read);
  std::vector<std::size_t> all(impressions.size()), fitted;
  std::iota(all.begin(), all.end(), 0);
  std::ranges::copy_if(all, std::back_inserter(fitted), [&](std::size_t n) { return !recorded.notes[n].is_kept; });
  std::vector<NoteImpression> heard;
  for (const std::size_t n : fitted) heard.push_back(impressions[n]);
  ListeningProblem problem(recorded, renderer, fitted, heard);
  std::vector<NoteImpression> started = renderer.render_one(problem.numbers_at(problem.start()), all);
  const auto before = distances_of(impressions, started, recorded);
  tell("trying numbers all over their bounds");
  Eigen::VectorXd at = find_place(recorded, problem);
  tell("searching");
  problem.matched.scales.far_cents = kNear_cents;
  at = find_lower(problem, problem.search(at, kManySteps));
  for (int time = 0; time < 2; ++time) {
    set_scales(problem.matched, renderer.render_one(problem.numbers_at(at), fitted));
    problem.matched.scales.far_levels = kNear;
    at = problem.search(at, kManySteps);
  }
  std::vector<NoteImpression> found = renderer.render_one(problem.numbers_at(at), all);
  const auto after = distances_of(impressions, found, recorded);
  InstrumentFit fit;
  for (const std::size_t n : all)
    fit.notes.push_back({before[n], after[n], impressions[n], std::move(started[n]), std::move(found[n])});
  require_pitch(recorded, fit.notes);
  fit.numbers = found_numbers(recorded, problem, at);
  return fit;
}

}  // namespace contactspline
