// SPDX-License-Identifier: MIT
#include "generator/cli/render_output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "generator/support/error.hpp"

namespace contactspline {

double scale_to_peak(double peak) {
  return peak > 0 ? kPeak / peak : 1;
}

void require_short(const std::string& key, double duration_s, int sample_rate_hz) {
  constexpr double kMaxSamples = 3600.0 * 44100;
  const double samples = duration_s * sample_rate_hz;
  if (samples > kMaxSamples)
    throw BadInput(fmt::format("{}: {} s at {} Hz are {:.4g} samples; allowed: at most {:.4g} s at this rate", key,
                               duration_s, sample_rate_hz, samples, kMaxSamples / sample_rate_hz));
}

std::string figure_file(const RenderOutput& output) {
  return output.svg.empty() ? std::filesystem::path(output.sound).replace_extension("svg").string() : output.svg;
}

void show_progress(double fraction) {
  if (::isatty(STDERR_FILENO) == 0) return;
  std::fputs(fmt::format("\rrendering {:3.0f} %{}", 100 * fraction, fraction < 1 ? "" : "\n").c_str(), stderr);
}

}  // namespace contactspline
