// SPDX-License-Identifier: MIT
// A MIDI file on several instruments by channel, and the drum kit that ships.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "generator/cli/midi_mix.hpp"
#include "program.hpp"
#include "render_score.hpp"
#include "sandbox.hpp"
#include "sound.hpp"
#include "support/compare.hpp"
#include "support/midi_files.hpp"

namespace contactspline::testing {
namespace {

using std::numbers::pi;

// A string of the pitch of C4 that its key plays, and a drum. A second output must not change what is mixed.
const std::string kString = R"({
  "name": "probe",
  "bodies": [ { "name": "string", "resonator": "string_c4", "max_modes": 20 }, { "name": "hammer", "mass_kg": 0.003 } ],
  "places": [ { "name": "struck", "body": "string", "position_m": 0.07 } ],
  "contacts": [ { "name": "felt", "between": ["hammer", "struck"], "material": "felt_c4" } ],
  "strikes": ["hammer"],
  "keys": [ { "first": 48, "last": 72, "event": "strike_hammer", "tuned_key": 60 } ],
  "outputs": [ { "name": "string", "end_force_n": "string", "full_scale": 20 },
               { "name": "felt", "force_n": "felt", "full_scale": 3 } ]
})";
const std::string kDrum = R"({
  "name": "drum",
  "bodies": [
    { "name": "head", "membrane": { "radius_m": 0.15, "mass_per_area_kg_m2": 0.3, "tension_n_per_m": 2000,
                                    "constant_loss_per_s": 8, "quadratic_loss_m2_per_s": 0.01 }, "max_modes": 20 },
    { "name": "stick", "mass_kg": 0.02 } ],
  "places": [ { "name": "struck", "body": "head", "position_m": 0.05 } ],
  "contacts": [ { "name": "tip", "between": ["stick", "struck"], "material": "felt_c4" } ],
  "strikes": ["stick"],
  "keys": [ { "key": 38, "event": "strike_stick" } ],
  "outputs": [ { "name": "head", "velocity_m_per_s": "struck", "full_scale": 2 } ]
})";

// How strong a sound is at a frequency, by a window of Hann over the whole of it.
double level_at(std::span<const double> samples, double frequency_hz, double rate_hz) {
  std::complex<double> sum;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const double part = (static_cast<double>(n) + 0.5) / static_cast<double>(samples.size());
    sum += samples[n] * std::pow(std::sin(pi * part), 2) *
           std::polar(1.0, -2 * pi * frequency_hz * static_cast<double>(n) / rate_hz);
  }
  return std::abs(sum);
}

// The strongest frequency of a range.
double strongest(std::span<const double> samples, double from_hz, double to_hz, double rate_hz) {
  double best_hz = 0, best = 0;
  for (double hz = from_hz; hz < to_hz; hz += 1)
    if (const double level = level_at(samples, hz, rate_hz); level > best) best = level, best_hz = hz;
  return best_hz;
}

class RenderParts : public ::testing::Test {
 protected:
  // Channel 1: C4. Channel 2: G4, softer and later. Channel 10: a drum, and a hi-hat and a maraca that nobody has. A
  // tuning of all: 30 cents up.
  RenderParts() {
    using namespace midi;
    const std::string tuned = exclusive(bytes({0x7f, 0x7f, 4, 3, 0, 0x53}));
    const Events song = {{0, tuned},          {0, on(60)},       {0, on(38, 100, 9)},  {200, on(67, 50, 1)},
                         {300, off(60)},      {300, off(38, 9)}, {400, on(42, 80, 9)}, {420, on(42, 80, 9)},
                         {430, on(70, 9, 9)}, {800, off(67, 1)}};
    write_file(box_ / "song.mid", file(track(song)));
    write_file(box_ / "probe.json", kString);
    write_file(box_ / "drum.json", kDrum);
    fs::copy_file(box_ / "probe.json", box_ / "second.json");
  }

  [[nodiscard]] Outcome render(const std::string& parts, const Words& options = {},
                               const std::string& score = "song.mid") const {
    return run({.arguments = followed_by({"render", score, "--instrument", parts, "--no-figure", "--tail", "1", "-o",
                                          "a.wav", "--gain", "0", "--bits", "32"},
                                         options),
                .folder = box_.path()});
  }
  [[nodiscard]] Sound sound(const std::string& parts, const Words& options = {}) const {
    const Outcome outcome = render(parts, options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_sound(box_ / "a.wav");
  }

  Sandbox box_;
};

// That of the first note of a channel, counted from 1; channels that are named go first. The tenth has none.
TEST_F(RenderParts, AreChosenByPrograms) {
  using namespace midi;
  const Events song = {{0, on(60)},          {0, bytes({0xc1, 40})}, {1, on(67, 50, 1)}, {2, bytes({0xc1, 7})},
                       {3, on(38, 99, 9)},   {100, off(60)},         {100, off(67, 1)},  {100, off(38, 9)},
                       {101, on(64, 50, 1)}, {150, off(64, 1)}};
  write_file(box_ / "programs.mid", file(track(song)));
  const auto sound_of = [&](const std::string& parts) {
    const Outcome outcome = render(parts, {}, "programs.mid");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.err + read_file(box_ / "a.wav");
  };
  const std::string by_channel = sound_of("1=second.json,2=probe.json,10=drum.json");
  for (const char* parts : {"p1=second.json,p41=probe.json,10=drum.json", "p41=probe.json,second.json,10=drum.json",
                            "1=second.json,p1=cello,p41=probe.json,10=drum.json"}) {
    const std::string sound = sound_of(parts);
    const auto riff = sound.find("RIFF");
    EXPECT_TRUE(sound.substr(riff) == by_channel) << parts;
    EXPECT_EQ(sound.substr(0, riff), std::string(parts).find("cello") == std::string::npos
                                         ? ""
                                         : "contactspline: programs.mid: MIDI: no note is on program 1, which cello "
                                           "plays\n");
  }
}

// A reset of controllers brings expression back, one of the system volume and pan, too.
TEST(Mix, GoesBack) {
  using namespace midi;
  const auto gains = [](const std::vector<std::string>& messages) {
    std::vector<MidiFileMessage> at;
    for (const std::string& message : messages)
      at.push_back({static_cast<double>(at.size()), {message.begin(), message.end()}});
    return mix_of(at, std::array{1}, [](int) { return true; }).back();
  };
  const std::vector<std::string> moved = {controller(7, 50), controller(10, 0), controller(11, 64)};
  const auto after = [&](std::vector<std::string> last) {
    last.insert(last.begin(), moved.begin(), moved.end());
    return gains(last);
  };
  EXPECT_NEAR(after({}).left, std::numbers::sqrt2 * std::pow(0.5 * 64 / 127, 2), 1e-12);
  EXPECT_NEAR(after({controller(121, 0)}).left, std::numbers::sqrt2 * 0.25, 1e-12);
  EXPECT_EQ(after({controller(121, 0)}).right, 0);
  EXPECT_NEAR(after({controller(121, 0, 1)}).left, after({}).left, 1e-12);  // of another channel
  const MixGains reset = after({bytes({0xf0, 0x7e, 0x7f, 9, 1, 0xf7})});
  EXPECT_EQ(reset.left, 1);
  EXPECT_EQ(reset.right, 1);
}

// Each at the full scale of its first output. Samples are summed in single precision.
TEST_F(RenderParts, AddUpWhatEachPlaysAlone) {
  const Sound mix = sound("1=probe.json,2=second.json,10=drum.json");
  std::vector<double> sum(mix.samples.size());
  for (const auto& [part, full_scale] :
       std::map<std::string, double>{{"1=probe.json", 20}, {"2=second.json", 20}, {"10=drum.json", 2}}) {
    const Sound alone = sound(part);
    ASSERT_LE(alone.samples.size(), sum.size());
    EXPECT_GT(alone.peak() / full_scale, 0.01 * mix.peak()) << part;
    for (std::size_t n = 0; n < alone.samples.size(); ++n) sum[n] += alone.samples[n] / full_scale;
  }
  EXPECT_TRUE(sequences_within<double>(mix.samples, sum, 1e-6 * mix.peak()));
}

// By volume and expression, (80/100)^2 (100/127)^2, and pan: hard left, sqrt 2 times.
TEST_F(RenderParts, AreMixedByTheirControllers) {
  using namespace midi;
  const auto song_with = [&](const Events& mixed) {
    return file(track(followed_by(mixed, {{0, on(60)}, {0, on(60, 90, 1)}, {300, off(60)}, {300, off(60, 1)}})));
  };
  const auto played = [&](const Events& mixed) {
    write_file(box_ / "mixed.mid", song_with(mixed));
    const Outcome outcome = render("1=probe.json,2=second.json", {}, "mixed.mid");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read_sound(box_ / "a.wav");
  };
  const Sound plain = played({});
  ASSERT_EQ(plain.channels, 1);
  const Sound softer = played({{0, controller(7, 80)}, {0, controller(11, 100)}, {0, controller(7, 0, 1)}});
  const Sound aside = played({{0, controller(10, 0)}, {0, controller(7, 0, 1)}});
  const Sound alone = played({{0, controller(7, 0, 1)}});
  ASSERT_EQ(aside.channels, 2);
  ASSERT_EQ(aside.samples.size(), 2 * alone.samples.size());
  const double gain = std::pow(0.8 * 100 / 127, 2);
  // Of a song that has no notes for the second one, too.
  const std::string of_first = file(track({{0, controller(7, 80)}, {0, on(60)}, {300, off(60)}}));
  write_file(box_ / "first.mid", of_first);
  ASSERT_EQ(render("1=probe.json,2=second.json", {}, "first.mid").exit_code, 0);
  const Sound first = read_sound(box_ / "a.wav");
  const auto is_times_alone = [&](std::span<const double> sound, double factor) {
    std::vector<double> expected;
    for (const double sample : alone.samples) expected.push_back(factor * sample);
    return sequences_within<double>(sound, expected, 1e-6);
  };
  std::vector<double> left, right;
  for (std::size_t n = 0; n < aside.samples.size(); n += 2) {
    left.push_back(aside.samples[n]);
    right.push_back(aside.samples[n + 1]);
  }
  EXPECT_TRUE(is_times_alone(plain.samples, 2));
  EXPECT_TRUE(is_times_alone(softer.samples, gain));
  EXPECT_TRUE(is_times_alone(first.samples, 20 * 0.8 * 0.8));  // N
  EXPECT_TRUE(is_times_alone(left, std::numbers::sqrt2));
  EXPECT_EQ(std::ranges::count(right, 0), static_cast<std::ptrdiff_t>(right.size()));
}

// Of the tuning, which is of no channel, every part hears: 30 cents, 8192 for 100. The string's own pitch is that of
// its file.
TEST_F(RenderParts, PlayTheKeysOfTheirChannels) {
  for (const auto& [part, key] : {std::pair{"1=probe.json,10=drum.json", 60}, {"2=probe.json,10=drum.json", 67}}) {
    const Sound mix = sound(part, {"--stems", "stems", "--force"});
    const Sound stem = read_sound(box_ / "stems/probe.wav");
    const double rate = stem.rate, c4_hz = 261.6 * std::exp2(0.3 / 12),
                 expected = c4_hz * std::exp2((key - 60) / 12.0);
    EXPECT_NEAR(strongest(stem.samples, expected - 60, expected + 60, rate), expected, 4) << part;
    EXPECT_GT(level_at(stem.samples, expected, rate),
              10 * level_at(stem.samples, c4_hz * std::exp2((key == 60 ? 7 : 0) / 12.0), rate))
        << part;
    EXPECT_FALSE(mix.samples.empty());
  }
}

// One part plays all channels that its name stands before.
TEST_F(RenderParts, OfOneNameAreOneInstrument) {
  const Outcome both = render("1=probe.json,2=probe.json");
  EXPECT_EQ(both.exit_code, 0) << both.err;
  EXPECT_NE(both.out.find("1 N (probe: string end force)\n"), std::string::npos) << both.out;
  const std::string as_listed = read_file(box_ / "a.wav");
  for (const char* others : {"*=probe.json", "1=probe.json,*=probe.json", "2=probe.json,probe.json"}) {
    EXPECT_EQ(render(others).exit_code, 0);
    EXPECT_TRUE(read_file(box_ / "a.wav") == as_listed) << others;
  }
}

TEST_F(RenderParts, SayWhatIsNotPlayed) {
  const Outcome outcome = render("1=probe.json,3=second.json,10=drum.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(
      outcome.err,
      "contactspline: song.mid: MIDI: no note is on channel 3, which second.json plays\n"
      "contactspline: song.mid: MIDI: left out: notes of channels that --instrument does not name: 2 (1)\n"
      "contactspline: drum: song.mid: MIDI: left out, as drum has nothing to strike there: keys 42 closed hi-hat "
      "(2), 70 maracas (1)\n");
}

TEST_F(RenderParts, AreRefusedInOneLine) {
  const std::string such = "allowed: 1 to 16, p1 to p128 for programs, or * before =, such as 10=kit";
  for (const auto& [parts, wrong, allowed] :
       {std::array<std::string, 3>{"17=probe.json", "--instrument: '17=probe.json' names no channel", such},
        {"0=probe.json", "--instrument: '0=probe.json' names no channel", such},
        {"p129=probe.json", "--instrument: 'p129=probe.json' names no channel", such},
        {"1x=probe.json", "--instrument: '1x=probe.json' names no channel", such},
        {"=probe.json", "--instrument: '=probe.json' names no channel", such},
        {"1=unknown", "--instrument: unknown: is no instrument and no keyboard", "cello, classical_guitar, "},
        {"1=probe.json,10=none.json", "none.json: ", ""},
        {"1=probe.json,1=cello", "--instrument: '1' has two instruments", "allowed: one for each, such as"},
        {"1=probe.json,01=cello", "--instrument: '01' has two instruments", "allowed: one for each"},
        {"*=probe.json,cello", "--instrument: '*' has two instruments", "allowed: one for each"},
        {"1=", "--instrument: '1=' names no instrument", "allowed: such as 1=piano"},
        {"1=probe.json,", "--instrument: '' names no instrument", "allowed: such as 1=piano"},
        {"", "--instrument: '' is refused", "allowed: an instrument"},
        {"3=probe.json,4=drum.json", "--instrument: no channel that it names has a note in song.mid",
         "channels 1, 2, 10"}}) {
    SCOPED_TRACE(parts);
    const Outcome outcome = render(parts);
    expect_refused(outcome, wrong, allowed);
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_FALSE(fs::exists(box_ / "a.wav"));
  }
  expect_refused(render("1=probe.json", {"--channel", "1"}), "--channel: stands beside the channels of --instrument",
                 "one of the two");
  expect_refused(render("1=probe.json,10=drum.json", {"--signal", "felt"}), "--signal: is for one instrument",
                 "--instrument with one name");
  for (const char* parts : {"1=probe.json,10=drum.json", "1=cello"}) {
    const Outcome outcome = render(parts, {}, "tom_pattern");
    expect_refused(outcome, "tom_pattern: --instrument: the score is not a MIDI file", "no --instrument");
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }
}

// A file that exists is a name, whatever stands in its path.
TEST_F(RenderParts, MayHaveAnyPath) {
  fs::copy_file(box_ / "probe.json", box_ / "my=probe.json");
  fs::copy_file(box_ / "probe.json", box_ / "1,2=probe.json");
  for (const char* name : {"my=probe.json", "1,2=probe.json"}) {
    const Outcome outcome = render(name);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string as_named = read_file(box_ / "a.wav");
    EXPECT_EQ(render("probe.json").exit_code, 0);
    EXPECT_TRUE(as_named == read_file(box_ / "a.wav")) << name;
  }
}

// A tuning is of those that have a pitch, of which there must be one.
TEST_F(RenderParts, OfDrumsKeepTheirPitch) {
  const Words tuned = {"--a4", "460"};
  const Sound plain = sound("10=drum.json"),
              both = sound("1=probe.json,10=drum.json", followed_by({"--stems", "s"}, tuned));
  const Sound drum = read_sound(box_ / "s/drum.wav");
  ASSERT_LE(drum.samples.size(), plain.samples.size());
  for (std::size_t n = 0; n < drum.samples.size(); n += 100)
    ASSERT_NEAR(drum.samples[n], plain.samples[n] / 2, 1e-6 * plain.peak());
  EXPECT_FALSE(both.samples.empty());
  expect_refused(render("10=drum.json", tuned), "song.mid: tuning: the score has no keys",
                 "instruments with a tuned_key");
  expect_refused(render("drum.json", tuned), "song.mid: tuning: the score has no keys",
                 "instruments with a tuned_key");
}

// Of two equal films under the tensions T1 and T2, whose lowest modes are the zero 2.405 of the Bessel function J0,
// the mode in which both move alike lies between those of each alone. Only the snare moves its wires.
TEST(Kit, StrikesTheDrumOfEachKey) {
  const Sandbox box;
  for (const auto& [key, radius_m, batter_n, lower_n] : {std::tuple{35, 0.279, 600, 600},
                                                         {41, 0.203, 1500, 1900},
                                                         {43, 0.178, 1500, 1900},
                                                         {45, 0.165, 1500, 1900},
                                                         {47, 0.152, 1500, 1900},
                                                         {48, 0.127, 1500, 1900},
                                                         {50, 0.102, 1500, 1900},
                                                         {38, 0.165, 2200, 2500}}) {
    using namespace midi;
    write_file(box / "key.mid", file(track({{0, on(key, 64, 9)}, {10, off(key, 9)}})));
    const auto play = [&](const std::string& signal) {
      return run(
          {.arguments = {"render", "key.mid", "--instrument", "10=kit", "--no-figure", "-o", "a.wav", "--force",
                         "--rate", "22050", "--tail", "0.6", "--gain", "0", "--bits", "32", "--signal", signal},
           .folder = box.path()});
    };
    ASSERT_EQ(play("drums").exit_code, 0);
    const Sound sound = read_sound(box / "a.wav");
    const auto lowest = [&, r = radius_m](double tension) {
      return 2.4048 / (2 * pi * r) * std::sqrt(tension / 0.353);
    };
    const std::span ringing = std::span(sound.samples).subspan(1100);  // the stick has left
    const double found = strongest(ringing, 40, key == 38 ? 250 : 320, sound.rate);
    EXPECT_GT(found, lowest(batter_n) - 1.5) << key;
    EXPECT_LT(found, lowest(lower_n) + 1.5) << key;
    ASSERT_EQ(play("wires").exit_code, 0);
    EXPECT_EQ(read_sound(box / "a.wav").peak() > 1e-6, key == 38) << key;  // N; at rest they are pressed
  }
}

}  // namespace
}  // namespace contactspline::testing
