// SPDX-License-Identifier: MIT
// contactspline render SCORE: a score to a sound file and a figure.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
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

// What --help calls an output of a model with parts: displacement, force, velocity, bridge.
std::string_view word_of(const Output& output) {
  const std::string_view stem = stem_of(output);
  return stem == "contact_force" ? "force" : stem.substr(0, stem.find('_'));
}

// Is an output meant by its name, by its name without the unit, or by the first word of that?
bool is_called(const Output& output, std::string_view signal) {
  const std::string_view stem = stem_of(output);
  return signal == output.name || signal == stem || stem.starts_with(fmt::format("{}_", signal));
}

// A model of the user's own that plays, or null.
const ModelModule* module_of(const Score& score) {
  return score.model == Model::kFile ? score.voices.front().model->module : nullptr;
}

// Is an output the force of contacts alone? A file says so by what the output is the sum of, other models by its
// name.
bool is_contact_force(const Score& score, const Output& output, std::size_t number) {
  if (score.model != Model::kFile || module_of(score) != nullptr)
    return stem_of(output) == "contact_force" || stem_of(output) == "force";
  const InstrumentModel& model = *score.voices.front().model;
  const ModelOutput& sum = model.outputs[number];
  return sum.quantity == OutputQuantity::kForce && std::ranges::all_of(sum.targets, [&](std::size_t target) {
           return model.connections[target].each.kind == ConnectionKind::kContact;
         });
}

// Chooses the output that the sound is.
void choose_output(const ScoreOptions& options, const Score& score, PlayOptions& how) {
  if (options.signal.empty()) return choose_best_output(score, how);
  const std::vector<Output> outputs = outputs_of(score);
  if (options.signal == kBody && score.model != Model::kFile) {
    how.is_on_body = true;
    return;
  }
  for (how.output = 0; how.output < outputs.size(); ++how.output) {
    const Output& output = outputs[how.output];
    if (options.signal == "force" ? is_contact_force(score, output, how.output) : is_called(output, options.signal))
      return;
  }
  std::vector<std::string_view> names;
  for (const Output& output : outputs)
    names.emplace_back(score.model == Model::kFile ? output.name : word_of(output));
  if (score.body) names.push_back(kBody);
  throw BadInput(
      fmt::format("--signal: '{}' is no output; allowed: {}", shown(options.signal), fmt::join(names, ", ")));
}

PlayOptions play_options(const ScoreOptions& options, const Score& score) {
  PlayOptions how{static_cast<double>(options.output.sample_rate_hz)};
  how.oversampling = options.output.oversampling.value_or(1);
  how.precision = options.precision == "single" ? Precision::kSingle : Precision::kDouble;
  if (const ModelModule* module = module_of(score))  // it computes in one precision only
    how.precision = module->make_single != nullptr ? Precision::kSingle : Precision::kDouble;
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
  const Output output = outputs_of(score)[how.output];
  return {label_of(output.name).text, output.unit};
}

// What plays a score: an instrument or a keyboard by its name, or a model.
std::string player_of(const Score& score) {
  if (score.model == Model::kFile) return score.voices.front().model->name;
  return score.keys.empty() ? std::string(name_of(score.model)) : score.voices.front().resonator.name;
}

// The description of a score, or its name and what plays it.
std::string title_of(const ScoreOptions& options, const Score& score) {
  if (!score.description.empty()) return score.description;
  return fmt::format("{} ({})", std::filesystem::path(options.score).stem().string(), player_of(score));
}

// How many contacts of an instrument file the recorded force adds up; of other models 1.
std::size_t summed_contacts(const Score& score) {
  if (score.model != Model::kFile || module_of(score) != nullptr) return 1;
  std::size_t contacts = 0;
  for (const ConnectionGroup& group : score.voices.front().model->connections)
    if (group.each.kind == ConnectionKind::kContact) contacts += group.gaps_m.size();
  return contacts;
}

// The recorded force is the largest of all voices, and in an instrument file the sum of all contacts.
std::string force_label(const Score& score) {
  const std::size_t contacts = summed_contacts(score), voices = score.voices.size();
  const std::string whose = voices > 1     ? fmt::format("largest {}of {} voices", contacts > 1 ? "sum " : "", voices)
                            : contacts > 1 ? fmt::format("sum of {} contacts", contacts)
                                           : "";
  return "contact force [N]" + (whose.empty() ? "" : ",\\n" + whose);
}

// A file in the folder of the stems for each voice, in the format of the sound.
std::vector<std::filesystem::path> stem_files(const ScoreOptions& options, const Score& score) {
  std::vector<std::filesystem::path> files;
  if (options.stems.empty()) return files;
  for (const Voice& voice : score.voices) {
    const auto is_refused = [](unsigned char c) { return c == '/' || c < 0x20 || c == 0x7f; };
    if (std::ranges::any_of(voice.name, is_refused))
      refuse(options.score, "--stems", fmt::format("the name of voice '{}' cannot name a file", shown(voice.name)),
             "names without / and control characters");
    files.push_back(std::filesystem::path(options.stems) / (voice.name + file_ending(options.output.sound)));
  }
  return files;
}

// The end of every sound. With a gain the samples are a measurement, and keep what is too low to be heard.
void finish(Performance& performance, const RenderOutput& output) {
  if (!output.gain_db) high_pass(performance.samples, performance.channels, performance.sample_rate_hz);
  fade_end(performance.samples, performance.channels, performance.sample_rate_hz);
}

// Each voice is played again: the stems of a long score need not fit into memory together.
std::string write_stems(const std::vector<std::filesystem::path>& files, const ScoreOptions& options,
                        const Score& score, PlayOptions how, double scale) {
  if (files.empty()) return {};
  for (std::size_t voice = 0; voice < files.size(); ++voice) {
    how.only_voice = voice;
    Performance stem = play(score, how, show_progress);
    finish(stem, options.output);
    const std::string file = files[voice].string();
    if (options.output.bits != kFloatBits) report_clipping(file, stem.samples, scale);
    write_files({{OutputFile{file, sound_bytes(file, std::span<const float>(stem.samples), scale, stem.channels,
                                               options.output.sample_rate_hz, options.output.bits)}}});
  }
  return fmt::format("stems:  {} in {}\n", files.size(), options.stems);
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
  Score score;
  PlayOptions how;
  std::vector<std::filesystem::path> stems;
};

// How long it sounds: as long as it is told to, or until it has rung out.
void set_length(Prepared& prepared) {
  auto& [options, score, how, stems] = prepared;
  const int rate_hz = options.output.model_rate_hz();
  if (options.tail_s) score.duration_s += *options.tail_s - score.ring_s;
  require_short(options.score + ": duration_s", score.duration_s, rate_hz);
  if (!options.tail_s && score.ring_s > 0)
    how.max_ring_s = std::min(kLongestRing_s, longest_sound_s(rate_hz) - score.duration_s);
}

Prepared prepare(std::optional<Model> model, const ScoreOptions& given) {
  const Tuning tuning = tuning_argument(given.tuning, given.keymap, given.a4_hz);
  ScoreSource source = score_argument(given.score, given.channels, given.instrument, tuning);
  Prepared prepared{given, std::move(source.score), {0}, {}};
  auto& [options, score, how, stems] = prepared;
  if (options.output.sound.empty()) options.output.sound = default_sound(given.score);
  if (!options.output.level_db) options.output.level_db = score.level_db;
  if (!options.output.oversampling) options.output.oversampling = score.oversampling;
  if (model && score.model != *model)
    refuse(options.score, "instrument",
           score.model == Model::kFile ? "the score is for an instrument file"
                                       : fmt::format("the score is for a {}", name_of(score.model)),
           fmt::format("render {}", name_of(score.model)));
  require_short(options.score + ": duration_s", score.duration_s, options.output.model_rate_hz());
  stems = stem_files(options, score);
  for (const std::string& file : {given.tuning, given.keymap})
    if (!file.empty()) source.files.emplace_back(file);
  require_outputs(options.output, channels_of(score), source.files, stems);
  how = play_options(options, score);
  set_length(prepared);
  return prepared;
}

// A line where the contacts of the voices are, on average, too short for the rate.
std::string short_contact_line(const Performance& performance, const PlayOptions& how) {
  if (!(performance.mean_contact_s > 0)) return {};
  const std::string text = short_contact(performance.mean_contact_s, how.sample_rate_hz * how.oversampling);
  return text.empty() ? text : "a contact, on average, " + text + "\n";
}

void render(Prepared& prepared) {
  auto& [options, score, how, stems] = prepared;
  if (!score.left_out.empty()) std::fputs(fmt::format("contactspline: {}\n", score.left_out).c_str(), stderr);
  if (!how.is_on_body && !score.left_out_at_rest.empty())
    std::fputs(fmt::format("contactspline: {}: left out, because only the keys on their body have them: {}\n",
                           options.score, score.left_out_at_rest)
                   .c_str(),
               stderr);
  Performance performance = play(score, how, show_progress);
  how.max_ring_s = 0;  // the stems have the same length
  score.duration_s = static_cast<double>(performance.samples.size()) / performance.channels / how.sample_rate_hz;
  report_silence(options.score, performance);
  finish(performance, options.output);
  const double scale = scale_of(options.output, performance.samples);
  const SoundLabel sound = sound_label(how, score);
  const PerformanceText text{
      title_of(options, score),
      fmt::format("{} [{}]{}", sound.trace, sound.unit, performance.channels > 1 ? ",\\nmean of both channels" : ""),
      force_label(score)};
  const std::string written =
      write_outputs(options.output,
                    sound_bytes(options.output.sound, std::span<const float>(performance.samples), scale,
                                performance.channels, options.output.sample_rate_hz, options.output.bits),
                    [&](FigureFormat format) { return figure_of(performance, text, format); });
  const std::string contacts =
      summed_contacts(score) == 0
          ? ""
          : fmt::format("{} contacts in {:.4g} s, largest contact force {:.4g} N\n{}", performance.contacts,
                        score.duration_s, performance.largest_force_n, short_contact_line(performance, how));
  write_stdout(fmt::format("{}full scale of the sound: {:.4g} {} ({})\n{}{}", contacts, 1 / scale, sound.unit,
                           sound.trace, written, write_stems(stems, options, score, how, scale)));
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

void render_scores(std::optional<Model> model, const ScoreOptions& given) {
  require_one_score_each(given);
  std::vector<Prepared> all;
  for (const std::string& score : given.scores) {
    ScoreOptions options = given;
    options.score = score;
    all.push_back(prepare(model, options));
  }
  for (Prepared& prepared : all) render(prepared);
}

}  // namespace contactspline
