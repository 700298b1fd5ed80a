// SPDX-License-Identifier: MIT
// Two and three detuned strings under one hammer: energy over 10 s with restrikes while they sound.
#include "energy.hpp"
#include "generator/resonator/resonator.hpp"
#include "generator/spline/contact_spline.hpp"
#include "strings.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

struct Course {
  std::string name;
  Resonator resonator;
  double hammer_kg;
  PowerLaw felt;
};

Course three_strings_of_c4() {
  StiffString string = c4().string;
  string.detuning_cents = {0, 0.8, -0.7};
  return {"C4, three strings", {"c4", "", string, {0.0744}, {0.248}, 1000}, 0.00297, {4.5e9, 2.5}};
}

/// As data/resonators/dulcimer_g4.json, struck with a light wooden hammer.
Course dulcimer() {
  const StiffString string{0.45, 0.00056182, 155.397, 0.000402578, {0.9, 2e-4}, {0, 1.2}};
  return {"dulcimer course", {"dulcimer", "", string, {0.06}, {0.02}, 1000}, 0.005, {1e9, 2.2}};
}

class CourseOfStrings : public ::testing::TestWithParam<double> {};

// The same bound as for one string: 1e-12 of the peak. Restruck every 0.37 s, every fourth time again after 1 ms,
// when the felt is still compressed.
TEST_P(CourseOfStrings, BalancesItsEnergy) {
  const double rate = GetParam();
  for (const Course& course : {three_strings_of_c4(), dulcimer()}) {
    const auto modes = modes_of(course.resonator, 22050).modes;
    const double range = course.felt.max_compression(course.hammer_kg, 6.0);
    const auto felt = segment_table(uniform_spline({"felt", "", course.felt, {}, {32, range}}, "felt"));
    const SegmentTable<double> table(felt);
    HammerBooks<double> hammer({table, bare(modes), shapes<double>(modes, &ResonatorMode::strike_shape), rate}, table,
                               rate);
    const HammerStringControls<double> controls{.hammer_mass_kg = course.hammer_kg};
    const int period = static_cast<int>(0.37 * rate), soon = static_cast<int>(0.001 * rate);
    int contacts_broken = 0;
    for (int n = 0; n < 10 * static_cast<int>(rate); ++n) {
      const bool again = n % (4 * period) == soon;
      contacts_broken += again && hammer.model().force() > 0;
      if (n % period == 0 || again) hammer.strike(1 + n % 7, 1e-4, controls);
      hammer.tick(controls);
    }
    EXPECT_GT(contacts_broken, 0) << course.name;
    EXPECT_GT(hammer.books().peak, 0.001) << course.name;
    EXPECT_TRUE(within(hammer.books().worst, 0, 1e-12 * hammer.books().peak)) << course.name;
    RecordProperty(course.name, std::to_string(1e15 * hammer.books().worst / hammer.books().peak));
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, CourseOfStrings, ::testing::Values(22050.0, 44100.0, 96000.0, 192000.0));

// Strings in tune under one hammer are one string n times as heavy under n times the tension: each takes its part.
TEST(CourseOfStringsInTune, MovesAsOneHeavierString) {
  Course course = three_strings_of_c4();
  StiffString& string = std::get<StiffString>(course.resonator.body);
  string.detuning_cents = {0, 0, 0};
  Resonator heavier = course.resonator;
  heavier.body = StiffString{
      0.62, 3 * string.mass_kg, 3 * string.tension_n, 3 * string.bending_stiffness_n_m2, string.losses, {0}};
  const auto felt = felt_table(c4(), 32);
  std::vector<std::vector<double>> forces;
  for (const Resonator& resonator : {course.resonator, heavier}) {
    const auto modes = modes_of(resonator, 22050).modes;
    HammerString<double> model(felt, bare(modes), shapes<double>(modes, &ResonatorMode::strike_shape), 44100);
    model.strike(2.5, 1e-4);
    forces.emplace_back();
    for (int n = 0; n < 400; ++n) {
      model.tick({.hammer_mass_kg = course.hammer_kg});
      forces.back().push_back(model.force());
    }
  }
  EXPECT_TRUE(sequences_within<double>(forces[0], forces[1], 1e-11));
}

}  // namespace
}  // namespace contactspline::testing
