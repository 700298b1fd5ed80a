// SPDX-License-Identifier: MIT
// A live exponent: every blend of the family is convex, continuous and near its power law; a sweep in the midst of a
// contact accounts for its energy; Faust blends as C++ does.
#include "contactspline/step/live_exponent.hpp"

#include <random>

#include "contactspline/materials/felt_live.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "cpp_program.hpp"
#include "generator/contact/contact_law.hpp"
#include "generator/spline/piecewise_linear_force.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

#define FAUSTFLOAT double
#include "live_exponent_double.hpp"

namespace contactspline::testing {
namespace {

using Felt = materials::felt_live;
using Live = LiveExponent<Felt, double>;

constexpr double kMass = 0.00297;  // kg, of the material's impact
constexpr double kMin = 1.2, kMax = 3.2;

// Left and right of every knot energy and force agree to the rounding of their own sums, and the force never falls.
TEST(LiveExponent, BlendsAreConvexAndContinuous) {
  Live live(kMin);
  for (int i = 0; i <= 1000; ++i) {
    live.set(kMin + (kMax - kMin) * i / 1000);
    const auto table = live.table();
    EXPECT_EQ(table[0].half_curvature, 0);
    EXPECT_EQ(table[1].knot, 0);
    EXPECT_EQ(table[1].energy, 0);
    EXPECT_EQ(table[1].force, 0);
    for (std::size_t j = 1; j < Live::size; ++j) {
      EXPECT_GT(table[j].half_curvature, 0) << j;
      if (j + 1 == Live::size) continue;
      EXPECT_TRUE(relatively_within(table[j].energy_at(table[j + 1].knot), table[j + 1].energy, 1e-13)) << j;
      EXPECT_TRUE(relatively_within(table[j].force_at(table[j + 1].knot), table[j + 1].force, 1e-13)) << j;
    }
  }
}

// Contact duration of the material's impacts, 0.12 to 6 m/s, against the closed form of the power law with the
// material's force at its largest compression, at the family's exponents and between them. At 3.2 the fastest impact
// goes 4 % deeper than the material's own; the family reaches as far.
TEST(LiveExponent, ContactsLastAsThePowerLawsDo) {
  const double range = Felt::max_compression_m;
  const double largest = PowerLaw{Felt::stiffness_n_per_m_alpha, Felt::exponent}.force(range);
  double worst = 0, deepest = 0;
  for (int i = 0; i <= 80; ++i) {
    const double exponent = kMin + (kMax - kMin) * i / 80;
    const PowerLaw law{largest / std::pow(range, exponent), exponent};
    deepest = std::max(deepest, law.max_compression(kMass, 6));
    const Live live(exponent);
    PiecewiseLinearForce line;
    for (const auto& segment : live.table().subspan(1)) {
      line.y.push_back(segment.knot);
      line.f.push_back(segment.force);
    }
    line.y.push_back(Felt::live::max_compression_m);
    line.f.push_back(live.table().back().force_at(Felt::live::max_compression_m));
    for (int n = 0; n <= 400; ++n) {
      const double speed = 6 * std::pow(50.0, -n / 400.0);
      // A mass m on F lasts as a unit mass on F/m.
      PiecewiseLinearForce unit = line;
      for (double& f : unit.f) f /= kMass;
      const double duration = 2 * half_duration(unit, speed * speed / 2);
      worst = std::max(worst, std::abs(duration / law.contact_duration(kMass, speed) - 1));
    }
  }
  RecordProperty("worst_percent", std::to_string(100 * worst));
  Measured() << "worst error of the contact duration " << 100 * worst << " %";
  EXPECT_TRUE(within(worst, 0, 0.01));
  EXPECT_TRUE(relatively_within(Felt::live::max_compression_m, deepest, 1e-12));
  EXPECT_GT(deepest, 1.04 * range);
}

// A mass with gravity bounces while the exponent sweeps to and fro, through whole contacts and within them. Energy
// changes by the work of the sweep, V'(y) - V(y), and by nothing else.
TEST(LiveExponent, SweepsWithinAContactAccountForTheirWork) {
  for (const double rate : {22050.0, 44100.0, 192000.0}) {
    Live live(kMin);
    MassBarrier<double, Live::size> mass(live.table(), rate);
    mass.throw_from(-1e-4, 3);
    const MassBarrierControls<double> controls{.mass_kg = kMass, .gravity_m_per_s2 = 9.81};
    const auto mechanical = [&] {
      return kMass * mass.velocity() * mass.velocity() / 2 - kMass * 9.81 * mass.displacement();
    };
    const double begin = mechanical();
    double work = 0, worst = 0, peak = begin;
    int touching = 0;
    for (int n = 0; n < 2 * static_cast<int>(rate); ++n) {
      const double before = potential(live.table(), mass.displacement());
      // A sweep takes 0.4 ms, less than a contact.
      const double phase = std::fmod(n / rate, 0.0004) / 0.0004;
      live.set(kMin + (kMax - kMin) * (phase < 0.5 ? 2 * phase : 2 - 2 * phase));
      work += potential(live.table(), mass.displacement()) - before;
      mass.tick(controls);
      touching += mass.force() > 0;
      ASSERT_TRUE(std::isfinite(mass.force()) && mass.force() >= 0) << n;
      const double energy = mechanical() + potential(live.table(), mass.displacement());
      peak = std::max({peak, energy, std::abs(work)});
      worst = std::max(worst, std::abs(energy - work - begin));
    }
    EXPECT_GT(touching, 10) << rate;
    EXPECT_GT(std::abs(work), 1e-6) << rate;
    EXPECT_TRUE(within(worst, 0, 1e-12 * peak)) << rate << " Hz";
  }
}

TEST(LiveExponent, KeepsToItsRange) {
  const Live below(0.3), min(kMin), above(9), max(kMax);
  for (std::size_t j = 0; j < Live::size; ++j) {
    EXPECT_EQ(below.table()[j].force, min.table()[j].force);
    EXPECT_EQ(above.table()[j].force, max.table()[j].force);
  }
}

// Random steps at random exponents. The blends are rounded in another order, by some 1e-16 of each number.
TEST(LiveExponent, IsTheSameInFaust) {
  std::mt19937_64 random(20260202);
  const auto uniform = [&](double min, double max) {
    return std::uniform_real_distribution<double>(min, max)(random);
  };
  std::vector<std::vector<double>> inputs(3);
  std::vector<double> force, energy;
  Live live(kMin);
  for (int n = 0; n < 20000; ++n) {
    const double exponent = uniform(1.1, 3.3);
    const double y0 = Felt::max_compression_m * uniform(-0.2, 1.2), xf = Felt::max_compression_m * uniform(-0.3, 0.3);
    for (const auto& [input, value] : {std::pair(0, exponent), {1, y0}, {2, xf}})
      inputs[static_cast<std::size_t>(input)].push_back(value);
    live.set(exponent);
    force.push_back(contact_force(live.table(), Approach<double>{y0, xf, 1e-7}));
    energy.push_back(potential(live.table(), y0));
  }
  CppProgram<live_exponent_double, double> program(44100);
  const auto outputs = program.run(inputs, force.size());
  EXPECT_TRUE(sequences_within<double>(outputs[0], force, 1e-12));
  EXPECT_TRUE(sequences_within<double>(outputs[1], energy, 1e-13));
}

}  // namespace
}  // namespace contactspline::testing
