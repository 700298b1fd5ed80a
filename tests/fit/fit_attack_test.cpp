// SPDX-License-Identifier: MIT
// Fits of random tables and sets of pulses, class by class: how often the interval of the exponent holds the true
// one, and how often the fit refuses. scripts/fits draws many of each.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/math/distributions/binomial.hpp>
#include <cstdlib>
#include <map>
#include <string>

#include "fit/measured_impacts.hpp"
#include "generator/fit/fit.hpp"
#include "generator/fit/measurements_reader.hpp"
#include "generator/support/error.hpp"

namespace contactspline::testing {
namespace {

const char* const kMany = std::getenv("CONTACTSPLINE_FIT_CASES");
const char* const kFirst = std::getenv("CONTACTSPLINE_FIT_FIRST");

int cases(int few) {
  return kMany != nullptr ? std::atoi(kMany) : few;
}

// Of the cases: those of another number than were looked at when the fit was made are the better judges.
int first_case() {
  return kFirst != nullptr ? std::atoi(kFirst) : 0;
}

// Of the cases that do not hold.
bool tells() {
  return kMany != nullptr;
}

/// What became of the fits of a class.
struct Outcomes {
  int refused = 0, held = 0, missed = 0;

  void print(const std::string& name) const {
    fmt::print("{:<44} {:>5} cases {:>5} refused {:>5} of {:>5} intervals hold, {:.1f} %\n", name,
               refused + held + missed, refused, held, held + missed, 100.0 * held / std::max(1, held + missed));
    std::fflush(stdout);
  }
};

/// Data files by name, and the fit file that names them.
struct FitFiles {
  std::string fit;
  std::map<std::string, std::string> data;
};

void add(Outcomes& outcomes, const FitFiles& files, double exponent, std::uint64_t seed) {
  try {
    const Measurements measured =
        parse_measurements(files.fit, "probe.json", [&](const std::string& name) { return files.data.at(name); });
    const Fit fit = fit_material(measured, "probe.json", [](const std::string& /*what*/) {});
    const bool holds = fit.exponent.low <= exponent && exponent <= fit.exponent.high;
    ++(holds ? outcomes.held : outcomes.missed);
    if (!holds && tells())
      fmt::print("  seed {}: exponent {:.4f}, {} {}{} says {:.4f} to {:.4f}\n", seed, exponent, fit.law, fit.loss,
                 fit.low_pass_hz ? " behind a low-pass" : "", fit.exponent.low, fit.exponent.high);
  } catch (const BadInput& refused) {
    ++outcomes.refused;
    if (tells()) fmt::print("  seed {}: {}\n", seed, refused.what());
  }
}

// Intervals that hold 95 of 100 miss as often as this once in 10,000 times.
void expect_held(const Outcomes& outcomes, const std::string& name) {
  const boost::math::binomial misses(outcomes.held + outcomes.missed, 0.05);
  if (outcomes.missed > 0) {
    EXPECT_GT(cdf(complement(misses, outcomes.missed - 1)), 1e-4) << name;
  }
}

/// Durations of 2 % at speeds from 0.3 to 5 m/s, as a table.
FitFiles table_of(int rows, const TrueMaterial& truth, Random& random) {
  std::string text = "speed_m_per_s,duration_s\n";
  for (int i = 0; i < rows; ++i) {
    const double speed = 0.3 * std::pow(5 / 0.3, i / (rows - 1.0));
    text +=
        fmt::format("{},{}\n", speed, truth.law.contact_duration(truth.mass_kg, speed) * (1 + 0.02 * normal(random)));
  }
  return {fmt::format(R"({{"name":"probe","mass_kg":{},"tables":[{{"file":"rows.csv"}}]}})", truth.mass_kg),
          {{"rows.csv", text}}};
}

TEST(FitAttack, IntervalsOfTablesHold) {
  for (int rows = 3; rows <= 12; ++rows) {
    Outcomes outcomes;
    for (int i = 0; i < cases(8); ++i) {
      const auto seed = static_cast<std::uint64_t>(1000 * rows + i);
      Random random(seed);
      const TrueMaterial truth =
          lasting(random.log_between(1e-3, 6e-3), random.between(1.5, 3.5), 0, random.log_between(2e-3, 2e-1));
      add(outcomes, table_of(rows, truth, random), truth.law.exponent, seed);
    }
    const std::string name = fmt::format("tables of {} rows", rows);
    outcomes.print(name);
    expect_held(outcomes, name);
  }
}

/// What the pulses of a class have.
struct PulseClass {
  const char* name;
  bool has_core = false, has_loss = false, has_memory = false;
  double offset = 0, drift = 0, hum = 0;  ///< in parts of the largest force
  double low_pass_hz = 0;
  bool states_low_pass = false;
};

constexpr PulseClass kClasses[] = {
    {"pulses without loss"},
    {"with Hunt-Crossley loss", false, true},
    {"with memory", false, false, true},
    {"with a core", true},
    {"with a core and Hunt-Crossley loss", true, true},
    {"with a core and memory", true, false, true},
    {"with loss and an offset", false, true, false, 0.05},
    {"with loss and a drift", false, true, false, 0, 0.1},
    {"with loss and a hum", false, true, false, 0, 0, 0.05},
    {"with memory, offset, drift and hum", false, false, true, 0.05, 0.05, 0.02},
    {"with loss behind a stated 5 kHz low-pass", false, true, false, 0, 0, 0, 5000, true},
    {"with loss behind an unstated 5 kHz low-pass", false, true, false, 0, 0, 0, 5000},
    {"with a core behind a stated 5 kHz low-pass", true, false, false, 0, 0, 0, 5000, true}};

struct Drawn {
  ViscoelasticLaw<double> law;
  double mass_kg, duration_s;
};

constexpr double kSlowest = 0.4, kFastest = 4;

Drawn drawn_law(const PulseClass& kind, Random& random) {
  const double duration = random.log_between(1.5e-3, 8e-3);
  const TrueMaterial felt = lasting(duration, random.between(1.6, 3.2), 0, random.log_between(2e-3, 2e-2));
  const double reach = felt.law.max_compression(felt.mass_kg, kFastest), reference = reach / 2;
  ViscoelasticLaw<double> law{std::log(felt.law.force(reference)), felt.law.exponent, 0, 0, 1, reference};
  if (kind.has_core) {
    law.depth = 2 * random.between(0.4, 0.75);
    law.core = random.log_between(1, 5) * std::pow(2, law.exponent) / std::pow(2 - law.depth, 1.5);
  }
  if (kind.has_loss) law.loss_s_per_m = random.between(0.03, 0.2);
  if (kind.has_memory) {
    law.weight = random.between(0.3, 0.8);
    law.time_s = duration * random.log_between(0.05, 0.3);
  }
  return {law, felt.mass_kg, duration};
}

// Of order 1, by its closed form between samples that are dense.
void pass_low_pass(std::vector<double>& forces, double step_s, double hz) {
  const double keep = std::exp(-2 * std::numbers::pi * hz * step_s);
  double y = 0;
  for (double& force : forces) force = y = keep * y + (1 - keep) * force;
}

std::string pulse_text(const PulseClass& kind, const Drawn& drawn, double speed, Random& random) {
  constexpr double kRate_hz = 48000;
  const std::size_t dense = kind.low_pass_hz > 0 ? 32 : 1;
  const double step_s = 1 / (kRate_hz * static_cast<double>(dense));
  const double begin_s = drawn.duration_s * random.between(2.9, 3.1) * std::pow(2 / speed, 0.4);
  std::vector<double> times, forces(dense * static_cast<std::size_t>(3 * begin_s * kRate_hz));
  for (std::size_t i = 0; i < forces.size(); ++i) times.push_back(static_cast<double>(i) * step_s);
  EXPECT_TRUE(pulse_force(drawn.law, drawn.mass_kg, speed, begin_s, times, std::span<double>(forces)));
  if (kind.low_pass_hz > 0) pass_low_pass(forces, step_s, kind.low_pass_hz);
  const double top = std::ranges::max(forces), phase = random.between(0, 2 * std::numbers::pi);
  std::string text = "time_s,force_n\n";
  for (std::size_t i = 0; i < forces.size(); i += dense) {
    const double disturbed = kind.offset + kind.drift * (times[i] / times.back() - 0.5) +
                             kind.hum * std::sin(2 * std::numbers::pi * 50 * times[i] + phase) +
                             0.01 * normal(random);
    text += fmt::format("{},{}\n", times[i], forces[i] + top * disturbed);
  }
  return text;
}

FitFiles pulses_in(const PulseClass& kind, const Drawn& drawn, Random& random) {
  const auto count = static_cast<int>(3 + random.below(4));
  std::string low_pass;
  if (kind.states_low_pass) low_pass = fmt::format(R"(,"low_pass_hz":{})", kind.low_pass_hz);
  FitFiles files;
  std::string pulses;
  for (int i = 0; i < count; ++i) {
    const double speed = kSlowest * std::pow(kFastest / kSlowest, i / (count - 1.0));
    const std::string name = fmt::format("pulse_{}.csv", i);
    files.data[name] = pulse_text(kind, drawn, speed, random);
    pulses += fmt::format(R"({}{{"file":"{}","speed_m_per_s":{}{}}})", i > 0 ? "," : "", name, speed, low_pass);
  }
  files.fit = fmt::format(R"({{"name":"probe","mass_kg":{},"pulses":[{}]}})", drawn.mass_kg, pulses);
  return files;
}

// Set `number` of a class.
void add_pulses(Outcomes& outcomes, std::size_t kind, int number) {
  const std::uint64_t seed = 100000 * (kind + 1) + static_cast<std::uint64_t>(number);
  Random random(seed);
  const Drawn drawn = drawn_law(kClasses[kind], random);
  add(outcomes, pulses_in(kClasses[kind], drawn, random), drawn.law.exponent, seed);
}

/// A class by its place in the table; --gtest_filter='*Attack*/11' chooses one.
class FitAttackOfPulses : public ::testing::TestWithParam<std::size_t> {};

TEST_P(FitAttackOfPulses, IntervalsHold) {
  Outcomes outcomes;
  for (int i = 0; i < cases(1); ++i) add_pulses(outcomes, GetParam(), first_case() + i);
  outcomes.print(kClasses[GetParam()].name);
  expect_held(outcomes, kClasses[GetParam()].name);
}

INSTANTIATE_TEST_SUITE_P(All, FitAttackOfPulses, ::testing::Range<std::size_t>(0, std::size(kClasses)));

// Without a core the exponent of the first two comes out far too high, and from there no core was found, or one that
// no material has; what was left fitted badly. In the next two no search found the core, because it moved before the
// begins of the pulses were right. The low-pass of the others moves the exponent, though data do not show it.
TEST(FitAttack, IntervalsHoldWhereTheyDidNot) {
  Outcomes outcomes;
  for (const auto& [kind, number] :
       {std::pair<std::size_t, int>{3, 71}, {5, 48}, {5, 1040}, {12, 1032}, {11, 201}, {11, 202}})
    add_pulses(outcomes, kind, number);
  EXPECT_EQ(outcomes.missed, 0);
  EXPECT_GE(outcomes.held, 5);
}

}  // namespace
}  // namespace contactspline::testing
