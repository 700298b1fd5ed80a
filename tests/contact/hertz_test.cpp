// SPDX-License-Identifier: MIT
// Hertz contacts against published contact times, and against the integrals from which the theory begins.
#include "generator/contact/hertz.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/exp_sinh.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

using Shape = ElasticBody::Shape;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ElasticBody steel(Shape shape, double radius_m = kInfinity) {
  return {shape, 210e9, 0.3, radius_m};
}

double steel_ball_kg(double radius_m) {
  return 7850 * 4.0 / 3 * std::numbers::pi * std::pow(radius_m, 3);
}

// T = 2.87 (m^2/(R E*^2 v))^(1/5), as it is printed: three digits.
TEST(SteelBallOnSteelPlate, LastsAsLongAsHertzClosedForm) {
  for (const double radius_m : {0.00079, 0.005, 0.01, 0.025})
    for (const double speed : {0.01, 0.1, 1.0, 3.0}) {
      const PowerLaw law = hertz_law(steel(Shape::kSphere, radius_m), steel(Shape::kPlane));
      const double modulus = 210e9 / (2 * (1 - 0.3 * 0.3));
      const double mass = steel_ball_kg(radius_m);
      const double printed = 2.87 * std::pow(mass * mass / (radius_m * modulus * modulus * speed), 0.2);
      EXPECT_TRUE(relatively_within(law.contact_duration(mass, speed), printed, 0.005 / 2.87));
    }
}

// G. C. McLaskey, Ball impact and sensor calibration (with S. D. Glaser, J. Acoust. Soc. Am. 128, 2010): a steel
// ball, 1.58 mm across, that bounces on a steel plate 50 mm thick is in contact for "about 5 microseconds". The
// height of the fall is not given; 5 cm to 30 cm make 1 to 2.4 m/s, and 4.5 to 5.5 us count as about 5.
TEST(SteelBallOnSteelPlate, LastsAsLongAsMeasured) {
  const PowerLaw law = hertz_law(steel(Shape::kSphere, 0.00079), steel(Shape::kPlane));
  for (const double height_m : {0.05, 0.1, 0.2, 0.3}) {
    const double duration = law.contact_duration(steel_ball_kg(0.00079), std::sqrt(2 * 9.81 * height_m));
    Measured() << "fall of " << height_m << " m: " << 1e6 * duration << " us";
    EXPECT_TRUE(within(duration, 5e-6, 0.5e-6)) << height_m;
  }
}

// F = (4/3) E* sqrt(R) y^1.5, 1/E* and 1/R the sums for both bodies.
TEST(Spheres, HaveTheClosedForm) {
  const ElasticBody rubber{Shape::kSphere, 2.5e6, 0.49, 0.0125};
  const ElasticBody ball = steel(Shape::kSphere, 0.03);
  const double modulus = 1 / ((1 - 0.49 * 0.49) / 2.5e6 + (1 - 0.09) / 210e9);
  const double radius = 1 / (1 / 0.0125 + 1 / 0.03);
  for (const PowerLaw& law : {hertz_law(rubber, ball), hertz_law(ball, rubber)}) {
    EXPECT_EQ(law.exponent, 1.5);
    EXPECT_TRUE(relatively_within(law.stiffness, 4.0 / 3 * modulus * std::sqrt(radius), 1e-14));
  }
}

// The material that ships as a power law, rounded there to five digits.
TEST(Spheres, AreThoseOfTheShippedMaterials) {
  EXPECT_TRUE(
      relatively_within(hertz_law(steel(Shape::kSphere, 0.005), steel(Shape::kPlane)).stiffness, 1.0879e10, 0.5e-4));
}

// Equal crossed cylinders touch in a circle, as a sphere of their radius on a plane does.
TEST(CrossedCylinders, OfEqualRadiusAreASphereOnAPlane) {
  const PowerLaw crossed = hertz_law(steel(Shape::kCylinder, 0.002), steel(Shape::kCylinder, 0.002));
  const PowerLaw sphere = hertz_law(steel(Shape::kSphere, 0.002), steel(Shape::kPlane));
  EXPECT_EQ(crossed.stiffness, sphere.stiffness);
}

// The two branches of the code meet: a radius that differs by 1e-7 changes the stiffness by half of that, not more.
TEST(CrossedCylinders, ChangeSmoothlyFromCircleToEllipse) {
  const double round = hertz_law(steel(Shape::kCylinder, 0.002), steel(Shape::kCylinder, 0.002)).stiffness;
  const double nearly =
      hertz_law(steel(Shape::kCylinder, 0.002), steel(Shape::kCylinder, 0.002 * (1 + 1e-7))).stiffness;
  EXPECT_TRUE(within(nearly / round - 1, 0.25e-7, 1e-12));
}

/// The pressure of a contact ellipse with half axes a, b presses these in (Landau and Lifshitz, Theory of Elasticity,
/// section 9), for F = 4/3 E* pi: approach and half curvatures.
struct EllipseIntegrals {
  double approach, half_curvature_a, half_curvature_b;

  EllipseIntegrals(double a, double b) {
    boost::math::quadrature::exp_sinh<double> rule;
    // xi = w^2 takes the root at 0 away.
    const auto integral = [&](double power_a, double power_b) {
      return rule.integrate(
          [=](double w) {
            const double p = a * a + w * w, q = b * b + w * w;
            return 2 / (std::sqrt(p * q) * std::pow(p, power_a) * std::pow(q, power_b));
          },
          1e-14);
    };
    approach = integral(0, 0);
    half_curvature_a = integral(1, 0);
    half_curvature_b = integral(0, 1);
  }
};

// For ellipses from nearly round to 30 to 1: from the half axes the integrals give the radii of two crossed
// cylinders, or of a sphere on a cylinder, and the approach; the law must give back the force. No elliptic function
// in common.
TEST(CrossedCylinders, FollowFromTheIntegralsOfTheTheory) {
  double worst = 0;
  for (const double ratio : {1.001, 1.1, 1.5, 2.0, 5.0, 10.0, 30.0}) {
    const double b = 1e-4, a = ratio * b, modulus = 210e9 / (2 * (1 - 0.09));
    const EllipseIntegrals integrals(a, b);
    const double force = 4.0 / 3 * modulus * std::numbers::pi;
    const double one = 1 / (2 * integrals.half_curvature_a), other = 1 / (2 * integrals.half_curvature_b);
    const PowerLaw crossed = hertz_law(steel(Shape::kCylinder, one), steel(Shape::kCylinder, other));
    const double error = crossed.force(integrals.approach) / force - 1;
    worst = std::max(worst, std::abs(error));
    EXPECT_TRUE(within(error, 0, 1e-10)) << ratio;
    // A sphere of the larger radius on a cylinder whose curvature is what is left.
    const ElasticBody sphere = steel(Shape::kSphere, one);
    const ElasticBody cylinder = steel(Shape::kCylinder, 1 / (1 / other - 1 / one));
    EXPECT_TRUE(relatively_within(hertz_law(sphere, cylinder).stiffness, crossed.stiffness, 1e-9)) << ratio;
    EXPECT_EQ(hertz_law(sphere, cylinder).stiffness, hertz_law(cylinder, sphere).stiffness);
  }
  Measured() << "crossed cylinders: worst error " << worst;
}

TEST(Contact, IsAtAPointUnlessSomethingFlatMeetsAPlaneOrACylinder) {
  const ElasticBody sphere = steel(Shape::kSphere, 1), cylinder = steel(Shape::kCylinder, 1),
                    plane = steel(Shape::kPlane);
  for (const auto& other : {sphere, cylinder, plane}) {
    EXPECT_TRUE(touch_at_a_point(sphere, other));
    EXPECT_TRUE(touch_at_a_point(other, sphere));
  }
  EXPECT_TRUE(touch_at_a_point(cylinder, cylinder));
  EXPECT_FALSE(touch_at_a_point(cylinder, plane));
  EXPECT_FALSE(touch_at_a_point(plane, cylinder));
  EXPECT_FALSE(touch_at_a_point(plane, plane));
}

}  // namespace
}  // namespace contactspline::testing
