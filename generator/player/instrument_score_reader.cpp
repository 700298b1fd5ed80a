// SPDX-License-Identifier: MIT
#include "generator/player/instrument_score_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "generator/instrument/instrument_reader.hpp"
#include "generator/material/named_file.hpp"
#include "generator/player/score_keys.hpp"
#include "generator/resonator/resonator_reader.hpp"

namespace contactspline {
namespace {

constexpr Range kSpeed{-100, 100};

// pop_force_n becomes pop_release_n.
std::string release_name(const ModelControl& control) {
  return control.name.substr(0, control.name.size() - std::string_view("force_n").size()) + "release_n";
}

Voice voice_of(const InstrumentModel& model, double tuning_cents) {
  Voice voice;
  voice.name = model.name;
  voice.model = model;
  tune(*voice.model, tuning_cents);
  for (const ModelControl& control : model.controls) voice.initial.push_back(control.initial);
  return voice;
}

std::vector<Voice> read_voices(const JsonObject& score, const InstrumentModel& model) {
  if (!score.has("voices")) return {voice_of(model, 0)};
  std::vector<Voice> voices;
  std::set<std::string> names;
  for (const JsonObject& json : score.objects("voices", {"name", "tuning_cents", "pan"}, kMaxVoices)) {
    Voice& voice = voices.emplace_back(voice_of(model, number_or(json, "tuning_cents", kTuningCents, 0)));
    voice.name = read_voice_name(json, names);
    voice.pan = number_or(json, "pan", kVoicePan, 0);
  }
  return voices;
}

std::vector<std::string> event_keys(const InstrumentModel& model) {
  std::vector<std::string> keys = {"time_s", "voice", "over_s"};
  for (const ModelControl& control : model.controls) {
    keys.push_back(control.name);
    if (control.quantity == ControlQuantity::kForce) keys.push_back(release_name(control));
  }
  for (std::size_t i = 0; i < model.strikes.size(); ++i) keys.push_back(strike_name(model, i));
  return keys;
}

// A control that moves to a value, or a pluck: a force that rises and lets go at once. Does one of them happen?
bool read_control(const JsonObject& event, const InstrumentModel& model, std::size_t control, double time,
                  std::span<Voice> voices) {
  const ModelControl& of = model.controls[control];
  const Range range = of.range;
  const bool moves = event.has(of.name.c_str());
  if (moves) {
    const double to = event.number(of.name.c_str(), range), over = number_or(event, "over_s", kEventTime_s, 0);
    for (Voice& voice : voices) voice.glides.push_back({time, over, control, to});
  }
  if (of.quantity != ControlQuantity::kForce || !event.has(release_name(of).c_str())) return moves;
  const std::string key = release_name(of);
  if (moves) event.fail(event.key(key), fmt::format("stands beside {}", of.name), "one of the two");
  const double force = event.number(key.c_str(), range),
               rise = number_or(event, "over_s", kEventTime_s, kPluckRise_s);
  for (Voice& voice : voices) {
    voice.glides.push_back({time, rise, control, force});
    voice.glides.push_back({time + rise, 0, control, 0});
  }
  return true;
}

void read_event(const JsonObject& event, const InstrumentModel& model, double duration_s,
                std::vector<Voice>& voices) {
  const double time = event.number("time_s", {0, duration_s});
  const auto concerned = voices_of(event, voices);
  bool moves = false, strikes = false;
  for (std::size_t i = 0; i < model.controls.size(); ++i) moves |= read_control(event, model, i, time, concerned);
  for (std::size_t i = 0; i < model.strikes.size(); ++i) {
    const std::string key = strike_name(model, i);
    if (!event.has(key.c_str())) continue;
    strikes = true;
    const double speed = event.number(key.c_str(), kSpeed);
    for (Voice& voice : concerned) voice.strikes.push_back({time, speed, std::numeric_limits<double>::infinity(), i});
  }
  if (event.has("over_s") && !moves) event.fail(event.key("over_s"), "glides to nothing", "beside a control");
  if (!moves && !strikes) event.fail(event.key("time_s"), "nothing happens", "beside a control or a strike");
}

}  // namespace

Score parse_instrument_score(const JsonObject& score, std::string_view file, const ReadFile& read) {
  const NamedText named = read_named(score, "instrument", Shipped::kInstruments, read);
  const InstrumentModel model = parse_instrument(named.text, named.file, reader_beside(named, read));
  if (score.has("keyboard")) score.fail("keyboard", "has no place here", "in a score for hammer-string");
  Score result{std::string(file), Instrument::kFile, read_description(score),
               score.number("duration_s", kScoreDuration_s), read_voices(score, model)};
  for (const JsonObject& event : score.objects("events", event_keys(model), kMaxEvents))
    read_event(event, model, result.duration_s, result.voices);
  sort_by_time(result.voices);
  return result;
}

}  // namespace contactspline
