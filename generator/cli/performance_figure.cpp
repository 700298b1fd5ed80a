// SPDX-License-Identifier: MIT
// The figure of a played score: waveform, contact force and spectrogram.
#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <regex>
#include <string>
#include <string_view>
#include <vector>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"
#include "generator/player/spectrogram.hpp"

namespace contactspline {
namespace {

constexpr auto kSpectrogramScript = R"(
set ylabel 'frequency [Hz]'
unset grid
set tics front
set yrange [log10(lowest):log10(highest)]
set ytics ('50' log10(50), '100' log10(100), '200' log10(200), '500' log10(500), '1 k' 3, '2 k' log10(2000), '5 k' log10(5000), '10 k' 4)
set cblabel 'level [dB]' offset 0.5
set cbrange [-80:0]
set palette defined (0 '#000004', 1 '#1b0c41', 2 '#4a0c6b', 3 '#781c6d', 4 '#a52c60', 5 '#cf4446', 6 '#ed6925', 7 '#fb9b06', 8 '#f7d13d', 9 '#fcffa4')
)";

// The mean of the channels.
std::vector<float> mono(const Performance& performance) {
  if (performance.channels == 1) return performance.samples;
  std::vector<float> mean;
  for (std::size_t i = 0; i + 1 < performance.samples.size(); i += 2)
    mean.push_back((performance.samples[i] + performance.samples[i + 1]) / 2);
  return mean;
}

// The plot of a spectrogram, with its levels as binary data behind the command: gnuplot reads text six times as
// slowly.
std::string spectrogram_plot(const Spectrogram& spectrogram, double duration) {
  const auto& [columns, rows, lowest, highest, level_db] = spectrogram;
  const double width = duration / static_cast<double>(columns);
  std::string plot = fmt::format(
      "plot '-' binary array=({},{}) format='%float32' origin=({},{}) dx={} dy={} with image\n", columns, rows,
      width / 2, std::log10(lowest), width, std::log10(highest / lowest) / static_cast<double>(rows - 1));
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const auto level = static_cast<float>(level_db[column * rows + row]);
      plot.append(reinterpret_cast<const char*>(&level), sizeof level);
    }
  return plot + "\nunset multiplot\n";
}

Data force_data(const Performance& performance, double duration_s) {
  Data data("force");
  const double step = duration_s / static_cast<double>(performance.force_n.size());
  for (std::size_t i = 0; i < performance.force_n.size(); ++i)
    data.add({(static_cast<double>(i) + 0.5) * step, performance.force_n[i]});
  return data;
}

/// Lower and upper border of a panel, as parts of the figure.
struct Borders {
  double bottom, top;
};

std::string borders(Borders at) {
  return fmt::format("set bmargin at screen {}\nset tmargin at screen {}\n", at.bottom, at.top);
}

std::string curve_panel(const Data& data, Interval range, Borders at, const std::string& label,
                        std::string_view style) {
  return borders(at) + linear_axis('y', range, label) +
         fmt::format("plot ${} using 1:2 with lines {}\n", data.name(), style);
}

// Waveform and force, whose time axis has no labels. Without any force the waveform has the room of both.
std::string upper_panels(const Data& sound, const Data& force, const PerformanceText& text) {
  const Interval newtons{0, force.range(2).high};
  const bool has_force = newtons.high > 0;
  const std::string upper =
      curve_panel(sound, sound.range(2), {has_force ? 0.72 : 0.53, 0.93}, text.signal, "lt 2 lw 0.8");
  return has_force ? upper + curve_panel(force, newtons, {0.53, 0.69}, text.force, "lt 3 lw 1") : upper;
}

}  // namespace

std::string figure_of(const Performance& performance, const PerformanceText& text, FigureFormat format) {
  const std::vector<float> samples = mono(performance);
  const double duration = static_cast<double>(samples.size()) / performance.sample_rate_hz;
  const Data sound = envelope<float>("sound", samples, 1, performance.sample_rate_hz);
  const Data force = force_data(performance, duration);
  const Spectrogram spectrogram = spectrogram_of(samples, performance.sample_rate_hz, 900, 280);
  const std::string axis = linear_axis('x', {0, duration}, "time [s]");
  return draw(sound.text() + force.text() + heading(kOwnMargins) +
                  "unset key\nset ylabel font ',12'\nset lmargin at screen 0.11\nset rmargin at screen 0.88\n" +
                  std::regex_replace(axis, std::regex("'[^']*'"), "''") + "set xlabel ''\n" +
                  upper_panels(sound, force, text) + axis + borders({0.095, 0.5}) +
                  fmt::format("lowest = {:g}\nhighest = {:g}", spectrogram.lowest_hz, spectrogram.highest_hz) +
                  kSpectrogramScript + spectrogram_plot(spectrogram, duration),
              text.title, FigureKind::kSound, format);
}

}  // namespace contactspline
