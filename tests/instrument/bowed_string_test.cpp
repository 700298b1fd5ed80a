// SPDX-License-Identifier: MIT
// Friction of instrument files: a mass on a belt, and a bowed string.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/input_file.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/precisions.hpp"
#include "support/seen_network.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

// Parameters by their names.
template <typename T>
struct Played {
  explicit Played(const InstrumentModel& of) : model(of), instrument(arrays.view(), kRate) {}

  void set(const std::string& name, double value) {
    const auto found = std::ranges::find(model.parameters, name, &ModelParameter::name);
    ASSERT_NE(found, model.parameters.end()) << name;
    instrument.set(static_cast<std::size_t>(found - model.parameters.begin()), value);
  }
  void tick(double duration_s) {
    for (int n = 0; n < duration_s * kRate; ++n) instrument.tick();
  }

  InstrumentModel model;
  InstrumentArrays arrays = arrays_of(model, kRate / 2);
  SeenNetwork<T> instrument;
};

// A belt at 1 m/s under a mass of 0.2 kg, which a constant friction of 0.4 times 2 N accelerates by 4 m/s^2. It
// yields at 4e-10 m, within the first sample. Half a sample of its motion is 1e-4 of the speed.
TEST(FrictionOfAFile, AcceleratesAMassOnABelt) {
  Played<double> belt(parse_instrument(R"({
    "name": "probe",
    "bodies": [ { "name": "mass", "mass_kg": 0.2 } ],
    "frictions": [ { "name": "belt", "between": ["ground", "mass"], "coefficient": 0.4, "stiffness_per_m": 1e9,
                     "normal_force_n": 2, "surface_speed_m_per_s": 1 } ],
    "controls": [ { "name": "belt", "normal_force_n": "belt" } ],
    "outputs": [ { "name": "mass", "velocity_m_per_s": "mass" }, { "name": "belt", "force_n": "belt" } ]
  })",
                                       "probe.json"));
  EXPECT_FALSE(belt.instrument.is_silent(1e-14)) << "it is about to move";
  const double energy = belt.instrument.energy();
  double balance = energy;
  for (int n = 0; n < 4410; ++n) {
    belt.instrument.tick();
    balance += belt.instrument.work() - belt.instrument.dissipated();
  }
  EXPECT_TRUE(relatively_within(belt.instrument.output(0), 0.4, 2e-4));
  EXPECT_TRUE(relatively_within(belt.instrument.output(1), 0.8, 1e-12));
  EXPECT_TRUE(relatively_within(belt.instrument.energy(), balance, 1e-12));
  belt.set("belt_normal_force_n", 0);
  belt.instrument.tick();
  EXPECT_EQ(belt.instrument.output(1), 0);
}

template <typename T>
struct Violin : Played<T> {
  explicit Violin(const std::string& name = "violin_d4")
      : Played<T>(parse_instrument(read_input(EXAMPLES_FOLDER "/" + name + ".json"), name)) {
    while (this->arrays.connections[bow].kind != ConnectionKind::kFriction) ++bow;
    EXPECT_FALSE(this->instrument.is_in_double());
  }

  void stroke(double force_n, double speed_m_per_s) {
    this->set("bow_normal_force_n", force_n);
    this->set("bow_surface_speed_m_per_s", speed_m_per_s);
  }

  std::size_t bow = 0;
};

// Slips in a period of the string, and their mean rate beside its pitch.
struct Slips {
  double count_per_period, cents;
};

// In the next 0.4 s under a bow. A slip counts that follows a stick and is faster than a fifth of that of Helmholtz
// motion.
constexpr double kFrequency_hz = 293.66, kSpeed_m_per_s = 0.15;
template <typename T>
Slips slips_of(Violin<T>& violin) {
  constexpr double kPlace = 0.039 / 0.325;
  std::vector<int> begins;
  bool has_stuck = false;
  for (int n = 0; n < 0.4 * kRate; ++n) {
    violin.instrument.tick();
    const double slip = double(violin.instrument.slip(violin.bow)) * kRate / kSpeed_m_per_s;
    if (slip > 0.2 / kPlace && std::exchange(has_stuck, false)) begins.push_back(n);
    has_stuck |= slip < 0.05;
  }
  const double per_s =
      begins.size() < 2 ? 0 : kRate * double(begins.size() - 1) / double(begins.back() - begins.front());
  return {per_s / kFrequency_hz, 1200 * std::log2(per_s / kFrequency_hz)};
}

template <typename T>
void begin_stroke(Violin<T>& violin, double force_n) {
  for (int n = 0; n < 4410; ++n) {
    violin.stroke(force_n, kSpeed_m_per_s * n / 4410);
    violin.instrument.tick();
  }
}

template <typename T>
Slips slips_under(double force_n) {
  Violin<T> violin;
  begin_stroke(violin, force_n);
  violin.tick(0.5);
  const Slips slips = slips_of(violin);
  Measured() << force_n << " N: " << slips.count_per_period << " slips a period, " << slips.cents << " cents";
  return slips;
}

CONTACTSPLINE_EACH_PRECISION(BowedViolin);

// Helmholtz motion, at the pitch of the string, which stiffness raises and a bow lowers by some cents.
TYPED_TEST(BowedViolin, SlipsOnceAPeriod) {
  for (const double force_n : {0.15, 0.25, 0.4}) {
    const Slips slips = slips_under<TypeParam>(force_n);
    EXPECT_TRUE(within(slips.cents, 0, 10)) << force_n;
  }
}

TYPED_TEST(BowedViolin, SlipsSeveralTimesAPeriodUnderTooLittleForce) {
  EXPECT_GT(slips_under<TypeParam>(0.07).count_per_period, 1.7);
}

// A finger that stops the string 200 cents up glides to 700 cents within 0.4 s, trembles by 25 cents 5.5 times a
// second and comes to rest: once a period the string slips all the same, at the pitch of the length that is left,
// 0.325 m of it with the open string. Where the finger presses, flesh of 1e5 N/m yields, which is 3 to 5 cents, and
// the string is stiff.
TYPED_TEST(BowedViolin, FollowsAFingerThatMoves) {
  Violin<TypeParam> violin("violin_glide");
  const auto place_of = [](double cents) { return 0.325 * (1 - std::exp2(-cents / 1200)); };
  begin_stroke(violin, 0.3);
  violin.tick(0.5);
  const double low = slips_of(violin).cents;
  for (int n = 0; n < 0.4 * kRate; ++n) {
    violin.set("finger_place_m", place_of(200 + 500 * n / (0.4 * kRate)));
    violin.instrument.tick();
  }
  for (int n = 0; n < kRate; ++n) {
    violin.set("finger_place_m", place_of(700 + 25 * std::sin(2 * std::numbers::pi * 5.5 * n / kRate)));
    violin.instrument.tick();
  }
  violin.set("finger_place_m", place_of(700));
  violin.tick(0.2);
  const double high = slips_of(violin).cents;
  Measured() << "pitch at 200 cents " << low << ", at 700 cents " << high;
  EXPECT_TRUE(within(low, 200, 12));
  EXPECT_TRUE(within(high, 700, 12));
}

// The plectrum presses by the spring of the hand, and drags the string at its own speed until the string pulls by
// more than 0.3 of that force, which is that of the sample before; then the string slips at that force. After the
// plectrum is lifted the string rings alone.
TEST(FrictionOfAFile, LetsGoOfAStringUnderAPlectrum) {
  Played<double> guitar(parse_instrument(read_input(EXAMPLES_FOLDER "/plectrum.json"), "plectrum.json"));
  const auto& network = guitar.instrument;
  std::size_t rubbing = 0;
  while (guitar.arrays.connections[rubbing].kind != ConnectionKind::kFriction) ++rubbing;
  const std::size_t tip = guitar.arrays.connections[rubbing].friction.pressed_by;
  ASSERT_EQ(guitar.arrays.connections[tip].kind, ConnectionKind::kContact);
  double balance = guitar.instrument.energy(), largest = 0;
  int held = 0, slipped = 0, let_go_at = 0;
  for (int n = 0; n < 22050; ++n) {
    const double t = n / kRate;
    guitar.set("hand_gap_shift_m", 0.003 * std::clamp(std::min(t / 0.01, (0.028 - t) / 0.003), 0.0, 1.0));
    guitar.set("stroke_surface_speed_m_per_s", 0.3 * std::clamp((t - 0.01) / 0.005, 0.0, 1.0));
    const double pressing = double(network.force(tip));
    guitar.instrument.tick();
    balance += guitar.instrument.work() - guitar.instrument.dissipated();
    const double rubs = std::abs(double(network.force(rubbing)));
    ASSERT_LE(rubs, 0.3 * pressing * (1 + 1e-5)) << n;
    largest = std::max(largest, guitar.instrument.energy());
    if (!(rubs > 0)) continue;
    const bool slips = double(network.slip(rubbing)) * kRate > 0.01;
    if (slips && let_go_at == 0) let_go_at = n;
    ++(slips ? slipped : held);
    if (slips) {
      EXPECT_GT(rubs, 0.29 * pressing) << n;
    }
  }
  Measured() << "held for " << held << " samples, slipped for " << slipped << ", let go at " << let_go_at / kRate
             << " s";
  EXPECT_GT(held, 50);
  EXPECT_GT(slipped, 50);
  EXPECT_EQ(double(network.force(rubbing)), 0);
  EXPECT_GT(guitar.instrument.energy(), 1e-5);
  EXPECT_TRUE(within(guitar.instrument.energy(), balance, 1e-11 * largest));
}

TYPED_TEST(BowedViolin, FallsSilentWhereTheBowIsLifted) {
  Violin<TypeParam> violin;
  EXPECT_TRUE(violin.instrument.is_silent(1e-14));
  violin.stroke(0, 0.15);
  EXPECT_TRUE(violin.instrument.is_silent(1e-14));
  violin.stroke(0.3, 0);
  EXPECT_TRUE(violin.instrument.is_silent(1e-14));
  violin.stroke(0.3, 0.15);
  EXPECT_FALSE(violin.instrument.is_silent(1e-14)) << "a host would let it sleep";
  EXPECT_FALSE(violin.instrument.is_at_rest(1e-14));
  violin.tick(0.5);
  EXPECT_GT(violin.instrument.energy(), 1e-5);
  violin.stroke(0, 0.15);
  violin.set("hand_damping_per_s", 50);
  violin.tick(1);
  EXPECT_TRUE(violin.instrument.is_silent(1e-14));
}

}  // namespace
}  // namespace contactspline::testing
