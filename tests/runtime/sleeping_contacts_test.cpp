// SPDX-License-Identifier: MIT
// Contacts of a network that sleep while their bodies are far apart: none is missed, each wakes in time.
#include <numbers>

#include "contactspline/network/contact_network.hpp"
#include "power_table.hpp"
#include "random_network.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

// A string over four contacts that begins at a displacement of its first mode and is pushed from sample 400 to 550,
// beside the same by hand: there every connection takes part in every sample, none sleeps.
struct Sleep {
  std::size_t all = 0, in_motion = 0;  // sum of sleeping contacts over the samples; in those with more than 1 m/s
};
Sleep expect_no_contact_missed(double displacement_m, double push_n) {
  const Table table = power_table(1e9, 1.5, 1e-4);
  const auto modes = string_modes(200, 40, 1e-3);
  const std::vector<double> places{0.1, 0.3, 0.45, 0.8}, gaps{5e-4, 1e-3, 2e-3, 1e-3};
  NetworkPlan<double> plan;
  const std::size_t string = plan.add_body(modes);
  for (std::size_t k = 0; k < places.size(); ++k)
    plan.add_contact(plan.add_place(string, string_shapes(40, places[k])), kGround, table, gaps[k]);
  ContactNetwork<double> network(plan, kRate);
  network.set_motion(string, displacement_m, 0);

  ModalBank<double> bank(modes, kRate);
  bank.set_motion(0, displacement_m, 0);
  CoupledContacts<double> solver(places.size(), kRate);
  std::vector<ModeShapes<double>> shapes;
  for (const double place : places) shapes.emplace_back(string_shapes(40, place));
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = 0; j < places.size(); ++j)
      solver.set_receptance(i, j, bank.receptance(shapes[i], shapes[j]));
    solver[i].table = table;
    solver[i].compression = bank.displacement(shapes[i]) - gaps[i];
  }
  std::vector<double> found, expected;
  Sleep sleep;
  std::size_t active = 0;
  for (int n = 0; n < 2000; ++n) {
    const double push = n >= 400 && n < 550 ? push_n : 0;
    network.push(1, push);
    network.tick();
    bank.predict();
    bank.push(shapes[1], push);
    solver.begin();
    for (std::size_t i = 0; i < places.size(); ++i) solver[i].free_increment = bank.increment(shapes[i]);
    for (std::size_t i = 0; i < places.size(); ++i) solver.add(i);
    solver.solve();
    for (const std::size_t i : solver.active()) bank.push(shapes[i], -solver[i].force);
    solver.advance();
    bank.commit();
    found.push_back(network.displacement(1));
    expected.push_back(bank.displacement(shapes[1]));
    active += solver.active().size();
    sleep.all += network.sleeping();
    if (std::abs(network.velocity(1)) > 1) sleep.in_motion += network.sleeping();
  }
  EXPECT_TRUE(sequences_within<double>(found, expected, 1e-9));
  EXPECT_GT(active, 100U);
  return sleep;
}

// All contacts sleep before the push.
TEST(ContactNetwork, MissesNoContactThatSleeps) {
  EXPECT_GT(expect_no_contact_missed(0, 6).all, 1000U);
}

// Contacts fall asleep while the string swings by 3 mm. It moves in one mode at first: bounds of its motion are no
// larger than the motion at the middle.
TEST(ContactNetwork, MissesNoContactThatFallsAsleepInMotion) {
  EXPECT_GT(expect_no_contact_missed(-3e-3, 0).in_motion, 100U);
}

// A push that drives a mass into a sleeping contact within one sample: it wakes in this sample.
TEST(ContactNetwork, WakesAContactInTheSampleOfAPush) {
  const Table table = power_table(1e9, 1.5, 1e-4);
  NetworkPlan<double> plan;
  const std::size_t place = plan.add_mass_place(plan.add_mass(1e-3));
  plan.add_contact(place, kGround, table, 1e-4);
  ContactNetwork<double> network(plan, kRate);
  for (int n = 0; n < 100; ++n) network.tick();
  ASSERT_EQ(network.sleeping(), 1U);
  network.push(place, 1000);  // 0.257 mm within a sample without the contact
  network.tick();
  EXPECT_GT(network.force(0), 1);
  EXPECT_LT(network.displacement(place), 2.3e-4);
}

// The same between two places of one mode that move against each other: they close by twice what each one moves.
TEST(ContactNetwork, WakesAContactWithinABodyInTheSampleOfAPush) {
  const Table table = power_table(1e9, 1.5, 1e-4);
  const Mode mode{2 * std::numbers::pi * 100, 1, 1e-3};
  const double up = 1, down = -1;
  NetworkPlan<double> plan;
  const std::size_t body = plan.add_body({&mode, 1});
  const std::size_t first = plan.add_place(body, {&up, 1}), second = plan.add_place(body, {&down, 1});
  plan.add_contact(first, second, table, 4e-4);
  ContactNetwork<double> network(plan, kRate);
  for (int n = 0; n < 100; ++n) network.tick();
  ASSERT_EQ(network.sleeping(), 1U);
  network.push(first, 1000);  // without the contact 0.514 mm between the places
  network.tick();
  EXPECT_GT(network.force(0), 1);
  EXPECT_LT(network.compression(0), 1e-4);
}

// A hammer meets one end of a lever at rest. In the same sample the other end moves 30 times as far, further than any
// body moved by itself, into a sleeping contact: it wakes.
TEST(ContactNetwork, WakesAContactInTheSampleOfABlow) {
  const Table table = power_table(1e9, 1.5, 1e-3);
  const Mode mode{2 * std::numbers::pi * 100, 1, 1e-4};
  const double near = 1, far = 30;
  NetworkPlan<double> plan;
  const std::size_t mass = plan.add_mass(0.1), hammer = plan.add_mass_place(mass);
  const std::size_t lever = plan.add_body({&mode, 1});
  const std::size_t first = plan.add_place(lever, {&near, 1}), second = plan.add_place(lever, {&far, 1});
  plan.add_contact(hammer, first, table, 0);
  plan.add_contact(second, kGround, table, 5e-4);
  ContactNetwork<double> network(plan, kRate);
  network.set_motion(mass, -0.05, 10);  // 0.23 mm per sample
  std::size_t asleep = 0;
  for (int n = 0; n < 300 && network.displacement(second) == 0; ++n) {
    asleep = network.sleeping();
    network.tick();
  }
  EXPECT_EQ(asleep, 1U);
  EXPECT_GT(network.force(1), 1);
  EXPECT_LT(network.displacement(second), 7e-4);
}

// A gap that moves to a mass at rest in thousands of steps, each rounded to single precision.
TEST(ContactNetwork, WakesAContactWhoseGapCloses) {
  const auto table = power_table<float>(1e5, 1, 0.1);
  std::size_t touched = 0;
  for (int m = 0; m < 40; ++m) {
    NetworkPlan<float> plan;
    const std::size_t place = plan.add_mass_place(plan.add_mass(1000));
    plan.add_contact(place, kGround, table, 0.1f);
    ContactNetwork<float> network(plan, 96000);
    network.set_motion(0, static_cast<float>(0.0989 - 0.0049 * m), 0);
    for (int n = 0; n < 40; ++n) network.tick();
    ASSERT_EQ(network.sleeping(), 1U);
    network.set_gap(0, -0.1f);
    for (int n = 0; n < 24000; ++n) {
      network.tick();
      if (network.compression(0) <= 0) continue;
      ++touched;
      ASSERT_EQ(network.sleeping(), 0U) << "mass " << m << ", " << network.compression(0);
    }
  }
  EXPECT_GT(touched, 40U);
}

// A mass that a spring pulls towards a sleeping contact while its damping jumps up and down: forces of samples
// without damping count as what they were when the damping rises.
TEST(ContactNetwork, WakesAContactWhileTheDampingJumps) {
  const Table table = power_table(1e9, 1.5, 1e-4);
  NetworkPlan<double> plan;
  const std::size_t place = plan.add_mass_place(plan.add_mass(1e-3));
  plan.add_contact(place, kGround, table, 0.01);
  plan.add_spring(place, kGround, 10, 0, 0.1);  // pulls with 1 N
  ContactNetwork<double> network(plan, kRate);
  bool has_slept = false;
  double deepest = 0;
  for (int n = 0; n < 5000; ++n) {
    network.set_damping(0, n % 16 == 15 ? kRate : 0);
    network.tick();
    has_slept |= network.sleeping() == 1;
    if (network.compression(0) > 0) {
      EXPECT_EQ(network.sleeping(), 0U) << n << " " << network.compression(0);
    }
    deepest = std::max(deepest, network.compression(0));
  }
  EXPECT_TRUE(has_slept);
  EXPECT_GT(deepest, 0);
}

// Random networks with pushes, gaps and springs that move: what sleeps has not closed.
TEST(RandomNetworks, SleepOnlyWhileApart) {
  std::size_t asleep = 0, woken = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    RandomNetwork random_network(seed);
    Random& random = random_network.random;
    auto network = random_network.network(CoupledContacts<double>::kMaxSteps);
    network.let_springs_sleep();
    const auto& connections = random_network.plan.connections();
    const auto is_spring = [&](std::size_t k) { return connections[k].table.empty() && !connections[k].is_rigid; };
    std::vector<char> slept(connections.size());
    for (int n = 0; n < 3000; ++n) {
      if (n % 40 < 3) network.push(random.below(random_network.plan.places().size()), random.between(-100, 100));
      const std::size_t moved = random.below(connections.size());
      if (n % 50 == 0) network.set_gap(moved, random.between(-1e-4, 2e-3));
      if (n % 30 == 0 && is_spring(moved)) network.set_spring(moved, random.below(2) == 0 ? 0 : 1e4, 0);
      network.tick();
      for (std::size_t k = 0; k < connections.size(); ++k) {
        const bool sleeps = network.is_sleeping(k);
        asleep += sleeps;
        woken += slept[k] && !sleeps;
        slept[k] = sleeps;
        if (!sleeps) continue;
        ASSERT_EQ(network.force(k), 0) << "seed " << seed << ", sample " << n;
        if (is_spring(k)) continue;
        ASSERT_LE(network.compression(k), 1e-12) << "seed " << seed << ", sample " << n;
      }
    }
  }
  EXPECT_GT(asleep, 100000U);
  EXPECT_GT(woken, 1000U);
}

}  // namespace
}  // namespace contactspline::testing
