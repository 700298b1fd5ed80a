// SPDX-License-Identifier: MIT
#include "generator/fit/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <set>

#include "generator/fit/fit_intervals.hpp"
#include "generator/fit/fit_notes.hpp"
#include "generator/fit/fit_problem.hpp"
#include "generator/support/error.hpp"
#include "generator/support/ranges.hpp"

namespace contactspline {
namespace {

/// A model, and the best values that were found for it.
struct Candidate {
  const ModelRow* law;
  const ModelRow* loss;
  std::vector<FitParameter> frees;
  FitValues values;
  double criterion = 0;

  [[nodiscard]] bool has_low_pass() const { return values.low_pass_order > 0; }
};

// Slow curves tell nothing of a loss, nor does one quantity over the speed, which a law with another exponent has,
// too. A curve of an impact has no times, which a memory needs.
bool tells_of(const ModelRow& loss, const Measurements& measured) {
  const auto is_impact = [](const MeasuredForce& curve) { return curve.impact_speed_m_per_s.has_value(); };
  const auto has_two = [](const ImpactRow& row) { return row.restitution || (row.duration_s && row.max_force_n); };
  const bool has_impact_curve = std::ranges::any_of(measured.curves, is_impact);
  if (loss.frees.empty()) return true;
  if (std::ranges::count(loss.frees, kWeight) > 0 && has_impact_curve) return false;
  return has_impact_curve || !measured.pulses.empty() || std::ranges::any_of(measured.rows, has_two) ||
         measured.has_blows();
}

Candidate candidate_of(const ModelRow& law, const ModelRow& loss, const Measurements& measured) {
  Candidate candidate{&law, &loss, law.frees, {}};
  std::vector<FitParameter>& frees = candidate.frees;
  frees.insert(frees.end(), loss.frees.begin(), loss.frees.end());
  if (measured.fits_mass()) frees.push_back(kLogMass);
  if (measured.struck && measured.struck->has_common_gain) frees.push_back(kLogGain);
  std::ranges::sort(frees);
  return candidate;
}

// Layers come last: their fit begins with that of the power law.
std::vector<Candidate> candidates_of(const Measurements& measured) {
  std::vector<Candidate> all;
  for (const ModelRow& law : laws())
    for (const ModelRow& loss : losses())
      if (std::ranges::count(measured.laws, law.name) > 0 && std::ranges::count(measured.losses, loss.name) > 0 &&
          tells_of(loss, measured))
        all.push_back(candidate_of(law, loss, measured));
  return all;
}

bool frees(const Candidate& candidate, FitParameter parameter) {
  return std::ranges::find(candidate.frees, parameter) != candidate.frees.end();
}

// What was found without a core, and of several pulses the law of the slowest one: with cores from several depths on.
std::vector<FitValues> layered_starts(const FitProblem& problem, const FitValues& without,
                                      const std::optional<FitValues>& slowest) {
  std::vector<FitValues> starts;
  for (const double depth : {0.2, 0.4, 0.6, 0.75, 0.9}) {
    starts.push_back(problem.with_core(without, depth));
    starts.push_back(starts.back());  // with a softer law beside the core
    starts.back().parameters[kExponent] = std::max(1.2, 0.75 * starts.back().parameters[kExponent]);
    if (slowest) starts.push_back(problem.with_core(*slowest, depth));
  }
  return starts;
}

// Values to start from: several exponents, and if the same law has been fitted without a loss, what that found.
std::vector<FitValues> starts_of(const FitProblem& problem, const Candidate& candidate, const Candidate* simpler) {
  const double loss = frees(candidate, kHuntCrossley) ? 0.3 : 0, weight = frees(candidate, kWeight) ? 0.5 : 0;
  const std::vector exponents = !frees(candidate, kExponent) ? std::vector{kHertzExponent}
                                : simpler == nullptr         ? problem.likely_exponents()
                                                             : std::vector{2.5};
  std::vector<FitValues> starts;
  for (const double time : frees(candidate, kLogTime) ? std::vector{0.1, 0.01} : std::vector{0.01}) {
    for (const double exponent : exponents) starts.push_back(problem.begin(exponent, loss, weight, time));
    if (simpler == nullptr) continue;
    const auto lossy = starts.back().parameters;
    starts.push_back(simpler->values);
    for (const FitParameter parameter : {kHuntCrossley, kWeight, kLogTime})
      starts.back().parameters[parameter] = lossy[parameter];
  }
  return starts;
}

// Layers: a few steps from each start, and more from the two best ones. Starts may agree on a core that is out of
// reach, so all are tried. Pulses find their begins first: while these are wrong, no step leads the core to its
// place.
void find_layers(const FitProblem& problem, Candidate& candidate, std::vector<FitValues> starts) {
  candidate.values.cost = std::numeric_limits<double>::infinity();
  constexpr int kFewSteps = 8, kSteps = 40;
  constexpr std::size_t kBest = 2;
  const bool has_begins = problem.free_values({}) > 0;
  for (FitValues& start : starts) {
    std::ranges::fill(start.noise, kFirstNoise);
    if (has_begins) start = problem.search(start, {}, kFewSteps, Samples::kSome);
    start = problem.search(start, candidate.frees, kFewSteps, Samples::kSome);
  }
  std::ranges::sort(starts, {}, &FitValues::cost);
  for (std::size_t i = 0; i < kBest; ++i) {
    const FitValues found = problem.search(starts[i], candidate.frees, kSteps, Samples::kSome);
    if (found.cost < candidate.values.cost) candidate.values = found;
  }
}

// The best of several starts, until two of them agree, from some samples of each pulse.
void find_values(const FitProblem& problem, Candidate& candidate, const Candidate* simpler) {
  constexpr int kSteps = 30;
  constexpr double kAgree = 1e-3;
  candidate.values.cost = std::numeric_limits<double>::infinity();
  for (FitValues& start : starts_of(problem, candidate, simpler)) {
    std::ranges::fill(start.noise, kFirstNoise);
    const FitValues found = problem.search(start, candidate.frees, kSteps, Samples::kSome);
    const double before = candidate.values.cost;
    if (found.cost < before) candidate.values = found;
    if (std::abs(found.cost / before - 1) <= kAgree) return;
  }
}

// The power law of the slowest pulse alone, which is the least likely to reach a core: that of all pulses may have an
// exponent that is far too high, and no search finds back from there.
std::optional<FitValues> of_slowest(const FitProblem& problem, const Measurements& measured, const Candidate& power) {
  if (measured.pulses.size() < 2) return std::nullopt;
  Measurements slow = measured;
  slow.pulses = {std::ranges::min(measured.pulses, {}, [](const Pulse& p) { return std::ranges::max(p.force_n); })};
  slow.rows.clear(), slow.curves.clear();
  if (slow.struck) slow.struck->blows.clear(), slow.struck->has_common_gain = false;
  const FitProblem alone(slow);
  Candidate candidate = candidate_of(*power.law, *power.loss, slow);
  find_values(alone, candidate, nullptr);
  if (!std::isfinite(candidate.values.cost)) return std::nullopt;
  FitValues values = problem.begin(candidate.values.parameters[kExponent], 0, 0, 1);
  for (const FitParameter parameter : candidate.frees)
    values.parameters[parameter] = candidate.values.parameters[parameter];
  values.parameters[kLogForce] +=
      values.parameters[kExponent] * std::log(problem.reference_m() / alone.reference_m());
  return values;
}

// Twice, with the noise that all samples show about the values.
void refine(const FitProblem& problem, Candidate& candidate) {
  constexpr int kSteps = 60;
  for (int round = 0; round < 2; ++round)
    candidate.values =
        problem.search(problem.with_noise(candidate.values, candidate.frees), candidate.frees, kSteps, Samples::kAll);
}

// Twice the cost of a candidate at a noise of each source, in parts of what one independent sample costs.
double cost_of(const FitProblem& problem, const Candidate& candidate, const std::vector<double>& noise,
               const std::vector<double>& together) {
  const std::vector<double> residuals = problem.linearised(candidate.values, candidate.frees).residuals;
  std::vector<double> costs(noise.size());
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const std::size_t source = problem.source_of_residual()[i];
    const double r = residuals[i] * candidate.values.noise[source] / noise[source] / kRobust;
    costs[source] += 2 * kRobust * kRobust * (std::sqrt(1 + r * r) - 1);
  }
  double sum = 0;
  for (std::size_t s = 0; s < noise.size(); ++s) {
    const auto samples = static_cast<double>(problem.sources()[s].at.size());
    const bool is_least = noise[s] < 1.001 * min_noise(problem.sources()[s]);  // better is not to be known
    sum += (is_least ? std::max(samples, costs[s]) : costs[s]) / together[s];
  }
  return sum;
}

// What p parameters cost among n values: the Bayesian information criterion, or if values are few and that is more
// Akaike's, as N. Sugiura corrected it (Communications in Statistics A7, 1978).
double penalty(double p, double n) {
  return std::max(p * std::log(n), 2 * p + 2 * p * (p + 1) / std::max(0.5, n - p - 1));
}

// Of the criterion: this much more is strong evidence against a model.
constexpr double kStrong = 10;

// What few have, a core or a sensor's low-pass that nobody stated, is taken for true only on strong evidence.
double doubt(const Candidate& candidate) {
  return (candidate.law->name == kLayers ? kStrong : 0) + (candidate.has_low_pass() ? kStrong : 0);
}

// n ln of the cost at the least noise that any candidate shows, the penalty and the doubt. The best comes first.
void set_criteria(const FitProblem& problem, std::vector<Candidate>& all) {
  const std::size_t sources = problem.sources().size();
  std::vector<double> noise(sources, std::numeric_limits<double>::infinity()), together(sources, 1);
  for (const Candidate& candidate : all)
    for (std::size_t s = 0; s < sources; ++s)
      if (candidate.values.noise[s] < noise[s])
        noise[s] = candidate.values.noise[s], together[s] = candidate.values.together[s];
  double n = 0;
  for (std::size_t s = 0; s < sources; ++s) n += static_cast<double>(problem.sources()[s].at.size()) / together[s];
  for (Candidate& candidate : all)
    candidate.criterion = n * std::log(cost_of(problem, candidate, noise, together) / n) +
                          penalty(static_cast<double>(candidate.frees.size()), n) + doubt(candidate);
  std::ranges::stable_sort(all, {}, &Candidate::criterion);
}

std::vector<FitQuality> qualities_of(const FitProblem& problem, const Candidate& candidate) {
  const std::vector<double> residuals = problem.linearised(candidate.values, candidate.frees).residuals;
  std::vector<FitQuality> all;
  for (const FitSource& source : problem.sources())
    all.push_back({std::filesystem::path(source.file).filename().string(),
                   source.quantity,
                   source.at.size(),
                   0,
                   source.at,
                   source.measured,
                   {}});
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const std::size_t s = problem.source_of_residual()[i];
    const double difference = residuals[i] * candidate.values.noise[s];
    const std::size_t k = all[s].modelled.size();
    all[s].modelled.push_back(all[s].measured[k] + difference * problem.sources()[s].scale[k]);
    all[s].scatter += difference * difference / static_cast<double>(all[s].samples);
  }
  for (FitQuality& quality : all)
    quality.scatter = std::sqrt(quality.scatter) * (quality.is_level() ? kDecibelsPerNeper : 1);
  return all;
}

// How far the data reach: the largest compression of all impacts and blows, and their speeds.
void set_reach(Fit& fit, const Measurements& measured, const FitValues& values) {
  const double mass_kg = fit.mass_kg.value;
  std::vector<double> speeds;  // at a wall
  std::vector<double> struck;
  for (std::size_t i = 0; i < values.pulses.size(); ++i)
    (measured.pulses[i].is_struck ? struck : speeds).push_back(std::exp(values.pulses[i][kLogSpeed]));
  for (const auto& unknown : values.blows) struck.push_back(std::exp(unknown[kBlowSpeed]));
  for (const ImpactRow& row : measured.rows) speeds.push_back(row.speed_m_per_s);
  for (const MeasuredForce& curve : measured.curves) {
    fit.max_compression_m = std::max(fit.max_compression_m, curve.samples.back().compression_m);
    if (curve.impact_speed_m_per_s) speeds.push_back(*curve.impact_speed_m_per_s);
  }
  if (!speeds.empty())
    if (const auto impact = measure_impact(fit.model, mass_kg, std::ranges::max(speeds)))
      fit.max_compression_m = std::max(fit.max_compression_m, impact->max_compression_m);
  for (const double speed : struck) {
    speeds.push_back(speed);
    strike_model::Strike<double> strike(fit.model, mass_kg, speed, measured.struck->modes);
    if (strike.play()) fit.max_compression_m = std::max(fit.max_compression_m, strike.max_compression_m());
  }
  const double slow = 1 - fit.model.weight;  // the stiffness of a slow press, in parts of that of a fast blow
  fit.max_speed_m_per_s = std::sqrt(2 * slow * impact_model::energy(fit.model, fit.max_compression_m) / mass_kg);
  constexpr double kRangeOfSlowCurves = 20;
  const double slowest = speeds.empty() ? fit.max_speed_m_per_s / kRangeOfSlowCurves : std::ranges::min(speeds);
  fit.min_speed_m_per_s = std::min(slowest, fit.max_speed_m_per_s);
}

// Levels of partials above the first minimum of the force's spectrum fit many contacts nearly as well as the true
// one. If they fit badly, another one has been found.
void require_low_partials(const Fit& fit, const Measurements& measured, const FitValues& values,
                          const std::string& file) {
  constexpr double kMinimum = 1.5, kMaxScatter_db = 2;  // the minimum is at 1.5 over the contact duration
  std::set<double> partials;
  for (const Blow& blow : measured.struck->blows)
    for (const auto& [mode, level_db] : blow.levels) partials.insert(measured.struck->modes[mode].frequency_hz());
  double longest = 0, squares = 0, samples = 0;
  for (const auto& unknown : values.blows) {
    strike_model::Strike<double> strike(fit.model, fit.mass_kg.value, std::exp(unknown[kBlowSpeed]),
                                        measured.struck->modes);
    if (strike.play()) longest = std::max(longest, strike.contact_s());
  }
  for (const FitQuality& quality : fit.qualities)
    if (quality.is_level()) {
      const auto count = static_cast<double>(quality.samples);
      squares += count * quality.scatter * quality.scatter;
      samples += count;
    }
  const double scatter = std::sqrt(squares / samples);
  if (scatter <= kMaxScatter_db || *std::next(partials.begin()) * longest < kMinimum) return;
  refuse(
      file, "struck.blows",
      fmt::format("contacts of {:.2g} ms leave one partial below the first minimum of the force's spectrum, and the "
                  "best law that was found is {:.1f} dB off",
                  1e3 * longest, scatter),
      fmt::format("two partials or more below {:.3g} Hz: a harder hammer, or a resonator of lower modes",
                  kMinimum / longest));
}

std::string fitting(const Candidate& candidate) {
  return fmt::format("fitting a {} {}", candidate.law->words, candidate.loss->words);
}

// Every law and loss that the data can tell, found from some of their samples. The two laws without a loss need one
// value more than they have numbers; all others twice as many values, or their perfect fit would be mistaken for
// truth.
std::vector<Candidate> found_candidates(const FitProblem& problem, const Measurements& measured,
                                        const std::function<void(const std::string&)>& tell) {
  const std::size_t values = problem.source_of_residual().size();
  std::vector<Candidate> all;
  for (Candidate& candidate : candidates_of(measured)) {
    const std::size_t free = problem.free_values(candidate.frees);
    const bool is_simple = candidate.law->name != kLayers && candidate.loss->frees.empty();
    if (values < (is_simple ? free + 1 : 2 * free)) continue;
    const bool is_layered = candidate.law->name == kLayers;
    const auto simpler = std::find_if(all.rbegin(), all.rend(), [&](const Candidate& other) {
      return is_layered ? std::string_view(other.law->name) == "power" && other.loss == candidate.loss
                        : other.law == candidate.law;
    });
    if (is_layered && simpler == all.rend()) continue;
    tell(fitting(candidate));
    if (is_layered)
      find_layers(problem, candidate,
                  layered_starts(problem, simpler->values, of_slowest(problem, measured, *simpler)));
    else
      find_values(problem, candidate, simpler == all.rend() ? nullptr : &*simpler);
    if (std::isfinite(candidate.values.cost)) all.push_back(candidate);
  }
  return all;
}

/// A number that a material file would hold, what it may hold, and what to try where it does not.
struct FileNumber {
  const char* name;
  double value;
  Range allowed;
  std::string unit;
  const char* advice;

  [[nodiscard]] bool is_allowed() const { return value >= allowed.min && value <= allowed.max; }
};

std::vector<FileNumber> numbers_in_file(const FitProblem& problem, const Candidate& candidate) {
  constexpr auto kUnits = ": do the units of mass, force and time agree?", kNoAdvice = "",
                 kWithoutCore = ": is a length wrong? else \"laws\": [\"power\", \"hertz\"]",
                 kWithoutMemory = ": is a time wrong? else \"losses\": [\"none\", \"hunt_crossley\"]";
  const ViscoelasticLaw<double> law = problem.law(candidate.values);
  const double log_reference = std::log(law.reference_m);
  std::vector<FileNumber> numbers = {{"stiffness", std::exp(law.log_force - law.exponent * log_reference),
                                      ranges::kStiffness, fmt::format("N/m^{:.3g}", law.exponent), kUnits},
                                     {"exponent", law.exponent, ranges::kExponent, "", kNoAdvice},
                                     {"loss", law.loss_s_per_m, ranges::kLoss, "s/m", kNoAdvice}};
  if (frees(candidate, kDepth)) {
    numbers.push_back({"stiffness of the core",
                       std::exp(law.log_force + std::log(law.core) - kHertzExponent * log_reference),
                       ranges::kStiffness, "N/m^1.5", kWithoutCore});
    numbers.push_back({"depth of the core", law.depth * law.reference_m, ranges::kOffset, "m", kWithoutCore});
  }
  if (frees(candidate, kWeight)) {
    numbers.push_back({"weight of the memory", law.weight, ranges::kWeight, "", kWithoutMemory});
    numbers.push_back({"relaxation time", law.time_s, ranges::kRelaxation, "s", kWithoutMemory});
  }
  return numbers;
}

bool is_material(const FitProblem& problem, const Candidate& candidate) {
  return std::ranges::all_of(numbers_in_file(problem, candidate), &FileNumber::is_allowed);
}

[[noreturn]] void refuse_no_material(const FitProblem& problem, const Candidate& best, const std::string& file) {
  const std::vector<FileNumber> numbers = numbers_in_file(problem, best);
  const FileNumber& wrong = *std::ranges::find(numbers, false, &FileNumber::is_allowed);
  const std::string unit = wrong.unit.empty() ? "" : " " + wrong.unit;
  refuse(file, "fit",
         fmt::format("the {} {} describes the data far better than all others, and its {} is {:.4g}{}, which no "
                     "material has",
                     best.law->words, best.loss->words, wrong.name, wrong.value, unit),
         fmt::format("{} to {}{}{}", wrong.allowed.min, wrong.allowed.max, unit, wrong.advice));
}

// Does what the best candidate leaves look as if a low-pass that nobody stated were before the pulses? It is no noise
// then, or it needs more than a power law.
bool looks_filtered(const Measurements& measured, const Candidate& best) {
  constexpr double kTogether = 1.3;
  const auto is_stated = [](const Pulse& pulse) { return pulse.low_pass_hz.has_value(); };
  if (measured.pulses.empty() || std::ranges::any_of(measured.pulses, is_stated)) return false;
  return best.law->name == kLayers || frees(best, kWeight) || std::ranges::max(best.values.together) > kTogether;
}

Candidate behind_low_pass(const FitProblem& problem, Candidate candidate, int order) {
  constexpr int kSteps = 60;
  candidate.frees.push_back(kLogLowPass);
  std::ranges::sort(candidate.frees);
  candidate.values.parameters[kLogLowPass] = problem.log_frequency(3);
  candidate.values.low_pass_order = order;
  candidate.values = problem.search(candidate.values, candidate.frees, kSteps, Samples::kSome);
  if (std::isfinite(candidate.values.cost)) refine(problem, candidate);
  return candidate;
}

// Adds the laws without core and memory behind a low-pass.
void add_low_pass(const FitProblem& problem, std::vector<Candidate>& all,
                  const std::function<void(const std::string&)>& tell) {
  const std::vector<Candidate> without = all;
  for (const Candidate& from : without) {
    if (from.law->name == kLayers || frees(from, kWeight)) continue;
    tell(fitting(from) + " behind a low-pass");
    for (const int order : {1, 2})
      if (const Candidate found = behind_low_pass(problem, from, order); std::isfinite(found.values.cost))
        all.push_back(found);
  }
  set_criteria(problem, all);
}

// All that are no worse by far are refined.
void refine_all(const FitProblem& problem, std::vector<Candidate>& all) {
  constexpr double kHopeless = 10;
  const auto cost = [](const Candidate& candidate) { return candidate.values.cost; };
  const double lowest = cost(std::ranges::min(all, {}, cost));
  for (Candidate& candidate : all)
    if (candidate.values.cost <= kHopeless * lowest)
      refine(problem, candidate);
    else
      candidate.values = problem.with_noise(candidate.values, candidate.frees);
}

// The candidates that a material can hold, the best one first.
std::vector<Candidate> fitted_candidates(const FitProblem& problem, const Measurements& measured,
                                         const std::string& file,
                                         const std::function<void(const std::string&)>& tell) {
  std::vector<Candidate> all = found_candidates(problem, measured, tell);
  if (all.empty())
    refuse(file, "fit",
           "no law describes the data, or there are too few values for the laws and losses that are allowed",
           "data of impacts on a rigid wall or a known resonator, in the units that they state, and twice as many "
           "values as a law with a loss has numbers");
  refine_all(problem, all);
  set_criteria(problem, all);
  if (looks_filtered(measured, all.front())) add_low_pass(problem, all, tell);
  const Candidate best = all.front();
  std::erase_if(all, [&](const Candidate& candidate) { return !is_material(problem, candidate); });
  if (all.empty() || all.front().criterion > best.criterion + kStrong) refuse_no_material(problem, best, file);
  return all;
}

// The same behind a low-pass of order 1 that nobody stated, if pulses may have passed one. It begins where it hardly
// changes them.
std::optional<Candidate> behind_unstated_low_pass(const FitProblem& problem, const Measurements& measured,
                                                  Candidate candidate) {
  constexpr int kSteps = 30;
  const auto is_open = [](const Pulse& pulse) { return !pulse.low_pass_hz; };
  if (candidate.has_low_pass() || std::ranges::none_of(measured.pulses, is_open)) return std::nullopt;
  candidate.frees.push_back(kLogLowPass);
  std::ranges::sort(candidate.frees);
  candidate.values.parameters[kLogLowPass] = problem.log_frequency(20);
  candidate.values.low_pass_order = 1;
  candidate.values = problem.search(candidate.values, candidate.frees, kSteps, Samples::kAll);
  return std::isfinite(candidate.values.cost) ? std::optional(candidate) : std::nullopt;
}

/// The intervals about the values of a candidate. A low-pass of a few kHz moves exponent and loss by more than their
/// noise before the criterion shows it, and intervals of a law that the data chose hold less than they say (H. Leeb
/// and B. M. Poetscher, Econometric Theory 21, 2005): where it is not stated, they are those with a low-pass.
class AllowingIntervals {
 public:
  AllowingIntervals(const FitProblem& problem, const Measurements& measured, const Candidate& candidate)
      : parameters_(candidate.values.parameters),
        allowing_(behind_unstated_low_pass(problem, measured, candidate).value_or(candidate)),
        intervals_(problem, allowing_.values, allowing_.frees) {}

  [[nodiscard]] Estimate of(const std::vector<std::pair<FitParameter, double>>& sum) const {
    Estimate estimate = intervals_.of(sum);
    estimate.value = 0;
    for (const auto& [parameter, weight] : sum) estimate.value += weight * parameters_[parameter];
    return estimate;
  }

 private:
  std::array<double, kFitParameters> parameters_;
  Candidate allowing_;
  FitIntervals intervals_;
};

// The interval of the exponent. That of Hertz's law is what the power law with the same loss says of the data.
Estimate exponent_of(const FitProblem& problem, const Measurements& measured, const std::vector<Candidate>& all,
                     const AllowingIntervals& of_best) {
  const Candidate& best = all.front();
  const auto power = std::ranges::find_if(all, [&](const Candidate& other) {
    return std::string_view(other.law->name) == "power" && other.loss == best.loss &&
           other.values.low_pass_order == best.values.low_pass_order;
  });
  const std::vector<std::pair<FitParameter, double>> alone = {{kExponent, 1}};
  Estimate exponent = frees(best, kExponent) || power == all.end()
                          ? of_best.of(alone)
                          : AllowingIntervals(problem, measured, *power).of(alone);
  exponent.value = best.values.parameters[kExponent];
  return within(exponent, ranges::kExponent);
}

// Law, loss and their numbers.
Fit numbers_of(const FitProblem& problem, const Measurements& measured, const std::vector<Candidate>& all) {
  const Candidate& best = all.front();
  const AllowingIntervals intervals(problem, measured, best);
  const double reference_m = problem.reference_m(), log_reference = std::log(reference_m);
  const Estimate log_core = plus(intervals.of({{kLogForce, 1}, {kLogCore, 1}}), -kHertzExponent * log_reference);
  Fit fit{best.law->name,
          best.loss->name,
          problem.law(best.values),
          within(exponential(intervals.of({{kLogForce, 1}, {kExponent, -log_reference}})), ranges::kStiffness),
          exponent_of(problem, measured, all, intervals),
          within(exponential(log_core), ranges::kStiffness),
          within(times(intervals.of({{kDepth, 1}}), reference_m), ranges::kOffset),
          within(intervals.of({{kHuntCrossley, 1}}), ranges::kLoss),
          within(intervals.of({{kWeight, 1}}), {0, ranges::kWeight.max}),
          within(exponential(intervals.of({{kLogTime, 1}})), ranges::kRelaxation),
          within(exponential(intervals.of({{kLogMass, 1}})), kFitMass),
          0,
          0,
          0,
          qualities_of(problem, best),
          {}};
  constexpr Range kLowPass{1, 1e6};
  if (best.has_low_pass()) fit.low_pass_hz = within(exponential(intervals.of({{kLogLowPass, 1}})), kLowPass);
  return fit;
}

FittedModel model_of(const Candidate& candidate, const Candidate& best) {
  const std::size_t own = candidate.law->frees.size() + candidate.loss->frees.size();
  return {candidate.law->name, candidate.loss->name, static_cast<int>(own) + (candidate.has_low_pass() ? 1 : 0),
          candidate.criterion - best.criterion, candidate.has_low_pass()};
}

}  // namespace

Fit fit_material(const Measurements& measured, const std::string& file,
                 const std::function<void(const std::string&)>& tell) {
  const FitProblem problem(measured);
  const std::vector<Candidate> all = fitted_candidates(problem, measured, file, tell);
  const Candidate& best = all.front();
  Fit fit = numbers_of(problem, measured, all);
  set_reach(fit, measured, best.values);
  if (measured.has_blows()) require_low_partials(fit, measured, best.values, file);
  for (const Candidate& candidate : all) fit.candidates.push_back(model_of(candidate, best));
  add_notes(fit, measured, best.values);
  return fit;
}

}  // namespace contactspline
