// SPDX-License-Identifier: MIT
// Keys that bow: the stroke, strings that keys tune one by one, strokes that go on and turn, and what a file may say.
#include <numbers>
#include <numeric>
#include <optional>

#include "contactspline/data/stroke.hpp"
#include "generator/instrument/instrument_reader.hpp"
#include "generator/support/error.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;
constexpr BowLimits kLimits{1, 4};

// The motion after some samples of a stroke.
Stroke::Motion after(Stroke& stroke, int samples, double force_n, double speed_m_per_s, double assistance = 0) {
  Stroke::Motion motion{};
  for (int n = 0; n < samples; ++n) motion = stroke.next(force_n, speed_m_per_s, kLimits, assistance);
  return motion;
}

// 2 m/s^2 reach 0.2 m/s in 0.1 s; the bow has come down by then. The sum of 4410 increments is exact to 4410 eps.
TEST(StrokeOfABow, SpeedsUpTurnsAndIsLifted) {
  Stroke stroke;
  stroke.prepare(kRate);
  EXPECT_FALSE(stroke.is_active());
  stroke.begin(2);
  EXPECT_TRUE(relatively_within(after(stroke, 2205, 0.5, 0.2).speed_m_per_s, 0.1, 1e-11));
  const Stroke::Motion whole = after(stroke, 2300, 0.5, 0.2);
  EXPECT_EQ(whole.speed_m_per_s, 0.2);
  EXPECT_EQ(whole.force_n, 0.5);
  stroke.begin(2);  // while it is down it goes on
  EXPECT_EQ(after(stroke, 1, 0.5, 0.2).speed_m_per_s, 0.2);
  stroke.lift();
  stroke.begin(2);  // and turns once it has been lifted, from 0.2 to -0.2 m/s in 0.2 s
  EXPECT_TRUE(within(after(stroke, 4410, 0.5, 0.2).speed_m_per_s, 0, 1e-11));
  EXPECT_EQ(after(stroke, 4500, 0.5, 0.2).speed_m_per_s, -0.2);
  stroke.lift();
  EXPECT_TRUE(relatively_within(after(stroke, 441, 0.5, 0.2).force_n, 0.25, 1e-11)) << "half of 20 ms";
  EXPECT_EQ(after(stroke, 442, 0.5, 0.2).force_n, 0);
  EXPECT_FALSE(stroke.is_active());
}

// At 0.2 m/s the limits are 0.2 and 0.8 N.
TEST(StrokeOfABow, AssistanceMovesTheForceToItsLimits) {
  const auto force = [](double force_n, double assistance) {
    Stroke stroke;
    stroke.prepare(kRate);
    stroke.begin(100);
    return after(stroke, 4410, force_n, 0.2, assistance).force_n;
  };
  EXPECT_EQ(force(3.2, 0), 3.2);
  EXPECT_TRUE(relatively_within(force(3.2, 1), 0.8, 1e-14));
  EXPECT_TRUE(relatively_within(force(3.2, 0.5), 1.6, 1e-14)) << "half of the way in decibels";
  EXPECT_TRUE(relatively_within(force(0.5, 1), 0.5, 1e-14));
  EXPECT_TRUE(relatively_within(force(0.05, 1), 0.2, 1e-14));
  EXPECT_TRUE(relatively_within(force(0, 1), 0.2, 1e-14)) << "a controller at 0 does not silence it";
  EXPECT_EQ(force(0, 0.5), 0);
}

constexpr auto kString = R"("string": { "length_m": 0.325, "mass_kg": 0.0004, "tension_n": 48,
  "bending_stiffness_n_m2": 5e-5, "constant_loss_per_s": 2, "quadratic_loss_m2_per_s": 0.002 }, "max_modes": 30 })";

// Two strings alike but for their tuning, each with its bow.
std::string fiddle(int low_cents = 0, int high_cents = 0) {
  const auto string = [](const std::string& name, int cents) {
    return R"({ "name": ")" + name + R"(", "tuning_cents": )" + std::to_string(cents) + ", " + kString;
  };
  return R"({ "name": "fiddle", "bodies": [ )" + string("low", low_cents) + ", " + string("high", high_cents) + R"( ],
    "places": [ { "name": "at_low", "body": "low", "position_m": 0.286 },
                { "name": "at_high", "body": "high", "position_m": 0.286 } ],
    "frictions": [ { "name": "on_low", "between": ["ground", "at_low"], "material": "rosin" },
                   { "name": "on_high", "between": ["ground", "at_high"], "material": "rosin" } ],
    "bows": [ { "friction": "on_low", "min_n_s_per_m": 1, "max_n_s_per_m": 4 }, { "friction": "on_high" } ],
    "controls": [ { "name": "bow", "normal_force_n": ["on_low", "on_high"], "initial": 0.4, "max": 5,
                    "controller": "pressure" },
                  { "name": "bow", "surface_speed_m_per_s": ["on_low", "on_high"], "initial": 0.2, "controller": 2 } ],
    "outputs": [ { "name": "low", "end_force_n": "low" }, { "name": "high", "end_force_n": "high" },
                 { "name": "on_low", "force_n": "on_low" }, { "name": "on_high", "force_n": "on_high" } ],
    "keys": [ { "first": 55, "last": 61, "event": "bow_on_low", "tuned_key": 55, "string": "low" },
              { "first": 62, "last": 80, "event": "bow_on_high", "tuned_key": 62, "string": "high" } ],
    "polyphony": 1 })";
}

struct Fiddle {
  explicit Fiddle(const std::string& text = fiddle())
      : arrays(arrays_of(parse_instrument(text, "fiddle.json"), kRate / 2)) {
    voices.emplace(Engine<double>::network(arrays.view()), kRate);
  }
  void play(double seconds) {
    for (int n = 0; n < seconds * kRate; ++n) {
      const double before = voices->energy();
      voices->tick();
      const double error = voices->energy() - before - voices->work() + voices->dissipated();
      imbalance = std::max(imbalance, std::abs(error));
      peak = std::max(peak, voices->energy());
    }
  }
  // The next samples of both outputs, one after the other.
  std::vector<double> played(int samples) {
    std::vector<double> sound;
    for (int n = 0; n < samples; ++n) {
      voices->tick();
      for (const std::size_t o : {0, 1}) sound.push_back(voices->output(o));
    }
    return sound;
  }
  // The pitch of the lower string, by the lag at which its force is most like itself, over 0.2 s.
  double pitch_hz() {
    std::vector<double> sound;
    for (int n = 0; n < 8820; ++n) {
      voices->tick();
      sound.push_back(voices->output(0));
    }
    const auto likeness = [&](int lag) {
      return std::inner_product(sound.begin() + lag, sound.end(), sound.begin(), 0.0) / double(sound.size() - lag);
    };
    int best = 100;
    for (int lag = 100; lag < 200; ++lag)
      if (likeness(lag) > likeness(best)) best = lag;
    const double before = likeness(best - 1), at = likeness(best), behind = likeness(best + 1);
    return kRate / (best + (before - behind) / (2 * (before - 2 * at + behind)));
  }
  void note_on(int key, double velocity) { voices->handle().note_on(key, velocity); }
  void note_off(int key) { voices->handle().note_off(key); }
  /// Of friction on the lower or the higher string.
  [[nodiscard]] double force(std::size_t string) const { return voices->output(2 + string); }

  InstrumentArrays arrays;
  std::optional<BySample<double>> voices;
  double imbalance = 0, peak = 0;
};

TEST(KeysThatBow, ReadTheirFile) {
  const InstrumentModel model = parse_instrument(fiddle(), "fiddle.json");
  ASSERT_EQ(model.events.size(), 2U);
  EXPECT_EQ(model.events[1].name, "bow_on_high");
  EXPECT_EQ(model.events[1].kind, EventKind::kBow);
  EXPECT_EQ(model.parameters[model.events[0].parameter].name, "bow_acceleration_m_per_s2");
  EXPECT_EQ(model.parameters[model.assistance].name, "assistance");
  EXPECT_EQ(model.parameters[0].controller, kPressureController);
  EXPECT_EQ(model.parameters[1].controller, 2);
  EXPECT_EQ(model.keys.ranges[1].string, 1U);
}

TEST(KeysThatBow, AreUpUntilAKeyGoesDown) {
  Fiddle fiddle;
  EXPECT_TRUE(fiddle.voices->is_silent(1e-14));
  fiddle.play(0.1);
  EXPECT_EQ(fiddle.voices->energy(), 0);
  fiddle.note_on(55, 1);
  EXPECT_FALSE(fiddle.voices->is_silent(1e-14));
  fiddle.play(0.5);
  EXPECT_GT(fiddle.voices->energy(), 1e-6);
  EXPECT_EQ(fiddle.force(1), 0) << "of the other string";
  fiddle.note_off(55);
  fiddle.play(0.021);
  fiddle.play(0.001);
  EXPECT_EQ(fiddle.force(0), 0);
  EXPECT_GT(fiddle.voices->energy(), 1e-7) << "the string rings";
  // Rounding: as in friction_network_test, of a sample.
  EXPECT_LE(fiddle.imbalance, 1e-12 * fiddle.peak);
}

// They play the samples of a file whose strings have these pitches, until sticking and slipping amplify the rounding
// of the modes to 13 digits.
TEST(KeysThatBow, TuneTheirOwnString) {
  Fiddle by_keys, by_file(fiddle(250, 400));
  by_keys.note_on(57, 0.5);
  by_keys.note_on(66, 0.5);
  by_keys.voices->handle().play({0, Action::kBendKey, 57, 50});
  by_file.note_on(55, 0.5);
  by_file.note_on(62, 0.5);
  const std::vector<double> expected = by_file.played(1000);
  EXPECT_TRUE(
      sequences_within(std::span<const double>(by_keys.played(1000)), std::span<const double>(expected), 1e-8));
}

// So do modes that are tuned with it.
TEST(KeysThatBow, TuneTheTorsionOfTheirString) {
  const auto with_torsion = [](double cents, bool is_tuned) {
    std::string text = fiddle(static_cast<int>(cents));
    const auto insert = [&](std::string_view before, const std::string& inserted) {
      text.insert(text.find(before), inserted);
    };
    insert(R"({ "name": "high", "tuning)", R"({ "name": "torsion", "modes": [ { "frequency_hz": )" +
                                               std::to_string(1078 * std::exp2(cents / 1200)) +
                                               R"(, "decay_per_s": 110, "mass_kg": 0.00002 } ] }, )");
    insert(R"({ "name": "at_low")", R"({ "name": "surface", "body": "torsion", "shapes": [0.7] }, )");
    text.replace(text.find(R"("ground", "at_low")"), 18, R"("surface", "at_low")");
    constexpr std::string_view kAlone = R"("string": "low")";
    return is_tuned ? text.replace(text.find(kAlone), kAlone.size(), R"("bodies": [ "low", "torsion" ])") : text;
  };
  Fiddle by_keys(with_torsion(0, true)), by_file(with_torsion(250, false)), untuned(with_torsion(0, false));
  for (Fiddle* played : {&by_keys, &untuned}) {
    played->note_on(57, 0.5);
    played->voices->handle().play({0, Action::kBendKey, 57, 50});
  }
  by_file.note_on(55, 0.5);
  const std::vector<double> expected = by_file.played(1000);
  const std::span<const double> wanted(expected);
  // The frequency in the file has six decimals.
  EXPECT_TRUE(sequences_within(std::span<const double>(by_keys.played(1000)), wanted, 1e-6));
  EXPECT_FALSE(sequences_within(std::span<const double>(untuned.played(1000)), wanted, 1e-3));

  InstrumentModel model = parse_instrument(with_torsion(0, true), "fiddle.json");
  const double before = arrays_of(model, kRate / 2).angular_frequencies[30];  // behind the modes of the string
  tune(model, 1200);                                                          // as voices of a score do
  EXPECT_TRUE(relatively_within(arrays_of(model, kRate / 2).angular_frequencies[30], 2 * before, 1e-12));
}

// The key below stays down while another is played over it, as in a trill.
TEST(KeysThatBow, GoOnWithTheKeyThatIsStillHeld) {
  Fiddle fiddle;
  const double file_hz = fiddle.arrays.angular_frequencies.front() / (2 * std::numbers::pi);
  const auto cents = [&] { return 1200 * std::log2(fiddle.pitch_hz() / file_hz); };
  fiddle.note_on(57, 1);
  fiddle.play(0.5);
  EXPECT_TRUE(within(cents(), 200, 30));  // a bow flattens
  fiddle.note_on(59, 1);
  fiddle.play(0.3);
  EXPECT_TRUE(within(cents(), 400, 30));
  fiddle.note_off(59);
  fiddle.play(0.3);
  EXPECT_TRUE(within(cents(), 200, 30));
  EXPECT_FALSE(fiddle.voices->is_silent(1e9)) << "the bow is still down";
  fiddle.note_off(57);
  fiddle.play(0.03);
  EXPECT_EQ(fiddle.force(0), 0);
}

// What bows pull alternates from stroke to stroke: the mean force on the string. A held key keeps its direction.
TEST(KeysThatBow, AlternateTheirStrokes) {
  Fiddle fiddle;
  const auto mean_force = [&] {
    fiddle.play(0.3);
    double sum = 0;
    for (int n = 0; n < 4410; ++n) {
      fiddle.voices->tick();
      sum += fiddle.force(0);
    }
    return sum;
  };
  fiddle.note_on(55, 1);
  const double first = mean_force();
  fiddle.note_on(57, 1);
  EXPECT_GT(first * mean_force(), 0) << "legato";
  fiddle.note_off(55);
  fiddle.note_off(57);
  fiddle.play(0.05);
  fiddle.note_on(55, 1);
  EXPECT_LT(first * mean_force(), 0);
}

// A note without velocity lifts no bow that another key holds, and an event bows the string of the file.
TEST(KeysThatBow, LeaveOtherKeysAlone) {
  Fiddle fiddle, alone;
  for (Fiddle* played : {&fiddle, &alone}) {
    played->note_on(57, 1);
    played->note_on(66, 1);
  }
  fiddle.note_on(58, 0);
  EXPECT_TRUE(sequences_within(std::span<const double>(fiddle.played(1000)),
                               std::span<const double>(alone.played(1000)), 0.0));
  fiddle.voices->bow(0, 5.0);  // the lower string has the pitch of the file until the event ends
  fiddle.voices->bow(0, 0.0);
  fiddle.play(0.05);
  EXPECT_FALSE(fiddle.voices->is_silent(1e9)) << "two keys are held";
  fiddle.note_off(57);
  fiddle.note_off(66);
  fiddle.play(0.03);
  EXPECT_TRUE(fiddle.voices->is_silent(1e9));
}

// With two voices a third key takes the voice of another one, whose bow it lifts.
TEST(KeysThatBow, LiftTheBowOfAVoiceThatIsTaken) {
  std::string text = fiddle();
  text.replace(text.find("\"polyphony\": 1"), 14, "\"polyphony\": 2");
  Fiddle two(text);
  two.note_on(57, 1);
  two.note_on(58, 1);
  two.play(0.1);
  two.note_on(62, 1);
  two.play(0.1);
  two.note_off(62);
  two.note_off(58);
  two.note_off(57);
  two.play(0.03);
  EXPECT_TRUE(two.voices->is_silent(1e9)) << "no bow is down";
}

TEST(KeysThatBow, AreUpAfterAReset) {
  Fiddle fiddle;
  fiddle.note_on(57, 1);
  fiddle.play(0.1);
  fiddle.voices->reset();
  EXPECT_TRUE(fiddle.voices->is_silent(1e-14));
  fiddle.play(0.05);
  EXPECT_EQ(fiddle.voices->energy(), 0);
  EXPECT_EQ(fiddle.force(0), 0);
}

TEST(KeysThatBow, HaveOneVoiceUnlessTheFileSaysMore) {
  std::string text = fiddle();
  text.replace(text.find(",\n    \"polyphony\": 1"), 20, "");
  EXPECT_EQ(parse_instrument(text, "fiddle.json").keys.voices, 1U);
}

struct BadBows {
  const char* replaced;
  const char* by;
  const char* says;
};

class BadBowsOfAFile : public ::testing::TestWithParam<BadBows> {};

TEST_P(BadBowsOfAFile, AreRefusedInOneLine) {
  std::string text = fiddle();
  const std::size_t at = text.find(GetParam().replaced);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string_view(GetParam().replaced).size(), GetParam().by);
  try {
    (void)parse_instrument(text, "fiddle.json");
    FAIL() << GetParam().by;
  } catch (const BadInput& bad) {
    EXPECT_NE(std::string(bad.what()).find(GetParam().says), std::string::npos) << bad.what();
  }
}
INSTANTIATE_TEST_SUITE_P(
    Cases, BadBowsOfAFile,
    ::testing::Values(BadBows{R"({ "friction": "on_high" })", R"({ "friction": "on_hgh" })", "on_high"},
                      BadBows{R"({ "friction": "on_high" })", R"({ "friction": "on_low" })", "twice"},
                      BadBows{R"("min_n_s_per_m": 1, )", "", "min_n_s_per_m"},
                      BadBows{R"("min_n_s_per_m": 1)", R"("min_n_s_per_m": 5)", "below"},
                      BadBows{R"("surface_speed_m_per_s": ["on_low", "on_high"])",
                              R"("surface_speed_m_per_s": "on_low")", "'on_high' has no surface_speed_m_per_s"},
                      BadBows{R"("controller": 2)", R"("controller": 64)", "pedal"},
                      BadBows{R"("controller": 2)", R"("controller": 200)", "119"},
                      BadBows{R"("controller": "pressure")", R"("controller": "breath")", "pressure"},
                      BadBows{R"("string": "high")", R"("string": "hihg")", "high"},
                      BadBows{R"("tuned_key": 62, "string")", R"("string")", "tuned_key"}));

}  // namespace
}  // namespace contactspline::testing
