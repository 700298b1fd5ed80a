// SPDX-License-Identifier: MIT
// A slide on a string: energy with the work of the hand, detachment, placement.
#include "contactspline/models/slide_string.hpp"

#include <numbers>

#include "plucked_string.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kPluck = 0.13;   // m
constexpr double kHeight = 1e-3;  // m
constexpr double kSpring = 50;    // N/m

const StruckString kGuitar{"guitar", {0.65, 0.0036, 70, 3e-4, {0.4, 2e-4}}, 0, {1e8, 1.5}, kPluck};

/// A guitar string with a slide above it.
struct Guitar : PluckedString<SlideString<double>> {
  explicit Guitar(double rate)
      : PluckedString(kGuitar, segment_table(uniform_spline({"slide", "", kGuitar.felt, {}, {32, 2e-4}}, "slide")),
                      kPluck, 0.3, kHeight, rate) {}

  [[nodiscard]] double energy(const SlideStringControls<double>& controls) const {
    const double v = model.slide_velocity(), u = model.slide();
    return model.string().energy() + controls.slide_mass_kg * v * v / 2 + kSpring * u * u / 2 +
           potential(std::span<const Segment<double>>(table), model.compression());
  }
};

// What a hand does: presses in and out, slides with vibrato, plucks every second.
SlideStringControls<double> gesture(double time) {
  const double angle = 2 * std::numbers::pi * time;
  const double since_pluck = std::fmod(time, 1.0);
  return {.place_m = 0.3 + 0.05 * std::sin(0.7 * angle) + 0.003 * std::sin(5.5 * angle),
          .slide_mass_kg = 0.02,
          .hand_force_n = 1.5 * std::sin(0.9 * angle),
          .hand_stiffness_n_per_m = kSpring,
          .hand_resistance_n_s_per_m = 0.3,
          .rest_resistance_n_s_per_m = 0.5,
          .pluck_force_n = since_pluck < 0.004 ? 500 * since_pluck : 0.0};
}

// Stored + dissipated - work of the hand (pressing, plucking, and along the bent string) over 10 s of gliding,
// vibrato, attachment and hundreds of rattling contacts.
TEST(SlideString, BalancesItsEnergyWithTheWorkOfTheHand) {
  for (const double rate : {22050.0, 44100.0, 192000.0}) {
    Guitar guitar(rate);
    SlideString<double>& model = guitar.model;
    const double begin = guitar.energy(gesture(0));
    const auto at_pluck = guitar.shapes_at(kPluck);
    ModeShapes<double> at_rest(guitar.shapes.size());
    double work = 0, lost = 0, worst = 0, peak = 0;
    int contacts = 0;
    for (int n = 0; n < 10 * static_cast<int>(rate); ++n) {
      const auto controls = gesture(n / rate);
      guitar.shapes.at(controls.place_m / 2, at_rest);
      const double slide = model.slide(), pluck = guitar.displacement(at_pluck), rest = guitar.displacement(at_rest);
      const bool was_apart = model.force() == 0;
      model.tick(controls);
      const double moved = model.slide() - slide;
      contacts += was_apart && model.force() > 0;
      work += controls.hand_force_n * moved + controls.pluck_force_n * (guitar.displacement(at_pluck) - pluck) +
              model.work_along();
      lost += controls.hand_resistance_n_s_per_m * moved * moved * rate + model.string().dissipated() -
              model.rest_force() * (guitar.displacement(at_rest) - rest);
      const double energy = guitar.energy(controls);
      peak = std::max(peak, energy);
      worst = std::isfinite(energy) ? std::max(worst, std::abs(energy + lost - work - begin)) : energy;
      if (!std::isfinite(energy)) break;
    }
    EXPECT_GT(contacts, 50);
    EXPECT_TRUE(within(worst, 0, 1e-12 * peak)) << rate << " Hz";
  }
}

// The compression that is carried along sample by sample is still slide - string after all the gliding.
TEST(SlideString, CarriesItsCompressionAlong) {
  Guitar guitar(44100);
  for (int n = 0; n < 441000; ++n) guitar.model.tick(gesture(n / 44100.0));
  const double place = gesture(440999 / 44100.0).place_m;
  EXPECT_TRUE(within(guitar.model.compression(), guitar.model.slide() - guitar.displacement_at(place), 1e-13));
}

// In single precision the roundings of the increments would add up to 0.5 um in a minute. They are held to the
// rounding of the displacements themselves: some millimetres in 92 modes, each by 2^-24, are some 1e-8 m.
TEST(SlideString, StaysWithTheStringInSinglePrecision) {
  const auto modes = audible_modes(kGuitar);
  const auto table = segment_table(uniform_spline({"slide", "", kGuitar.felt, {}, {32, 2e-4}}, "slide"));
  std::vector<Segment<float>> single;
  for (const auto& [knot, energy, force, half_curvature] : table)
    single.push_back({static_cast<float>(knot), static_cast<float>(energy), static_cast<float>(force),
                      static_cast<float>(half_curvature)});
  const StringShapes<float> shapes(wavenumbers_of(modes));
  SlideString<float> model(single, bare(modes), shapes, static_cast<float>(kPluck), 44100);
  model.place(0.3f, 0);
  ModeShapes<float> at(shapes.size());
  for (int n = 0; n < 30 * 44100; ++n) {
    const double time = n / 44100.0;
    model.tick({.place_m = static_cast<float>(0.3 + 0.02 * std::sin(6 * time)),
                .slide_mass_kg = 0.02f,
                .hand_force_n = 2,
                .hand_stiffness_n_per_m = 50,
                .hand_resistance_n_s_per_m = 1,
                .pluck_force_n = static_cast<float>(std::fmod(time, 1.0) < 0.004 ? 500 * std::fmod(time, 1.0) : 0)});
    if (n % 441 != 0) continue;
    shapes.at(static_cast<float>(0.3 + 0.02 * std::sin(6 * time)), at);
    ASSERT_TRUE(within(model.compression(), model.slide() - model.string().displacement(at), 5e-8)) << time << " s";
  }
}

// A slide of a microgram moves 250 m/N in a sample: its increment without the contact force, and what the force takes
// from it, nearly cancel. The compression must not be their difference, which is off by 15 um (250 m/2^24): the
// energy stored would not be the work of the force. The bound is 1 % of 100 J, the work of 1 MN over 1 um.
TEST(SlideString, StoresTheWorkOfTheForceWithALightSlideInSinglePrecision) {
  const auto modes = audible_modes(kGuitar);
  const auto table =
      table_in<float>(segment_table(uniform_spline({"slide", "", kGuitar.felt, {}, {32, 2e-4}}, "slide")));
  SlideString<float> model(table, bare(modes), StringShapes<float>(wavenumbers_of(modes)), static_cast<float>(kPluck),
                           44100);
  constexpr float kRatio = 1e6f;
  model.place(0.3f, 0.1f);
  const auto stored = [&] {
    return double{kRatio} * potential(SegmentTable<float>(table), std::max(0.0f, model.compression()));
  };
  double before = stored(), compression = model.compression(), largest = 0;
  for (int n = 0; n < 100; ++n) {
    model.tick({.place_m = 0.3f, .slide_mass_kg = 1e-9f, .hand_force_n = 1000, .contact = {kRatio, 0}});
    const double after = stored(), work = model.force() * (model.compression() - compression);
    ASSERT_NEAR(after - before, work, 1e-2 * (after + before) + 1e-3) << "sample " << n;
    largest = std::max(largest, after);
    before = after, compression = model.compression();
  }
  EXPECT_GT(largest, 1);
}

// Pulled a kilometre away and back, a slide of 1 kg meets a sounding string where it is. Its place and the
// compression that is carried along are both rounded in each sample, by up to 31 um (1 km/2^15), and not alike,
// because the compression has the string's motion in it. Carried along these errors add up, over hours to metres, and
// a stiff contact was pressed by them: it gained terajoules. The bound is four roundings.
TEST(SlideString, ComesBackFromAfarInSinglePrecision) {
  const auto modes = audible_modes(kGuitar);
  const auto table =
      table_in<float>(segment_table(uniform_spline({"slide", "", kGuitar.felt, {}, {32, 2e-4}}, "slide")));
  const StringShapes<float> shapes(wavenumbers_of(modes));
  SlideString<float> model(table, bare(modes), shapes, static_cast<float>(kPluck), 44100);
  model.place(0.3f, 1e-3f);
  ModeShapes<float> at(shapes.size());
  shapes.at(0.3f, at);
  double farthest = 0;
  for (int n = 0; n < 6 * 44100 && model.force() == 0; ++n) {
    model.tick({.place_m = 0.3f,
                .slide_mass_kg = 1,
                .hand_force_n = n < 44100 ? -1000.0f : 1000.0f,
                .pluck_force_n = n % 400 < 200 ? 10.0f : 0.0f});
    farthest = std::max(farthest, -static_cast<double>(model.slide()));
    ASSERT_TRUE(within(model.compression(), model.slide() - model.string().displacement(at), 4 * 31e-6))
        << "sample " << n;
  }
  EXPECT_GT(farthest, 900);
  EXPECT_GT(model.force(), 0);
}

// Pressed and left alone, slide and string come to rest where the string's pull and the spring hold the hand's force.
TEST(SlideString, SettlesWhereTheForcesBalance) {
  Guitar guitar(44100);
  const SlideStringControls<double> controls{.place_m = 0.3,
                                             .slide_mass_kg = 0.02,
                                             .hand_force_n = 2,
                                             .hand_stiffness_n_per_m = kSpring,
                                             .hand_resistance_n_s_per_m = 5,
                                             .rest_resistance_n_s_per_m = 2};
  for (int n = 0; n < 20 * 44100; ++n) guitar.model.tick(controls);
  EXPECT_TRUE(within(guitar.model.force() + kSpring * guitar.model.slide(), 2, 1e-6));
  EXPECT_TRUE(within(force(std::span<const Segment<double>>(guitar.table), guitar.model.compression()),
                     guitar.model.force(), 1e-6));
}

// Put down elsewhere, a slide that has stood still plays as a new one does.
TEST(SlideString, CanBePlacedAgain) {
  const SlideStringControls<double> there{.place_m = 0.4, .slide_mass_kg = 0.02, .hand_force_n = 1};
  Guitar moved(44100), fresh(44100);
  SlideStringControls<double> here = there;
  here.place_m = 0.3;
  here.hand_force_n = 0;
  for (int n = 0; n < 10; ++n) moved.model.tick(here);
  std::vector<double> found, expected;
  moved.model.place(0.4, 0);
  fresh.model.place(0.4, 0);
  for (int n = 0; n < 2000; ++n) {
    moved.model.tick(there);
    fresh.model.tick(there);
    found.push_back(moved.model.compression());
    expected.push_back(fresh.model.compression());
  }
  EXPECT_TRUE(sequences_within<double>(found, expected, 1e-12));
}

TEST(SlideString, LiftedOffLeavesTheStringAlone) {
  Guitar guitar(44100);
  SlideStringControls<double> controls{.place_m = 0.3, .slide_mass_kg = 0.02, .hand_force_n = -0.5};
  for (int n = 0; n < 100; ++n) {
    guitar.model.tick(controls);
    EXPECT_EQ(guitar.model.force(), 0);
    controls.place_m += 1e-4;
  }
  EXPECT_EQ(guitar.model.string().energy(), 0);
}

}  // namespace
}  // namespace contactspline::testing
