// SPDX-License-Identifier: MIT
// Several contacts at once: the solver against nested bisection, networks by their energy and by independent paths.
#include <functional>
#include <numbers>
#include <random>
#include <type_traits>
#include <utility>

#include "contactspline/contact_network.hpp"
#include "contactspline/hammer_string.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"

namespace contactspline::testing {
namespace {

using Table = std::vector<Segment<double>>;

// Quadratic pieces whose forces at the knots are those of k y^a; beyond the last knot the last piece goes on.
template <typename T = double>
std::vector<Segment<T>> power_table(double k, double a, double max_compression, int segments = 24) {
  std::vector<Segment<T>> table(1, {0, 0, 0, 0});
  double energy = 0;
  for (int j = 0; j < segments; ++j) {
    const double from = max_compression * std::pow(double(j) / segments, 2);
    const double to = max_compression * std::pow(double(j + 1) / segments, 2);
    const double f0 = k * std::pow(from, a), f1 = k * std::pow(to, a);
    table.push_back({static_cast<T>(from), static_cast<T>(energy), static_cast<T>(f0),
                     static_cast<T>((f1 - f0) / (to - from) / 2)});
    energy += (f0 + f1) / 2 * (to - from);
  }
  return table;
}

struct Random {
  explicit Random(unsigned seed) : engine(seed) {}
  double between(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine); }
  double log_between(double a, double b) { return std::exp(between(std::log(a), std::log(b))); }
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(engine); }
  std::mt19937_64 engine;
};

// Up to eight quadratic pieces, each stiffer or softer than the one before.
Table uneven_table(Random& random) {
  Table table(1, {0, 0, 0, 0});
  double knot = 0, energy = 0, force = 0;
  for (std::size_t pieces = 1 + random.below(8); pieces > 0; --pieces) {
    const double length = random.log_between(1e-7, 1e-4), half_curvature = random.log_between(1e3, 1e12);
    table.push_back({knot, energy, force, half_curvature});
    energy += length * (force + half_curvature * length);
    force += 2 * half_curvature * length;
    knot += length;
  }
  return table;
}

enum class Law { power, uneven };

// n contacts on a body of some modes: their admittances are positive definite and strongly coupled.
struct Problem {
  Problem(Random& random, std::size_t n, Law law = Law::power) : admittance(n, std::vector<double>(n)) {
    std::vector<std::vector<double>> shapes(n, std::vector<double>(6));
    for (auto& row : shapes)
      for (double& shape : row) shape = random.between(-1, 1);
    const double scale = random.log_between(1e-9, 1e-5);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t m = 0; m < 6; ++m) admittance[i][j] += scale * shapes[i][m] * shapes[j][m];
    for (std::size_t i = 0; i < n; ++i) {
      const double exponent = random.between(1, 3), stiffness = random.log_between(1e4, 1e12);
      tables.push_back(law == Law::power ? power_table(stiffness, exponent, 1e-3) : uneven_table(random));
      compression.push_back(random.between(-3e-4, 5e-4));
      free_increment.push_back(random.between(-1e-3, 1e-3));
      controls.push_back({random.log_between(0.1, 10), random.below(2) != 0 ? random.between(0, 1) : 0.0});
    }
  }

  [[nodiscard]] std::size_t size() const { return tables.size(); }

  void put_into(CoupledContacts<double>& solver) const {
    solver.begin();
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t j = 0; j < size(); ++j) solver.set_admittance(i, j, admittance[i][j]);
      solver[i].table = tables[i];
      solver[i].contact = controls[i];
      solver[i].compression = compression[i];
      solver[i].free_increment = free_increment[i];
      solver[i].segment = segment_index(SegmentTable<double>(tables[i]), compression[i]);
    }
    for (std::size_t i = 0; i < size(); ++i) solver.add(i);
  }

  std::vector<std::vector<double>> admittance;
  std::vector<Table> tables;
  std::vector<ContactControls<double>> controls;
  std::vector<double> compression, free_increment;
};

constexpr double kRate = 44100;

// Potential and its derivative in long double, by a plain search.
std::pair<long double, long double> plain_potential(const Table& table, long double y) {
  std::size_t j = 0;
  for (std::size_t k = 1; k < table.size() && table[k].knot <= y; ++k) j = k;
  const long double t = y - table[j].knot, c = table[j].half_curvature;
  return {table[j].energy + t * (table[j].force + t * c), table[j].force + 2 * t * c};
}

// The force of contact i for the increment x: its definition.
long double plain_force(const Problem& p, std::size_t i, long double x) {
  const long double y0 = p.compression[i], ratio = p.controls[i].stiffness_ratio;
  const auto [before, slope] = plain_potential(p.tables[i], y0);
  const auto [after, slope_after] = plain_potential(p.tables[i], y0 + x);
  const long double elastic = std::abs(x) > 1e-13L ? (after - before) / x : (slope + slope_after) / 2;
  const long double viscous = p.controls[i].loss_s_per_m * ratio * kRate * slope * x;
  return std::max(0.0L, ratio * elastic + viscous);
}

// Forces by bisection for the last contact, within bisection for the one before, and so on: each residual rises with
// its force, because the matrix of admittances is positive definite.
void bisect(const Problem& p, std::size_t i, std::vector<long double>& forces) {
  if (i == p.size()) return;
  const auto residual = [&](long double force) {
    forces[i] = force;
    for (std::size_t j = i + 1; j < p.size(); ++j) forces[j] = 0;
    bisect(p, i + 1, forces);
    long double x = p.free_increment[i];
    for (std::size_t j = 0; j < p.size(); ++j) x -= p.admittance[i][j] * forces[j];
    return force - plain_force(p, i, x);
  };
  long double low = 0, high = 1;
  while (residual(high) < 0) high *= 2;
  for (int n = 0; n < 62 && low < high; ++n) {
    const long double middle = (low + high) / 2;
    (residual(middle) < 0 ? low : high) = middle;
  }
  residual((low + high) / 2);
}

template <typename T>
class OneContact : public ::testing::Test {};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(OneContact, Precisions);

// A contact that is alone computes the bits of contact_step, beside others that it is not coupled with too.
TYPED_TEST(OneContact, IsTheContactStep) {
  using T = TypeParam;
  constexpr T kRounding = (kCopiesRoundAlike ? 0 : 32) * std::numeric_limits<T>::epsilon();
  Random random(1);
  const auto table = power_table<T>(1e9, 1.5, 1e-3);
  CoupledContacts<T> solver(3, kRate);
  for (std::size_t i = 0; i < 3; ++i) solver[i].table = table;
  int touching = 0;
  for (int n = 0; n < 100000; ++n) {
    solver.begin();
    std::vector<ContactStep<T>> expected;
    std::vector<T> before;
    for (std::size_t i = 0; i < 3; ++i) {
      CoupledConnection<T>& c = solver[i];
      solver.set_admittance(i, i, static_cast<T>(random.log_between(1e-12, 1e-4)));
      c.contact = {static_cast<T>(random.log_between(0.1, 10)), random.below(2) != 0 ? T(0.3) : T(0)};
      c.compression = static_cast<T>(random.between(-1e-4, 1e-3));
      c.free_increment = static_cast<T>(random.between(-1e-3, 1e-3));
      c.segment = segment_index(c.table, c.compression);
      before.push_back(c.compression);
      expected.push_back(
          contact_step(c.table, c.contact, T(1 / kRate), {c.compression, c.free_increment, solver.admittance(i, i)}));
      solver.add(i);
    }
    solver.solve();
    solver.advance();
    for (std::size_t i = 0; i < 3; ++i) {
      const T motion = std::abs(before[i]) + std::abs(solver[i].free_increment);
      const T force = std::abs(expected[i].force) + motion / solver.admittance(i, i);
      ASSERT_TRUE(within(solver[i].force, expected[i].force, kRounding * force)) << n;
      ASSERT_TRUE(within(solver[i].compression, expected[i].compression, kRounding * motion)) << n;
      ASSERT_EQ(solver[i].segment, segment_index(solver[i].table, solver[i].compression)) << n;
      touching += expected[i].force > 0;
    }
    ASSERT_EQ(solver.steps(), 0);
  }
  EXPECT_GT(touching, 100000);
}

void expect_agreement_with_bisection(std::size_t contacts, int problems,
                                     int patience = CoupledContacts<double>::kPatience, Law law = Law::power) {
  Random random(2);
  CoupledContacts<double> solver(contacts, kRate, CoupledContacts<double>::kMaxSteps, patience);
  int coupled = 0;
  for (int n = 0; n < problems; ++n) {
    const Problem problem(random, contacts, law);
    std::vector<long double> expected(contacts);
    bisect(problem, 0, expected);
    problem.put_into(solver);
    solver.solve();
    coupled += solver.steps() > 0;
    const double largest = static_cast<double>(*std::ranges::max_element(expected));
    const double bound =
        std::max(1e-10 * largest, 1e-18);  // bisection leaves 1e-19 N of a contact that does not touch
    for (std::size_t i = 0; i < contacts; ++i)
      ASSERT_TRUE(within(solver[i].force, static_cast<double>(expected[i]), bound))
          << "problem " << n << ", contact " << i;
    EXPECT_EQ(solver.bounded(), 0U);
  }
  EXPECT_GT(coupled, problems / 4);
}

TEST(CoupledContacts, AgreesWithBisectionForTwo) {
  expect_agreement_with_bisection(2, 1000);
}
TEST(CoupledContacts, AgreesWithBisectionForThree) {
  expect_agreement_with_bisection(3, 30);
}

// Newton's method on the convex merit, which takes over where the quicker steps fail, finds the same forces by
// itself.
TEST(CoupledContacts, AgreesWithBisectionIfEachStepLowersTheMerit) {
  expect_agreement_with_bisection(2, 1000, -1);
  expect_agreement_with_bisection(3, 30, -1);
}

// Contacts that become softer: full steps of Newton's method overshoot, and do not converge in more than a quarter of
// such problems.
TEST(CoupledContacts, AgreesWithBisectionWhereContactsSoften) {
  expect_agreement_with_bisection(2, 1000, -1, Law::uneven);
  expect_agreement_with_bisection(2, 1000, CoupledContacts<double>::kPatience, Law::uneven);
}

// Two problems without admittance between them give the bits that each gives alone.
TEST(CoupledContacts, SolvesIndependentGroupsApart) {
  Random random(3);
  for (int n = 0; n < 1000; ++n) {
    const Problem a(random, 3), b(random, 4);
    CoupledContacts<double> of_a(3, kRate), of_b(4, kRate), both(7, kRate);
    a.put_into(of_a);
    b.put_into(of_b);
    both.begin();
    for (std::size_t i = 0; i < 7; ++i)
      for (std::size_t j = 0; j < 7; ++j)
        both.set_admittance(i, j,
                            i < 3 && j < 3     ? a.admittance[i][j]
                            : i >= 3 && j >= 3 ? b.admittance[i - 3][j - 3]
                                               : 0);
    for (std::size_t i = 0; i < 7; ++i) {
      both[i] = i < 3 ? of_a[i] : of_b[i - 3];
      both.add(i);
    }
    of_a.solve();
    of_b.solve();
    both.solve();
    for (std::size_t i = 0; i < 7; ++i) ASSERT_EQ(both[i].force, i < 3 ? of_a[i].force : of_b[i - 3].force) << n;
  }
}

// The bounding law begins where the forces of the sample before would move the contacts of this one.
TEST(CoupledContacts, BoundsEachSampleByItself) {
  Random random(5);
  CoupledContacts<double> used(3, kRate, 0);
  for (int n = 0; n < 1000; ++n) {
    const Problem problem(random, 3);
    CoupledContacts<double> fresh(3, kRate, 0);
    for (auto* solver : {&used, &fresh}) {
      problem.put_into(*solver);
      for (std::size_t i = 0; i < 3; ++i) (*solver)[i].force = 0;
      solver->solve();
    }
    for (std::size_t i = 0; i < 3; ++i) ASSERT_EQ(used[i].force, fresh[i].force) << n;
  }
  EXPECT_GT(used.bounded(), 300U);
}

// Motions near the smallest numbers, which round to multiples of them, are solved like any other.
TEST(CoupledContacts, SolvesTheSmallestMotions) {
  Random random(4);
  const Problem problem(random, 3);
  for (const double scale : {1e-290, 1e-300, 1e-305, 1e-310, 1e-320}) {
    CoupledContacts<double> solver(3, kRate);
    problem.put_into(solver);
    solver.begin();
    for (std::size_t i = 0; i < 3; ++i) {
      solver[i].compression = scale;
      solver[i].segment = 1;
      solver[i].free_increment = 0.7 * scale;
      solver.add(i);
    }
    solver.solve();
    EXPECT_EQ(solver.bounded(), 0U) << scale;
    EXPECT_LE(solver.steps(), 10) << scale;
  }
}

// A random network: masses and modal bodies, contacts of 8 decades of stiffness, springs, dampers and rigid links.
struct RandomNetwork {
  explicit RandomNetwork(unsigned seed) : random(seed) {
    rate = std::vector<double>{22050, 44100, 96000, 192000}[random.below(4)];
    const std::size_t bodies = 2 + random.below(7), count = 1 + random.below(40);
    for (std::size_t b = 0; b < bodies; ++b) {
      if (random.below(2) == 0) {
        plan.add_mass_place(plan.add_mass(random.log_between(1e-4, 1)));
        continue;
      }
      std::vector<Mode> modes;
      const double f0 = random.log_between(30, 1000), mass = random.log_between(1e-3, 0.1);
      for (std::size_t i = 1; i <= 4 + random.below(20); ++i)
        modes.push_back({2 * std::numbers::pi * f0 * double(i), random.between(0, 20), mass});
      const std::size_t body = plan.add_body(modes);
      for (std::size_t p = 0; p < 1 + random.below(8); ++p) {
        std::vector<double> shapes;
        const double place = random.between(0.01, 0.99);
        for (std::size_t i = 1; i <= modes.size(); ++i)
          shapes.push_back(std::sin(std::numbers::pi * double(i) * place));
        plan.add_place(body, shapes);
      }
    }
    tables.reserve(count);
    for (std::size_t k = 0; k < count; ++k) connect();
  }

  void connect() {
    const std::size_t places = plan.places().size();
    std::size_t first = random.below(places), second = random.below(places + 1);
    if (second == first || second == places) second = kGround;
    if (second != kGround && random.below(2) == 0) std::swap(first, second);
    switch (random.below(8)) {
      case 0:
        plan.add_spring(first, second, random.log_between(10, 1e7));
        return;
      case 1: {
        const double resistance = random.log_between(1e-3, 10), stiffness = random.log_between(10, 1e5);
        plan.add_spring(first, second, stiffness, resistance);
        return;
      }
      case 2:
        if (second != kGround) {
          plan.add_rigid_link(first, second);
          return;
        }
        [[fallthrough]];
      default:
        const double exponent = random.between(1.01, 3), stiffness = random.log_between(1e4, 1e12);
        tables.push_back(power_table(stiffness, exponent, 1e-4));
        const double loss = random.below(3) == 0 ? random.between(0, 1) : 0.0, gap = random.between(0, 1e-3);
        plan.add_contact(first, second, tables.back(), gap, {1, loss});
    }
  }

  [[nodiscard]] ContactNetwork<double> network(int max_steps) {
    ContactNetwork<double> network(plan, rate, max_steps);
    for (std::size_t b = 0; b < plan.bodies().size(); ++b) network.set_motion(b, 0, random.between(-2, 2));
    return network;
  }

  Random random;
  double rate;
  NetworkPlan<double> plan;
  std::vector<Table> tables;
};

// What a run of a network shows of its energy.
struct Books {
  double peak = 0;
  double worst = 0;   // largest |stored + dissipated - work - stored at first|
  double gained = 0;  // largest energy gained over a sample beyond what balances
  std::size_t coupled = 0;
};

Books books_of(RandomNetwork& random_network, ContactNetwork<double>& network, int samples) {
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
    const Books books = books_of(random_network, network, 3000);
    EXPECT_TRUE(within(books.worst, 0, 1e-12 * books.peak)) << "network " << seed;
    EXPECT_EQ(network.solver().bounded(), 0U) << "network " << seed;
    worst = std::max(worst, books.worst / books.peak);
    coupled += books.coupled;
  }
  std::cout << "largest error of the energy, over its peak: " << worst << "\n";
  EXPECT_GT(coupled, 90000U);
}

// A solver that may take no step uses the bounding law wherever contacts are coupled: energy is lost, never gained.
TEST(ContactNetwork, GainsNoEnergyAtTheBound) {
  std::size_t bounded = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    RandomNetwork random_network(seed);
    auto network = random_network.network(0);
    const Books books = books_of(random_network, network, 1000);
    EXPECT_TRUE(is_finite(books.worst)) << "network " << seed;
    EXPECT_LE(books.gained, 1e-12 * books.peak) << "network " << seed;
    bounded += network.solver().bounded();
  }
  EXPECT_GT(bounded, 10000U);
}

std::vector<Mode> string_modes(double f0, std::size_t count, double modal_mass) {
  std::vector<Mode> modes;
  for (std::size_t i = 1; i <= count; ++i)
    modes.push_back({2 * std::numbers::pi * f0 * double(i), 0.5 + 5e-4 * double(i * i), modal_mass});
  return modes;
}

std::vector<double> string_shapes(std::size_t count, double place) {
  std::vector<double> shapes;
  for (std::size_t i = 1; i <= count; ++i) shapes.push_back(std::sin(std::numbers::pi * double(i) * place));
  return shapes;
}

// A string of 0.9 m plucked over a bridge that curves down from it over 20 mm.
template <typename T>
struct Tanpura {
  Tanpura(std::size_t points, double rate)
      : table(power_table<T>(5e10, 1.3, 1e-4)), network(plan_of(points), rate), rate_hz(rate) {}

  NetworkPlan<T> plan_of(std::size_t points) {
    NetworkPlan<T> plan;
    const std::size_t string = plan.add_body(string_modes(131, 120, 2.7e-4));
    pluck = plan.add_place(string, string_shapes(120, 0.3));
    std::vector<std::size_t> places;
    std::vector<double> gaps, lengths(points, 0.02 / double(points));
    for (std::size_t k = 0; k < points; ++k) {
      const double part = (double(k) + 0.5) / double(points);
      places.push_back(plan.add_place(string, string_shapes(120, 0.02 * part / 0.9)));
      gaps.push_back(8e-5 * part * part);
    }
    bridge = plan.add_profile(places, kGround, SegmentTable<T>(table), gaps, lengths);
    return plan;
  }

  void tick() {
    if (sample < static_cast<int>(0.004 * rate_hz)) network.push(pluck, static_cast<T>(1000 * sample / rate_hz));
    ++sample;
    network.tick();
  }

  std::vector<Segment<T>> table;
  std::size_t pluck = 0;
  ConnectionRange bridge{};
  ContactNetwork<T> network;
  double rate_hz;
  int sample = 0;
};

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
    const auto found = played(points);
    double sum = 0, square = 0;
    for (std::size_t n = 0; n < found.size(); ++n) {
      sum += std::pow(found[n] - reference[n], 2);
      square += std::pow(reference[n], 2);
    }
    errors.push_back(std::sqrt(sum / square));
    std::cout << points << " points: " << errors.back() << "\n";
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
      solver.set_admittance(i, j, bank.admittance(shapes[i], shapes[j]));
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
