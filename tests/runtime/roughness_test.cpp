// SPDX-License-Identifier: MIT
// Rough surfaces: their heights, and contacts that slide over them.
#include "contactspline/step/roughness.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "contactspline/network/contact_network.hpp"
#include "power_table.hpp"
#include "random_network.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

std::vector<double> heights(const Roughness& roughness, double step_m, std::size_t count, std::uint32_t number = 1) {
  RoughSurface<double> surface(roughness, number);
  std::vector<double> heights;
  for (std::size_t n = 0; n < count; ++n) {
    heights.push_back(surface.height());
    surface.go(step_m);
  }
  return heights;
}

// Power of a sequence at a frequency, in cycles of a sample, through a Hann window.
double power_at(const std::vector<double>& sequence, double frequency) {
  std::complex<double> sum = 0;
  const auto size = static_cast<double>(sequence.size());
  for (std::size_t n = 0; n < sequence.size(); ++n) {
    const auto t = static_cast<double>(n);
    const double window = 1 - std::cos(2 * std::numbers::pi * t / size);
    sum += window * sequence[n] * std::polar(1.0, -2 * std::numbers::pi * frequency * t);
  }
  return std::norm(sum / size);
}

TEST(RoughSurface, IsAWaveOfItsLengthIfPeriodic) {
  const auto found = heights({2e-5, 1e-3, true}, 3.7e-5, 1000);
  std::vector<double> expected;
  for (int n = 0; n < 1000; ++n) expected.push_back(2e-5 * std::sin(2 * std::numbers::pi * n * 3.7e-5 / 1e-3));
  EXPECT_TRUE(sequences_within<double>(found, expected, 1e-10));
}

TEST(RoughSurface, HasItsHeightAndComesBack) {
  RoughSurface<double> surface({2e-5, 1e-3, false}, 1);
  EXPECT_EQ(surface.height(), 0) << "where the way begins";
  const auto found = heights({2e-5, 1e-3, false}, 1e-5, 100000);
  EXPECT_LE(std::ranges::max(found), 2e-5);
  EXPECT_GE(std::ranges::min(found), -2e-5);
  EXPECT_GT(std::ranges::max(found), 1.99e-5);
  EXPECT_LT(std::ranges::min(found), -1.99e-5);
  surface.go(1e-5 * 777);
  EXPECT_TRUE(within(surface.height(), found[777], 1e-15)) << "in one step";
  surface.go(-1e-5 * 700);
  EXPECT_TRUE(within(surface.height(), found[77], 1e-15)) << "and back";
}

TEST(RoughSurface, HasHeightsOfItsOwn) {
  const auto first = heights({1, 1e-3, false}, 1e-4, 20000, 1), second = heights({1, 1e-3, false}, 1e-4, 20000, 2);
  double both = 0, power = 0;
  for (std::size_t n = 0; n < first.size(); ++n) both += first[n] * second[n], power += first[n] * first[n];
  EXPECT_LT(std::abs(both / power), 0.06) << "4000 heights: 4/sqrt(4000)";
}

// Random heights u at nodes at a distance d, mean square 1/3, between which w = 3 u^2 - 2 u^3 leads from one to the
// next, are a train of bumps: the power at the wavenumber k is d/3 times the square of the bump's transform,
// 12 [2 - 2 cos(kd) - kd sin(kd)]/(kd)^4.
TEST(RoughSurface, HasASpectrumThatEndsAtItsLength) {
  constexpr std::size_t kCount = 4096, kBins = 8, kBands = 30;  // 1/16 of a wave of the length each
  constexpr double kStep = 1.0 / 32, kNode = 0.5;
  std::vector<std::vector<double>> sequences;
  for (std::uint32_t number = 0; number < 24; ++number)
    sequences.push_back(heights({1, 2 * kNode, false}, kStep, kCount, number));
  double slowest = 0;
  for (std::size_t band = 1; band < kBands; ++band) {
    double found = 0, expected = 0;
    for (std::size_t bin = band * kBins; bin < (band + 1) * kBins; ++bin) {
      const double cycles = static_cast<double>(bin) / kCount;
      for (std::uint32_t number = 0; number < 24; ++number) found += power_at(sequences[number], cycles) / 24;
      const double kd = 2 * std::numbers::pi * cycles / kStep * kNode;
      const double bump = 12 * (2 - 2 * std::cos(kd) - kd * std::sin(kd)) / std::pow(kd, 4);
      expected += 1.5 * (kNode / kStep) / 3 * bump * bump / kCount;  // 1.5: the window
    }
    if (band == 1) slowest = found;
    if (expected > 1e-4 * slowest) {
      EXPECT_TRUE(within(10 * std::log10(found / expected), 0, 1.5)) << band;
    }
    if (band % 8 == 0)
      Measured() << "at " << static_cast<double>(band) / 16 << "/length " << 10 * std::log10(found / slowest)
                 << " dB";
    if (band >= 24) {
      EXPECT_LT(found, 0.03 * slowest) << band;  // 15 dB less beyond 1.5/length
    }
  }
}

// A mass that a spring presses on a rough surface, by a contact with a linear law that never opens.
struct Skate {
  static constexpr double kMass = 0.01, kSpring = 100, kContact = 4e4, kDamper = 4, kPressed = 1e-3;

  explicit Skate(const Roughness& roughness, double rate = kRate) : network(plan_of(roughness), rate) {}

  NetworkPlan<double> plan_of(const Roughness& roughness) {
    NetworkPlan<double> plan;
    const std::size_t place = plan.add_mass_place(plan.add_mass(kMass));
    contact = plan.add_contact(kGround, place, table, -kPressed);
    plan.roughen(contact, roughness);
    plan.add_spring(place, kGround, kSpring, kDamper);
    return plan;
  }

  Table table{{0, 0, 0, 0}, {0, 0, 0, kContact / 2}};
  std::size_t contact = 0;
  ContactNetwork<double> network;
};

// The gap is that of the file less the height, and the work is that of the force over it.
TEST(RoughContact, HasAGapThatFollowsTheSurface) {
  for (const bool is_periodic : {true, false}) {
    const Roughness roughness{1e-5, 1e-3, is_periodic};
    Skate skate(roughness);
    const auto expected = heights(roughness, 0.3 / kRate, 2000, static_cast<std::uint32_t>(skate.contact + 1));
    skate.network.set_surface_speed(skate.contact, 0.3);
    long double balance = skate.network.energy();
    double gap = skate.network.gap(skate.contact);
    for (std::size_t n = 1; n < expected.size(); ++n) {
      skate.network.tick();
      ASSERT_TRUE(within(skate.network.gap(skate.contact), -Skate::kPressed - expected[n], 1e-13)) << n;
      const double lift = gap - skate.network.gap(skate.contact);
      ASSERT_TRUE(within(skate.network.work(), skate.network.force(skate.contact) * lift, 1e-12)) << n;
      gap = skate.network.gap(skate.contact);
      balance += static_cast<long double>(skate.network.work()) - skate.network.dissipated();
    }
    EXPECT_TRUE(relatively_within(skate.network.energy(), static_cast<double>(balance), 1e-11));
  }
}

// A wave of the length l under the speed v moves the mass at the frequency v/l, as far as a base that moves so does:
// contact and spring are in parallel on the mass.
TEST(RoughContact, SoundsAtSpeedOverLength) {
  for (const double speed : {0.05, 0.1, 0.2}) {
    Skate skate({1e-6, 1e-3, true});
    skate.network.set_surface_speed(skate.contact, speed);
    std::vector<double> motion;
    for (int n = 0; n < 44100; ++n) {
      skate.network.tick();
      if (n >= 22050) motion.push_back(skate.network.displacement(0));
    }
    double mean = 0;
    for (const double x : motion) mean += x / static_cast<double>(motion.size());
    for (double& x : motion) x -= mean;
    const double frequency = speed / 1e-3, w = 2 * std::numbers::pi * frequency;
    const std::complex<double> stiffness(Skate::kContact + Skate::kSpring - Skate::kMass * w * w, Skate::kDamper * w);
    const double expected = 1e-6 * Skate::kContact / std::abs(stiffness);
    EXPECT_TRUE(relatively_within(2 * std::sqrt(power_at(motion, frequency / kRate)), expected, 2e-3)) << speed;
    EXPECT_LT(power_at(motion, 2.5 * frequency / kRate), 1e-8 * expected * expected) << speed;
  }
}

// Up to which frequency half of the power of a force lies [Hz].
double median_frequency(double speed, double length) {
  Skate skate({1e-7, length, false});
  skate.network.set_surface_speed(skate.contact, speed);
  std::vector<double> gaps;
  for (int n = 0; n < 32768; ++n) {
    skate.network.tick();
    gaps.push_back(skate.network.gap(skate.contact) + Skate::kPressed);
  }
  std::vector<double> sums(1);
  for (int band = 0; band < 800; ++band) sums.push_back(sums.back() + power_at(gaps, (10.0 * band + 5) / kRate));
  const auto half = std::ranges::lower_bound(sums, sums.back() / 2);
  return 10.0 * static_cast<double>(half - sums.begin());
}

TEST(RoughContact, HasABandwidthOfSpeedOverLength) {
  const double once = median_frequency(0.5, 5e-4), twice = median_frequency(1, 5e-4);
  const double shorter = median_frequency(0.5, 2.5e-4);
  Measured() << "half of the power lies below " << once << " Hz at 0.5 m/s over 0.5 mm, " << twice << " Hz at 1 m/s";
  EXPECT_TRUE(relatively_within(twice / once, 2, 0.15));
  EXPECT_TRUE(relatively_within(shorter / once, 2, 0.15));
}

TEST(RoughContact, OfNoHeightIsASmoothOne) {
  Skate smooth({}), flat({0, 1e-4, false});
  flat.network.set_surface_speed(flat.contact, 3);
  for (Skate* skate : {&smooth, &flat}) skate->network.set_motion(0, 1e-4, 1);
  for (int n = 0; n < 2000; ++n) {
    smooth.network.tick(), flat.network.tick();
    ASSERT_EQ(smooth.network.force(0), flat.network.force(0)) << n;
  }
}

TEST(RoughContact, BeginsAnewAtReset) {
  Skate skate({1e-5, 1e-3, false});
  std::vector<double> first;
  for (const bool again : {false, true}) {
    skate.network.set_surface_speed(skate.contact, 0.3);
    for (int n = 0; n < 500; ++n) {
      skate.network.tick();
      if (!again) first.push_back(skate.network.force(0));
      ASSERT_EQ(skate.network.force(0), first[static_cast<std::size_t>(n)]) << n;
    }
    EXPECT_FALSE(skate.network.is_following()) << "a surface that slides on keeps nothing awake";
    skate.network.reset();
  }
  skate.network.set_surface_speed(skate.contact, 0);
  for (int n = 0; n < 10; ++n) skate.network.tick();
  EXPECT_FALSE(skate.network.is_following());
}

// Where bodies stretch, forces act on two samples, of which the first one of a reset lies before it.
TEST(RoughContact, BeginsAnewAtResetWhereABodyStretches) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    RandomNetwork random(seed, false, true);
    for (std::size_t k = 0; k < random.plan.connections().size(); ++k)
      if (!random.plan.connections()[k].table.empty()) random.plan.roughen(k, {1e-4, 1e-3, true});
    auto network = random.network(CoupledContacts<double>::kMaxSteps);
    network.reset();
    std::vector<double> first;
    for (const bool again : {false, true}) {
      for (std::size_t k = 0; k < random.plan.connections().size(); ++k)
        if (!random.plan.connections()[k].table.empty()) network.set_surface_speed(k, 1);
      for (std::size_t n = 0; n < 300; ++n) {
        for (std::size_t p = 0; p < random.plan.places().size() && n < 10; ++p) network.push(p, 1);
        network.tick();
        if (!again) first.push_back(network.energy());
        ASSERT_EQ(network.energy(), first[n]) << "network " << seed << ", sample " << n;
      }
      network.reset();
    }
    EXPECT_GT(std::ranges::max(first), 0) << "network " << seed;
  }
}

// A finger on a wound string: the way over the windings is that of the place.
TEST(RoughContact, FollowsAPlaceThatMoves) {
  constexpr std::size_t kModes = 10;
  const Table table = power_table(1e5, 1.5, 1e-3);
  const Roughness windings{1e-5, 4e-3, true};
  NetworkPlan<double> plan;
  const std::size_t string = plan.add_body(string_modes(100, kModes, 0.01));
  std::vector<double> wavenumbers;
  for (std::size_t n = 1; n <= kModes; ++n) wavenumbers.push_back(std::numbers::pi * static_cast<double>(n));
  const std::size_t touched = plan.add_moving_place(string, wavenumbers, 0.3);
  const std::size_t contact = plan.add_contact(touched, kGround, table, -1e-4);
  plan.roughen(contact, windings);
  ContactNetwork<double> network(plan, kRate);
  long double balance = network.energy();
  double peak = 0;
  for (int n = 0; n < 20000; ++n) {
    const double before = network.place_m(touched) - 0.3;
    network.move_place(touched, 0.3 + 0.1 * std::sin(n / 3000.0));
    network.tick();
    balance += static_cast<long double>(network.work()) - network.dissipated();
    peak = std::max(peak, network.energy());
    const double height = 1e-5 * std::sin(2 * std::numbers::pi * before / 4e-3);
    ASSERT_TRUE(within(network.gap(contact), -1e-4 - height, 1e-12)) << n;
    ASSERT_TRUE(within(network.energy(), static_cast<double>(balance), 1e-11 * peak)) << n;
  }
  EXPECT_GT(network.force(contact), 0);
}

// Surfaces that slide at any speed, on networks of bodies that stretch or do not, with memories or without. rounding:
// eps times the sum of |f| (|xf| + xi |f|), of what the solver rounds.
TEST(RoughContact, BalancesTheEnergyOfRandomNetworks) {
  double worst = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    RandomNetwork random(seed, seed % 3 == 1, seed % 3 == 2);
    std::vector<std::size_t> rough;
    for (std::size_t k = 0; k < random.plan.connections().size(); ++k)
      if (!random.plan.connections()[k].table.empty()) rough.push_back(k);
    for (const std::size_t k : rough)
      random.plan.roughen(k,
                          {random.random.decades(-6, -3), random.random.decades(-5, -1), random.random.once_in(2)});
    auto network = random.network(CoupledContacts<double>::kMaxSteps);
    long double balance = network.energy();
    double peak = network.energy(), error = 0, rounding = 0;
    for (int n = 0; n < 2000; ++n) {
      for (const std::size_t k : rough)
        if (random.random.once_in(50))
          network.set_surface_speed(k, random.random.sign() * random.random.decades(-3, 3));
      network.tick();
      balance += static_cast<long double>(network.work()) - network.dissipated();
      peak = std::max(peak, network.energy());
      const double off = std::abs(network.energy() - static_cast<double>(balance));
      error = is_finite(off) ? std::max(error, off) : off;
      for (const std::size_t k : network.solver().active()) {
        const double force = std::abs(network.solver()[k].force);
        rounding += std::numeric_limits<double>::epsilon() * force *
                    (std::abs(network.solver()[k].free_increment) + network.solver().receptance(k, k) * force);
      }
    }
    EXPECT_TRUE(within(error, 0, 1e-12 * peak + 8 * rounding)) << "network " << seed;
    worst = std::max(worst, error / (1e-12 * peak + 8 * rounding));
  }
  Measured() << "largest error of the energy: " << worst << " of its bound";
}

}  // namespace
}  // namespace contactspline::testing
