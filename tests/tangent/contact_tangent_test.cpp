// SPDX-License-Identifier: MIT
// Derivatives through one contact: central differences in long double, closed forms, and the balance of energy.
#include "contactspline/tangent/contact_tangent.hpp"

#include <array>
#include <utility>
#include <vector>

#include "contactspline/tangent/mass_barrier_tangent.hpp"
#include "exact_felt.hpp"
#include "generator/spline/design.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr std::size_t kMost = 3 + 2 * kMaxMemories + 4;  // directions of a throw
constexpr std::size_t kSamples = 400;

/// A throw of a mass at a felt, with all its numbers in long double.
struct ExactThrow {
  FeltChange felt = {};
  Real mass = 1, gravity = 1, distance = 1, speed = 1;  // factors

  [[nodiscard]] Real& number(std::size_t direction, std::size_t of_felt) {
    if (direction < of_felt) return number_of(felt, direction);
    Real* const others[] = {&mass, &gravity, &distance, &speed};
    return *others[direction - of_felt];
  }
};

struct Throw {
  Throw(Random& random, std::size_t memories)
      : felt(random, memories), rate(random.log_between(16000, 192000)), gravity(random.between(0, 50)) {
    distance = random.uniform() * 3 * felt.speed / rate;
  }

  // Displacements, velocities times dt, and forces, one after the other.
  [[nodiscard]] std::vector<Real> play(const ExactThrow& change) const {
    ExactContact contact(felt, change.felt, rate);
    const Real dt = 1 / Real(rate), xi = dt * dt / (2 * felt.mass * change.mass);
    const Real step = dt * dt * gravity * change.gravity;
    Real y = -distance * change.distance, v = felt.speed * change.speed * dt;
    std::vector<Real> samples;
    for (std::size_t n = 0; n < kSamples; ++n) {
      const auto result = contact.advance({y, v + step / 2, xi});
      y = result.compression;
      v += step - 2 * xi * result.force;
      samples.insert(samples.end(), {y, v, result.force});
    }
    return samples;
  }

  [[nodiscard]] std::vector<ThrowNumbers<double>> directions() const {
    std::vector<ThrowNumbers<double>> all;
    for (const auto& contact : felt_directions(felt)) all.push_back({.contact = contact});
    all.push_back({.mass_kg = felt.mass});
    all.push_back({.gravity_m_per_s2 = gravity});
    all.push_back({.displacement_m = -distance});
    all.push_back({.velocity_m_per_s = felt.speed});
    return all;
  }

  Felt felt;
  double rate, gravity, distance = 0;
};

// Column `part` of three of rows of samples.
template <typename T>
std::vector<T> column(const std::vector<T>& samples, std::size_t part) {
  std::vector<T> values;
  for (std::size_t n = part; n < samples.size(); n += 3) values.push_back(samples[n]);
  return values;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

void expect_central_differences(Random& random, std::size_t memories, double& worst) {
  const Throw thrown(random, memories);
  const auto directions = thrown.directions();
  std::array<ThrowNumbers<double>, kMost> padded;
  std::ranges::copy(directions, padded.begin());
  MassBarrierTangent<double, kMost> tangent(SegmentTable<double>(thrown.felt.table), thrown.rate,
                                            {thrown.felt.mass, thrown.gravity, {thrown.felt.ratio, thrown.felt.loss}},
                                            padded, thrown.felt.memories);
  tangent.throw_from(-thrown.distance, thrown.felt.speed);
  std::vector<std::vector<double>> found(directions.size());
  for (std::size_t n = 0; n < kSamples; ++n) {
    tangent.tick();
    for (std::size_t p = 0; p < directions.size(); ++p)
      for (const double slope :
           {tangent.displacement().slopes[p], tangent.velocity().slopes[p] / thrown.rate, tangent.force().slopes[p]})
        found[p].push_back(slope);
  }
  for (std::size_t p = 0; p < directions.size(); ++p) {
    const auto expected = central_difference([&](Real h) {
      ExactThrow change;
      change.number(p, 3 + 2 * memories) += h;
      return thrown.play(change);
    });
    for (const std::size_t part : {0U, 1U, 2U}) {
      const auto slopes = column(found[p], part), differences = column(expected, part);
      const double scale = largest(differences);
      if (scale == 0) continue;  // no loss, no gravity
      for (std::size_t n = 0; n < kSamples; ++n) {
        ASSERT_TRUE(within(slopes[n], differences[n], 1e-6 * scale))
            << "direction " << p << " of " << directions.size() << ", part " << part << ", sample " << n;
        worst = std::max(worst, std::abs(slopes[n] - differences[n]) / scale);
      }
    }
  }
}

TEST(MassBarrierTangent, IsTheCentralDifferenceInLongDouble) {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < 60 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    expect_central_differences(random, static_cast<std::size_t>(i % 4), worst);
  }
  Measured() << "worst difference, over the largest slope of each run: " << worst;
}

/// Two equal balls of a power law that meet, without loss: their positions after the contact.
struct Balls {
  using Number = Dual<double, 2>;
  Number first, second;
};

// The derivatives with respect to both initial positions. phase: when in a sample they meet.
Balls collided(double rate, double phase, int segments) {
  using Number = Dual<double, 2>;
  const double mass = 0.003, speed = 2.5, dt = 1 / rate;
  const Table table = power_table(4.5e9, 2.5, 1.2e-3, segments);
  ContactTangent<double, 2> contact(SegmentTable<double>(table), {}, rate, {});
  Number first(-speed * dt * phase, {1, 0}), second(0, {0, 1});
  Number first_velocity(speed), second_velocity(0), compression = first - second;
  const Number xi(dt * dt / mass);
  for (int n = 0; n < 400; ++n) {
    const Number xf = Number(dt) * (first_velocity - second_velocity);
    const auto model = contact_step(SegmentTable<double>(table), Approach{compression.value, xf.value, xi.value});
    const auto step = contact.advance({}, compression, xf, xi, model.force, model.compression);
    const Number change = Number(dt / mass) * step.force;
    first = first + Number(dt) * (first_velocity - Number(0.5) * change);
    second = second + Number(dt) * (second_velocity + Number(0.5) * change);
    first_velocity = first_velocity - change;
    second_velocity = second_velocity + change;
    compression = step.compression;
  }
  EXPECT_LT(compression.value, 0);
  return {first, second};
}

// They exchange their motion: each ends where the other would, whenever the contact was. What remains is the jumps of
// the stiffness at knots, which many segments make small; they cost nothing.
TEST(ContactTangent, TwoEqualBallsExchangeTheirPlaces) {
  for (const auto& [segments, bound] : {std::pair{64, 2e-4}, std::pair{1024, 1e-5}}) {
    double worst = 0;
    for (int i = 0; i < 10; ++i) {
      const auto [first, second] = collided(44100, 0.1 * i, segments);
      const double slopes[] = {second.slopes[0], second.slopes[1], first.slopes[1], first.slopes[0]};
      const double exact[] = {1, 0, 1, 0};
      for (int k = 0; k < 4; ++k) {
        EXPECT_TRUE(within(slopes[k], exact[k], bound))
            << segments << " segments, phase " << i << ", derivative " << k;
        worst = std::max(worst, std::abs(slopes[k] - exact[k]));
      }
    }
    Measured() << "two balls, " << segments << " segments, worst of ten phases: " << worst;
  }
}

constexpr PowerLaw kFelt{4.5e9, 2.5};
constexpr double kMass = 0.003, kSpeed = 2.5;

/// The duration of a contact, and the derivatives of its ln with respect to ln of stiffness, mass and speed.
struct Duration {
  double seconds;
  std::array<double, 3> slopes;
};

// of_stiffness, of_mass: directions of the table.
Duration duration_with(SegmentTable<double> table, double rate, std::vector<Segment<double>> of_stiffness,
                       std::vector<Segment<double>> of_mass) {
  std::array<ThrowNumbers<double>, 3> directions;
  directions[0].contact.table = std::move(of_stiffness);
  directions[1].contact.table = std::move(of_mass);
  directions[1].mass_kg = kMass;
  directions[2].velocity_m_per_s = kSpeed;
  MassBarrierTangent<double, 3> thrown(table, rate, {.mass_kg = kMass}, directions);
  thrown.throw_from(0, kSpeed);
  int samples = 0;
  do {
    thrown.tick();
    ++samples;
  } while (thrown.displacement().value > 0 || thrown.force().value > 0);
  const auto duration = Dual<double, 3>(samples / rate) - thrown.displacement() / thrown.velocity();
  return {duration.value, (duration / Dual<double, 3>(duration.value)).slopes};
}

// The duration is proportional to k^(-1/(a + 1)), m^(1/(a + 1)) and v^(-(a - 1)/(a + 1)).
void expect_closed_form(const char* table, double rate, const Duration& found, double bound) {
  const double a = kFelt.exponent, exact[] = {-1 / (a + 1), 1 / (a + 1), -(a - 1) / (a + 1)};
  const double seconds = kFelt.contact_duration(kMass, kSpeed);
  EXPECT_TRUE(relatively_within(found.seconds, seconds, bound)) << table << ", " << rate << " Hz";
  Measured() << table << " table at " << rate << " Hz: error of the duration " << found.seconds / seconds - 1;
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_TRUE(relatively_within(found.slopes[p], exact[p], bound)) << table << ", " << rate << " Hz, " << p;
    Measured() << table << " table at " << rate << " Hz: derivative of ln duration " << found.slopes[p] << " for "
               << exact[p] << ", error " << found.slopes[p] / exact[p] - 1;
  }
}

// The time that a step takes is wrong in second order, and so are the duration and its derivatives.
TEST(MassBarrierTangent, ContactDurationFollowsTheClosedForm) {
  const Table table = power_table(kFelt.stiffness, kFelt.exponent, 1.2e-3, 1024);
  for (const auto& [rate, bound] : {std::pair{44100.0, 3e-3}, std::pair{88200.0, 1e-3}})
    expect_closed_form("plain", rate, duration_with(SegmentTable<double>(table), rate, table, {}), bound);
}

// The compensation of a material takes this error away at the rate that it is made for.
TEST(MassBarrierTangent, ContactDurationOfACompensatedMaterialFollowsTheClosedForm) {
  for (const double rate : {44100.0, 88200.0}) {
    Material felt{"felt", "", kFelt, Impact{kMass, kSpeed, kSpeed / 50}, {1024, 0, Knots::graded}};
    felt.spline.max_compression_m = kFelt.max_compression(kMass, kSpeed);
    felt.compensation = Compensation{rate, kMass};
    const auto spline = design_spline(felt, "felt.json");
    const Table table = segment_table(spline);
    const CompensatedFor<double> made{1 / rate, kMass};
    expect_closed_form("compensated", rate,
                       duration_with(SegmentTable<double>(table), rate,
                                     compensated_direction<double>(table, spline.end_m, made, table),
                                     compensated_direction<double>(table, spline.end_m, made, {}, kMass)),
                       1e-3);
  }
}

// The energy m v^2/2 + V(y) is that of the throw, so its derivatives are, too.
TEST(MassBarrierTangent, DerivativesOfTheEnergyStay) {
  const double mass = 0.003, speed = 2.5;
  const Table table = power_table(4.5e9, 2.5, 1.2e-3, 40);
  const SegmentTable<double> segments(table);
  std::array<ThrowNumbers<double>, 3> directions;
  directions[0].contact.stiffness_ratio = 1;
  directions[1].contact.table = exponent_direction(segments, 1.2e-3, 1e-3);
  directions[2].velocity_m_per_s = 1;
  MassBarrierTangent<double, 3> thrown(segments, 44100.0, {.mass_kg = mass}, directions);
  thrown.throw_from(-1e-5, speed);
  const double rounding = 1e-12;  // thousands of roundings of terms of this size
  for (int n = 0; n < 300; ++n) {
    thrown.tick();
    const double y = thrown.displacement().value, v = thrown.velocity().value;
    for (std::size_t p = 0; p < 3; ++p) {
      double slope = mass * v * thrown.velocity().slopes[p] + force(segments, y) * thrown.displacement().slopes[p];
      if (p == 0) slope += potential(segments, y);
      if (p == 1) slope += directions[1].contact.table[segment_index(segments, y)].energy_at(y);
      EXPECT_TRUE(within(slope, p == 2 ? mass * speed : 0, rounding * mass * speed)) << p << ", sample " << n;
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
