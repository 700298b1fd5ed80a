// SPDX-License-Identifier: MIT
#include "generator/listen/place_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>

namespace contactspline {
namespace {

constexpr int kFewSteps = 8;

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
std::vector<Eigen::VectorXd> scattered(std::size_t open, const Eigen::VectorXd& start) {
  constexpr std::size_t kEach = 24, kMost = 240;
  const std::vector<std::size_t> bases = first_primes(open);
  std::vector<Eigen::VectorXd> places{start};
  for (std::size_t k = 1; k <= std::min(kMost, kEach * open); ++k) {
    places.push_back(start);
    for (std::size_t i = 0; i < open; ++i)
      places.back()[static_cast<Eigen::Index>(i)] = place_of(halton(k, bases[i]));
  }
  return places;
}

/// Places along numbers from one that was found.
struct AlongNumbers {
  std::vector<Candidate> all;
  std::vector<Candidate> valleys;   ///< the lowest ones near by beyond a rise: of each number, on each side
  std::vector<Eigen::Index> loose;  ///< numbers that have a place far away almost as good
};

// On each side of a place, of candidates in the order of their distance from it: the lowest of those that stand lower
// than the one before.
void add_valleys(std::span<const Candidate> near, std::vector<Candidate>& valleys) {
  for (const std::size_t side : {0, 1}) {
    const Candidate* lowest = nullptr;
    for (std::size_t i = side + 2; i < near.size(); i += 2)
      if (near[i].cost < near[i - 2].cost && (lowest == nullptr || near[i].cost < lowest->cost)) lowest = &near[i];
    if (lowest != nullptr) valleys.push_back(*lowest);
  }
}

// Where one number alone moves over its bounds, and by little.
AlongNumbers along_each(const ListeningProblem& problem, const Candidate& from) {
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
  AlongNumbers along{problem.with_costs(places), {}, {}};
  for (Eigen::Index i = 0; i < from.place.size(); ++i) {
    const auto of_number = std::span(along.all).subspan(static_cast<std::size_t>(i) * kEach, kEach);
    add_valleys(of_number.subspan(kScanned), along.valleys);
    const auto is_near = [&](const Candidate& candidate) {
      return std::abs(part_at(candidate.place[i]) - part_at(from.place[i])) < 1.0 / kScanned;
    };
    if (std::ranges::any_of(of_number, [&](const Candidate& candidate) {
          return !is_near(candidate) && candidate.cost < kLoose * from.cost;
        }))
      along.loose.push_back(i);
  }
  return along;
}

// Where each two of these numbers move at once, if a note tells of both.
std::vector<Candidate> along_pairs(const ListeningProblem& problem, const Candidate& from,
                                   const std::vector<Eigen::Index>& loose) {
  constexpr std::size_t kEach = 32, kMost = 640;
  std::vector<Eigen::VectorXd> places;
  for (std::size_t k = 1; k <= kEach; ++k)
    for (std::size_t i = 0; i < loose.size(); ++i)
      for (std::size_t j = 0; j < i && places.size() < kMost; ++j) {
        if (!problem.act_together(static_cast<std::size_t>(loose[i]), static_cast<std::size_t>(loose[j]))) continue;
        places.push_back(from.place);
        places.back()[loose[i]] = place_of(halton(k, 2));
        places.back()[loose[j]] = place_of(halton(k, 3));
      }
  return problem.with_costs(places);
}

// Do no numbers of two places differ by this part of the way between their bounds or more?
bool is_within(const Eigen::VectorXd& one, const Eigen::VectorXd& other, double part) {
  return (one.unaryExpr(&part_at) - other.unaryExpr(&part_at)).cwiseAbs().maxCoeff() < part;
}

// The best of these that are not near a better one, nor, unless they are better, where the search is.
std::vector<Eigen::VectorXd> best_apart(std::vector<Candidate> candidates, const Candidate& at) {
  constexpr std::size_t kTried = 10;
  constexpr double kApart = 0.08;  // of the way between bounds
  std::ranges::sort(candidates, {}, &Candidate::cost);
  std::vector<Eigen::VectorXd> best;
  for (const Candidate& candidate : candidates) {
    const auto is_near = [&](const Eigen::VectorXd& other) { return is_within(candidate.place, other, kApart); };
    if (candidate.cost >= at.cost && is_near(at.place)) continue;
    if (best.size() < kTried && std::ranges::none_of(best, is_near)) best.push_back(candidate.place);
  }
  return best;
}

// Where searches get to from the best of places along one or two numbers, and from those near by beyond a rise: at
// first of the numbers that act on the same notes alone, then, where that led to another place worth it, of all.
std::vector<Candidate> others_than(const ListeningProblem& problem, const Candidate& at, const Tell& tell) {
  constexpr double kWorth = 30;    // of the cost
  constexpr double kSame = 0.002;  // of the way between bounds
  AlongNumbers along = along_each(problem, at);
  std::ranges::move(along_pairs(problem, at, along.loose), std::back_inserter(along.all));
  std::vector<Eigen::VectorXd> from = best_apart(std::move(along.all), at), found;
  for (const Candidate& valley : along.valleys) from.push_back(valley.place);
  for (const Eigen::VectorXd& place : from) {
    tell(fmt::format("place {} of {}", found.size() + 1, from.size()));
    const std::vector<std::size_t> numbers = problem.numbers_between(at.place, place);
    found.push_back(problem.search(place, kFewSteps, numbers));
    if (numbers.size() == problem.size() || is_within(found.back(), at.place, kSame)) continue;
    if (problem.with_costs({found.back()}).front().cost < at.cost + kWorth)
      found.back() = problem.search(found.back(), kFewSteps, problem.all_numbers());
  }
  return problem.with_costs(found);
}

}  // namespace

Eigen::VectorXd find_place(const ListeningProblem& problem) {
  constexpr std::size_t kBest = 2;
  std::vector<Eigen::VectorXd> places = scattered(problem.open_in_text(), problem.start());
  std::vector<Candidate> candidates = problem.with_costs(places);
  const std::vector<std::size_t> all = problem.all_numbers();
  std::vector<Eigen::VectorXd> found{problem.search(places[0], kFewSteps, all)};
  std::ranges::sort(candidates, {}, &Candidate::cost);
  candidates.resize(std::min(kBest, candidates.size()));
  for (const Candidate& candidate : candidates) found.push_back(problem.search(candidate.place, kFewSteps, all));
  return std::ranges::min(problem.with_costs(found), {}, &Candidate::cost).place;
}

FoundPlaces find_best(ListeningProblem& problem, const Eigen::VectorXd& start, const Tell& tell) {
  constexpr int kTimes = 6;
  constexpr double kLower = 0.1;
  FoundPlaces found{{0, start}, {}};
  for (int time = 0; time < kTimes; ++time) {
    const auto tell_round = [&](const std::string& what) {
      tell(fmt::format("round {} of at most {}: {}", time + 1, kTimes, what));
    };
    tell_round("down");
    found.best = problem.with_costs({problem.settle(found.best.place)}).front();
    tell_round("along each number");
    found.others = others_than(problem, found.best, tell_round);
    const auto best = std::ranges::min_element(found.others, {}, &Candidate::cost);
    if (best == found.others.end() || best->cost > found.best.cost - kLower) break;
    found.best = *best;
  }
  return found;
}

}  // namespace contactspline
