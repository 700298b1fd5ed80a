// SPDX-License-Identifier: MIT
// Networks of bodies and contacts: their energy, and their motion against closed forms and other paths.
#include "contactspline/network/contact_network.hpp"

#include <numbers>
#include <type_traits>
#include <utility>

#include "contactspline/models/hammer_string.hpp"
#include "power_table.hpp"
#include "random_network.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/relative_error.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

// What a run of a network shows of its energy.
struct Books {
  double peak = 0;
  double worst = 0;   // largest |stored + dissipated - work - stored at first|
  double gained = 0;  // largest energy gained over a sample beyond what balances
  std::size_t coupled = 0;
};

Books energy_balance_of(RandomNetwork& random_network, ContactNetwork<double>& network, int samples) {
  Books books{.peak = network.energy()};
  long double balance = books.peak;
  for (int n = 0; n < samples; ++n) {
    if (n % 100 < 10) network.push(random_network.random.below(random_network.plan.places().size()), 3);
    network.tick();
    balance += static_cast<long double>(network.work()) - network.dissipated();
    const double stored = network.energy(), error = static_cast<double>(stored - balance);
    books.peak = std::max(books.peak, stored);
    books.worst = is_finite(error) ? std::max(books.worst, std::abs(error)) : error;
    if (!is_finite(error)) return books;
    books.gained = std::max(books.gained, error);
    books.coupled += network.solver().steps() > 0;
  }
  return books;
}

TEST(ContactNetwork, BalancesItsEnergy) {
  std::size_t coupled = 0;
  double worst = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomNetwork random_network(seed);
    auto network = random_network.network(CoupledContacts<double>::kMaxSteps);
    const Books books = energy_balance_of(random_network, network, 3000);
    EXPECT_TRUE(within(books.worst, 0, 1e-12 * books.peak)) << "network " << seed;
    EXPECT_EQ(network.solver().bounded(), 0U) << "network " << seed;
    worst = std::max(worst, books.worst / books.peak);
    coupled += books.coupled;
  }
  Measured() << "largest error of the energy, over its peak: " << worst;
  EXPECT_GT(coupled, 90000U);
}

// A solver that may take no step uses the bounding law wherever contacts are coupled: energy is lost, never gained.
TEST(ContactNetwork, GainsNoEnergyAtTheBound) {
  std::size_t bounded = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomNetwork random_network(seed);
    auto network = random_network.network(0);
    const Books books = energy_balance_of(random_network, network, 1000);
    EXPECT_TRUE(is_finite(books.worst)) << "network " << seed;
    EXPECT_LE(books.gained, 1e-12 * books.peak) << "network " << seed;
    bounded += network.solver().bounded();
  }
  EXPECT_GT(bounded, 10000U);
}

// A string that is pressed onto its bridge for long stays where it is: neither its compressions nor its energy drift.
TEST(ContactNetwork, HoldsAPressedStringWithoutDrift) {
  Tanpura<double> tanpura(24, 44100);
  auto& network = tanpura.network;
  for (std::size_t k = 0; k < tanpura.bridge.count; ++k)
    network.set_gap(tanpura.bridge.first + k, network.gap(tanpura.bridge.first + k) - 1e-3);
  long double balance = 0;
  double peak = 0, error_after_1_s = 0;
  for (int n = 0; n < 4 * 44100; ++n) {
    tanpura.tick();
    balance += static_cast<long double>(network.work()) - network.dissipated();
    peak = std::max(peak, network.energy());
    if (n == 44100) error_after_1_s = static_cast<double>(network.energy() - balance);
  }
  EXPECT_TRUE(within(static_cast<double>(network.energy() - balance), error_after_1_s, 1e-13 * peak));
  EXPECT_GT(network.energy(), 0.5 * peak);
}

TEST(ContactNetwork, ConvergesAsAProfileIsRefined) {
  const auto played = [](std::size_t points) {
    Tanpura<double> tanpura(points, 192000);
    std::vector<double> displacements;
    double max_force = 0;
    for (int n = 0; n < 1920; ++n) {
      tanpura.tick();
      max_force = std::max(max_force, tanpura.network.force(tanpura.bridge));
      displacements.push_back(tanpura.network.displacement(tanpura.pluck));
    }
    EXPECT_GT(max_force, 1);
    return displacements;
  };
  const auto reference = played(192);
  std::vector<double> errors;
  for (const std::size_t points : {6u, 12u, 24u, 48u}) {
    errors.push_back(relative_error(played(points), reference));
    Measured() << points << " points: " << errors.back();
  }
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], 0.6 * errors[i - 1]);
  EXPECT_LT(errors.back(), 1e-3);
}

// Its bodies point to the shapes of its places: a copy would point into the original, a moved network does not.
static_assert(!std::is_copy_constructible_v<ContactNetwork<double>> &&
              !std::is_copy_assignable_v<ContactNetwork<double>>);

TEST(ContactNetwork, PlaysOnAfterAMove) {
  Tanpura<double> stays(12, kRate), moves(12, kRate);
  for (int n = 0; n < 500; ++n) {
    stays.tick(), moves.tick();
    if (n % 100 == 99) moves.network = ContactNetwork<double>(std::move(moves.network));
    ASSERT_EQ(moves.network.displacement(moves.pluck), stays.network.displacement(stays.pluck)) << n;
  }
}

// Points of a profile that touch at once act together as one contact of the sum of their weights.
TEST(ContactNetwork, WeighsThePointsOfAProfile) {
  const Table table = power_table(1e8, 1.5, 1e-3);
  const auto played = [&](const std::vector<double>& weights) {
    NetworkPlan<double> plan;
    const std::size_t place = plan.add_mass_place(plan.add_mass(0.01));
    const std::vector<std::size_t> places(weights.size(), place);
    const auto points = plan.add_profile(places, kGround, table, std::vector<double>(weights.size(), 1e-4), weights);
    ContactNetwork<double> network(plan, kRate);
    network.set_motion(0, 0, 2);
    std::vector<double> forces;
    for (int n = 0; n < 100; ++n) {
      network.tick();
      forces.push_back(network.force(points));
    }
    return forces;
  };
  EXPECT_TRUE(sequences_within<double>(played({0.5, 0.125, 0.25}), played({0.875}), 1e-10));
}

TEST(ContactNetwork, DoesNotAllocate) {
  Tanpura<double> tanpura(24, kRate);
  Tanpura<float> in_float(24, kRate);
  const std::size_t before = allocations;
  for (int n = 0; n < 10000; ++n) {
    tanpura.tick();
    in_float.tick();
    if (n == 5000) {
      tanpura.network.set_damping(0, 5);
      tanpura.network.set_contact(tanpura.bridge, {.stiffness_ratio = 2});
      tanpura.network.set_gap(3, 1e-4);
    }
  }
  tanpura.network.reset();
  EXPECT_EQ(allocations, before);
  EXPECT_TRUE(is_finite(in_float.network.displacement(in_float.pluck)));
  EXPECT_GT(in_float.network.energy(), 1e-6);
}

// A network of a string and a mass is HammerString.
TEST(ContactNetwork, IsTheHammerString) {
  const auto modes = string_modes(262, 60, 2e-3);
  const Table felt = power_table(4.5e9, 2.5, 1e-3);
  const auto strike = string_shapes(60, 0.12);
  HammerString<double> model(felt, modes, ModeShapes<double>(strike), kRate);
  model.strike(2.5, 1e-4);
  NetworkPlan<double> plan;
  const std::size_t string = plan.add_body(modes), hammer = plan.add_mass(0.003);
  const std::size_t at_string = plan.add_place(string, strike), at_hammer = plan.add_mass_place(hammer);
  plan.add_contact(at_hammer, at_string, felt, 1e-4, {1, 0.1});
  ContactNetwork<double> network(plan, kRate);
  network.set_motion(hammer, 0, 2.5);
  std::vector<double> found, expected;
  for (int n = 0; n < 1000; ++n) {
    model.tick({.hammer_mass_kg = 0.003, .felt = {1, 0.1}});
    network.tick();
    found.push_back(network.force(0));
    expected.push_back(model.force());
  }
  EXPECT_TRUE(sequences_within<double>(found, expected, 1e-10));
}

// Two masses on a spring: the midpoint rule turns w dt/2 into its tangent.
TEST(ContactNetwork, SwingsTwoMassesOnASpring) {
  const double mass = 0.01, stiffness = 1e4;
  NetworkPlan<double> plan;
  const std::size_t a = plan.add_mass_place(plan.add_mass(mass)), b = plan.add_mass_place(plan.add_mass(mass));
  plan.add_spring(a, b, stiffness);
  ContactNetwork<double> network(plan, kRate);
  network.set_motion(0, 1e-3, 0);
  const double w = 2 * kRate * std::atan(std::sqrt(2 * stiffness / mass) / kRate / 2);
  for (int n = 1; n < 20000; ++n) {
    network.tick();
    ASSERT_TRUE(within(network.displacement(a) - network.displacement(b), 1e-3 * std::cos(w * n / kRate), 1e-12))
        << n;
  }
}

// A mass that is rigidly linked to two others moves with them as their sum does.
TEST(ContactNetwork, MovesLinkedMassesAsOne) {
  NetworkPlan<double> plan;
  std::vector<std::size_t> places;
  for (const double mass : {0.01, 0.02, 0.005}) places.push_back(plan.add_mass_place(plan.add_mass(mass)));
  plan.add_rigid_link(places[0], places[1]);
  plan.add_rigid_link(places[1], places[2]);
  plan.add_rigid_link(places[2], places[0]);  // one too many does no harm
  ContactNetwork<double> network(plan, kRate);
  for (int n = 1; n <= 10000; ++n) {
    network.push(places[0], 1);
    network.tick();
    const double time = n / kRate, expected = time * time / (2 * 0.035);
    for (const std::size_t place : places) ASSERT_TRUE(within(network.displacement(place), expected, 1e-9)) << n;
  }
}

// Controls that jump anywhere, out of range and to NaN: the books close, and they stay finite. A stiffness of up to
// 1e18 N/m^a multiplies the rounding of the displacements, hence the bound.
TEST(ContactNetwork, FollowsItsControls) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (unsigned seed = 0; seed < 20; ++seed) {
    RandomNetwork random_network(seed);
    Random& random = random_network.random;
    const auto& plan = random_network.plan;
    auto network = random_network.network(CoupledContacts<double>::kMaxSteps);
    const std::vector<double> wild{nan, inf, -inf, 0, 1, 1e-9, 1e9, -1};
    const auto any = [&] { return wild[random.below(wild.size())]; };
    long double balance = network.energy();
    double peak = network.energy(), worst = 0, gained = 0;
    for (int n = 0; n < 3000; ++n) {
      const std::size_t k = random.below(plan.connections().size());
      if (n % 10 == 0 && !plan.connections()[k].table.empty()) network.set_contact(k, {any(), any()});
      if (n % 10 == 3 && plan.connections()[k].table.empty() && !plan.connections()[k].is_rigid)
        network.set_spring(k, any(), any());
      if (n % 10 == 5) network.set_gap(k, random.below(4) == 0 ? any() : random.between(0, 1e-3));
      if (n % 10 == 7) network.set_damping(random.below(plan.bodies().size()), any());
      if (n % 50 == 9) network.push(random.below(plan.places().size()), any());
      network.tick();
      balance += static_cast<long double>(network.work()) - network.dissipated();
      const double stored = network.energy();
      peak = std::max(peak, stored);
      const double error = static_cast<double>(stored - balance);
      worst = is_finite(error) ? std::max(worst, std::abs(error)) : inf;
      gained = std::max(gained, error);
    }
    EXPECT_TRUE(is_finite(worst)) << "network " << seed;
    EXPECT_LE(gained, 1e-9 * peak) << "network " << seed;
    if (network.solver().bounded() == 0) {
      EXPECT_LE(worst, 1e-9 * peak) << "network " << seed;
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
