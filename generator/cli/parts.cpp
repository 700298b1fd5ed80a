// SPDX-License-Identifier: MIT
#include "generator/cli/parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>
#include <ranges>
#include <set>
#include <utility>

#include "contactspline/data/model_parameters.hpp"
#include "contactspline/host/model_module.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr int kChannels = 16, kDrums = 10;
constexpr const char* kOthers = "*";
constexpr std::size_t kColumns = 1200;  // of the forces of a sum

[[noreturn]] void refuse_part(std::string_view wrong, std::string_view allowed) {
  throw BadInput(fmt::format("--instrument: {}; allowed: {}", wrong, allowed));
}

// What stands between commas.
std::vector<std::string> items_of(std::span<const std::string> lists) {
  std::vector<std::string> items;
  for (const std::string& list : lists)
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
      end = list.find(',', begin);
      items.push_back(list.substr(begin, end - begin));
    }
  return items;
}

// The channel before a name, or nothing for the others.
std::optional<int> channel_of(const std::string& given, const std::string& channel) {
  if (channel == kOthers) return std::nullopt;
  int number = 0;
  const auto [end, error] = std::from_chars(channel.data(), channel.data() + channel.size(), number);
  if (error != std::errc() || end != channel.data() + channel.size() || number < 1 || number > kChannels)
    refuse_part(fmt::format("'{}' names no channel", shown(given)), "1 to 16 or * before =, such as 10=kit");
  return number;
}

// All channels that no part names, without that of drums.
std::vector<int> other_channels(std::span<const Part> parts) {
  std::vector<int> others;
  for (int channel = 1; channel <= kChannels; ++channel)
    if (channel != kDrums &&
        std::ranges::none_of(parts, [=](const Part& part) { return std::ranges::count(part.channels, channel) > 0; }))
      others.push_back(channel);
  return others;
}

// The part of an instrument, which is made if there is none.
Part& part_of(std::vector<Part>& parts, const std::string& instrument) {
  const auto found = std::ranges::find(parts, instrument, &Part::instrument);
  return found != parts.end() ? *found : parts.emplace_back(Part{instrument, {}});
}

// A part's score, without the tuning if it has no pitch.
ScoreSource read_part(const std::string& score, const Part& part, const Tuning& tuning) {
  try {
    return score_argument(score, part.channels, part.instrument, tuning);
  } catch (const NothingTuned&) {
    return score_argument(score, part.channels, part.instrument, {});
  }
}

bool has_notes(const Part& part, const std::map<int, std::size_t>& notes) {
  return std::ranges::any_of(part.channels, [&](int channel) { return notes.contains(channel); });
}

// A line on the channels that have notes and no part, or nothing.
std::vector<std::string> remark_on_others(const std::string& score, const Parts& parts,
                                          std::map<int, std::size_t> notes) {
  for (const Part& part : parts.list)
    for (const int channel : part.channels) notes.erase(channel);
  std::vector<std::string> others;
  for (const auto& [channel, count] : notes) others.push_back(fmt::format("{} ({})", channel, count));
  if (others.empty()) return {};
  return {fmt::format("{}: MIDI: left out: notes of channels that --instrument does not name: {}", score,
                      fmt::join(others, ", "))};
}

// The largest forces of a sound of one length as those of another length.
std::vector<float> forces_over(std::span<const float> forces, std::size_t samples, std::size_t all) {
  std::vector<float> columns(kColumns);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const double middle = (static_cast<double>(i) + 0.5) * static_cast<double>(samples) /
                          (static_cast<double>(forces.size()) * static_cast<double>(all));
    float& largest = columns[std::min(static_cast<std::size_t>(middle * kColumns), columns.size() - 1)];
    largest = std::max(largest, forces[i]);
  }
  return columns;
}

}  // namespace

Parts parts_argument(std::span<const std::string> instruments, const std::vector<int>& channels) {
  if (instruments.empty()) return {{{"", channels}}};
  if (instruments.size() == 1 && instruments[0].find('=') == std::string::npos) return {{{instruments[0], channels}}};
  if (!channels.empty())
    throw BadInput("--channel: stands beside the channels of --instrument; allowed: one of the two");
  std::vector<Part> parts;
  std::optional<std::string> others;
  std::set<int> named;
  for (const std::string& given : items_of(instruments)) {
    const std::size_t at = given.find('=');
    const std::string name = at == std::string::npos ? given : given.substr(at + 1);
    if (name.empty()) refuse_part(fmt::format("'{}' names no instrument", shown(given)), "such as 1=piano");
    const auto channel = channel_of(given, at == std::string::npos ? kOthers : given.substr(0, at));
    if (channel ? !named.insert(*channel).second : others.has_value())
      refuse_part(channel ? fmt::format("channel {} has two instruments", *channel)
                          : std::string("the other channels have two instruments"),
                  "one for each, such as 1=piano,2=cello");
    if (channel)
      part_of(parts, name).channels.push_back(*channel);
    else
      others = name;
  }
  if (others) {
    const std::vector<int> rest = other_channels(parts);
    Part& part = part_of(parts, *others);
    part.channels.insert(part.channels.end(), rest.begin(), rest.end());
  }
  return {std::move(parts), true};
}

PartSources read_parts(const std::string& score, const Parts& parts, const Tuning& tuning) {
  const auto midi = parts.by_channel ? midi_bytes(score) : std::nullopt;
  if (!midi) return {{{"", score_argument(score, parts.list[0].channels, parts.list[0].instrument, tuning)}}, {}};
  const std::map<int, std::size_t> notes = notes_by_channel(*midi, score);
  PartSources read;
  std::string nothing;
  for (const Part& part : parts.list) try {
      read.list.push_back({std::filesystem::path(part.instrument).stem().string(), read_part(score, part, tuning)});
    } catch (const NothingPlayed& error) {
      nothing = error.what();
      read.remarks.push_back(has_notes(part, notes)
                                 ? nothing
                                 : fmt::format("{}: MIDI: no note is on channel {}, which {} plays", score,
                                               fmt::join(part.channels, ", "), shown(part.instrument)));
    }
  if (std::ranges::none_of(parts.list, [&](const Part& part) { return has_notes(part, notes); }))
    refuse_part(fmt::format("{} has no note on these channels", score),
                fmt::format("channels {}", fmt::join(std::views::keys(notes), ", ")));
  if (read.list.empty()) throw BadInput(nothing);
  std::ranges::move(remark_on_others(score, parts, notes), std::back_inserter(read.remarks));
  return read;
}

Precision precision_of(const Score& score, Precision asked) {
  const ModelModule* module = score.model == Model::kFile ? score.voices.front().model->module : nullptr;
  if (module == nullptr) return asked;
  return module->make_single != nullptr ? Precision::kSingle : Precision::kDouble;
}

double full_scale_of(const Score& score, const PlayOptions& how) {
  if (!how.is_on_body) return outputs_of(score)[how.output].full_scale;
  return (score.ears.empty() ? KeyboardParameter::kOutputs : KeyboardParameter::kPressureOutputs)[0].full_scale;
}

void add_part(Performance& sum, const Performance& part, double full_scale) {
  const auto channels = static_cast<std::size_t>(sum.channels), of_part = static_cast<std::size_t>(part.channels);
  const std::size_t before = sum.samples.size() / channels, frames = part.samples.size() / of_part,
                    all = std::max(before, frames);
  sum.samples.resize(all * channels);
  for (std::size_t n = 0; n < frames; ++n)
    for (std::size_t side = 0; side < channels; ++side)
      sum.samples[n * channels + side] +=
          static_cast<float>(part.samples[n * of_part + std::min(side, of_part - 1)] / full_scale);
  sum.force_n = forces_over(sum.force_n, before, all);
  const std::vector<float> added = forces_over(part.force_n, frames, all);
  for (std::size_t i = 0; i < kColumns; ++i) sum.force_n[i] = std::max(sum.force_n[i], added[i]);
  sum.largest_force_n = std::max(sum.largest_force_n, part.largest_force_n);
  sum.contacts += part.contacts;
  if (part.mean_contact_s > 0)
    sum.mean_contact_s =
        sum.mean_contact_s > 0 ? std::min(sum.mean_contact_s, part.mean_contact_s) : part.mean_contact_s;
}

}  // namespace contactspline
