// SPDX-License-Identifier: MIT
#include "generator/player/midi_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "contactspline/data/parameter.hpp"
#include "contactspline/step/controls.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr int kDrums = 9, kChannels = 16;  // the tenth channel

/// Gathers the performance that the interpreter tells.
class SongRecorder {
 public:
  SongRecorder(const MidiSettings& settings, const MidiInterpreter& midi)
      : max_cents_(settings.max_cents < kNoLimit ? ControlRanges<double>::bend_cents.max : kNoLimit), midi_(midi) {}

  void set_time(double time_s) { time_s_ = time_s; }

  void operator()(const MidiEvent& event) {
    using Kind = MidiEvent::Kind;
    ++told_;
    switch (event.kind) {
      case Kind::kNoteOn:
        ++down_[channel_of(event)];
        song_.far_bends += std::abs(event.cents) > max_cents_;
        song_.notes.push_back({time_s_, 0, 0, event.key, event.value, event.channel, event.own_cents, 0, told_});
        return;
      case Kind::kNoteOff:
        return note_off(event);
      case Kind::kKeyController:
      case Kind::kNoteStart:
      case Kind::kLevel:
      case Kind::kPan:
        return;
      case Kind::kKeyBend:
        song_.far_bends += std::abs(event.cents) > max_cents_ && down_[channel_of(event)] > 0;
        return;
      case Kind::kChannelBend:
        song_.bends.push_back({time_s_, event.channel, event.cents, sounds(event.channel)});
        return;
      case Kind::kController:
        if (event.number != 0 && midi_pedal(event.number) == kMidiPedals.size())
          song_.moves.push_back({time_s_, event.channel, event.number, event.value});
        if (event.number == kSustainPedal && !midi_.is_sustained(event.channel)) end_held(channel_of(event));
        return;
      case Kind::kPedal:
        return pedal(event);
      case Kind::kSoundOff:
        return silence(event.channel);
      case Kind::kReset:
        return silence_all();
      case Kind::kPressure:
      case Kind::kKeyPressure:
        song_.moves.push_back({time_s_, event.channel, kPressureController, event.value, event.is_first});
        return;
      case Kind::kProgram:
        return program(event);
    }
  }

  [[nodiscard]] MidiSong&& song() { return std::move(song_); }

 private:
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

  static std::size_t channel_of(const MidiEvent& event) { return static_cast<std::size_t>(event.channel); }

  [[nodiscard]] bool sounds(int channel) const {
    const auto c = static_cast<std::size_t>(channel);
    return down_[c] > 0 || !held_[c].empty();
  }

  void note_off(const MidiEvent& event) {
    MidiNote& note = song_.notes[event.note];
    --down_[channel_of(event)];
    note.key_hold_s = time_s_ - note.time_s;
    note.release = event.value;
    note.ends = told_;
    held_[channel_of(event)].push_back(event.note);
    if (!midi_.is_sustained(event.channel)) end_held(channel_of(event));
  }

  void end_held(std::size_t channel) {
    for (const std::size_t note : std::exchange(held_[channel], {}))
      song_.notes[note].hold_s = time_s_ - song_.notes[note].time_s;
  }

  void pedal(const MidiEvent& event) {
    if (event.value != std::exchange(positions_[midi_pedal(event.number)], event.value))
      song_.pedals.push_back({time_s_, event.number, event.value});
  }

  void program(const MidiEvent& event) {
    MidiProgram& change = song_.programs.emplace_back(MidiProgram{time_s_, {event.channel}, event.number});
    for (int member = 0; member < kChannels; ++member)
      if (midi_.master_of(member) == event.channel) change.channels.insert(member);
  }

  // One instrument plays all channels: while another one sounds, the keys of this one are let go, and that is all.
  void silence(int channel) {
    for (int other = 0; other < kChannels; ++other)
      if (other != channel && sounds(other)) return;
    silence_all();
  }

  void silence_all() {
    for (std::size_t channel = 0; channel < kChannels; ++channel) end_held(channel);
    song_.silences_s.push_back(time_s_);
  }

  double max_cents_;
  const MidiInterpreter& midi_;
  double time_s_ = 0;
  std::size_t told_ = 0;  // events
  MidiSong song_;
  std::array<int, kChannels> down_{};                       // notes
  std::array<std::vector<std::size_t>, kChannels> held_{};  // notes that only the pedal holds
  std::array<double, kMidiPedals.size()> positions_{};
};

bool is_note_on(const std::vector<std::uint8_t>& bytes) {
  return (bytes[0] & 0xf0) == 0x90 && bytes[2] > 0;
}

// Says which channels have notes, and what was not read. channels: the chosen ones; none where all but drums are.
[[noreturn]] void refuse_silence(std::string_view file, const std::set<int>& with_notes,
                                 std::span<const int> channels, const std::vector<std::string>& remarks) {
  const std::string why = remarks.empty() ? "" : fmt::format(" ({})", fmt::join(remarks, "; "));
  if (with_notes.empty()) refuse_midi(file, "it has no note" + why);
  if (with_notes == std::set{kDrums + 1})
    throw NothingPlayed(fmt::format(
        "{}: MIDI: all its notes are on channel 10, which is for drums{}; allowed: --channel 10 to play them as keys",
        file, why));
  const bool is_of_drums = channels.size() == 1 && channels.front() == kDrums + 1;
  throw NothingPlayed(fmt::format(
      "{}: MIDI: no note is on channel {}{}{}; allowed: --channel {}", file, fmt::join(channels, ", "),
      is_of_drums ? ", that of drums and of keys without tuned_key" : "", why, fmt::join(with_notes, ", ")));
}

// What nobody has let go ends: keys, and pedals.
void let_go(MidiFile& file) {
  for (int channel = 0; channel < kChannels; ++channel)
    for (const int controller : {123, kSustainPedal, kSostenutoPedal, kSoftPedal})
      file.messages.push_back(
          {file.end_s, {static_cast<std::uint8_t>(0xb0 | channel), static_cast<std::uint8_t>(controller), 0}});
}

}  // namespace

std::map<int, MidiUse> midi_uses(std::span<const MidiFileMessage> messages) {
  std::map<int, MidiUse> uses;
  std::array<int, kChannels> programs{};
  for (const auto& [time_s, message] : messages) {
    const int channel = message[0] & 0xf;
    if ((message[0] & 0xf0) == 0xc0) programs[static_cast<std::size_t>(channel)] = message[1];
    if (!is_note_on(message)) continue;
    MidiUse& use = uses[channel + 1];
    if (use.notes++ == 0) use.program = programs[static_cast<std::size_t>(channel)];
  }
  return uses;
}

PlayedMidi read_played_midi(std::string_view bytes, std::string_view file, std::span<const int> channels) {
  PlayedMidi played{read_midi_file(bytes, file)};
  MidiInterpreter midi;  // knows the MPE zones
  const auto is_chosen = [&](int channel) {
    return channels.empty() ? channel != kDrums || midi.is_in_zone(kDrums)
                            : std::ranges::count(channels, channel + 1) > 0;
  };
  std::set<int> with_notes;
  for (MidiFileMessage& message : std::exchange(played.file.messages, {})) {
    const int channel = message.bytes[0] & 0xf;
    const bool is_of_channel = message.bytes[0] < 0xf0, is_note = is_of_channel && is_note_on(message.bytes);
    if (is_note) with_notes.insert(channel + 1);
    if (is_of_channel && !is_chosen(channel)) {
      played.unchosen += is_note;
      continue;
    }
    played.notes += is_note;
    midi.take(message.bytes, [](const MidiEvent& /*event*/) {});
    played.file.messages.push_back(std::move(message));
  }
  if (played.notes == 0) refuse_silence(file, with_notes, channels, played.file.remarks);
  let_go(played.file);
  return played;
}

MidiSong parse_midi(std::string_view bytes, std::string_view file, std::span<const int> channels,
                    const MidiSettings& settings) {
  PlayedMidi played = read_played_midi(bytes, file, channels);
  MidiInterpreter midi(settings);
  SongRecorder recorder(settings, midi);
  for (const auto& [time_s, message] : played.file.messages) {
    recorder.set_time(time_s);
    midi.take(message, recorder);
  }
  MidiSong song = recorder.song();
  song.title = std::move(played.file.title);
  song.remarks = std::move(played.file.remarks);
  song.unchosen = played.unchosen;
  song.unmapped = played.notes - song.notes.size();
  if (song.notes.empty())
    throw NothingPlayed(
        fmt::format("{}: MIDI: all its notes are on keys that the key map leaves out; allowed: a key map "
                    "with a degree for some of them",
                    file));
  return song;
}

}  // namespace contactspline
