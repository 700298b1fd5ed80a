// SPDX-License-Identifier: MIT
#include "generator/player/instrument_score_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "contactspline/data/pluck.hpp"
#include "contactspline/midi/midi_meaning.hpp"
#include "generator/player/drum_names.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/player/score_keys.hpp"
#include "generator/resonator/resonator_reader.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

Voice voice_of(const InstrumentModel& model, double tuning_cents) {
  Voice voice;
  voice.name = model.name;
  voice.model = model;
  tune(*voice.model, tuning_cents);
  for (const ModelParameter& parameter : model.parameters) voice.initial.push_back(parameter.initial);
  return voice;
}

bool plays_key(const InstrumentModel& model, int key) {
  return std::ranges::any_of(model.keys.ranges,
                             [&](const KeyRange& range) { return range.first <= key && key <= range.last; });
}

std::string keys_in_words(const InstrumentModel& model) {
  std::vector<std::string> words;
  for (const KeyRange& range : model.keys.ranges)
    words.push_back(range.first == range.last ? fmt::format("{}", range.first)
                                              : fmt::format("{} to {}", range.first, range.last));
  return shown(fmt::format("keys {}", fmt::join(words, ", ")), 240);
}

constexpr int kDrumChannel = 9;  // counted from 0

/// A voice and the channels whose notes it plays.
struct MidiVoice {
  Voice voice;
  std::set<int> channels = {};
};

// The notes of a MIDI file and what it left out.
struct MidiVoices {
  std::map<std::pair<int, double>, MidiVoice> by_channel;  ///< and the own tuning of its notes
  std::map<std::pair<int, bool>, std::size_t> beyond;      ///< by key, and whether it is one of the tenth channel
  double end_s = 0;
};

MidiVoices midi_voices(const InstrumentModel& model, const MidiSong& song) {
  const bool bends = model.keys.bend != kNoParameter;
  MidiVoices voices;
  for (const MidiNote& note : song.notes) {
    if (!plays_key(model, note.key)) {
      ++voices.beyond[{note.key, note.channel == kDrumChannel}];
      continue;
    }
    const bool has_bends =
        bends && std::ranges::find(song.bends, note.channel, &MidiBend::channel) != song.bends.end();
    const int channel = has_bends ? note.channel : -1;
    const bool bends_keys = model.keys.tune();  // otherwise as a whole
    const double cents = bends && !bends_keys ? note.cents : 0;
    auto& [voice, played] =
        voices.by_channel.try_emplace({channel, cents}, MidiVoice{voice_of(model, 0)}).first->second;
    played.insert(note.channel);
    if (has_bends) voice.name = fmt::format("{}_channel_{}", model.name, channel + 1);
    if (cents != 0) voice.name += fmt::format("_{:+.6g}_cents", cents);
    voice.notes.push_back(
        {note.time_s, note.key, note.velocity, note.key_hold_s, bends_keys ? note.cents : 0, note.begins, note.ends});
    voices.end_s = std::max(voices.end_s, note.time_s + note.hold_s);
  }
  return voices;
}

// Without keys of its own, an instrument plays what it plays in hosts: each key its one event; of several events, the
// keys from 60 on one each.
InstrumentModel with_keys(InstrumentModel model) {
  if (!model.keys.ranges.empty()) return model;
  if (model.events.empty())
    throw BadInput(
        fmt::format("--instrument: {} has nothing that keys could play; allowed: an instrument file with "
                    "strikes, plucks or bows, or a model of your own (.so)",
                    model.name));
  constexpr int kFirst = 60, kLast = 127;
  if (model.events.size() == 1) model.keys.ranges = {{0, kLast, 0}};
  for (std::size_t event = 0; event < model.events.size() && model.events.size() > 1; ++event)
    if (const int key = kFirst + static_cast<int>(event); key <= kLast)
      model.keys.ranges.push_back({key, key, event});
  return model;
}

// The notes beyond the keys, if there are some. Of keys that tune nothing each is named, on the channel of drums by
// its drum.
std::string beyond_in_words(const InstrumentModel& model, const std::map<std::pair<int, bool>, std::size_t>& beyond) {
  std::size_t notes = 0;
  std::vector<std::string> keys;
  for (const auto& [key_and_channel, count] : beyond) {
    const auto& [key, is_of_drums] = key_and_channel;
    const std::string_view drum = is_of_drums ? drum_on(key) : "";
    notes += count;
    keys.push_back(fmt::format("{}{}{} ({})", key, drum.empty() ? "" : " ", drum, count));
  }
  if (model.keys.tune() || model.module != nullptr)
    return fmt::format("left out: notes beyond {} ({})", keys_in_words(model), notes);
  return shown(fmt::format("left out, as {} has nothing to strike there: keys {}", model.name, fmt::join(keys, ", ")),
               400);
}

// The keys that tune nothing stay as they are.
KeyCents key_cents_of(const InstrumentModel& model, const Tuning& tuning) {
  KeyCents cents = key_cents(tuning);
  for (const KeyRange& range : model.keys.ranges)
    for (int key = range.first; key <= range.last && range.tuned_key < 0 && model.keys.tune(); ++key)
      if (double& of = cents[static_cast<std::size_t>(key)]; is_number(of)) of = 0;
  return cents;
}

MidiSettings settings_of(const InstrumentModel& model, const Tuning& tuning) {
  MidiSettings settings{.first_key = model.keys.ranges.front().first, .last_key = model.keys.ranges.front().last};
  for (const KeyRange& range : model.keys.ranges) {
    settings.first_key = std::min(settings.first_key, range.first);
    settings.last_key = std::max(settings.last_key, range.last);
  }
  if (model.keys.bend != kNoParameter) settings.max_cents = kTuningCents.max;
  return tuning.is_given() ? tuned(settings, key_cents_of(model, tuning)) : settings;
}

// A program is the preset of that number, but for pedals and bends, on the channels that the voice plays.
void add_programs(const InstrumentModel& model, const MidiSong& song, MidiVoice& played) {
  for (const auto& [time_s, channels, program] : song.programs) {
    const auto preset = static_cast<std::size_t>(program);
    const bool is_heard =
        std::ranges::any_of(channels, [&](int channel) { return played.channels.contains(channel); });
    for (std::size_t p = 0; is_heard && preset < model.presets.size() && p < model.parameters.size(); ++p)
      if (const ModelParameter& x = model.parameters[p]; !is_of_performance(x.name, x.controller))
        played.voice.glides.push_back({time_s, x.glide_s, p, model.presets[preset].values[p]});
  }
}

// The wheel of its channel, the sustain pedal, and what moves parameters, unless it is of another channel that has a
// voice of its own.
void add_controllers(const InstrumentModel& model, const MidiSong& song, int channel, double cents,
                     const std::set<int>& with_voice, Voice& voice) {
  const auto is_heard = [&](int from) { return from == channel || !with_voice.contains(from); };
  if (cents != 0) voice.glides.push_back({0, 0, model.keys.bend, cents});
  for (const MidiBend& bend : song.bends)
    if (bend.channel == channel) voice.glides.push_back(glide_of(bend, model.keys.bend, cents));
  for (const MidiPedal& pedal : song.pedals)
    if (pedal.controller == kSustainPedal && model.keys.sustain != kNoParameter)
      voice.glides.push_back({pedal.time_s, 0, model.keys.sustain, pedal.position});
  for (const MidiMove& move : song.moves)
    for (std::size_t p = 0; p < model.parameters.size(); ++p)
      if (const ModelParameter& x = model.parameters[p]; x.controller == move.controller && is_heard(move.channel))
        voice.glides.push_back({move.time_s, x.glide_s, p, move.is_first ? x.initial : value_at(x, move.part)});
}

std::vector<Voice> read_voices(const JsonObject& score, const InstrumentModel& model) {
  if (!score.has("voices")) return {voice_of(model, 0)};
  std::vector<Voice> voices;
  std::set<std::string> names;
  const std::vector<std::string> keys = model.module != nullptr
                                            ? std::vector<std::string>{"name", "pan"}
                                            : std::vector<std::string>{"name", "tuning_cents", "pan"};
  for (const JsonObject& json : score.objects("voices", keys, kMaxVoices)) {
    Voice& voice = voices.emplace_back(voice_of(model, number_or(json, "tuning_cents", kTuningCents, 0)));
    voice.name = read_voice_name(json, names);
    voice.pan = number_or(json, "pan", kVoicePan, 0);
  }
  return voices;
}

// A score may pluck by any force: pop_force_n by pop_release_n.
std::string release_name(const ModelParameter& force) {
  return force.name.substr(0, force.name.size() - std::string_view("force_n").size()) + "release_n";
}

bool is_force(const InstrumentModel& model, std::size_t parameter) {
  return parameter < model.controls.size() && model.controls[parameter].quantity == ControlQuantity::kForce;
}

std::vector<std::string> event_keys(const InstrumentModel& model) {
  std::vector<std::string> keys = {"time_s", "voice", "over_s"};
  if (!model.keys.ranges.empty()) keys.insert(keys.end(), {"key", "velocity", "hold_s"});
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const std::string& name = model.parameters[i].name;
    if (std::ranges::find(keys, name) == keys.end()) keys.push_back(name);  // a pluck stands beside its force
    if (i < model.controls.size() && is_force(model, i)) keys.push_back(release_name(model.parameters[i]));
  }
  return keys;
}

// A control that moves to a value, or a pluck: a force that rises and lets go at once. Does one of them happen?
bool read_control(const JsonObject& event, const InstrumentModel& model, std::size_t control, double time,
                  std::span<Voice> voices) {
  const ModelParameter& parameter = model.parameters[control];
  const Range range{parameter.allowed.min, parameter.allowed.max};
  const bool moves = event.has(parameter.name.c_str());
  if (moves) {
    const double to = event.number(parameter.name.c_str(), range), over = number_or(event, "over_s", kEventTime_s, 0);
    for (Voice& voice : voices) voice.glides.push_back({time, over, control, to});
  }
  if (!is_force(model, control)) return moves;
  const std::string release = release_name(parameter);
  if (!event.has(release.c_str())) return moves;
  if (moves) event.fail(event.key(release), fmt::format("stands beside {}", parameter.name), "one of the two");
  const double force = event.number(release.c_str(), range),
               rise = number_or(event, "over_s", kEventTime_s, kPluckRise_s);
  for (Voice& voice : voices) {
    voice.glides.push_back({time, rise, control, force});
    voice.glides.push_back({time + rise, 0, control, 0});
  }
  return true;
}

// A key that goes down, and after hold_s up.
bool read_note(const JsonObject& event, const InstrumentModel& model, const MidiSettings& tuning, double time,
               std::span<Voice> voices) {
  for (const char* key : {"velocity", "hold_s"})
    if (event.has(key) && !event.has("key")) event.fail(event.key(key), "has no key", "beside key");
  if (!event.has("key")) return false;
  const int key = event.integer("key", 0, 127);
  require_tuned(event, key, tuning.key_cents);
  const auto [played, cents] = tuned_key(key, tuning.key_cents[static_cast<std::size_t>(key)], 0, tuning);
  if (!plays_key(model, played))
    event.fail(event.key("key"), fmt::format("{} plays nothing", key), keys_in_words(model));
  const Note note{time, played, number_or(event, "velocity", {0, 1}, 1),
                  number_or(event, "hold_s", kEventTime_s, std::numeric_limits<double>::infinity()), cents};
  for (Voice& voice : voices) voice.notes.push_back(note);
  return true;
}

void read_event(const JsonObject& event, const InstrumentModel& model, const MidiSettings& tuning, double duration_s,
                std::vector<Voice>& voices) {
  const double time = event.number("time_s", {0, duration_s});
  const auto concerned = voices_of(event, voices);
  bool moves = false, strikes = false;
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    if (const auto played = std::ranges::find(model.events, i, &ModelEvent::parameter);
        played == model.events.end() || played->kind == EventKind::kBow)
      moves |= read_control(event, model, i, time, concerned);
  const bool plays = read_note(event, model, tuning, time, concerned);
  for (const ModelEvent& played : model.events) {
    const ModelParameter& parameter = model.parameters[played.parameter];
    if (played.kind == EventKind::kPluck && model.module != nullptr && event.has(parameter.name.c_str()))
      event.fail(event.key(parameter.name), "plucks, which only keys of a model of your own do", "a key");
    if (played.kind != EventKind::kStrike || !event.has(parameter.name.c_str())) continue;
    strikes = true;
    const double speed = event.number(parameter.name.c_str(), {parameter.allowed.min, parameter.allowed.max});
    for (Voice& voice : concerned)
      voice.strikes.push_back({time, speed, std::numeric_limits<double>::infinity(), played.number});
  }
  if (event.has("over_s") && !moves) event.fail(event.key("over_s"), "glides to nothing", "beside a control");
  if (!moves && !strikes && !plays)
    event.fail(event.key("time_s"), "nothing happens", "beside a control, a strike or a key");
}

// Does a voice play keys, or move what only they have?
bool needs_keys(const Voice& voice) {
  const ModelKeys& keys = voice.model->keys;
  return !voice.notes.empty() || std::ranges::any_of(voice.glides, [&](const Glide& glide) {
    return glide.control == keys.sustain || glide.control == keys.bend;
  });
}

// A score that plays no keys needs no copies for them: one is plucked and struck, as of a file without keys.
void leave_out_keys(Voice& voice) {
  voice.model = without_keys(*voice.model);
  voice.initial.resize(voice.model->parameters.size());
}

}  // namespace

Score parse_midi_on_instrument(std::string_view bytes, std::string_view file, std::span<const int> channels,
                               const InstrumentModel& given, const Tuning& tuning) {
  const InstrumentModel model = with_keys(given);
  if (tuning.is_given() && model.keys.bend == kNoParameter) refuse_tuning(file);
  constexpr int kDrums[] = {kDrumChannel + 1};
  const bool is_drum =
      channels.empty() && given.module == nullptr && !given.keys.ranges.empty() && !given.keys.tune();
  const MidiSong song =
      parse_midi(bytes, file, is_drum ? std::span<const int>(kDrums) : channels, settings_of(model, tuning));
  MidiVoices voices = midi_voices(model, song);
  if (voices.by_channel.empty())
    throw NothingPlayed(fmt::format("{}: MIDI: no note of {} is on {}; allowed: {}, or --channel", file,
                                    is_drum ? "channel 10" : "its channels", model.name, keys_in_words(model)));
  const double duration_s = midi_duration_s(file, voices.end_s);
  Score score{std::string(file), {}, duration_s, {}};
  std::vector<std::string> left_out = left_out_parts(song);
  score.silences_s = song.silences_s;
  score.ring_s = kMidiRing_s;
  if (channels.empty() && song.unchosen > 0)
    left_out.push_back(is_drum ? fmt::format("left out: notes of other channels than 10 ({})", song.unchosen)
                               : left_out_drums(song.unchosen));
  if (!voices.beyond.empty()) left_out.push_back(beyond_in_words(model, voices.beyond));
  if (!left_out.empty()) score.left_out = fmt::format("{}: MIDI: {}", file, fmt::join(left_out, "; "));
  std::set<int> with_voice;
  for (const auto& [channel_and_cents, played] : voices.by_channel) with_voice.insert(channel_and_cents.first);
  for (auto& [channel_and_cents, played] : voices.by_channel) {
    add_programs(model, song, played);
    add_controllers(model, song, channel_and_cents.first, channel_and_cents.second, with_voice, played.voice);
    score.voices.push_back(std::move(played.voice));
  }
  sort_by_time(score.voices);
  return score;
}

Score parse_score_on(const JsonObject& score, std::string_view file, const InstrumentModel& model,
                     const Tuning& tuning) {
  if (tuning.is_given() && !model.keys.tune()) refuse_tuning(file);
  Score result{std::string(file), read_description(score), score.number("duration_s", kScoreDuration_s),
               read_voices(score, model)};
  result.level_db = read_level(score);
  result.oversampling = read_oversampling(score);
  const MidiSettings keys = model.keys.ranges.empty() ? MidiSettings() : settings_of(model, tuning);
  for (const JsonObject& event : score.objects("events", event_keys(model), kMaxEvents))
    read_event(event, model, keys, result.duration_s, result.voices);
  if (model.module == nullptr && std::ranges::none_of(result.voices, [&](const Voice& v) { return needs_keys(v); }))
    for (Voice& voice : result.voices) leave_out_keys(voice);
  sort_by_time(result.voices);
  return result;
}

}  // namespace contactspline
