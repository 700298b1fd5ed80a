// SPDX-License-Identifier: MIT
// The six strings over 19 frets of examples/instruments: fingers stop, touch and slide, and the books are exact.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "generator/instrument/instrument_reader.hpp"
#include "generator/player/instrument_parts.hpp"
#include "generator/support/input_file.hpp"
#include "support/compare.hpp"
#include "support/measured.hpp"
#include "support/seen_network.hpp"
#include "support/spectrum.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100, kScale_m = 0.648, kOfG_hz = 195.998;

/// Just behind a fret, as the fingers of its score.
double behind(int fret) {
  return kScale_m * (1 - std::exp2((0.3 - fret) / 12)) - 0.003;
}

/// The guitar, and its books since the beginning.
class Guitar {
 public:
  Guitar()
      : arrays_(instrument_arrays(
            parse_instrument(read_input(EXAMPLES_FOLDER "/fretted_guitar.json"), "fretted_guitar.json", read_input),
            kRate)),
        played_(arrays_.view(), kRate),
        balance_(played_.energy()) {}

  void set(const std::string& parameter, double value) {
    const auto& parameters = arrays_.model->parameters;
    const auto found = std::ranges::find(parameters, parameter, &ModelParameter::name);
    ASSERT_NE(found, parameters.end()) << parameter;
    played_.set(std::size_t(found - parameters.begin()), value);
  }
  void pluck(const std::string& event, double force_n) {
    const auto& events = arrays_.model->events;
    const auto found = std::ranges::find(events, event, &ModelEvent::name);
    ASSERT_NE(found, events.end()) << event;
    played_.pluck(found->number, force_n);
  }
  /// The force of one string on the saddle [N].
  std::vector<float> play(double seconds, const std::string& bridge = "g3_bridge") {
    const auto& connections = arrays_.model->connections;
    std::size_t link = 0;
    for (auto group = connections.begin(); group->name != bridge; ++group) link += group->gaps_m.size();
    std::vector<float> force;
    for (int n = 0; n < int(seconds * kRate); ++n) {
      played_.tick();
      balance_ += played_.work() - played_.dissipated();
      imbalance = std::max(imbalance, std::abs(played_.energy() - balance_));
      largest_energy = std::max(largest_energy, played_.energy());
      for (const std::size_t k : played_.active())
        if (k < arrays_.connections.size()) rounding += played_.rounding_j(k);
      force.push_back(float(played_.force(link)));
    }
    return force;
  }
  [[nodiscard]] std::size_t bounded() const { return played_.bounded(); }

  double imbalance = 0, largest_energy = 0, rounding = 0;

 private:
  InstrumentArrays arrays_;
  SeenNetwork<double> played_;
  double balance_;
};

// Cents of the pitch over that of equal temperament.
double cents_of(const std::vector<float>& force, int fret) {
  const double expected = kOfG_hz * std::exp2(fret / 12.0);
  const auto found = strongest_partial(std::span(force), kRate, 0.95 * expected, 1.05 * expected);
  return 1200 * std::log2(found.frequency_hz / expected);
}

// A string pressed behind a fret sounds from there. It bends over the fret as if it were shorter, which the place of
// the frets takes back in part, and modes of the body draw fundamentals aside: players know some cents of both.
TEST(FrettedGuitar, SoundsFromTheFretThatAFingerPresses) {
  Guitar guitar;
  for (const int fret : {0, 3, 7, 12}) {
    guitar.set("g3_finger_place_m", fret == 0 ? 0.1 : behind(fret));
    guitar.set("g3_press_force_n", fret == 0 ? 0 : 8);
    (void)guitar.play(0.3);
    guitar.pluck("pluck_finger_g3", -1.5);
    (void)guitar.play(0.15);
    const double cents = cents_of(guitar.play(0.5), fret);
    EXPECT_TRUE(within(cents, 0, 10)) << "fret " << fret;
    Measured() << "fret " << fret << ": " << cents << " cents";
  }
  EXPECT_TRUE(within(guitar.imbalance, 0, 1e-12 * guitar.largest_energy + 8 * guitar.rounding));
  EXPECT_EQ(guitar.bounded(), 0u);
  Measured() << "imbalance " << guitar.imbalance << " of " << guitar.largest_energy << " J";
}

// A touch over the twelfth fret leaves the even partials.
TEST(FrettedGuitar, HasHarmonicsWhereAFingerTouches) {
  Guitar guitar;
  guitar.set("g3_finger_place_m", 0.324);
  guitar.set("g3_touch_resistance_n_s_per_m", 0.5);
  (void)guitar.play(0.1);
  guitar.pluck("pluck_finger_g3", -2);
  (void)guitar.play(0.1);
  guitar.set("g3_touch_resistance_n_s_per_m", 0);
  (void)guitar.play(0.1);
  const auto force = guitar.play(0.5);
  const auto level = [&](int partial) {
    const double hz = partial * kOfG_hz;
    return 20 * std::log10(strongest_partial(std::span(force), kRate, 0.95 * hz, 1.05 * hz).amplitude);
  };
  EXPECT_GT(level(2), level(1) + 20);
  EXPECT_GT(level(4), level(3) + 20);
  Measured() << "partials 1 to 4: " << level(1) << ", " << level(2) << ", " << level(3) << ", " << level(4) << " dB";
}

// A finger that moves while it presses takes the pitch with it, fret by fret.
TEST(FrettedGuitar, SlidesWithoutAnotherPluck) {
  Guitar guitar;
  guitar.set("g3_finger_place_m", behind(3));
  guitar.set("g3_press_force_n", 10);
  (void)guitar.play(0.3);
  guitar.pluck("pluck_finger_g3", -3);
  (void)guitar.play(0.1);
  for (int step = 1; step <= 50; ++step) {
    guitar.set("g3_finger_place_m", behind(3) + (behind(8) - behind(3)) * step / 50);
    (void)guitar.play(0.004);
  }
  (void)guitar.play(0.1);
  EXPECT_TRUE(within(cents_of(guitar.play(0.4), 8), 0, 10));
}

}  // namespace
}  // namespace contactspline::testing
