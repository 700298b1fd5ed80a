// SPDX-License-Identifier: MIT
// A keyboard on its body: against the same strings on a Body by hand, against the exact motion, its energy, its
// pedals, and what must not sound.
#include "contactspline/instrument/keyboard_instrument.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "contactspline/keyboards/piano.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/embedded_files.hpp"
#include "strings_on_body.hpp"
#include "support/compare.hpp"
#include "support/damped_treble.hpp"
#include "support/finite.hpp"
#include "support/measured.hpp"
#include "support/precisions.hpp"

namespace contactspline::testing {
namespace {

using Piano = keyboards::piano;
constexpr double kRate = 44100;

template <typename T>
using Sound = std::vector<T>;

/// Plays some seconds in blocks of 441 samples and appends the left ear.
template <typename Instrument, typename T>
void play(Instrument& instrument, double seconds, Sound<T>& left) {
  Sound<T> right(441);
  for (auto left_over = static_cast<std::size_t>(seconds * kRate); left_over > 0;) {
    const std::size_t samples = std::min<std::size_t>(left_over, right.size()), begin = left.size();
    left.resize(begin + samples);
    instrument.process(std::span(left).subspan(begin), std::span(right).first(samples));
    left_over -= samples;
  }
}

template <typename T>
double peak_of(std::span<const T> sound) {
  double peak = 0;
  for (const T x : sound)
    peak = is_finite(x) ? std::max(peak, std::abs(double(x))) : std::numeric_limits<double>::infinity();
  return peak;
}

/// Largest of what a step of height 1 leaves in the fourth difference as 1: near half the sample rate it passes, low
/// partials it does not.
double largest_step(std::span<const double> sound) {
  double largest = 0;
  for (std::size_t n = 4; n < sound.size(); ++n) {
    const double difference = sound[n] - 4 * sound[n - 1] + 6 * sound[n - 2] - 4 * sound[n - 3] + sound[n - 4];
    largest = std::isfinite(difference) ? std::max(largest, std::abs(difference) / 3) : difference;
  }
  return largest;
}

/// Middle C of the tests on a board, three strings apart by so many cents, of so many modes each.
struct OneKey {
  explicit OneKey(std::vector<double> cents, int kept, double loss = 1) {
    struck.string.detuning_cents = std::move(cents);
    struck.string.losses = {0.1 * loss, 1e-4 * loss};
    max_modes = static_cast<std::size_t>(kept);
    for (const auto& mode : modes) {
      bare_modes.push_back(mode.mode);
      bridge.push_back(mode.strike_shape);
      ear.push_back(mode.pickup_shape);
    }
  }

  [[nodiscard]] BoardOfKeyboard keyboard_board() const { return {bare_modes, bridge, ear, bridge}; }
  [[nodiscard]] KeyOnBody<double> key(double transposed = 0) const {
    StiffString strings = struck.string;
    strings.length_m *= std::exp2(-transposed / 12);
    return {strings,
            struck.strike_m,
            SegmentTable<double>(felt),
            {.hammer_mass_kg = struck.hammer_kg / 3},
            {60, 0.005},
            {},
            1,
            1,
            horizontal};
  }

  StruckString struck = c4();
  HorizontalMotion horizontal = {};
  std::size_t max_modes;
  std::vector<ResonatorMode> modes = board(40, 3);
  std::vector<Mode> bare_modes;
  std::vector<double> bridge, ear;
  std::vector<Segment<double>> felt = felt_table(c4(), 32);
};

/// The same key by hand: Body and HammerString, all modes from the beginning; and the forces of the hammer.
struct ByHand {
  ByHand(const OneKey& one, BridgeStiffness stiffness) {
    auto rows = modes_below(one.struck.string, kRate / 2, one.max_modes);
    const std::size_t upright = rows.size();
    const auto& cents = one.struck.string.detuning_cents;
    const double strings = static_cast<double>(cents.size());
    const auto& [strike_ratio, bridge_ratio, horizontal_cents] = one.horizontal;
    if (strike_ratio > 0) {  // strings that move horizontally as one: one more string
      StiffString along = one.struck.string;
      along.detuning_cents = {std::accumulate(cents.begin(), cents.end(), 0.0) / strings + horizontal_cents};
      for (const StringMode& row : modes_below(along, kRate / 2, one.max_modes)) rows.push_back(row);
    }
    stiffness.ends +=
        (1 + bridge_ratio * bridge_ratio) * bridge_stiffness(one.struck.string, std::vector<StringMode>()).ends;
    strike = ModeShapes<double>(rows.size());
    ModeShapes<double> at_bridge = bridge_shapes<double>(one.struck.string, rows, 1);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      strike[i] = std::sin(rows[i].wavenumber_per_m * one.struck.strike_m) *
                  (i < upright ? 1 / strings : strike_ratio / std::sqrt(strings));
      if (i >= upright) at_bridge[i] *= bridge_ratio * std::sqrt(strings);
      stiffness.modes += at_bridge[i] * at_bridge[i] / stiffness_of(rows[i].mode);
    }
    HammerString<double> model(SegmentTable<double>(one.felt), bare(rows), strike, kRate);
    const auto bridge = model.bridge(at_bridge);
    Body<double> body(one.bare_modes, ModeShapes<double>(one.bridge), stiffness, kRate);
    const auto ear = body.modes().sound_pickup(ModeShapes<double>(one.ear));
    model.strike(2, 1e-4);
    const HammerStringControls<double> controls{.hammer_mass_kg = one.struck.hammer_kg / 3 * strings,
                                                .felt = {.stiffness_ratio = strings}};
    for (int n = 0; n < static_cast<int>(8 * kRate); ++n) {
      body.tick(model.tick(controls, bridge, body.change()));
      sound.push_back(body.modes().velocity(ear));
      forces.push_back(model.force());
    }
  }

  ModeShapes<double> strike;
  std::vector<double> sound, forces;
};

// The class plays what Body and HammerString play: a second key is there but sleeps, with the tension of its strings
// at the board. What leaves at 90 dB below the rest, or 1e-14 J, changes the sound by less than 1e-4 of its peak.
TEST(KeyboardOnBody, PlaysItsStringsOnABody) {
  for (const HorizontalMotion& horizontal : {HorizontalMotion(), {0.5, 0.3, 3}}) {
    OneKey one({0, 0.15, -0.1}, 12);
    one.horizontal = horizontal;
    const KeyOnBody<double> keys[] = {one.key(), one.key(7)};
    KeyboardOnBody<double> keyboard(keys, one.keyboard_board(), kRate, one.max_modes);
    keyboard.strike(0, 2);
    Sound<double> sound;
    play(keyboard, 8, sound);
    BridgeStiffness asleep = bridge_stiffness(keys[1].strings, std::vector<StringMode>());
    asleep.ends *= 1 + horizontal.bridge_ratio * horizontal.bridge_ratio;
    const ByHand expected(one, asleep);
    EXPECT_EQ(keyboard.awake(), 1u);
    const double peak = peak_of<double>(expected.sound);
    EXPECT_GT(peak, 1e-3);
    EXPECT_TRUE(sequences_within<double>(sound, expected.sound, 1e-4));
    EXPECT_TRUE(sequences_within<double>(std::span(sound).first(2000), std::span(expected.sound).first(2000), 1e-9));
  }
}

// A string in tune with its horizontal motion is one string on the bridge: what the bridge does not take at once, it
// never hears. A few cents apart the horizontal motion sounds on, some 20 dB below the beginning.
TEST(KeyboardOnBody, SoundsOnHorizontally) {
  const auto level_after = [](const HorizontalMotion& horizontal) {
    OneKey one({0}, 3);
    one.horizontal = horizontal;
    const KeyOnBody<double> keys[] = {one.key()};
    KeyboardOnBody<double> keyboard(keys, one.keyboard_board(), kRate, one.max_modes);
    keyboard.strike(0, 2);
    Sound<double> sound;
    play(keyboard, 6, sound);
    const auto second = static_cast<std::size_t>(kRate);
    return 20 * std::log10(peak_of<double>(std::span(sound).last(second)) /
                           peak_of<double>(std::span(sound).first(second)));
  };
  const double none = level_after({}), in_tune = level_after({0.4, 0.3, 0}), apart = level_after({0.4, 0.3, 4});
  Measured() << "after 5 s " << none << " dB, " << in_tune << " dB in tune, " << apart << " dB 4 cents apart";
  EXPECT_GT(apart, none + 6);
  EXPECT_GT(apart, in_tune + 6);
}

// Strings that are bent sound as strings of that tension: bent before the blow or asleep until a neighbour wakes
// them, by an octave at once, there and back. What differs is rounding. A place of the strike, too, is as if built
// so.
TEST(KeyboardOnBody, BendsItsStringsAtTheBridge) {
  const OneKey one({0, 0.15, -0.1}, 12);
  const auto sound_of = [&](double built_cents, double built_strike_m, const auto& prepare,
                            bool has_neighbour = true) {
    KeyOnBody<double> keys[] = {one.key(), one.key(7)};
    for (KeyOnBody<double>& key : keys) {
      key.strings.tension_n *= std::exp2(built_cents / 600);
      key.strike_position_m += built_strike_m;
    }
    KeyboardOnBody<double> keyboard(keys, one.keyboard_board(), kRate, one.max_modes);
    Sound<double> sound;
    keyboard.strike(0, 2);  // at rest its strings take the tension when they join, and so do those that leave
    play(keyboard, 0.01, sound);
    keyboard.reset();
    prepare(keyboard);
    if (has_neighbour) keyboard.press(1);
    keyboard.strike(0, 2);
    sound.clear();
    play(keyboard, 1, sound);
    return sound;
  };
  const auto nothing = [](auto&) {};
  const auto bend = [](double cents) {
    return [=](KeyboardOnBody<double>& keyboard) { keyboard.bend(0, cents), keyboard.bend(1, cents); };
  };
  const auto plain = sound_of(0, 0, nothing);
  for (const double cents : {150.0, -1200.0, -2400.0, -4800.0}) {
    const auto expected = sound_of(cents, 0, nothing);
    EXPECT_TRUE(sequences_within<double>(sound_of(0, 0, bend(cents)), expected, 1e-9)) << cents;
    EXPECT_FALSE(sequences_within<double>(plain, expected, 0.1)) << cents;
  }
  // Strings that are built so high have fewer modes below 5 kHz, with which a neighbour wakes.
  for (const double cents : {2400.0, 4800.0})
    EXPECT_TRUE(
        sequences_within<double>(sound_of(0, 0, bend(cents), false), sound_of(cents, 0, nothing, false), 1e-9))
        << cents;
  const auto there_and_back = [&](auto& keyboard) { bend(700)(keyboard), bend(0)(keyboard); };
  EXPECT_TRUE(sequences_within<double>(sound_of(0, 0, there_and_back), plain, 1e-12));
  const auto move = [](auto& keyboard) { keyboard.strike_at(0, 0.0744 + 0.05), keyboard.strike_at(7, 0.1); };
  EXPECT_TRUE(sequences_within<double>(sound_of(0, 0, move), sound_of(0, 0.05, nothing), 1e-9));
}

// By how much a keyboard's energy rises in one sample at most, and the largest energy.
struct Growth {
  double worst_j = 0, peak_j = 0;

  void tick(KeyboardOnBody<double>& keyboard) {
    const double before = keyboard.energy();
    double left, right;
    keyboard.process(std::span(&left, 1), std::span(&right, 1));
    const double growth = keyboard.energy() - before;
    peak_j = std::max(peak_j, before);
    worst_j = std::isfinite(growth) ? std::max(worst_j, growth) : std::numeric_limits<double>::infinity();
  }
  void tell() const { Measured() << "grows by " << worst_j / peak_j << " of the largest energy, " << peak_j << " J"; }
};

// Without losses energy comes from bends alone: one there and back at once leaves it as it was, and between bends no
// sample adds any. Bound: 1e-12 of the largest energy.
TEST(KeyboardOnBody, GainsEnergyByBendsAlone) {
  OneKey one({0, 0.15, -0.1}, 12, 0);
  for (Mode& mode : one.bare_modes) mode.decay_per_s = 0;
  const KeyOnBody<double> keys[] = {one.key(), one.key(7)};
  KeyboardOnBody<double> keyboard(keys, one.keyboard_board(), kRate, one.max_modes);
  keyboard.press(1);
  keyboard.strike(0, 2);
  Sound<double> sound;
  play(keyboard, 0.1, sound);
  ASSERT_FALSE(keyboard.is_hammer_flying());
  const double unbent = keyboard.energy();
  keyboard.bend(0, 30);
  EXPECT_TRUE(within(keyboard.energy() / unbent - 1, 0.0175, 0.0175));  // all of it potential: 30/600 ln 2
  EXPECT_NE(keyboard.energy(), unbent);
  keyboard.bend(0, 0);
  EXPECT_TRUE(relatively_within(keyboard.energy(), unbent, 1e-12));
  Growth growth{.peak_j = unbent};
  for (int n = 0; n < 2000; ++n) {
    if (n % 50 == 0) keyboard.bend(n % 100 < 50 ? 0 : 1, n % 300 - 100);
    growth.tick(keyboard);
  }
  growth.tell();
  EXPECT_LE(growth.worst_j, 1e-12 * growth.peak_j);
}

// The same over the whole range: where modes come to rest above half the sample rate, their energy leaves with the
// bend. So soft that each bend arrives at once.
TEST(KeyboardOnBody, GainsNoEnergyBetweenWideBends) {
  OneKey one({0, 0.15, -0.1}, 12, 0);
  for (Mode& mode : one.bare_modes) mode.decay_per_s = 0;
  const KeyOnBody<double> keys[] = {one.key(), one.key(7)};
  KeyboardOnBody<double> keyboard(keys, one.keyboard_board(), kRate, one.max_modes);
  keyboard.press(1);
  keyboard.strike(0, 0.1);
  Sound<double> sound;
  play(keyboard, 0.5, sound);
  for (const double cents : {4800.0, 2400.0, 0.0, -2400.0, 0.0, -4800.0, -2400.0}) {
    keyboard.bend(0, cents), keyboard.bend(1, cents);
    Growth growth{.peak_j = keyboard.energy()};
    EXPECT_GT(growth.peak_j, 0);
    for (int n = 0; n < 2000; ++n) growth.tick(keyboard);
    growth.tell();
    EXPECT_LE(growth.worst_j, 1e-12 * growth.peak_j) << cents;
  }
}

// Bends that alternate as fast as a host can move them: they would pump the strings (17 orders of magnitude in half a
// second), but do no more work than 1 W.
TEST(KeyboardOnBody, IsNotPumpedByBends) {
  const OneKey one({0, 0.15, -0.1}, 12);
  const KeyOnBody<double> keys[] = {one.key()};
  for (const auto& [samples, cents] : {std::pair(64, 200.0), {1, 1200.0}, {1, 4800.0}, {83, 50.0}}) {
    KeyboardOnBody<double> keyboard(keys, one.keyboard_board(), kRate, one.max_modes);
    Sound<double> sound;
    keyboard.strike(0, 4);
    play(keyboard, 0.1, sound);
    ASSERT_FALSE(keyboard.is_hammer_flying());
    const double before = keyboard.energy(), seconds = 0.5;
    ASSERT_GT(before, 0.01);
    for (int n = 0; n < seconds * kRate; n += samples) {
      keyboard.bend(0, n / samples % 2 == 0 ? cents : -cents);
      play(keyboard, samples / kRate, sound);
    }
    EXPECT_TRUE(is_finite(keyboard.energy()));
    EXPECT_LT(keyboard.energy(), before + seconds + 0.01);
    EXPECT_EQ(keyboard.failures(), 0u);
  }
}

// A bend that is still on its way when everything comes to rest has arrived at the next blow.
TEST(KeyboardOnBody, HasArrivedAtItsBendAfterAReset) {
  const OneKey one({0, 0.15, -0.1}, 12);
  const KeyOnBody<double> keys[] = {one.key()};
  const auto played = [&](bool sounds) {
    KeyboardOnBody<double> keyboard(keys, one.keyboard_board(), kRate, one.max_modes);
    Sound<double> sound;
    if (sounds) keyboard.strike(0, 4);
    play(keyboard, 0.1, sound);
    keyboard.bend(0, 1200);
    keyboard.reset();
    keyboard.strike(0, 2);
    sound.clear();
    play(keyboard, 0.2, sound);
    return sound;
  };
  EXPECT_TRUE(sequences_within<double>(played(true), played(false), 1e-9));
}

/// `one` struck on its board, 0.5 s of its sound.
Sound<double> played_on(const OneKey& one, const KeyOnBody<double>& key, const Listening& listening) {
  BoardOfKeyboard board = one.keyboard_board();
  board.listening = listening;
  KeyboardOnBody<double> keyboard({&key, 1}, board, kRate, one.max_modes);
  keyboard.strike(0, 2);
  Sound<double> sound;
  play(keyboard, 0.5, sound);
  return sound;
}

// Strings that end where the bridge moves r times as far are strings on a board whose bridge shapes are r times as
// large, and are heard alike, times the output ratio. What differs is rounding.
TEST(KeyboardOnBody, EndsItsStringsAtTheirOwnPlace) {
  constexpr double kRatio = 0.6;
  const OneKey one({0, 0.15, -0.1}, 12);
  OneKey scaled = one;
  for (double& shape : scaled.bridge) shape *= kRatio;
  KeyOnBody<double> key = one.key();
  key.bridge_ratio = kRatio;
  const Sound<double> here = played_on(one, one.key(), {}), there = played_on(one, key, {});
  EXPECT_TRUE(sequences_within<double>(there, played_on(scaled, one.key(), {}), 1e-9));
  EXPECT_FALSE(sequences_within<double>(there, here, 1e-2));
  const Listening force{0, 1, 80};
  key.output_ratio = 2.5;
  Sound<double> expected = played_on(scaled, one.key(), force);
  for (double& x : expected) x *= key.output_ratio;
  EXPECT_TRUE(sequences_within<double>(played_on(one, key, force), expected, 1e-9));
}

/// Keys on a board struck at once, 0.5 s of their sound.
Sound<double> played_together(std::span<const KeyOnBody<double>> keys, const BoardOfKeyboard& board,
                              std::size_t max_modes) {
  KeyboardOnBody<double> keyboard(keys, board, kRate, max_modes);
  for (std::size_t k = 0; k < keys.size(); ++k) keyboard.strike(k, 2);
  Sound<double> sound;
  play(keyboard, 0.5, sound);
  return sound;
}

// Places that move alike are one place: each takes a part of the keys, and acts on the others as fully as on itself.
// What differs is rounding.
TEST(KeyboardOnBody, PlaysPlacesThatMoveAlikeAsOne) {
  const OneKey one({0, 0.15, -0.1}, 12);
  std::vector<KeyOnBody<double>> keys = {one.key(), one.key(7), one.key(12), one.key(4)};
  BoardOfKeyboard board = one.keyboard_board();
  const Sound<double> expected = played_together(keys, board, one.max_modes);
  std::vector<double> alike;
  for (int place = 0; place < 3; ++place) alike.insert(alike.end(), one.bridge.begin(), one.bridge.end());
  board.bridge = alike;
  for (std::size_t k = 0; k < keys.size(); ++k) keys[k].bridge_place = 2 - k % 3;
  EXPECT_GT(peak_of<double>(expected), 1e-3);
  EXPECT_TRUE(sequences_within<double>(played_together(keys, board, one.max_modes), expected, 1e-9));
}

// Places on two halves of a body, each of which moves no mode of the other, are two bodies.
TEST(KeyboardOnBody, PlaysPlacesWithoutCommonModesAsTwoBodies) {
  const OneKey one({0, 0.15, -0.1}, 12);
  KeyOnBody<double> keys[] = {one.key(), one.key(7)};
  const std::size_t modes = one.bare_modes.size(), half = modes / 2;
  const auto part = [&](const std::vector<double>& whole, std::size_t first, std::size_t last) {
    std::vector<double> shapes(modes);
    for (std::size_t i = first; i < last; ++i) shapes[i] = whole[i];
    return shapes;
  };
  Sound<double> expected;
  std::vector<double> bridge;
  for (std::size_t place = 0; place < 2; ++place) {
    const std::size_t first = place * half, last = first + half;
    const std::vector<double> shapes = part(one.bridge, first, last), ear = part(one.ear, first, last);
    bridge.insert(bridge.end(), shapes.begin(), shapes.end());
    const Sound<double> alone =
        played_together(std::span(keys).subspan(place, 1), {one.bare_modes, shapes, ear, ear}, one.max_modes);
    expected.resize(alone.size());
    for (std::size_t n = 0; n < alone.size(); ++n) expected[n] += alone[n];
  }
  keys[1].bridge_place = 1;
  const Sound<double> sound = played_together(keys, {one.bare_modes, bridge, one.ear, one.ear}, one.max_modes);
  EXPECT_GT(peak_of<double>(expected), 1e-3);
  EXPECT_TRUE(sequences_within<double>(std::span(sound).first(2000), std::span(expected).first(2000), 1e-9));
  EXPECT_TRUE(sequences_within<double>(sound, expected, 1e-4));
}

// Eleven keys at five places ring, join by the pedal, are bent and leave: between two acts no sample adds energy.
// Bound: 1e-12 of the largest energy.
TEST(KeyboardOnBody, NeverGainsEnergyAtSeveralPlaces) {
  constexpr std::size_t kPlaces = 5;
  OneKey one({0, 0.15, -0.1}, 12);
  std::vector<double> bridge;
  for (const ModeShapes<double>& place : bridge_of_board<double>(40, kPlaces))
    bridge.insert(bridge.end(), place.data(), place.data() + place.size());
  BoardOfKeyboard board = one.keyboard_board();
  board.bridge = bridge;
  std::vector<KeyOnBody<double>> keys;
  for (std::size_t k = 0; k < 11; ++k) {
    keys.push_back(one.key(static_cast<double>(k)));
    keys.back().bridge_place = k % kPlaces;
  }
  KeyboardOnBody<double> keyboard(keys, board, kRate, one.max_modes);
  ASSERT_EQ(keyboard.body().places(), kPlaces);
  Sound<double> sound;
  for (std::size_t k = 0; k < 6; ++k) keyboard.strike(k, 2);
  play(keyboard, 0.1, sound);
  ASSERT_FALSE(keyboard.is_hammer_flying());
  EXPECT_EQ(keyboard.awake(), 6u);
  Growth growth;
  for (int n = 0; n < 20000; ++n) {
    if (n == 1000) keyboard.sustain(1);
    if (n == 12000) keyboard.sustain(0);
    if (n % 500 == 0) keyboard.bend(static_cast<std::size_t>(n / 500) % 11, n % 3000 / 30 - 50);
    if (n == 8000) {
      for (std::size_t k = 0; k < 11; ++k) keyboard.release(k);
      EXPECT_EQ(keyboard.awake(), 11u);
    }
    growth.tick(keyboard);
  }
  growth.tell();
  EXPECT_GT(growth.peak_j, 1e-3);
  EXPECT_LE(growth.worst_j, 1e-12 * growth.peak_j);
  play(keyboard, 60, sound);
  EXPECT_EQ(keyboard.awake(), 0u);
  EXPECT_EQ(sound.back(), 0);
}

// The sound is the sum of what the places of the ears and the force give, each by its own factor.
TEST(KeyboardOnBody, IsHeardAtItsEarsAndByTheForce) {
  const OneKey one({0, 0.15, -0.1}, 12);
  const Sound<double> at_ear = played_on(one, one.key(), {1, 0, 80}),
                      by_force = played_on(one, one.key(), {0, 1, 80});
  Sound<double> sum(at_ear.size());
  for (std::size_t n = 0; n < sum.size(); ++n) sum[n] = 0.25 * at_ear[n] + 7e-4 * by_force[n];
  EXPECT_TRUE(sequences_within<double>(played_on(one, one.key(), {0.25, 7e-4, 80}), sum, 1e-9));
  EXPECT_GT(peak_of<double>(by_force), 1);  // newtons
}

// What a key strikes when it is played rings by itself: an impulse J of r times the hammer's momentum sets a mode of
// mass m to move as J/m exp(-a t) (cos(w t) - a/w sin(w t)), from the middle of the first sample on. A force that is
// constant over a sample is weaker than an impulse by (w dt)^2/24, and sound_pickup() takes that away twice. What a
// mode loses in a sample is far less.
TEST(KeyboardOnBody, KnocksByTheHammersMomentum) {
  constexpr double kW = 2 * std::numbers::pi * 220, kDecay = 0.5, kMass = 1.5, kRatio = 3, kSpeed = 2;
  OneKey one({0, 0.15, -0.1}, 12);
  one.bare_modes.push_back({kW, kDecay, kMass});
  one.bridge.push_back(0);
  one.ear.push_back(0.5);
  std::vector<double> knock(one.bare_modes.size());
  knock.back() = -2;
  const auto played = [&](double ratio) {
    const KeyOnBody<double> key = one.key();
    BoardOfKeyboard board = one.keyboard_board();
    board.knock = knock;
    KeyboardOnBody<double> keyboard({&key, 1}, board, kRate, one.max_modes);
    keyboard.set_knock(ratio);
    keyboard.set_knock(std::numeric_limits<double>::quiet_NaN());
    keyboard.strike(0, kSpeed);
    Sound<double> sound;
    play(keyboard, 0.5, sound);
    return sound;
  };
  const Sound<double> without = played(0), with = played(kRatio);
  const double impulse = kRatio * one.struck.hammer_kg * kSpeed, peak = 2 * 0.5 * impulse / kMass;
  const double w_dt = kW / kRate;
  for (std::size_t n = 0; n < with.size(); ++n) {
    const double t = (static_cast<double>(n) + 0.5) / kRate;
    const double expected = -peak * std::exp(-kDecay * t) * (std::cos(kW * t) - kDecay / kW * std::sin(kW * t));
    ASSERT_NEAR(with[n] - without[n], expected, peak * w_dt * w_dt / 12) << n;
  }
}

// The knock is work on the body, and the only one: without damping of its modes the energy after the sample is J^2/2m
// for each, and stays.
TEST(Body, KeepsTheEnergyOfAKnock) {
  const std::vector<Mode> modes = {{2 * std::numbers::pi * 100, 0, 2}, {2 * std::numbers::pi * 300, 0, 3}};
  const double shapes[] = {1, -0.5};
  Body<double> body(modes, ModeShapes<double>(2), {}, kRate, ModeShapes<double>(std::span<const double>(shapes)));
  constexpr double kImpulse = 0.01;
  body.knock(kImpulse);
  body.tick(0);
  const double energy = body.energy(), w_dt = 2 * std::numbers::pi * 300 / kRate;
  const double expected = kImpulse * kImpulse * (1.0 / 4 + 0.25 / 6);
  EXPECT_TRUE(relatively_within(energy, expected, w_dt * w_dt / 4));
  for (int n = 0; n < 44100; ++n) body.tick(0);
  EXPECT_TRUE(relatively_within(body.energy(), energy, 1e-12));
}

// A knock that also moves the bridge works against the tension of the strings there: the energy is its force times
// the change of the place where it acts.
TEST(Body, KnocksAgainstItsBridge) {
  const std::vector<Mode> modes = {{2 * std::numbers::pi * 100, 0, 2}, {2 * std::numbers::pi * 300, 0, 3}};
  const double shapes[] = {1, -0.5}, bridge[] = {0.5, 1};
  Body<double> body(modes, ModeShapes<double>(std::span<const double>(bridge)), {1e6, 0}, kRate,
                    ModeShapes<double>(std::span<const double>(shapes)));
  constexpr double kImpulse = 0.01;
  body.knock(kImpulse);
  body.tick(0);
  const std::span<const double> changes = body.modes().changes();
  const double work = kImpulse * kRate * (shapes[0] * changes[0] + shapes[1] * changes[1]);
  EXPECT_TRUE(relatively_within(body.energy(), work, 1e-12));
  for (int n = 0; n < 44100; ++n) body.tick(0);
  EXPECT_TRUE(relatively_within(body.energy(), work, 1e-11));
}

// |H|^2 = 1/((1 - u^2)^2 + (u/Q)^2) with u = w/x, x = tan(pi f/rate), w = tan(pi cutoff/rate): the bilinear
// transform. The quality that is not given is that of a Butterworth.
TEST(HighPass, HasTheResponseOfItsQuality) {
  for (const auto& [hz, quality] : std::vector<std::pair<double, double>>{
           {20, 0}, {80, 0}, {500, 0}, {10000, 0}, {40, 1.75}, {80, 1.75}, {500, 1.75}}) {
    HighPass<double> filter = quality > 0 ? HighPass<double>(80, kRate, quality) : HighPass<double>(80, kRate);
    const double step = 2 * std::numbers::pi * hz / kRate;
    double cosine = 0, sine = 0;
    constexpr int kSettling = 22050, kSamples = 44100;  // whole periods
    for (int n = 0; n < kSettling + kSamples; ++n) {
      const double out = filter.tick(std::cos(step * n));
      if (n < kSettling) continue;
      cosine += 2 * out * std::cos(step * n) / kSamples;
      sine += 2 * out * std::sin(step * n) / kSamples;
    }
    const double ratio = std::tan(std::numbers::pi * 80 / kRate) / std::tan(std::numbers::pi * hz / kRate);
    const double loss = quality > 0 ? 1 / quality : std::numbers::sqrt2;
    EXPECT_TRUE(within(std::hypot(cosine, sine), 1 / std::hypot(1 - ratio * ratio, loss * ratio), 1e-9))
        << hz << " Hz";
  }
}

// A unison of three under one hammer, whose force drives the exact motion of the coupled equations: levels in windows
// of 0.1 s over 8 s, and the two slopes (G. Weinreich, JASA 1977).
TEST(KeyboardOnBody, HasTheTwoDecaysOfAUnison) {
  constexpr int kPartials = 3;
  OneKey one({0, 0.15, -0.1}, kPartials);
  if (!has_losses()) one.struck.string.losses = {0, 0};  // as in Strings
  const KeyOnBody<double> keys[] = {one.key()};
  KeyboardOnBody<double> keyboard(keys, one.keyboard_board(), kRate, one.max_modes);
  keyboard.strike(0, 2);
  Sound<double> sound;
  play(keyboard, 8, sound);
  const ByHand by_hand(one, {});
  const Strings strings(one.struck, one.struck.string.detuning_cents, kPartials, kRate / 2);
  ExactMotion exact(strings, one.modes);
  exact.rest();
  const auto ear = ModalBank<double>(one.bare_modes, kRate).sound_pickup(ModeShapes<double>(one.ear));
  std::size_t advanced = 0;
  expect_two_decays(sound, kRate, 5, [&](std::size_t n) {
    for (; advanced <= n; ++advanced) exact.advance(by_hand.strike, by_hand.forces[advanced], 1 / kRate);
    return exact.body_velocity(ear);
  });
}

// Twenty keys ring with the pedal down, and every string without a damper on it with them: no sample adds energy,
// with joins and leaves in between. Bound: 1e-12 of the largest energy.
TEST(KeyboardInstrument, NeverGainsEnergy) {
  KeyboardInstrument<Piano, double> piano(kRate, 40);
  double left, right;
  const auto tick = [&] { piano.process(std::span(&left, 1), std::span(&right, 1)); };
  for (int key = 30; key < 50; ++key) piano.note_on(2 * key - 30, 0.7);
  while (piano.is_hammer_flying()) tick();
  double peak = 0, worst = 0;
  const auto listen = [&](int samples) {
    for (int n = 0; n < samples; ++n) {
      const double before = piano.energy();
      tick();
      const double growth = piano.energy() - before;
      peak = std::max(peak, before);
      worst = std::isfinite(growth) ? std::max(worst, growth) : std::numeric_limits<double>::infinity();
    }
  };
  listen(200);
  const std::size_t held = piano.awake();
  const double before = piano.energy();
  piano.sustain(1);
  EXPECT_LT(piano.energy() - before, 1e-3 * peak);  // what joins follows the bridge
  EXPECT_GT(piano.awake(), held + 20);
  for (int key = 30; key < 50; ++key) piano.note_off(2 * key - 30);
  listen(3000);
  piano.sustain(0.6);
  listen(1000);
  piano.sustain(0);
  listen(3000);
  Measured() << "grows by " << worst / peak << " of the largest energy, " << peak << " J";
  EXPECT_GT(peak, 1e-3);
  EXPECT_LE(worst, 1e-12 * peak);
}

template <typename T>
Sound<T> phrase(const std::function<std::size_t()>& next_size) {
  KeyboardInstrument<Piano, T> piano(kRate, 20);
  Sound<T> left(30000), right(30000);
  const struct {
    std::size_t time;
    std::function<void()> act;
  } events[] = {{100, [&] { piano.note_on(60, 0.7); }},
                {3001, [&] { piano.sustain(0.4), piano.note_on(64, 0.6), piano.note_on(5, 0.9); }},
                {5000, [&] { piano.note_off(60), piano.una_corda(0.7), piano.note_on(60, 0.9); }},
                {9000, [&] { piano.sostenuto(true), piano.sustain(0); }},
                {12345, [&] { piano.note_off(64), piano.note_on(108, 1), piano.note_off(60); }},
                {20000, [&] { piano.sostenuto(false), piano.note_off(108); }}};
  std::size_t done = 0;
  const auto play_to = [&](std::size_t time) {
    while (done < time) {
      const std::size_t samples = std::min(next_size(), time - done);
      piano.process(std::span(left).subspan(done, samples), std::span(right).subspan(done, samples));
      done += samples;
    }
  };
  for (const auto& event : events) play_to(event.time), event.act();
  play_to(left.size());
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

CONTACTSPLINE_EACH_PRECISION(KeyboardInstrumentIn);

TYPED_TEST(KeyboardInstrumentIn, SoundsTheSameInBlocksOfAnySize) {
  const auto in_one = phrase<TypeParam>([] { return 30000; });
  EXPECT_GT(peak_of<TypeParam>(in_one), 1e-3);
  EXPECT_LT(peak_of<TypeParam>(in_one), 10);
  std::mt19937 random(1);
  for (int trial = 0; trial < 3; ++trial)
    EXPECT_EQ(phrase<TypeParam>([&] { return std::uniform_int_distribution<std::size_t>(1, 700)(random); }), in_one);
}

// Single precision: 60 dB below the peak.
TEST(KeyboardInstrument, SoundsTheSameInSinglePrecision) {
  const auto expected = phrase<double>([] { return 512; });
  const auto single = phrase<float>([] { return 512; });
  EXPECT_TRUE(sequences_within<double>(Sound<double>(single.begin(), single.end()), expected, 1e-3));
}

// What is no number or no key does nothing; what is out of range counts as the end of its range.
TYPED_TEST(KeyboardInstrumentIn, TakesAnyControl) {
  using T = TypeParam;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInfinite = std::numeric_limits<double>::infinity();
  const auto sound = [&](bool is_wrong) {
    KeyboardInstrument<Piano, T> piano(kRate, 10);
    Sound<T> left;
    piano.sustain(is_wrong ? kInfinite : 1);
    piano.una_corda(is_wrong ? 7 : 1);
    piano.note_on(60, is_wrong ? kInfinite : 1);
    if (is_wrong) {
      piano.sustain(kNan);
      piano.una_corda(kNan);
      piano.set_hammers(static_cast<T>(kNan),
                        {.stiffness_ratio = static_cast<T>(kNan), .loss_s_per_m = static_cast<T>(kNan)});
      piano.set_soft_ratio(kNan);
      for (const std::size_t key : {39u, 88u, 1u << 31})
        piano.bend(key, kNan), piano.damp(key, static_cast<T>(kNan)), piano.strike_at(key, kNan);
      piano.bend(88, 100), piano.damp(88, 100), piano.strike_at(88, 0.1);
      for (const int key : {-1, 20, 109, 1 << 30, -(1 << 30)}) piano.note_on(key, 0.5), piano.note_off(key);
      piano.note_on(62, kNan);
    }
    play(piano, 0.1, left);
    piano.bend(39, is_wrong ? kInfinite : 4800);
    piano.damp(39, is_wrong ? static_cast<T>(-kInfinite) : T(0));
    piano.strike_at(39, is_wrong ? kInfinite : 100);
    piano.note_on(60, 0.5);
    piano.sustain(is_wrong ? -kInfinite : 0);
    play(piano, 0.1, left);
    return left;
  };
  EXPECT_EQ(sound(true), sound(false));
  EXPECT_GT(peak_of<T>(sound(false)), 1e-3);
}

/// Damps the strings without dampers, which ring in sympathy with every note.
template <typename T>
void damp_treble(KeyboardInstrument<Piano, T>& piano) {
  for (std::size_t key = Piano::last_damped_key + 1 - Piano::first_key; key < Piano::strings.size(); ++key)
    piano.damp(key, static_cast<T>(kTrebleDamping_per_s));
}

// Released, everything falls asleep: 100 dB below the peak after 3 s, exact silence in the end, and at once awake.
TYPED_TEST(KeyboardInstrumentIn, IsSilentAfterTheRelease) {
  using T = TypeParam;
  KeyboardInstrument<Piano, T> piano(kRate);
  damp_treble(piano);
  Sound<T> sound;
  for (const int key : {36, 48, 60, 67}) piano.note_on(key, 0.8);
  play(piano, 0.5, sound);
  const double peak = peak_of<T>(sound);
  for (const int key : {36, 48, 60, 67}) piano.note_off(key);
  play(piano, 2.5, sound);
  Sound<T> rest, silence;
  play(piano, 0.5, rest);
  Measured() << 20 * std::log10(peak_of<T>(rest) / peak) << " dB after 2.5 s, " << piano.modes_awake() << " modes";
  EXPECT_LT(peak_of<T>(rest), 1e-5 * peak);
  play(piano, 20, rest);
  play(piano, 0.1, silence);
  EXPECT_EQ(peak_of<T>(silence), 0);
  EXPECT_EQ(piano.awake(), 0u);
  Sound<T> again;
  piano.note_on(60, 0.8);
  play(piano, 0.1, again);
  EXPECT_GT(peak_of<T>(again), 0.1 * peak);
  double mean = 0;
  for (const T x : sound) mean += double(x) / static_cast<double>(sound.size());
  EXPECT_LT(std::abs(mean), 1e-5 * peak);
}

// A low soft note rings; a pedal moves, a key is pressed, or everything that joined leaves. Nothing of it may click:
// 60 dB below the peak of the note as a step within the next 50 ms, and what sleeps later, too.
TEST(KeyboardInstrument, DoesNotClick) {
  const struct {
    const char* name;
    std::function<void(KeyboardInstrument<Piano, double>&)> prepare, move;
  } moves[] = {{"nothing", [](auto&) {}, [](auto&) {}},
               {"sustain down", [](auto&) {}, [](auto& p) { p.sustain(1); }},
               {"sustain up", [](auto& p) { p.sustain(1); }, [](auto& p) { p.sustain(0); }},
               {"half pedal", [](auto& p) { p.sustain(1), p.note_off(36); }, [](auto& p) { p.sustain(0.5); }},
               {"una corda", [](auto&) {}, [](auto& p) { p.una_corda(1); }},
               {"press", [](auto&) {}, [](auto& p) { p.press(15), p.press(27), p.press(39); }},
               {"sostenuto", [](auto& p) { p.sostenuto(true), p.note_off(36); }, [](auto& p) { p.sostenuto(false); }},
               {"release", [](auto&) {}, [](auto& p) { p.note_off(36); }}};
  for (const auto& [name, prepare, move] : moves) {
    KeyboardInstrument<Piano, double> piano(kRate);
    Sound<double> sound;
    piano.note_on(36, 0.1);
    play(piano, 0.5, sound);
    const double peak = peak_of<double>(sound);
    prepare(piano);
    play(piano, 1, sound);
    const std::size_t moved = sound.size();
    move(piano);
    play(piano, 3, sound);
    const double before = largest_step(std::span(sound).subspan(moved - 4410, 4410)),
                 after = largest_step(std::span(sound).subspan(moved - 4));
    Measured() << name << ": " << 20 * std::log10(before / peak) << " dB before, " << 20 * std::log10(after / peak)
               << " dB after";
    EXPECT_LT(after, 1e-3 * peak) << name;
    EXPECT_LT(after, 2 * before + 1e-4 * peak) << name;
  }
}

double energy_after(const std::function<void(KeyboardInstrument<Piano, double>&)>& act, double seconds) {
  KeyboardInstrument<Piano, double> piano(kRate, 30);
  damp_treble(piano);
  piano.set_knock(0);  // the energy of strings and board alone
  Sound<double> sound;
  piano.note_on(60, 0.6);
  play(piano, 0.1, sound);
  act(piano);
  play(piano, seconds, sound);
  return piano.energy();
}

// The pedal in between damps in between: exp(-2 (1 - position) 60/s t) of the energy, within a factor for the 5 ms
// that the dampers take and the energy that other strings take up, and the board, which no damper touches: a mode
// near the lowest partial holds 8 % of what counts here.
TEST(KeyboardInstrument, HasAHalfPedal) {
  const double held = energy_after([](auto& p) { p.sustain(1); }, 0.2);
  for (const double position : {1.0, 0.9, 0.75, 0.5}) {
    const double damped = energy_after([&](auto& p) { p.sustain(position), p.note_off(60); }, 0.2);
    EXPECT_TRUE(relatively_within(std::log(held / damped), 2 * (1 - position) * 60 * 0.195, 0.1)) << position;
  }
}

// Damping beside the damper's: exp(-2 d t) of the energy, within what the board holds and loses by itself.
TEST(KeyboardInstrument, DampsAKey) {
  const double held = energy_after([](auto&) {}, 0.2);
  for (const double damping : {5.0, 20.0}) {
    const double damped = energy_after([=](auto& p) { p.damp(39, damping); }, 0.2);
    EXPECT_TRUE(relatively_within(std::log(held / damped), 2 * damping * 0.2, 0.05)) << damping;
  }
}

TEST(KeyboardInstrument, HoldsWhatSostenutoHolds) {
  const double held = energy_after([](auto&) {}, 0.2);
  const auto sostenuto = [&](bool before) {
    return energy_after(
        [&](auto& p) {
          if (before) p.sostenuto(true);
          p.note_off(60);
          p.sostenuto(true);
        },
        0.2);
  };
  EXPECT_TRUE(relatively_within(sostenuto(true), held, 1e-9));
  EXPECT_LT(sostenuto(false), 1e-4 * held);
}

// The soft pedal: the last string of three is not struck, so the whole is softer at first; one string alone meets a
// softer felt only, and has weaker high partials.
TEST(KeyboardInstrument, StrikesOneStringLessUnaCorda) {
  const auto start = [](int key, double position) {
    KeyboardInstrument<Piano, double> piano(kRate, 30);
    piano.set_knock(0);  // it is alike with and without the pedal
    piano.una_corda(position);
    piano.note_on(key, 0.6);
    Sound<double> sound;
    play(piano, 0.05, sound);
    return key == 60 ? peak_of<double>(sound) : largest_step(sound);
  };
  for (const int key : {24, 60}) {
    EXPECT_LT(start(key, 1), 0.95 * start(key, 0)) << key;
    EXPECT_LT(start(key, 1), start(key, 0.5)) << key;
    EXPECT_LT(start(key, 0.5), start(key, 0)) << key;
  }
}

// With the pedal down the strings of other keys take up energy; up, they sleep, as soon as those without a damper,
// which ring on and move the bridge, have lost theirs.
TEST(KeyboardInstrument, RingsInSympathy) {
  KeyboardInstrument<Piano, float> piano(kRate);
  Sound<float> sound;
  piano.note_on(48, 0.8);
  play(piano, 0.05, sound);
  const std::size_t alone = piano.awake();
  piano.sustain(1);
  piano.note_off(48);
  EXPECT_EQ(piano.awake(), piano.keys());
  play(piano, 1, sound);
  EXPECT_GT(piano.awake(), alone + 40);
  piano.sustain(0);
  play(piano, 9, sound);
  EXPECT_LT(piano.awake(), 25u);  // those without a damper
}

// Drums through the strings of a piano: they ring behind the push where the pedal has lifted their dampers, and also
// where the push begins so softly that strings would have left the bridge.
TEST(KeyboardInstrument, RingsUnderAnInput) {
  constexpr std::size_t kBlow = 220;  // samples: below 200 Hz
  std::vector<double> ringing;
  for (const bool is_soft_before : {false, true})
    for (const double sustain : {0, 1}) {
      KeyboardInstrument<Piano, double> piano(kRate);
      piano.set(KeyboardParameter::kSustain, sustain);
      std::vector<double> input(88200, is_soft_before ? 1e-8 : 0);
      for (std::size_t n = 0; n < kBlow; ++n)
        input[44100 + n] = 50 * std::sin(std::numbers::pi * static_cast<double>(n) / kBlow);
      std::vector<double> left(input.size());
      const std::array<std::span<double>, 2> outputs = {left, {}};
      piano.process(outputs, {}, input);
      ringing.push_back(peak_of(std::span<const double>(left).last(11025)));
      EXPECT_EQ(piano.awake() == 88, sustain > 0);
    }
  EXPECT_GT(ringing[1], 3 * ringing[0]);
  EXPECT_TRUE(relatively_within(ringing[3], ringing[1], 1e-3));
}

// The emitted numbers are those of the resonator that ships, to the digits of the header.
TEST(EmittedKeyboard, HoldsItsBody) {
  using Board = Piano::body;
  const auto shipped = [](const char* name) {
    const EmbeddedFile* file = find_embedded(Shipped::kResonators, name);
    return file == nullptr ? std::optional<Resonator>() : parse_resonator(file->content, file->name);
  };
  const auto expected = body_modes({shipped("soundboard.json"), shipped("piano_case.json")}, 22050);
  EXPECT_EQ(expected.size(), body_modes({shipped("soundboard.json"), {}}, 22050).size() + 98);
  ASSERT_EQ(Board::modes, expected.size());
  EXPECT_EQ(Board::places, 1u);
  EXPECT_EQ(*std::ranges::max_element(Piano::bridge_places), 0u);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_TRUE(
        relatively_within(Board::angular_frequencies[i], expected[i].mode.angular_frequency_rad_per_s, 1e-12));
    EXPECT_TRUE(relatively_within(Board::decays[i], expected[i].mode.decay_per_s, 1e-12));
    EXPECT_TRUE(relatively_within(Board::masses[i], expected[i].mode.mass_kg, 1e-12));
    EXPECT_TRUE(within(Board::bridge_shapes[i], expected[i].bridge_shapes.at(0), 1e-11));
    EXPECT_TRUE(within(Board::knock_shapes[i], expected[i].knock_shape, 1e-11));
    EXPECT_EQ(Board::knock_shapes[i] == 0, Board::bridge_shapes[i] != 0) << i;
    EXPECT_TRUE(within(Board::left_shapes[i], expected[i].left_shape, 1e-11));
    EXPECT_TRUE(within(Board::right_shapes[i], expected[i].right_shape, 1e-11));
  }
  EXPECT_NE(Board::right_shapes, Board::left_shapes);
}

}  // namespace
}  // namespace contactspline::testing
