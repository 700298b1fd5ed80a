// SPDX-License-Identifier: MIT
// A string that buzzes against a fret: energy with the work of the pluck and of the moving fret.
#include "contactspline/models/fret_string.hpp"

#include <complex>
#include <numbers>
#include <random>

#include "plucked_string.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kPluck = 0.13;  // m
constexpr double kFret = 0.3;    // m
constexpr double kGap = 3e-4;    // m

/// The string against a stiff barrier of the reference.
const StruckString kString{"buzz", {0.5, 0.0025, 250, 1e-4, {0.4, 2e-4}}, 0, {1e9, 1.01}, kPluck};

struct Buzz : PluckedString<FretString<double>> {
  explicit Buzz(double rate)
      : PluckedString(kString, segment_table(uniform_spline({"fret", "", kString.felt, {}, {16, 1e-5}}, "fret")),
                      kPluck, kFret, kGap, rate) {}
};

// Plucks every second; the fret rises and sinks and wanders, and a hand damps the string for a while.
FretStringControls<double> gesture(double time, double stiffness_ratio) {
  const double angle = 2 * std::numbers::pi * time;
  const double since_pluck = std::fmod(time, 1.0);
  return {.place_m = kFret + 0.05 * std::sin(0.7 * angle),
          .gap_m = kGap * (1 + 0.9 * std::sin(0.3 * angle)),
          .pluck_force_n = since_pluck < 0.004 ? 1500 * since_pluck : 0.0,
          .contact = {.stiffness_ratio = stiffness_ratio}};
}

// Stored + dissipated - work of pluck and fret over 10 s of buzzing, at the reference's stiffness, which is 1e9 N/m^a
// already, and a thousand times above it.
TEST(FretString, BalancesItsEnergyAtAnyStiffness) {
  for (const auto& [rate, ratio] : {std::pair{22050, 1.0}, {44100, 1.0}, {192000, 1.0}, {44100, 1000.0}}) {
    Buzz buzz(rate);
    const FretString<double>& model = buzz.model;
    const auto at_pluck = buzz.shapes_at(kPluck);
    double work = 0, lost = 0, worst = 0, peak = 0;
    int contacts = 0;
    for (int n = 0; n < 10 * rate; ++n) {
      const auto controls = gesture(static_cast<double>(n) / rate, ratio);
      const double pluck = buzz.displacement(at_pluck);
      const bool was_apart = model.force() == 0;
      buzz.model.tick(controls);
      contacts += was_apart && model.force() > 0;
      work += controls.pluck_force_n * (buzz.displacement(at_pluck) - pluck) + model.work_of_fret();
      lost += model.string().dissipated();
      const double stored = model.string().energy() +
                            ratio * potential(std::span<const Segment<double>>(buzz.table), model.compression());
      peak = std::max(peak, stored);
      worst = std::isfinite(stored) ? std::max(worst, std::abs(stored + lost - work)) : stored;
      if (!std::isfinite(stored)) break;
    }
    EXPECT_GT(contacts, 1000) << rate << " Hz";
    EXPECT_TRUE(within(worst, 0, 1e-12 * peak)) << rate << " Hz, stiffness ratio " << ratio;
  }
}

TEST(FretString, CarriesItsCompressionAlong) {
  Buzz buzz(44100);
  for (int n = 0; n < 441000; ++n) buzz.model.tick(gesture(n / 44100.0, 1));
  const auto last = gesture(440999 / 44100.0, 1);
  EXPECT_TRUE(within(buzz.model.compression(), buzz.displacement_at(last.place_m) - last.gap_m, 1e-13));
}

// Far from the string, the fret changes nothing: the string sounds as one that was never near a fret.
TEST(FretString, LeavesAStringOutOfReachAlone) {
  Buzz buzz(44100);
  ModalBank<double> alone(bare(buzz.modes), 44100);
  ModeShapes<double> pluck(buzz.shapes.size());
  buzz.shapes.at(kPluck, pluck);
  buzz.model.place(kFret, 0.1);
  std::vector<double> found, expected;
  for (int n = 0; n < 4410; ++n) {
    const double force = n < 100 ? 5 : 0;
    buzz.model.tick({.place_m = kFret, .gap_m = 0.1, .pluck_force_n = force});
    alone.predict();
    alone.push(pluck, force);
    alone.commit();
    found.push_back(buzz.model.string().displacement(pluck));
    expected.push_back(alone.displacement(pluck));
  }
  EXPECT_EQ(found, expected);
}

// Lifted by the fret and left alone, the string rests on it: the fret's force bends it to just that place.
TEST(FretString, RestsOnAFretThatLiftsIt) {
  Buzz buzz(44100);
  for (int n = 0; n < 6 * 44100; ++n) {
    const double gap = std::max(-1e-3, kGap - 1e-7 * n);
    buzz.model.tick({.place_m = kFret, .gap_m = gap, .damping_per_s = 40});
  }
  // The string's static compliance: each mode has the stiffness m |p|^2, p = -s + j w.
  double compliance = 0;
  ModeShapes<double> at(buzz.shapes.size());
  buzz.shapes.at(kFret, at);
  for (std::size_t i = 0; i < buzz.modes.size(); ++i) {
    const Mode& mode = buzz.modes[i].mode;
    const std::complex pole(-mode.decay_per_s, mode.angular_frequency_rad_per_s);
    compliance += at[i] * at[i] / (mode.mass_kg * std::norm(pole));
  }
  EXPECT_TRUE(within(buzz.model.force() * compliance, -buzz.displacement_at(kFret), 1e-6 * 1e-3));
  EXPECT_GT(buzz.model.force(), 0.5);
}

// A leap of the place becomes a fast slide: no sample moves more than an eighth of the shortest wave, nor more than a
// tenth of the distance that the slowest wave travels, that of the first mode.
TEST(FretString, FollowsALeapInSmallSteps) {
  const auto modes = audible_modes(kString);
  const StringShapes<double> shapes(wavenumbers_of(modes));
  MovingPlace<double> place(shapes, 0.1, shapes.longest_step(bare(modes), 96000));
  const double eighth = 0.5 / static_cast<double>(modes.size()) / 4;
  const double wave_speed = modes.front().mode.angular_frequency_rad_per_s * 0.5 / std::numbers::pi;
  const double max = std::min(eighth, wave_speed / 96000 / 10);
  int moves = 0;
  for (double before = 0.1; place.move_to(0.4); before = place.place(), ++moves)
    ASSERT_LE(std::abs(place.place() - before), max * (1 + 1e-12));
  EXPECT_EQ(place.place(), 0.4);
  EXPECT_GE(moves, 0.3 / max);
}

// A leap of the gap becomes a motion at 1 m/s, which ends just there; place() puts the fret there at once.
TEST(FretString, FollowsALeapOfTheGapAtOneMetrePerSecond) {
  Buzz buzz(44100);
  const auto gap_after = [&](int samples, double gap) {
    for (int n = 0; n < samples; ++n) buzz.model.tick({.place_m = kFret, .gap_m = gap});
    return buzz.model.gap();
  };
  EXPECT_TRUE(within(gap_after(441, -5e-2), kGap - 1e-2, 1e-12));
  EXPECT_EQ(gap_after(4410, -5e-2), -5e-2);
  EXPECT_TRUE(within(gap_after(44, 0.1), -5e-2 + 44 / 44100.0, 1e-12));
  buzz.model.place(kFret, 0.07);
  EXPECT_EQ(gap_after(1, 0.07), 0.07);
}

// The place leaps at random every 20 ms, at high rates and with few modes too: the force stays of the size that
// plucks of 6 N and the fret's own pressing give, where a place faster than the waves would pump it up without bound.
TEST(FretString, StaysBoundedWhereThePlaceLeaps) {
  for (const auto& [rate, max_modes] : {std::pair{44100, 1000}, {192000, 1000}, {192000, 10}, {44100, 10}}) {
    auto modes = audible_modes(kString);
    modes.resize(std::min(modes.size(), static_cast<std::size_t>(max_modes)));
    const auto table = segment_table(uniform_spline({"fret", "", kString.felt, {}, {16, 1e-5}}, "fret"));
    FretString<double> model(table, bare(modes), StringShapes<double>(wavenumbers_of(modes)), kPluck, rate);
    model.place(kFret, kGap);
    std::mt19937_64 random(1);
    double place = kFret, largest = 0;
    for (int n = 0; n < 5 * rate; ++n) {
      if (n % (rate / 50) == 0) place = std::uniform_real_distribution<double>(0.025, 0.475)(random);
      const double since_pluck = std::fmod(static_cast<double>(n) / rate, 1.0);
      model.tick({.place_m = place, .gap_m = kGap, .pluck_force_n = since_pluck < 0.004 ? 1500 * since_pluck : 0.0});
      ASSERT_TRUE(std::isfinite(model.force())) << rate << " Hz, " << modes.size() << " modes, sample " << n;
      largest = std::max(largest, model.force());
    }
    Measured() << rate << " Hz, " << modes.size() << " modes: " << largest << " N";
    EXPECT_LT(largest, 1000) << rate << " Hz, " << modes.size() << " modes";
  }
}

}  // namespace
}  // namespace contactspline::testing
