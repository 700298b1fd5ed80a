// SPDX-License-Identifier: MIT
// contactspline render hammer-string, slide-string, fret-string, instrument: a score to a sound file and a figure.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "generator/cli/commands.hpp"
#include "generator/cli/figures.hpp"
#include "generator/cli/file_ending.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/inputs.hpp"
#include "generator/cli/render_output.hpp"
#include "generator/cli/sound_file.hpp"
#include "generator/player/score_player.hpp"
#include "generator/support/error.hpp"

namespace contactspline {
namespace {

constexpr const char* kTraces[] = {"displacement", "velocity", "bridge force", "contact force",
                                   "velocity of the body"};
constexpr const char* kUnits[] = {"m", "m/s", "N", "N", "m/s"};

Signal signal_of(const ScoreOptions& options, const Score& score) {
  if (options.signal.empty()) return best_signal(score);
  return static_cast<Signal>(std::ranges::find(signal_names(), options.signal) - signal_names().begin());
}

// Index of the output of an instrument file that is played.
std::size_t output_of(const ScoreOptions& options, const Score& score) {
  if (options.signal.empty()) return 0;
  std::vector<std::string> names;
  for (const ModelOutput& output : score.voices.front().model->outputs) names.push_back(output.name);
  const auto found = std::ranges::find(names, options.signal);
  if (found == names.end())
    throw BadInput(
        fmt::format("--signal: '{}' is no output; allowed: {}", shown(options.signal), fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

PlayOptions play_options(const ScoreOptions& options, const Score& score) {
  PlayOptions how{static_cast<double>(options.output.sample_rate_hz)};
  how.precision = options.precision == "single" ? Precision::kSingle : Precision::kDouble;
  if (score.instrument == Instrument::kFile)
    how.output = output_of(options, score);
  else
    how.signal = signal_of(options, score);
  return how;
}

/// What the sound is, in words, and its unit.
struct SoundLabel {
  std::string trace;
  std::string_view unit;
};

SoundLabel label_of(const PlayOptions& how, const Score& score) {
  if (score.instrument != Instrument::kFile)
    return {kTraces[static_cast<std::size_t>(how.signal)], kUnits[static_cast<std::size_t>(how.signal)]};
  const ModelOutput& output = score.voices.front().model->outputs[how.output];
  const auto is_unit = [&](std::string_view ending) { return output.name.ends_with(ending); };
  const std::size_t unit = is_unit("_m_per_s") ? 8 : 2;  // _n, _m
  std::string name = output.name.substr(0, output.name.size() - unit);
  std::ranges::replace(name, '_', ' ');
  return {name, unit_of(output)};
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

// Each voice is played again: the stems of a long score need not fit into memory together.
std::string write_stems(const std::vector<std::filesystem::path>& files, const ScoreOptions& options,
                        const Score& score, PlayOptions how, double scale) {
  if (files.empty()) return {};
  for (std::size_t voice = 0; voice < files.size(); ++voice) {
    how.only_voice = voice;
    Performance stem = play(score, how, show_progress);
    fade_end(stem.samples, stem.channels, stem.sample_rate_hz);
    const std::string file = files[voice].string();
    report_clipping(file, stem.samples, scale);
    write_files(
        {{OutputFile{file, sound_bytes(file, stem.samples, scale, stem.channels, options.output.sample_rate_hz)}}});
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

}  // namespace

// In the order of Signal.
const std::vector<std::string>& signal_names() {
  static const std::vector<std::string> names = {"displacement", "velocity", "bridge", "force", "body"};
  return names;
}

void render_score(Instrument instrument, const ScoreOptions& options) {
  const ScoreSource source = score_argument(options.score, options.channels);
  const Score& score = source.score;
  if (score.instrument != instrument)
    refuse(options.score, "instrument",
           score.instrument == Instrument::kFile ? "the score is for an instrument file"
                                                 : fmt::format("the score is for a {}", name_of(score.instrument)),
           fmt::format("render {}", name_of(score.instrument)));
  require_short(options.score + ": duration_s", score.duration_s, options.output.sample_rate_hz);
  const auto stems = stem_files(options, score);
  require_outputs(options.output, channels_of(score), source.files, stems);
  if (!score.left_out.empty()) std::fputs(fmt::format("contactspline: {}\n", score.left_out).c_str(), stderr);
  const PlayOptions how = play_options(options, score);
  if (how.signal != Signal::kBody && !score.left_out_at_rest.empty())
    std::fputs(fmt::format("contactspline: {}: left out, because only the keys on their body have them: {}\n",
                           options.score, score.left_out_at_rest)
                   .c_str(),
               stderr);
  Performance performance = play(score, how, show_progress);
  report_silence(options.score, performance);
  fade_end(performance.samples, performance.channels, performance.sample_rate_hz);
  const double scale = scale_of(options.output, performance.samples);
  const SoundLabel sound = label_of(how, score);
  const std::string title =
      score.description.empty() ? fmt::format("{} score", name_of(instrument)) : score.description;
  const std::string written =
      write_outputs(options.output,
                    sound_bytes(options.output.sound, performance.samples, scale, performance.channels,
                                options.output.sample_rate_hz),
                    [&](FigureFormat format) {
                      return figure_of(performance, title, fmt::format("{} [{}]", sound.trace, sound.unit), format);
                    });
  write_stdout(fmt::format(
      "{} contacts in {:.4g} s, largest contact force {:.4g} N\nfull scale of the sound: {:.4g} {} ({})\n{}{}",
      performance.contacts, score.duration_s, performance.largest_force_n, 1 / scale, sound.unit, sound.trace,
      written, write_stems(stems, options, score, how, scale)));
}

}  // namespace contactspline
