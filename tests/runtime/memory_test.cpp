// SPDX-License-Identifier: MIT
// Contacts with memory: their energy never rises, in any model, and they converge to the continuous equations.
#include "contactspline/step/memory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/mass_barrier.hpp"
#include "contactspline/models/slide_string.hpp"
#include "contactspline/network/contact_network.hpp"
#include "power_table.hpp"
#include "random_network.hpp"
#include "strings.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/random.hpp"

namespace contactspline::testing {
namespace {

/// A material with what meets it.
struct Blow {
  explicit Blow(Random& random)
      : rate(random.log_between(8000, 768000)),
        mass(random.log_between(1e-4, 0.1)),
        speed(random.log_between(0.05, 20)),
        exponent(random.between(1.1, 5)),
        compression(random.log_between(1e-5, 3e-3)),
        memories(random_memories(random)),
        loss(random.once_in(3) ? random.between(0, 0.5) : 0.0) {
    const double stiffness = mass * speed * speed * (exponent + 1) / 2 / std::pow(compression, exponent + 1);
    table = power_table(stiffness, exponent, 2 * compression, 1 + static_cast<int>(random.below(60)));
  }
  [[nodiscard]] double energy() const { return mass * speed * speed / 2; }

  double rate, mass, speed, exponent, compression;
  std::vector<Memory> memories;
  double loss;
  Table table;
};

/// The largest rise of an energy in one sample, and above what it ever was.
class Rise {
 public:
  void add(double energy) {
    sample_ = is_finite(energy) ? std::max(sample_, energy - last_) : std::numeric_limits<double>::infinity();
    total_ = std::max(total_, energy - least_);
    last_ = energy;
    least_ = std::min(least_, energy);
  }
  [[nodiscard]] double in_a_sample() const { return sample_; }
  [[nodiscard]] double total() const { return total_; }

 private:
  double last_ = std::numeric_limits<double>::max(), least_ = last_, sample_ = 0, total_ = 0;
};

constexpr int kMaterials = 1000;
// Of the blow's energy: a dozen roundings of its terms in a sample, which add up over the samples of a run.
constexpr double kRounding = 1e-14, kSumOfRoundings = 1e-13;

TEST(Memory, EnergyOfAMassOnABarrierNeverRises) {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < kMaterials; ++i) {
    const Blow blow(random);
    MassBarrier<double> barrier(SegmentTable<double>(blow.table), blow.rate, blow.memories);
    const MassBarrierControls<double> controls{blow.mass, 0, {1, blow.loss}};
    const double start = -random.uniform() * blow.speed / blow.rate;
    barrier.throw_from(start, blow.speed);
    Rise rise;
    for (int n = 0; n < 2000; ++n) {
      barrier.tick(controls);
      EXPECT_GE(barrier.force(), 0);
      rise.add(blow.mass * barrier.velocity() * barrier.velocity() / 2 + barrier.contact_energy());
    }
    EXPECT_LE(rise.total(), kRounding * blow.energy()) << "material " << i;
    EXPECT_GE(barrier.contact_energy(), -kRounding * blow.energy()) << "material " << i;
    worst = std::max(worst, rise.total() / blow.energy());
  }
  Measured() << "largest rise of the energy, over the blow's: " << worst;
}

// Lies on the felt in the end: many blows, each softer, and the memory of all of them.
TEST(Memory, EnergyOfABouncingMassNeverRises) {
  Random random(2);
  double worst = 0, total = 0;
  for (int i = 0; i < kMaterials; ++i) {
    const Blow blow(random);
    MassBarrier<double> barrier(SegmentTable<double>(blow.table), blow.rate, blow.memories);
    const double gravity = std::min(1000.0, 200 * blow.speed);
    const MassBarrierControls<double> controls{blow.mass, gravity, {1, blow.loss}};
    barrier.throw_from(0, blow.speed);
    Rise rise;
    double scale = blow.energy();  // of the largest term of the energy
    for (int n = 0; n < 4000; ++n) {
      barrier.tick(controls);
      const double v = barrier.velocity();
      scale = std::max({scale, blow.mass * v * v / 2, blow.mass * gravity * std::abs(barrier.displacement())});
      rise.add(blow.mass * (v * v / 2 - gravity * barrier.displacement()) + barrier.contact_energy());
    }
    EXPECT_LE(rise.in_a_sample(), kRounding * scale) << "material " << i;
    EXPECT_LE(rise.total(), kSumOfRoundings * scale) << "material " << i;
    worst = std::max(worst, rise.in_a_sample() / scale);
    total = std::max(total, rise.total() / scale);
  }
  Measured() << "largest rise in a sample, over the largest term: " << worst << ", in total " << total;
}

TEST(Memory, EnergyOfAHammerOnAStringNeverRises) {
  Random random(3);
  double worst = 0, total = 0;
  for (int i = 0; i < kMaterials; ++i) {
    const Blow blow(random);
    const std::size_t count = 1 + random.below(40);
    std::vector<Mode> modes;
    for (std::size_t m = 1; m <= count; ++m) modes.push_back({1600 * double(m), 0.5, random.log_between(1e-4, 1e-2)});
    std::vector<double> shapes = string_shapes(count, random.between(0.05, 0.5));
    HammerString<double> model(SegmentTable<double>(blow.table), modes, ModeShapes<double>(shapes), blow.rate,
                               blow.memories);
    model.strike(blow.speed, 0);
    long double dissipated = 0;
    Rise rise;
    for (int n = 0; n < 1000; ++n) {
      model.tick({.hammer_mass_kg = blow.mass, .felt = {1, blow.loss}});
      dissipated += model.string().dissipated();
      const double v = model.hammer_velocity();
      const double contact = model.memory().energy(SegmentTable<double>(blow.table), model.compression());
      rise.add(static_cast<double>(blow.mass * v * v / 2 + contact + model.string().energy() + dissipated));
    }
    EXPECT_LE(rise.in_a_sample(), kRounding * blow.energy()) << "material " << i;
    EXPECT_LE(rise.total(), kSumOfRoundings * blow.energy()) << "material " << i;
    worst = std::max(worst, rise.in_a_sample() / blow.energy());
    total = std::max(total, rise.total() / blow.energy());
  }
  Measured() << "largest rise in a sample, over the blow's: " << worst << ", in total " << total;
}

// A mass on ground, between two samples in contact and apart, is the mass on a barrier, also while it is retuned.
TEST(Memory, NetworkOfOneContactIsTheMassOnABarrier) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Blow blow(random);
    NetworkPlan<double> plan;
    const std::size_t mass = plan.add_mass(blow.mass);
    const std::size_t place = plan.add_mass_place(mass);
    plan.add_contact(place, kGround, blow.table, 0, {1, blow.loss}, 1, blow.memories);
    ContactNetwork<double> network(plan, blow.rate);
    network.set_motion(mass, 0, blow.speed);
    MassBarrier<double> barrier(SegmentTable<double>(blow.table), blow.rate, blow.memories);
    barrier.throw_from(0, blow.speed);
    double peak = 0, error = 0;
    for (int n = 0; n < 500; ++n) {
      if (n % 3 == 0) network.retune(mass, plan.bodies()[mass]);
      network.tick();
      barrier.tick({.mass_kg = blow.mass, .contact = {1, blow.loss}});
      peak = std::max(peak, barrier.force());
      error = std::max(error, std::abs(network.force(0) - barrier.force()));
    }
    EXPECT_GT(peak, 0);
    EXPECT_TRUE(within(error, 0, 1e-10 * peak)) << "material " << i;
  }
}

// Contacts that act on each other. The books close to 1e-12 of the peak, as those of contacts without memory do, and
// memory never gives back more than it holds.
TEST(Memory, NetworksBalanceTheirEnergy) {
  double worst = 0, gained = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    RandomNetwork random_network(seed, true);
    auto network = random_network.network(CoupledContacts<double>::kMaxSteps);
    long double balance = network.energy();
    double peak = network.energy(), error = 0;
    for (int n = 0; n < 1500; ++n) {
      if (n % 100 < 10) network.push(random_network.random.below(random_network.plan.places().size()), 3);
      network.tick();
      const double dissipated = network.dissipated(), stored = network.energy();
      gained = std::max(gained, -dissipated / peak);
      balance += static_cast<long double>(network.work()) - dissipated;
      peak = std::max(peak, stored);
      error = std::max(error, std::abs(static_cast<double>(stored - balance)));
      ASSERT_TRUE(is_finite(stored)) << "network " << seed;
    }
    EXPECT_LE(error, 1e-12 * peak) << "network " << seed;
    EXPECT_EQ(network.solver().bounded(), 0U) << "network " << seed;
    worst = std::max(worst, error / peak);
  }
  EXPECT_LE(gained, kRounding);
  Measured() << "largest error of the energy, over its peak: " << worst << ", largest gain in a sample: " << gained;
}

// Without steps of the solver, the bounding law takes its place.
TEST(Memory, NetworksGainNoEnergyAtTheBound) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomNetwork random_network(seed, true);
    auto network = random_network.network(0);
    long double balance = network.energy();
    double peak = network.energy(), gained = 0;
    for (int n = 0; n < 1000; ++n) {
      network.tick();
      balance += static_cast<long double>(network.work()) - network.dissipated();
      gained = std::max(gained, static_cast<double>(network.energy() - balance));
      peak = std::max(peak, network.energy());
    }
    EXPECT_LE(gained, 1e-12 * peak) << "network " << seed;
  }
}

// A pluck for 300 samples, then 2,700 in which the stored energy and what the string lost together never rise, for
// 100 materials. controls(n): of a sample; stored(model): energy but that of string and contact.
template <typename Model, typename Controls, typename Stored>
void expect_energy_never_rises(std::uint64_t seed, Controls controls, Stored stored) {
  const StruckString string = c4();
  const auto modes = audible_modes(string);
  const StringShapes<double> shapes(wavenumbers_of(modes));
  Random random(seed);
  double worst = 0;
  for (int i = 0; i < 100; ++i) {
    const auto memories = random_memories(random);
    const Table table = power_table(random.log_between(1e6, 1e10), random.between(1.1, 2.5), 1e-3);
    const double rate = random.log_between(44100, 192000);
    Model model(SegmentTable<double>(table), bare(modes), shapes, 0.1, rate, memories);
    model.place(0.3, 1e-4);
    double dissipated = 0, first = 0;
    Rise rise;
    for (int n = 0; n < 3000; ++n) {
      model.tick(controls(n));
      if (n < 300) continue;
      dissipated += model.string().dissipated();
      if (first == 0) first = model.string().energy();
      rise.add(model.string().energy() + model.memory().energy(SegmentTable<double>(table), model.compression()) +
               stored(model) + dissipated);
    }
    // The compression is drawn to the string by 1e-4 of its rounding in each sample (FretString::tick).
    EXPECT_LE(rise.total(), 1e-12 * first) << "material " << i;
    worst = std::max(worst, rise.total() / first);
  }
  Measured() << "largest rise of the energy, over the string's: " << worst;
}

double pluck_n(int n) {
  return n < 300 ? 10 : 0;
}

TEST(Memory, EnergyOfAStringOnAFretNeverRises) {
  expect_energy_never_rises<FretString<double>>(
      5, [](int n) { return FretStringControls<double>{.place_m = 0.3, .gap_m = 1e-4, .pluck_force_n = pluck_n(n)}; },
      [](const FretString<double>&) { return 0.0; });
}

TEST(Memory, EnergyOfASlideOnAStringNeverRises) {
  constexpr double kMass_kg = 0.05, kForce_n = 3;
  expect_energy_never_rises<SlideString<double>>(
      6,
      [](int n) {
        return SlideStringControls<double>{
            .place_m = 0.3, .slide_mass_kg = kMass_kg, .hand_force_n = kForce_n, .pluck_force_n = pluck_n(n)};
      },
      [](const SlideString<double>& model) {
        return kMass_kg * model.slide_velocity() * model.slide_velocity() / 2 - kForce_n * model.slide();
      });
}

/// The continuous equations, by Runge and Kutta's method with a step far below the relaxation time.
struct Continuous {
  double mass, stiffness, exponent, weight, time_s;
  double y = 0, v = 0, m = 0;

  struct Rates {
    double y, v, m;
  };
  [[nodiscard]] Rates rates(double at_y, double at_v, double at_m) const {
    const double spring = at_y > 0 ? stiffness * std::pow(at_y, exponent) : 0.0;
    const double force = std::max(0.0, spring - weight * at_m);
    return {at_v, -force / mass, (spring - at_m) / time_s};
  }
  void advance(double h) {
    const Rates a = rates(y, v, m), b = rates(y + h / 2 * a.y, v + h / 2 * a.v, m + h / 2 * a.m),
                c = rates(y + h / 2 * b.y, v + h / 2 * b.v, m + h / 2 * b.m),
                d = rates(y + h * c.y, v + h * c.v, m + h * c.m);
    y += h / 6 * (a.y + 2 * b.y + 2 * c.y + d.y);
    v += h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v);
    m += h / 6 * (a.m + 2 * b.m + 2 * c.m + d.m);
  }
};

// Largest error of the displacement over a blow at a rate. The table is so fine that only the time step counts.
double displacement_error(Continuous exact, const Table& table, double rate) {
  const std::vector<Memory> memories = {{exact.weight, exact.time_s}};
  MassBarrier<double> barrier(SegmentTable<double>(table), rate, memories);
  barrier.throw_from(0, exact.v);
  constexpr int kSteps = 200;
  double error = 0;
  for (int n = 0; n < 0.002 * rate; ++n) {
    for (int i = 0; i < kSteps; ++i) exact.advance(1 / (rate * kSteps));
    barrier.tick({.mass_kg = exact.mass});
    error = std::max(error, std::abs(barrier.displacement() - exact.y));
  }
  return error;
}

TEST(Memory, ErrorFallsToAQuarterWithTwiceTheRate) {
  const Table table = power_table(4e9, 2.6, 4e-3, 8192);
  for (const double time_s : {2e-4, 1e-4, 5e-5})
    for (const double weight : {0.5, 0.9}) {
      const Continuous blow{
          .mass = 8e-3, .stiffness = 4e9, .exponent = 2.6, .weight = weight, .time_s = time_s, .v = 2};
      double before = displacement_error(blow, table, 176400);
      for (const double rate : {352800.0, 705600.0}) {
        const double error = displacement_error(blow, table, rate), ratio = before / error;
        EXPECT_GT(ratio, 3.8) << rate << " Hz, " << time_s << " s, weight " << weight;
        EXPECT_LT(ratio, 4.2) << rate << " Hz, " << time_s << " s, weight " << weight;
        Measured() << rate << " Hz, " << time_s << " s, weight " << weight << ": " << ratio;
        before = error;
      }
    }
}

TEST(Memory, ResetForgets) {
  Random random(7);
  const Blow blow(random);
  MassBarrier<double> barrier(SegmentTable<double>(blow.table), blow.rate, blow.memories);
  std::vector<double> first, second;
  for (auto* forces : {&first, &second}) {
    barrier.reset();
    barrier.throw_from(0, blow.speed);
    for (int n = 0; n < 50; ++n) {
      barrier.tick({.mass_kg = blow.mass});
      forces->push_back(barrier.force());
    }
  }
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace contactspline::testing
