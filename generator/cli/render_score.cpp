// SPDX-License-Identifier: MIT
// contactspline render hammer-string, slide-string, fret-string: a score to a sound file and a picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "generator/cli/allowed.hpp"
#include "generator/cli/output.hpp"
#include "generator/cli/picture.hpp"
#include "generator/cli/render_output.hpp"
#include "generator/cli/score_argument.hpp"
#include "generator/cli/wav.hpp"
#include "generator/error.hpp"
#include "generator/play.hpp"

namespace contactspline {
namespace {

/// Words of --signal, in the order of Signal.
const std::vector<std::string> kSignals = {"displacement", "velocity", "bridge", "force"};
constexpr const char* kTraces[] = {"displacement", "velocity", "bridge force", "contact force"};
constexpr const char* kUnits[] = {"m", "m/s", "N", "N"};

struct ScoreOptions {
  std::string score;
  int sample_rate_hz = 44100;
  std::string signal;
  std::string precision = "double";
  std::string output;
  std::string svg;
};

Signal signal_of(const ScoreOptions& options, const Score& score) {
  if (options.signal.empty()) return best_signal(score);
  return static_cast<Signal>(std::ranges::find(kSignals, options.signal) - kSignals.begin());
}

PlayOptions play_options(const ScoreOptions& options, const Score& score) {
  return {static_cast<double>(options.sample_rate_hz), signal_of(options, score),
          options.precision == "single" ? Precision::kSingle : Precision::kDouble};
}

float peak_of(const Performance& performance) {
  float peak = 0;
  for (const float sample : performance.samples) peak = std::max(peak, std::abs(sample));
  return peak;
}

void render_score(Instrument instrument, const ScoreOptions& options) {
  const ScoreSource source = score_argument(options.score);
  const Score& score = source.score;
  if (score.instrument != instrument)
    throw BadInput(fmt::format("{}: instrument: it is for {}; allowed: {}", options.score, name_of(score.instrument),
                               name_of(instrument)));
  require_short(options.score + ": duration_s", score.duration_s, options.sample_rate_hz);
  const std::string svg = picture_beside(options.output, options.svg);
  require_distinct({{options.output, svg}}, source.files);
  const PlayOptions how = play_options(options, score);
  const Performance performance = play(score, how, show_progress);
  const double peak = peak_of(performance);
  const auto signal = static_cast<std::size_t>(how.signal);
  const std::string title =
      score.description.empty() ? fmt::format("{} score", name_of(instrument)) : score.description;
  const std::vector<OutputFile> files = {
      {options.output,
       wav_bytes(performance.samples, scale_to_peak(peak), performance.channels, options.sample_rate_hz)},
      {svg, picture_of(performance, title, fmt::format("{} [{}]", kTraces[signal], kUnits[signal]))}};
  write_files(files);
  write_stdout(
      fmt::format("{} contacts in {:.4g} s, largest force {:.4g} N\nfull scale of the sound: {:.4g} {}\nsound:   "
                  "{}\npicture: {}\n",
                  performance.contacts, score.duration_s, performance.largest_force_n, peak / kPeak, kUnits[signal],
                  options.output, svg));
}

void add_instrument(CLI::App& render, Instrument instrument, const char* help, const char* example) {
  const auto options = std::make_shared<ScoreOptions>();
  CLI::App* command = render.add_subcommand(std::string(name_of(instrument)), help);
  command->add_option("--score", options->score, kScoreHelp)->check(not_empty(kScoreHelp))->required();
  command->add_option("--rate", options->sample_rate_hz, "sample rate in Hz")
      ->check(number_from(1000, 768000))
      ->capture_default_str();
  command
      ->add_option("--signal", options->signal,
                   "what is heard: displacement or velocity at the pickup, force on the bridge, contact force "
                   "(default: bridge for hammers on strings, else velocity)")
      ->check(one_of(kSignals));
  command->add_option("--precision", options->precision, "of the model's numbers")
      ->check(one_of({"single", "double"}))
      ->capture_default_str();
  add_outputs(*command, options->output, options->svg);
  command->footer(fmt::format(
      "Example:\n  contactspline render {} --score {} -o out.wav\nThe scores that ship: contactspline scores",
      name_of(instrument), example));
  command->callback([options, instrument] { render_score(instrument, *options); });
}

}  // namespace

void add_render_score(CLI::App& render) {
  add_instrument(render, Instrument::kHammerString, "Felt hammers on strings, bars or drums, played from a score",
                 "dulcimer");
  add_instrument(render, Instrument::kSlideString, "Strings with a slide, plucked, played from a score",
                 "slide_guitar");
  add_instrument(render, Instrument::kFretString, "Plucked strings that buzz against a fret, played from a score",
                 "fret_buzz");
}

}  // namespace contactspline
