// SPDX-License-Identifier: MIT
#include "generator/fit/fit_problem.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr double kMinNoise = 1e-7;
constexpr double kMinLevelNoise = 0.1 / kDecibelsPerNeper;  // a spectrum tells a level to 0.1 dB
// In the order of FitParameter; the time in parts of the contact's. Shorter memories are a viscous loss, longer ones
// none.
constexpr std::array<Range, kFitParameters> kBounds = {
    {{-30, 40}, {0.6, 9.5}, {0, 900}, {1e-4, 0.999}, {-5.7, 1.6}, {-30, 30}, {0, 1e3}, {-17, 7}, {-100, 100}}};

constexpr double kLikelyExponent = 2.5;

double speed_of(const Pulse& pulse, double mass_kg) {
  constexpr double kLikely = 1.6;  // 1 + restitution
  return pulse.speed_m_per_s.value_or(measures_of(pulse).impulse_n_s / (kLikely * mass_kg));
}

// Enough of its samples to find the values near which all samples are searched.
Pulse thinned(const Pulse& pulse) {
  constexpr std::size_t kSamples = 128;
  const std::size_t stride = pulse.time_s.size() / kSamples + 1;
  Pulse few{pulse.file, {}, {}, pulse.speed_m_per_s, pulse.is_struck};
  for (std::size_t i = 0; i < pulse.time_s.size(); i += stride) {
    few.time_s.push_back(pulse.time_s[i]);
    few.force_n.push_back(pulse.force_n[i]);
  }
  return few;
}

double max_force(const MeasuredForce& curve) {
  return std::ranges::max(curve.samples, {}, &CurveSample::force_n).force_n;
}

/// A pointer to each value, in this order.
template <typename... Values>
std::vector<double*> pointers_to(Values&... values) {
  std::vector<double*> pointers;
  (..., [&] {
    for (double& value : values) pointers.push_back(&value);
  }());
  return pointers;
}

}  // namespace

/// The problem as Ceres takes it, over values that it moves. Each unknown is a block of its own, so Ceres computes
/// the derivatives with respect to what is free alone.
struct FitProblem::Posed {
  ceres::Problem problem;
  ceres::Problem::EvaluateOptions order;

  template <typename Residual>
  void add(Residual residual, std::size_t count, const std::vector<double*>& unknowns) {
    constexpr int kDerivativesAtOnce = 6;
    auto* cost =
        new ceres::DynamicAutoDiffCostFunction<Residual, kDerivativesAtOnce>(new Residual(std::move(residual)));
    for (std::size_t i = 0; i < unknowns.size(); ++i) cost->AddParameterBlock(1);
    cost->SetNumResiduals(static_cast<int>(count));
    order.residual_blocks.push_back(problem.AddResidualBlock(cost, nullptr, unknowns));
  }

  void set_free(double* unknown, bool is_free) {
    if (is_free)
      order.parameter_blocks.push_back(unknown);
    else
      problem.SetParameterBlockConstant(unknown);
  }
};

FitProblem::FitProblem(const Measurements& measured) : measured_(measured), scales_{measured.mass_kg, 1} {
  FLAGS_minloglevel =
      google::GLOG_FATAL;  // a search that fails is none of the user's business; another start is tried
  for (const Pulse& pulse : measured.pulses) {
    pulse_measures_.push_back(measures_of(pulse));
    some_samples_.push_back(thinned(pulse));
    const PulseMeasures& measures = pulse_measures_.back();
    max_speed_m_per_s_ = std::max(max_speed_m_per_s_, contactspline::speed_of(pulse, measured.mass_kg));
    duration_s_ = std::max(duration_s_, measures.end_s - measures.begin_s);
  }
  for (const ImpactRow& row : measured.rows) {
    max_speed_m_per_s_ = std::max(max_speed_m_per_s_, row.speed_m_per_s);
    duration_s_ = std::max(duration_s_, row.duration_s.value_or(0));
  }
  for (std::size_t i = 0; measured.struck && i < measured.struck->blows.size(); ++i)
    max_speed_m_per_s_ = std::max(max_speed_m_per_s_, speed_of(measured.struck->blows[i]));
  if (!measured.has_blows() || !measured.pulses.empty() || !measured.rows.empty() || !measured.curves.empty())
    scales_.reference_m = anchor(kLikelyExponent).first;
  for (const MeasuredForce& curve : measured.curves)
    max_speed_m_per_s_ = std::max(max_speed_m_per_s_, curve.impact_speed_m_per_s.value_or(1));
  if (duration_s_ == 0) duration_s_ = 3 * scales_.reference_m / max_speed_m_per_s_;
  add_sources();
  if (measured.has_blows()) find_contact();
}

FitProblem::~FitProblem() = default;

ViscoelasticLaw<double> FitProblem::law(const FitValues& values) const {
  std::array<const double*, kFitParameters> pointers;
  for (std::size_t i = 0; i < pointers.size(); ++i) pointers[i] = &values.parameters[i];
  return law_of(pointers.data(), scales_.reference_m);
}

// A compression and the force there, as one impact shows them if the law has this exponent and no loss.
std::pair<double, double> FitProblem::anchor(double exponent) const {
  if (contact_) return *contact_;
  const double energy = (exponent + 1) * scales_.mass_kg / 2;
  for (const Pulse& pulse : measured_.pulses) {
    const double v = contactspline::speed_of(pulse, measured_.mass_kg), force = measures_of(pulse).max_force_n;
    return {energy * v * v / force, force};
  }
  constexpr double kDurationOfImpact = 3.2;  // in units of ym/v, for most exponents
  for (const ImpactRow& row : measured_.rows) {
    const double v = row.speed_m_per_s;
    if (row.max_force_n) return {energy * v * v / *row.max_force_n, *row.max_force_n};
    if (row.duration_s) {
      const double y = *row.duration_s * v / kDurationOfImpact;
      return {y, energy * v * v / y};
    }
  }
  if (measured_.curves.empty()) {  // blows on a resonator
    const double y = duration_s_ * max_speed_m_per_s_ / kDurationOfImpact;
    return {y, energy * max_speed_m_per_s_ * max_speed_m_per_s_ / y};
  }
  const MeasuredForce& curve = measured_.curves.front();
  return {curve.samples.back().compression_m, max_force(curve)};
}

// The known speed, or the first known one times the ratio of the amplitudes of the partials that both have.
double FitProblem::speed_of(const Blow& blow) const {
  if (blow.speed_m_per_s) return *blow.speed_m_per_s;
  const auto& known = *std::ranges::find_if(measured_.struck->blows,
                                            [](const Blow& other) { return other.speed_m_per_s.has_value(); });
  double sum = 0, count = 0;
  for (const auto& [mode, level_db] : blow.levels)
    if (const auto same = std::ranges::find(known.levels, mode, &Blow::Level::mode); same != known.levels.end())
      sum += level_db - same->level_db, ++count;
  constexpr double kMax = 2;  // nepers
  return *known.speed_m_per_s * std::exp(std::clamp(sum / std::max(1.0, count) / kDecibelsPerNeper, -kMax, kMax));
}

// Gains with which the mean error of the levels is 0. Returns the sum of what remains, infinity without a motion.
double FitProblem::set_gains(FitValues& values) const {
  FitScales scales = scales_;
  scales.is_robust = false;
  const StruckResonator& struck = *measured_.struck;
  std::vector<std::vector<double>> errors;
  for (std::size_t i = 0; i < struck.blows.size(); ++i) {
    const auto& levels = struck.blows[i].levels;
    std::vector<double> all(levels.size());
    if (!BlowResidual{struck, struck.blows[i], scales, std::make_shared<double>(1)}(
            pointers_to(values.parameters, values.blows[i]).data(), all.data()))
      return std::numeric_limits<double>::infinity();
    errors.emplace_back();
    for (std::size_t k = 0; k < all.size(); ++k)
      if (struck.modes[levels[k].mode].frequency_hz() <= scales.max_frequency_hz) errors.back().push_back(all[k]);
  }
  const auto mean_of = [](std::span<const std::vector<double>> all) {
    double sum = 0, count = 0;
    for (const auto& some : all)
      for (const double error : some) sum += error, ++count;
    return sum / std::max(1.0, count);  // none counts: nothing to mend
  };
  if (struck.has_common_gain) values.parameters[kLogGain] -= mean_of(errors);
  double cost = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double mean = struck.has_common_gain ? mean_of(errors) : mean_of(std::span(errors).subspan(i, 1));
    if (!struck.has_common_gain) values.blows[i][kBlowGain] -= mean;
    for (const double error : errors[i]) cost += std::abs(error - mean);
  }
  return cost;
}

void FitProblem::take_contact(double mass_kg, double duration_s) {
  scales_.mass_kg = mass_kg;
  duration_s_ = duration_s;
  scales_.reference_m = anchor(kLikelyExponent).first;
}

// Contacts of many durations and, if it is not known, masses: the few that describe the levels best. The values name
// the duration as that of a memory.
std::vector<FitValues> FitProblem::scanned_contacts() {
  constexpr int kDurations = 24, kMasses = 12;
  constexpr std::size_t kKept = 6;
  const bool has_anchor = !measured_.pulses.empty() || !measured_.rows.empty() || !measured_.curves.empty();
  const StruckMode& first =
      *std::ranges::find_if(measured_.struck->modes, [](const StruckMode& mode) { return mode.shape != 0; });
  const double known_duration_s = duration_s_, known_mass_kg = scales_.mass_kg;
  const double exponent = std::ranges::count(measured_.laws, "power") > 0 ? kLikelyExponent : kHertzExponent;
  std::vector<std::pair<double, FitValues>> all;
  double reference_m = 0;
  for (int m = 0; m < (measured_.fits_mass() ? kMasses : 1); ++m)
    for (int d = 0; d < (has_anchor ? 1 : kDurations); ++d) {
      const double ratio = 0.02 * std::pow(200, m / (kMasses - 1.0));  // to what the first mode resists with
      take_contact(measured_.fits_mass() ? ratio * first.mass_kg / (first.shape * first.shape) : known_mass_kg,
                   has_anchor ? known_duration_s : 1e-4 * std::pow(100, d / (kDurations - 1.0)));
      if (reference_m == 0) reference_m = scales_.reference_m;
      FitValues values = begin(exponent, 0, 0, 1);
      values.parameters[kLogForce] += exponent * std::log(reference_m / scales_.reference_m);
      all.emplace_back(values.cost, values);
    }
  scales_.reference_m = reference_m;
  std::ranges::sort(all, {}, &std::pair<double, FitValues>::first);
  std::vector<FitValues> kept;
  for (std::size_t i = 0; i < std::min(kKept, all.size()); ++i) kept.push_back(all[i].second);
  return kept;
}

// The levels of high partials have many minima over mass and stiffness, those of low ones few: they show the way.
// Noise misleads few levels most, so the lowest partials alone are tried only if six of them lead nowhere.
void FitProblem::find_contact() {
  std::set<double> frequencies;
  double levels = 0;
  for (const Blow& blow : measured_.struck->blows)
    for (const auto& [mode, level_db] : blow.levels) {
      frequencies.insert(measured_.struck->modes[mode].frequency_hz());
      ++levels;
    }
  const std::vector<double> sorted(frequencies.begin(), frequencies.end());
  FitValues best = contact_from(6, sorted);
  if (best.cost > levels / 2)
    if (const FitValues other = contact_from(measured_.struck->has_common_gain ? 1 : 2, sorted);
        other.cost < best.cost)
      best = other;
  scales_.max_frequency_hz = std::numeric_limits<double>::infinity();
  if (!std::isfinite(best.cost)) return;
  const double at_m = scales_.reference_m;
  take_contact(std::exp(best.parameters[kLogMass]), std::exp(best.parameters[kLogTime]));
  contact_ = {scales_.reference_m, std::exp(best.parameters[kLogForce] +
                                            best.parameters[kExponent] * std::log(scales_.reference_m / at_m))};
  likely_exponents_ = {best.parameters[kExponent]};
}

// The best of several contacts, fitted to the levels of so many partials, then to twice as many, and so on to all.
FitValues FitProblem::contact_from(std::size_t partials, const std::vector<double>& frequencies) {
  constexpr int kSteps = 12;
  constexpr double kNoise = 0.2;
  const auto limit_to = [&](std::size_t count) {
    scales_.max_frequency_hz = frequencies[std::min(count, frequencies.size()) - 1];
  };
  limit_to(partials);
  std::vector<FitParameter> frees{kLogForce};
  if (std::ranges::count(measured_.laws, "power") > 0) frees.push_back(kExponent);
  if (measured_.fits_mass()) frees.push_back(kLogMass);
  if (measured_.struck->has_common_gain) frees.push_back(kLogGain);
  FitValues best;
  best.cost = std::numeric_limits<double>::infinity();
  for (FitValues values : scanned_contacts()) {
    std::ranges::fill(values.noise, kNoise);
    for (std::size_t count = partials;; count *= 2) {
      limit_to(count);
      values = search(values, frees, kSteps, Samples::kAll);
      if (count >= frequencies.size()) break;
    }
    if (values.cost < best.cost) best = values;
  }
  return best;
}

std::size_t FitProblem::source_called(const std::string& file, const std::string& quantity) {
  const auto found = std::ranges::find_if(
      sources_, [&](const FitSource& source) { return source.file == file && source.quantity == quantity; });
  if (found != sources_.end()) return static_cast<std::size_t>(found - sources_.begin());
  sources_.push_back({file, quantity, std::make_shared<double>(kFirstNoise), {}, {}, {}});
  return sources_.size() - 1;
}

void FitProblem::add_sample(std::size_t source, double at, double measured, double scale) {
  sources_[source].at.push_back(at);
  sources_[source].measured.push_back(measured);
  sources_[source].scale.push_back(scale);
  source_of_residual_.push_back(source);
}

void FitProblem::add_sources() {
  for (std::size_t k = 0; k < measured_.pulses.size(); ++k) {
    const Pulse& pulse = measured_.pulses[k];
    sources_.push_back({pulse.file, "force", std::make_shared<double>(kFirstNoise), {}, {}, {}});
    for (std::size_t i = 0; i < pulse.time_s.size(); ++i)
      add_sample(k, pulse.time_s[i], pulse.force_n[i], pulse_measures_[k].max_force_n);
  }
  for (const ImpactRow& row : measured_.rows) {
    RowResidual residual{row.speed_m_per_s, {}, scales_, {}};
    const std::array<std::pair<const char*, std::optional<double>>, 3> values = {
        {{"duration", row.duration_s}, {"largest force", row.max_force_n}, {"restitution", row.restitution}}};
    for (int i = 0; i < 3; ++i)
      if (const auto& [quantity, value] = values[static_cast<std::size_t>(i)]; value) {
        const std::size_t source = source_called(row.file, quantity);
        add_sample(source, row.speed_m_per_s, *value, *value);
        residual.measured.emplace_back(i, *value);
        residual.noise.push_back(sources_[source].noise);
      }
    rows_.push_back(std::move(residual));
  }
  first_curve_ = sources_.size();
  for (const MeasuredForce& curve : measured_.curves) {
    sources_.push_back({curve.file, "force over compression", std::make_shared<double>(kFirstNoise), {}, {}, {}});
    for (const CurveSample& sample : curve.samples)
      add_sample(sources_.size() - 1, sample.compression_m, sample.force_n, max_force(curve));
  }
  if (measured_.has_blows()) add_levels();
}

// A blow has few levels: one noise for all of them is better known.
void FitProblem::add_levels() {
  const StruckResonator& struck = *measured_.struck;
  const auto noise = std::make_shared<double>(kFirstNoise);
  for (const Blow& blow : struck.blows) {
    sources_.push_back({blow.file, kLevels, noise, {}, {}, {}});
    for (const auto& [mode, level_db] : blow.levels)
      add_sample(sources_.size() - 1, struck.modes[mode].frequency_hz(), level_db, kDecibelsPerNeper);
  }
}

FitValues FitProblem::begin(double exponent, double loss, double weight, double time_ratio) const {
  const auto [y, force] = anchor(exponent);
  FitValues values{
      {std::log(force) + exponent * std::log(scales_.reference_m / y), exponent, loss / max_speed_m_per_s_, weight,
       std::log(time_ratio * duration_s_), kNoCore, 0, std::log(scales_.mass_kg), 0},
      {},
      {},
      std::vector<double>(sources_.size(), kFirstNoise)};
  constexpr double kBefore = -0.1;  // the contact begins before a tenth of its largest force
  for (const Pulse& pulse : measured_.pulses)
    values.pulses.push_back({kBefore, std::log(contactspline::speed_of(pulse, measured_.mass_kg)), 0});
  for (std::size_t i = 0; measured_.struck && i < measured_.struck->blows.size(); ++i)
    values.blows.push_back({std::log(speed_of(measured_.struck->blows[i])), 0});
  if (measured_.has_blows()) values.cost = set_gains(values);
  return values;
}

FitValues FitProblem::with_core(FitValues values, double depth) const {
  auto& p = values.parameters;
  const double a = p[kExponent], energy = scales_.mass_kg * max_speed_m_per_s_ * max_speed_m_per_s_ / 2;
  double reach = 0;  // in parts of the reference
  if (!measured_.pulses.empty() || !measured_.rows.empty() || measured_.struck)
    reach =
        std::pow((a + 1) * energy / ((1 - p[kWeight]) * std::exp(p[kLogForce]) * scales_.reference_m), 1 / (a + 1));
  for (const MeasuredForce& curve : measured_.curves)
    reach = std::max(reach, curve.samples.back().compression_m / scales_.reference_m);
  p[kDepth] = depth * reach;
  p[kLogCore] = a * std::log(reach) - kHertzExponent * std::log(reach - p[kDepth]);
  return values;
}

// Pulses, rows and curves depend on the law alone, blows on the hammer too.
void FitProblem::pose_parameters(Posed& posed, std::span<double> parameters,
                                 const std::vector<FitParameter>& frees) const {
  for (int i = 0; i < std::ssize(parameters); ++i) {
    double* parameter = &parameters[static_cast<std::size_t>(i)];
    const bool is_free = std::ranges::find(frees, i) != frees.end();
    posed.problem.AddParameterBlock(parameter, 1);
    posed.set_free(parameter, is_free);
    if (!is_free) continue;
    const auto& [min, max] = kBounds[static_cast<std::size_t>(i)];
    const double unit = i == kLogTime ? std::log(duration_s_) : 0;
    posed.problem.SetParameterLowerBound(parameter, 0, min + unit);
    posed.problem.SetParameterUpperBound(parameter, 0, max + unit);
  }
}

std::unique_ptr<FitProblem::Posed> FitProblem::pose(FitValues& values, const std::vector<FitParameter>& frees,
                                                    Samples samples) const {
  auto posed = std::make_unique<Posed>();
  const std::span<double, kLawParameters> law(values.parameters.data(), kLawParameters);
  pose_parameters(*posed, std::span(values.parameters).first(measured_.struck ? kFitParameters : kLawParameters),
                  frees);
  for (std::size_t i = 0; i < sources_.size(); ++i) *sources_[i].noise = values.noise[i];
  for (std::size_t i = 0; i < measured_.pulses.size(); ++i) {
    const Pulse& pulse = (samples == Samples::kSome ? some_samples_ : measured_.pulses)[i];
    auto& unknown = values.pulses[i];
    const PulseResidual residual{pulse, pulse_measures_[i], scales_, sources_[i].noise};
    if (pulse.is_struck)
      posed->add(StruckPulseResidual{residual, measured_.struck->modes}, pulse.time_s.size(),
                 pointers_to(values.parameters, unknown));
    else
      posed->add(residual, pulse.time_s.size(), pointers_to(law, unknown));
    for (std::size_t k = 0; k < unknown.size(); ++k)
      posed->set_free(&unknown[k], k != kLogSpeed || !pulse.speed_m_per_s);
  }
  for (const RowResidual& row : rows_) posed->add(row, row.measured.size(), pointers_to(law));
  for (std::size_t i = 0; i < measured_.curves.size(); ++i) {
    const MeasuredForce& curve = measured_.curves[i];
    posed->add(CurveResidual{curve, max_force(curve), scales_, sources_[first_curve_ + i].noise},
               curve.samples.size(), pointers_to(law));
  }
  for (std::size_t i = 0; i < values.blows.size(); ++i) {
    const Blow& blow = measured_.struck->blows[i];
    auto& unknown = values.blows[i];
    posed->add(
        BlowResidual{*measured_.struck, blow, scales_, sources_[first_curve_ + measured_.curves.size() + i].noise},
        blow.levels.size(), pointers_to(values.parameters, unknown));
    posed->set_free(&unknown[kBlowSpeed], !blow.speed_m_per_s);
    posed->set_free(&unknown[kBlowGain], !measured_.struck->has_common_gain);
  }
  return posed;
}

FitValues FitProblem::search(FitValues values, const std::vector<FitParameter>& frees, int max_steps,
                             Samples samples) const {
  scales_.is_robust = true;
  const auto posed = pose(values, frees, samples);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;  // each pulse's unknowns on their own
  options.max_num_iterations = max_steps;
  options.max_num_line_search_step_size_iterations = 0;  // a step is shortened to the bounds, not searched along
  options.function_tolerance = samples == Samples::kSome ? 1e-5 : 1e-8;
  options.parameter_tolerance = 1e-9;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &posed->problem, &summary);
  values.cost = summary.IsSolutionUsable() ? summary.final_cost : std::numeric_limits<double>::infinity();
  return values;
}

Linearised FitProblem::linearised(const FitValues& at, const std::vector<FitParameter>& frees) const {
  FitValues values = at;
  scales_.is_robust = false;
  const auto posed = pose(values, frees, Samples::kAll);
  std::vector<double> residuals;
  ceres::CRSMatrix sparse;
  posed->problem.Evaluate(posed->order, nullptr, &residuals, nullptr, &sparse);
  Linearised linear{Eigen::Map<Eigen::VectorXd>(residuals.data(), static_cast<Eigen::Index>(residuals.size())),
                    Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols)};
  for (int row = 0; row < sparse.num_rows; ++row)
    for (int i = sparse.rows[static_cast<std::size_t>(row)]; i < sparse.rows[static_cast<std::size_t>(row) + 1]; ++i)
      linear.jacobian(row, sparse.cols[static_cast<std::size_t>(i)]) = sparse.values[static_cast<std::size_t>(i)];
  return linear;
}

FitValues FitProblem::with_noise(FitValues values, const std::vector<FitParameter>& frees) const {
  const Linearised linear = linearised(values, frees);
  const double all = static_cast<double>(linear.residuals.size());
  const double free_part = std::max(0.1, 1 - static_cast<double>(linear.jacobian.cols()) / all);
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    std::vector<double> sizes;
    for (std::size_t i = 0; i < source_of_residual_.size(); ++i)
      if (sources_[source_of_residual_[i]].noise == sources_[s].noise)
        sizes.push_back(std::abs(linear.residuals[static_cast<Eigen::Index>(i)]));
    std::ranges::sort(sizes);
    const double likely = 4 * sizes[sizes.size() / 2] / 0.6745;  // beyond four deviations is no noise
    double sum = 0, count = 0;
    for (const double size : sizes)
      if (size <= likely) sum += size * size, ++count;
    const double min_noise = sources_[s].quantity == kLevels ? kMinLevelNoise : kMinNoise;
    values.noise[s] = std::max(min_noise, values.noise[s] * std::sqrt(sum / count / free_part));
  }
  return values;
}

}  // namespace contactspline
