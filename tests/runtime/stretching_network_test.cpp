// SPDX-License-Identifier: MIT
// Networks in which bodies stretch: their energy, and their motion against other paths.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "contactspline/network/contact_network.hpp"
#include "random_network.hpp"
#include "stretch_terms.hpp"
#include "string_at_stop.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/relative_error.hpp"

namespace contactspline::testing {
namespace {

// Turns controls of a random network.
void turn_controls(RandomNetwork& with, ContactNetwork<double>& network) {
  Random& random = with.random;
  network.set_damping(random.below(with.plan.bodies().size()),
                      random.below(2) == 0 ? 0 : random.log_between(1, 1000));
  const std::size_t k = random.below(with.plan.connections().size());
  if (!with.plan.connections()[k].table.empty()) {
    network.set_contact(k, {random.log_between(0.1, 10), random.between(0, 1)});
    network.set_gap(k, random.between(0, 1e-3));
  } else if (!with.plan.connections()[k].is_rigid) {
    network.set_spring(k, random.log_between(10, 1e5), random.below(2) == 0 ? 0 : random.log_between(1e-3, 10));
  }
}

// The largest error of the energy of a network that is pushed at random, over the largest energy.
double energy_error(RandomNetwork& with, ContactNetwork<double>& network, int samples, bool is_controlled) {
  double peak = network.energy(), worst = 0;
  long double balance = peak;
  for (int n = 0; n < samples; ++n) {
    if (n % 100 < 10) network.push(with.random.below(with.plan.places().size()), 3);
    if (is_controlled && n % 50 == 0) turn_controls(with, network);
    network.tick();
    balance += static_cast<long double>(network.work()) - network.dissipated();
    const double stored = network.energy(), error = static_cast<double>(stored - balance);
    if (!is_finite(error)) return error;
    peak = std::max(peak, stored);
    worst = std::max(worst, std::abs(error));
  }
  return worst / peak;
}

// With controls that are turned in every other one.
TEST(StretchingNetwork, BalancesItsEnergy) {
  double worst = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomNetwork random_network(seed, seed % 2 == 0, true);
    if (random_network.plan.forms() == 0) continue;  // masses alone
    auto network = random_network.network(CoupledContacts<double>::kMaxSteps);
    const double error = energy_error(random_network, network, 1000, seed % 4 < 2);
    EXPECT_TRUE(within(error, 0, 1e-12)) << "network " << seed;
    worst = std::max(worst, error);
  }
  Measured() << "largest error of the energy, over its peak: " << worst;
}

// The forms as springs of the solver, and as the equations of the body with the contact step inside: one motion. Each
// blow multiplies the difference that rounding makes.
TEST(StretchingNetwork, MovesAsTheBankWithOneContact) {
  StringAtStop<double> string(44100);
  NetworkPlan<double> plan;
  const std::size_t body = plan.add_body(string.modes(), std::vector{string.form()});
  const std::size_t at = plan.add_place(body, string.stop_shapes());
  const std::size_t pickup = plan.add_place(body, string.pickup_shapes());
  const auto table = string.table();
  const std::size_t contact = plan.add_contact(at, kGround, table, StringAtStop<double>::kGap_m);
  ContactNetwork<double> network(plan, 44100);
  for (std::size_t i = 0; i < string.modes().size(); ++i) network.set_motion(body, string.plucked(i), 0, i);
  std::vector<double> found, expected;
  double largest_force = 0;
  for (int n = 0; n < 4410; ++n) {
    string.tick();
    network.tick();
    found.push_back(network.displacement(pickup));
    expected.push_back(string.sound());
    largest_force = std::max(largest_force, network.force(contact));
  }
  EXPECT_GT(largest_force, 0.1);
  EXPECT_TRUE(sequences_within<double>(found, expected, 1e-9));
}

// A string that falls on a lossy contact with a memory, held by a spring with a damper, under a damper of its own,
// and linked to a mass.
std::vector<double> falling_string(double rate, bool takes_two_samples) {
  static const auto table = power_table(1e6, 1.5, 1e-3);
  static const std::vector<Memory> memories{{0.3, 1e-3}};
  NetworkPlan<double> plan;
  const auto modes = string_modes(120, 6, 1e-2);
  const std::size_t string = plan.add_body(modes), mass = plan.add_mass(0.02);
  if (takes_two_samples) plan.add_body(std::vector{Mode{1000, 1, 1}}, std::vector{StretchForm{1, {1}}});
  const std::size_t at = plan.add_place(string, string_shapes(6, 0.3));
  plan.add_contact(at, kGround, table, 1e-4, {1, 0.5}, 1, memories);
  plan.add_spring(plan.add_place(string, string_shapes(6, 0.6)), plan.add_mass_place(mass), 1e4, 1);
  ContactNetwork<double> network(plan, rate);
  network.set_damping(string, 20);
  network.set_motion(string, 0, 1, 0);
  std::vector<double> sound;
  const int every = static_cast<int>(std::lround(rate / 44100));
  for (int n = 0; n < 882 * every; ++n) {
    network.tick();
    if (n % every == every - 1) sound.push_back(network.displacement(at));
  }
  return sound;
}

// Losses, memories, springs and dampers know that they act on two samples: as the rate rises, networks in which a
// body stretches and others play the same.
TEST(StretchingNetwork, MovesAsOthersWhereNothingIsStretched) {
  const auto exact = falling_string(32 * 44100, false);
  std::vector<double> errors;
  for (const int factor : {2, 4, 8}) {
    errors.push_back(relative_error(falling_string(factor * 44100, true), exact));
    Measured() << "error at " << factor << " times 44.1 kHz: " << errors.back();
  }
  EXPECT_LT(errors.back(), 1e-3);
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], errors[i - 1] / 1.8);
}

// A felt that presses a wall which hardly moves has done so for ever, in even samples and in odd ones: its memory
// holds 0.3 of the force, so 0.7 of it are left, and all stays as it is. The wall moves by 1e-9 of the compression.
TEST(StretchingNetwork, BeginsAndResetsWithMemoriesThatAreHeld) {
  const auto table = power_table(1e6, 1.5, 1e-3);
  const std::vector<Memory> memories{{0.3, 1e-3}};
  NetworkPlan<double> plan;
  const std::size_t wall = plan.add_body(std::vector{Mode{1000, 1, 1e6}}, std::vector{StretchForm{1, {1}}});
  const std::size_t felt = plan.add_contact(plan.add_mass_place(wall), kGround, table, -5e-4, {1, 0}, 1, memories);
  ContactNetwork<double> network(plan, 44100);
  const double held = 0.7 * force(SegmentTable<double>(table), 5e-4);
  for (int round = 0; round < 2; ++round, network.reset())
    for (int n = 0; n < 20; ++n) {
      network.tick();
      ASSERT_TRUE(relatively_within(network.force(felt), held, 1e-6)) << "round " << round << ", sample " << n;
    }
}

// The ends of the ranges of displacement and velocity in double precision, a tenth of them in single: modes of 0.65 m
// of string that move so far [m] and so fast [m/s]. Rounding is of the size of the energy there (rounding_bound()).
template <typename T>
void play_far_out(T far) {
  StringAtStop<T> string(44100);
  NetworkPlan<T> plan;
  const std::size_t body = plan.add_body(string.modes(), std::vector{string.form()});
  const auto table = string.table();
  const std::size_t stop = plan.add_place(body, string.stop_shapes());
  plan.add_contact(stop, kGround, table, T(StringAtStop<T>::kGap_m));
  ContactNetwork<T> network(plan, 44100);
  for (std::size_t i = 0; i < string.modes().size(); ++i)
    network.set_motion(body, i % 2 == 0 ? far : -far, i % 3 == 0 ? far : -far, i);
  for (int n = 0; n < 2000; ++n) {
    network.push(stop, 1000);
    network.tick();
    ASSERT_TRUE(is_finite(double(network.displacement(stop)))) << n;
    ASSERT_TRUE(is_finite(network.energy())) << n;
  }
}

TEST(StretchingNetwork, StaysFiniteFarOut) {
  play_far_out<float>(100);
  play_far_out<double>(1000);
}

// In single precision: rounding adds to the energy as it does in a bank.
TEST(StretchingNetwork, ErrsByRoundingAlone) {
  StringAtStop<float> string(44100);
  NetworkPlan<float> plan;
  const std::vector<StretchForm> forms{string.form()};
  const std::size_t body = plan.add_body(string.modes(), forms);
  const auto table = string.table();
  plan.add_contact(plan.add_place(body, string.stop_shapes()), kGround, table, float(StringAtStop<float>::kGap_m));
  ContactNetwork<float> network(plan, 44100);
  for (std::size_t i = 0; i < string.modes().size(); ++i)
    network.set_motion(body, static_cast<float>(string.plucked(i)), 0, i);
  const double first = network.energy();
  double worst = 0, terms = 0;
  constexpr int kSamples = 44100;
  for (int n = 0; n < kSamples; ++n) {
    network.tick();
    const double error = std::abs(network.energy() / first - 1);
    worst = std::max(worst, is_finite(error) ? error : std::numeric_limits<double>::infinity());
    terms = std::max(terms, energy_of_terms<float>(forms, network.body(body).displacements()));
  }
  const double bound = rounding_bound<float>(kSamples, terms, first);
  Measured() << "largest error of the energy over a second " << worst << ", bound " << bound;
  EXPECT_TRUE(within(worst, 0, bound));
}

TEST(StretchingNetwork, DoesNotAllocate) {
  RandomNetwork random_network(1, true, true);
  auto network = random_network.network(CoupledContacts<double>::kMaxSteps);
  const std::size_t before = allocations;
  for (int n = 0; n < 100; ++n) network.tick();
  network.reset();
  network.tick();
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace contactspline::testing
