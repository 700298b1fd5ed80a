// SPDX-License-Identifier: MIT
#include "generator/cli/parts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <compare>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "contactspline/data/model_parameters.hpp"
#include "contactspline/host/model_module.hpp"
#include "generator/player/midi_reader.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr int kChannels = 16, kDrums = 10, kPrograms = 128;
constexpr const char* kOthers = "*";
constexpr std::size_t kColumns = 1200;  // of the forces of a sum

[[noreturn]] void refuse_part(std::string_view wrong, std::string_view allowed) {
  throw BadInput(fmt::format("--instrument: {}; allowed: {}", wrong, allowed));
}

bool is_existing_file(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

// What stands between commas, but for those in the path of a file.
std::vector<std::string> items_of(std::span<const std::string> lists) {
  std::vector<std::string> items;
  for (const std::string& list : lists)
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
      end = is_existing_file(list) ? std::string::npos : list.find(',', begin);
      items.push_back(list.substr(begin, end - begin));
    }
  return items;
}

// Is an item a channel and a name, with = between them?
bool names_channel(const std::string& item) {
  return item.find('=') != std::string::npos && !is_existing_file(item);
}

// A whole text as a number from 1 to `most`, or nothing.
std::optional<int> number_of(std::string_view text, int most) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_read = error == std::errc() && end == text.data() + text.size();
  return is_read && number >= 1 && number <= most ? std::optional(number) : std::nullopt;
}

// The part of an instrument, which is made if there is none.
Part& part_of(std::vector<Part>& parts, const std::string& instrument) {
  const auto found = std::ranges::find(parts, instrument, &Part::instrument);
  return found != parts.end() ? *found : parts.emplace_back(Part{instrument, {}});
}

// What stands before a name: a channel, a program, or all others.
struct Plays {
  enum class Kind { kChannel, kProgram, kRest } kind = Kind::kRest;
  int number = 0;
  auto operator<=>(const Plays&) const = default;
};

Plays plays_argument(const std::string& what, const std::string& name) {
  if (what == kOthers) return {};
  if (const auto channel = number_of(what, kChannels)) return {Plays::Kind::kChannel, *channel};
  if (const auto program = what.starts_with('p') ? number_of(what.substr(1), kPrograms) : std::nullopt)
    return {Plays::Kind::kProgram, *program};
  refuse_part(fmt::format("'{}' names no channel", shown(what + "=" + name)),
              "1 to 16, p1 to p128 for programs, or * before =, such as 10=kit");
}

void give(const Plays& plays, Part& part) {
  if (plays.kind == Plays::Kind::kChannel) part.channels.push_back(plays.number);
  if (plays.kind == Plays::Kind::kProgram) part.programs.push_back(plays.number);
  if (plays.kind == Plays::Kind::kRest) part.has_others = true;
}

// The part that plays a channel: by its number, else by its program, else with all others; or null.
Part* player_of(std::vector<Part>& parts, int channel, const MidiUse& use) {
  const auto find = [&](const auto& plays) {
    const auto found = std::ranges::find_if(parts, plays);
    return found == parts.end() ? nullptr : &*found;
  };
  const auto has = [](const std::vector<int>& list, int number) { return std::ranges::count(list, number) > 0; };
  if (Part* part = find([&](const Part& each) { return has(each.channels, channel); })) return part;
  if (channel == kDrums) return nullptr;
  if (Part* part = find([&](const Part& each) { return has(each.programs, use.program + 1); })) return part;
  return find([](const Part& part) { return part.has_others; });
}

// What a part without notes was to play.
std::string wanted_of(const Part& part) {
  std::vector<std::string> wanted;
  if (!part.channels.empty()) wanted.push_back(fmt::format("channel {}", fmt::join(part.channels, ", ")));
  if (!part.programs.empty()) wanted.push_back(fmt::format("program {}", fmt::join(part.programs, ", ")));
  if (part.has_others) wanted.emplace_back("another channel");
  return fmt::format("{}", fmt::join(wanted, ", "));
}

// The parts with the channels that have notes, in place of their programs and others.
std::vector<Part> with_channels(std::vector<Part> parts, const std::map<int, MidiUse>& uses) {
  std::vector<Part> played = parts;
  for (Part& part : played) part.channels.clear();
  for (const auto& [channel, use] : uses)
    if (const Part* part = player_of(parts, channel, use))
      played[static_cast<std::size_t>(part - parts.data())].channels.push_back(channel);
  return played;
}

bool moves_a_parameter(const Score& score, int controller) {
  const InstrumentModel* model = model_of(score);
  return model != nullptr && std::ranges::count(model->parameters, controller, &ModelParameter::controller) > 0;
}

/// Reads the parts of a MIDI file.
struct PartReader {
  const std::string& score;
  const Tuning& tuning;
  std::vector<MidiFileMessage> messages;
  PartSources read = {};
  std::vector<std::string> untuned = {};  ///< the error of each part without a pitch, which is one where all are

  // Without the tuning if the part has no pitch. Without channels nothing is played: there is no channel 0.
  ScoreSource source_of(const Part& part) {
    const std::vector<int> channels = part.channels.empty() ? std::vector{0} : part.channels;
    try {
      return score_argument(score, channels, part.instrument, tuning);
    } catch (const NothingTuned& error) {
      ScoreSource source = score_argument(score, channels, part.instrument, {});
      untuned.emplace_back(error.what());
      return source;
    }
  }

  // A part with the channels that it plays, or a remark that it has no notes. given: with what its user gave it.
  void add(const Part& part, const Part& given) {
    try {
      ScoreSource source = source_of(part);
      auto mix = mix_of(messages, part.channels,
                        [&](int controller) { return !moves_a_parameter(source.score, controller); });
      read.list.push_back(
          {std::filesystem::path(part.instrument).stem().string(), std::move(source), std::move(mix)});
    } catch (const NothingPlayed& error) {
      read.remarks.push_back(part.channels.empty() ? fmt::format("{}: MIDI: no note is on {}, which {} plays", score,
                                                                 wanted_of(given), shown(part.instrument))
                                                   : error.what());
    }
  }
};

std::vector<int> channels_of(const std::map<int, MidiUse>& uses) {
  std::vector<int> channels;
  for (const auto& [channel, use] : uses) channels.push_back(channel);
  return channels;
}

// A line on the channels that have notes and no part, or nothing.
std::vector<std::string> remark_on_others(const std::string& score, std::span<const Part> parts,
                                          std::map<int, MidiUse> uses) {
  for (const Part& part : parts)
    for (const int channel : part.channels) uses.erase(channel);
  std::vector<std::string> others;
  for (const auto& [channel, use] : uses) others.push_back(fmt::format("{} ({})", channel, use.notes));
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

Parts parts_by_channel(std::span<const std::pair<std::string, std::string>> list) {
  std::vector<Part> parts;
  std::set<Plays> given;
  for (const auto& [what, name] : list) {
    if (name.empty())
      refuse_part(fmt::format("'{}' names no instrument", shown(what == kOthers ? "" : what + "=")),
                  "such as 1=piano");
    const Plays plays = plays_argument(what, name);
    if (!given.insert(plays).second)
      refuse_part(fmt::format("'{}' has two instruments", shown(what)), "one for each, such as 1=piano,2=cello");
    give(plays, part_of(parts, name));
  }
  return {std::move(parts), true};
}

Parts parts_argument(std::span<const std::string> instruments, const std::vector<int>& channels) {
  if (instruments.empty()) return {{{"", channels}}};
  if (instruments.size() == 1 && !names_channel(instruments[0])) return {{{instruments[0], channels}}};
  if (!channels.empty())
    throw BadInput("--channel: stands beside the channels of --instrument; allowed: one of the two");
  std::vector<std::pair<std::string, std::string>> list;
  for (const std::string& item : items_of(instruments)) {
    const std::size_t at = item.find('=');
    if (names_channel(item))
      list.emplace_back(item.substr(0, at), item.substr(at + 1));
    else
      list.emplace_back(kOthers, item);
  }
  return parts_by_channel(list);
}

PartSources read_parts(const std::string& score, const Parts& parts, const Tuning& tuning) {
  const auto midi = parts.by_channel ? midi_bytes(score) : std::nullopt;
  if (!midi) {
    const Part all = parts.by_channel ? Part{} : parts.list[0];
    PartSources one{{{"", score_argument(score, all.channels, all.instrument, tuning)}}, {}};
    if (parts.by_channel)
      refuse(score, "--instrument", "the score is not a MIDI file", "no --instrument, or a .mid file");
    return one;
  }
  PartReader reader{score, tuning, read_midi_file(*midi, score).messages};
  const std::map<int, MidiUse> uses = midi_uses(reader.messages);
  const std::vector<Part> played = with_channels(parts.list, uses);
  for (std::size_t p = 0; p < played.size(); ++p) reader.add(played[p], parts.list[p]);
  auto& [list, remarks] = reader.read;
  if (list.empty() && std::ranges::all_of(played, [](const Part& part) { return part.channels.empty(); }))
    refuse_part(fmt::format("no channel that it names has a note in {}", score),
                fmt::format("channels {}", fmt::join(channels_of(uses), ", ")));
  if (list.empty()) throw BadInput(remarks.back());
  if (!reader.untuned.empty() && reader.untuned.size() == list.size()) throw BadInput(reader.untuned.front());
  std::ranges::move(remark_on_others(score, played, uses), std::back_inserter(remarks));
  return std::move(reader.read);
}

int channels_of(const Score& score, const PlayOptions& options, std::span<const MixGains> mix) {
  const bool is_aside = std::ranges::any_of(mix, [](const MixGains& gains) { return gains.left != gains.right; });
  return is_aside ? 2 : channels_of(score, options);
}

Precision precision_of(const Score& score, Precision asked) {
  const InstrumentModel* model = model_of(score);
  if (model == nullptr || model->module == nullptr) return asked;
  return model->module->make_single != nullptr ? Precision::kSingle : Precision::kDouble;
}

double full_scale_of(const Score& score, const PlayOptions& how) {
  if (!how.is_on_body) return outputs_of(score)[how.output].full_scale;
  return (score.ears.empty() ? KeyboardParameter::kOutputs : KeyboardParameter::kPressureOutputs)[0].full_scale;
}

void add_part(Performance& sum, const Performance& part, double full_scale, std::span<const MixGains> mix) {
  const auto channels = static_cast<std::size_t>(sum.channels), of_part = static_cast<std::size_t>(part.channels);
  const std::size_t before = sum.samples.size() / channels, frames = part.samples.size() / of_part,
                    all = std::max(before, frames);
  sum.samples.resize(all * channels);
  MixGlide glide(mix, part.sample_rate_hz);
  for (std::size_t n = 0; n < frames; ++n) {
    const auto [left, right] = glide.next();
    for (std::size_t side = 0; side < channels; ++side)
      sum.samples[n * channels + side] += static_cast<float>(part.samples[n * of_part + std::min(side, of_part - 1)] *
                                                             (side == 0 ? left : right) / full_scale);
  }
  sum.force_n = forces_over(sum.force_n, before, all);
  const std::vector<float> added = forces_over(part.force_n, frames, all);
  for (std::size_t i = 0; i < kColumns; ++i) sum.force_n[i] = std::max(sum.force_n[i], added[i]);
  sum.largest_force_n = std::max(sum.largest_force_n, part.largest_force_n);
  sum.contacts += part.contacts;
  sum.contact_s += part.contact_s;
  if (part.mean_contact_s > 0)
    sum.mean_contact_s =
        sum.mean_contact_s > 0 ? std::min(sum.mean_contact_s, part.mean_contact_s) : part.mean_contact_s;
}

}  // namespace contactspline
