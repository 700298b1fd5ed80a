// SPDX-License-Identifier: MIT
// Coupled contacts: the solver against nested bisection, one contact against the contact step.
#include "contactspline/network/coupled_contacts.hpp"

#include <algorithm>
#include <utility>

#include "power_table.hpp"
#include "support/compare.hpp"
#include "support/precisions.hpp"
#include "support/random.hpp"

namespace contactspline::testing {
namespace {

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

// n contacts on a body of some modes: their receptances are positive definite and strongly coupled.
struct Problem {
  Problem(Random& random, std::size_t n, Law law = Law::power) : receptance(n, std::vector<double>(n)) {
    std::vector<std::vector<double>> shapes(n, std::vector<double>(6));
    for (auto& row : shapes)
      for (double& shape : row) shape = random.between(-1, 1);
    const double scale = random.log_between(1e-9, 1e-5);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t m = 0; m < 6; ++m) receptance[i][j] += scale * shapes[i][m] * shapes[j][m];
    for (std::size_t i = 0; i < n; ++i) {
      const double exponent = random.between(1, 3), stiffness = random.log_between(1e4, 1e12);
      tables.push_back(law == Law::power ? power_table(stiffness, exponent, 1e-3) : uneven_table(random));
      compression.push_back(random.between(-3e-4, 5e-4));
      free_increment.push_back(random.between(-1e-3, 1e-3));
      controls.push_back({random.log_between(0.1, 10), random.below(2) != 0 ? random.between(0, 1) : 0.0});
      last_increment.push_back(random.between(-1e-3, 1e-3));
    }
  }

  [[nodiscard]] std::size_t size() const { return tables.size(); }

  void put_into(CoupledContacts<double>& solver) const {
    solver.begin();
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t j = 0; j < size(); ++j) solver.set_receptance(i, j, receptance[i][j]);
      solver[i].table = tables[i];
      solver[i].contact = controls[i];
      solver[i].compression = compression[i];
      solver[i].free_increment = free_increment[i];
      solver[i].segment = segment_index(SegmentTable<double>(tables[i]), compression[i]);
      solver[i].memory.set_last_increment(last_increment[i]);
    }
    for (std::size_t i = 0; i < size(); ++i) solver.add(i);
  }

  std::vector<std::vector<double>> receptance;
  std::vector<Table> tables;
  std::vector<ContactControls<double>> controls;
  std::vector<double> compression, free_increment, last_increment;
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
  const long double midway = std::min(plain_potential(p.tables[i], y0 + p.last_increment[i] / 2).second, 2 * slope);
  const long double viscous = p.controls[i].loss_s_per_m * ratio * kRate * midway * x;
  return std::max(0.0L, ratio * elastic + viscous);
}

// Forces by bisection for the last contact, within bisection for the one before, and so on: each residual rises with
// its force, because the matrix of receptances is positive definite.
void bisect(const Problem& p, std::size_t i, std::vector<long double>& forces) {
  if (i == p.size()) return;
  const auto residual = [&](long double force) {
    forces[i] = force;
    for (std::size_t j = i + 1; j < p.size(); ++j) forces[j] = 0;
    bisect(p, i + 1, forces);
    long double x = p.free_increment[i];
    for (std::size_t j = 0; j < p.size(); ++j) x -= p.receptance[i][j] * forces[j];
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

CONTACTSPLINE_EACH_PRECISION(OneContact);

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
      solver.set_receptance(i, i, static_cast<T>(random.log_between(1e-12, 1e-4)));
      c.contact = {static_cast<T>(random.log_between(0.1, 10)), random.below(2) != 0 ? T(0.3) : T(0)};
      c.compression = static_cast<T>(random.between(-1e-4, 1e-3));
      c.free_increment = static_cast<T>(random.between(-1e-3, 1e-3));
      c.segment = segment_index(c.table, c.compression);
      before.push_back(c.compression);
      expected.push_back(contact_step(c.table, c.contact, T(1 / kRate),
                                      {c.compression, c.free_increment, solver.receptance(i, i)}, c.segment,
                                      c.memory.last_increment()));
      solver.add(i);
    }
    solver.solve();
    solver.advance();
    for (std::size_t i = 0; i < 3; ++i) {
      const T motion = std::abs(before[i]) + std::abs(solver[i].free_increment);
      const T force = std::abs(expected[i].force) + motion / solver.receptance(i, i);
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

// Two problems without receptance between them give the bits that each gives alone.
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
        both.set_receptance(i, j,
                            i < 3 && j < 3     ? a.receptance[i][j]
                            : i >= 3 && j >= 3 ? b.receptance[i - 3][j - 3]
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

}  // namespace
}  // namespace contactspline::testing
