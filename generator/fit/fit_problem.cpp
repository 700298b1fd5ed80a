// SPDX-License-Identifier: MIT
#include "generator/fit/fit_problem.hpp"

#include <ceres/tiny_solver.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <set>

#include "generator/fit/fit_dual.hpp"
#include "generator/support/ranges.hpp"

namespace contactspline {
namespace {

constexpr double kMinLevelNoise = 0.1 / kDecibelsPerNeper;  // a spectrum tells a level to 0.1 dB
// In the order of FitParameter; the time in parts of the contact's. Shorter memories are a viscous loss, longer ones
// none.
constexpr std::array<Range, kFitParameters> kBounds = {{{-30, 40},
                                                        {0.6, 9.5},
                                                        {0, 900},
                                                        {1e-4, ranges::kWeight.max},
                                                        {-5.7, 1.6},
                                                        {-30, 30},
                                                        {0, 1e3},
                                                        {2, 14},
                                                        {-17, 7},
                                                        {-100, 100}}};

constexpr double kLikelyExponent = 2.5;

double speed_of(const Pulse& pulse, double mass_kg) {
  constexpr double kLikely = 1.6;  // 1 + restitution
  return pulse.speed_m_per_s.value_or(measures_of(pulse).impulse_n_s / (kLikely * mass_kg));
}

// Enough of its samples to find the values near which all samples are searched.
Pulse thinned(const Pulse& pulse) {
  constexpr std::size_t kSamples = 128;
  const std::size_t stride = pulse.time_s.size() / kSamples + 1;
  Pulse few{pulse.file, {}, {}, pulse.speed_m_per_s, pulse.is_struck, pulse.low_pass_hz, pulse.low_pass_order};
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

/// The problem over values that a search moves: blocks of residuals, each of its own unknowns.
struct FitProblem::Posed {
  struct Block {
    std::function<bool(const FitDual* const*, FitDual*)> residual;
    std::size_t count;
    std::vector<double*> unknowns;
  };
  struct Free {
    double* value;
    std::optional<Range> bounds;
  };
  std::vector<Block> blocks;
  std::vector<Free> frees;  ///< in the order of the columns

  void add(std::function<bool(const FitDual* const*, FitDual*)> residual, std::size_t count,
           std::vector<double*> unknowns) {
    blocks.push_back({std::move(residual), count, std::move(unknowns)});
  }
  void set_free(double* value, std::optional<Range> bounds = {}) { frees.push_back({value, bounds}); }

  /// Of what is free in a block: the columns, and in their order the places among the block's unknowns.
  struct Columns {
    std::vector<Eigen::Index> of_all;
    std::vector<std::size_t> unknowns;
  };
  [[nodiscard]] Columns columns_of(const Block& block) const {
    Columns found;
    for (std::size_t i = 0; i < block.unknowns.size(); ++i)
      if (const auto at = std::ranges::find(frees, block.unknowns[i], &Free::value); at != frees.end()) {
        found.of_all.push_back(at - frees.begin());
        found.unknowns.push_back(i);
      }
    return found;
  }

  /// The derivatives of a block's residuals with respect to what is free in it, and the residuals in the last column.
  /// Infinite if the model has no motion.
  [[nodiscard]] Eigen::MatrixXd linearised(const Block& block) const {
    const std::vector<std::size_t> free = columns_of(block).unknowns;
    Eigen::MatrixXd linear(block.count, free.size() + 1);
    for (std::size_t begin = 0; begin == 0 || begin < free.size(); begin += FitDual::kSlopes) {
      const std::size_t count = std::min(FitDual::kSlopes, free.size() - begin);
      std::vector<FitDual> unknowns, residuals(block.count);
      for (const double* value : block.unknowns) unknowns.emplace_back(*value);
      for (std::size_t k = 0; k < count; ++k) unknowns[free[begin + k]].set_slope(k, 1);
      std::vector<const FitDual*> pointers;
      for (const FitDual& unknown : unknowns) pointers.push_back(&unknown);
      if (!block.residual(pointers.data(), residuals.data()))
        return linear.setConstant(std::numeric_limits<double>::infinity());
      for (Eigen::Index row = 0; row < linear.rows(); ++row) {
        const FitDual& residual = residuals[static_cast<std::size_t>(row)];
        for (std::size_t k = 0; k < count; ++k) linear(row, static_cast<Eigen::Index>(begin + k)) = residual.slope(k);
        linear(row, linear.cols() - 1) = residual.value;
      }
    }
    if (!linear.allFinite()) linear.setConstant(std::numeric_limits<double>::infinity());
    return linear;
  }
};

namespace {

/// The problem as Ceres' small solver takes it: over an angle u for each value with bounds, low + (high - low) (1 +
/// sin u)/2. The rows of each block are turned by an orthogonal matrix: all but the first few are 0 then, and left
/// out.
template <typename Posed>
class Search {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  explicit Search(const Posed& posed) : posed_(posed) {}

  // NOLINTBEGIN(readability-identifier-naming): names that Ceres asks for
  [[nodiscard]] int NumParameters() const { return static_cast<int>(posed_.frees.size()); }
  [[nodiscard]] int NumResiduals() const {
    std::size_t rows = 0;
    for (const auto& block : posed_.blocks) rows += rows_of(block);
    return static_cast<int>(rows);
  }
  // NOLINTEND(readability-identifier-naming)

  [[nodiscard]] Eigen::VectorXd start() const {
    Eigen::VectorXd u(NumParameters());
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      const auto& [value, bounds] = free(i);
      u[i] = bounds ? std::asin(std::clamp(2 * (*value - bounds->min) / (bounds->max - bounds->min) - 1, -1.0, 1.0))
                    : *value;
    }
    return u;
  }

  void set(const double* u) const {
    for (Eigen::Index i = 0; i < NumParameters(); ++i) {
      const auto& [value, bounds] = free(i);
      *value = bounds ? bounds->min + (bounds->max - bounds->min) * (1 + std::sin(u[i])) / 2 : u[i];
    }
  }

  // Residuals are infinite where the model has no motion. `derivatives` may be null: a step that is taken asks again
  // for both, so the last ones are kept.
  bool operator()(const double* u, double* residuals, double* derivatives) const {
    const Eigen::Map<const Eigen::VectorXd> at(u, NumParameters());
    if (at_.size() == 0 || at_ != at) evaluate(at);
    Eigen::Map<Eigen::VectorXd>(residuals, residuals_.size()) = residuals_;
    if (derivatives != nullptr)
      Eigen::Map<Eigen::MatrixXd>(derivatives, jacobian_.rows(), jacobian_.cols()) = jacobian_;
    return true;
  }

 private:
  void evaluate(const Eigen::VectorXd& at) const {
    at_ = at;
    set(at.data());
    residuals_.resize(NumResiduals());
    jacobian_.setZero(residuals_.size(), at.size());
    Eigen::Index row = 0;
    for (const auto& block : posed_.blocks) {
      const Eigen::Index rows = rows_of(block);
      const Eigen::MatrixXd linear = posed_.linearised(block);
      if (linear.allFinite()) {
        const Eigen::MatrixXd turned = Eigen::HouseholderQR<Eigen::MatrixXd>(linear)
                                           .matrixQR()
                                           .topRows(rows)
                                           .template triangularView<Eigen::Upper>();
        jacobian_.middleRows(row, rows)(Eigen::all, posed_.columns_of(block).of_all) =
            turned.leftCols(turned.cols() - 1);
        residuals_.segment(row, rows) = turned.rightCols<1>();
      } else {
        residuals_.segment(row, rows).setConstant(std::numeric_limits<double>::infinity());
      }
      row += rows;
    }
    for (Eigen::Index i = 0; i < at.size(); ++i)
      if (const auto& bounds = free(i).bounds) jacobian_.col(i) *= (bounds->max - bounds->min) * std::cos(at[i]) / 2;
  }

  [[nodiscard]] std::size_t rows_of(const typename Posed::Block& block) const {
    return std::min(block.count, posed_.columns_of(block).unknowns.size() + 1);
  }
  [[nodiscard]] const auto& free(Eigen::Index i) const { return posed_.frees[static_cast<std::size_t>(i)]; }

  const Posed& posed_;
  mutable Eigen::VectorXd at_, residuals_;
  mutable Eigen::MatrixXd jacobian_;
};

}  // namespace

// By Cholesky's method, with a diagonal scaled to 1.
std::optional<Eigen::MatrixXd> Linearised::inverse() const {
  constexpr double kSingular = 1e-15;
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  const Eigen::LLT<Eigen::MatrixXd> factors(scale.asDiagonal() * normal * scale.asDiagonal());
  if (factors.info() != Eigen::Success || !(factors.rcond() > kSingular)) return std::nullopt;
  const Eigen::MatrixXd inverse = factors.solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

double min_noise(const FitSource& source) {
  return source.quantity == kLevels ? kMinLevelNoise : kMinNoise;
}

FitProblem::FitProblem(const Measurements& measured) : measured_(measured), scales_{measured.mass_kg, 1} {
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
// Noise misleads few levels most, so fewer or more than six partials are tried only if six of them lead nowhere.
void FitProblem::find_contact() {
  std::set<double> frequencies;
  double levels = 0;
  for (const Blow& blow : measured_.struck->blows)
    for (const auto& [mode, level_db] : blow.levels) {
      frequencies.insert(measured_.struck->modes[mode].frequency_hz());
      ++levels;
    }
  const std::vector<double> sorted(frequencies.begin(), frequencies.end());
  FitValues best;
  best.cost = std::numeric_limits<double>::infinity();
  const std::size_t fewest = measured_.struck->has_common_gain ? 1 : 2;
  for (const std::size_t partials : {std::size_t{6}, fewest, std::size_t{3}, std::size_t{12}}) {
    const FitValues found = contact_from(partials, sorted);
    if (found.cost < best.cost) best = found;
    if (best.cost <= levels / 2) break;
  }
  scales_.max_frequency_hz = std::numeric_limits<double>::infinity();
  if (!std::isfinite(best.cost)) return;
  best = best_beside(best);
  const double at_m = scales_.reference_m;
  take_contact(std::exp(best.parameters[kLogMass]), std::exp(best.parameters[kLogTime]));
  contact_ = {scales_.reference_m, std::exp(best.parameters[kLogForce] +
                                            best.parameters[kExponent] * std::log(scales_.reference_m / at_m))};
  likely_exponents_ = {best.parameters[kExponent]};
}

// The best of several contacts, fitted to the levels of so many partials, then to twice as many, and so on to all.
FitValues FitProblem::contact_from(std::size_t partials, const std::vector<double>& frequencies) {
  constexpr double kNoise = 0.2;
  const auto limit_to = [&](std::size_t count) {
    scales_.max_frequency_hz = frequencies[std::min(count, frequencies.size()) - 1];
  };
  limit_to(partials);
  FitValues best;
  best.cost = std::numeric_limits<double>::infinity();
  for (FitValues values : scanned_contacts()) {
    std::ranges::fill(values.noise, kNoise);
    for (std::size_t count = partials;; count *= 2) {
      limit_to(count);
      values = search_contact(values);
      if (count >= frequencies.size()) break;
    }
    if (values.cost < best.cost) best = values;
  }
  return best;
}

FitValues FitProblem::search_contact(const FitValues& from) const {
  constexpr int kSteps = 24;
  std::vector<FitParameter> frees{kLogForce};
  if (std::ranges::count(measured_.laws, "power") > 0) frees.push_back(kExponent);
  if (measured_.fits_mass()) frees.push_back(kLogMass);
  if (measured_.struck->has_common_gain) frees.push_back(kLogGain);
  return search(from, frees, kSteps, Samples::kAll);
}

// The levels of all partials have minima some 7 % of the mass apart, at contacts of equal duration: those on both
// sides are tried as long as they lead down.
FitValues FitProblem::best_beside(FitValues best) const {
  constexpr std::array kLogRatios = {-0.14, -0.07, 0.07, 0.14};
  constexpr double kLower = 0.999;
  for (double before = 2 * best.cost; best.cost < kLower * before;) {
    before = best.cost;
    const FitValues from = best;
    for (const double log_ratio : kLogRatios) {
      FitValues values = from;
      values.parameters[kLogForce] += log_ratio;
      if (measured_.fits_mass()) values.parameters[kLogMass] += log_ratio;
      values = search_contact(values);
      if (values.cost < best.cost) best = values;
    }
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
       std::log(time_ratio * duration_s_), kNoCore, 0, kNoLowPass, std::log(scales_.mass_kg), 0},
      {},
      {},
      std::vector<double>(sources_.size(), kFirstNoise),
      std::vector<double>(sources_.size(), 1)};
  constexpr double kBefore = -0.1;  // the contact begins before a tenth of its largest force
  for (const Pulse& pulse : measured_.pulses)
    values.pulses.push_back({kBefore, std::log(contactspline::speed_of(pulse, measured_.mass_kg)), 0, 0});
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

DenseTimes FitProblem::dense_for(const Pulse& pulse, std::size_t number) const {
  constexpr double kSteps = 150;  // a contact: as many as its motion has
  const PulseMeasures& measures = pulse_measures_[number];
  double longest_s = (measures.end_s - measures.begin_s) / kSteps;
  if (pulse.low_pass_hz) longest_s = std::min(longest_s, 0.25 / (2 * std::numbers::pi * *pulse.low_pass_hz));
  return dense_times(pulse.time_s, longest_s);
}

double FitProblem::log_frequency(double periods) const {
  return std::log(periods / duration_s_);
}

std::unique_ptr<FitProblem::Posed> FitProblem::pose(FitValues& values, const std::vector<FitParameter>& frees,
                                                    Samples samples) const {
  auto posed = std::make_unique<Posed>();
  const std::span<double, kLawParameters> law(values.parameters.data(), kLawParameters);
  for (const FitParameter parameter : frees) {
    const auto& [min, max] = kBounds[parameter];
    const double unit = parameter == kLogTime ? std::log(duration_s_) : 0;
    posed->set_free(&values.parameters[parameter], Range{min + unit, max + unit});
  }
  for (std::size_t i = 0; i < sources_.size(); ++i) *sources_[i].noise = values.noise[i];
  for (std::size_t i = 0; i < measured_.pulses.size(); ++i) {
    const Pulse& pulse = (samples == Samples::kSome ? some_samples_ : measured_.pulses)[i];
    auto& unknown = values.pulses[i];
    PulseResidual residual{pulse, pulse_measures_[i], scales_, sources_[i].noise};
    if (pulse.low_pass_hz || values.low_pass_order > 0) residual.dense = dense_for(pulse, i);
    residual.fitted_order = values.low_pass_order;
    if (pulse.is_struck)
      posed->add(StruckPulseResidual{residual, measured_.struck->modes}, pulse.time_s.size(),
                 pointers_to(values.parameters, unknown));
    else
      posed->add(residual, pulse.time_s.size(), pointers_to(law, unknown));
    for (std::size_t k = 0; k < unknown.size(); ++k)
      if (k != kLogSpeed || !pulse.speed_m_per_s) posed->set_free(&unknown[k]);
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
    if (!blow.speed_m_per_s) posed->set_free(&unknown[kBlowSpeed]);
    if (!measured_.struck->has_common_gain) posed->set_free(&unknown[kBlowGain]);
  }
  return posed;
}

FitValues FitProblem::search(FitValues values, const std::vector<FitParameter>& frees, int max_steps,
                             Samples samples) const {
  scales_.is_robust = true;
  const auto posed = pose(values, frees, samples);
  const Search search(*posed);
  ceres::TinySolver<Search<Posed>> solver;
  solver.options.max_num_iterations = max_steps;
  solver.options.initial_trust_region_radius = 10;  // levels have many minima: the first steps stay near the start
  solver.options.function_tolerance = samples == Samples::kSome ? 1e-5 : 1e-8;  // of twice the cost, absolute
  solver.options.parameter_tolerance = 1e-9;
  Eigen::VectorXd u = search.start();
  values.cost = solver.Solve(search, &u).final_cost;
  search.set(u.data());
  return values;
}

Linearised FitProblem::linearised(const FitValues& at, const std::vector<FitParameter>& frees) const {
  FitValues values = at;
  scales_.is_robust = false;
  const auto posed = pose(values, frees, Samples::kAll);
  const auto all = std::ssize(posed->frees);
  Linearised linear{{}, Eigen::MatrixXd::Zero(all, all), std::vector<SourceNormal>(sources_.size())};
  for (const Posed::Block& block : posed->blocks) {
    const auto columns = posed->columns_of(block).of_all;
    const Eigen::MatrixXd part = posed->linearised(block);
    for (const auto& row : part.rowwise()) {
      SourceNormal& source = linear.sources[source_of_residual_[linear.residuals.size()]];
      linear.residuals.push_back(row.tail<1>().value());
      if (source.columns.empty()) source = {columns, Eigen::MatrixXd::Zero(std::ssize(columns), std::ssize(columns))};
      if (!std::isfinite(linear.residuals.back())) continue;
      const auto slopes = row.head(std::ssize(columns));
      source.normal += slopes.transpose() * slopes;
    }
  }
  for (const auto& [columns, normal] : linear.sources) linear.normal(columns, columns) += normal;
  return linear;
}

namespace {

// The number of samples that tell as much as one that is independent of the others.
double samples_together(std::span<const double> residuals) {
  constexpr double kOutlier = 4;  // in parts of the noise
  const std::size_t n = residuals.size();
  std::vector<double> r;
  for (const double residual : residuals) r.push_back(std::clamp(residual, -kOutlier, kOutlier));
  double mean = 0, square = 0, together = 1;
  for (const double x : r) mean += x / static_cast<double>(n);
  for (const double x : r) square += (x - mean) * (x - mean);
  for (std::size_t lag = 1; lag < n / 4; ++lag) {
    double product = 0;
    for (std::size_t i = lag; i < n; ++i) product += (r[i] - mean) * (r[i - lag] - mean);
    const double correlation = product / square;
    if (!(correlation > 2 / std::sqrt(static_cast<double>(n)))) break;  // chance
    together += 2 * correlation;
  }
  return std::min(together, std::max(1.0, static_cast<double>(n) / 8));
}

}  // namespace

std::size_t FitProblem::free_values(const std::vector<FitParameter>& frees) const {
  FitValues values = begin(kLikelyExponent, 0, 0, 1);
  return pose(values, frees, Samples::kSome)->frees.size();
}

std::vector<double> FitProblem::freedoms_of(const Linearised& linear) const {
  std::vector<double> freedoms(sources_.size());
  const auto inverse = linear.inverse();
  const double all = static_cast<double>(linear.residuals.size()),
               columns = static_cast<double>(linear.normal.cols());
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    const auto n = static_cast<double>(sources_[s].at.size());
    const auto& [at, normal] = linear.sources[s];
    // Less as many values as the source's data tell of.
    freedoms[s] = inverse ? n - (*inverse)(at, at).cwiseProduct(normal).sum() : n * (1 - columns / all);
  }
  std::vector<double> together(freedoms);  // of sources whose noise is the same
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    constexpr double kLeast = 0.25;
    together[s] = 0;
    for (std::size_t other = 0; other < sources_.size(); ++other)
      if (sources_[other].noise == sources_[s].noise) together[s] += freedoms[other];
    together[s] = std::max(kLeast, together[s]);
  }
  return together;
}

FitValues FitProblem::with_noise(FitValues values, const std::vector<FitParameter>& frees) const {
  const Linearised linear = linearised(values, frees);
  const std::vector<double> freedoms = freedoms_of(linear);
  const std::vector<double> before = values.noise;
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    std::vector<double> residuals, sizes;
    for (std::size_t i = 0; i < source_of_residual_.size(); ++i) {
      const std::size_t source = source_of_residual_[i];
      if (sources_[source].noise == sources_[s].noise) sizes.push_back(std::abs(linear.residuals[i]));
      if (source == s) residuals.push_back(linear.residuals[i]);
    }
    std::ranges::sort(sizes);
    // Beyond four deviations is no noise; but the median of few values tells no deviation.
    constexpr std::size_t kMany = 20;
    const double likely = sizes.size() < kMany ? sizes.back() : 4 * sizes[sizes.size() / 2] / 0.6745;
    double sum = 0, count = 0;
    for (const double size : sizes)
      if (size <= likely) sum += size * size, ++count;
    const double deviation = std::sqrt(sum / count * static_cast<double>(sizes.size()) / freedoms[s]);
    values.noise[s] = std::max(min_noise(sources_[s]), before[s] * deviation);
    for (double& residual : residuals) residual *= before[s] / values.noise[s];
    values.together[s] = sources_[s].quantity == "force" ? samples_together(residuals) : 1;
  }
  return values;
}

}  // namespace contactspline
