// SPDX-License-Identifier: MIT
// The one interpreter of MIDI: bytes in, events of a performance out.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "contactspline/midi/key_tuning.hpp"
#include "contactspline/midi/midi_channel.hpp"
#include "contactspline/midi/midi_meaning.hpp"
#include "contactspline/midi/midi_message.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// An event of a performance by MIDI.
struct MidiEvent {
  enum class Kind {
    kNoteStart,      ///< channel, key, cents, pressure, brightness: what a note begins with, before its kNoteOn
    kNoteOn,         ///< note, channel, key, value: velocity above 0 to 1, cents
    kNoteOff,        ///< note, channel, key, value: release velocity, 0 to 1, is_last
    kKeyBend,        ///< channel, key, cents: of a key that the channel has played last
    kChannelBend,    ///< channel, cents: of all its keys, beside their own tuning
    kPressure,       ///< channel, value: 0 to 1, is_first, is_of_zone
    kController,     ///< channel, number, value: 0 to 1, is_of_zone
    kKeyPressure,    ///< channel, key, value: 0 to 1
    kKeyController,  ///< channel, key, number, value: 0 to 1
    kPedal,    ///< number: of kMidiPedals; value: 0 up to 1 down, of the channel that presses it farthest; also where
               ///< it stays there
    kProgram,  ///< channel, number
    kLevel,
    kPan,       ///< key, which the note plays; value: a gain; -1, left, to 1, right
    kSoundOff,  ///< channel
    kReset      ///< of the system: of all channels
  };

  Kind kind;
  int channel = 0;          ///< 0 to 15
  int key = -1;             ///< of the instrument, which the note plays
  int number = 0;           ///< of a controller, a pedal or a program
  double value = 0;         ///< of what kind says
  double cents = 0;         ///< above the pitch of `key`
  double own_cents = 0;     ///< of a note: what of that is not its channel's
  std::size_t note = 0;     ///< identity: how many notes began before it
  bool is_last = true;      ///< of a note off: does no other note hold the key?
  bool is_first = false;    ///< of a pressure: as if none had been sent
  bool is_of_zone = false;  ///< is its channel a member of an MPE zone, whose notes it concerns alone?
  /// Of a note that starts: those of its channel in an MPE zone, 0 to 1; not a number where none was sent.
  double pressure = MidiChannel::kUnsent, brightness = MidiChannel::kUnsent;
};

/// How a host that names notes says which ones it means: those that have all of these; -1 stands for any.
struct NoteName {
  int id = -1, channel = -1, key = -1;

  /// Is a note, which has all of these, meant?
  [[nodiscard]] constexpr bool means(const NoteName& note) const {
    return (id < 0 || id == note.id) && (channel < 0 || channel == note.channel) && (key < 0 || key == note.key);
  }
};

/// What such a host can do to a note: tune it [cents above its key], press it, 0 to 1, make it brighter, 0 to 1, and
/// mix it: by its volume and its expression, each 0 to 4, whose product is its gain, and by its place, -1 (left) to 1
/// (right). Values are clamped.
enum class NoteExpression { kTuning, kPressure, kBrightness, kVolume, kExpression, kPan };

/// Follows channels, tunings, MPE zones and held notes. What each message does is listed in midi_meaning.hpp. A note
/// off ends the note of its key and channel that began first. Nothing allocates; any bytes are safe.
class MidiInterpreter {
 public:
  static constexpr std::size_t kMaxNotes = 512;  ///< that are held; one more ends the first of them

  explicit MidiInterpreter(const MidiSettings& settings = {}) : settings_(settings) { forget(); }

  /// Takes bytes of a stream, which may be cut anywhere. sink: called with each MidiEvent.
  template <typename Sink>
  void take(std::span<const std::uint8_t> bytes, Sink&& sink) {
    for (const std::uint8_t byte : bytes)
      parser_.take(
          byte, [&](const MidiMessage& message) { this->message(message, sink); },
          [&](std::span<const std::uint8_t> exclusive) { this->exclusive(exclusive, sink); }, [&] { reset(sink); });
  }

  /// Begins a note of a host that names it. velocity: 0 to 1; cents above its key, -12000 to 12000; both clamped.
  /// What is no number, no key or no channel does nothing. express: called before it sounds; may express it.
  template <typename Sink, typename Express>
  void begin(const NoteName& name, double velocity, double cents, Sink&& sink, Express&& express) {
    const bool is_of_midi =
        name.key >= 0 && name.key < int(kMidiKeys) && name.channel >= 0 && name.channel < kChannels;
    if (!is_of_midi || !is_number(velocity) || !is_number(cents)) return;
    start(name, std::clamp(velocity, 0.0, 1.0), held(0.0, cents, kTuned), sink, express);
  }
  /// Ends the notes of a name that are held, or the first of them. velocity: 0 to 1, clamped; 0 where it is no
  /// number.
  template <typename Sink>
  void end(const NoteName& name, double velocity, bool is_first_only, Sink&& sink) {
    for (std::size_t n = 0; n < held_count_;) {
      if (!name.means(held_[n].name)) {
        ++n;
        continue;
      }
      end(n, 127 * held(0.0, velocity, {0, 1}), sink);
      if (is_first_only) return;
    }
  }
  /// Expresses the notes of a name, also while they ring after their end.
  template <typename Sink>
  void express(const NoteName& name, NoteExpression expression, double value, Sink&& sink) {
    if (!is_number(value)) return;
    each(name, [&](int key) {
      Sounding& note = sounding_[static_cast<std::size_t>(key)];
      switch (expression) {
        case NoteExpression::kTuning:
          note.bent_cents = held(0.0, value, kTuned);
          return tell_key(key, sink);
        case NoteExpression::kVolume:
        case NoteExpression::kExpression:
          (expression == NoteExpression::kVolume ? note.volume : note.expression) = held(0.0, value, {0, 4});
          return sink(MidiEvent{.kind = Kind::kLevel,
                                .channel = note.name.channel,
                                .key = key,
                                .value = note.volume * note.expression});
        case NoteExpression::kPan:
          return sink(MidiEvent{
              .kind = Kind::kPan, .channel = note.name.channel, .key = key, .value = held(0.0, value, {-1, 1})});
        case NoteExpression::kPressure:
        case NoteExpression::kBrightness:
          const bool is_pressure = expression == NoteExpression::kPressure;
          return sink(MidiEvent{.kind = is_pressure ? Kind::kKeyPressure : Kind::kKeyController,
                                .channel = note.name.channel,
                                .key = key,
                                .number = is_pressure ? 0 : kBrightnessController,
                                .value = std::clamp(value, 0.0, 1.0)});
      }
    });
  }
  /// Calls visit(key) for each key of the instrument that plays a note of a name, or has played it last.
  template <typename Visitor>
  void each(const NoteName& name, Visitor&& visit) const {
    for (std::size_t key = 0; key < kMidiKeys; ++key)
      if (sounding_[key].name.channel >= 0 && name.means(sounding_[key].name)) visit(static_cast<int>(key));
  }

  /// Calls visit(key of MIDI, cents above its pitch in equal temperament) for each note that is held. Where several
  /// play the same key of the instrument, all have the pitch of the last one.
  template <typename Visitor>
  void each_held(Visitor&& visit) const {
    for (const Held& held : std::span(held_).first(held_count_))
      visit(held.name.key, 100.0 * (held.played - held.name.key) + cents_of_key(held.played));
  }

  /// Tunes the keys by a table, or anew, for the notes that begin from now on.
  void tune(const MidiSettings& settings) {
    settings_ = settings;
    tuning_.tune(settings_.key_cents);
  }

  [[nodiscard]] const MidiSettings& settings() const { return settings_; }

  /// Tunes one key for the notes that begin from now on; not a number: it does not sound.
  void tune_key(int key, double cents) { tuning_.tune(static_cast<std::size_t>(key), cents); }

  /// The bend range of all channels that are in no MPE zone, 0 to 96 semitones, in steps of a cent; messages may
  /// change it.
  template <typename Sink>
  void set_bend_range(double semitones, Sink&& sink) {
    const int cents = static_cast<int>(std::lround(100 * std::clamp(semitones, 0.0, 96.0)));
    settings_.bend_range = cents / 100 << 7 | cents % 100;
    for (int channel = 0; channel < kChannels; ++channel)
      if (!is_in_zone(channel)) at(channel).bend_range = settings_.bend_range;
    tell_bends(sink);
  }

  /// Lets all notes go that are held, as if the instrument had been brought to rest. Channels keep their state.
  void drop_notes() {
    held_count_ = 0;
    sounding_.fill({});
  }

  /// The first channel of the MPE zone whose member a channel is, or -1.
  [[nodiscard]] int master_of(int channel) const {
    if (channel >= 1 && channel <= lower_) return 0;
    return channel <= 14 && channel >= 15 - upper_ ? 15 : -1;
  }
  /// Is a channel in an MPE zone, as its first or as a member?
  [[nodiscard]] bool is_in_zone(int channel) const {
    return master_of(channel) >= 0 || (channel == 0 && lower_ > 0) || (channel == 15 && upper_ > 0);
  }
  /// Does a channel hold the sustain pedal down, from 64 on?
  [[nodiscard]] bool is_sustained(int channel) const {
    return at(channel).pedals[midi_pedal(kSustainPedal)] >= kHalf;
  }

 private:
  using Kind = MidiEvent::Kind;
  static constexpr int kHalf = 64, kChannels = 16;
  static constexpr ControlRange<double> kTuned{-12000, 12000};  // cents, by a host that names notes

  struct Held {
    std::size_t note;
    NoteName name;
    int played;  // the key of the instrument
  };
  // What a key of the instrument plays.
  struct Sounding {
    NoteName name;          // of the note
    double own_cents = 0;   // beside the bend of the channel
    double bent_cents = 0;  // by the host that names the note
    double volume = 1, expression = 1;
  };

  [[nodiscard]] MidiChannel& at(int channel) { return channels_[static_cast<std::size_t>(channel)]; }
  [[nodiscard]] const MidiChannel& at(int channel) const { return channels_[static_cast<std::size_t>(channel)]; }

  [[nodiscard]] double cents_of(int channel) const {
    const int master = master_of(channel);
    return tuning_.master() + at(channel).cents() + (master < 0 ? 0 : at(master).cents());
  }

  // Of the instrument, which has played.
  [[nodiscard]] double cents_of_key(int key) const {
    const Sounding& note = sounding_[static_cast<std::size_t>(key)];
    return note.own_cents + note.bent_cents + cents_of(note.name.channel);
  }

  template <typename Sink>
  void message(const MidiMessage& message, Sink& sink) {
    const auto& [status, first, second, channel] = message;
    switch (status) {
      case 0x80:
        return note_off(channel, first, second == 0 ? kHalf : second, sink);
      case 0x90:
        return second == 0 ? note_off(channel, first, kHalf, sink) : note_on(channel, first, second, sink);
      case 0xa0:
        return press_key(channel, first, second, sink);
      case 0xb0:
        return controller(channel, first, second, sink);
      case 0xc0:
        return sink(MidiEvent{.kind = Kind::kProgram, .channel = channel, .number = first});
      case 0xd0:
        at(channel).pressure = first / 127.0;
        return sink(MidiEvent{.kind = Kind::kPressure,
                              .channel = channel,
                              .value = first / 127.0,
                              .is_of_zone = master_of(channel) >= 0});
      default:
        at(channel).wheel = second << 7 | first;
        return tell_bends(sink);
    }
  }

  template <typename Sink>
  void press_key(int channel, int key, int pressure, Sink& sink) {
    each({-1, channel, key}, [&](int played) {
      sink(MidiEvent{.kind = Kind::kKeyPressure, .channel = channel, .key = played, .value = pressure / 127.0});
    });
  }

  template <typename Sink>
  void exclusive(std::span<const std::uint8_t> bytes, Sink& sink) {
    const bool is_general_midi =
        bytes.size() == 4 && bytes[0] == 0x7e && bytes[2] == 9 && bytes[3] >= 1 && bytes[3] <= 3;
    if (is_general_midi) return reset(sink);
    tuning_.take(bytes);  // the tuning of a key waits for its next note
    tell_bends(sink);
  }

  template <typename Sink>
  void note_on(int channel, int key, int velocity, Sink& sink) {
    if (!is_number(tuning_.cents(key))) return;
    const double value = (velocity + std::exchange(at(channel).velocity_low, 0) / 128.0) / 127.0;
    start({-1, channel, key}, (std::min)(value, 1.0), 0, sink, [] {});
  }

  // Begins a note: the key of the instrument that plays it, and how far it is tuned.
  template <typename Sink, typename Express>
  void start(const NoteName& name, double velocity, double cents, Sink& sink, const Express& express) {
    const int channel = name.channel;
    const double own_of_key = tuning_.cents(name.key) + cents;
    if (!is_number(own_of_key)) return;
    if (held_count_ == kMaxNotes) end(0, kHalf, sink);
    const auto [played, own] = tuned_key(name.key, own_of_key, cents_of(channel), settings_);
    sounding_[static_cast<std::size_t>(played)] = {name, own};
    held_[held_count_++] = {notes_, name, played};
    const bool is_member = master_of(channel) >= 0;
    sink(MidiEvent{.kind = Kind::kNoteStart,
                   .channel = channel,
                   .key = played,
                   .cents = own + cents_of(channel),
                   .pressure = is_member ? at(channel).pressure : MidiChannel::kUnsent,
                   .brightness = is_member ? at(channel).brightness : MidiChannel::kUnsent});
    express();
    sink(MidiEvent{.kind = Kind::kNoteOn,
                   .channel = channel,
                   .key = played,
                   .value = velocity,
                   .cents = own + cents_of(channel),
                   .own_cents = own,
                   .note = notes_++});
  }

  template <typename Sink>
  void note_off(int channel, int key, int velocity, Sink& sink) {
    for (std::size_t n = 0; n < held_count_; ++n)
      if (held_[n].name.channel == channel && held_[n].name.key == key) return end(n, velocity, sink);
  }

  template <typename Sink>
  void end(std::size_t number, double velocity, Sink& sink) {
    const Held ended = held_[number];
    std::copy(held_.begin() + static_cast<std::ptrdiff_t>(number) + 1,
              held_.begin() + static_cast<std::ptrdiff_t>(held_count_),
              held_.begin() + static_cast<std::ptrdiff_t>(number));
    --held_count_;
    const auto others = std::span(held_).first(held_count_);
    sink(MidiEvent{.kind = Kind::kNoteOff,
                   .channel = ended.name.channel,
                   .key = ended.played,
                   .value = velocity / 127.0,
                   .note = ended.note,
                   .is_last = std::ranges::find(others, ended.played, &Held::played) == others.end()});
  }

  template <typename Sink>
  void end_notes(int channel, Sink& sink) {
    for (std::size_t n = 0; n < held_count_;)
      if (held_[n].name.channel == channel)
        end(n, kHalf, sink);
      else
        ++n;
  }

  template <typename Sink>
  void controller(int channel, int number, int value, Sink& sink) {
    const auto* const row = midi_row(kMidiControllers, number);
    MidiChannel& of = at(channel);
    if (row == nullptr) return tell_controller(channel, number, value, sink);
    switch (row->meaning) {
      case MidiControl::kParameter:
        return tell_controller(channel, number, value, sink);
      case MidiControl::kPedal:
      case MidiControl::kSwitch:
        return pedal(channel, number, value, sink);
      case MidiControl::kDataHigh:
        return data_entry(channel, value << 7, 0, sink);
      case MidiControl::kDataLow:
        return data_entry(channel, value, 0x7f << 7, sink);
      case MidiControl::kIncrement:
      case MidiControl::kDecrement:
        if (const auto* const parameter = of.parameter())
          of.step(parameter->meaning, row->meaning == MidiControl::kIncrement ? 1 : -1);
        return share_range(channel, sink);
      case MidiControl::kVelocityLow:
        of.velocity_low = value;
        return;
      case MidiControl::kUnregistered:
        of.is_registered = false;
        return;
      case MidiControl::kRegisteredLow:
      case MidiControl::kRegisteredHigh:
        of.is_registered = true;
        of.chosen = number == 100 ? (of.chosen & 0x7f << 7) | value : (of.chosen & 0x7f) | value << 7;
        return;
      case MidiControl::kSoundOff:
        end_notes(channel, sink);
        return sink(MidiEvent{.kind = Kind::kSoundOff, .channel = channel});
      case MidiControl::kReset:
        return reset_controllers(channel, sink);
      case MidiControl::kNotesOff:
        return end_notes(channel, sink);
    }
  }

  template <typename Sink>
  void tell_controller(int channel, int number, int value, Sink& sink) {
    const bool is_brightness = number == kBrightnessController;
    if (is_brightness) at(channel).brightness = value / 127.0;
    sink(MidiEvent{.kind = Kind::kController,
                   .channel = channel,
                   .number = number,
                   .value = value / 127.0,
                   .is_of_zone = is_brightness && master_of(channel) >= 0});
  }

  [[nodiscard]] double position(std::size_t pedal) const {
    const int farthest =
        (std::ranges::max)(channels_, {}, [=](const MidiChannel& of) { return of.pedals[pedal]; }).pedals[pedal];
    if (kMidiPedals[pedal] == kSostenutoPedal) return farthest >= kHalf ? 1 : 0;
    return (std::min)(1.0, double(farthest) / kHalf);
  }

  template <typename Sink>
  void pedal(int channel, int number, int value, Sink& sink) {
    const std::size_t which = midi_pedal(number);
    at(channel).pedals[which] = value;
    tell_controller(channel, number, value, sink);
    sink(MidiEvent{.kind = Kind::kPedal, .number = number, .value = position(which)});
  }

  // Sets a registered parameter, of whose 14 bits some stay.
  template <typename Sink>
  void data_entry(int channel, int bits, int stay, Sink& sink) {
    const auto* const parameter = at(channel).parameter();
    if (parameter == nullptr) return;
    if (parameter->meaning == MidiTuning::kZone) {
      if (stay == 0) zone(channel, bits >> 7, sink);
      return;
    }
    int& value = *at(channel).value_of(parameter->meaning);
    value = (value & stay) | bits;
    share_range(channel, sink);
  }

  // All members of a zone have one bend range.
  template <typename Sink>
  void share_range(int channel, Sink& sink) {
    if (const int master = master_of(channel); master >= 0)
      for (int other = 0; other < kChannels; ++other)
        if (master_of(other) == master) at(other).bend_range = at(channel).bend_range;
    tell_bends(sink);
  }

  // An MPE zone of so many members; the other one keeps what is left.
  template <typename Sink>
  void zone(int channel, int members, Sink& sink) {
    if ((channel != 0 && channel != 15) || members > 15) return;
    std::array<bool, kChannels> were{};
    for (int c = 0; c < kChannels; ++c) were[static_cast<std::size_t>(c)] = is_in_zone(c);
    (channel == 0 ? lower_ : upper_) = members;
    int& other = channel == 0 ? upper_ : lower_;
    other = (std::min)(other, (std::max)(0, 14 - members));
    for (int c = 0; c < kChannels; ++c) {
      const bool is_member = master_of(c) >= 0;
      if (!is_member && !were[static_cast<std::size_t>(c)] && c != channel) continue;
      end_notes(c, sink);
      at(c).bend_range = is_member ? 48 << 7 : settings_.bend_range;
      at(c).wheel = 0x2000;
      at(c).pressure = at(c).brightness = MidiChannel::kUnsent;
    }
    tell_bends(sink);
  }

  template <typename Sink>
  void reset_controllers(int channel, Sink& sink) {
    MidiChannel& of = at(channel);
    of.wheel = 0x2000;
    of.chosen = MidiChannel::kNone;
    of.is_registered = false;
    of.velocity_low = 0;
    of.pressure = MidiChannel::kUnsent;  // the brightness stays (RP-015)
    for (const int number : kMidiPedals) pedal(channel, number, 0, sink);
    tell_controller(channel, 1, 0, sink);
    tell_controller(channel, 11, 127, sink);
    sink(MidiEvent{
        .kind = Kind::kPressure, .channel = channel, .is_first = true, .is_of_zone = master_of(channel) >= 0});
    tell_bends(sink);
  }

  template <typename Sink>
  void reset(Sink& sink) {
    while (held_count_ > 0) end(0, kHalf, sink);
    for (int channel = 0; channel < kChannels; ++channel) reset_controllers(channel, sink);
    forget();
    for (int channel = 0; channel < kChannels; ++channel)
      sink(MidiEvent{.kind = Kind::kChannelBend, .channel = channel});
    sink(MidiEvent{.kind = Kind::kReset});
  }

  void forget() {
    channels_.fill({});
    for (MidiChannel& channel : channels_) channel.bend_range = settings_.bend_range;
    tuning_ = MidiKeyTuning(settings_.key_cents);
    lower_ = upper_ = 0;
    drop_notes();
  }

  // Tells the bends of all channels that have changed, and of the keys that they have played.
  template <typename Sink>
  void tell_bends(Sink& sink) {
    for (int channel = 0; channel < kChannels; ++channel) {
      const double cents = cents_of(channel);
      if (cents == std::exchange(at(channel).told_cents, cents)) continue;
      sink(MidiEvent{.kind = Kind::kChannelBend, .channel = channel, .cents = cents});
      for (std::size_t key = 0; key < kMidiKeys; ++key)
        if (sounding_[key].name.channel == channel) tell_key(static_cast<int>(key), sink);
    }
  }

  template <typename Sink>
  void tell_key(int key, Sink& sink) {
    sink(MidiEvent{.kind = Kind::kKeyBend,
                   .channel = sounding_[static_cast<std::size_t>(key)].name.channel,
                   .key = key,
                   .cents = cents_of_key(key)});
  }

  MidiSettings settings_;
  MidiParser parser_;
  std::array<MidiChannel, kChannels> channels_;
  MidiKeyTuning tuning_;
  int lower_ = 0, upper_ = 0;  // member channels of the MPE zones
  std::array<Held, kMaxNotes> held_{};
  std::size_t held_count_ = 0, notes_ = 0;
  std::array<Sounding, kMidiKeys> sounding_{};
};

}  // namespace contactspline
