// SPDX-License-Identifier: MIT
// Strings on a body: energy, and the motion against the exact solution of the coupled equations.
#include "contactspline/models/body.hpp"

#include <random>

#include "energy.hpp"
#include "strings_on_body.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"

namespace contactspline::testing {
namespace {

BridgeStiffness sum_of(BridgeStiffness a, const BridgeStiffness& b, const BridgeStiffness& c) {
  a += b;
  return a += c;
}

/// A key with its hammer and its energy.
template <typename T>
class Key {
 public:
  Key(const StruckString& struck, const Strings& strings, double rate)
      : table_(table_in<T>(felt_table(struck, 32))),
        model_(SegmentTable<T>(table_), strings.modes, ModeShapes<T>(vector_of(strings.strike)), rate),
        bridge_(model_.bridge(ModeShapes<T>(strings.bridge))),
        controls_{.hammer_mass_kg = static_cast<T>(struck.hammer_kg)} {}

  void strike(T speed) {
    const double before = hammer_energy();
    model_.strike(speed, T(1e-4));
    work += hammer_energy() - before;
  }
  T tick(T change, T damping) {
    controls_.damping_per_s = damping;
    const T force = model_.tick(controls_, bridge_, change);
    if (has_losses()) dissipated += model_.string().dissipated();
    return force;
  }
  [[nodiscard]] double energy() const { return model_.string().energy() + hammer_energy(); }

  long double work = 0, dissipated = 0;

 private:
  static std::vector<double> vector_of(const ModeShapes<double>& shapes) {
    return {shapes.data(), shapes.data() + shapes.size()};
  }
  [[nodiscard]] double hammer_energy() const {
    const double v = double(model_.hammer_velocity());
    return double(controls_.hammer_mass_kg) * v * v / 2 +
           double(potential(SegmentTable<T>(table_), model_.compression()));
  }

  std::vector<Segment<T>> table_;
  HammerString<T> model_;
  BridgeShapes<T> bridge_;
  HammerStringControls<T> controls_;
};

class StrungBody : public ::testing::TestWithParam<double> {};

// Three keys of one to three strings on a board of 120 modes, struck in turn, in part while they sound, with dampers
// that fall and rise. Bound: 1e-12 of the largest energy.
TEST_P(StrungBody, BalancesItsEnergy) {
  const double rate = GetParam();
  const double limit_hz = std::min(22050.0, rate / 2);
  const Strings low(c2(), {0}, 400, limit_hz), middle(c4(), {0, 0.8, -0.7}, 400, limit_hz),
      high(c7(), {0, 1, -1}, 400, limit_hz);
  const auto modes = board(120);
  Body<double> body(bare(modes), shapes<double>(modes, &ResonatorMode::strike_shape),
                    sum_of(low.stiffness, middle.stiffness, high.stiffness), rate);
  std::vector<Key<double>> keys;
  keys.emplace_back(c2(), low, rate);
  keys.emplace_back(c4(), middle, rate);
  keys.emplace_back(c7(), high, rate);
  EnergyBooks books;
  long double of_body = 0;
  double largest_in_body = 0;
  const int samples = static_cast<int>(4 * rate), period = static_cast<int>(0.11 * rate);
  for (int n = 0; n < samples; ++n) {
    if (n % period == 0) keys[static_cast<std::size_t>(n / period) % 3].strike(1 + n / period % 5);
    const double damping = has_losses() && n / (5 * period) % 2 != 0 ? 60 : 0;
    double force = 0, stored = 0;
    for (auto& key : keys) force += key.tick(body.change(), damping);
    body.tick(force);
    books.work = books.dissipated = 0;
    for (const auto& key : keys) {
      stored += key.energy();
      books.work += key.work;
      books.dissipated += key.dissipated;
    }
    of_body += body.modes().dissipated();
    books.dissipated += of_body;
    largest_in_body = std::max(largest_in_body, body.modes().energy());
    books.close(stored + body.energy());
  }
  Measured() << rate << " Hz: " << books.worst / books.peak << " of the largest energy, "
             << largest_in_body / books.peak << " of it in the board";
  EXPECT_GT(largest_in_body, 0.001 * books.peak);
  EXPECT_TRUE(within(books.worst, 0, 1e-12 * books.peak));
}

INSTANTIATE_TEST_SUITE_P(Rates, StrungBody, ::testing::Values(22050.0, 44100.0, 96000.0));

/// The same at a sample rate: force on the bridge after each sample.
std::vector<double> played(const Strings& strings, const std::vector<ResonatorMode>& modes,
                           const std::vector<double>& displacement, double rate, double duration_s) {
  Body<double> body(bare(modes), shapes<double>(modes, &ResonatorMode::strike_shape), strings.stiffness, rate);
  ModalBank<double> bank(strings.modes, rate);
  const ModeShapes<double> bridge{strings.bridge};
  for (std::size_t i = 0; i < displacement.size(); ++i) bank.set_motion(i, displacement[i], 0);
  std::vector<double> forces;
  for (int n = 0; n < static_cast<int>(duration_s * rate); ++n) {
    bank.predict();
    bank.push(bridge, body.displacement());
    bank.commit();
    forces.push_back(bank.displacement(bridge));
    body.tick(forces.back() - strings.stiffness.modes * body.displacement());
  }
  return forces;
}

// A flexible string that ends at a free mass m: T k cot(k L) = m w^2 (Morse, Vibration and Sound, 1948). The modes
// beyond the N that are kept act as a string without mass: the mass lacks 2 M/(pi^2 N), half of whose part of m the
// frequencies rise at most.
TEST(StrungBodyMotion, HasTheFrequenciesOfAStringAtAMass) {
  const double length = 0.62, tension = 670, density = 0.00634, mass = 0.02;
  StruckString flexible = c4();
  flexible.string = {length, density * length, tension, 0, {0, 0}};
  const Strings strings(flexible, {0}, 40, 22050);
  const std::vector<ResonatorMode> free_mass = {{{0, 0, mass}, 0, 1, 1}};
  const double bound = density * length / (pi * pi * 40) / mass;
  const std::vector<double> frequencies = ExactMotion(strings, free_mass).frequencies();
  const auto residual = [&](double w) {
    const double k = w * std::sqrt(density / tension);
    return tension * k * std::cos(k * length) - mass * w * w * std::sin(k * length);
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const double low = frequencies[i] * (1 - bound), high = frequencies[i] * (1 + 1e-12);
    EXPECT_LT(residual(low) * residual(high), 0) << i;
  }
}

// A string on a bridge that moves at random, with losses and a damper, against its modes one by one: the kernel,
// where there is one, and the scalar code sum up in other orders only.
template <typename T>
void expect_the_modes_motion(double bound) {
  const Strings strings(c4(), {0, 0.8}, 50, 22050);
  const ModeShapes<T> shapes(strings.bridge);
  const StruckString struck = c4();
  const auto felt = table_in<T>(felt_table(struck, 32));
  HammerString<T> model(SegmentTable<T>(felt), strings.modes, ModeShapes<T>(strings.modes.size()), 44100);
  const auto bridge = model.bridge(shapes);
  ModalBank<T> bank(strings.modes, 44100);
  std::mt19937_64 random(5);
  double worst = 0, largest = 0;
  T before = 0;
  for (int n = 0; n < 20000; ++n) {
    const T w = static_cast<T>(std::uniform_real_distribution<double>(-1e-6, 1e-6)(random));
    const T damping_per_s = n / 1000 % 2 == 0 ? T(0) : T(60), damping = damping_per_s * T(1 / 44100.0);
    bank.predict(damping);
    bank.push(shapes, w / (1 + damping));
    bank.commit();
    const double expected = double(bank.displacement(shapes)) - strings.stiffness.modes * double(w);
    const T change = w - std::exchange(before, w);
    const double force =
        double(model.tick({.hammer_mass_kg = T(0.003), .damping_per_s = damping_per_s}, bridge, change));
    worst = std::isfinite(force) ? std::max(worst, std::abs(force - expected)) : force;
    largest = std::max(largest, std::abs(expected));
  }
  EXPECT_GT(largest, 0.01);
  EXPECT_TRUE(within(worst, 0, bound * largest)) << largest;
}

TEST(StringOnABridge, MovesAsItsModesInDouble) {
  expect_the_modes_motion<double>(1e-12);
}
TEST(StringOnABridge, MovesAsItsModesInSingle) {
  expect_the_modes_motion<float>(1e-4);
}

// A body so light that the strings' stiffness is 1e7 times its own inertia over a sample: the bridge stays bounded by
// the energy of the pluck.
TEST(StrungBodyMotion, IsBoundedOnALightBodyInSinglePrecision) {
  const Strings strings(c4(), {0}, 40, 22050);
  const std::vector<Mode> light = {{2 * pi * 200, 5, 1e-9}};
  ModeShapes<float> one(1);
  one[0] = 1;
  Body<float> body(light, one, strings.stiffness, 44100);
  ModalBank<float> bank(strings.modes, 44100);
  const ModeShapes<float> bridge{strings.bridge};
  ModeShapes<float> rest(bridge.size());
  for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = static_cast<float>(bank.compliance(i) * strings.bridge[i]);
  bank.set_motion(0, 1e-3f, 0);
  float largest = 0;
  for (int n = 0; n < 44100; ++n) {
    bank.shift(rest, body.change() / 2);
    bank.advance(0);
    bank.shift(rest, body.change() / 2);
    body.tick(bank.displacement(bridge));
    largest = std::isfinite(body.displacement()) ? std::max(largest, std::abs(body.displacement())) : INFINITY;
  }
  EXPECT_GT(largest, 1e-4f);
  EXPECT_LT(largest, 3e-3f);
}

// The same with three places of which two move alike: the matrix of their receptances has no inverse. Three plucks of
// 1 mm hold T/L pi^2/4 (1 + 4 + 9) 1e-6 m^2, and T/L w^2/2 is a part of that: w is below 8.4 mm.
TEST(StrungBodyMotion, IsBoundedAtPlacesThatMoveAlike) {
  const Strings strings(c4(), {0}, 40, 22050);
  const std::vector<Mode> light = {{2 * pi * 200, 5, 1e-9}, {2 * pi * 310, 5, 1e-9}};
  std::vector<ModeShapes<float>> places(3, ModeShapes<float>(2));
  places[0][0] = places[1][0] = places[2][0] = 1;
  places[2][1] = 0.5f;
  const std::vector<BridgeStiffness> stiffness(3, strings.stiffness);
  Body<float> body(light, places, stiffness, 44100);
  const ModeShapes<float> bridge{strings.bridge};
  std::vector<ModalBank<float>> banks(3, ModalBank<float>(strings.modes, 44100));
  ModeShapes<float> rest(bridge.size());
  for (std::size_t i = 0; i < rest.size(); ++i)
    rest[i] = static_cast<float>(banks[0].compliance(i) * strings.bridge[i]);
  for (std::size_t p = 0; p < 3; ++p) banks[p].set_motion(p, 1e-3f, 0);
  float largest = 0;
  for (int n = 0; n < 44100; ++n) {
    std::vector<float> forces;
    for (std::size_t p = 0; p < 3; ++p) {
      banks[p].shift(rest, body.change(p) / 2);
      banks[p].advance(0);
      banks[p].shift(rest, body.change(p) / 2);
      forces.push_back(banks[p].displacement(bridge));
    }
    body.tick(forces);
    for (std::size_t p = 0; p < 3; ++p)
      largest = std::isfinite(body.displacement(p)) ? std::max(largest, std::abs(body.displacement(p))) : INFINITY;
  }
  Measured() << "at most " << largest << " m";
  EXPECT_GT(largest, 1e-4f);
  EXPECT_LT(largest, 8.4e-3f);
}

// A body at rest stays there while the force is not a number, then keeps the last force.
TEST(Body, KeepsItsForceWhileItIsNotANumber) {
  const Mode mode{2 * std::numbers::pi * 100, 1, 1};
  const double shape = 1;
  Body<double> body({&mode, 1}, ModeShapes<double>({&shape, 1}), {}, 44100);
  Body<double> expected = body;
  body.tick(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(body.change(), 0);
  for (auto* each : {&body, &expected}) {
    each->reset();
    each->tick(10);
  }
  EXPECT_GT(body.change(), 0);
  body.tick(std::numeric_limits<double>::quiet_NaN());
  expected.tick(10);
  EXPECT_EQ(body.change(), expected.change());
}

// A string that is tuned up by an octave is one of four times the tension, at its bridge too.
TEST(BridgeShape, KnowsTheTensionOfATunedString) {
  StiffString tuned = c4().string, tense = tuned;
  tuned.bending_stiffness_n_m2 = tense.bending_stiffness_n_m2 = 0.01;
  tuned.detuning_cents = {1200};
  tense.tension_n *= 4;
  const auto of_tuned = modes_below(tuned, 20000), of_tense = modes_below(tense, 20000);
  ASSERT_EQ(of_tuned.size(), of_tense.size());
  for (std::size_t i = 0; i < of_tuned.size(); ++i)
    EXPECT_TRUE(relatively_within(bridge_shape(tuned, of_tuned[i]), bridge_shape(tense, of_tense[i]), 1e-13));
  EXPECT_TRUE(
      relatively_within(bridge_stiffness(tuned, of_tuned).modes, bridge_stiffness(tense, of_tense).modes, 1e-13));
  EXPECT_TRUE(
      relatively_within(bridge_stiffness(tuned, of_tuned).ends, bridge_stiffness(tense, of_tense).ends, 1e-13));
  const double beta = of_tense[2].wavenumber_per_m;  // -(T beta + EI beta^3) cos(beta L), and cos(3 pi) = -1
  EXPECT_TRUE(
      relatively_within(bridge_shape(tense, of_tense[2]), beta * (tense.tension_n + 0.01 * beta * beta), 1e-13));
}

// Each mode adds 2 (T + EI beta^2)/L to the bridge, the string as a whole T/L.
TEST(BridgeStiffness, IsThatOfAllModes) {
  const Strings strings(c4(), {0}, 30, 22050);
  const StiffString& string = c4().string;
  EXPECT_TRUE(relatively_within(strings.stiffness.ends, string.tension_n / string.length_m, 1e-13));
  double expected = 0;
  for (int i = 1; i <= 30; ++i)
    expected += 2 * (string.tension_n + string.bending_stiffness_n_m2 * std::pow(i * pi / string.length_m, 2)) /
                string.length_m;
  EXPECT_TRUE(relatively_within(strings.stiffness.modes, expected, 1e-13));
}

// A pluck of two strings, eight modes each, on a board of six: the error falls with the square of the rate.
TEST(StrungBodyMotion, IsOfSecondOrder) {
  const Strings strings(c4(), {0, 3}, 8, 22050);
  const auto modes = board(6);
  std::vector<double> pluck;
  for (std::size_t i = 0; i < strings.modes.size(); ++i)
    pluck.push_back(1e-3 * strings.strike[i] / double(i / 2 + 1));
  ExactMotion exact(strings, modes);
  double before = 0;
  for (const double rate : {88200.0, 176400.0, 352800.0}) {
    exact.start(pluck, rate);
    const auto forces = played(strings, modes, pluck, rate, 0.1);
    double worst = 0, largest = 0;
    const auto stride = static_cast<std::size_t>(rate / 2205);  // the same times at each rate
    for (std::size_t n = stride - 1; n < forces.size(); n += stride) {
      const double force = exact.force_at(static_cast<double>(n + 1) / rate);
      worst = std::max(worst, std::abs(forces[n] - force));
      largest = std::max(largest, std::abs(force));
    }
    Measured() << rate << " Hz: " << worst / largest << " of the largest force";
    EXPECT_GT(largest, 0.1);
    if (before > 0) {
      EXPECT_TRUE(relatively_within(before / worst, 4, 0.1));
    }
    before = worst;
  }
}

// Middle C as a piano tunes it, three strings a little apart: they decay together at first, through the bridge, then
// each by itself (Weinreich, JASA 1977). Levels in windows of 0.1 s against the exact motion, and the two slopes.
TEST(StrungBodyMotion, HasTheTwoDecaysOfAUnison) {
  StruckString without_loss = c4();
  without_loss.string.losses = {0.1, 1e-4};
  const Strings strings(without_loss, {0, 0.15, -0.1}, 12, 22050);
  const auto modes = board(40, 3);  // its resistance at the first partial is larger than its stiffness
  std::vector<double> pluck;
  for (std::size_t i = 0; i < strings.modes.size(); ++i)
    pluck.push_back(i < 3 ? 1e-3 + 2e-4 * double(i) : 0);  // the first partial
  ExactMotion exact(strings, modes);
  constexpr double kRate = 44100, kDuration = 8;
  exact.start(pluck, kRate);
  const auto forces = played(strings, modes, pluck, kRate, kDuration);
  expect_two_decays(forces, kRate, 10,
                    [&](std::size_t n) { return exact.force_at(static_cast<double>(n + 1) / kRate); });
}

}  // namespace
}  // namespace contactspline::testing
