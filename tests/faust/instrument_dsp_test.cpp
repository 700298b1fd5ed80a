// SPDX-License-Identifier: MIT
// Instruments from files behind Faust's `dsp` interface, against the instruments without it; Faust's programs
// of them against both.
#define FAUSTFLOAT double
// clang-format off
#include <faust/dsp/dsp.h>
#include <faust/gui/DecoratorUI.h>
#include <faust/gui/MapUI.h>
#include <faust/gui/UI.h>
#include <faust/gui/meta.h>
// clang-format on

#include <limits>
#include <sstream>

#include "classical_guitar_double.hpp"
#include "contactspline/host/engine.hpp"
#include "contactspline/host/faust_dsp.hpp"
#include "contactspline/instruments/classical_guitar.hpp"
#include "contactspline/instruments/dulcimer.hpp"
#include "contactspline/instruments/marimba.hpp"
#include "contactspline/instruments/prepared_piano.hpp"
#include "contactspline/instruments/slap_bass.hpp"
#include "contactspline/instruments/snare.hpp"
#include "contactspline/instruments/tanpura.hpp"
#include "contactspline/instruments/trichord_c4.hpp"
#include "dulcimer_double.hpp"
#include "marimba_double.hpp"
#include "prepared_piano_double.hpp"
#include "support/by_sample.hpp"
#include "support/compare.hpp"
#include "support/real_time.hpp"
#include "trichord_c4_double.hpp"

namespace contactspline::testing {
namespace {

constexpr int kRate = 44100;

/// A class with Faust's interface.
template <typename Dsp>
class DspPlayer {
 public:
  DspPlayer() {
    instrument_.init(kRate);
    instrument_.buildUserInterface(&controls_);
  }
  void set(const std::string& label, double value) {
    ASSERT_NE(controls_.getParamZone(label), nullptr) << label;
    controls_.setParamValue(label, value);
  }
  /// [output][sample]
  std::vector<std::vector<double>> play(std::size_t samples) {
    std::vector sound(static_cast<std::size_t>(instrument_.getNumOutputs()), std::vector<double>(samples));
    std::vector<double*> outputs;
    for (auto& channel : sound) outputs.push_back(channel.data());
    expect_real_time([&] { instrument_.compute(static_cast<int>(samples), nullptr, outputs.data()); });
    return sound;
  }
  Dsp& instrument() { return instrument_; }

 private:
  Dsp instrument_;
  MapUI controls_;
};

/// InstrumentDsp of a class as the engine has compiled it.
template <typename Instrument>
class CompiledDsp : public HandleDsp<double> {
 public:
  CompiledDsp() : HandleDsp(&compiled<Instrument>) {}
};

template <typename Instrument>
using Player = DspPlayer<CompiledDsp<Instrument>>;

/// The outputs of an emitted class, without its keys, over their full scales; before_sample(instrument, n) moves its
/// controls.
template <typename Instrument, typename BeforeSample>
std::vector<std::vector<double>> bare(std::size_t samples, BeforeSample before_sample) {
  BySample<double> instrument(Instrument::data::view(), kRate);
  const auto& outputs = Instrument::data::outputs;
  std::vector sound(outputs.size(), std::vector<double>());
  for (std::size_t n = 0; n < samples; ++n) {
    before_sample(instrument, n);
    instrument.tick();
    for (std::size_t o = 0; o < outputs.size(); ++o) sound[o].push_back(instrument.output(o) / outputs[o].full_scale);
  }
  return sound;
}

double peak(const std::vector<double>& sound) {
  double peak = 0;
  for (const double x : sound) peak = std::max(peak, std::abs(x));
  return peak;
}

// A pluck of 4 ms that eases in and out, as in a score.
double pluck_n(std::size_t sample, double release_n) {
  constexpr std::size_t kLength = 176;
  const double part = static_cast<double>(sample) / kLength;
  return sample < kLength ? release_n * (part * part * (3 - 2 * part)) : 0;
}

template <typename Instrument>
void expect_same_strikes() {
  for (std::size_t s = 0; s < Instrument::data::strikes.size(); ++s) {
    SCOPED_TRACE(Instrument::data::events[s].name);
    Player<Instrument> player;
    player.set(Instrument::data::events[s].name, 1);
    const auto sound = player.play(4410);
    const auto expected = bare<Instrument>(4410, [&](BySample<double>& instrument, std::size_t n) {
      if (n == 0) instrument.strike(s, 2.5);
    });
    EXPECT_GT(peak(sound[0]), 0.01);
    EXPECT_EQ(sound, expected);
  }
}

TEST(InstrumentDsp, IsTheClassToTheLastBit) {
  expect_same_strikes<instruments::trichord_c4<double>>();
  expect_same_strikes<instruments::slap_bass<double>>();
  expect_same_strikes<instruments::prepared_piano<double>>();
  expect_same_strikes<instruments::snare<double>>();
}

TEST(InstrumentDsp, PlucksAsAScore) {
  using Tanpura = instruments::tanpura<double>;
  Player<Tanpura> player;
  player.set("pluck_finger", 1);
  const auto sound = player.play(4410);
  EXPECT_GT(peak(sound[0]), 0.01);
  EXPECT_EQ(sound, bare<Tanpura>(4410, [](BySample<double>& instrument, std::size_t n) {
              instrument.set(0, pluck_n(n, 0.45));  // finger_force_n
            }));

  using SlapBass = instruments::slap_bass<double>;
  Player<SlapBass> popped;
  popped.set("pop_release_n", -5);
  popped.set("pluck_pop", 1);
  EXPECT_EQ(popped.play(4410), bare<SlapBass>(4410, [](BySample<double>& instrument, std::size_t n) {
              instrument.set(4, pluck_n(n, -5));  // pop_force_n
            }));
}

// Between two blocks: a stiffness and a gap at once, a damping with the time constant of 5 ms.
TEST(InstrumentDsp, FollowsItsControls) {
  using Piano = instruments::prepared_piano<double>;
  Player<Piano> player;
  player.set("hammer_speed_m_per_s", 3.5);
  player.set("strike_hammer", 1);
  const auto first = player.play(2000);
  player.set("screw_stiffness_n_per_m", 2e5);
  player.set("play_gap_shift_m", -1e-4);
  player.set("damper_damping_per_s", 60);
  player.set("strike_hammer", 0);
  auto sound = player.play(2000);
  const double rate = -std::expm1(-1 / (0.005 * kRate));
  double damping = 0;
  const auto control = [](std::string_view name) {
    const auto& all = Piano::data::parameters;
    return static_cast<std::size_t>(std::ranges::find(all, name, &Parameter::name) - all.begin());
  };
  const auto expected = bare<Piano>(4000, [&](BySample<double>& instrument, std::size_t n) {
    if (n == 0) instrument.strike(0, 3.5);
    if (n < 2000) return;
    if (n == 2000) instrument.set(control("screw_stiffness_n_per_m"), 2e5);
    if (n == 2000) instrument.set(control("play_gap_shift_m"), -1e-4);
    damping += rate * (60 - damping);
    instrument.set(control("damper_damping_per_s"), damping);
  });
  for (std::size_t o = 0; o < sound.size(); ++o) {
    sound[o].insert(sound[o].begin(), first[o].begin(), first[o].end());
    EXPECT_EQ(sound[o], expected[o]) << o;
  }
}

// A control that is no number: as if it had stayed. One out of range acts as the end of its slider.
TEST(InstrumentDsp, HoldsItsControlsInTheirRanges) {
  using Bass = instruments::slap_bass<double>;
  const auto played = [](const std::string& label, double value) {
    Player<Bass> player;
    (void)player.play(50);
    player.set(label, value);
    player.set("strike_thumb", 1);
    player.set("pluck_pop", 1);
    return player.play(1500)[0];
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto left_alone = played("thumb_speed_m_per_s", 2.5);
  for (const char* label :
       {"thumb_speed_m_per_s", "pop_release_n", "press_2_force_n", "action_gap_shift_m", "palm_damping_per_s"}) {
    EXPECT_EQ(played(label, nan), left_alone) << label;
    EXPECT_EQ(played(label, infinity), played(label, 1e30)) << label;
    EXPECT_NE(played(label, infinity), left_alone) << label;
  }
  EXPECT_EQ(played("pop_release_n", 1e30), played("pop_release_n", 20));
  EXPECT_EQ(played("palm_damping_per_s", 1e30), played("palm_damping_per_s", 1000));
  EXPECT_EQ(played("thumb_speed_m_per_s", -1e30), played("thumb_speed_m_per_s", 0));

  // A strike that is no number is no strike, and the next one is.
  Player<Bass> player;
  player.set("strike_thumb", nan);
  EXPECT_EQ(peak(player.play(500)[0]), 0);
  player.set("strike_thumb", 1);
  EXPECT_GT(peak(player.play(500)[0]), 0.01);
}

TEST(InstrumentDsp, IsSilentUntilItsStrikeAndAfterItIsCleared) {
  Player<instruments::trichord_c4<double>> player;
  EXPECT_EQ(peak(player.play(1000)[0]), 0);
  player.set("strike_hammer", 1);
  const auto first = player.play(2000);
  expect_real_time([&] { player.instrument().instanceClear(); });
  player.set("strike_hammer", 0);
  EXPECT_EQ(peak(player.play(1000)[0]), 0);
  player.set("strike_hammer", 1);
  EXPECT_EQ(player.play(2000), first);
}

/// What a host is told, line by line.
class Transcript : public GenericUI {
 public:
  void openVerticalBox(const char* label) override { text_ << label << '\n'; }
  void addButton(const char* label, FAUSTFLOAT* zone) override { line(zone) << label << '\n'; }
  void addHorizontalSlider(const char* label, FAUSTFLOAT* zone, FAUSTFLOAT initial, FAUSTFLOAT min, FAUSTFLOAT max,
                           FAUSTFLOAT) override {
    line(zone) << label << ' ' << initial << ' ' << min << ' ' << max << '\n';
  }
  void declare(FAUSTFLOAT*, const char* key, const char* value) override { said_ += std::string(key) + value + ' '; }
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream& line(const FAUSTFLOAT*) {
    text_ << std::exchange(said_, "");
    return text_;
  }
  std::ostringstream text_;
  std::string said_;
};

TEST(InstrumentDsp, TellsHostsWhatTheFileSays) {
  Player<instruments::trichord_c4<double>> player;
  Transcript transcript;
  const std::unique_ptr<dsp> copy(player.instrument().clone());
  copy->buildUserInterface(&transcript);
  EXPECT_EQ(transcript.text(),
            "trichord_c4\n"
            "0 midikey 60 strike_hammer\n"
            "1 unitm/s hammer_speed_m_per_s 2.5 0 10\n"
            "2 scalelog felt_stiffness_ratio 1 0.01 100\n"
            "3 units/m felt_loss_s_per_m 0.1 0 2\n"
            "4 unit1/s damper_damping_per_s 0 0 1000\n"
            "5 sustain 0 0 1\n"
            "6 unitcents bend_cents 0 -200 200\n");
  EXPECT_EQ(copy->getNumInputs(), 0);
  EXPECT_EQ(copy->getNumOutputs(), 3);
  EXPECT_EQ(player.instrument().getSampleRate(), kRate);
}

/// A slider that is moved at a sample.
struct Move {
  std::size_t sample;
  const char* label;
  double value;
};

/// All outputs, one after the other, of a class that is played in blocks of 100 samples; from sample `delay` on.
template <typename Dsp>
std::vector<std::vector<double>> played(std::size_t samples, const std::vector<Move>& moves, std::size_t delay = 0) {
  DspPlayer<Dsp> player;
  std::vector<std::vector<double>> sound;
  for (std::size_t n = 0; n < samples; n += 100) {
    for (const Move& move : moves)
      if (move.sample == n) player.set(move.label, move.value);
    const auto block = player.play(100);
    sound.resize(block.size());
    for (std::size_t o = 0; o < block.size(); ++o) sound[o].insert(sound[o].end(), block[o].begin(), block[o].end());
  }
  for (auto& channel : sound) {
    channel.erase(channel.begin(), channel.begin() + static_cast<std::ptrdiff_t>(delay));
    channel.resize(samples - 1);
  }
  return sound;
}

// Contact steps and Newton's method by a fixed number of steps, springs and links by elimination, modes in half
// steps: the class by another path, a sample later. Each output that is not silent is louder than `least`.
template <typename Instrument, typename Program>
void expect_same_sound(std::size_t samples, const std::vector<Move>& moves, double least = 1e-3,
                       double bound = 1e-9) {
  const auto expected = played<CompiledDsp<Instrument>>(samples, moves);
  const auto found = played<Program>(samples, moves, 1);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t o = 0; o < found.size(); ++o) {
    if (o != 0 && peak(expected[o]) == 0) {
      EXPECT_EQ(peak(found[o]), 0) << o;
      continue;
    }
    EXPECT_GT(peak(expected[o]), least) << o;
    EXPECT_TRUE(sequences_within(std::span<const double>(found[o]), std::span<const double>(expected[o]), bound))
        << o;
  }
}

TEST(FaustInstrument, OfTheTrichordIsTheClass) {
  expect_same_sound<instruments::trichord_c4<double>, trichord_c4_double>(22000,
                                                                          {{0, "strike_hammer", 1},
                                                                           {8000, "felt_stiffness_ratio", 2},
                                                                           {9000, "damper_damping_per_s", 60},
                                                                           {9500, "felt_loss_s_per_m", 0.3},
                                                                           {12000, "damper_damping_per_s", 0},
                                                                           {12000, "strike_hammer", 0},
                                                                           {13000, "hammer_speed_m_per_s", 4.5},
                                                                           {13000, "strike_hammer", 1}});
}

// Where the bolt is weightless and does not rattle. Its output counts from where it hangs on the string by 0.049 N,
// and is minus that, of 100 N: 4.9e-4.
TEST(FaustInstrument, OfThePreparedPianoIsTheClass) {
  expect_same_sound<instruments::prepared_piano<double>, prepared_piano_double>(
      22000,
      {{0, "weight_force_n", 0},
       {0, "play_gap_shift_m", 5e-4},
       {0, "hammer_speed_m_per_s", 0.5},
       {3000, "strike_hammer", 1},
       {8000, "screw_stiffness_n_per_m", 2e5},
       {9000, "damper_damping_per_s", 20}},
      4.8e-4);
}

// Where it is pressed from above and below: two stiff contacts of the same two places, for which the program needs
// all its steps. They leave 2.4e-9 of the peak in the sample in which the bolt, which hung on the string, meets both.
TEST(FaustInstrument, OfThePreparedPianoHoldsItsBoltAsTheClass) {
  expect_same_sound<instruments::prepared_piano<double>, prepared_piano_double>(
      10000, {{0, "play_gap_shift_m", -3e-4}, {2000, "strike_hammer", 1}}, 1e-3, 5e-9);
}

// Where it rattles, each bounce amplifies rounding: the program may differ from the class by what the class itself
// differs from those whose hammer is faster or whose bolt is heavier by some roundings. The bolt hangs on the string,
// with a weight that compresses the steel by 1e-8 m only: what is rounded there acts as another weight.
TEST(FaustInstrument, OfThePreparedPianoRattlesAsTheClass) {
  using Class = CompiledDsp<instruments::prepared_piano<double>>;
  constexpr std::size_t kSamples = 2200;
  constexpr double kSome = 1 + 64 * std::numeric_limits<double>::epsilon();
  const auto moves = [](double speed, double weight_n) {
    return std::vector<Move>{
        {0, "hammer_speed_m_per_s", speed}, {0, "weight_force_n", weight_n}, {0, "strike_hammer", 1}};
  };
  const auto expected = played<Class>(kSamples, moves(2.5, 0.049));
  const auto faster = played<Class>(kSamples, moves(2.5 * kSome, 0.049));
  const auto heavier = played<Class>(kSamples, moves(2.5, 0.049 * kSome));
  const auto found = played<prepared_piano_double>(kSamples, moves(2.5, 0.049), 1);
  for (std::size_t o = 0; o < 2; ++o) {
    double error = 0, allowed = 0, largest = peak(expected[o]);
    for (std::size_t n = 0; n < expected[o].size(); ++n) {
      error = std::max(error, std::abs(found[o][n] - expected[o][n]) / largest);
      for (const auto* other : {&faster, &heavier})
        allowed = std::max(allowed, std::abs((*other)[o][n] - expected[o][n]) / largest);
      ASSERT_LE(error, 30 * allowed + 1e-13) << o << ' ' << n;
      EXPECT_TRUE(n > 800 || error <= 1e-9) << n;
    }
    EXPECT_GT(allowed, 1e-9);  // it does rattle
  }
}

// Without a contact, with one, and with springs that follow their controls.
TEST(FaustInstrument, OfBodiesOnSpringsIsTheClass) {
  expect_same_sound<instruments::classical_guitar<double>, classical_guitar_double>(
      10000, {{0, "cavity_stiffness_n_per_m", 50000}, {100, "pluck_finger_d3", 1}, {5000, "hand_damping_per_s", 20}});
  expect_same_sound<instruments::marimba<double>, marimba_double>(
      10000, {{100, "strike_mallet_ds4", 1}, {5000, "tubes_damping_per_s", 100}});
  // One blow: the class plays a second one on another voice, whose strings rest.
  expect_same_sound<instruments::dulcimer<double>, dulcimer_double>(
      10000, {{100, "strike_cs5_hammer", 1}, {5000, "hand_damping_per_s", 20}});
}

template <typename Dsp>
std::string told() {
  DspPlayer<Dsp> player;
  Transcript transcript;
  player.instrument().buildUserInterface(&transcript);
  return transcript.text();
}

// But for the pedal and the bend of keys, which are its last lines.
TEST(FaustInstrument, TellsHostsWhatTheClassTellsThem) {
  const auto without_keys = [](const std::string& text) {
    const std::size_t sustain = text.find("sustain 0 0 1\n");
    return text.substr(0, text.rfind('\n', sustain) + 1);
  };
  EXPECT_EQ(told<trichord_c4_double>(), without_keys(told<CompiledDsp<instruments::trichord_c4<double>>>()));
  EXPECT_EQ(told<prepared_piano_double>(), without_keys(told<CompiledDsp<instruments::prepared_piano<double>>>()));
}

}  // namespace
}  // namespace contactspline::testing
