// SPDX-License-Identifier: MIT
// Bytes of MIDI, from the stream to what happens to an instrument, and the page that says so.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "contactspline/data/model_parameters.hpp"
#include "contactspline/host/hosted.hpp"
#include "contactspline/host/replaceable.hpp"
#include "support/compare.hpp"
#include "support/hostile_midi.hpp"
#include "support/midi_files.hpp"

namespace contactspline::testing {
namespace {

using namespace midi;

std::span<const std::uint8_t> span_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST(MidiMessage, IsReadFromWholeMessagesOnly) {
  for (int status = 0; status < 256; ++status)
    for (const int first : {0, 60, 127, 128, 200, 255})
      for (const int second : {0, 127, 128, 255}) {
        const std::array bytes = {static_cast<std::uint8_t>(status), static_cast<std::uint8_t>(first),
                                  static_cast<std::uint8_t>(second)};
        const auto message = midi_message(bytes);
        // A status has the highest bit, data have not; from 0xf0 on a message is the system's.
        ASSERT_EQ(message.has_value(), status >= 128 && status < 240 && first < 128 && second < 128) << status;
        if (!message) continue;
        EXPECT_EQ(message->status, status - status % 16);
        EXPECT_EQ(message->channel, status % 16);
        EXPECT_EQ(message->first, first);
        EXPECT_EQ(message->second, second);
      }
  const std::array<std::uint8_t, 4> long_one = {0x90, 60, 100, 0};
  EXPECT_FALSE(midi_message(long_one));
  EXPECT_FALSE(midi_message(std::span(long_one).first(2)));
  EXPECT_FALSE(midi_message({}));
}

// What a stream says, one word for each message.
std::string words_of(const std::string& stream) {
  MidiParser parser;
  std::string words;
  for (const char byte : stream)
    parser.take(
        static_cast<std::uint8_t>(byte),
        [&](const MidiMessage& m) {
          words += fmt::format("{:x}{:x}:{},{} ", m.status / 16, m.channel, m.first, m.second);
        },
        [&](std::span<const std::uint8_t> exclusive) { words += fmt::format("x{} ", exclusive.size()); },
        [&] { words += "reset "; });
  return words;
}

TEST(MidiStream, KeepsWhatIsWhole) {
  const std::map<std::string, std::string> streams = {
      {bytes({0x90, 60, 64, 62, 65}), "90:60,64 90:62,65 "},                 // running status
      {bytes({0x90, 60, 0xf8, 64, 0xfe, 62, 65}), "90:60,64 90:62,65 "},     // a clock within messages
      {bytes({60, 64, 0x91, 60, 0xb2, 7, 100}), "b2:7,100 "},                // no status, and one cut off
      {bytes({0xc3, 5, 6, 0xd4, 7}), "c3:5,0 c3:6,0 d4:7,0 "},               // of one data byte
      {bytes({0x90, 60, 64, 0xf0, 1, 2, 3, 0xf7, 62, 65}), "90:60,64 x3 "},  // ends running status
      {bytes({0xf0, 1, 2, 0x90, 60, 64}), "90:60,64 "},                      // exclusive, cut off
      {bytes({0xf3, 5, 60, 64, 0xff, 0x80, 60, 0}), "reset 80:60,0 "}};
  for (const auto& [stream, words] : streams) EXPECT_EQ(words_of(stream), words);
  EXPECT_EQ(words_of("\xf0" + std::string(513, 'x') + "\xf7\xf0" + std::string(512, 'x') + "\xf7"), "x512 ");
}

/// Writes down what happens to it.
class Witness final : public AnyInstrument<float> {
 public:
  explicit Witness(bool bends, double hardness = 1, double step = 0)
      : bends_(bends), step_(step), values_{0, 0, 0, 0, hardness, 0.5} {}

  [[nodiscard]] const char* name() const override { return "witness"; }
  [[nodiscard]] const char* description() const override { return ""; }
  [[nodiscard]] const char* license() const override { return ""; }
  [[nodiscard]] std::span<const Parameter> parameters() const override { return kList; }
  [[nodiscard]] std::span<const Event> events() const override { return {}; }
  [[nodiscard]] std::span<const Output> outputs() const override { return KeyboardParameter::kOutputs; }
  [[nodiscard]] std::span<const Preset> presets() const override { return {}; }
  [[nodiscard]] std::optional<std::size_t> event_of(int) const override { return {}; }
  [[nodiscard]] bool has_key(int key) const override { return key >= 21 && key <= 108; }
  [[nodiscard]] bool bends_keys() const override { return bends_; }
  [[nodiscard]] bool moves_keys(std::size_t parameter) const override { return bends_ && parameter >= 4; }
  void prepare(double) override {}
  void play(const TimedEvent& event) override {
    if (event.action == Action::kSet)
      values_.at(event.number) = step_ > 0 ? step_ * std::round(event.value / step_) : event.value;
    const std::string parameter =
        event.action == Action::kMoveKey ? fmt::format("/{}", kList.at(event.parameter).name) : "";
    happened += fmt::format("{}:{}{}={:.6g} ", kNames.at(static_cast<std::size_t>(event.action)), event.number,
                            parameter, event.value);
  }
  void process(Outputs<float>, std::span<float>, std::span<const float> = {}) override {}
  void reset() override { happened += "rest "; }
  [[nodiscard]] double value(std::size_t parameter) const override { return values_.at(parameter); }
  [[nodiscard]] bool is_silent(double) const override { return true; }
  [[nodiscard]] bool is_at_rest(double) const override { return true; }
  [[nodiscard]] bool sleeps() const override { return true; }
  [[nodiscard]] Books books() const override { return {}; }

  std::string happened;

 private:
  static constexpr std::array kNames = {"strike", "release", "pluck", "on",   "off",   "set", "bend",
                                        "damp",   "place",   "bow",   "move", "level", "pan"};
  static constexpr std::array<Parameter, 6> kList = {
      {{"sustain", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtOnce, 0, 64},
       {"sostenuto", "", {0, 1}, {0, 1}, 0, Scale::kLinear, Acts::kAtOnce, 0, 66},
       {"bend_cents", "cents", {-1200, 1200}, {-200, 200}, 0, Scale::kLinear, Acts::kAtOnce, 0.02},
       {"modulation", "", {0, 1}, {0, 2}, 0, Scale::kLinear, Acts::kAtOnce, 0, 1},
       {"hardness", "", {0, 10}, {1, 3}, 1, Scale::kLinear, Acts::kAtOnce, 0, 74},
       {"force", "", {0, 10}, {0, 4}, 0.5, Scale::kLinear, Acts::kAtOnce, 0, kPressureController}}};
  bool bends_;
  double step_;  // to which it rounds values; 0: to none
  std::array<double, 6> values_;
};

// What a stream does to an instrument that bends its keys alone, or as a whole.
std::string what_happens(const std::string& stream, bool bends = true) {
  auto witness = std::make_unique<Witness>(bends);
  Witness& seen = *witness;
  Hosted<float> hosted(std::move(witness));
  hosted.prepare(48000);
  seen.happened.clear();
  hosted.midi(span_of(stream));
  return seen.happened;
}

std::string choose(int parameter) {
  return controller(101, 0) + controller(100, parameter);
}

struct Live {
  std::string test, stream, happens;
  bool bends = true;
};
void PrintTo(const Live& live, std::ostream* stream) {
  *stream << live.test;
}
class LiveMidi : public ::testing::TestWithParam<Live> {};

TEST_P(LiveMidi, DoesWhatThePageSays) {
  EXPECT_EQ(what_happens(GetParam().stream, GetParam().bends), GetParam().happens);
}

std::string pressure(int value, int channel = 0) {
  return bytes({0xd0 | channel, value});
}
std::string key_pressure(int key, int value) {
  return bytes({0xa0, key, value});
}
// Channel 1 has five members.
const std::string kZone = choose(6) + controller(6, 5);

const std::string kStruck = "bend:60=0 on:60=0.708661 ", kLetGo = "off:60=0.503937 ";

const Live kLive[] = {
    {"Note", on(60) + off(60), kStruck + kLetGo},
    {"NoteOffByVelocity0", on(60) + on(60, 0), kStruck + kLetGo},
    {"HandoverWithTheOnFirst", on(60) + on(60) + off(60) + off(60) + off(60), kStruck + kStruck + kLetGo},
    {"OneKeyOfTwoChannels", on(60) + on(60, 90, 1) + off(60) + off(60, 1), kStruck + kStruck + kLetGo},
    {"ReleaseVelocity", on(60) + off(60, 0, 127) + on(60) + off(60, 0, 0), kStruck + "off:60=1 " + kStruck + kLetGo},
    {"VelocityOf14Bits", controller(88, 64) + on(60, 40) + on(60, 127),
     "bend:60=0 on:60=0.318898 bend:60=0 on:60=1 "},
    {"Pedal", controller(64, 32) + controller(64, 64) + controller(64, 127), "set:0=0.5 set:0=1 set:0=1 "},
    {"FarthestPedal", controller(64, 127) + controller(64, 0, 1) + controller(64, 0), "set:0=1 set:0=1 set:0=0 "},
    {"Sostenuto", controller(66, 63) + controller(66, 64), "set:1=0 set:1=1 "},
    {"Brightness", controller(74, 127), "set:4=3 "},
    {"WheelOfItsChannel", on(60) + on(64, 90, 1) + wheel(0) + wheel(0),
     kStruck + "bend:64=0 on:64=0.708661 bend:60=-200 "},
    {"WheelOfAll", wheel(0, 3) + on(60), "set:2=-200 set:2=0 on:60=0.708661 ", false},
    {"UnregisteredEndsTheChoice",
     choose(0) + controller(99, 1) + controller(98, 32) + controller(6, 64) + wheel(0) + on(60),
     "bend:60=-200 on:60=0.708661 "},
    {"BendRangeInCents", choose(0) + controller(6, 0) + controller(38, 50) + wheel(0) + on(60),
     "bend:60=-50 on:60=0.708661 "},
    {"Decrement", choose(0) + controller(97, 99) + wheel(0) + on(60), "bend:60=-199 on:60=0.708661 "},
    {"FineTuning", choose(1) + controller(6, 96) + on(60), "bend:60=50 on:60=0.708661 "},
    {"CoarseTuning", choose(2) + controller(6, 66) + on(60), "bend:60=200 on:60=0.708661 "},
    {"MasterTuning", on(60) + bytes({0xf0, 0x7f, 0x7f, 4, 3, 0, 0x60, 0xf7}), kStruck + "bend:60=50 "},
    {"TunedKey", bytes({0xf0, 0x7f, 0x7f, 8, 2, 0, 1, 60, 60, 0x40, 0, 0xf7}) + on(60), "bend:60=50 on:60=0.708661 "},
    {"UnchangedKey", bytes({0xf0, 0x7f, 0x7f, 8, 2, 0, 1, 60, 127, 127, 127, 0xf7}) + on(60), kStruck},
    {"BulkTuning",
     bytes({0xf0, 0x7e, 0, 8, 1, 0}) + std::string(16, 'n') +
         [] {
           std::string keys;
           for (int key = 0; key < 128; ++key) keys += bytes({key, 0x20, 0});
           return keys;
         }() +
         bytes({0, 0xf7}) + on(60),
     "bend:60=25 on:60=0.708661 "},
    {"Mpe", choose(6) + controller(6, 5) + wheel(0, 1) + wheel(0, 2) + on(108, 90, 1) + on(67, 90, 2) + off(108, 1),
     "bend:60=0 on:60=0.708661 bend:21=-200 on:21=0.708661 off:60=0.503937 "},
    {"MpeBeside", choose(6) + controller(6, 5) + wheel(0) + wheel(8192 - 128, 1) + on(60, 90, 1),
     "bend:60=-275 on:60=0.708661 "},
    {"PressureOfAChannel", on(60) + pressure(127), kStruck + "set:5=4 "},
    {"PressureOfAKey", on(60) + on(64) + key_pressure(64, 127) + key_pressure(70, 127),
     kStruck + "bend:64=0 on:64=0.708661 move:64/force=3.5 "},
    {"PressureOfAKeyMovesAll", on(60) + key_pressure(60, 127), "on:60=0.708661 set:5=4 ", false},
    {"NextNoteHasNoPressure", on(60) + key_pressure(60, 127) + on(60),
     kStruck + "move:60/force=3.5 bend:60=0 move:60/hardness=0 move:60/force=0 level:60=1 pan:60=0 on:60=0.708661 "},
    {"MpePressure", kZone + on(60, 90, 1) + on(64, 90, 2) + pressure(127, 1) + pressure(0, 2) + pressure(127),
     kStruck + "bend:64=0 on:64=0.708661 move:60/force=3.5 move:64/force=-0.5 set:5=4 "},
    {"MpeBrightnessBeforeItsNote",
     kZone + controller(74, 127, 1) + on(60, 90, 1) + on(64, 90, 2) + controller(74, 0, 1),
     "bend:60=0 move:60/hardness=2 move:60/force=0 level:60=1 pan:60=0 on:60=0.708661 bend:64=0 on:64=0.708661 "
     "move:60/hardness=0 "},
    {"MpeReset", kZone + on(60, 90, 1) + pressure(127, 1) + controller(121, 0, 1),
     kStruck + "move:60/force=3.5 set:0=0 set:1=0 set:3=0 move:60/force=0 "},
    {"AllNotesOff", on(60) + controller(123, 0, 1) + controller(123, 0), kStruck + kLetGo},
    {"ModeLetsGo", on(60) + controller(126, 1), kStruck + kLetGo},
    {"AllSoundOff", on(60) + controller(120, 0), kStruck + kLetGo + "rest "},
    {"ResetOfControllers", controller(64, 127) + wheel(0) + on(60) + controller(121, 0),
     "set:0=1 bend:60=-200 on:60=0.708661 set:0=0 set:1=0 set:3=0 set:5=0.5 bend:60=0 "},
    {"SystemReset", choose(0) + controller(6, 12) + bytes({0xff}) + wheel(0) + on(60),
     "set:0=0 set:1=0 set:3=0 set:5=0.5 " +
         [] {
           std::string more;
           for (int channel = 1; channel < 16; ++channel) more += "set:0=0 set:1=0 set:3=0 set:5=0.5 ";
           return more;
         }() +
         "rest set:0=0 set:1=0 set:3=0 set:5=0.5 bend:60=-200 on:60=0.708661 "},
    {"Damaged", bytes({0x90, 60, 0xf5, 64, 62}) + bytes({0x85, 60}) + bytes({0xc0, 5}), ""},
};
INSTANTIATE_TEST_SUITE_P(All, LiveMidi, ::testing::ValuesIn(kLive), [](const auto& live) { return live.param.test; });

// A host names notes by an identity, a channel and a key, or by some of them.
TEST(NamedNotes, AreBegunExpressedAndEndedAlone) {
  auto witness = std::make_unique<Witness>(true);
  Witness& seen = *witness;
  Hosted<float> hosted(std::move(witness));
  hosted.prepare(48000);
  const auto happens = [&](const auto& act) {
    seen.happened.clear();
    act();
    return seen.happened;
  };
  using E = NoteExpression;
  EXPECT_EQ(happens([&] { hosted.begin_note({7, 0, 60}, 0.3, 10); }), "bend:60=10 on:60=0.3 ");
  EXPECT_EQ(happens([&] { hosted.begin_note({8, 1, 64}, 1); }), "bend:64=0 on:64=1 ");
  EXPECT_EQ(happens([&] { hosted.express({.id = 7}, E::kTuning, 0.125); }), "bend:60=10.125 ");
  EXPECT_EQ(happens([&] { hosted.midi(span_of(wheel(0))); }), "bend:60=-189.875 ");
  EXPECT_EQ(happens([&] { hosted.express({.channel = 1}, E::kPressure, 1); }), "move:64/force=3.5 ");
  EXPECT_EQ(happens([&] { hosted.express({.key = 60}, E::kBrightness, 0.5); }), "move:60/hardness=1 ");
  EXPECT_EQ(happens([&] { hosted.express({}, E::kVolume, 2); }), "level:60=2 level:64=2 ");
  EXPECT_EQ(happens([&] { hosted.express({.id = 7}, E::kExpression, 0.25); }), "level:60=0.5 ");
  EXPECT_EQ(happens([&] { hosted.express({8, 1, 64}, E::kPan, -2); }), "pan:64=-1 ");
  EXPECT_EQ(happens([&] { hosted.move_note({.id = 8}, 4, 0.25); }), "move:64/hardness=0.25 ");
  EXPECT_EQ(happens([&] { hosted.express({.id = 9}, E::kTuning, 100); }), "");
  EXPECT_EQ(happens([&] { hosted.express({.id = 7}, E::kTuning, std::nan("")); }), "");
  EXPECT_EQ(happens([&] { hosted.begin_note({9, 16, 60}, 1), hosted.begin_note({9, 0, 128}, 1); }), "");
  EXPECT_EQ(happens([&] { hosted.end_note({.id = 7}, 1); }), "off:60=1 ");
  EXPECT_EQ(happens([&] { hosted.express({.id = 7}, E::kTuning, 0); }), "bend:60=-190 ") << "it still rings";
  EXPECT_EQ(happens([&] { hosted.end_note({}, 0.5), hosted.end_note({}, 0.5); }), "off:64=0.5 ");

  // Two notes of one key and channel, on keys of their own where they are tuned so far; the wheel is 2 semitones
  // down.
  hosted.begin_note({1, 0, 60}, 1);
  hosted.begin_note({2, 0, 60}, 1, 2400);
  EXPECT_EQ(happens([&] { hosted.express({.id = 2}, E::kPressure, 1); }), "move:82/force=3.5 ");
  EXPECT_EQ(happens([&] { hosted.express({.id = 1}, E::kPan, 1); }), "pan:60=1 ");
  EXPECT_EQ(happens([&] { hosted.end_note({-1, 0, 60}, 1, true); }), "off:60=1 ");
  EXPECT_EQ(happens([&] { hosted.end_note({-1, 0, 60}, 1, true); }), "off:82=1 ");
}

// What nobody has set is the next instrument's own, also after a rest.
TEST(Hosted, ResetsOnlyWhatWasSet) {
  auto replaceable = std::make_unique<Replaceable<float>>(std::make_unique<Witness>(true));
  auto& next = *replaceable;
  Hosted<float> hosted(std::move(replaceable));
  hosted.prepare(48000);
  hosted.set(0, 0.5);
  next.offer(std::make_unique<Witness>(true, 2));
  hosted.reset();
  EXPECT_EQ(hosted.target(0), 0.5);
  EXPECT_EQ(hosted.instrument().value(0), 0.5);
  EXPECT_EQ(hosted.target(4), 2);
  EXPECT_EQ(hosted.instrument().value(4), 2);
}

// A glide of 20 ms takes that long in an instrument that rounds to whole cents: after 40 ms exp(-2) of the way is
// left, which is rounded, and at its end nothing.
TEST(Hosted, GlidesThroughAnInstrumentThatRounds) {
  Hosted<float> hosted(std::make_unique<Witness>(true, 1, 1));
  hosted.prepare(48000);
  std::array<float, 1920> left;
  std::array<float*, 2> outputs = {left.data(), nullptr};
  hosted.process<float>(outputs, 1);
  hosted.set(2, 100);
  hosted.process<float>(outputs, 1920);
  EXPECT_NEAR(hosted.instrument().value(2), 100 * (1 - std::exp(-2)), 0.5);
  for (int n = 0; n < 25; ++n) hosted.process<float>(outputs, 1920);
  EXPECT_EQ(hosted.instrument().value(2), 100);
}

/// The notes that are held, as events tell them.
struct HeldNotes {
  void take(const MidiEvent& event) {
    const bool is_mix = event.kind == MidiEvent::Kind::kLevel || event.kind == MidiEvent::Kind::kPan;
    ASSERT_TRUE(std::isfinite(event.cents) && (is_mix || (event.value >= 0 && event.value <= 1)));
    if (event.kind == MidiEvent::Kind::kNoteOn) {
      ASSERT_EQ(event.note, begun++);
      held[event.note] = event.key;
      ASSERT_LE(held.size(), MidiInterpreter::kMaxNotes);
    }
    if (event.kind == MidiEvent::Kind::kNoteOff) {
      ASSERT_EQ(held.erase(event.note), 1u);
    }
  }

  std::map<std::size_t, int> held;  // note to key
  std::size_t begun = 0;
};

// Whatever comes in, each note ends once, the first of its key and channel first, and none is left after a reset, nor
// after as many notes off of all keys and channels as notes are held. 10 million bytes with CONTACTSPLINE_FULL_TESTS.
TEST(HostileMidi, EndsEachNoteOnce) {
  MidiInterpreter midi({.first_key = 21, .last_key = 108, .max_cents = 1200});
  std::uint64_t state = 5;
  HeldNotes notes;
  const auto sink = [&](const MidiEvent& event) { notes.take(event); };
  HostileMidi hostile(11);
  const std::size_t all = hostile_bytes(300'000);
  for (std::size_t n = 0, taken = 0; taken < all; ++n) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const auto byte = static_cast<std::uint8_t>(state >> 40);
    const std::span<const std::uint8_t> bytes = n / 64 % 2 == 0 ? std::span(&byte, 1) : hostile.next();
    midi.take(bytes, sink);
    taken += bytes.size();
    if (n % 8 != 0) continue;
    // Notes by name beside them, also with parts that are no name.
    const auto part = [&](int shift, int most) { return static_cast<int>(state >> shift) % most - 1; };
    const NoteName name{part(8, 50), part(16, 18), part(24, 130)};
    const double value = n % 5 == 0   ? std::nan("")
                         : n % 7 == 0 ? std::numeric_limits<double>::infinity()
                                      : static_cast<double>(part(32, 300)) / 100;
    switch (state % 3) {
      case 0:
        midi.begin(name, value, 100 * value, sink, [&] { midi.express(name, NoteExpression::kTuning, value, sink); });
        break;
      case 1:
        midi.end(name, value, n % 3 == 0, sink);
        break;
      default:
        midi.express(name, static_cast<NoteExpression>(n / 8 % 6), value, sink);
    }
  }
  EXPECT_GT(notes.begun, 5'000u);
  midi.take(span_of("\xf7"), sink);  // ends what is cut off
  for (int n = 0; n < 400; ++n) midi.take(span_of(on(n % 127, 90, n % 16)), sink);
  EXPECT_GE(notes.held.size(), 400u);
  const HeldNotes held_before = notes;
  const MidiInterpreter before = midi;
  midi.take(span_of("\xff"), sink);
  EXPECT_TRUE(notes.held.empty());
  notes = held_before;
  midi = before;
  for (std::size_t n = 0; n < MidiInterpreter::kMaxNotes && !notes.held.empty(); ++n)
    for (int channel = 0; channel < 16; ++channel)
      for (int key = 0; key < 128; ++key) midi.take(span_of(off(key, channel)), sink);
  EXPECT_TRUE(notes.held.empty());
}

// The page shows the list that the interpreter obeys, word by word.
TEST(PageOfMidi, ShowsWhatEachMessageDoes) {
  std::ostringstream page;
  page << std::ifstream(SOURCE_FOLDER "/docs/how-to/midi.md").rdbuf();
  std::vector<std::string> rows;
  const auto numbers = [](int first, int last) {
    return first == last ? fmt::format("{}", first) : fmt::format("{} to {}", first, last);
  };
  for (const auto& row : kMidiControllers)
    rows.push_back(fmt::format("| {} | {} | {} |", numbers(row.first, row.last), row.name, row.effect));
  for (const auto& row : kMidiRegistered)
    rows.push_back(fmt::format("| registered {} | {} | {} |", numbers(row.first, row.last), row.name, row.effect));
  for (const auto& row : kMidiOthers) rows.push_back(fmt::format("| | {} | {} |", row.name, row.effect));
  std::string table;
  for (const std::string& row : rows) table += row + "\n";
  EXPECT_NE(page.str().find("\n" + table + "\n"), std::string::npos) << "docs/how-to/midi.md must show:\n" << table;
}

}  // namespace
}  // namespace contactspline::testing
