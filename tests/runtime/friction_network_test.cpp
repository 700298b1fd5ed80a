// SPDX-License-Identifier: MIT
// Friction in networks: beside contacts that do the same, beside friction at one point, and its energy.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <vector>

#include "contactspline/network/contact_network.hpp"
#include "power_table.hpp"
#include "random_network.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

// n points of friction, strongly coupled, on the one hand; on the other n contacts with two segments, y = z + L,
// beside the constant forces -k L, which the increments without forces contain.
TEST(CoupledFriction, IsThatOfContactsOnTwoSegments) {
  Random random(5);
  int most_steps = 0, slipping = 0;
  for (int run = 0; run < 2000; ++run) {
    const std::size_t n = 2 + random.below(3);
    CoupledContacts<double> points(n, 44100), contacts(n, 44100);
    std::vector<std::array<double, 6>> shapes(n);
    for (auto& row : shapes)
      for (double& shape : row) shape = random.between(-1, 1);
    const double scale = random.log_between(1e-9, 1e-4);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        double receptance = 0;
        for (std::size_t m = 0; m < 6; ++m) receptance += scale * shapes[i][m] * shapes[j][m];
        points.set_receptance(i, j, receptance);
        contacts.set_receptance(i, j, receptance);
      }
    std::vector<std::array<Segment<double>, 3>> tables(n);
    std::vector<double> limits(n);
    points.begin(), contacts.begin();
    for (std::size_t i = 0; i < n; ++i) {
      auto& point = points[i];
      point.is_friction = true;
      point.friction = Friction<double>({.stiffness_per_m = random.log_between(1e3, 1e7)}, 44100);
      const FrictionControls<double> pressed{random.log_between(0.01, 100), random.between(0.1, 1)};
      point.friction.press(pressed);
      const double yield = point.friction.law().yield, limit = pressed.normal_force_n * pressed.coefficient;
      point.friction.advance({0, 0, random.between(-yield, yield), 0});
      point.free_increment = random.sign() * random.log_between(1e-2, 1e3) * yield;
      tables[i] = {{{0, 0, 0, 0}, {0, 0, 0, limit / yield / 2}, {2 * yield, 2 * limit * yield, 2 * limit, 0}}};
      limits[i] = limit;
    }
    for (std::size_t i = 0; i < n; ++i) {
      auto& contact = contacts[i];
      contact.table = tables[i];
      contact.compression = points[i].friction.strain() + points[i].friction.law().yield;
      contact.segment = 1;
      contact.free_increment = points[i].free_increment;
      for (std::size_t j = 0; j < n; ++j) contact.free_increment += contacts.receptance(i, j) * limits[j];
      points.add(i), contacts.add(i);
    }
    points.solve(), contacts.solve();
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_TRUE(within(points[i].force, contacts[i].force - limits[i], 1e-9 * limits[i])) << run;
      slipping += points[i].friction_step.slip > 0;
    }
    ASSERT_EQ(points.bounded(), 0U) << run;
    most_steps = std::max(most_steps, points.steps());
  }
  Measured() << "at most " << most_steps << " steps";
  EXPECT_GT(slipping, 1000);
}

CONTACTSPLINE_EACH_PRECISION(NetworkFriction);

// A free mass on a belt is one point of friction, without iteration.
TYPED_TEST(NetworkFriction, OfAMassOnABeltIsTheFrictionStep) {
  using T = TypeParam;
  constexpr double kRate = 44100, kMass = 0.01;
  NetworkPlan<T> plan;
  const std::size_t place = plan.add_mass_place(plan.add_mass(kMass));
  const std::size_t belt = plan.add_friction(kGround, place, kRosin, 0.01);
  ContactNetwork<T> network(plan, kRate);
  Friction<double> friction(kRosin.bristles, kRate);
  FrictionTemperature<double> surfaces(kRosin.heat, 0.01, kRate);
  double velocity = 0;
  std::vector<double> found, expected;
  for (int n = 0; n < 2000; ++n) {
    const double normal = n < 1000 ? 0.5 : 2, speed = n < 1500 ? 0.4 : -0.2;
    network.set_normal_force(belt, T(normal));
    network.set_surface_speed(belt, T(speed));
    network.tick();
    const auto step =
        friction.tick({normal, surfaces.coefficient()}, (speed - velocity) / kRate, 1 / (2 * kMass * kRate * kRate));
    surfaces.advance(normal, step.increment, friction.slip_heat());
    velocity += step.force / kMass / kRate;
    found.push_back(network.velocity(place));
    expected.push_back(velocity);
    ASSERT_EQ(network.solver().steps(), 0) << n;
    if (n == 20) {
      ASSERT_TRUE(relatively_within(network.temperature(belt), surfaces.temperature(), 1e-3));
    }
  }
  EXPECT_TRUE(sequences_within<double>(found, expected, 1000 * std::numeric_limits<T>::epsilon()));
}

// A ball bounces on a plate, across the motion of a mass on a belt that its contact presses: the mass gets 0.4 times
// the momentum of that contact, whose force presses in the sample after it. At first bristles yield after 2e-5 of
// one.
TYPED_TEST(NetworkFriction, IsPressedByAContact) {
  using T = TypeParam;
  constexpr double kRate = 44100, kMass = 1;
  const auto table = power_table<T>(1e6, 1.5, 1e-3);
  NetworkPlan<T> plan;
  const std::size_t ball = plan.add_mass(0.01), mass = plan.add_mass(kMass);
  const std::size_t contact = plan.add_contact(plan.add_mass_place(ball), kGround, SegmentTable<T>(table), T(1e-4));
  const std::size_t sliding = plan.add_mass_place(mass);
  const std::size_t belt = plan.add_friction(kGround, sliding, coulomb_friction(0.4, {1e9}), 1, contact);
  ContactNetwork<T> network(plan, kRate);
  network.set_surface_speed(belt, T(1));
  network.set_motion(ball, T(0), T(2));
  double impulse = 0, last = 0, balance = network.energy();
  for (int n = 0; n < 400; ++n) {
    network.tick();
    ASSERT_TRUE(relatively_within(double(network.force(belt)), 0.4 * last, 2e-5)) << n;
    last = double(network.force(contact));
    impulse += last / kRate;
    balance += network.work() - network.dissipated();
  }
  EXPECT_TRUE(relatively_within(impulse, 0.04, 1e-3)) << "the ball turns round";
  EXPECT_TRUE(relatively_within(double(network.velocity(sliding)), 0.4 * impulse / kMass, 1e-3));
  EXPECT_TRUE(relatively_within(network.energy(), balance, 1e4 * std::numeric_limits<T>::epsilon()));
}

// A random network with up to four points of friction, which are pressed and drawn at random, and contacts that may
// be rough.
struct RandomFriction : RandomNetwork {
  explicit RandomFriction(unsigned seed) : RandomNetwork(seed) {
    rate = random.log_between(8000, 768000);
    for (std::size_t count = 1 + random.below(4); count > 0; --count) {
      const std::size_t first = random.below(plan.places().size()), second = random.below(plan.places().size());
      FrictionMaterial material = kRosin;
      if (random.once_in(2))
        material = coulomb_friction(random.between(0, 2), {random.log_between(1e4, 1e7), random.log_between(1, 1e3)});
      points.push_back(
          plan.add_friction(first == second ? kGround : first, second, material, 0.01, pressing(first + 2 * second)));
    }
    for (std::size_t k = 0; k < plan.connections().size(); ++k) {
      if (plan.connections()[k].table.empty() || random.once_in(2)) continue;
      plan.roughen(k, {random.decades(-6, -3), random.decades(-5, -1), random.once_in(2)});
      rough.push_back(k);
    }
  }

  // Some are pressed by a contact, too.
  [[nodiscard]] std::size_t pressing(std::size_t number) const {
    std::vector<std::size_t> contacts;
    for (std::size_t k = 0; k < plan.connections().size(); ++k)
      if (!plan.connections()[k].table.empty()) contacts.push_back(k);
    return contacts.empty() || number % 2 == 0 ? kNoConnection : contacts[number % contacts.size()];
  }

  void jump(ContactNetwork<double>& network) {
    for (const std::size_t point : points) {
      if (random.once_in(50)) network.set_normal_force(point, random.once_in(4) ? 0 : random.decades(-4, 2));
      if (random.once_in(50)) network.set_surface_speed(point, random.between(-1, 1));
    }
    for (const std::size_t contact : rough)
      if (random.once_in(50)) network.set_surface_speed(contact, random.sign() * random.decades(-3, 3));
  }

  std::vector<std::size_t> points, rough;
};

struct FrictionBooks {
  double worst = 0, gained = 0, peak = 0;
  double rounding = 0;  // eps times the sum of |f| (|xf| + xi |f|), and of what bristles hold
  long slipped = 0, held = 0, coupled = 0, steps = 0;
  int most_steps = 0;
};

FrictionBooks friction_books(RandomFriction& random, ContactNetwork<double>& network, int samples) {
  FrictionBooks books{.peak = network.energy()};
  long double balance = books.peak;
  for (int n = 0; n < samples; ++n) {
    random.jump(network);
    network.tick();
    balance += static_cast<long double>(network.work()) - network.dissipated();
    const double stored = network.energy(), error = static_cast<double>(stored - balance);
    books.worst = is_finite(error) ? std::max(books.worst, std::abs(error)) : error;
    if (!is_finite(error)) return books;
    books.gained = std::max(books.gained, error);
    books.peak = std::max(books.peak, stored);
    const auto& solver = network.solver();
    for (const std::size_t k : solver.active()) {
      const double force = std::abs(solver[k].force);
      books.rounding += force * (std::abs(solver[k].free_increment) + solver.receptance(k, k) * force);
    }
    for (const std::size_t point : random.points) {
      if (solver[point].force == 0) continue;
      (network.slip(point) > 0 ? books.slipped : books.held) += 1;
    }
    books.coupled += solver.steps() > 0;
    books.steps += solver.steps();
    books.most_steps = std::max(books.most_steps, solver.steps());
  }
  books.rounding *= std::numeric_limits<double>::epsilon();
  return books;
}

TEST(RandomNetworksWithFriction, BalanceTheirEnergy) {
  const unsigned networks = std::getenv("CONTACTSPLINE_FULL_TESTS") != nullptr ? 1000 : 100;
  double worst = 0, worst_of_rounding = 0;
  long slipped = 0, held = 0, coupled = 0, steps = 0;
  int most_steps = 0;
  for (unsigned seed = 0; seed < networks; ++seed) {
    RandomFriction random(seed);
    auto network = random.network(CoupledContacts<double>::kMaxSteps);
    const auto books = friction_books(random, network, 2000);
    EXPECT_TRUE(within(books.worst, 0, 1e-12 * books.peak + 8 * books.rounding)) << "network " << seed;
    EXPECT_EQ(network.solver().bounded(), 0U) << "network " << seed;
    worst = std::max(worst, books.worst / books.peak);
    worst_of_rounding = std::max(worst_of_rounding, books.worst / books.rounding);
    slipped += books.slipped, held += books.held, coupled += books.coupled, steps += books.steps;
    most_steps = std::max(most_steps, books.most_steps);
  }
  Measured() << "largest error of the energy: " << worst << " of its peak, " << worst_of_rounding
             << " eps times the sum of |f| (|xf| + xi |f|); steps: mean "
             << static_cast<double>(steps) / static_cast<double>(coupled) << " of " << coupled << " samples, at most "
             << most_steps << "; " << slipped << " slips, " << held << " hold";
  EXPECT_GT(slipped, 500L * networks);
  EXPECT_GT(held, 500L * networks);
}

TEST(RandomNetworksWithFriction, GainNoEnergyAtTheBound) {
  std::size_t bounded = 0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    RandomFriction random(seed);
    auto network = random.network(0);
    const auto books = friction_books(random, network, 1000);
    EXPECT_TRUE(is_finite(books.worst)) << "network " << seed;
    EXPECT_LE(books.gained, 1e-12 * books.peak + 8 * books.rounding) << "network " << seed;
    bounded += network.solver().bounded();
  }
  EXPECT_GT(bounded, 5000U);
}

// Four points of hair on a string, each a mass on a spring and a damper. The first one moves along the string.
template <typename T>
struct BowedString {
  explicit BowedString(double rate) : network(plan_of(), rate) {}

  NetworkPlan<T> plan_of() {
    NetworkPlan<T> plan;
    const std::size_t string = plan.add_body(string_modes(293.7, 40, 2.5e-4));
    std::vector<double> wavenumbers;
    for (int n = 1; n <= 40; ++n) wavenumbers.push_back(std::numbers::pi * n / kLength_m);
    moving = plan.add_moving_place(string, wavenumbers, T(0.1 * kLength_m));
    for (std::size_t p = 0; p < 4; ++p) {
      const std::size_t on_string =
          p == 0 ? moving : plan.add_place(string, string_shapes(40, 0.1 + 0.008 * double(p)));
      const std::size_t hair = plan.add_mass_place(plan.add_mass(6.2e-3 / 4));
      plan.add_spring(hair, kGround, T(1.1e5 / 4), T(10.0 / 4));
      points[p] = plan.add_friction(hair, on_string, kRosin, 0.0025);
    }
    return plan;
  }

  void tick(T force, T speed) {
    for (const std::size_t point : points) {
      network.set_normal_force(point, force / 4);
      network.set_surface_speed(point, speed);
    }
    network.tick();
  }

  static constexpr double kLength_m = 0.325;
  std::array<std::size_t, 4> points{};
  std::size_t moving = 0;
  ContactNetwork<T> network;
};

// Force and speed of the bow jump in every sample, and its place all the time; then it is lifted, and the string
// rings out.
TYPED_TEST(NetworkFriction, OfABowedStringBalancesItsEnergy) {
  using T = TypeParam;
  BowedString<T> bowed(44100);
  Random random(6);
  long double balance = 0;
  double rounding = 0, peak = 0, worst = 0;
  const std::size_t before = allocations;
  for (int n = 0; n < 20000; ++n) {
    if (n % 1000 == 0) bowed.network.move_place(bowed.moving, T(random.between(0.05, 0.3) * bowed.kLength_m));
    bowed.tick(n > 15000 ? T(0) : T(random.decades(-3, 2)), T(random.between(-1, 1)));
    const auto& network = bowed.network;
    balance += static_cast<long double>(network.work()) - network.dissipated();
    peak = std::max(peak, network.energy());
    worst = std::max(worst, std::abs(static_cast<double>(network.energy() - balance)));
    for (const std::size_t k : network.solver().active()) {
      const double force = std::abs(network.solver()[k].force);
      rounding += double(std::numeric_limits<T>::epsilon()) * force *
                  (std::abs(double(network.solver()[k].free_increment)) + network.solver().receptance(k, k) * force);
    }
  }
  EXPECT_EQ(allocations, before);
  Measured() << "energy off by " << worst << " J, its peak " << peak << " J, " << worst / rounding
             << " eps times the sum of |f| (|xf| + xi |f|); bounded " << bowed.network.solver().bounded();
  EXPECT_TRUE(within(worst, 0, 8 * rounding));
  EXPECT_EQ(bowed.network.solver().bounded(), 0U);
  EXPECT_GT(peak, 1e-4);
}

}  // namespace
}  // namespace contactspline::testing
