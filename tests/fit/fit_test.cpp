// SPDX-License-Identifier: MIT
// Fits to pulses and tables of random materials: errors, intervals, the choice of a law. Draws a hundred materials if
// CONTACTSPLINE_FULL_TESTS is set.
#include "generator/fit/fit.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "fit/least_deviation.hpp"
#include "fit/measured_impacts.hpp"
#include "generator/fit/fitted_material.hpp"
#include "generator/material/material_reader.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

const auto kSilent = [](const std::string& /*what*/) {};

Fit fit_of(const Measurements& measured) {
  return fit_material(measured, "probe.json", kSilent);
}

int materials(int few) {
  return std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr ? 100 : few;
}

bool holds(const Estimate& estimate, double value) {
  return estimate.low <= value && value <= estimate.high;
}

// An error of twice the half interval, four deviations, comes once in 16,000 times.
void expect_near(const Estimate& estimate, double truth) {
  EXPECT_LT(std::abs(estimate.value - truth), estimate.high - estimate.low);
}

constexpr double kSlowest = 0.2, kFastest = 6, kNoise = 0.01;

/// The force at a compression that the fastest blow passes on its way in: a memory makes it depend on the motion.
double loading_force(const ViscoelasticLaw<double>& law, double mass_kg, double y) {
  const impact_model::Impact<double> impact(law, mass_kg);
  const double step = impact.longest_step(kFastest);
  impact_model::State<double> state{0, kFastest, 0}, next = state;
  while ((next = impact.step(state, step)).y < y) state = next;
  for (int i = 0; i < 3; ++i) state = impact.step(state, (y - state.y) / state.v);
  return impact.force(state);
}

/// Errors of many fits of one quantity, beside the least standard deviations that their data allow.
struct Scores {
  double sum = 0, squares = 0;  // of errors in units of these
  std::vector<double> deviations;

  void add(double error, double deviation) {
    const double score = error / deviation;
    sum += score, squares += score * score;
    deviations.push_back(deviation);
  }
  [[nodiscard]] double mean() const { return sum / static_cast<double>(deviations.size()); }
  [[nodiscard]] double root_mean_square() const {
    return std::sqrt(squares / static_cast<double>(deviations.size()));
  }

  /// The largest error that normal errors exceed as often as not.
  [[nodiscard]] double likely_largest() const {
    double low = 0, high = 10 * std::ranges::max(deviations);
    for (int i = 0; i < 50; ++i) {
      const double middle = (low + high) / 2;
      double all_below = 1;
      for (const double deviation : deviations) all_below *= std::erf(middle / (deviation * std::numbers::sqrt2));
      (all_below < 0.5 ? low : high) = middle;
    }
    return low;
  }
};

/// The largest errors of many fits, and how often the intervals hold the true values.
struct Tally {
  std::map<std::string, Scores> scores;  ///< of each quantity, if all data are pulses
  std::set<std::string> chosen;          ///< law and loss
  double exponent = 0, force = 0, loss = 0, weight = 0, time = 0, seconds = 0;
  int fits = 0, exponents_held = 0, stiffnesses_held = 0, losses_held = 0, weights_held = 0, times_held = 0;

  void add(const Fit& fit, const TrueMaterial& truth, std::span<const Pulse> pulses) {
    ++fits;
    chosen.insert(fit.law + " " + fit.loss);
    const double half = fit.max_compression_m / 2;
    const PowerLaw found{fit.stiffness.value, fit.exponent.value};
    exponent = std::max(exponent, std::abs(found.exponent - truth.law.exponent));
    const auto log_force = [&](const TrueMaterial& material) {
      return std::log(material.weight > 0 ? loading_force(model_of(material, half), truth.mass_kg, half)
                                          : material.law.force(half));
    };
    const TrueMaterial fitted{found, fit.loss_s_per_m.value, truth.mass_kg, fit.weight.value, fit.time_s.value};
    force = std::max(force, std::abs(std::exp(log_force(fitted) - log_force(truth)) - 1));
    exponents_held += holds(fit.exponent, truth.law.exponent) ? 1 : 0;
    stiffnesses_held += holds(fit.stiffness, truth.law.stiffness) ? 1 : 0;
    if (truth.loss_s_per_m > 0) {
      loss = std::max(loss, std::abs(fit.loss_s_per_m.value / truth.loss_s_per_m - 1));
      losses_held += holds(fit.loss_s_per_m, truth.loss_s_per_m) ? 1 : 0;
    }
    if (truth.weight > 0) {
      weight = std::max(weight, std::abs(fit.weight.value / truth.weight - 1));
      time = std::max(time, std::abs(fit.time_s.value / truth.time_s - 1));
      weights_held += holds(fit.weight, truth.weight) ? 1 : 0;
      times_held += holds(fit.time_s, truth.time_s) ? 1 : 0;
    }
    if (pulses.empty()) return;
    const LeastDeviation least(truth, pulses, kNoise);
    const auto score = [&](const char* name, const auto& of) {
      scores[name].add(of(fitted) - of(truth), least.deviation_of(of));
    };
    score("force", log_force);
    score("exponent", [](const TrueMaterial& material) { return material.law.exponent; });
    if (truth.loss_s_per_m > 0)
      score("loss", [](const TrueMaterial& material) { return std::log(material.loss_s_per_m); });
    if (truth.weight == 0) return;
    score("weight", [](const TrueMaterial& material) { return std::log(material.weight); });
    score("time", [](const TrueMaterial& material) { return std::log(material.time_s); });
  }

  void print() const {
    std::printf(
        "%d fits: largest error of the exponent %.4f, of the force at half the compression %.3f %%, of the loss "
        "%.2f %%, of the memory's weight %.2f %%, of its time %.2f %%; intervals hold exponent %d, stiffness %d, "
        "loss "
        "%d, weight %d, time %d times; the longest fit took %.2f s of processor time\n",
        fits, exponent, 100 * force, 100 * loss, 100 * weight, 100 * time, exponents_held, stiffnesses_held,
        losses_held, weights_held, times_held, seconds);
    for (const auto& [name, score] : scores)
      std::printf(
          "  %s: errors in least standard deviations: mean %.2f, root mean square %.2f; likely largest %.4f\n",
          name.c_str(), score.mean(), score.root_mean_square(), score.likely_largest());
  }
};

// 90 of 100 or more intervals hold the true value, and of a dozen all but two; never do all of a hundred.
void expect_held(int held, int fits) {
  EXPECT_GE(held, fits - std::max(2, fits / 10));
  if (fits >= 100) {
    EXPECT_LE(held, 99);
  }
}

void expect_all_held(const Tally& tally) {
  expect_held(tally.exponents_held, tally.fits);
  expect_held(tally.stiffnesses_held, tally.fits);
  expect_held(tally.losses_held, tally.fits);
}

// No fit without bias can do better than the bound of Cramer and Rao. The mean of n errors in its units deviates from
// 0 by 1/sqrt(n), their root mean square from 1 by 1/sqrt(2 n): four deviations come once in 16,000 times.
void expect_best(const Tally& tally) {
  const double n = tally.fits;
  for (const auto& [name, score] : tally.scores) {
    EXPECT_TRUE(within(score.mean(), 0, 4 / std::sqrt(n))) << name;
    EXPECT_TRUE(within(score.root_mean_square(), 1, 4 / std::sqrt(2 * n))) << name;
  }
}

struct Measured {
  TrueMaterial truth;
  Measurements measurements;
};

/// Fits random materials. measure(random): a material and what is measured of it.
template <typename Measure>
Tally tally_of(std::uint64_t seed, Measure measure, int few = 12) {
  Tally tally;
  for (int i = 0; i < materials(few); ++i) {
    Random random(seed + static_cast<std::uint64_t>(i));
    const Measured measured = measure(random);
    const std::clock_t begin = std::clock();
    const Fit fit = fit_of(measured.measurements);
    tally.seconds = std::max(tally.seconds, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    tally.add(fit, measured.truth, measured.measurements.pulses);
  }
  tally.print();
  return tally;
}

// Pulses with noise of 1 % at speeds between two [m/s]; the fit chooses between no loss and Hunt and Crossley's.
Measured pulses_with_loss(const TrueMaterial& truth, int count, double slowest, double fastest, Random& random) {
  Measurements measured = measurements_of(truth);
  measured.losses = {"none", "hunt_crossley"};
  measured.pulses = pulses_of(truth, count, slowest, fastest, kNoise, random);
  return {truth, measured};
}

// Contacts of 5 to 10 ms at 2 m/s, exponents from 1.6 to 2.5. Shorter ones have fewer samples, and all errors grow
// with the root of that.
Tally tally_of_eight_pulses(double max_exponent, int few) {
  const Tally tally = tally_of(
      1,
      [&](Random& random) {
        return pulses_with_loss(lasting(random.log_between(5e-3, 10e-3), random.between(1.6, max_exponent),
                                        random.between(0.1, 0.2), random.log_between(2e-3, 2e-2)),
                                8, kSlowest, kFastest, random);
      },
      few);
  EXPECT_EQ(tally.chosen, std::set<std::string>{"power hunt_crossley"});
  EXPECT_LT(tally.loss, 0.03);
  expect_all_held(tally);
  expect_best(tally);
  return tally;
}

TEST(Fit, FindsRandomMaterialsFromEightPulses) {
  const Tally tally = tally_of_eight_pulses(2.5, 12);
  EXPECT_LT(tally.exponent, 0.01);
  EXPECT_LT(tally.force, 0.005);
}

// The noise leaves exponents of 3 a standard deviation of up to 0.004.
TEST(Fit, FindsExponentsUpTo3AsWellAsTheNoiseAllows) {
  tally_of_eight_pulses(3, 4);
}

// What the pulses of stiff hammers allow is less; the intervals say so.
TEST(Fit, SaysHowWellShortPulsesAreKnown) {
  const Tally tally = tally_of(1000, [](Random& random) {
    return pulses_with_loss(lasting(random.log_between(0.7e-3, 3e-3), random.between(1.6, 4),
                                    random.between(0.03, 0.3), random.log_between(2e-3, 2e-2)),
                            5, 0.5, 4, random);
  });
  expect_all_held(tally);
  expect_best(tally);
}

// ln T falls with ln v by (a - 1)/(a + 1). With n values of 1 % over a ratio R of speeds, its deviation is
// 0.01 sqrt(12/n)/ln R, and that of the exponent (a + 1)^2/2 times as much: 0.0027 here for an exponent of 2.5.
TEST(Fit, FindsTheExponentFromDurationsAlone) {
  const Tally tally = tally_of(2000, [](Random& random) {
    const TrueMaterial truth =
        lasting(random.log_between(1e-3, 6e-3), random.between(1.5, 2.5), 0, random.log_between(2e-3, 2e-1));
    Measurements measured = measurements_of(truth);
    measured.laws = {"power"};
    measured.losses = {"none"};
    constexpr int kRows = 300;
    for (int row = 0; row < kRows; ++row) {
      const double speed = 0.05 * std::pow(100, row / (kRows - 1.0));
      measured.rows.push_back(
          {"rows", speed, truth.law.contact_duration(truth.mass_kg, speed) * (1 + 0.01 * normal(random)), {}, {}});
    }
    return Measured{truth, measured};
  });
  EXPECT_LT(tally.exponent, 0.01);
  expect_held(tally.exponents_held, tally.fits);
}

// The three columns of a table together, without noise.
TEST(Fit, FindsLawAndLossFromATable) {
  const TrueMaterial truth = lasting(3e-3, 2.2, 0.15, 0.01);
  Measurements measured = measurements_of(truth);
  const ContactLaw contact(truth.law);
  for (const double speed : {0.5, 1.0, 1.5, 2.0, 3.0}) {
    const BarrierImpact impact = barrier_impact(law_view(contact), truth.mass_kg, speed, truth.loss_s_per_m);
    measured.rows.push_back(
        {"rows", speed, impact.contact_duration_s, impact.max_force_n, impact.exit_speed_m_per_s / speed});
  }
  const Fit fit = fit_of(measured);
  EXPECT_TRUE(within(fit.exponent.value, 2.2, 1e-4));
  EXPECT_TRUE(relatively_within(fit.loss_s_per_m.value, 0.15, 1e-3));
  EXPECT_TRUE(relatively_within(fit.max_compression_m,
                                barrier_impact(law_view(contact), truth.mass_kg, 3, 0.15).max_compression_m, 1e-4));
}

TEST(Fit, ChoosesTheSimplestLawThatDescribesTheData) {
  Random random(7);
  for (const auto& [exponent, loss, chosen] :
       {std::tuple{1.5, 0.0, "hertz none"}, {1.5, 0.1, "hertz hunt_crossley"}, {2.3, 0.0, "power none"}}) {
    const TrueMaterial truth = lasting(3e-3, exponent, loss, 0.01);
    Measurements measured = measurements_of(truth);
    measured.pulses = pulses_of(truth, 5, 0.5, 4, 0.01, random);
    const Fit fit = fit_of(measured);
    EXPECT_EQ(fit.law + " " + fit.loss, chosen);
    // Each law with each loss, but for cores that are no material.
    const auto with_core = std::ranges::count(fit.candidates, kLayers, &FittedModel::law);
    EXPECT_EQ(std::ssize(fit.candidates) - with_core, 6);
    EXPECT_EQ(fit.candidates.front().criterion, 0);
  }
}

// Stulov's felt: weights from 0.4 to 0.8, relaxation times from 0.05 to 0.3 of the contact at 2 m/s.
TEST(Fit, FindsTheMemoryOfAFelt) {
  const Tally tally = tally_of(
      3000,
      [](Random& random) {
        const double duration = random.log_between(5e-3, 10e-3), weight = random.between(0.4, 0.8);
        TrueMaterial felt = lasting(duration, random.between(1.6, 3), 0, random.log_between(2e-3, 2e-2));
        felt.weight = weight;
        felt.time_s = duration * random.log_between(0.05, 0.3);
        Measurements measured = measurements_of(felt);
        measured.pulses = pulses_of(felt, 8, kSlowest, kFastest, kNoise, random);
        return Measured{felt, measured};
      },
      3);
  EXPECT_EQ(tally.chosen, std::set<std::string>{"power memory"});
  EXPECT_LT(tally.exponent, 0.01);
  EXPECT_LT(tally.weight, 0.02);
  EXPECT_LT(tally.time, 0.05);
  expect_held(tally.exponents_held, tally.fits);
  expect_held(tally.weights_held, tally.fits);
  expect_held(tally.times_held, tally.fits);
  expect_best(tally);
}

// A slow press, and both branches of an impact: F (1 + loss v) at the speed of each sample.
TEST(Fit, FindsLawAndLossFromCurves) {
  Random random(10);
  const TrueMaterial truth = lasting(3e-3, 2.2, 0.15, 0.01);
  const double reach = truth.law.max_compression(truth.mass_kg, 2);
  MeasuredForce slow{"slow", {}, {}}, impact{"impact", {}, 2.0};
  for (int i = 1; i <= 100; ++i) {
    const double y = reach * i / 100, noise = 0.01 * truth.law.force(reach), speed = 2 * std::sqrt(1 - i / 100.0);
    slow.samples.push_back({y, truth.law.force(y) + noise * normal(random)});
    for (const double sign : {1.0, -0.8})
      impact.samples.push_back(
          {y, truth.law.force(y) * (1 + 0.15 * sign * speed) + noise * normal(random), sign * speed});
  }
  Measurements measured = measurements_of(truth);
  measured.curves = {slow};
  const Fit pressed = fit_of(measured);
  EXPECT_EQ(pressed.loss, "none");
  EXPECT_TRUE(holds(pressed.exponent, 2.2) && within(pressed.exponent.value, 2.2, 0.05)) << pressed.exponent.value;
  EXPECT_TRUE(relatively_within(pressed.max_speed_m_per_s, 2, 0.01));
  measured.curves = {slow, impact};
  const Fit both = fit_of(measured);
  EXPECT_EQ(both.loss, "hunt_crossley");
  EXPECT_TRUE(holds(both.loss_s_per_m, 0.15) && within(both.loss_s_per_m.value, 0.15, 0.01));
}

// A felt that bottoms out on wood at two thirds of the reach. From a slow press and from pulses of the model itself.
TEST(Fit, FindsTheCoreUnderAFelt) {
  Random random(11);
  const TrueMaterial felt = lasting(3e-3, 2.4, 0, 0.01);
  const double reach = felt.law.max_compression(felt.mass_kg, 3), depth = 0.65 * reach;
  const PowerLaw core{3 * felt.law.force(reach) / std::pow(reach - depth, 1.5), 1.5};
  const ContactLaw truth(PowerSum{{{felt.law, 0}, {core, depth}}});
  const auto expect_found = [&](const Fit& fit, const char* loss) {
    EXPECT_EQ(fit.law + " " + fit.loss, std::string("layers ") + loss);
    expect_near(fit.exponent, 2.4);
    expect_near(fit.core_stiffness, core.stiffness);
    expect_near(fit.offset_m, depth);
    EXPECT_TRUE(relatively_within(fit.offset_m.value, depth, 0.02));
    EXPECT_TRUE(relatively_within(fit.core_stiffness.value, core.stiffness, 0.1));
    const Material material = parse_material(material_text(fit, measurements_of(felt), "probe"), "probe.json");
    for (const double y : {0.3 * reach, 0.6 * reach, 0.9 * reach})
      EXPECT_TRUE(within(material.contact.force(y), truth.force(y), 0.01 * truth.force(reach))) << y / reach;
  };
  MeasuredForce slow{"slow", {}, {}};
  for (int i = 1; i <= 200; ++i) {
    const double y = reach * i / 200;
    slow.samples.push_back({y, truth.force(y) + 0.005 * truth.force(reach) * normal(random)});
  }
  Measurements measured = measurements_of(felt);
  measured.curves = {slow};
  expect_found(fit_of(measured), "none");

  const double reference = reach / 2, ratio = core.force(reference) / felt.law.force(reference);
  const ViscoelasticLaw<double> law{
      std::log(felt.law.force(reference)), 2.4, 0.1, 0, 1, reference, ratio, depth / reference};
  measured = measurements_of(felt);
  measured.losses = {"none", "hunt_crossley"};
  for (int k = 0; k < 6; ++k) {
    Pulse pulse{"pulse", {}, {}, 0.3 * std::pow(20, k / 5.0)};
    for (int s = 0; s < 2000; ++s) pulse.time_s.push_back(s / 96000.0);
    pulse.force_n.resize(pulse.time_s.size());
    ASSERT_TRUE(pulse_force(law, felt.mass_kg, *pulse.speed_m_per_s, random.between(0.006, 0.0061), pulse.time_s,
                            std::span<double>(pulse.force_n)));
    const double deviation = 0.01 * std::ranges::max(pulse.force_n);
    for (double& force : pulse.force_n) force += deviation * normal(random);
    measured.pulses.push_back(contact_window(pulse, std::vector<std::size_t>(pulse.time_s.size()), felt.mass_kg));
  }
  expect_found(fit_of(measured), "hunt_crossley");
}

// The impulse tells the speed if nobody measured it.
TEST(Fit, FindsUnknownSpeeds) {
  Random random(8);
  const TrueMaterial truth = lasting(4e-3, 2.4, 0.1, 0.01);
  Measurements measured = measurements_of(truth);
  measured.pulses = pulses_of(truth, 8, 0.3, 5, 0.01, random);
  for (Pulse& pulse : measured.pulses) pulse.speed_m_per_s.reset();
  const Fit fit = fit_of(measured);
  EXPECT_TRUE(holds(fit.exponent, 2.4)) << fit.exponent.low << " to " << fit.exponent.high;
  EXPECT_LT(fit.exponent.high - fit.exponent.low, 0.1);
  EXPECT_TRUE(relatively_within(fit.min_speed_m_per_s, 0.3, 0.03));
}

// On the way out one sample of fifteen is half the largest force too high. Least squares without a robust norm take
// that for a loss that is too small.
TEST(Fit, IsLittleMovedByOutliers) {
  Random random(9);
  const TrueMaterial truth = lasting(4e-3, 2.4, 0.1, 0.01);
  Measurements measured = measurements_of(truth);
  measured.losses = {"hunt_crossley"};
  measured.pulses = pulses_of(truth, 6, 0.3, 5, 0.01, random);
  for (Pulse& pulse : measured.pulses) {
    const PulseMeasures measures = measures_of(pulse);
    for (std::size_t i = 0; i < pulse.time_s.size(); ++i)
      if (pulse.time_s[i] > (measures.begin_s + measures.end_s) / 2 && pulse.time_s[i] < measures.end_s &&
          random.once_in(15))
        pulse.force_n[i] += 0.5 * measures.max_force_n;
  }
  const Fit fit = fit_of(measured);
  EXPECT_TRUE(within(fit.exponent.value, 2.4, 0.03));
  EXPECT_TRUE(relatively_within(fit.loss_s_per_m.value, 0.1, 0.1));
}

}  // namespace
}  // namespace contactspline::testing
