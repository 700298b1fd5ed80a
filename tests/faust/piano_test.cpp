// SPDX-License-Identifier: MIT
// piano.dsp against independent computations: its voices, the strings of a key, pedals, and the soundboard.
#include "contactspline/keyboards/piano.hpp"

#include <complex>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/step/high_pass.hpp"
#include "cpp_program.hpp"
#include "generator/resonator/keyboard.hpp"
#include "generator/resonator/keyboard_reader.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/spline/contact_spline.hpp"
#include "generator/spline/design.hpp"
#include "support/compare.hpp"

#define FAUSTFLOAT double
#include "piano_double.hpp"
#include "piano_effect_double.hpp"

namespace contactspline::testing {
namespace {

using Program = CppProgram<piano_double, double>;

constexpr int kRate = 44100;
constexpr double kVelocity = 0.7;
constexpr double kVolume = 0.5, kFullScale_n = 50;
constexpr std::size_t kLatency = 4;  // samples: the loop's one, and 3 of the interpolation

std::string text_of(const std::string& file) {
  std::ifstream stream(SOURCE_FOLDER "/data/" + file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

const Keyboard& piano() {
  static const Keyboard keyboard = parse_keyboard(text_of("keyboards/piano.json"), "piano.json");
  return keyboard;
}

std::vector<double> cents_of(int key) {
  return strings_on_body(note_of(piano(), key), *piano().body).detuning_cents;
}

/// Frequency of the note whose highest string is in tune with the key.
double frequency_hz(int key) {
  const double highest = std::ranges::max(cents_of(key));
  return 440 * std::exp2((key - 69) / 12.0 - highest / 1200);
}

Program struck(int key, double velocity = kVelocity, double soft = 0) {
  Program program(kRate);
  program.set("freq", frequency_hz(key));
  program.set("gain", velocity);
  program.set("soft pedal", soft);
  program.set("gate", 1);
  return program;
}

/// One string of a key with its share of the hammer, and the force of that string on the bridge.
class OneString {
 public:
  explicit OneString(int key, double mass_ratio = 1, double stiffness_ratio = 1)
      : note_(note_of(piano(), key)),
        felt_(segment_table(design_spline(note_.felt, "piano"))),
        rows_(modes_below(note_.string, kRate / 2.0, 80)),
        voice_({.felt = felt_,
                .modes = bare(rows_),
                .strike = strike(),
                .output = bridge_shapes<double>(note_.string, rows_, 1),
                .controls = {.hammer_mass_kg = mass_ratio * note_.hammer_mass_kg,
                             .felt = {stiffness_ratio, piano().felt_loss_s_per_m}},
                .damper = {piano().damper_per_s, piano().damper_time_s}},
               kRate) {}

  HammerVoice<double>& voice() { return voice_; }

 private:
  [[nodiscard]] ModeShapes<double> strike() const {
    ModeShapes<double> shapes(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i)
      shapes[i] = std::sin(rows_[i].wavenumber_per_m * note_.strike_position_m);
    return shapes;
  }

  KeyboardNote note_;
  std::vector<Segment<double>> felt_;
  std::vector<StringMode> rows_;
  HammerVoice<double> voice_;
};

/// A signal at a time between samples: the polynomial of seventh degree through eight samples, by Neville's scheme.
double between_samples(const std::vector<double>& signal, std::ptrdiff_t first, double place) {
  std::array<double, 8> value{};
  for (std::ptrdiff_t i = 0; i < 8; ++i)
    if (first + i >= 0) value[static_cast<std::size_t>(i)] = signal.at(static_cast<std::size_t>(first + i));
  for (std::size_t step = 1; step < 8; ++step)
    for (std::size_t i = 0; i + step < 8; ++i)
      value[i] =
          ((place - static_cast<double>(i + step)) * value[i] - (place - static_cast<double>(i)) * value[i + 1]) /
          (static_cast<double>(i) - static_cast<double>(i + step));
  return value[0];
}

/// What the strings of a key make of the force of the highest of them; the first `silent` are not struck.
std::vector<double> in_unison(const std::vector<double>& force, int key, std::size_t silent = 0) {
  const auto cents = cents_of(key);
  std::vector<double> sum(force.size());
  for (std::size_t k = silent; k < cents.size(); ++k) {
    const double slowness = 1 - std::exp2((cents[k] - std::ranges::max(cents)) / 1200);
    for (std::size_t n = 0; n < force.size(); ++n) {
      // The delay grows from the first millisecond on.
      const double delay = slowness * std::max(0.0, static_cast<double>(n) - 43);
      const auto whole = static_cast<std::ptrdiff_t>(delay);
      const auto first = static_cast<std::ptrdiff_t>(n) - whole - 7;
      sum[n] += between_samples(force, first, 4 - (delay - static_cast<double>(whole)));
    }
  }
  for (double& value : sum) value *= note_of(piano(), key).output_ratio * kVolume / kFullScale_n;
  return sum;
}

// The program's samples, from where the force of the C++ model begins; both outputs are the same.
std::vector<double> without_latency(Signals<double> outputs, std::size_t latency) {
  EXPECT_EQ(outputs.at(0), outputs.at(1));
  outputs[0].erase(outputs[0].begin(), outputs[0].begin() + static_cast<std::ptrdiff_t>(latency));
  return outputs[0];
}

// Keys of one, two and three strings: a voice of HammerVoice, read at each string's own time. `in_unison`
// interpolates between the samples n - 7 and n, Faust between the same: it needs three of these eight after the time
// it reads.
TEST(Piano, PlaysTheStringsOfAKey) {
  constexpr std::size_t kSamples = 22050;
  for (const int key : {25, 33, 60, 96}) {
    OneString string(key);
    string.voice().strike(strike_speed(piano(), kVelocity));
    std::vector<double> force(kSamples);
    for (double& value : force) value = string.voice().tick();
    const auto found = without_latency(struck(key).run({}, kSamples + 1), 1);
    EXPECT_TRUE(sequences_within<double>(found, in_unison(force, key), 1e-9)) << "key " << key;
  }
}

// Under the soft pedal the hammer strikes one string fewer, of two or three, with its whole mass and softer felt.
TEST(Piano, LeavesAStringOutUnderTheSoftPedal) {
  constexpr std::size_t kSamples = 11025;
  for (const int key : {25, 33, 60}) {
    const int strings = note_of(piano(), key).strings, struck_strings = std::max(1, strings - 1);
    OneString string(key, double(strings) / struck_strings, piano().body->una_corda_stiffness_ratio);
    string.voice().strike(strike_speed(piano(), kVelocity));
    std::vector<double> force(kSamples);
    for (double& value : force) value = string.voice().tick();
    const auto found = without_latency(struck(key, kVelocity, 1).run({}, kSamples + 1), 1);
    EXPECT_TRUE(sequences_within<double>(
        found, in_unison(force, key, static_cast<std::size_t>(strings - struck_strings)), 1e-9))
        << "key " << key;
  }
}

// Faust's damper glides with each sample, C++'s by 16 samples with the same mean. While it covers D = 60/s the
// two differ by d, in each 16 samples of length h by no more than half of what the glide does in them, and by a
// quarter in the mean: the sum of |d| dt is D h/4. A damper of decay d takes 2 d v dt of the velocity v, of an
// oscillation d dt of its amplitude in the mean, where the two agree, and no more than that swinging about it: no
// mode differs by more than D h/4 of itself, and of many modes no more than that of the root of the mean square.
TEST(Piano, ReleasesAKeyAsHammerVoiceDoes) {
  constexpr std::size_t kHeld = 4000, kSamples = kHeld + 4410;
  for (const int key : {33, 60}) {
    Program program = struck(key);
    auto sound = program.run({}, kHeld + 1)[0];
    program.set("gate", 0);
    const auto rest = program.run({}, kSamples - kHeld)[0];
    sound.insert(sound.end(), rest.begin(), rest.end());
    sound.erase(sound.begin());
    OneString string(key);
    string.voice().strike(strike_speed(piano(), kVelocity));
    std::vector<double> force(kSamples);
    for (std::size_t n = 0; n < kSamples; ++n) {
      if (n == kHeld) string.voice().release();
      force[n] = string.voice().tick();
    }
    const auto expected = in_unison(force, key);
    double error = 0, size = 0;
    for (std::size_t n = kHeld; n < kSamples; ++n) {
      error += std::pow(sound[n] - expected[n], 2);
      size += std::pow(expected[n], 2);
    }
    EXPECT_TRUE(within(std::sqrt(error / size), 0, 60 * 16.0 / kRate / 4)) << "key " << key;
  }
}

// A pedal that is half down lets the dampers act by half.
TEST(Piano, HalvesTheDampersUnderAHalfPedal) {
  const auto released = [](double pedal, double damper) {
    Program program = struck(60);
    program.set("sustain pedal", pedal);
    program.set("damper", damper);
    (void)program.run({}, 4000);
    program.set("gate", 0);
    return program.run({}, 8000)[0];
  };
  EXPECT_TRUE(sequences_within<double>(released(0.5, 60), released(0, 30), 1e-12));
  EXPECT_TRUE(sequences_within<double>(released(1, 60), released(0, 0), 1e-12));
}

/// Amplitude of a partial around a sample, by a Hann window of 0.2 s.
double level(const std::vector<double>& sound, std::size_t middle, double frequency) {
  constexpr std::size_t kWindow = 8820;
  std::complex<double> sum = 0;
  for (std::size_t n = 0; n < kWindow; ++n) {
    const double window = 1 - std::cos(2 * std::numbers::pi * (static_cast<double>(n) + 0.5) / kWindow);
    sum += window * sound.at(middle - kWindow / 2 + n) *
           std::polar(1.0, -2 * std::numbers::pi * frequency * static_cast<double>(n) / kRate);
  }
  return std::abs(sum) / kWindow;
}

// The strings of middle C beat as three strings that are simulated one by one. Bending stiffness takes the part eta =
// B i^2/(1 + B i^2) of a mode's stiffness; tension that changes by `cents` changes its frequency w by the ratio
// epsilon (1 - eta), where Faust changes it by epsilon: after a time t the phases differ by eta epsilon w t. The
// level of the sum of three strings differs by no more than a third of the sum of these, of the level of three
// strings in phase; 1e-3 for attack and losses, which change by epsilon = 5e-4 too.
TEST(Piano, BeatsAsThreeStringsDo) {
  KeyboardNote note = note_of(piano(), 60);
  StiffString strings = note.string;
  strings.detuning_cents = cents_of(60);
  const auto rows = modes_below(strings, kRate / 2.0, 80);
  ModeShapes<double> strike(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i)
    strike[i] = std::sin(rows[i].wavenumber_per_m * note.strike_position_m) / 3;
  const auto felt = segment_table(design_spline(note.felt, "piano"));
  HammerVoice<double> voice(
      {.felt = felt,
       .modes = bare(rows),
       .strike = strike,
       .output = bridge_shapes<double>(strings, rows, 1),
       .controls = {.hammer_mass_kg = 3 * note.hammer_mass_kg, .felt = {3, piano().felt_loss_s_per_m}},
       .damper = {piano().damper_per_s, piano().damper_time_s}},
      kRate);
  voice.strike(strike_speed(piano(), kVelocity));
  constexpr std::size_t kSamples = 6 * kRate;
  std::vector<double> expected(kSamples);
  voice.process(expected);
  Program program = struck(60);
  program.set("freq", 440 * std::exp2((60 - 69) / 12.0));
  const auto found = without_latency(program.run({}, kSamples + kLatency), kLatency);

  const double highest = std::ranges::max(strings.detuning_cents);
  const double bending =
      std::pow(std::numbers::pi / strings.length_m, 2) * strings.bending_stiffness_n_m2 / strings.tension_n;
  double lowest = 1;
  for (const int partial : {1, 2, 3}) {
    const Mode mode = *undamped_mode(note.string, partial).with(note.string.losses);
    const double eta = bending * partial * partial / (1 + bending * partial * partial);
    const double start = 0.2, reference = level(expected, static_cast<std::size_t>(start * kRate),
                                                mode.angular_frequency_rad_per_s / (2 * std::numbers::pi));
    for (double t = 0.5; t < 5.8; t += 0.5) {
      const auto middle = static_cast<std::size_t>(t * kRate);
      const double hz = mode.angular_frequency_rad_per_s / (2 * std::numbers::pi);
      const double in_phase = reference * std::exp(-mode.decay_per_s * (t - start));
      double bound = 1e-3;
      for (const double cents : strings.detuning_cents)
        bound += std::log(2) / 1200 * (highest - cents) * eta * mode.angular_frequency_rad_per_s * t / 3;
      const double scale = note_of(piano(), 60).output_ratio * kVolume / kFullScale_n;
      EXPECT_TRUE(
          within(level(found, middle, hz) / (scale * in_phase), level(expected, middle, hz) / in_phase, bound))
          << "partial " << partial << " at " << t << " s";
      lowest = std::min(lowest, level(expected, middle, hz) / in_phase);
    }
  }
  EXPECT_LT(lowest, 0.5) << "they do not beat";
}

// A string that still sounds when its key is struck again does not click. After 3 s the strings of middle C are late
// by 69, 31 and 0 samples. These delays fall to 0 by exp(-10000 t), at first by 0.2 of themselves in a sample, so the
// strings are read up to 14.8, 7.2 and 1 times as fast, and their steps grow by as much: by 7.7 in the mean. Delays
// that jump to 0 make a step of 14.
TEST(Piano, IsStruckAgainWithoutAClick) {
  Program program = struck(60, 1);
  const auto before = program.run({}, 3 * kRate)[0];
  program.set("gate", 0);
  program.set("sustain pedal", 1);
  auto after = program.run({}, 1)[0];
  program.set("gate", 1);
  program.set("gain", 0);
  const auto rest = program.run({}, 60)[0];  // the wave of the soft hammer, 0.2 m/s, comes later than that
  after.insert(after.end(), rest.begin(), rest.end());
  const auto largest_step = [](std::span<const double> x) {
    double largest = 0;
    for (std::size_t n = 1; n < x.size(); ++n) largest = std::max(largest, std::abs(x[n] - x[n - 1]));
    return largest;
  };
  const double old_step = largest_step(std::span(before).last(1000));
  EXPECT_GT(old_step, 0);
  EXPECT_LT(largest_step(after), 7.7 * old_step);
}

/// What is heard of the soundboard of the file, driven by a force, in C++.
Signals<double> on_soundboard(const std::vector<double>& force_n) {
  const Resonator board = parse_resonator(text_of("resonators/soundboard.json"), "soundboard.json");
  const auto rows = modes_of(board, 22050).modes;
  ModeShapes<double> bridge(rows.size()), left(rows.size()), right(rows.size());
  const auto& table = std::get<ModeTable>(board.body).rows;  // by rising frequency, as rows
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bridge[i] = rows[i].strike_shape;
    left[i] = rows[i].pickup_shape;
    right[i] = table[i].right_shape;
  }
  ModalBank<double> bank(bare(rows), kRate);
  const auto at_left = bank.sound_pickup(left), at_right = bank.sound_pickup(right);
  const auto& listening = piano().body->listening;
  HighPass<double> high_pass(listening.above_hz, kRate, listening.quality);
  Signals<double> velocities(2);
  for (const double force : force_n) {
    bank.predict();
    bank.push(bridge, force);
    bank.commit();
    const double direct = listening.mobility_m_per_n_s * high_pass.tick(force);
    velocities[0].push_back(listening.pickup_ratio * bank.velocity(at_left) + direct);
    velocities[1].push_back(listening.pickup_ratio * bank.velocity(at_right) + direct);
  }
  return velocities;
}

// Voice and effect: the strings of a key, on the bank of the board's modes.
TEST(Piano, SoundsThroughItsSoundboard) {
  const auto voice = struck(60).run({}, kRate / 2);
  CppProgram<piano_effect_double, double> effect(kRate);
  const auto found = effect.run(voice, voice[0].size());
  std::vector<double> force_n;
  for (const double x : voice[0]) force_n.push_back(kFullScale_n * x);
  auto expected = on_soundboard(force_n);
  constexpr double kFullScale_m_per_s = 0.1;
  for (auto& channel : expected)
    for (double& value : channel) value /= kFullScale_m_per_s;
  EXPECT_TRUE(sequences_within<double>(found[0], expected[0], 1e-9));
  EXPECT_TRUE(sequences_within<double>(found[1], expected[1], 1e-9));
}

// Noise, which has all frequencies.
TEST(Piano, HearsNoiseThroughItsSoundboard) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> force(-1, 1);
  std::vector<double> noise(kRate / 4);
  for (double& value : noise) value = force(random);
  CppProgram<piano_effect_double, double> effect(kRate);
  const auto found = effect.run({noise, noise}, noise.size());
  auto expected = on_soundboard(noise);
  for (auto& channel : expected)
    for (double& value : channel) value *= kFullScale_n / 0.1;
  EXPECT_TRUE(sequences_within<double>(found[0], expected[0], 1e-9));
  EXPECT_TRUE(sequences_within<double>(found[1], expected[1], 1e-9));
}

// A chord of four notes, soft and loud, in both ears. At volume 0.5, 0.2 m/s of the board are full scale.
TEST(Piano, IsLoudEnoughAndDoesNotClip) {
  for (const double velocity : {0.5, 1.0}) {
    Signals<double> sum(2, std::vector<double>(kRate / 2));
    for (const int key : {48, 60, 64, 67}) {
      const auto voice = struck(key, velocity).run({}, sum[0].size());
      for (std::size_t channel = 0; channel < 2; ++channel)
        for (std::size_t n = 0; n < sum[channel].size(); ++n) sum[channel][n] += voice[channel][n];
    }
    CppProgram<piano_effect_double, double> effect(kRate);
    const auto sound = effect.run(sum, sum[0].size());
    for (const auto& channel : sound) {
      double peak = 0;
      for (const double x : channel) {
        ASSERT_TRUE(std::isfinite(x));
        peak = std::max(peak, std::abs(x));
      }
      const double decibels = 20 * std::log10(peak);
      RecordProperty("peak_db_" + std::to_string(velocity), std::to_string(decibels));
      EXPECT_GT(decibels, -30);
      EXPECT_LT(decibels, 0);
    }
  }
}

}  // namespace
}  // namespace contactspline::testing
