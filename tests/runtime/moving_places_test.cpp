// SPDX-License-Identifier: MIT
// Places of a network that move along a string: energy, and motion against a closed form and a model by hand.
#include <numbers>

#include "contactspline/models/fret_string.hpp"
#include "contactspline/network/contact_network.hpp"
#include "power_table.hpp"
#include "random_network.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

std::vector<double> wavenumbers(std::size_t count) {
  std::vector<double> numbers;
  for (std::size_t i = 1; i <= count; ++i) numbers.push_back(std::numbers::pi * double(i));  // a string of 1 m
  return numbers;
}

// Strings and masses, joined by contacts, springs and dampers at places that move at random.
struct RandomMovers {
  explicit RandomMovers(unsigned seed) : random(seed) {
    rate = std::vector<double>{22050, 44100, 96000, 192000}[random.below(4)];
    for (std::size_t b = 0; b < 2 + random.below(4); ++b) {
      if (random.below(2) == 0) {
        plan.add_mass_place(plan.add_mass(random.log_between(1e-4, 1)));
        continue;
      }
      const std::size_t modes = 4 + random.below(20);
      const std::size_t string =
          plan.add_body(string_modes(random.log_between(30, 500), modes, random.log_between(1e-3, 0.1)));
      for (std::size_t p = 0; p < 1 + random.below(4); ++p) {
        if (random.below(4) == 0) {
          plan.add_place(string, string_shapes(modes, random.between(0.01, 0.99)));
        } else {
          movers.push_back(plan.add_moving_place(string, wavenumbers(modes), random.between(0.01, 0.99)));
        }
      }
    }
    const std::size_t count = 1 + random.below(20);
    tables.reserve(count);
    for (std::size_t k = 0; k < count; ++k) connect();
  }

  void connect() {
    const std::size_t places = plan.places().size(), first = random.below(places);
    std::size_t second = random.below(places + 1);
    if (second == first || second == places) second = kGround;
    if (random.below(4) == 0) {
      const double stiffness = random.log_between(10, 1e6), resistance = random.log_between(1e-3, 10);
      plan.add_spring(first, second, stiffness, resistance);
      return;
    }
    const double exponent = random.between(1.01, 3), stiffness = random.log_between(1e4, 1e11);
    tables.push_back(power_table(stiffness, exponent, 1e-4));
    const double gap = random.between(0, 1e-3), loss = random.below(3) == 0 ? random.between(0, 1) : 0.0;
    plan.add_contact(first, second, tables.back(), gap, {1, loss});
  }

  Random random;
  double rate;
  NetworkPlan<double> plan;
  std::vector<Table> tables;
  std::vector<std::size_t> movers;
};

// Shapes of multiples of a wavenumber, rounded to 13 digits as in files, against sines in extended precision. In n/4
// rotations and an angle of n x, the errors are at most a few roundings of n (1 + x). Wavenumbers in single precision
// would lose more.
template <typename T>
void expect_sines_of_multiples() {
  constexpr std::size_t kModes = 403;
  std::vector<double> numbers = wavenumbers(kModes);
  for (double& number : numbers) {
    const double unit = std::pow(10, std::floor(std::log10(number)) - 12);
    number = std::round(number / unit) * unit;
  }
  const StringShapes<T> string{std::span<const double>(numbers)};
  ModeShapes<T> shapes(kModes);
  Random random(7);
  double worst = 0;
  for (int i = 0; i < 200; ++i) {
    const T x = static_cast<T>(i == 0 ? 0.0 : i == 1 ? 1.0 : random.between(0, 1));
    string.at(x, shapes);
    for (std::size_t n = 1; n <= kModes; ++n) {
      const long double angle = static_cast<long double>(numbers[n - 1]) * static_cast<long double>(x);
      const double error = double(std::abs(static_cast<long double>(shapes[n - 1]) - std::sin(angle)));
      const double bound = double(std::numeric_limits<T>::epsilon()) +
                           double(n) * (2 + std::numbers::pi * double(x)) * std::numeric_limits<double>::epsilon();
      if (!(error / bound <= worst)) worst = error / bound;
    }
  }
  Measured() << worst << " of the bound";
  EXPECT_LE(worst, 1);
}

TEST(StringShapes, OfMultiplesAreSines) {
  expect_sines_of_multiples<double>();
  expect_sines_of_multiples<float>();
}

// A wavenumber that is no multiple takes a sine for each mode.
TEST(StringShapes, OfOtherWavenumbersAreSines) {
  std::vector<double> numbers = wavenumbers(20);
  numbers[6] *= 1 + 1e-9;
  ModeShapes<double> shapes(20);
  StringShapes<double>{std::span<const double>(numbers)}.at(0.37, shapes);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(shapes[i], std::sin(numbers[i] * 0.37)) << i;
}

// 100 random networks whose places move, at 1 m/s on average. A place may reach the ends of its string, where it
// cannot be pushed.
TEST(MovingPlaces, BalanceTheEnergyWithTheWorkOfTheirHands) {
  double worst = 0, moved_j = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomMovers random(seed);
    ContactNetwork<double> network(random.plan, random.rate);
    for (std::size_t b = 0; b < random.plan.bodies().size(); ++b)
      network.set_motion(b, 0, random.random.between(-2, 2));
    double peak = network.energy(), largest = 0;
    long double balance = peak;
    for (int n = 0; n < 3000; ++n) {
      if (n % 500 == 0)
        for (const std::size_t place : random.movers) network.move_place(place, random.random.between(-0.1, 1.1));
      const std::size_t before = allocations;
      network.tick();
      ASSERT_EQ(allocations, before);
      moved_j += std::abs(network.work());
      balance += static_cast<long double>(network.work()) - network.dissipated();
      peak = std::max(peak, network.energy());
      const double error = std::abs(static_cast<double>(network.energy() - balance));
      if (!(error <= largest)) largest = error;
    }
    EXPECT_TRUE(within(largest, 0, 1e-12 * peak)) << "network " << seed;
    EXPECT_EQ(network.solver().bounded(), 0U) << "network " << seed;
    worst = std::max(worst, largest / peak);
  }
  EXPECT_GT(moved_j, 1);
  Measured() << "largest error of the energy, over its peak: " << worst;
}

// A constant force that moves along a string: F sin(W t + p) on each mode, W = beta v. The error falls to a quarter
// at twice the rate.
TEST(MovingPlaces, CarryAForceAsTheClosedFormDoes) {
  constexpr double kSpeed = 5, kForce = 2, kMass = 1e-3, kStart = 0.1, kTime = 0.1;
  constexpr std::size_t kModes = 8;
  std::vector<Mode> modes;
  for (std::size_t i = 1; i <= kModes; ++i) modes.push_back({2 * std::numbers::pi * 60 * double(i), 0, kMass});
  const auto error_at = [&](double rate) {
    NetworkPlan<double> plan;
    const std::size_t place = plan.add_moving_place(plan.add_body(modes), wavenumbers(kModes), kStart);
    ContactNetwork<double> network(plan, rate);
    const int samples = static_cast<int>(kTime * rate);
    for (int n = 0; n < samples; ++n) {
      network.move_place(place, kStart + kSpeed * (n + 1) / rate);
      network.push(place, kForce);
      network.tick();
    }
    double largest = 0;
    const double t = samples / rate;
    for (std::size_t i = 0; i < kModes; ++i) {
      const double beta = std::numbers::pi * double(i + 1), w = modes[i].angular_frequency_rad_per_s;
      const double moved = beta * kSpeed, phase = beta * kStart;
      const double expected = kForce / kMass / (w * w - moved * moved) *
                              (std::sin(moved * t + phase) - std::cos(w * t) * std::sin(phase) -
                               moved / w * std::cos(phase) * std::sin(w * t));
      largest = std::max(largest, std::abs(network.body(0).displacement(i) - expected));
    }
    return largest / (kForce / kMass / std::pow(modes[0].angular_frequency_rad_per_s, 2));
  };
  const double coarse = error_at(44100), fine = error_at(88200);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_TRUE(within(fine / coarse, 0.25, 0.02));
}

struct FretRun {
  std::vector<double> forces, displacements;
  std::size_t sleeping = 0;  // contacts, summed over the samples
};
struct FretMotion {
  double from_m, speed_m_per_s;
};

// A string that swings over a fret for 45 ms, by the network or by the model by hand.
FretRun play_fret(const FretMotion& motion, bool by_hand, double rate = kRate) {
  constexpr std::size_t kModes = 30;
  const Table table = power_table(1e5, 1.5, 1e-3);
  const auto modes = string_modes(150, kModes, 2e-3);
  const auto numbers = wavenumbers(kModes);
  const auto place_at = [&](int n) { return motion.from_m + motion.speed_m_per_s * (n + 1) / rate; };
  NetworkPlan<double> plan;
  const std::size_t string = plan.add_body(modes), plucked = plan.add_place(string, string_shapes(kModes, 0.3));
  const std::size_t over_fret = plan.add_moving_place(string, numbers, place_at(-1));
  plan.add_contact(over_fret, kGround, table, 1e-4);
  ContactNetwork<double> network(plan, rate);
  FretString<double> model(table, modes, StringShapes<double>(std::span<const double>(numbers)), 0.3, rate);
  model.place(place_at(-1), 1e-4);
  const ModeShapes<double> pickup(string_shapes(kModes, 0.3));
  FretRun run;
  for (int n = 0; n < 0.045 * rate; ++n) {
    const double push = n < 0.003 * rate ? 500 * n / rate : 0;
    if (by_hand) {
      model.tick({.place_m = place_at(n), .gap_m = 1e-4, .pluck_force_n = push});
      run.forces.push_back(model.force());
      run.displacements.push_back(model.string().displacement(pickup));
    } else {
      network.move_place(over_fret, place_at(n));
      network.push(plucked, push);
      network.tick();
      run.forces.push_back(network.force(0));
      run.displacements.push_back(network.displacement(plucked));
      run.sleeping += network.sleeping();
    }
  }
  return run;
}

TEST(MovingPlaces, AtRestAreThoseOfTheModelByHand) {
  const FretRun network = play_fret({0.6, 0}, false), model = play_fret({0.6, 0}, true);
  EXPECT_TRUE(sequences_within<double>(network.forces, model.forces, 1e-9));
  EXPECT_TRUE(sequences_within<double>(network.displacements, model.displacements, 1e-9));
}

// Largest difference of the string's motion between network and model, over its largest displacement.
double difference_from_model(const FretMotion& motion, double rate) {
  const FretRun network = play_fret(motion, false, rate), model = play_fret(motion, true, rate);
  EXPECT_GT(std::ranges::max(model.forces), 0.1);
  double difference = 0, size = 0;
  for (std::size_t n = 0; n < model.forces.size(); ++n) {
    const double error = std::abs(network.displacements[n] - model.displacements[n]);
    if (!(error <= difference)) difference = error;
    size = std::max(size, std::abs(model.displacements[n]));
  }
  return difference / size;
}

// Within a sample the network extrapolates the middle displacement, which the model knows: their difference is of
// order 3.
TEST(MovingPlaces, InMotionAreThoseOfTheModelByHand) {
  const double coarse = difference_from_model({0.5, 2}, 44100), fine = difference_from_model({0.5, 2}, 88200);
  EXPECT_LT(coarse, 1e-6);
  EXPECT_TRUE(within(fine / coarse, 1.0 / 8, 0.02));
}

// The fret begins near the end of the string, where the contact sleeps, and moves under the string at 10 m/s.
TEST(MovingPlaces, WakeTheirContacts) {
  EXPECT_GT(play_fret({0.01, 10}, false).sleeping, 50U);
  const double coarse = difference_from_model({0.01, 10}, 44100), fine = difference_from_model({0.01, 10}, 88200);
  EXPECT_LT(coarse, 1e-5);
  EXPECT_TRUE(within(fine / coarse, 1.0 / 8, 0.02));
}

// A place waits only under friction that is lifted, and is where its control is once that presses.
TEST(MovingPlaces, WaitUnderLiftedFrictionAlone) {
  constexpr std::size_t kModes = 10;
  NetworkPlan<double> plan;
  const std::size_t string = plan.add_body(string_modes(100, kModes, 0.01));
  const std::size_t heard = plan.add_moving_place(string, wavenumbers(kModes), 0.4);
  const std::size_t bowed = plan.add_moving_place(string, wavenumbers(kModes), 0.4);
  const std::size_t bow = plan.add_friction(kGround, bowed, kRosin, 0.01);
  ContactNetwork<double> network(plan, kRate);
  for (const std::size_t place : {heard, bowed}) network.move_place(place, 0.6);
  for (int n = 0; n < 44100; ++n) network.tick();
  EXPECT_EQ(network.place_m(heard), 0.6);
  EXPECT_EQ(network.place_m(bowed), 0.4);
  network.set_normal_force(bow, 0.5);
  network.tick();
  EXPECT_EQ(network.place_m(bowed), 0.6);
}

TEST(MovingPlaces, ArePutElsewhereWithoutMotion) {
  const Table table = power_table(1e5, 1.5, 1e-3);
  const auto compression_at = [&](bool is_put) {
    NetworkPlan<double> plan;
    const std::size_t string = plan.add_body(string_modes(150, 10, 2e-3));
    const std::size_t place = plan.add_moving_place(string, wavenumbers(10), is_put ? 0.1 : 0.4);
    plan.add_contact(place, kGround, table, 1e-4);
    ContactNetwork<double> network(plan, kRate);
    network.set_motion(string, 2e-4, 1);
    if (is_put) network.put_place(place, 0.4);
    for (int n = 0; n < 50; ++n) network.tick();
    return network.compression(0);
  };
  EXPECT_TRUE(relatively_within(compression_at(true), compression_at(false), 1e-12));
}

}  // namespace
}  // namespace contactspline::testing
