// SPDX-License-Identifier: MIT
// Examples that rub or are rough, under their scores: one slip a period, noise that goes with the speed, no clipping,
// silence at the end, exact books.
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "generator/player/instrument_parts.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/player/voice_tracks.hpp"
#include "generator/support/input_file.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/seen_network.hpp"
#include "support/spectrum.hpp"

namespace contactspline::testing {
namespace {

constexpr int kRate = 44100;

/// An example under its score. Its friction, if it has one, is the last connection, its sound the first output.
struct Rubbed {
  explicit Rubbed(const std::string& name) {
    const std::string folder = EXAMPLES_FOLDER "/../scores/";
    const Score score = parse_score(read_input(folder + name + ".json"), name + ".json",
                                    [&](const std::string& path) { return read_input(folder + path); });
    const Voice& voice = score.voices.front();
    arrays = instrument_arrays(*voice.model, kRate);
    SeenNetwork<double> instrument(arrays.view(), kRate);
    ControlTrack controls(voice, kRate);
    const std::size_t friction = arrays.connections.size() - 1;
    double balance = instrument.energy();
    for (std::size_t n = 0; n < at(score.duration_s); ++n) {
      const auto values = controls.at(n);
      for (std::size_t i = 0; i < values.size(); ++i) instrument.set(i, values[i]);
      instrument.tick();
      balance += instrument.work() - instrument.dissipated();
      imbalance = std::max(imbalance, std::abs(instrument.energy() - balance));
      energy = std::max(energy, instrument.energy());
      for (std::size_t k = 0; k < arrays.connections.size(); ++k)
        if (arrays.connections[k].kind == ConnectionKind::kFriction || arrays.connections[k].roughness.height_m != 0)
          rounding += instrument.rounding_j(k);
      sound.push_back(instrument.output(0));
      second.push_back(instrument.output(1));
      slip_m_per_s.push_back(instrument.slip(friction) * kRate);
    }
    bounded = instrument.bounded();
  }

  static std::size_t at(double time_s) { return static_cast<std::size_t>(time_s * kRate); }
  [[nodiscard]] double peak(double from_s, double to_s) const {
    double peak = 0;
    for (std::size_t n = at(from_s); n < at(to_s) && n < sound.size(); ++n) peak = std::max(peak, std::abs(sound[n]));
    return peak;
  }

  // The level of the sound [dB], and the frequency below which half of its power lies.
  struct Noise {
    double level_db, median_hz;
  };
  [[nodiscard]] Noise noise(double from_s, double to_s) const {
    const std::size_t begin = at(from_s), size = at(to_s) - begin;
    std::vector<double> sums(1);
    for (double hz = 100; hz < 8000; hz *= 1.02) {  // bands of equal ratios
      std::complex<double> sum = 0;
      const double w = 2 * std::numbers::pi * hz / kRate;
      for (std::size_t n = 0; n < size; ++n)
        sum +=
            sound[begin + n] * std::sin(std::numbers::pi * double(n) / double(size)) * std::polar(1.0, w * double(n));
      sums.push_back(sums.back() + std::norm(sum) * hz);
    }
    const auto half = std::ranges::lower_bound(sums, sums.back() / 2) - sums.begin();
    return {10 * std::log10(sums.back() / double(size)), 100 * std::pow(1.02, double(half))};
  }

  // Books as in instrument_energy_test. The last quarter of a second is 100 dB down, but for a constant: links creep
  // under a wheel that stands.
  void expect_sane() const {
    EXPECT_TRUE(within(imbalance, 0, 1e-12 * energy + 8 * rounding));
    EXPECT_EQ(bounded, 0U);
    const double largest = peak(0, 100);
    EXPECT_LT(largest, arrays.outputs[0].full_scale) << "it clips";
    EXPECT_GT(largest, 0.1 * arrays.outputs[0].full_scale);
    const auto [low, high] = std::minmax_element(sound.end() - kRate / 4, sound.end());
    EXPECT_LT(*high - *low, 1e-5 * largest);
    Measured() << "peak " << largest << ", imbalance " << imbalance << " of " << energy << " J";
  }

  // Under a surface at this speed slips begin once in each period, all equally long to 2 samples. A slip counts that
  // follows a stick and is faster than a fifth of the speed.
  void expect_one_slip_a_period(double from_s, double to_s, double speed_m_per_s, double pitch_hz) const {
    std::vector<double> begins;
    bool has_stuck = false;
    for (std::size_t n = at(from_s); n < at(to_s); ++n) {
      if (slip_m_per_s[n] > 0.2 * speed_m_per_s && std::exchange(has_stuck, false)) begins.push_back(double(n));
      has_stuck |= slip_m_per_s[n] < 0.05 * speed_m_per_s;
    }
    ASSERT_GT(begins.size(), 100U);
    const double period = (begins.back() - begins.front()) / double(begins.size() - 1);
    for (std::size_t i = 1; i < begins.size(); ++i) ASSERT_TRUE(within(begins[i] - begins[i - 1], period, 2)) << i;
    const double cents = 1200 * std::log2(kRate / period / pitch_hz);
    EXPECT_TRUE(within(cents, 0, 10));
    Measured() << kRate / period << " Hz, " << cents << " cents";
  }

  InstrumentArrays arrays;
  std::vector<double> sound, second, slip_m_per_s;
  double imbalance = 0, energy = 0, rounding = 0;
  std::size_t bounded = 0;
};

TEST(RubbedExamples, BowMakesABarSing) {
  const Rubbed bar("bowed_vibraphone");
  bar.expect_sane();
  bar.expect_one_slip_a_period(1, 1.8, 0.2, 261.63);
  bar.expect_one_slip_a_period(3.2, 4.2, 0.4, 261.63);
}

TEST(RubbedExamples, FingersMakeARodSing) {
  const Rubbed rod("singing_rod");
  rod.expect_sane();
  rod.expect_one_slip_a_period(3, 4, 0.3, 2527.6);
  EXPECT_LT(rod.peak(0.8, 1), 0.01 * rod.peak(3, 4)) << "it takes a second or two";
}

// The lowest mode of five nodal diameters: lambda^2 = 32.911, of Leissa's equation for this Poisson's ratio. The
// finger lets no lower one sing.
TEST(RubbedExamples, BowMakesACymbalSing) {
  const Rubbed cymbal("bowed_cymbal");
  cymbal.expect_sane();
  cymbal.expect_one_slip_a_period(1.2, 2.4, 0.1, 304.92);
  cymbal.expect_one_slip_a_period(3.6, 4.7, 0.2, 304.92);
  EXPECT_LT(cymbal.peak(0, 0.3), 0.1 * cymbal.peak(3.6, 4.7)) << "it begins softly";
}

// While the wheel turns evenly the foot stays on the board; jerked, it lifts and meets the board again and again.
TEST(RubbedExamples, JerkOfAWheelMakesItsChienBuzz) {
  const Rubbed gurdy("hurdy_gurdy");
  gurdy.expect_sane();
  gurdy.expect_one_slip_a_period(1, 2, 0.5, 261.63);
  const auto lifts = [&](double from_s, double to_s) {
    int count = 0;
    const double least = *std::min_element(gurdy.second.begin(), gurdy.second.end());
    for (std::size_t n = Rubbed::at(from_s); n < Rubbed::at(to_s); ++n)
      count += gurdy.second[n] == least && gurdy.second[n - 1] > least;  // outputs count from the force at rest
    return count;
  };
  EXPECT_EQ(lifts(1, 2), 0);
  for (const double jerk_s : {2.0, 2.6, 3.2}) EXPECT_GE(lifts(jerk_s, jerk_s + 0.3), 10);
  EXPECT_EQ(lifts(3.6, 4.5), 0);
}

// A finger on windings of 0.4 mm: while it slides steadily, the string's end is moved at its speed over this length.
TEST(RoughExamples, FingerSqueaksOnAWoundString) {
  const Rubbed played("wound_string");
  played.expect_sane();
  BySample<double> guitar(played.arrays.view(), kRate);
  const auto number = [&](std::string_view name) {
    const auto found = std::ranges::find(guitar.parameters(), name, &Parameter::name);
    return static_cast<std::size_t>(found - guitar.parameters().begin());
  };
  guitar.set(number("press_force_n"), 1);
  for (const double speed : {0.2, 0.4, 0.8}) {
    std::vector<float> sound;
    for (int n = 0; n < 0.4 * kRate; ++n) {
      guitar.set(number("finger_place_m"), 0.15 + speed * n / kRate);
      guitar.tick();
      sound.push_back(static_cast<float>(guitar.output(0)));
    }
    const double pitch = speed / 4e-4;
    const Partial squeak = strongest_partial(std::span(sound).last(kRate / 5), kRate, 0.7 * pitch, 1.4 * pitch);
    EXPECT_TRUE(relatively_within(squeak.frequency_hz, pitch, 0.01)) << speed;
    EXPECT_GT(squeak.amplitude, 0.01) << speed;
    guitar.set(number("finger_place_m"), 0.15);
    for (int n = 0; n < kRate; ++n) guitar.tick();
  }
}

// Faster sweeps are brighter, a brush that stands is silent.
TEST(RoughExamples, BrushHissesAsItIsSwept) {
  const Rubbed brush("brush");
  brush.expect_sane();
  const auto slow = brush.noise(0.45, 0.6), fast = brush.noise(1.95, 2.1);
  Measured() << slow.level_db << " dB, half of it below " << slow.median_hz << " Hz; faster " << fast.level_db
             << " dB, " << fast.median_hz << " Hz";
  EXPECT_GT(fast.median_hz, 1.2 * slow.median_hz);
  EXPECT_LT(brush.peak(3.9, 4), 0.01 * brush.peak(2.8, 3.2));
}

}  // namespace
}  // namespace contactspline::testing
