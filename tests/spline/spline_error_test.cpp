// SPDX-License-Identifier: MIT
// Closed forms of an impact, on the power law and on its spline, against quadrature and published figures; and the
// quality figures against brute force.
#include "generator/spline/spline_error.hpp"

#include <gtest/gtest.h>

#include <boost/math/constants/constants.hpp>
#include <numbers>
#include <string>

#include "generator/contact/barrier_impact.hpp"
#include "generator/contact/contact_law_quad.hpp"
#include "generator/spline/contact_spline.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/reference.hpp"

namespace contactspline::testing {
namespace {

/// Nodes of the tanh-sinh rule over the unit interval: distances to the two ends, each to full relative precision.
struct Node {
  Real from_left, from_right, weight;
};

// x = 1/(1 + exp(-pi sinh t)) by the trapezoidal rule in t. Cut off where x is 1e-66, so an inverse square root at an
// end loses 1e-33; a step of 1/48 leaves less than that (see Quadrature below).
const std::vector<Node>& tanh_sinh_nodes() {
  static const std::vector<Node> nodes = [] {
    const Real pi = boost::math::constants::pi<Real>();
    const Real step = Real(1) / 48;
    std::vector<Node> made;
    for (int i = -220; i <= 220; ++i) {
      const Real steepness = exp(pi * sinh(i * step));
      const Real left = steepness / (1 + steepness);
      const Real right = 1 / (1 + steepness);
      made.push_back({left, right, step * pi * cosh(i * step) * left * right});
    }
    return made;
  }();
  return nodes;
}

/// Integral of f(distance from the left end, distance from the right end) over a width; the ends may be singular.
template <typename Integrand>
Real integral(const Real& width, Integrand f) {
  Real sum = 0;
  for (const Node& node : tanh_sinh_nodes())
    sum += node.weight * f(Real(width * node.from_left), Real(width * node.from_right));
  return width * sum;
}

TEST(Quadrature, IntegratesSquareRootEndsToThirtyDigits) {
  const auto f = [](const Real& left, const Real& right) { return Real(1 / sqrt(left * right)); };
  const Real error = integral(Real(1), f) - boost::math::constants::pi<Real>();
  EXPECT_LT(abs(error), Real("1e-30")) << error;
}

struct PublishedCase {
  const char* name;
  PowerLaw law;
  double mass_kg, speed_m_per_s;
};

constexpr PublishedCase kMb1{"MB1", {1e9, 1.3}, 0.01, 2.0};
constexpr PublishedCase kC4{"C4", {4.5e9, 2.5}, 0.00297, 2.5};
constexpr PublishedCase kC2{"C2", {4e8, 2.3}, 0.0049, 2.5};

double max_compression(const PublishedCase& c) {
  return c.law.max_compression(c.mass_kg, c.speed_m_per_s);
}
double contact_duration(const PublishedCase& c) {
  return c.law.contact_duration(c.mass_kg, c.speed_m_per_s);
}

// Published figures hold to half a unit of their last digit.

TEST(PublishedImpact, Mb1) {
  EXPECT_TRUE(within(max_compression(kMb1), 3.20293e-5, 0.5e-10));
  EXPECT_TRUE(within(contact_duration(kMb1), 48.261e-6, 0.5e-9));
  EXPECT_TRUE(within(contact_duration(kMb1) * 44100, 2.13, 0.005));
}

TEST(PublishedImpact, HammerC4) {
  EXPECT_TRUE(within(contact_duration(kC4), 0.70853e-3, 0.5e-8));
  EXPECT_TRUE(within(kC4.law.force(max_compression(kC4)), 49.54, 0.005));
}

TEST(PublishedImpact, HammerC2) {
  EXPECT_TRUE(within(contact_duration(kC2), 1.09685e-3, 0.5e-8));
}

TEST(PublishedImpact, Zeta) {
  const std::pair<double, double> table[] = {{1, 1.57080},   {1.3, 1.50677}, {1.5, 1.47164},
                                             {2.3, 1.36962}, {2.5, 1.35072}, {3, 1.31103}};
  for (const auto& [exponent, zeta] : table) {
    const PowerLaw law{1e9, exponent};
    const double found = law.contact_duration(0.01, 2) * 2 / (2 * law.max_compression(0.01, 2));
    EXPECT_TRUE(within(found, zeta, 0.5e-5)) << exponent;
  }
}

// pow(x, r) of x = (a + 1) E/k: r = 1/(a + 1) is off by 1.5 u of itself, which moves the result by 1.5 u r |ln x|,
// and x by 4 u, which moves it by 4 u r; pow() adds 2 u. Gamma adds at most 10 u a call, here on arguments that are
// off by 1.5 u, the rest 6 u.
double compression_bound(const PublishedCase& c) {
  const double root = 1 / (c.law.exponent + 1);
  const double x = c.mass_kg * c.speed_m_per_s * c.speed_m_per_s / (2 * root * c.law.stiffness);
  return kUnitRoundoff * (1.5 * root * std::abs(std::log(x)) + 4 * root + 2);
}
double duration_bound(const PublishedCase& c) {
  return compression_bound(c) + kUnitRoundoff * 30;
}

std::vector<PublishedCase> random_impacts(int count) {
  std::mt19937_64 random(3);
  std::vector<PublishedCase> impacts = {kMb1, kC4, kC2};
  for (int i = 0; i < count; ++i)
    impacts.push_back({"random",
                       {log_uniform(random, 1e3, 1e12), uniform(random, 1, 5)},
                       log_uniform(random, 1e-4, 1),
                       log_uniform(random, 1e-2, 20)});
  return impacts;
}

// By energy, without the closed form: V(ym) = m v^2/2. A relative error e of ym is one of (a + 1) e in V.
TEST(PowerLaw, AllKineticEnergyIsStoredAtMaxCompression) {
  for (const auto& c : random_impacts(100)) {
    const Real kinetic = Real(c.mass_kg) * c.speed_m_per_s * c.speed_m_per_s / 2;
    const Real stored = exact_energy(c.law, max_compression(c));
    const double error = (stored / kinetic - 1).convert_to<double>();
    EXPECT_TRUE(within(error, 0, compression_bound(c) * (c.law.exponent + 1) * 1.001)) << c.law.exponent;
  }
}

// T = 2 times the integral of dy/v(y) up to ym, by quadrature; near the end v is taken from the distance to it.
TEST(PowerLaw, ContactLastsAsLongAsTheMotionTakes) {
  double worst = 0;
  for (const auto& c : random_impacts(40)) {
    const Real power = Real(c.law.exponent) + 1;
    const Real kinetic = Real(c.mass_kg) * c.speed_m_per_s * c.speed_m_per_s / 2;
    const Real deepest = pow(power * kinetic / c.law.stiffness, 1 / power);
    const auto slowness = [&](const Real& u, const Real& left) {  // u = y/ym; 1 - u^p without cancellation
      return Real(1 / sqrt(-expm1(power * (u < left ? Real(log(u)) : Real(log1p(-left))))));
    };
    const Real duration = 2 * deepest / c.speed_m_per_s * integral(Real(1), slowness);
    const double error = (contact_duration(c) / duration - 1).convert_to<double>();
    EXPECT_TRUE(within(error, 0, duration_bound(c))) << c.law.exponent;
    worst = std::max(worst, std::abs(error) / duration_bound(c));
  }
  Measured() << "closed form of T: worst error " << worst << " of its bound";
}

TEST(PowerLaw, ForceAndEnergyAreZeroOutOfContact) {
  for (const double y : {-1.0, -1e-300, -0.0, 0.0}) {
    EXPECT_EQ(kC4.law.force(y), 0);
    EXPECT_EQ(kC4.law.energy(y), 0);
  }
}

/// Motion into a spline by quadrature of dy/v(y) segment after segment, with v from the energy left. The spline is
/// the unrounded one: rounded coefficients leave a step of u in the energy at a knot, which matters where the motion
/// dies.
struct QuadratureImpact {
  Real max_compression, duration;
};

QuadratureImpact impact_by_quadrature(const ReferenceSpline& spline, double mass_kg, double speed) {
  const Real kinetic = Real(mass_kg) * speed * speed / 2;
  const auto slowness = [&](const Real& energy) { return Real(1 / sqrt(2 * energy / mass_kg)); };
  Real half_duration = 0;
  for (std::size_t j = 0;; ++j) {
    const Real& force = spline.force[j];
    const Real& c = spline.half_curvature[j];
    const auto left = [&](const Real& t) { return Real(kinetic - spline.energy[j] - t * (force + t * c)); };
    const bool last = j + 1 == spline.knot.size();
    if (!last && left(spline.width) > 0) {
      half_duration += integral(spline.width, [&](const Real& t, const Real&) { return slowness(left(t)); });
      continue;
    }
    Real low = 0, high = spline.width;
    while (left(high) > 0) high *= 2;
    for (int i = 0; i < 300; ++i) (left((low + high) / 2) > 0 ? low : high) = (low + high) / 2;
    // left(end - d) = d (force(end) - c d), without cancellation
    const Real end_force = force + 2 * c * low;
    half_duration += integral(low, [&](const Real&, const Real& d) { return slowness(d * (end_force - c * d)); });
    return {spline.knot[j] + low, 2 * half_duration};
  }
}

// Each segment's time is off by some 5 u of itself, and N such times of either sign add up to less than 5 u sqrt(N)
// of the largest, which is a part of the sum. A cancelled energy shifts the speed at a knot but not the time: what
// the segment before loses the one after gains, to first order. Measured: at most a quarter of this bound.
double spline_impact_bound(const Spline& spline) {
  return 4 * kUnitRoundoff * (1 + std::sqrt(static_cast<double>(spline.segments.size())));
}

/// A generated spline, its unrounded twin, and the worst error of impact_on_spline so far.
class SplinePair {
 public:
  explicit SplinePair(const PublishedCase& c, int segments) : SplinePair(c, material(c, segments)) {}

  void strike(double speed) {
    const SplineImpact found = impact_on_spline(rounded_, mass_kg_, speed);
    const QuadratureImpact exact = impact_by_quadrature(exact_, mass_kg_, speed);
    const double duration = (found.contact_duration_s / exact.duration - 1).convert_to<double>();
    const double compression = (found.max_compression_m / exact.max_compression - 1).convert_to<double>();
    const double bound = spline_impact_bound(rounded_);
    EXPECT_TRUE(within(duration, 0, bound)) << "N " << rounded_.segments.size() << ", speed " << speed;
    EXPECT_TRUE(within(compression, 0, bound)) << "N " << rounded_.segments.size() << ", speed " << speed;
    worst_of_bound_ = std::max({worst_of_bound_, std::abs(duration) / bound, std::abs(compression) / bound});
  }
  [[nodiscard]] double knot_speed(std::size_t j) const {
    return std::sqrt(2 * rounded_.segments[j].energy / mass_kg_);
  }
  [[nodiscard]] double worst_of_bound() const { return worst_of_bound_; }

 private:
  SplinePair(const PublishedCase& c, const Material& of)
      : mass_kg_(c.mass_kg), rounded_(uniform_spline(of, "case.json")), exact_(reference_spline(of)) {}
  static Material material(const PublishedCase& c, int segments) {
    return {c.name, "", c.law, {}, {segments, max_compression(c)}};
  }

  double mass_kg_;
  Spline rounded_;
  ReferenceSpline exact_;
  double worst_of_bound_ = 0;
};

// From far below the first knot to far beyond the last.
TEST(SplineImpact, LastsAsLongAsTheMotionTakes) {
  double worst = 0;
  for (const double exponent : {1.0, 1.3, 2.5, 5.0})
    for (const int segments : {1, 2, 3, 16, 64}) {
      SplinePair pair({"case", {1e9, exponent}, 0.01, 2.0}, segments);
      for (const double speed : {2e-6, 2e-3, 0.1, 0.6, 1.4, 2.0, 6.0, 200.0}) pair.strike(speed);
      worst = std::max(worst, pair.worst_of_bound());
    }
  Measured() << "impact_on_spline: worst error " << worst << " of its bound";
}

// The speed dies at a knot, to the last bit or nearly: the last square roots are of rounding errors.
TEST(SplineImpact, LastsAsLongWhereItTurnsAtAKnot) {
  for (const auto& c : {kMb1, kC4}) {
    SplinePair pair(c, 16);
    for (const std::size_t j : {1U, 2U, 7U, 15U})
      for (const double off : {0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-8, -1e-8})
        pair.strike(pair.knot_speed(j) * (1 + off));
    Measured() << "impact_on_spline, turning at a knot: worst error " << pair.worst_of_bound() << " of its bound";
  }
}

// m = 2: one quarter turn of w = 1 in the first segment would take pi/2; force 2 from y = 1 on is a free fall
// upwards. With m v^2/2 = 3 the knot is passed at sqrt 2 (of sqrt 3): atan(1/sqrt 2) = asin(1/sqrt 3) in, then
// v/(F/m) = sqrt 2.
TEST(SplineImpact, TurnsInASegmentOfConstantForce) {
  const Spline spline{{{0, 0, 0, 1}, {1, 1, 2, 0}}, 1, 1, {}, {}, {}};
  const SplineImpact found = impact_on_spline(spline, 2, std::sqrt(3.0));
  EXPECT_TRUE(relatively_within(found.max_compression_m, 2, 16 * kUnitRoundoff));
  const double half = std::asin(1 / std::sqrt(3.0)) + std::sqrt(2.0);
  EXPECT_TRUE(relatively_within(found.contact_duration_s, 2 * half, 16 * kUnitRoundoff));
}

// F = k y is its own spline, and an oscillator's half period does not depend on the speed.
TEST(SplineImpact, OfALinearContactIsHalfAPeriodWhateverTheSpeed) {
  for (const int segments : {1, 7, 64}) {
    const Spline spline = uniform_spline({"linear", "", {8e5, 1.0}, {}, {segments, 1e-3}}, "linear.json");
    for (const double speed : {1e-4, 0.1, 1.0, 10.0, 1e3}) {
      const SplineImpact found = impact_on_spline(spline, 0.02, speed);
      const double bound = spline_impact_bound(spline);
      EXPECT_TRUE(relatively_within(found.contact_duration_s, std::numbers::pi * std::sqrt(0.02 / 8e5), bound));
      EXPECT_TRUE(relatively_within(found.max_compression_m, speed * std::sqrt(0.02 / 8e5), bound));
    }
  }
}

/// Worst relative error of the contact duration over speeds in geometric progression.
double worst_duration_error(const Spline& spline, const ContactLaw& law, const Impact& impact, int speeds) {
  double worst = 0;
  for (int i = 0; i < speeds; ++i) {
    const double ratio = impact.max_speed_m_per_s / impact.min_speed_m_per_s;
    const double speed = impact.min_speed_m_per_s * std::pow(ratio, i / (speeds - 1.0));
    const double found = impact_on_spline(spline, impact.mass_kg, speed).contact_duration_s;
    worst = std::max(worst, std::abs(found / contact_duration(law, impact.mass_kg, speed) - 1));
  }
  return worst;
}

constexpr Impact kFiftyToOne{0.003, 5.0, 0.1};

/// A material whose spline reaches as far as the fastest of its impacts compresses it.
Material fifty_to_one(double exponent, int segments) {
  const PowerLaw law{4.5e9, exponent};
  const double range = law.max_compression(kFiftyToOne.mass_kg, kFiftyToOne.max_speed_m_per_s);
  return {"felt", "", law, kFiftyToOne, {segments, range}};
}

struct DesignRow {
  double exponent;
  int segments;
  double tabled_percent, half_digit;  ///< as printed in design 2.1
};

const DesignRow kDesignTable[] = {{1.5, 8, 17.9, 0.05},   {1.5, 16, 6.9, 0.05},  {1.5, 32, 1.9, 0.05},
                                  {1.5, 48, 0.86, 0.005}, {2.5, 8, 15.9, 0.05},  {2.5, 16, 0.82, 0.005},
                                  {2.5, 32, 0.15, 0.005}, {2.5, 48, 0.12, 0.005}};

// The range of compression is that of the fastest impact; 60 speeds in geometric progression give all eight figures
// of the design to the last digit printed.
TEST(DesignTable, IsReproducedByASweepOfSixtySpeeds) {
  for (const auto& row : kDesignTable) {
    const Material material = fifty_to_one(row.exponent, row.segments);
    const Spline spline = uniform_spline(material, "felt.json");
    const double percent = 100 * worst_duration_error(spline, material.contact, kFiftyToOne, 60);
    EXPECT_TRUE(within(percent, row.tabled_percent, row.half_digit * 1.001)) << row.exponent << " " << row.segments;
  }
}

// The generator's own sweep is finer and can only find worse: it does, by at most 4 % of the figure (N = 8, 32 at
// exponent 2.5, where the error has a sharp maximum inside the range: 16.36 for 15.9, 0.1555 for 0.15).
TEST(DesignTable, IsAtMostFourPercentBelowTheMeasuredQuality) {
  for (const auto& row : kDesignTable) {
    const Material material = fifty_to_one(row.exponent, row.segments);
    const Quality quality = measure_quality(uniform_spline(material, "felt.json"), material);
    const double percent = 100 * quality.impact->contact_duration;
    Measured() << "exponent " << row.exponent << ", N " << row.segments << ": " << percent << " % (design "
               << row.tabled_percent << ")";
    EXPECT_GE(percent, row.tabled_percent - row.half_digit);
    EXPECT_LE(percent, (row.tabled_percent + row.half_digit) * 1.04);
  }
}

/// The same figures from 266-bit energies and forces at the same 64 points a segment.
Quality quality_by_brute_force(const Spline& spline, const Material& material, int points) {
  Real force_worst = 0, force_squares = 0, energy_worst = 0, energy_squares = 0;
  const Real width = Real(material.spline.max_compression_m) / material.spline.segments;
  for (std::size_t j = 0; j < spline.segments.size(); ++j)
    for (int i = 1; i <= points; ++i) {
      const auto& s = spline.segments[j];
      const Real t = width * i / points;
      const Real y = s.knot + t;
      const Real force_error = abs(s.force + 2 * s.half_curvature * t - exact_force(material.contact, y));
      const Real energy_error =
          abs(s.energy + t * (s.force + t * s.half_curvature) - exact_energy(material.contact, y));
      if (force_error > force_worst) force_worst = force_error;
      if (energy_error > energy_worst) energy_worst = energy_error;
      force_squares += force_error * force_error;
      energy_squares += energy_error * energy_error;
    }
  const int count = points * material.spline.segments;
  const Real force = exact_force(material.contact, material.spline.max_compression_m);
  const Real energy = exact_energy(material.contact, Real(material.spline.max_compression_m));
  const auto relative = [](const Real& value, const Real& scale) { return Real(value / scale).convert_to<double>(); };
  return {{relative(force_worst, force), relative(sqrt(force_squares / count), force)},
          {relative(energy_worst, energy), relative(sqrt(energy_squares / count), energy)},
          {}};
}

// Errors are differences of doubles that are off by a few u of the value at the end of the range: y by 2 u, which
// moves F by 2 a u and V by 2 (a + 1) u; pow, products and the spline's own roundings 8 u more.
TEST(CurveQuality, IsThatOfBruteForceAtTheSamePoints) {
  for (const double exponent : {1.0, 1.3, 2.5, 5.0})
    for (const int segments : {1, 2, 16}) {
      const Material material = fifty_to_one(exponent, segments);
      const Spline spline = uniform_spline(material, "felt.json");
      const Quality found = measure_quality(spline, material);
      const Quality exact = quality_by_brute_force(spline, material, 64);
      const double bound = kUnitRoundoff * (2 * (exponent + 1) + 8);
      EXPECT_TRUE(within(found.force.worst, exact.force.worst, bound));
      EXPECT_TRUE(within(found.force.rms, exact.force.rms, bound));
      EXPECT_TRUE(within(found.energy.worst, exact.energy.worst, bound));
      EXPECT_TRUE(within(found.energy.rms, exact.energy.rms, bound));
    }
}

// An error's lobe is at least half a segment wide. As a parabola it is at most 1/128 of a segment from a point, which
// misses (2/64)^2 of its height, 1e-3. The root mean square is a right-hand sum: half of the last square too much,
// where the first is zero. The next term of Euler and Maclaurin, e e'/(6 64^2 N), is at most 4e-3 of the mean square
// (at exponent 5 and N = 1), 2e-3 of its root.
TEST(CurveQuality, AtSixtyFourPointsIsThatOfTwoThousand) {
  for (const double exponent : {1.3, 2.5, 5.0})
    for (const int segments : {1, 16}) {
      const Material material = fifty_to_one(exponent, segments);
      const Spline spline = uniform_spline(material, "felt.json");
      const Quality found = measure_quality(spline, material);
      const Quality dense = quality_by_brute_force(spline, material, 2048);
      EXPECT_TRUE(relatively_within(found.force.worst, dense.force.worst, 1e-3)) << exponent << " " << segments;
      EXPECT_TRUE(relatively_within(found.energy.worst, dense.energy.worst, 1e-3)) << exponent << " " << segments;
      const double range = material.spline.max_compression_m;
      const double end = spline.segments.back().force_at(range) / material.contact.force(range) - 1;
      const double surplus = end * end * (1.0 / 64 - 1.0 / 2048) / (2 * segments);
      EXPECT_TRUE(relatively_within(found.force.rms, std::sqrt(dense.force.rms * dense.force.rms + surplus), 2e-3));
      EXPECT_TRUE(relatively_within(found.energy.rms, dense.energy.rms, 1e-3));  // exact at the end: no surplus
    }
}

/// 512 speeds against 20,000: by how much the measured figure is too small, as a part of it.
double missed_duration_error(const Material& material) {
  const Spline spline = uniform_spline(material, "felt.json");
  const double found = measure_quality(spline, material).impact->contact_duration;
  const double dense = worst_duration_error(spline, material.contact, *material.impact, 20000);
  return dense / found - 1;
}

TEST(ImpactQuality, IsThatOfBruteForceAtTheSameSpeeds) {
  const Material material = fifty_to_one(2.5, 16);
  const Spline spline = uniform_spline(material, "felt.json");
  const Quality found = measure_quality(spline, material);
  const ReferenceSpline exact = reference_spline(material);
  Real duration_worst = 0, compression_worst = 0;
  for (int i = 0; i < 512; ++i) {
    const double speed = 0.1 * std::pow(50.0, i / 511.0);
    const QuadratureImpact motion = impact_by_quadrature(exact, 0.003, speed);
    const Real power = Real(material.contact.power_law()->exponent) + 1;
    const Real compression =
        pow(power * 0.003 * speed * speed / (2 * material.contact.power_law()->stiffness), 1 / power);
    const Real zeta =
        sqrt(boost::math::constants::pi<Real>()) * tgamma(1 + 1 / power) / tgamma(Real(0.5) + 1 / power);
    duration_worst = std::max(duration_worst, Real(abs(motion.duration * speed / (2 * zeta * compression) - 1)));
    compression_worst = std::max(compression_worst, Real(abs(motion.max_compression / compression - 1)));
  }
  const double bound =
      spline_impact_bound(spline) + duration_bound({"fastest", *material.contact.power_law(), 0.003, 5.0});
  EXPECT_TRUE(within(found.impact->contact_duration, duration_worst.convert_to<double>(), bound));
  EXPECT_TRUE(within(found.impact->max_compression, compression_worst.convert_to<double>(), bound));
}

TEST(ImpactQuality, IsLeftOutWithoutARangeOfImpacts) {
  Material material = fifty_to_one(2.5, 16);
  material.impact.reset();
  EXPECT_FALSE(measure_quality(uniform_spline(material, "felt.json"), material).impact.has_value());
}

// At one speed only there is one error: that of the impact itself.
TEST(ImpactQuality, OfASingleSpeedIsItsOwnError) {
  Material material = fifty_to_one(2.5, 16);
  material.impact->min_speed_m_per_s = material.impact->max_speed_m_per_s = 3;
  const Spline spline = uniform_spline(material, "felt.json");
  const double found = impact_on_spline(spline, 0.003, 3).contact_duration_s;
  EXPECT_EQ(measure_quality(spline, material).impact->contact_duration,
            std::abs(found / contact_duration(material.contact, 0.003, 3) - 1));
}

// The error has a sharp maximum in every segment, the highest among the slow impacts. Up to 64 segments 512 speeds
// meet the highest segment often enough: measured, at most 0.6 % is missed.
TEST(ImpactQuality, IsWithinOnePercentOfADenseSweepUpToSixtyFourSegments) {
  for (const double exponent : {1.1, 1.5, 2.5, 3.155, 5.0})
    for (const int segments : {1, 2, 8, 16, 32, 48, 64}) {
      const double missed = missed_duration_error(fifty_to_one(exponent, segments));
      EXPECT_GE(missed, -1e-9) << exponent << " " << segments;
      EXPECT_LE(missed, 0.01) << exponent << " " << segments;
    }
}

// Beyond, neighbouring speeds turn segments apart: measured, up to 10 % of the figure is missed at 200 segments,
// where the figure itself is 1e-5 to 1e-3. (37 % at 1000 segments, exponent 2.5.)
TEST(ImpactQuality, IsWithinTwelvePercentOfADenseSweepUpToTwoHundredSegments) {
  double worst = 0;
  for (const double exponent : {1.1, 1.5, 2.3, 2.5, 3.155, 5.0})
    for (const int segments : {100, 150, 200}) {
      const double missed = missed_duration_error(fifty_to_one(exponent, segments));
      EXPECT_LE(missed, 0.12) << exponent << " " << segments;
      worst = std::max(worst, missed);
    }
  Measured() << "512 speeds, 100 to 200 segments: up to " << 100 * worst << " % of the figure is missed";
}

}  // namespace
}  // namespace contactspline::testing
