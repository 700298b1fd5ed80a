// SPDX-License-Identifier: MIT
#include "generator/cli/render_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

#include "contactspline/step/high_pass.hpp"
#include "generator/cli/figure_file.hpp"
#include "generator/cli/files.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/sound_file.hpp"
#include "generator/cli/system.hpp"
#include "generator/support/error.hpp"
#include "generator/support/input_file.hpp"

namespace contactspline {
namespace {

std::string figure_file(const RenderOutput& output) {
  return output.figure.empty() ? std::filesystem::path(output.sound).replace_extension("svg").string()
                               : output.figure;
}

template <typename T>
void fade(std::span<T> interleaved, std::size_t channels, double sample_rate_hz) {
  constexpr double kFade_s = 0.01;
  const std::size_t frames = interleaved.size() / channels;
  const std::size_t faded = std::min(static_cast<std::size_t>(std::llround(kFade_s * sample_rate_hz)), frames / 2);
  for (std::size_t i = 1; i <= faded; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(faded);
    const double factor = 0.5 * (1 + std::cos(std::numbers::pi * part));
    for (T& sample : interleaved.subspan((frames - faded + i - 1) * channels, channels))
      sample = static_cast<T>(factor * static_cast<double>(sample));
  }
}

template <typename T>
void high_pass_channels(std::span<T> interleaved, std::size_t channels, double sample_rate_hz) {
  constexpr int kSections = 3;  // of second order; their qualities make the product a Butterworth
  std::vector<HighPass<double>> at_rest;
  for (int k = 0; k < kSections; ++k)
    at_rest.emplace_back(kHighPass_hz, sample_rate_hz,
                         0.5 / std::cos(std::numbers::pi * (2 * k + 1) / (4 * kSections)));
  for (std::size_t channel = 0; channel < channels; ++channel) {
    auto sections = at_rest;
    for (std::size_t n = channel; n < interleaved.size(); n += channels) {
      auto sample = static_cast<double>(interleaved[n]);
      for (HighPass<double>& section : sections) sample = section.tick(sample);
      interleaved[n] = static_cast<T>(sample);
    }
  }
}

template <typename T>
void report(const std::string& file, std::span<const T> samples, double scale) {
  const auto clips = [=](T sample) { return scale * std::abs(static_cast<double>(sample)) > 1; };
  if (const auto clipped = std::ranges::count_if(samples, clips); clipped > 0)
    std::fputs(fmt::format("contactspline: {}: {} samples exceed full scale, by {:.1f} dB, and are clipped; a lower "
                           "--gain or --level keeps them\n",
                           file, clipped, 20 * std::log10(scale * peak_of(samples)))
                   .c_str(),
               stderr);
}

template <typename T>
double scale(const RenderOutput& output, std::span<const T> samples) {
  if (!output.gain_db) {
    const double peak = peak_of(samples), level = output.level_db ? std::pow(10, *output.level_db / 20) : kPeak;
    return peak > 0 ? level / peak : 1;
  }
  const double scale = std::pow(10, *output.gain_db / 20);
  if (output.bits != kFloatBits) report(output.sound, samples, scale);
  return scale;
}

}  // namespace

std::string default_sound(const std::string& played) {
  if (played == kStandardInput)
    throw BadInput("--output: missing, and standard input has no name; allowed: a file name, such as -o song.wav");
  return std::filesystem::path(played).filename().replace_extension("wav").string();
}

void high_pass(std::span<float> interleaved, int channels, double sample_rate_hz) {
  high_pass_channels(interleaved, static_cast<std::size_t>(channels), sample_rate_hz);
}

void high_pass(std::span<double> interleaved, int channels, double sample_rate_hz) {
  high_pass_channels(interleaved, static_cast<std::size_t>(channels), sample_rate_hz);
}

void fade_end(std::span<float> interleaved, int channels, double sample_rate_hz) {
  fade(interleaved, static_cast<std::size_t>(channels), sample_rate_hz);
}

void fade_end(std::span<double> samples, double sample_rate_hz) {
  fade(samples, 1, sample_rate_hz);
}

double scale_of(const RenderOutput& output, std::span<const float> samples) {
  return scale(output, samples);
}

double scale_of(const RenderOutput& output, std::span<const double> samples) {
  return scale(output, samples);
}

void report_clipping(const std::string& file, std::span<const float> samples, double scale) {
  report(file, samples, scale);
}

double longest_sound_s(int sample_rate_hz) {
  return 3600.0 * 44100 / sample_rate_hz;
}

void require_short(const std::string& key, double duration_s, int sample_rate_hz) {
  const double samples = duration_s * sample_rate_hz;
  if (duration_s > longest_sound_s(sample_rate_hz))
    throw BadInput(fmt::format("{}: {} s at {} Hz are {:.4g} samples; allowed: at most {:.4g} s at this rate", key,
                               duration_s, sample_rate_hz, samples, longest_sound_s(sample_rate_hz)));
}

void require_outputs(const RenderOutput& output, int channels, const std::vector<std::filesystem::path>& inputs,
                     const std::vector<std::filesystem::path>& stems) {
  require_sound_format(output.sound, channels, output.sample_rate_hz, output.bits);
  std::vector<std::filesystem::path> outputs{output.sound};
  if (output.no_figure && !output.figure.empty())
    throw BadInput("--no-figure: cannot be combined with --figure; allowed: one of the two");
  if (!output.no_figure) {
    (void)figure_format(figure_file(output));
    require_kind(figure_file(output), FigureKind::kSound, output.force);
    outputs.emplace_back(figure_file(output));
  }
  std::vector<std::filesystem::path> all = outputs;
  all.insert(all.end(), stems.begin(), stems.end());
  require_writable(all, inputs, output.force);
  if (!output.figure.empty() && !has_gnuplot())
    throw BadInput("--figure: gnuplot is not installed; install the package gnuplot-nox, or use --no-figure");
  require_creatable(outputs);
  create_folders_of(stems);
  require_creatable(stems);
}

std::string write_outputs(const RenderOutput& output, std::string sound, const DrawFigure& draw) {
  write_files({{OutputFile{output.sound, std::move(sound)}}});
  std::string report = fmt::format("sound:  {}\n", output.sound);
  if (output.no_figure) return report;
  OutputFile figure{figure_file(output), {}};
  try {
    figure.bytes = draw(figure_format(figure.path.string()));
  } catch (const BadInput& error) {
    if (!output.figure.empty()) throw;
    std::fputs(fmt::format("contactspline: {} (--no-figure)\n", error.what()).c_str(), stderr);
    return report;
  }
  write_files({{figure}});
  return report + fmt::format("figure: {}\n", figure.path.string());
}

void show_progress(double fraction) {
  if (!is_terminal(stderr)) return;
  std::fputs(fmt::format("\rrendering {:3.0f} %{}", 100 * fraction, fraction < 1 ? "" : "\n").c_str(), stderr);
}

}  // namespace contactspline
