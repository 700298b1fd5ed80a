// SPDX-License-Identifier: MIT
#include "generator/fit/fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <filesystem>
#include <set>

#include "generator/fit/fit_problem.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

/// A model, and the best values that were found for it.
struct Candidate {
  const ModelRow* law;
  const ModelRow* loss;
  std::vector<FitParameter> frees;
  FitValues values;
  double criterion = 0;
};

// Slow curves tell nothing of a loss. A curve of an impact has no times, which a memory needs.
bool tells_of(const ModelRow& loss, const Measurements& measured) {
  const auto is_impact = [](const MeasuredForce& curve) { return curve.impact_speed_m_per_s.has_value(); };
  const bool has_impact_curve = std::ranges::any_of(measured.curves, is_impact);
  if (loss.frees.empty()) return true;
  if (std::ranges::count(loss.frees, kWeight) > 0 && has_impact_curve) return false;
  return has_impact_curve || !measured.pulses.empty() || !measured.rows.empty() || measured.has_blows();
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

// Without layers.
std::vector<Candidate> candidates_of(const Measurements& measured) {
  std::vector<Candidate> all;
  for (const ModelRow& law : laws())
    for (const ModelRow& loss : losses())
      if (law.name != kLayers && std::ranges::count(measured.laws, law.name) > 0 &&
          std::ranges::count(measured.losses, loss.name) > 0 && tells_of(loss, measured))
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
    for (const double depth : {0.3, 0.6, 0.85}) starts.push_back(problem.with_core(simpler->values, depth));
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

// The best of several starts, until two of them agree, from some samples of each pulse. Starts of layers may agree on
// a core that is out of reach, so all are tried.
void find_values(const FitProblem& problem, Candidate& candidate, const Candidate* simpler) {
  constexpr int kSteps = 30;
  constexpr double kAgree = 1e-3;
  candidate.values.cost = std::numeric_limits<double>::infinity();
  for (FitValues& start : starts_of(problem, candidate, simpler)) {
    std::ranges::fill(start.noise, kFirstNoise);
    const FitValues found = problem.search(start, candidate.frees, kSteps, Samples::kSome);
    const double before = candidate.values.cost;
    if (found.cost < before) candidate.values = found;
    if (!frees(candidate, kDepth) && std::abs(found.cost / before - 1) <= kAgree) return;
  }
}

// Twice, with the noise that all samples show about the values.
void refine(const FitProblem& problem, Candidate& candidate) {
  constexpr int kSteps = 60;
  for (int round = 0; round < 2; ++round)
    candidate.values =
        problem.search(problem.with_noise(candidate.values, candidate.frees), candidate.frees, kSteps, Samples::kAll);
}

// Twice the cost at the least noise that any candidate shows, and ln of the number of residuals for each parameter.
void set_criteria(const FitProblem& problem, std::vector<Candidate>& all) {
  std::vector<double> min_noise(problem.sources().size(), std::numeric_limits<double>::infinity());
  for (const Candidate& candidate : all)
    for (std::size_t s = 0; s < min_noise.size(); ++s)
      min_noise[s] = std::min(min_noise[s], candidate.values.noise[s]);
  for (Candidate& candidate : all) {
    const Eigen::VectorXd residuals = problem.linearised(candidate.values, candidate.frees).residuals;
    double cost = 0;
    for (Eigen::Index i = 0; i < residuals.size(); ++i) {
      const std::size_t source = problem.source_of_residual()[static_cast<std::size_t>(i)];
      const double r = residuals[i] * candidate.values.noise[source] / min_noise[source] / kRobust;
      cost += 2 * kRobust * kRobust * (std::sqrt(1 + r * r) - 1);
    }
    candidate.criterion =
        cost + static_cast<double>(candidate.frees.size()) * std::log(static_cast<double>(residuals.size()));
  }
  std::ranges::sort(all, {}, &Candidate::criterion);
}

/// Covariance of the free parameters, and the number of deviations that holds 95 %.
struct Uncertainty {
  Eigen::MatrixXd covariance;
  double deviations;
};

// That of an estimate with a robust norm (P. J. Huber, Robust Statistics, 1981, section 7.6).
Uncertainty uncertainty_of(const FitProblem& problem, const Candidate& candidate) {
  const Linearised linear = problem.linearised(candidate.values, candidate.frees);
  const double n = static_cast<double>(linear.residuals.size());
  const double freedom = std::max(1.0, n - static_cast<double>(linear.jacobian.cols()));
  double squares = 0, slopes = 0;
  for (const double r : linear.residuals) {
    const double u = 1 + r * r / (kRobust * kRobust);
    squares += r * r / u;
    slopes += 1 / (u * std::sqrt(u));
  }
  const Eigen::MatrixXd normal = linear.jacobian.transpose() * linear.jacobian;
  const Eigen::MatrixXd inverse = normal.ldlt().solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols())) *
                                  (squares / freedom) / std::pow(slopes / n, 2);
  const auto shared = static_cast<Eigen::Index>(candidate.frees.size());
  return {inverse.topLeftCorner(shared, shared), boost::math::quantile(boost::math::students_t(freedom), 0.975)};
}

// The interval of one parameter, or of a sum of parameters with these weights.
Estimate estimate(const Candidate& candidate, const Uncertainty& uncertainty,
                  const std::vector<std::pair<FitParameter, double>>& sum) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(uncertainty.covariance.rows());
  double value = 0;
  for (const auto& [parameter, weight] : sum) {
    value += weight * candidate.values.parameters[parameter];
    const auto found = std::ranges::find(candidate.frees, parameter);
    if (found != candidate.frees.end()) weights[found - candidate.frees.begin()] = weight;
  }
  const double half =
      uncertainty.deviations * std::sqrt(std::max(0.0, weights.dot(uncertainty.covariance * weights)));
  return {value, value - half, value + half};
}

Estimate exponential(const Estimate& of) {
  return {std::exp(of.value), std::exp(of.low), std::exp(of.high)};
}

Estimate scaled(const Estimate& of, double factor) {
  return {factor * of.value, factor * of.low, factor * of.high};
}

std::vector<FitQuality> qualities_of(const FitProblem& problem, const Candidate& candidate) {
  const Eigen::VectorXd residuals = problem.linearised(candidate.values, candidate.frees).residuals;
  std::vector<FitQuality> all;
  for (const FitSource& source : problem.sources())
    all.push_back({std::filesystem::path(source.file).filename().string(),
                   source.quantity,
                   source.at.size(),
                   0,
                   source.at,
                   source.measured,
                   {}});
  for (Eigen::Index i = 0; i < residuals.size(); ++i) {
    const std::size_t s = problem.source_of_residual()[static_cast<std::size_t>(i)];
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

// Layers with the loss of the best candidate, the first of all.
void add_layers(const FitProblem& problem, const Measurements& measured, std::vector<Candidate>& all,
                const std::function<void(const std::string&)>& tell) {
  const Candidate best = all.front();
  Candidate layered =
      candidate_of(*std::ranges::find(laws(), std::string_view(kLayers), &ModelRow::name), *best.loss, measured);
  tell(fitting(layered));
  find_values(problem, layered, &best);
  if (!std::isfinite(layered.values.cost)) return;
  refine(problem, layered);
  all.push_back(layered);
  set_criteria(problem, all);
}

}  // namespace

Fit fit_material(const Measurements& measured, const std::string& file,
                 const std::function<void(const std::string&)>& tell) {
  const FitProblem problem(measured);
  std::vector<Candidate> all = candidates_of(measured);
  for (Candidate& candidate : all) {
    tell(fitting(candidate));
    const Candidate* before = &candidate == all.data() ? nullptr : &candidate - 1;
    const Candidate* simpler = before != nullptr && before->law == candidate.law ? before : nullptr;
    find_values(problem, candidate, simpler);
  }
  std::erase_if(all, [](const Candidate& candidate) { return !std::isfinite(candidate.values.cost); });
  if (all.empty())
    refuse(file, "fit", "no law describes the data",
           "data of impacts on a rigid wall or a known resonator, in the units that they state");
  constexpr double kHopeless = 10;
  const double lowest_cost =
      std::ranges::min(all, {}, [](const Candidate& candidate) { return candidate.values.cost; }).values.cost;
  for (Candidate& candidate : all)
    if (candidate.values.cost <= kHopeless * lowest_cost) refine(problem, candidate);
  set_criteria(problem, all);
  if (std::ranges::count(measured.laws, kLayers) > 0) add_layers(problem, measured, all, tell);
  const Candidate& best = all.front();
  const Uncertainty uncertainty = uncertainty_of(problem, best);
  const auto of = [&](const std::vector<std::pair<FitParameter, double>>& sum, double plus = 0) {
    const Estimate found = estimate(best, uncertainty, sum);
    return Estimate{found.value + plus, found.low + plus, found.high + plus};
  };
  Fit fit{best.law->name,
          best.loss->name,
          problem.law(best.values),
          exponential(of({{kLogForce, 1}, {kExponent, -std::log(problem.reference_m())}})),
          of({{kExponent, 1}}),
          exponential(of({{kLogForce, 1}, {kLogCore, 1}}, -kHertzExponent * std::log(problem.reference_m()))),
          scaled(of({{kDepth, 1}}), problem.reference_m()),
          of({{kHuntCrossley, 1}}),
          of({{kWeight, 1}}),
          exponential(of({{kLogTime, 1}})),
          exponential(of({{kLogMass, 1}})),
          0,
          0,
          0,
          qualities_of(problem, best),
          {}};
  fit.loss_s_per_m.low = std::max(0.0, fit.loss_s_per_m.low);
  set_reach(fit, measured, best.values);
  if (measured.has_blows()) require_low_partials(fit, measured, best.values, file);
  for (const Candidate& candidate : all)
    fit.candidates.push_back({candidate.law->name, candidate.loss->name,
                              static_cast<int>(candidate.law->frees.size() + candidate.loss->frees.size()),
                              candidate.criterion - best.criterion});
  return fit;
}

}  // namespace contactspline
