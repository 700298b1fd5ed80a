// SPDX-License-Identifier: MIT
// contactspline render SCORE: a score to a sound file and a figure.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/file_ending.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/parts.hpp"
#include "generator/cli/render_output.hpp"
#include "generator/cli/sound_file.hpp"
#include "generator/player/score_player.hpp"
#include "generator/spline/design_impact.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr std::string_view kBody = "body";

// The name of an output without its unit: bridge_force.
std::string_view stem_of(const Output& output) {
  const std::string_view name = output.name;
  return name.substr(0, label_of(name).text.size());
}

// What --help calls an output of a key: displacement, force, velocity, bridge.
std::string_view word_of(const Output& output) {
  const std::string_view stem = stem_of(output);
  return stem == "contact_force" ? "force" : stem.substr(0, stem.find('_'));
}

// Is an output meant by its name, by its name without the unit, or by the first word of that?
bool is_called(const Output& output, std::string_view signal) {
  const std::string_view stem = stem_of(output);
  return signal == output.name || signal == stem || stem.starts_with(fmt::format("{}_", signal));
}

// Is the instrument a model of the user's own?
bool is_module(const Score& score) {
  return model_of(score) != nullptr && model_of(score)->module != nullptr;
}

// Is an output the force of contacts alone? A file says so by what the output is the sum of, others by its name.
bool is_contact_force(const Score& score, const Output& output, std::size_t number) {
  const InstrumentModel* model = model_of(score);
  if (model == nullptr || model->module != nullptr)
    return stem_of(output) == "contact_force" || stem_of(output) == "force";
  const ModelOutput& sum = model->outputs[number];
  return sum.quantity == OutputQuantity::kForce && std::ranges::all_of(sum.targets, [&](std::size_t target) {
           return model->connections[target].each.kind == ConnectionKind::kContact;
         });
}

// Chooses the output that the sound is.
void choose_output(const ScoreOptions& options, const Score& score, PlayOptions& how) {
  if (options.signal.empty()) return choose_best_output(score, how);
  const std::vector<Output> outputs = outputs_of(score);
  if (options.signal == kBody && model_of(score) == nullptr) {
    how.is_on_body = true;
    return;
  }
  for (how.output = 0; how.output < outputs.size(); ++how.output) {
    const Output& output = outputs[how.output];
    if (options.signal == "force" ? is_contact_force(score, output, how.output) : is_called(output, options.signal))
      return;
  }
  std::vector<std::string_view> names;
  for (const Output& output : outputs) names.emplace_back(model_of(score) != nullptr ? output.name : word_of(output));
  if (score.body) names.push_back(kBody);
  throw BadInput(
      fmt::format("--signal: '{}' is no output; allowed: {}", shown(options.signal), fmt::join(names, ", ")));
}

PlayOptions play_options(const ScoreOptions& options, const Score& score) {
  PlayOptions how{static_cast<double>(options.output.sample_rate_hz)};
  how.oversampling = options.output.oversampling.value_or(1);
  how.precision = precision_of(score, options.precision == "single" ? Precision::kSingle : Precision::kDouble);
  choose_output(options, score, how);
  return how;
}

/// What the sound is, in words, and its unit.
struct SoundLabel {
  std::string trace;
  std::string unit;
};

// A keyboard's sound may be weighted: the velocity of its body, and that which the force of each key's strings would
// give it.
bool is_weighted(const Score& score) {
  const auto has_weight = [](const KeyParts& key) { return key.output_ratio != 1; };
  return score.listening.pickup_ratio != 1 || score.listening.mobility_m_per_n_s != 0 ||
         std::ranges::any_of(score.keys, has_weight);
}

SoundLabel sound_label(const PlayOptions& how, const Score& score) {
  if (how.is_on_body && !score.ears.empty()) return {"pressure at the ears", "Pa"};
  if (how.is_on_body) return {is_weighted(score) ? "weighted body velocity" : "velocity of the body", "m/s"};
  const Output output = sounding_output(score, how);
  return {label_of(output.name).text, output.unit};
}

/// A part that can be played.
struct PlayedPart {
  std::string name;  ///< of the instrument, of several parts
  Score score;
  PlayOptions how;
  std::vector<MixGains> mix = {};
};

// The name of the instrument or the keyboard.
const std::string& player_of(const Score& score) {
  const InstrumentModel* model = model_of(score);
  return model != nullptr ? model->name : score.voices.front().resonator.name;
}

// The description of a score, or its name and what plays it.
std::string title_of(const ScoreOptions& options, const std::vector<PlayedPart>& parts) {
  if (!parts[0].score.description.empty()) return parts[0].score.description;
  std::vector<std::string> players;
  for (const PlayedPart& part : parts) players.push_back(player_of(part.score));
  return fmt::format("{} ({})", std::filesystem::path(options.score).stem().string(), fmt::join(players, ", "));
}

// How many contacts of an instrument file the recorded force adds up; of others 1.
std::size_t summed_contacts(const Score& score) {
  if (model_of(score) == nullptr || is_module(score)) return 1;
  std::size_t contacts = 0;
  for (const ConnectionGroup& group : model_of(score)->connections)
    if (group.each.kind == ConnectionKind::kContact) contacts += group.gaps_m.size();
  return contacts;
}

// The recorded force is the largest of all voices, and in an instrument file the sum of all contacts.
std::string force_label(const std::vector<PlayedPart>& parts) {
  if (parts.size() > 1) return fmt::format("contact force [N],\\nlargest of {} instruments", parts.size());
  const Score& score = parts[0].score;
  const std::size_t contacts = summed_contacts(score), voices = score.voices.size();
  const std::string whose = voices > 1     ? fmt::format("largest {}of {} voices", contacts > 1 ? "sum " : "", voices)
                            : contacts > 1 ? fmt::format("sum of {} contacts", contacts)
                                           : "";
  return "contact force [N]" + (whose.empty() ? "" : ",\\n" + whose);
}

/// A file of the stems, and what it is the sound of.
struct Stem {
  std::filesystem::path file;
  std::size_t part;
  std::optional<std::size_t> voice = {};  ///< none: all
};

// A file in the folder of the stems for each part, or of one part for each voice, in the format of the sound.
std::vector<Stem> stems_of(const ScoreOptions& options, const std::vector<PlayedPart>& parts) {
  std::vector<Stem> stems;
  if (options.stems.empty()) return stems;
  const auto file_of = [&](const std::string& name) {
    return std::filesystem::path(options.stems) / (name + file_ending(options.output.sound));
  };
  for (std::size_t p = 0; parts.size() > 1 && p < parts.size(); ++p) stems.push_back({file_of(parts[p].name), p});
  if (parts.size() > 1) return stems;
  for (const Voice& voice : parts[0].score.voices) {
    const auto is_refused = [](unsigned char c) { return c == '/' || c < 0x20 || c == 0x7f; };
    if (std::ranges::any_of(voice.name, is_refused))
      refuse(options.score, "--stems", fmt::format("the name of voice '{}' cannot name a file", shown(voice.name)),
             "names without / and control characters");
    stems.push_back({file_of(voice.name), 0, stems.size()});
  }
  return stems;
}

// The end of every sound. With a gain the samples are a measurement, and keep what is too low to be heard.
void finish(Performance& performance, const RenderOutput& output) {
  if (!output.gain_db) high_pass(performance.samples, performance.channels, performance.sample_rate_hz);
  fade_end(performance.samples, performance.channels, performance.sample_rate_hz);
}

// Of several parts each is at its full scale, of one the sound has its unit.
double scale_in(const std::vector<PlayedPart>& parts, const PlayedPart& part) {
  return parts.size() > 1 ? full_scale_of(part.score, part.how) : 1;
}

// Each stem is played again: those of a long score need not fit into memory together.
std::string write_stems(const std::vector<Stem>& stems, const ScoreOptions& options,
                        const std::vector<PlayedPart>& parts, double scale) {
  if (stems.empty()) return {};
  for (const auto& [file, number, voice] : stems) {
    const PlayedPart& part = parts[number];
    PlayOptions how = part.how;
    how.only_voice = voice;
    Performance stem = play(part.score, how, show_progress);
    finish(stem, options.output);
    const double of_part = scale / scale_in(parts, part);
    if (options.output.bits != kFloatBits) report_clipping(file.string(), stem.samples, of_part);
    write_files({{OutputFile{file.string(),
                             sound_bytes(file.string(), std::span<const float>(stem.samples), of_part, stem.channels,
                                         options.output.sample_rate_hz, options.output.bits)}}});
  }
  return fmt::format("stems:  {} in {}\n", stems.size(), options.stems);
}

// A sound without any sound is an error of the score, most likely.
void report_silence(const std::string& score, const Performance& performance) {
  if (std::ranges::any_of(performance.samples, [](float sample) { return sample != 0; })) return;
  const auto* why = performance.contacts == 0 ? "nothing is struck or plucked so that it sounds"
                                              : "the contact or the pickup is where no mode moves";
  std::fputs(fmt::format("contactspline: {}: the sound is silent: {}\n", score, why).c_str(), stderr);
}

/// A score that can be played and written.
struct Prepared {
  ScoreOptions options;
  std::vector<PlayedPart> parts = {};
  std::vector<Stem> stems = {};
  std::vector<std::string> remarks = {};
};

// How long a part sounds: as long as it is told to, or until it has rung out.
void set_length(const ScoreOptions& options, PlayedPart& part) {
  const int rate_hz = options.output.model_rate_hz();
  if (options.tail_s) part.score.duration_s += *options.tail_s - part.score.ring_s;
  require_short(options.score + ": duration_s", part.score.duration_s, rate_hz);
  if (!options.tail_s && part.score.ring_s > 0)
    part.how.max_ring_s = std::min(kLongestRing_s, longest_sound_s(rate_hz) - part.score.duration_s);
}

Prepared prepare(const ScoreOptions& given) {
  const Tuning tuning = tuning_argument(given.tuning, given.keymap, given.a4_hz);
  PartSources sources = read_parts(given.score, parts_argument(given.instruments, given.channels), tuning);
  if (sources.list.size() > 1 && !given.signal.empty())
    throw BadInput("--signal: is for one instrument; allowed: --instrument with one name");
  Prepared prepared{given};
  auto& [options, parts, stems, remarks] = prepared;
  remarks = std::move(sources.remarks);
  std::vector<std::filesystem::path> files;
  int channels = 1;
  if (options.output.sound.empty()) options.output.sound = default_sound(given.score);
  for (auto& [name, source, mix] : sources.list) {
    PlayedPart& part = parts.emplace_back(PlayedPart{std::move(name), std::move(source.score), {0}, std::move(mix)});
    if (!options.output.level_db) options.output.level_db = part.score.level_db;
    if (!options.output.oversampling) options.output.oversampling = part.score.oversampling;
    require_short(options.score + ": duration_s", part.score.duration_s, options.output.model_rate_hz());
    part.how = play_options(options, part.score);
    channels = std::max(channels, channels_of(part.score, part.how, part.mix));
    std::ranges::move(source.files, std::back_inserter(files));
  }
  stems = stems_of(options, parts);
  std::vector<std::filesystem::path> stem_files;
  for (const Stem& stem : stems) stem_files.push_back(stem.file);
  for (const std::string& file : {given.tuning, given.keymap})
    if (!file.empty()) files.emplace_back(file);
  require_outputs(options.output, channels, files, stem_files);
  for (PlayedPart& part : parts) set_length(options, part);
  return prepared;
}

// A line where the contacts of the voices are, on average, too short for the rate.
std::string short_contact_line(const Performance& performance, const PlayOptions& how) {
  if (!(performance.mean_contact_s > 0)) return {};
  const std::string text = short_contact(performance.mean_contact_s, how.sample_rate_hz * how.oversampling);
  return text.empty() ? text : "a contact, on average, " + text + "\n";
}

// Says what of a part is not played, and of what cannot be heard.
void report_left_out(const ScoreOptions& options, const PlayedPart& part) {
  const std::string whose = part.name.empty() ? "" : part.name + ": ";
  if (!part.score.left_out.empty())
    std::fputs(fmt::format("contactspline: {}{}\n", whose, part.score.left_out).c_str(), stderr);
  if (!part.how.is_on_body && !part.score.left_out_at_rest.empty())
    std::fputs(fmt::format("contactspline: {}{}: left out, because only the keys on their body have them: {}\n",
                           whose, options.score, part.score.left_out_at_rest)
                   .c_str(),
               stderr);
}

// The sound of a part as it is written, without its scale. Its stems have the same length.
Performance play_part(const ScoreOptions& options, PlayedPart& part, const Progress& progress) {
  report_left_out(options, part);
  Performance performance = play(part.score, part.how, progress);
  part.how.max_ring_s = 0;
  part.score.duration_s =
      static_cast<double>(performance.samples.size()) / performance.channels / part.how.sample_rate_hz;
  report_silence(part.name.empty() ? options.score : options.score + ": " + part.name, performance);
  finish(performance, options.output);
  return performance;
}

// The only part, or the sum of all of them, each at its full scale; as they are mixed.
Performance play_parts(const ScoreOptions& options, std::vector<PlayedPart>& parts) {
  if (parts.size() == 1 && parts[0].mix.empty()) return play_part(options, parts[0], show_progress);
  Performance sum{static_cast<double>(options.output.sample_rate_hz), 1, {}, {}, 0, 0};
  for (const PlayedPart& part : parts)
    sum.channels = std::max(sum.channels, channels_of(part.score, part.how, part.mix));
  for (std::size_t p = 0; p < parts.size(); ++p)
    add_part(sum,
             play_part(options, parts[p],
                       [&](double done) {
                         show_progress((static_cast<double>(p) + done) / static_cast<double>(parts.size()));
                       }),
             scale_in(parts, parts[p]), parts[p].mix);
  return sum;
}

SoundLabel sound_label(const std::vector<PlayedPart>& parts) {
  if (parts.size() == 1) return sound_label(parts[0].how, parts[0].score);
  return {"sum of instruments", "1"};
}

// What the sound file is scaled by: for each part, what it plays as 1.
std::string scale_line(const std::vector<PlayedPart>& parts, double scale) {
  std::vector<std::string> words;
  for (const PlayedPart& part : parts) {
    const SoundLabel label = sound_label(part.how, part.score);
    words.push_back(fmt::format("{:.4g} {} ({}{}{})", scale_in(parts, part) / scale, label.unit, part.name,
                                part.name.empty() ? "" : ": ", label.trace));
  }
  return fmt::format("full scale of the sound: {}\n", fmt::join(words, ", "));
}

std::string contact_lines(const std::vector<PlayedPart>& parts, const Performance& performance) {
  if (std::ranges::all_of(parts, [](const PlayedPart& part) { return summed_contacts(part.score) == 0; })) return {};
  const double seconds =
      static_cast<double>(performance.samples.size()) / performance.channels / performance.sample_rate_hz;
  const bool is_sum =
      std::ranges::any_of(parts, [](const PlayedPart& part) { return summed_contacts(part.score) > 1; });
  const std::size_t voices =
      std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                      [](std::size_t sum, const PlayedPart& part) { return sum + part.score.voices.size(); });
  return (is_sum ? fmt::format("{}in contact for {:.3g} s of {:.4g} s, largest sum of contact forces {:.4g} N\n",
                               voices > 1 ? fmt::format("{} voices together ", voices) : "", performance.contact_s,
                               seconds, performance.largest_force_n)
                 : fmt::format("{} contacts in {:.4g} s, largest contact force {:.4g} N\n", performance.contacts,
                               seconds, performance.largest_force_n)) +
         short_contact_line(performance, parts[0].how);
}

void render(Prepared& prepared) {
  auto& [options, parts, stems, remarks] = prepared;
  for (const std::string& remark : remarks) std::fputs(fmt::format("contactspline: {}\n", remark).c_str(), stderr);
  const Performance performance = play_parts(options, parts);
  const double scale = scale_of(options.output, performance.samples);
  const SoundLabel sound = sound_label(parts);
  const PerformanceText text{
      title_of(options, parts),
      fmt::format("{} [{}]{}", sound.trace, sound.unit, performance.channels > 1 ? ",\\nmean of both channels" : ""),
      force_label(parts)};
  const std::string written =
      write_outputs(options.output,
                    sound_bytes(options.output.sound, std::span<const float>(performance.samples), scale,
                                performance.channels, options.output.sample_rate_hz, options.output.bits),
                    [&](FigureFormat format) { return figure_of(performance, text, format); });
  write_stdout(contact_lines(parts, performance) + scale_line(parts, scale) + written +
               write_stems(stems, options, parts, scale));
}

// What names one file cannot be for several scores, and two of them cannot be one.
void require_one_score_each(const ScoreOptions& given) {
  if (given.scores.size() < 2) return;
  for (const auto& [option, value] :
       {std::pair{"--output", given.output.sound}, {"--figure", given.output.figure}, {"--stems", given.stems}})
    if (!value.empty())
      throw BadInput(
          fmt::format("{}: is for one score, not for {}; allowed: with one SCORE", option, given.scores.size()));
  std::set<std::string> sounds;
  for (const std::string& score : given.scores)
    if (const std::string sound = default_sound(score); !sounds.insert(sound).second)
      throw BadInput(
          fmt::format("{}: two scores would be written to it; allowed: scores with different names", sound));
}

}  // namespace

void render_scores(const ScoreOptions& given) {
  require_one_score_each(given);
  std::vector<Prepared> all;
  for (const std::string& score : given.scores) {
    ScoreOptions options = given;
    options.score = score;
    all.push_back(prepare(options));
  }
  for (Prepared& prepared : all) render(prepared);
}

}  // namespace contactspline
