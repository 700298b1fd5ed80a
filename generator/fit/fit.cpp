// SPDX-License-Identifier: MIT
#include "generator/fit/fit.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>

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
  int low_pass_order = 0;  ///< of a low-pass that is fitted, 0: none
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

// Values to start from: several exponents, and if the same law has been fitted without a loss, what that found.
// Layers start from what was found without a core.
std::vector<FitValues> starts_of(const FitProblem& problem, const Candidate& candidate, const Candidate* simpler) {
  if (frees(candidate, kDepth)) {
    std::vector<FitValues> starts;
    for (const double depth : {0.2, 0.4, 0.6, 0.75, 0.9}) {
      starts.push_back(problem.with_core(simpler->values, depth));
      starts.push_back(starts.back());  // with a softer law beside the core
      starts.back().parameters[kExponent] = std::max(1.2, 0.75 * starts.back().parameters[kExponent]);
    }
    return starts;
  }
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
// reach, so all are tried.
void find_layers(const FitProblem& problem, Candidate& candidate, std::vector<FitValues> starts) {
  constexpr int kFewSteps = 8, kSteps = 40;
  constexpr std::size_t kBest = 2;
  for (FitValues& start : starts) {
    std::ranges::fill(start.noise, kFirstNoise);
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
  if (frees(candidate, kDepth)) return find_layers(problem, candidate, starts_of(problem, candidate, simpler));
  for (FitValues& start : starts_of(problem, candidate, simpler)) {
    std::ranges::fill(start.noise, kFirstNoise);
    const FitValues found = problem.search(start, candidate.frees, kSteps, Samples::kSome);
    const double before = candidate.values.cost;
    if (found.cost < before) candidate.values = found;
    if (std::abs(found.cost / before - 1) <= kAgree) return;
  }
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
  problem.set_low_pass_order(std::max(1, candidate.low_pass_order));
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

// n ln of the cost at the least noise that any candidate shows, and the penalty. The best comes first.
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
                          penalty(static_cast<double>(candidate.frees.size()), n);
  std::ranges::stable_sort(all, {}, &Candidate::criterion);
}

/// What the data tell of the free parameters: the inverse of the normal matrix, what each source adds to it, and the
/// degrees of freedom with which the noise of each is known.
struct Uncertainty {
  Eigen::MatrixXd inverse;
  Linearised linear;
  std::vector<double> freedoms;
  double inflation;  ///< of the variance, by the robust norm
};

// That of an estimate with a robust norm (P. J. Huber, Robust Statistics, 1981, section 7.6).
std::optional<Uncertainty> uncertainty_of(const FitProblem& problem, const Candidate& candidate) {
  Linearised linear = problem.linearised(candidate.values, candidate.frees);
  auto inverse = linear.inverse();
  if (!inverse) return std::nullopt;
  const auto n = static_cast<double>(linear.residuals.size());
  const double freedom = std::max(0.25, n - static_cast<double>(linear.normal.cols()));
  double squares = 0, slopes = 0;
  for (const double r : linear.residuals) {
    const double u = 1 + r * r / (kRobust * kRobust);
    squares += r * r / u;
    slopes += 1 / (u * std::sqrt(u));
  }
  std::vector<double> freedoms = problem.freedoms_of(linear);
  for (std::size_t s = 0; s < freedoms.size(); ++s) freedoms[s] /= candidate.values.together[s];
  return Uncertainty{std::move(*inverse), std::move(linear), std::move(freedoms),
                     squares / freedom / std::pow(slopes / n, 2)};
}

/// Half the interval of a weighted sum of the free values: by how much each of them moves to its upper end. The noise
/// of each source is known with degrees of freedom of its own; what that leaves for the sum is F. E. Satterthwaite's
/// approximation (Biometrics Bulletin 2, 1946).
Eigen::VectorXd half_interval(const FitProblem& problem, const Candidate& candidate, const Uncertainty& known,
                              const Eigen::VectorXd& weights) {
  const Eigen::VectorXd gain = known.inverse * weights;
  std::map<const double*, std::pair<double, double>> of_noise;  // variance and degrees of freedom of each noise
  for (std::size_t s = 0; s < known.linear.sources.size(); ++s) {
    const auto& [columns, normal] = known.linear.sources[s];
    auto& [variance, freedom] = of_noise[problem.sources()[s].noise.get()];
    variance += gain(columns).dot(normal * gain(columns)) * known.inflation * candidate.values.together[s];
    freedom = known.freedoms[s];
  }
  double variance = 0, squares = 0;
  for (const auto& [noise, part] : of_noise) {
    variance += part.first;
    squares += part.first * part.first / part.second;
  }
  if (!(variance > 0)) return Eigen::VectorXd::Zero(weights.size());
  const boost::math::students_t student(std::max(1.0, variance * variance / squares));
  return quantile(student, 0.975) * std::sqrt(variance) / weights.dot(gain) * gain;
}

// Durations and largest forces are powers of the speed, v^-b and v^(1 + b) with b = (a - 1)/(a + 1): b is as
// uncertain upwards as downwards, and the exponent is not.
double exponent_moved(double exponent, double by) {
  constexpr double kMost = 0.999;
  const double b = (exponent - 1) / (exponent + 1), slope = 2 / ((exponent + 1) * (exponent + 1));
  const double moved = std::clamp(b + slope * by, -kMost, kMost);
  return (1 + moved) / (1 - moved);
}

// The interval of one parameter, or of a sum of parameters with these weights.
Estimate estimate(const FitProblem& problem, const Candidate& candidate, const std::optional<Uncertainty>& known,
                  const std::vector<std::pair<FitParameter, double>>& sum) {
  double value = 0;
  for (const auto& [parameter, weight] : sum) value += weight * candidate.values.parameters[parameter];
  if (!known) return {value, -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(known->inverse.cols());
  const auto column = [&](FitParameter parameter) {
    return std::ranges::find(candidate.frees, parameter) - candidate.frees.begin();
  };
  for (const auto& [parameter, weight] : sum)
    if (frees(candidate, parameter)) weights[column(parameter)] += weight;
  const Eigen::VectorXd half = half_interval(problem, candidate, *known, weights);
  const auto end = [&](double sign) {
    double moved = 0;
    for (const auto& [parameter, weight] : sum) {
      const double at = candidate.values.parameters[parameter];
      const double by = frees(candidate, parameter) ? sign * half[column(parameter)] : 0;
      moved += weight * (parameter == kExponent ? exponent_moved(at, by) : at + by);
    }
    return moved;
  };
  return {value, end(-1), end(1)};
}

Estimate exponential(const Estimate& of) {
  return {std::exp(of.value), std::exp(of.low), std::exp(of.high)};
}

Estimate scaled(const Estimate& of, double factor) {
  return {factor * of.value, factor * of.low, factor * of.high};
}

// An interval holds nothing that a material may not have.
Estimate within(Estimate of, Range range) {
  of.low = std::clamp(std::min(of.low, of.high), range.min, std::max(range.min, of.value));
  of.high = std::clamp(std::max(of.low, of.high), std::min(of.value, range.max), range.max);
  return of;
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
    find_values(problem, candidate, simpler == all.rend() ? nullptr : &*simpler);
    if (std::isfinite(candidate.values.cost)) all.push_back(candidate);
  }
  return all;
}

// Can a material file hold these numbers?
bool is_material(const FitProblem& problem, const Candidate& candidate) {
  const ViscoelasticLaw<double> law = problem.law(candidate.values);
  const auto in = [](double x, Range range) { return x >= range.min && x <= range.max; };
  const double log_reference = std::log(law.reference_m);
  bool is = in(std::exp(law.log_force - law.exponent * log_reference), ranges::kStiffness) &&
            in(law.exponent, ranges::kExponent) && in(law.loss_s_per_m, ranges::kLoss);
  if (frees(candidate, kDepth))
    is = is &&
         in(std::exp(law.log_force + std::log(law.core) - kHertzExponent * log_reference), ranges::kStiffness) &&
         in(law.depth * law.reference_m, ranges::kOffset);
  if (frees(candidate, kWeight)) is = is && in(law.weight, ranges::kWeight) && in(law.time_s, ranges::kRelaxation);
  return is;
}

// The power law behind a low-pass of the sensor that nobody has stated, if what the best candidate leaves is no
// noise, or if it needs more than a power law: that is what a low-pass looks like. It joins the others if it is
// better.
void try_low_pass(const FitProblem& problem, const Measurements& measured, std::vector<Candidate>& all,
                  const std::function<void(const std::string&)>& tell) {
  constexpr double kTogether = 1.3, kEvidence = 10;
  const Candidate best = all.front();
  const bool is_known =
      std::ranges::any_of(measured.pulses, [](const Pulse& pulse) { return pulse.low_pass_hz.has_value(); });
  const bool is_doubtful =
      std::ranges::max(best.values.together) > kTogether || best.law->name == kLayers || frees(best, kWeight);
  if (measured.pulses.empty() || is_known || !is_doubtful) return;
  const std::vector<Candidate> without = all;
  std::vector<Candidate> behind;
  for (const Candidate& from : without) {
    if (from.law->name == kLayers || frees(from, kWeight)) continue;
    for (const int order : {1, 2}) {
      Candidate candidate = from;
      candidate.low_pass_order = order;
      candidate.frees.push_back(kLogLowPass);
      std::ranges::sort(candidate.frees);
      candidate.values.parameters[kLogLowPass] = problem.low_pass_to_begin_with();
      tell(fitting(candidate) + " behind a low-pass");
      problem.set_low_pass_order(order);
      candidate.values = problem.search(candidate.values, candidate.frees, 60, Samples::kSome);
      if (!std::isfinite(candidate.values.cost)) continue;
      refine(problem, candidate);
      behind.push_back(candidate);
    }
  }
  if (behind.empty()) return;
  all.insert(all.end(), behind.begin(), behind.end());
  set_criteria(problem, all);
  const auto first_without = std::ranges::find(all, 0, &Candidate::low_pass_order);
  if (all.front().low_pass_order > 0 && first_without->criterion - all.front().criterion > kEvidence) return;
  std::erase_if(all, [](const Candidate& candidate) { return candidate.low_pass_order > 0; });
}

// The interval of the exponent. That of Hertz's law is what the power law with the same loss says of the data.
Estimate exponent_of(const FitProblem& problem, const std::vector<Candidate>& all) {
  const Candidate& best = all.front();
  const auto power = std::ranges::find_if(all, [&](const Candidate& other) {
    return std::string_view(other.law->name) == "power" && other.loss == best.loss &&
           other.low_pass_order == best.low_pass_order;
  });
  const Candidate& teller = frees(best, kExponent) || power == all.end() ? best : *power;
  Estimate exponent = estimate(problem, teller, uncertainty_of(problem, teller), {{kExponent, 1}});
  exponent.value = best.values.parameters[kExponent];
  return within(exponent, ranges::kExponent);
}

// The deviation of white noise in a pulse, in parts of its largest force: of its second differences.
double white_noise_of(const Pulse& pulse) {
  std::vector<double> differences;
  const auto& force = pulse.force_n;
  for (std::size_t i = 2; i < force.size(); ++i)
    differences.push_back(std::abs(force[i] - 2 * force[i - 1] + force[i - 2]));
  std::ranges::nth_element(differences, differences.begin() + std::ssize(differences) / 2);
  return differences[differences.size() / 2] / 0.6745 / std::sqrt(6.0) / std::ranges::max(force);
}

// What the files show that the model does not.
void note_poor_files(Fit& fit, const Measurements& measured, const Candidate& best) {
  constexpr double kTogether = 4, kManyTimes = 5, kPoor = 0.1, kWorth = 0.003;
  std::map<std::string, std::vector<double>> scatters;
  for (const FitQuality& quality : fit.qualities) scatters[quality.quantity].push_back(quality.scatter);
  for (std::size_t s = 0; s < fit.qualities.size(); ++s) {
    const FitQuality& quality = fit.qualities[s];
    const std::string what = fmt::format("{}, {}", quality.file, quality.quantity);
    std::vector<double>& others = scatters[quality.quantity];
    std::ranges::sort(others);
    const double usual = others[(others.size() - 1) / 2], floor = quality.is_level() ? 0.1 : kWorth;
    const double noise = s < measured.pulses.size() ? white_noise_of(measured.pulses[s]) : quality.scatter;
    if (quality.scatter > kManyTimes * std::max(usual, floor))
      fit.notes.push_back(fmt::format("{}: scatters {:.3g} times as much as others: look at the figure", what,
                                      quality.scatter / usual));
    else if (!quality.is_level() && quality.scatter > kPoor)
      fit.notes.push_back(
          fmt::format("{}: scatters by {:.3g} %: the model describes it poorly", what, 100 * quality.scatter));
    else if (s < measured.pulses.size() && best.values.together[s] > kTogether &&
             quality.scatter > std::max(kWorth, 1.5 * noise))
      fit.notes.push_back(fmt::format("{}: what the model leaves is no noise: it hangs together over {:.0f} samples",
                                      what, best.values.together[s]));
  }
}

// Numbers that are possible, but that no collision in an instrument is likely to have.
void note_proportions(Fit& fit, const Measurements& measured) {
  constexpr Range kStiffness{100, 1e9}, kSpeed{0.01, 30};
  const double y = fit.max_compression_m;
  const double force = std::exp(fit.model.log_force) * impact_model::shape(fit.model, y);
  const bool has_unknown_speed =
      std::ranges::any_of(measured.pulses, [](const Pulse& p) { return !p.speed_m_per_s; });
  const bool is_odd = !(force / y >= kStiffness.min && force / y <= kStiffness.max);
  const bool is_odd_speed =
      has_unknown_speed && !(fit.min_speed_m_per_s >= kSpeed.min && fit.max_speed_m_per_s <= kSpeed.max);
  if (is_odd || is_odd_speed)
    fit.notes.push_back(
        fmt::format("{:.3g} N at {:.3g} m, at {:.3g} to {:.3g} m/s, is out of proportion: is a unit wrong, "
                    "or are volts called newtons?",
                    force, y, fit.min_speed_m_per_s, fit.max_speed_m_per_s));
}

void note_doubts(Fit& fit, const Measurements& measured, const Candidate& best) {
  if (fit.low_pass_hz)
    fit.notes.push_back(
        fmt::format("the pulses look as if a low-pass of order {} at {:.4g} Hz were before them: if there is "
                    "one, state its low_pass_hz",
                    best.low_pass_order, fit.low_pass_hz->value));
  std::size_t files = 0, recorded = 0, kept = 0;
  for (const Pulse& pulse : measured.pulses)
    if (pulse.recorded > 0) ++files, recorded += pulse.recorded, kept += pulse.time_s.size();
  if (files > 0)
    fit.notes.push_back(fmt::format("{} samples of {} files are many: the means of neighbours were fitted, {} in all",
                                    recorded, files, kept));
  note_poor_files(fit, measured, best);
  note_proportions(fit, measured);
}

}  // namespace

Fit fit_material(const Measurements& measured, const std::string& file,
                 const std::function<void(const std::string&)>& tell) {
  const FitProblem problem(measured);
  std::vector<Candidate> all = found_candidates(problem, measured, tell);
  if (all.empty())
    refuse(file, "fit",
           "no law describes the data, or there are too few values for the laws and losses that are allowed",
           "data of impacts on a rigid wall or a known resonator, in the units that they state, and twice as many "
           "values "
           "as a law with a loss has numbers");
  constexpr double kHopeless = 10;
  const double lowest_cost =
      std::ranges::min(all, {}, [](const Candidate& candidate) { return candidate.values.cost; }).values.cost;
  for (Candidate& candidate : all)
    if (candidate.values.cost <= kHopeless * lowest_cost)
      refine(problem, candidate);
    else
      candidate.values = problem.with_noise(candidate.values, candidate.frees);
  set_criteria(problem, all);
  try_low_pass(problem, measured, all, tell);
  std::erase_if(all, [&](const Candidate& candidate) { return !is_material(problem, candidate); });
  if (all.empty())
    refuse(file, "fit",
           "what describes the data is no material: its stiffness, its core or its memory is out of range",
           fmt::format("a stiffness from {} to {} N/m^exponent: do the units of mass, force and time agree?",
                       ranges::kStiffness.min, ranges::kStiffness.max));
  const Candidate& best = all.front();
  problem.set_low_pass_order(std::max(1, best.low_pass_order));
  const std::optional<Uncertainty> uncertainty = uncertainty_of(problem, best);
  const auto of = [&](const std::vector<std::pair<FitParameter, double>>& sum, double plus = 0) {
    const Estimate found = estimate(problem, best, uncertainty, sum);
    return Estimate{found.value + plus, found.low + plus, found.high + plus};
  };
  Fit fit{
      best.law->name,
      best.loss->name,
      problem.law(best.values),
      within(exponential(of({{kLogForce, 1}, {kExponent, -std::log(problem.reference_m())}})), ranges::kStiffness),
      exponent_of(problem, all),
      within(exponential(of({{kLogForce, 1}, {kLogCore, 1}}, -kHertzExponent * std::log(problem.reference_m()))),
             ranges::kStiffness),
      within(scaled(of({{kDepth, 1}}), problem.reference_m()), ranges::kOffset),
      within(of({{kHuntCrossley, 1}}), ranges::kLoss),
      within(of({{kWeight, 1}}), {0, ranges::kWeight.max}),
      within(exponential(of({{kLogTime, 1}})), ranges::kRelaxation),
      within(exponential(of({{kLogMass, 1}})), kFitMass),
      0,
      0,
      0,
      qualities_of(problem, best),
      {}};
  set_reach(fit, measured, best.values);
  if (measured.has_blows()) require_low_partials(fit, measured, best.values, file);
  for (const Candidate& candidate : all)
    fit.candidates.push_back({candidate.law->name, candidate.loss->name,
                              static_cast<int>(candidate.law->frees.size() + candidate.loss->frees.size()) +
                                  (candidate.low_pass_order > 0 ? 1 : 0),
                              candidate.criterion - best.criterion, candidate.low_pass_order > 0});
  if (best.low_pass_order > 0) {
    constexpr Range kLowPass{1, 1e6};
    fit.low_pass_hz = within(exponential(of({{kLogLowPass, 1}})), kLowPass);
  }
  note_doubts(fit, measured, best);
  return fit;
}

}  // namespace contactspline
