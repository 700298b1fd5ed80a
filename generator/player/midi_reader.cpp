// SPDX-License-Identifier: MIT
#include "generator/player/midi_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

// The library's header wants std::size_t.
#include <portSMF/mfmidi.h>

#include "generator/support/error.hpp"
#include "generator/support/json_reader.hpp"

namespace contactspline {
namespace {

constexpr int kTrackName = 3;
constexpr std::size_t kLongestTitle = 100;
constexpr int kDrums = 9;  // the tenth channel
constexpr std::array<int, 3> kPedalControllers = {MidiPedal::kSustain, MidiPedal::kSostenuto, MidiPedal::kSoft};
constexpr int kPedalDown = 64;  // value of a controller
constexpr int kDataEntry = 6, kParameterLow = 100,
              kParameterHigh = 101;  // controllers; parameter 0 is the bend range
constexpr int kWheelCentre = 0x2000;
constexpr long kLastTick = 1L << 40;  // far beyond an hour

[[noreturn]] void fail(std::string_view file, std::string_view wrong) {
  throw BadInput(fmt::format("{}: MIDI: {}; allowed: a standard MIDI file of format 0 or 1", file, wrong));
}

/// An event of a file that is played: a key, the pedal or the tempo.
struct MidiEvent {
  enum Kind { kKey, kController, kBend, kTempo } kind;
  long tick;
  int channel, number, value;  ///< a key with its velocity (0: let go), a controller, the wheel, us a quarter
};

/// The library reads a file byte by byte and calls what it finds. Whatever is wrong throws.
class Reader final : private Midifile_reader {
 public:
  explicit Reader(std::string_view file) : file_(file) {}
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { finalize(); }

  std::vector<MidiEvent> events_in(std::string_view bytes) {
    // The library reads an empty message through a null pointer unless it has had one with content before.
    constexpr std::string_view kOneText("MThd\0\0\0\6\0\0\0\1\0\1MTrk\0\0\0\11\0\377\1\1\0\0\377\57\0", 31);
    read(kOneText);
    read(bytes);
    return std::move(events_);
  }
  [[nodiscard]] const std::string& title() const { return title_; }
  [[nodiscard]] int division() const { return division_; }

 private:
  void read(std::string_view bytes) {
    bytes_ = bytes;
    tracks_ = 0;
    midifile();
  }

  void add(MidiEvent::Kind kind, int channel, int number, int value) {
    if (Mf_currtime < last_tick_ || Mf_currtime > kLastTick) fail(file_, "a time is damaged");
    last_tick_ = Mf_currtime;
    const int max = kind == MidiEvent::kTempo ? value : kind == MidiEvent::kBend ? 0x3fff : 127;
    if (number < 0 || number > 127 || value < 0 || value > max)
      fail(file_, fmt::format("a data byte of channel {} is above 127", channel + 1));
    events_.push_back({kind, Mf_currtime, channel, number, value});
  }

  // The library reads a message of a fixed length whole, even where the file has fewer bytes of it: zeros.
  void* Mf_malloc(std::size_t size) override { return new char[size](); }
  void Mf_free(void* object, std::size_t) override { delete[] static_cast<char*>(object); }
  int Mf_getc() override {
    if (bytes_.empty()) return EOF;
    const auto byte = static_cast<unsigned char>(bytes_.front());
    bytes_.remove_prefix(1);
    return byte;
  }
  void Mf_error(char* what) override { fail(file_, shown(what)); }
  void Mf_header(int format, int, int division) override {
    if (format > 1) fail(file_, fmt::format("it has format {}", format));
    if (division == 0) fail(file_, "its unit of time is 0");
    division_ = division;
  }
  void Mf_starttrack() override {
    ++tracks_;
    last_tick_ = 0;
    has_ended_ = false;
  }
  void Mf_endtrack() override {
    if (!has_ended_) fail(file_, "a track has no end");
  }
  void Mf_eot() override { has_ended_ = true; }
  void Mf_on(int channel, int key, int velocity) override { add(MidiEvent::kKey, channel, key, velocity); }
  void Mf_off(int channel, int key, int) override { add(MidiEvent::kKey, channel, key, 0); }
  void Mf_controller(int channel, int number, int value) override {
    add(MidiEvent::kController, channel, number, value);
  }
  void Mf_tempo(int microseconds) override {
    if (microseconds <= 0) fail(file_, "a tempo is 0");
    add(MidiEvent::kTempo, 0, 0, microseconds);
  }
  void Mf_chanprefix(int) override {}
  void Mf_portprefix(int) override {}
  void Mf_pressure(int, int, int) override {}
  void Mf_pitchbend(int channel, int low, int high) override {
    add(MidiEvent::kBend, channel, low, 128 * high + low);
  }
  void Mf_program(int, int) override {}
  void Mf_chanpressure(int, int) override {}
  void Mf_sysex(int, unsigned char*) override {}
  void Mf_arbitrary(int, unsigned char*) override {}
  void Mf_metamisc(int, int, unsigned char*) override {}
  void Mf_seqnum(int) override {}
  void Mf_smpte(int, int, int, int, int) override {}
  void Mf_timesig(int, int, int, int) override {}
  void Mf_keysig(int, int) override {}
  void Mf_sqspecific(int, unsigned char*) override {}
  void Mf_text(int type, int length, unsigned char* text) override {
    if (type == kTrackName && tracks_ == 1 && title_.empty() && length > 0)
      title_ = shown({reinterpret_cast<const char*>(text), static_cast<std::size_t>(length)}, kLongestTitle);
  }

  std::string_view file_, bytes_;
  std::string title_;
  std::vector<MidiEvent> events_;
  long last_tick_ = 0;
  int division_ = 0, tracks_ = 0;
  bool has_ended_ = false;
};

/// Seconds from ticks that come in rising order.
class Clock {
 public:
  /// division: ticks a quarter, or, above 0x7fff, minus frames a second and ticks a frame in a byte each.
  explicit Clock(int division) {
    const int frames = 256 - (division >> 8);
    if (division > 0x7fff)
      tick_s_ = 1 / ((frames == 29 ? 29.97 : frames) * std::max(1, division & 0xff));
    else
      quarter_ticks_ = division, set_tempo(500'000);
  }

  double at(long tick) {
    time_s_ += static_cast<double>(tick - tick_) * tick_s_;
    tick_ = tick;
    return time_s_;
  }
  void set_tempo(int microseconds) {
    if (quarter_ticks_ > 0) tick_s_ = 1e-6 * microseconds / quarter_ticks_;
  }

 private:
  int quarter_ticks_ = 0;
  double tick_s_ = 0, time_s_ = 0;
  long tick_ = 0;
};

/// Keys and pedals of all channels: which notes sound on.
class NoteTracker {
 public:
  void key(double time_s, int channel, int key, int velocity) {
    let_go(time_s, channel, key);
    if (velocity == 0) return;
    pressed_[{channel, key}] = notes_.size();
    notes_.push_back({time_s, 0, 0, key, velocity, channel});
  }

  void bend(double time_s, int channel, int wheel) {
    of_channel(channel).wheel = wheel;
    note_bend(time_s, channel);
  }

  void controller(double time_s, int channel, int number, int value) {
    Channel& of = of_channel(channel);
    note_pedal(time_s, channel, number, value);
    if (!of.is_sustained())
      for (const std::size_t note : std::exchange(of.held, {})) end(note, time_s);
    if (number == kParameterHigh) of.parameter = 128 * value + of.parameter % 128;
    if (number == kParameterLow) of.parameter = of.parameter / 128 * 128 + value;
    if (number == kDataEntry && of.parameter == 0) {
      of.bend_range = value;
      note_bend(time_s, channel);
    }
  }

  std::vector<MidiNote> notes_at_end(double time_s) {
    while (!pressed_.empty()) let_go(time_s, pressed_.begin()->first.first, pressed_.begin()->first.second);
    for (int channel = 0; channel < 16; ++channel)
      for (const int controller : kPedalControllers) this->controller(time_s, channel, controller, 0);
    return std::move(notes_);
  }

  [[nodiscard]] std::vector<MidiBend> bends() { return std::move(bends_); }
  [[nodiscard]] std::vector<MidiPedal> pedals() { return std::move(pedals_); }

 private:
  struct Channel {
    [[nodiscard]] double cents() const { return 100.0 * bend_range * (wheel - kWheelCentre) / kWheelCentre; }

    [[nodiscard]] bool is_sustained() const { return pedals[0] >= kPedalDown; }

    std::array<int, kPedalControllers.size()> pedals =
        {};  ///< positions, 0 to 127, in the order of kPedalControllers
    int wheel = kWheelCentre;
    int bend_range = 2;             ///< semitones
    double bend_cents = 0;          ///< of the last bend
    int parameter = 0x3fff;         ///< registered parameter that a data entry sets; 0x3fff: none
    std::vector<std::size_t> held;  ///< notes that only the pedal holds
  };

  Channel& of_channel(int channel) { return channels_[static_cast<std::size_t>(channel)]; }

  bool sounds(int channel) {
    const auto is_pressed = [=](const auto& entry) { return entry.first.first == channel; };
    return !of_channel(channel).held.empty() || std::ranges::any_of(pressed_, is_pressed);
  }

  void note_bend(double time_s, int channel) {
    Channel& of = of_channel(channel);
    if (of.cents() == of.bend_cents) return;
    of.bend_cents = of.cents();
    bends_.push_back({time_s, channel, of.bend_cents, sounds(channel)});
  }

  void note_pedal(double time_s, int channel, int controller, int value) {
    const auto pedal =
        static_cast<std::size_t>(std::ranges::find(kPedalControllers, controller) - kPedalControllers.begin());
    if (pedal == kPedalControllers.size()) return;
    const auto farthest = [&] {
      return std::ranges::max(channels_, {}, [=](const Channel& of) { return of.pedals[pedal]; }).pedals[pedal];
    };
    const int before = farthest();
    of_channel(channel).pedals[pedal] = value;
    if (farthest() != before) pedals_.push_back({time_s, controller, farthest() / 127.0});
  }

  void let_go(double time_s, int channel, int key) {
    const auto pressed = pressed_.find({channel, key});
    if (pressed == pressed_.end()) return;
    notes_[pressed->second].key_hold_s = time_s - notes_[pressed->second].time_s;
    Channel& of = of_channel(channel);
    if (of.is_sustained())
      of.held.push_back(pressed->second);
    else
      end(pressed->second, time_s);
    pressed_.erase(pressed);
  }

  void end(std::size_t note, double time_s) { notes_[note].hold_s = time_s - notes_[note].time_s; }

  std::vector<MidiNote> notes_;
  std::map<std::pair<int, int>, std::size_t> pressed_;  ///< channel and key to note
  std::array<Channel, 16> channels_;
  std::vector<MidiBend> bends_;
  std::vector<MidiPedal> pedals_;
};

bool is_chosen(int channel, std::span<const int> channels) {
  return channels.empty() ? channel != kDrums : std::ranges::count(channels, channel + 1) > 0;
}

// Says which channels have notes.
[[noreturn]] void refuse_silence(std::string_view file, const std::set<int>& with_notes) {
  if (with_notes.empty()) fail(file, "it has no note");
  if (with_notes == std::set{kDrums + 1})
    throw BadInput(fmt::format(
        "{}: MIDI: all its notes are on channel 10, which is for drums; allowed: --channel 10 to play them as keys",
        file));
  throw BadInput(fmt::format("{}: MIDI: no note is on a chosen channel; allowed: --channel {}", file,
                             fmt::join(with_notes, ", ")));
}

}  // namespace

MidiSong parse_midi(std::string_view bytes, std::string_view file, std::span<const int> channels) {
  Reader reader(file);
  auto events = reader.events_in(bytes);
  std::ranges::stable_sort(events, {}, &MidiEvent::tick);
  Clock clock(reader.division());
  NoteTracker tracker;
  std::set<int> with_notes;
  std::size_t unchosen = 0;
  double time = 0;
  for (const auto& [kind, tick, channel, number, value] : events) {
    time = clock.at(tick);
    if (kind == MidiEvent::kTempo) clock.set_tempo(value);
    if (kind == MidiEvent::kTempo) continue;
    if (kind == MidiEvent::kKey && value > 0) with_notes.insert(channel + 1);
    if (!is_chosen(channel, channels)) {
      unchosen += kind == MidiEvent::kKey && value > 0;
      continue;
    }
    if (kind == MidiEvent::kKey) tracker.key(time, channel, number, value);
    if (kind == MidiEvent::kController) tracker.controller(time, channel, number, value);
    if (kind == MidiEvent::kBend) tracker.bend(time, channel, value);
  }
  auto notes = tracker.notes_at_end(time);
  if (notes.empty()) refuse_silence(file, with_notes);
  return {reader.title(), std::move(notes), tracker.bends(), tracker.pedals(), unchosen};
}

}  // namespace contactspline
