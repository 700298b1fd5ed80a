// SPDX-License-Identifier: MIT
// Derivatives of a struck string, forwards and backwards: against central differences in long double and each other.
#include "contactspline/tangent/strike_tangent.hpp"

#include <numbers>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/tangent/strike_gradient.hpp"
#include "exact_felt.hpp"
#include "support/compare.hpp"
#include "support/count_allocations.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

constexpr std::size_t kModes = 24, kSamples = 700, kMemories = 2;
constexpr std::size_t kOfFelt = 3 + 2 * kMemories;
// Mass, speed and distance of the hammer; length, mass, tension, bending stiffness and two losses of the string;
// places of strike and pickup.
constexpr std::size_t kOthers = 11, kDirections = kOfFelt + kOthers;

/// A string, its hammer and its felt.
struct StruckAtRandom {
  explicit StruckAtRandom(Random& random)
      : felt(random, random.below(kMemories + 1)),
        string{random.between(0.3, 1.5),
               random.log_between(1e-3, 3e-2),
               random.between(300, 900),
               random.log_between(1e-4, 1e-1),
               {random.between(0.1, 3), random.log_between(1e-4, 1e-3)}},
        strike_m(random.between(0.08, 0.2) * string.length_m),
        pickup_m(random.between(0.3, 0.6) * string.length_m),
        distance(random.between(0, 2e-4)),
        damping(random.once_in(2) ? 20.0 : 0.0) {
    rows = modes_below(string, 100 * kRate, kModes);
    modes = bare(rows);
  }

  [[nodiscard]] HammerStrike<double> strike() const {
    return {SegmentTable<double>(felt.table),
            modes,
            shapes(strike_m),
            shapes(pickup_m),
            {felt.mass, {felt.ratio, felt.loss}, damping},
            felt.speed,
            distance,
            felt.memories};
  }
  [[nodiscard]] ModeShapes<double> shapes(double place) const {
    ModeShapes<double> values(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) values[i] = std::sin(rows[i].wavenumber_per_m * place);
    return values;
  }

  // In relative changes, as the references move them.
  [[nodiscard]] std::array<StrikeNumbers<double>, kDirections> directions() const {
    std::array<StrikeNumbers<double>, kDirections> all;
    const auto of_felt = felt_directions(felt);
    for (std::size_t p = 0; p < of_felt.size(); ++p) all[p].felt = of_felt[p];
    all[kOfFelt].hammer_mass_kg = felt.mass;
    all[kOfFelt + 1].velocity_m_per_s = felt.speed;
    all[kOfFelt + 2].distance_m = distance;
    double StiffString::*const of_string[] = {&StiffString::length_m, &StiffString::mass_kg, &StiffString::tension_n,
                                              &StiffString::bending_stiffness_n_m2};
    for (std::size_t k = 0; k < 6; ++k) {
      StiffString change{};
      if (k < 4) change.*of_string[k] = string.*of_string[k];
      if (k == 4) change.losses.constant_per_s = string.losses.constant_per_s;
      if (k == 5) change.losses.quadratic_m2_per_s = string.losses.quadratic_m2_per_s;
      StrikeNumbers<double>& direction = all[kOfFelt + 3 + k];
      direction.modes = modes_tangent(string, rows, change);
      direction.strike = shapes_tangent<double>(string, rows, strike_m, 0, change.length_m);
      direction.output = shapes_tangent<double>(string, rows, pickup_m, 0, change.length_m);
    }
    all[kOfFelt + 9].strike = shapes_tangent<double>(string, rows, strike_m, strike_m, 0);
    all[kOfFelt + 10].output = shapes_tangent<double>(string, rows, pickup_m, pickup_m, 0);
    return all;
  }

  static constexpr double kRate = 44100;
  Felt felt;
  StiffString string;
  double strike_m, pickup_m, distance, damping;
  std::vector<StringMode> rows;
  std::vector<Mode> modes;
};

/// The same in long double, with every number times a factor.
struct ExactStrike {
  FeltChange felt = {};
  Real others[kOthers] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

  struct ExactMode {
    Real stiffness, loss, push, shape, output, receptance;
  };

  [[nodiscard]] std::vector<ExactMode> modes_of(const StruckAtRandom& s) const {
    const Real length = s.string.length_m * others[3], mass = s.string.mass_kg * others[4], dt = 1 / Real(s.kRate);
    std::vector<ExactMode> modes;
    for (std::size_t i = 1; i <= s.rows.size(); ++i) {
      const Real beta = std::numbers::pi_v<Real> * Real(i) / length;
      const Real decay =
          s.string.losses.constant_per_s * others[7] + s.string.losses.quadratic_m2_per_s * others[8] * beta * beta;
      const Real square = (s.string.tension_n * others[5] * beta * beta +
                           s.string.bending_stiffness_n_m2 * others[6] * beta * beta * beta * beta) *
                          length / mass;
      const Real w = std::sqrt(square - decay * decay), half_sine = std::sin(w * dt / 2);
      const Real r = std::exp(-decay * dt), lost = -std::expm1(-decay * dt);  // |1 - z|^2 without cancellation:
      const Real stiffness = lost * lost + 4 * r * half_sine * half_sine;
      const Real receptance = w * dt < std::numbers::pi_v<Real> ? stiffness / (mass * square) : 0;
      const Real shape = std::sin(beta * s.strike_m * others[9]);
      modes.push_back({stiffness, -std::expm1(-2 * decay * dt), receptance * shape, shape,
                       std::sin(beta * s.pickup_m * others[10]), receptance * shape * shape});
    }
    return modes;
  }

  // Outputs, then forces.
  [[nodiscard]] std::vector<Real> play(const StruckAtRandom& s) const {
    const Real dt = 1 / Real(s.kRate), gain = 1 / (1 + s.damping * dt), mass = s.felt.mass * others[0];
    const auto modes = modes_of(s);
    ExactContact contact(s.felt, felt, s.kRate);
    Real receptance = dt * dt / (2 * mass), y = -s.distance * others[2], v = s.felt.speed * others[1];
    for (const ExactMode& mode : modes) receptance += gain * mode.receptance;
    std::vector<Real> q(modes.size()), d(modes.size()), outputs, forces;
    for (std::size_t n = 0; n < kSamples; ++n) {
      Real xf = dt * v, output = 0;
      for (std::size_t i = 0; i < modes.size(); ++i) xf -= gain * modes[i].shape * d[i];
      const auto step = contact.advance({y, xf, receptance});
      y = step.compression;
      v -= dt / mass * step.force;
      for (std::size_t i = 0; i < modes.size(); ++i) {
        const Real c = gain * (d[i] + modes[i].push * step.force);
        q[i] += c;
        d[i] = 2 * c - d[i] - modes[i].loss * c - modes[i].stiffness * q[i];
        output += modes[i].output * q[i];
      }
      outputs.push_back(output);
      forces.push_back(step.force);
    }
    outputs.insert(outputs.end(), forces.begin(), forces.end());
    return outputs;
  }
};

double largest(std::span<const double> values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// Slopes of outputs, then of forces, in each direction.
std::vector<std::vector<double>> forwards(const StruckAtRandom& struck) {
  StrikeTangent<double, kDirections> tangent(struck.strike(), struck.kRate, struck.directions());
  std::vector<std::vector<double>> slopes(kDirections, std::vector<double>(2 * kSamples));
  for (std::size_t n = 0; n < kSamples; ++n) {
    const auto output = tangent.tick();
    for (std::size_t p = 0; p < kDirections; ++p) {
      slopes[p][n] = output.slopes[p];
      slopes[p][kSamples + n] = tangent.force().slopes[p];
    }
  }
  return slopes;
}

TEST(StrikeTangent, IsTheCentralDifferenceInLongDouble) {
  Random random(1);
  double worst = 0;
  for (int i = 0; i < 20 && !HasFailure(); ++i) {
    const StruckAtRandom struck(random);
    const auto slopes = forwards(struck);
    for (std::size_t p = 0; p < kDirections; ++p) {
      if (p >= 3 + 2 * struck.felt.memories.size() && p < kOfFelt) continue;
      const bool is_weak = p == kOfFelt + 7 || p == kOfFelt + 8;  // the string's losses: a contact hardly feels them
      const auto expected = central_difference(
          [&](Real h) {
            ExactStrike exact;
            (p < kOfFelt ? number_of(exact.felt, p) : exact.others[p - kOfFelt]) += h;
            return exact.play(struck);
          },
          is_weak ? 1e-4L : 1e-7L);
      for (const std::size_t first : {std::size_t(0), kSamples}) {
        const double scale = largest(std::span(expected).subspan(first, kSamples));
        for (std::size_t n = first; n < first + kSamples && scale > 0; ++n) {
          ASSERT_TRUE(within(slopes[p][n], expected[n], 1e-6 * scale))
              << "strike " << i << ", direction " << p << ", " << (first > 0 ? "force " : "output ") << n - first;
          worst = std::max(worst, std::abs(slopes[p][n] - expected[n]) / scale);
        }
      }
    }
  }
  Measured() << "worst difference, over the largest slope of each run: " << worst;
}

// Beside the model, in blocks of any length, also after the hammer is stopped.
TEST(StrikeTangent, PlaysTheModel) {
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    const StruckAtRandom struck(random);
    const HammerStrike<double> strike = struck.strike();
    auto model = detail::struck(strike, struck.kRate);
    std::vector<double> expected(6000), found;
    model.process(strike.controls, strike.output, expected);
    StrikeTangent<double, kDirections> tangent(strike, struck.kRate, struck.directions());
    std::vector<Dual<double, kDirections>> block;
    while (found.size() < expected.size()) {
      block.resize(std::min(expected.size() - found.size(), 1 + random.below(40)));
      tangent.process(block);
      for (const auto& output : block) found.push_back(output.value);
    }
    EXPECT_EQ(tangent.is_hammer_flying(), model.is_hammer_flying());
    EXPECT_TRUE(sequences_within<double>(found, expected, 1e-11)) << "strike " << i;  // thousands of roundings
  }
}

// Also in the sample in which the hammer stops.
TEST(StrikeTangent, AllocatesNothingAfterConstruction) {
  Random random(4);
  for (int i = 0; i < 10; ++i) {
    const StruckAtRandom struck(random);
    StrikeTangent<double, kDirections> tangent(struck.strike(), struck.kRate, struck.directions());
    std::vector<Dual<double, kDirections>> block(40);
    const std::size_t before = allocations;
    for (int n = 0; n < 400; ++n) tangent.process(block);
    EXPECT_EQ(allocations, before) << "strike " << i;
    EXPECT_FALSE(tangent.is_hammer_flying()) << "strike " << i;
  }
}

// The same derivatives the other way round: sums of thousands of products, each rounded.
TEST(StrikeGradient, IsTheTangentReadBackwards) {
  Random random(2);
  double worst = 0;
  for (int i = 0; i < 40; ++i) {
    const StruckAtRandom struck(random);
    const auto slopes = forwards(struck);
    std::vector<double> weights(2 * kSamples);
    for (double& weight : weights) weight = random.between(-1, 1);
    const std::span<const double> all(weights);
    const auto gradient = strike_gradient(struck.strike(), struck.kRate, all.first(kSamples), all.subspan(kSamples));
    const auto directions = struck.directions();
    for (std::size_t p = 0; p < kDirections; ++p) {
      double expected = 0, scale = 0;
      for (std::size_t n = 0; n < 2 * kSamples; ++n) {
        expected += weights[n] * slopes[p][n];
        scale += std::abs(weights[n] * slopes[p][n]);
      }
      const double found = derivative(gradient, directions[p]);
      EXPECT_TRUE(within(found, expected, 1e-10 * scale)) << "strike " << i << ", direction " << p;
      if (scale > 0) worst = std::max(worst, std::abs(found - expected) / scale);
    }
  }
  Measured() << "worst difference, over the sum of the sizes: " << worst;
}

TEST(StrikeGradient, TakesMissingForceWeightsAs0) {
  Random random(5);
  const StruckAtRandom struck(random);
  const auto directions = struck.directions();
  const std::vector<double> outputs(kSamples);
  std::vector<double> whole(kSamples);
  for (std::size_t n = 0; n < 40; ++n) whole[n] = random.between(-1, 1);
  const std::vector<double> part(whole.begin(), whole.begin() + 40);  // what lies behind it is not its own
  const auto gradient_for = [&](std::span<const double> forces) {
    return strike_gradient<double>(struck.strike(), struck.kRate, outputs, forces);
  };
  const auto expected = gradient_for(whole), found = gradient_for(part), none = gradient_for({});
  EXPECT_NE(expected.velocity_m_per_s, 0);
  for (std::size_t p = 0; p < kDirections; ++p) {
    EXPECT_EQ(derivative(found, directions[p]), derivative(expected, directions[p])) << "direction " << p;
    EXPECT_EQ(derivative(none, directions[p]), 0) << "direction " << p;
  }
}

}  // namespace
}  // namespace contactspline::testing
