// SPDX-License-Identifier: MIT
// What the contact step promises, on random steps: energy, monotony, limits, scaling, reversal, loss. Its digits are
// the business of step_checker.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/exact_contact.hpp"
#include "runtime/random_steps.hpp"
#include "runtime/step_cases.hpp"
#include "support/compare.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

constexpr int kSteps = 200'000;

/// Tables, steps and bounds in one precision.
template <typename T>
class ContactStepProperty : public ::testing::Test {
 protected:
  // As derived in step_reference.cpp: the force is that of xf moved by D = u |x|, with `fraction` of it, and the
  // compression that of xf moved by 12 u (|x| + |xf|).
  static constexpr double kU = kRoundoff<T>;
  static constexpr double kForceFraction = 40 * kU;

  ContactStepProperty() {
    for (const auto& table : tables_) {
      contacts_.emplace_back(table.segments);
      double stiffest = 0;
      for (const auto& segment : table.segments)
        stiffest = std::max(stiffest, static_cast<double>(segment.half_curvature));
      stiffest_.push_back(stiffest);
    }
  }

  /// Calls test(step, table) on steps that pass the pairs by.
  template <typename Test>
  void for_steps(Test test) {
    RandomSteps<T> steps(tables_, RandomSteps<T>::Pairs::kNone);
    for (int i = 0; i < kSteps && !this->HasFailure(); ++i) {
      const RandomStep<T> step = steps.next();
      test(step, SegmentTable<T>(tables_[step.table].segments));
    }
  }

  static Approach<T> approach(const RandomStep<T>& step) {
    return {step.compression, step.free_increment, step.receptance};
  }
  static Wide increment(const RandomStep<T>& step, T force) {
    return Wide(step.free_increment) - Wide(step.receptance) * Wide(force);
  }
  /// What xf is as good as moved by [m]: D, and where xf or xi are rounded beforehand, so many u (|x| + |xf|).
  static double increment_error(const RandomStep<T>& step, T force, int roundings = 0) {
    const double x = std::abs(static_cast<double>(increment(step, force)));
    return kU * (x + roundings * (x + std::abs(static_cast<double>(step.free_increment))));
  }
  /// Rounding of a table, relative to a force: entries are rounded, and energies of many times the work subtracted.
  double fraction(const RandomStep<T>& step, Wide work, Wide y1) const {
    const auto& contact = contacts_[step.table];
    const Wide energies = contact.energy(step.compression) + contact.energy(y1);
    const bool far = work != 0 && contact.segment_of(y1) != contact.segment_of(step.compression);
    const Wide table = contact.slope_error() + (far ? contact.energy_error() * energies / magnitude(work) : Wide(0));
    return kForceFraction + static_cast<double>(table);
  }
  /// Uncertainty of a force [N]: of (1 - 1/h') D / xi, (1 - 1/h')/xi is at most 1/xi, and at most the greatest slope
  /// of a mean force, c.
  double force_error(const RandomStep<T>& step, T force, double fraction, int roundings = 0) const {
    const double slope = std::min(1 / static_cast<double>(step.receptance), stiffest_[step.table]);
    return fraction * static_cast<double>(force) + slope * increment_error(step, force, roundings);
  }

  std::vector<TestTable<T>> tables_ = test_tables<T>();
  std::vector<ExactContact> contacts_;
  std::vector<double> stiffest_;
};

TYPED_TEST_SUITE(ContactStepProperty, Precisions);

// f x is V(y0 + x) - V(y0), x = xf - xi f, up to the uncertainty e = D + fraction xi f of x, against which the mean
// force rises with slope (F(y1) - f)/x: |f x - W| <= fraction |W| + |F(y1) - f| e. Twice that, for F(y1) itself moves
// with e.
TYPED_TEST(ContactStepProperty, ExchangesTheEnergyTheContactStores) {
  double worst = 0;
  this->for_steps([&](const auto& step, const auto& table) {
    const auto f = contact_force(table, this->approach(step));
    const auto& contact = this->contacts_[step.table];
    const Wide x = this->increment(step, f), y1 = step.compression + x;
    const ExactApproach exact(contact, step.compression, step.free_increment, step.receptance);
    const Wide work = exact.work(x, exact.end_segment(x));
    if (work == 0) {
      ASSERT_TRUE(f == 0 || x == 0);
      return;
    }
    const double fraction = this->fraction(step, work, y1);
    const double e = this->increment_error(step, f) + fraction * static_cast<double>(step.receptance * f);
    const double resistance = std::abs(static_cast<double>(contact.force(y1)) - static_cast<double>(f));
    const double bound =
        2 * (fraction * std::abs(static_cast<double>(work)) + (resistance + 2 * this->stiffest_[step.table] * e) * e);
    const double error = std::abs(static_cast<double>(f * x - work));
    worst = std::max(worst, error / bound);
    ASSERT_LE(error, bound) << "y0 " << step.compression << " xf " << step.free_increment << " xi "
                            << step.receptance;
  });
  Measured() << "worst energy error " << worst << " of its bound";
  this->RecordProperty("worst", std::to_string(worst));
}

TYPED_TEST(ContactStepProperty, ForceRisesWithTheFreeIncrement) {
  this->for_steps([&](auto step, const auto& table) {
    if (step.free_increment == 0) return;
    const auto f = contact_force(table, this->approach(step));
    const double error = this->force_error(step, f, this->kForceFraction + 1e3 * kRoundoff<TypeParam>);
    for (const double farther : {1e-15, 1e-9, 1e-4, 0.5}) {
      auto next = step;
      next.free_increment += static_cast<TypeParam>(farther) * std::abs(step.free_increment);
      const auto g = contact_force(table, this->approach(next));
      ASSERT_GE(static_cast<double>(g), static_cast<double>(f) - 2 * error) << farther;
    }
  });
}

// |f - V'(y0)| <= c |x|, the mean of V'' x / 2.
TYPED_TEST(ContactStepProperty, ForceTendsToTheSlopeOfThePotential) {
  this->for_steps([&](auto step, const auto& table) {
    if (step.compression <= 0) return;
    const double y0 = static_cast<double>(step.compression);
    const double slope = static_cast<double>(this->contacts_[step.table].force(y0));
    for (const double fraction : {1e-2, 1e-5, 1e-9}) {
      step.free_increment = static_cast<TypeParam>(fraction * y0);
      step.receptance = static_cast<TypeParam>(fraction * y0 / slope);
      const auto f = contact_force(table, this->approach(step));
      const double x = std::abs(static_cast<double>(this->increment(step, f))) + this->increment_error(step, f);
      const double bound = this->stiffest_[step.table] * x + this->force_error(step, f, 2 * this->kForceFraction);
      ASSERT_NEAR(static_cast<double>(f), slope, bound) << y0 << " " << fraction;
      ASSERT_LE(x, 3 * fraction * y0);
    }
  });
}

TYPED_TEST(ContactStepProperty, StiffnessRatioIsAStifferSpline) {
  const auto stiffer = [](std::vector<Segment<TypeParam>> table, TypeParam ratio) {
    for (auto& s : table) s.energy *= ratio, s.force *= ratio, s.half_curvature *= ratio;
    return table;
  };
  for (const double ratio : {0x1p-10, 4.0, 0x1p+20, 0.001, 3.0, 1e6}) {
    const bool exact = kCopiesRoundAlike && std::exp2(std::round(std::log2(ratio))) == ratio;
    std::vector<std::vector<Segment<TypeParam>>> scaled;
    for (const auto& table : this->tables_) scaled.push_back(stiffer(table.segments, static_cast<TypeParam>(ratio)));
    int steps = 0;
    this->for_steps([&](const auto& step, const auto& table) {
      if (++steps > kSteps / 6) return;
      const ContactControls<TypeParam> controls{static_cast<TypeParam>(ratio), 0};
      const auto f = contact_force(table, controls, TypeParam(1), this->approach(step));
      const auto g = contact_force(SegmentTable<TypeParam>(scaled[step.table]), this->approach(step));
      // Powers of two scale without rounding, if nothing underflows: the same digits.
      if (exact && f > std::numeric_limits<TypeParam>::min() * TypeParam(1e12)) {
        ASSERT_EQ(f, g) << ratio;
      } else {
        const Wide x = this->increment(step, f);
        const ExactApproach path(this->contacts_[step.table], step.compression, 0, 1);
        const double fraction = this->fraction(step, path.work(x, path.end_segment(x)), step.compression + x);
        const double slope = std::min(1 / static_cast<double>(step.receptance), ratio * this->stiffest_[step.table]);
        const double bound = 2 * (fraction * static_cast<double>(f) + slope * this->increment_error(step, f, 1));
        ASSERT_NEAR(static_cast<double>(f), static_cast<double>(g), bound) << ratio;
      }
    });
  }
}

// From y1 back to y0 the force is the same. The rounding of y1 moves the path, by at most u |y1|, and the force by
// the mean of V'' <= 2 c times that.
TYPED_TEST(ContactStepProperty, TheReverseStepTakesTheSameForce) {
  this->for_steps([&](const auto& step, const auto& table) {
    const auto there = contact_step(table, this->approach(step));
    const Wide x = Wide(there.compression) - Wide(step.compression);
    const ExactApproach exact(this->contacts_[step.table], step.compression, 0, 1);
    const Wide mean = exact.mean_force(x);
    const auto back_free = static_cast<TypeParam>(-x + Wide(step.receptance) * mean);
    const RandomStep<TypeParam> back{step.table, there.compression, back_free, step.receptance, {}};
    const auto f = contact_force(table, this->approach(back));
    const double fraction = this->fraction(step, mean * x, there.compression);
    const double moved = kRoundoff<TypeParam> * (std::abs(static_cast<double>(there.compression)) +
                                                 std::abs(static_cast<double>(step.compression)));
    const double bound = this->force_error(step, there.force, fraction, 12) +
                         this->force_error(back, f, fraction, 1) + 2 * this->stiffest_[step.table] * moved;
    ASSERT_NEAR(static_cast<double>(f), static_cast<double>(there.force), bound)
        << "y0 " << step.compression << " xf " << step.free_increment << " xi " << step.receptance;
  });
}

// What a step hands on is what the next one would look for itself, so that a carried segment changes nothing.
TYPED_TEST(ContactStepProperty, NamesTheSegmentItEndsIn) {
  this->for_steps([&](const auto& step, const auto& table) {
    const auto elastic = contact_step(table, this->approach(step));
    ASSERT_EQ(elastic.segment, segment_index(table, elastic.compression));
    const ContactControls<TypeParam> controls{2, TypeParam(0.1)};
    const auto lossy = contact_step(table, controls, TypeParam(1e-5), this->approach(step));
    ASSERT_EQ(lossy.segment, segment_index(table, lossy.compression));
  });
}

TYPED_TEST(ContactStepProperty, WithoutLossTheLossyStepIsTheElasticOne) {
  this->for_steps([&](const auto& step, const auto& table) {
    const auto elastic = contact_step(table, this->approach(step));
    const auto lossy = contact_step(table, ContactControls<TypeParam>{1, 0}, TypeParam(1e-5), this->approach(step));
    if constexpr (kCopiesRoundAlike) {
      ASSERT_EQ(lossy.force, elastic.force);
      ASSERT_EQ(lossy.compression, elastic.compression);
    } else {
      const Wide x = this->increment(step, elastic.force);
      const ExactApproach path(this->contacts_[step.table], step.compression, 0, 1);
      const double fraction = this->fraction(step, path.work(x, path.end_segment(x)), step.compression + x);
      const double bound = 2 * this->force_error(step, elastic.force, fraction, 1);
      ASSERT_NEAR(static_cast<double>(lossy.force), static_cast<double>(elastic.force), bound);
    }
  });
}

// f = mean force + R x / dt with x = xf - xi f, R = lambda min(F(y0 + last/2), 2 F(y0)), where that is not negative;
// else 0. Both slopes, of the mean force and R/dt, act on the uncertainty of x. What is left of f x after the contact
// has taken its part is lost: >= 0.
TYPED_TEST(ContactStepProperty, LossIsViscousAndPassive) {
  constexpr double kTimeStep = 1.0 / 48000;
  Random random(3);
  int clamped = 0;
  double worst = 0;
  this->for_steps([&](const auto& step, const auto& table) {
    const ContactControls<TypeParam> controls{1, static_cast<TypeParam>(random.decades(-6, 2))};
    const TypeParam y0 = step.compression, last = random.between(-1, 1) * y0;
    const auto answer = contact_step(table, controls, static_cast<TypeParam>(kTimeStep), this->approach(step),
                                     segment_index(table, y0), last);
    const TypeParam f = answer.force;
    ASSERT_TRUE(is_finite(f) && f >= 0);
    const bool apart = step.compression <= 0 && step.compression + step.free_increment <= 0;
    ASSERT_TRUE(f == 0 || !apart);
    const auto& contact = this->contacts_[step.table];
    const Wide x = this->increment(step, f);
    const ExactApproach exact(contact, step.compression, step.free_increment, step.receptance);
    const double resistance = static_cast<double>(controls.loss_s_per_m) / static_cast<double>(TypeParam(kTimeStep)) *
                              static_cast<double>(std::min(contact.force(y0 + last / 2), 2 * contact.force(y0)));
    const double mean = static_cast<double>(exact.mean_force(x)), drag = resistance * static_cast<double>(x);
    const Wide work = exact.work(x, exact.end_segment(x));
    const double fraction = 2 * this->fraction(step, work, step.compression + x);
    const double forces = fraction * (mean + std::abs(drag));
    const double increments = 2 * this->increment_error(step, f, 2) + static_cast<double>(step.receptance) * forces;
    const double bound = forces + (this->stiffest_[step.table] + resistance) * increments;
    ASSERT_GE(static_cast<double>(f * x - work), -std::abs(static_cast<double>(x)) * bound);
    if (f == 0) {
      ASSERT_LE(mean + drag, bound);
      ASSERT_EQ(answer.compression, step.compression + step.free_increment);
      clamped += !apart;
      return;
    }
    worst = std::max(worst, std::abs(static_cast<double>(f) - mean - drag) / bound);
    ASSERT_NEAR(static_cast<double>(f), mean + drag, bound)
        << "y0 " << step.compression << " xf " << step.free_increment << " xi " << step.receptance << " loss "
        << controls.loss_s_per_m;
  });
  Measured() << "worst " << worst << " of the bound; " << clamped << " steps would have pulled";
  EXPECT_GT(clamped, 100);
}

// Every entry a small integer times a power of two, so every sum is exact: knots are hit exactly.
TYPED_TEST(ContactStepProperty, HitsKnotsExactly) {
  const auto& segments = this->tables_.back().segments;
  const SegmentTable<TypeParam> table(segments);
  const ExactContact& contact = this->contacts_.back();
  for (std::size_t from = 1; from < segments.size(); ++from)
    for (std::size_t to = 1; to < segments.size(); ++to)
      for (const TypeParam xi : {TypeParam(0x1p-26), TypeParam(0x1p-16), TypeParam(0x1p-10)}) {
        const TypeParam y0 = segments[from].knot, x = segments[to].knot - y0;
        const auto f = static_cast<TypeParam>(ExactApproach(contact, y0, 0, 1).mean_force(x));
        const auto step = contact_step(table, Approach<TypeParam>{y0, x + xi * f, xi});
        EXPECT_NEAR(static_cast<double>(step.force), static_cast<double>(f), 8 * kRoundoff<TypeParam> * f)
            << from << " to " << to;
        EXPECT_NEAR(static_cast<double>(step.compression), static_cast<double>(segments[to].knot),
                    8 * kRoundoff<TypeParam> * std::max(y0, segments[to].knot));
      }
}

// All 1025^2 pairs, too many for the cases of step_checker: the answer is the force the step was made from.
TEST(ContactStep, GoesFromEverySegmentToEverySegmentOf1024) {
  const std::vector<TestTable<double>> tables = {{power_law_table(2.3, 1024, 1e-3, 50), 2.3, 1e-3, 50}};
  const SegmentTable<double> table(tables[0].segments);
  const ExactContact contact(tables[0].segments);
  RandomSteps<double> steps(tables);
  constexpr double kU = kRoundoff<double>;
  for (std::size_t start = 0; start < table.size(); ++start)
    for (std::size_t end_segment = 0; end_segment < table.size(); ++end_segment) {
      const auto step = steps.between(0, steps.within(0, start), steps.within(0, end_segment));
      const double x = static_cast<double>(*step.increment);
      const ExactApproach exact(contact, step.compression, 0, 1);
      const double f = static_cast<double>(exact.mean_force(*step.increment, end_segment));
      const double force =
          contact_force(table, Approach<double>{step.compression, step.free_increment, step.receptance});
      const double increments = 2 * kU * (std::abs(x) + std::abs(step.free_increment));
      const double slope = std::min(1 / step.receptance, table.back().half_curvature * 2);
      ASSERT_NEAR(force, f, 8000 * kU * f + slope * increments) << start << " to " << end_segment;
    }
}

}  // namespace
}  // namespace contactspline::testing
