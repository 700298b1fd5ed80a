// SPDX-License-Identifier: MIT
// The classes emitted for instrument files, compiled here as in a program of a user.
#include <map>
#include <memory>
#include <string>

#include "contactspline/instruments/prepared_piano.hpp"
#include "contactspline/instruments/slap_bass.hpp"
#include "contactspline/instruments/snare.hpp"
#include "contactspline/instruments/tanpura.hpp"
#include "contactspline/instruments/tom.hpp"
#include "contactspline/instruments/trichord_c4.hpp"
#include "generator/player/score_player.hpp"
#include "generator/player/score_reader.hpp"
#include "generator/player/voice_tracks.hpp"
#include "generator/support/embedded_files.hpp"
#include "support/compare.hpp"

namespace contactspline::testing {
namespace {

constexpr double kRate = 44100;

Score shipped_score(const std::string& name) {
  return parse_score(find_embedded(Shipped::kScores, name + ".json")->content, name, shipped_file);
}

// Drives the arrays of the emitted class, without its keys, by a score with one voice, and compares the first output
// with what `render` plays, bit by bit.
template <typename Emitted>
void expect_same_as_render(const std::string& score_name) {
  Score score = shipped_score(score_name);
  score.duration_s = 0.75;
  ASSERT_EQ(score.voices.size(), 1u);
  const Voice& played = score.voices[0];
  const Performance expected = play(score, {kRate}, [](double) {});

  const auto emitted = std::make_unique<NetworkInstrument<double>>(Emitted::data::view(), kRate);
  ControlTrack controls(played, kRate);
  StrikeTrack strikes(played.strikes, kRate);
  double largest = 0;
  for (std::size_t n = 0; n < expected.samples.size(); ++n) {
    const auto values = controls.at(n);
    for (std::size_t i = 0; i < values.size(); ++i) emitted->set(i, values[i]);
    while (const auto* change = strikes.next_until(n))
      emitted->strike(change->strike->strike, change->strike->speed_m_per_s);
    double sample = 0;
    emitted->process(std::span(&sample, 1));
    ASSERT_EQ(static_cast<float>(sample), expected.samples[n]) << n;
    largest = std::max(largest, std::abs(sample));
  }
  EXPECT_GT(largest, 1e-3);
}

TEST(EmittedClass, PlaysTheSamplesOfRender) {
  expect_same_as_render<instruments::trichord_c4<>>("trichord_blows");
  expect_same_as_render<instruments::slap_bass<>>("slap_line");
  expect_same_as_render<instruments::prepared_piano<>>("prepared_notes");
  expect_same_as_render<instruments::snare<>>("snare_roll");
  expect_same_as_render<instruments::tom<>>("tom_pattern");
}

TEST(EmittedClass, PlaysTheSamplesOfRenderForAPluck) {
  NetworkInstrument<double> emitted(instruments::tanpura<>::data::view(), kRate);
  Score score = parse_score(R"({ "instrument": "tanpura", "duration_s": 0.5,
      "events": [ { "time_s": 0, "finger_force_n": 0.4 }, { "time_s": 0.01, "finger_force_n": 0 },
                  { "time_s": 0.2, "bridge_gap_shift_m": -1e-6, "hand_damping_per_s": 3 } ] })",
                            "probe.json", shipped_file);
  const Performance expected = play(score, {kRate}, [](double) {});
  for (std::size_t n = 0; n < expected.samples.size(); ++n) {
    if (n == 0) emitted.set(0, 0.4);
    if (n == 441) emitted.set(0, 0);
    if (n == 8820) emitted.set(2, -1e-6);
    if (n == 8820) emitted.set(1, 3);
    emitted.tick();
    ASSERT_EQ(static_cast<float>(emitted.output(0)), expected.samples[n]) << n;
  }
}

static_assert(Instrument<instruments::trichord_c4<float>> && Instrument<Voices<NetworkInstrument<float>>> &&
              KeyedInstrument<NetworkInstrument<double>>);

TEST(EmittedClass, NamesItsParameters) {
  instruments::trichord_c4<> named(kRate);
  named.set_felt_loss_s_per_m(0.3);
  named.set_damper_damping_per_s(7);
  named.set_hammer_speed_m_per_s(1.5);
  const std::map<std::string, double> set = {
      {"felt_loss_s_per_m", 0.3}, {"damper_damping_per_s", 7}, {"hammer_speed_m_per_s", 1.5}};
  for (std::size_t p = 0; p < named.parameters().size(); ++p) {
    const auto expected = set.find(named.parameters()[p].name);
    EXPECT_EQ(named.value(p), expected == set.end() ? named.parameters()[p].initial : expected->second) << p;
  }
}

TEST(EmittedClass, NamesItsStrikesAndOutputs) {
  instruments::trichord_c4<> named(kRate), numbered(kRate);
  named.strike_hammer(3);
  numbered.strike(0, 3);
  double largest_hammer_force = 0;
  for (int n = 0; n < 2000; ++n) {
    named.tick();
    numbered.tick();
    ASSERT_EQ(named.bridge_force_n(), numbered.output(0));
    ASSERT_EQ(named.soundboard_velocity_m_per_s(), numbered.output(1));
    ASSERT_EQ(named.hammer_force_n(), numbered.output(2));
    largest_hammer_force = std::max(largest_hammer_force, named.hammer_force_n());
    ASSERT_EQ(named.hammer_force_n(), named.contact_force());
  }
  EXPECT_GT(largest_hammer_force, 10);
}

}  // namespace
}  // namespace contactspline::testing
