// SPDX-License-Identifier: MIT
#include "generator/listen/instrument_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>

#include "generator/listen/note_doubts.hpp"
#include "generator/listen/note_renderer.hpp"
#include "generator/listen/place_search.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

/// Half widths of 95 % intervals of the places, and the quantile that they stand for.
struct HalfWidths {
  Eigen::VectorXd of_places;
  double quantile;
};

/// Half the width of each interval, infinite where the recordings tell nothing. Of two estimates of the variance the
/// larger one: that of independent residuals, of eight levels one, and the sandwich estimate with groups of residuals
/// that may depend on each other (P. J. Huber, Proc. 5th Berkeley Symp., 1967; K.-Y. Liang and S. L. Zeger,
/// Biometrika 73, 1986).
HalfWidths half_widths(const Residuals& residuals, const Eigen::MatrixXd& slopes) {
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
  return {widths, quantile};
}

std::vector<FoundNumber> found_numbers(const RecordedInstrument& recorded, const ListeningProblem& problem,
                                       const FoundPlaces& found) {
  constexpr double kAtBound = 0.005;  // of the way
  const Eigen::VectorXd& at = found.best.place;
  std::vector<Eigen::VectorXd> places{at};
  for (Eigen::VectorXd& place : ListeningProblem::beside(at)) places.push_back(std::move(place));
  const auto residuals = problem.residuals_at(places);
  const HalfWidths widths = half_widths(residuals[0].value(), problem.slopes(at, std::span(residuals).subspan(1)));
  std::vector<FoundNumber> numbers;
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const double place = at[i], width = widths.of_places[i], most = std::pow(widths.quantile, 2);
    double low = place - width, high = place + width;
    for (const Candidate& other : found.others)
      if (const double more = std::max(0.0, other.cost - found.best.cost); more < most) {
        low = std::min(low, other.place[i] - width * std::sqrt(1 - more / most));
        high = std::max(high, other.place[i] + width * std::sqrt(1 - more / most));
      }
    const OpenNumber& open = recorded.open[static_cast<std::size_t>(i)];
    numbers.push_back({open.at(part_at(place)), open.at(part_at(low)), open.at(part_at(high)),
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
    impressions.push_back(
        impression_of({note.recording.samples, note.recording.sample_rate_hz, note.recording.sample_rate_hz},
                      recorded.seconds, kDepth_db, kMaxPartials));
    if (impressions.back().power.empty())
      refuse(note.file, "samples", "end less than 0.05 s after the onset", "0.1 s or more of a note");
  }
  return impressions;
}

// At the start or behind it, with each number at its lower and at its upper bound.
std::vector<std::vector<double>> with_each_bound(const RecordedInstrument& recorded, const std::vector<double>& at) {
  std::vector<std::vector<double>> points{at};
  for (std::size_t i = 0; i < at.size(); ++i)
    for (const double bound : {recorded.open[i].bounds.min, recorded.open[i].bounds.max}) {
      points.push_back(at);
      points.back()[i] = bound;
    }
  return points;
}

// Does a note change, not only far below any noise, where another rendering of it stands in its place?
bool changes(const NotesToMatch& matched, std::vector<NoteImpression> notes, const Residuals& here, std::size_t n,
             const NoteImpression& other) {
  constexpr double kLeastSquares = 1e-4;  // with scales of 3 dB
  if (notes[n].power == other.power) return false;
  notes[n] = other;
  const Residuals there = residuals_of(matched, notes);
  return std::transform_reduce(here.values.begin(), here.values.end(), there.values.begin(), 0.0, std::plus(),
                               [](double a, double b) { return (a - b) * (a - b); }) >= kLeastSquares;
}

// Adds the notes that change where a number goes to its bounds; a bound that does not play tells nothing.
void add_effects(std::span<const RenderedNotes> at_bounds, const NotesToMatch& matched,
                 std::vector<std::vector<bool>>& acts_on) {
  if (!at_bounds[0]) return;
  const Residuals here = residuals_of(matched, *at_bounds[0]);
  for (std::size_t i = 0; i < acts_on.size(); ++i)
    for (const RenderedNotes& there : at_bounds.subspan(1 + 2 * i, 2))
      for (std::size_t n = 0; there && n < acts_on[i].size(); ++n)
        acts_on[i][n] = acts_on[i][n] || changes(matched, *at_bounds[0], here, n, (*there)[n]);
}

// A number that changes no note, but does not play at one of its bounds, is taken to act on all.
void add_untold(std::span<const RenderedNotes> at_bounds, std::vector<std::vector<bool>>& acts_on) {
  for (std::size_t i = 0; i < acts_on.size(); ++i)
    if (std::ranges::find(acts_on[i], true) == acts_on[i].end() && (!at_bounds[1 + 2 * i] || !at_bounds[2 + 2 * i]))
      acts_on[i].assign(acts_on[i].size(), true);
}

// Sets which numbers act on which notes, at the start or at another place. Throws BadInput where no search could
// help: a number that acts on none, and a recording of a pitch out of reach.
void require_fit(const RecordedInstrument& recorded, const NoteRenderer& renderer, std::span<const std::size_t> notes,
                 ListeningProblem& problem) {
  constexpr double kOtherPart = 0.3;
  std::vector<double> start, other;
  for (const OpenNumber& open : recorded.open) start.push_back(open.start), other.push_back(open.at(kOtherPart));
  const std::vector<RenderedNotes> at_start = renderer.render(with_each_bound(recorded, start), notes);
  std::vector<std::vector<bool>> acts_on(start.size(), std::vector<bool>(notes.size()));
  add_effects(at_start, problem.matched, acts_on);
  const auto acts_on_all = [](const std::vector<bool>& acts) { return std::ranges::find(acts, false) == acts.end(); };
  if (!std::ranges::all_of(acts_on, acts_on_all))
    add_effects(renderer.render(with_each_bound(recorded, other), notes), problem.matched, acts_on);
  add_untold(at_start, acts_on);
  for (std::size_t i = 0; i < start.size(); ++i) {
    if (std::ranges::find(acts_on[i], true) != acts_on[i].end()) continue;
    const OpenNumber& open = recorded.open[i];
    refuse(i < recorded.open_in_text ? recorded.file : recorded.fit_file, open.key,
           fmt::format("the recorded notes do not depend on it from {} to {}", open.bounds.min, open.bounds.max),
           fmt::format("a number in its place, such as {:.6g}", open.start));
  }
  require_pitch_in_reach(recorded, notes, problem.matched.recorded, at_start);
  problem.acts_on = std::move(acts_on);
}

// A digest of all that a search depends on (G. Fowler, L. C. Noll, K.-P. Vo, FNV-1a of 64 bits): of the files, and of
// what is rendered at the start by the materials that they name and by this program.
std::string digest_of(const RecordedInstrument& recorded, const std::vector<NoteImpression>& started) {
  std::uint64_t digest = 14695981039346656037u;
  const auto add = [&](std::string_view bytes) {
    for (const char byte : bytes) digest = (digest ^ static_cast<unsigned char>(byte)) * 1099511628211u;
  };
  const auto add_numbers = [&](const std::vector<double>& numbers) {
    add({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
  };
  add(recorded.fit_text);
  add(recorded.text);
  for (const RecordedNote& note : recorded.notes) add_numbers(note.recording.samples);
  for (const NoteImpression& note : started) add_numbers(note.power);
  return fmt::format("{:016x}", digest);
}

// The best place where each note is rendered with all numbers. The search leaves those out that act on it at other
// places alone; where that makes a difference, it goes on without.
FoundPlaces find_best_with_all(ListeningProblem& problem, const Eigen::VectorXd& start, const Tell& tell) {
  constexpr double kDifferent = 0.1;
  const auto tell_search = [&](int search) {
    return
        [&tell, search](const std::string& what) { tell(fmt::format("search {} of at most 2, {}", search, what)); };
  };
  FoundPlaces found = find_best(problem, start, tell_search(1));
  const auto cost = [&] { return problem.with_costs({found.best.place}).front().cost; };
  const double with_some = cost();
  for (std::vector<bool>& acts : problem.acts_on) acts.assign(acts.size(), true);
  return std::abs(cost() - with_some) < kDifferent ? found : find_best(problem, found.best.place, tell_search(2));
}

}  // namespace

InstrumentFit fit_instrument(const RecordedInstrument& recorded, const ReadFile& read,
                             const std::function<void(const std::string&)>& tell, const StepsOnDisk& disk) {
  constexpr double kNear_cents = 40;
  constexpr int kManySteps = 30;
  const std::vector<NoteImpression> impressions = recorded_impressions(recorded);
  const NoteRenderer renderer(recorded, read);
  std::vector<std::size_t> all(impressions.size()), fitted;
  std::iota(all.begin(), all.end(), 0);
  std::ranges::copy_if(all, std::back_inserter(fitted), [&](std::size_t n) { return !recorded.notes[n].is_kept; });
  std::vector<NoteImpression> heard;
  for (const std::size_t n : fitted) heard.push_back(impressions[n]);
  ListeningProblem problem(recorded, renderer, fitted, heard);
  std::vector<NoteImpression> started = renderer.render_one(problem.numbers_at(problem.start()), all);
  const std::string digest = digest_of(recorded, started);
  const auto before = distances_of(impressions, started, recorded);
  require_fit(recorded, renderer, fitted, problem);
  if (disk.read) problem.steps = SearchSteps(digest, disk);
  tell("trying numbers all over their bounds");
  const Eigen::VectorXd start = find_place(problem);
  problem.matched.scales.far_cents = kNear_cents;
  const FoundPlaces places =
      find_best_with_all(problem, problem.search(start, kManySteps, problem.all_numbers()), tell);
  std::vector<NoteImpression> found = renderer.render_one(problem.numbers_at(places.best.place), all);
  const auto after = distances_of(impressions, found, recorded);
  InstrumentFit fit;
  for (const std::size_t n : all)
    fit.notes.push_back({before[n], after[n], impressions[n], std::move(started[n]), std::move(found[n])});
  require_pitch(recorded, fit.notes);
  fit.doubts = doubts_of(recorded, fit.notes);
  fit.is_explained = std::ranges::all_of(fitted, [&](std::size_t n) { return is_explained(fit.notes[n]); });
  fit.numbers = found_numbers(recorded, problem, places);
  return fit;
}

}  // namespace contactspline
