// SPDX-License-Identifier: MIT
#include "generator/cli/output_peaks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "contactspline/data/pluck.hpp"
#include "contactspline/data/timed_event.hpp"
#include "generator/player/instrument_maker.hpp"
#include "generator/player/playing.hpp"

namespace contactspline {
namespace {

constexpr double kPlayed_s = 0.5;

/// What is played, alone.
struct Played {
  std::string name;
  TimedEvent event;
};

std::vector<Played> all_played(const InstrumentModel& model) {
  std::vector<Played> all;
  for (const KeyRange& range : model.keys.ranges)
    for (const int key : {range.first, range.last})
      if (all.empty() || all.back().event.number != static_cast<std::size_t>(key))
        all.push_back({fmt::format("key {}", key), {0, Action::kNoteOn, static_cast<std::size_t>(key), 1, 0}});
  if (!all.empty()) return all;
  for (const ModelEvent& event : model.events)
    all.push_back({event.name, {0, action_of(event.kind), event.number, TimedEvent::kOfParameter, kPluckRise_s}});
  return all;
}

void take(const Played& played, const std::vector<std::vector<float>>& sounds, std::vector<OutputPeak>& peaks) {
  for (std::size_t o = 0; o < peaks.size(); ++o)
    for (const float sample : sounds[o])
      if (std::abs(sample) > peaks[o].peak) peaks[o] = {std::abs(sample), played.name};
}

}  // namespace

std::vector<OutputPeak> output_peaks(const InstrumentModel& model, double sample_rate_hz) {
  std::vector<OutputPeak> peaks(model.outputs.size());
  Voice voice;
  voice.model = model;
  for (const ModelParameter& parameter : model.parameters) voice.initial.push_back(parameter.initial);
  const auto samples = static_cast<std::size_t>(kPlayed_s * sample_rate_hz);
  std::vector<std::vector<float>> sounds(peaks.size(), std::vector<float>(samples));
  const InstrumentMaker maker = maker_of_voice(std::move(voice));
  for (const Played& played : all_played(model)) {
    const auto instrument = maker.make<float>(sample_rate_hz);
    instrument->prepare(sample_rate_hz);
    try {
      render<float>(*instrument, {&played.event, 1}, samples, {{sounds.begin(), sounds.end()}, {}}, [] {});
    } catch (const NotFinite&) {
      continue;  // `render` says so
    }
    take(played, sounds, peaks);
  }
  return peaks;
}

}  // namespace contactspline
