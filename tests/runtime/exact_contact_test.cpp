// SPDX-License-Identifier: MIT
// The reference itself: against closed forms, and files that break off.
#include "runtime/exact_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "runtime/random_steps.hpp"
#include "runtime/step_cases.hpp"
#include "support/finite.hpp"

namespace contactspline::testing {
namespace {

constexpr double kTiny = 0x1p-96;  // the bisection ends at 2^-100 of the longer of x and xf

double relative(Wide value, Wide expected) {
  return static_cast<double>(magnitude(value - expected) / magnitude(expected));
}

// One segment is a linear spring of stiffness 2 c.
TEST(ExactContact, OfOneSegmentIsALinearSpring) {
  const std::vector<Segment<double>> table = {{}, {0, 0, 0, 500}};
  const ExactContact contact(table);
  const Wide xi = 0.001, c = 500;
  // Within: x = (xf - xi 2 c y0) / (1 + xi c).
  const ExactStep within = ExactApproach(contact, 0.25, 0.125, xi).solve();
  EXPECT_LT(relative(within.increment, (Wide(0.125) - xi * 2 * c / 4) / (1 + xi * c)), kTiny);
  EXPECT_LT(relative(within.force, 2 * c / 4 + c * within.increment), kTiny);
  // Out of contact, to y1 = 1: xf = x + xi c / x.
  const Wide x = 3, xf = x + xi * c / x;
  const ExactStep entering = ExactApproach(contact, -2, xf, xi).solve();
  EXPECT_LT(relative(entering.increment, x), kTiny);
  EXPECT_LT(relative(entering.force, c / x), kTiny);
  // Apart.
  const ExactStep apart = ExactApproach(contact, -2, 2, xi).solve();
  EXPECT_TRUE(apart.force == 0 && apart.increment == 2);
}

TEST(ExactContact, EnergyIsTheAreaBelowTheForce) {
  const auto table = power_law_table(2.3, 31, 1e-3, 50);
  const ExactContact contact(table);
  Wide area = 0;
  for (int i = 0; i < 3100; ++i) {
    const Wide y = Wide(i) * table[2].knot / 100, next = Wide(i + 1) * table[2].knot / 100;
    area += (contact.force(y) + contact.force(next)) / 2 * (next - y);
  }
  // The steps hit the knots but for their rounding in the table, where the kink of the force is cut off.
  EXPECT_LT(relative(contact.energy(Wide(31) * table[2].knot), area), 1e-17);
  EXPECT_TRUE(contact.energy(-1) == 0 && contact.force(-1) == 0 && contact.force(0) == 0);
}

TEST(ExactContact, TellsATableThatIsNotC1) {
  auto table = power_law_table(2.3, 8, 1e-3, 50);
  EXPECT_LT(static_cast<double>(ExactContact(table).energy_error()), 1e-15);
  table[5].energy *= 1 + 1e-9;
  EXPECT_GT(static_cast<double>(ExactContact(table).energy_error()), 0.9e-9);
  table[5].half_curvature *= 1 + 1e-9;
  EXPECT_GT(static_cast<double>(ExactContact(table).slope_error()), 0.1e-9);
}

// What defines the root, and the bounds: h is 0 there, and +-shift where the bounds of the force are taken.
TEST(ExactApproach, SolvesItsEquation) {
  const auto tables = test_tables<double>();
  RandomSteps<double> steps(tables, RandomSteps<double>::Pairs::kNone);
  std::vector<ExactContact> contacts;
  for (const auto& table : tables) contacts.emplace_back(table.segments);
  for (int i = 0; i < 3000; ++i) {
    const auto step = steps.next();
    const Wide xf = step.free_increment, xi = step.receptance;
    const ExactApproach approach(contacts[step.table], step.compression, xf, xi);
    const ExactStep exact = approach.solve();
    const Wide scale = std::max(magnitude(exact.increment), magnitude(xf));
    if (scale == 0) continue;
    const Wide width = kTiny * scale;
    EXPECT_TRUE(approach.h(exact.increment - width) <= 0 && approach.h(exact.increment + width) >= 0);
    EXPECT_LE(static_cast<double>(magnitude(exact.increment + xi * exact.force - xf) / scale), kTiny);
    if (step.increment) {
      const ExactStep near = approach.solve_near(*step.increment, 1e-15 * magnitude(xf));
      EXPECT_LE(static_cast<double>(magnitude(near.increment - exact.increment) / scale), kTiny);
    }
    const ExactApproach moved(contacts[step.table], step.compression, xf + scale / 1e9, xi);
    const Wide greatest = approach.force_at_shift(exact, scale / 1e9), force = moved.solve().force;
    EXPECT_TRUE(exact.force <= force * (1 + Wide(1e-25)) && force <= greatest * (1 + Wide(1e-25)));
    EXPECT_LE(static_cast<double>(greatest - force), 0.01 * static_cast<double>(force - exact.force) + 1e-300);
  }
}

TEST(IsFinite, AsksTheBits) {
  EXPECT_TRUE(is_finite(0.0) && is_finite(-1e308) && is_finite(5e-324) && is_finite(-3e38f) && is_finite(0.0f));
  EXPECT_FALSE(is_finite(HUGE_VAL) || is_finite(-HUGE_VAL) || is_finite(std::nan("")));
  EXPECT_FALSE(is_finite(HUGE_VALF) || is_finite(-HUGE_VALF) || is_finite(std::nanf("")));
}

TEST(StepCases, ReadBackAndNoticeWhatIsMissing) {
  namespace fs = std::filesystem;
  const std::string path = (fs::path(::testing::TempDir()) / "contact_step_cases.bin").string();
  const StepCases<float> set{{{{}, {0, 0, 0, 1}}}, {{0, 1, 2, 3, 4, 5, 6, 7, 8}}, {{0, 1, 2, 3}}};
  write_step_cases(path, set);
  const auto read = read_step_cases<float>(path);
  ASSERT_TRUE(read.tables.size() == 1 && read.cases.size() == 1 && read.extremes.size() == 1);
  EXPECT_TRUE(read.tables[0][1].half_curvature == 1 && read.cases[0].max_force == 8);
  EXPECT_EQ(read.extremes[0].receptance, 3);
  EXPECT_THROW((void)read_step_cases<double>(path), std::runtime_error);
  for (auto size = fs::file_size(path); size-- > 0;) {
    fs::resize_file(path, size);
    EXPECT_THROW((void)read_step_cases<float>(path), std::runtime_error) << size;
  }
  fs::remove(path);
  EXPECT_THROW((void)read_step_cases<float>(path), std::runtime_error);
}

}  // namespace
}  // namespace contactspline::testing
