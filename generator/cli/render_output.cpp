// SPDX-License-Identifier: MIT
#include "generator/cli/render_output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "generator/cli/allowed.hpp"
#include "generator/error.hpp"

namespace contactspline {

double scale_to_peak(double peak) {
  return peak > 0 ? kPeak / peak : 1;
}

void require_short(const std::string& key, double duration_s, int sample_rate_hz) {
  constexpr double kMostSamples = 3600.0 * 44100;
  const double samples = duration_s * sample_rate_hz;
  if (samples > kMostSamples)
    throw BadInput(fmt::format("{}: {} s at {} Hz are {:.4g} samples; allowed: at most {:.4g} s at this rate", key,
                               duration_s, sample_rate_hz, samples, kMostSamples / sample_rate_hz));
}

std::string picture_beside(const std::string& sound, const std::string& svg) {
  return svg.empty() ? std::filesystem::path(sound).replace_extension("svg").string() : svg;
}

void show_progress(double part) {
  if (::isatty(STDERR_FILENO) == 0) return;
  std::fputs(fmt::format("\rrendering {:3.0f} %{}", 100 * part, part < 1 ? "" : "\n").c_str(), stderr);
}

void add_outputs(CLI::App& command, std::string& sound, std::string& svg) {
  command.add_option("-o,--output", sound, "sound file to write (WAV, 24 bits)")
      ->check(file_name())
      ->type_name("FILE")
      ->required();
  command.add_option("--svg", svg, "picture to write (default: the sound file's name with .svg)")
      ->check(file_name())
      ->type_name("FILE");
}

}  // namespace contactspline
