// SPDX-License-Identifier: MIT
// The figure of an instrument's fit: recorded and rendered notes by band and over time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "generator/cli/figures.hpp"
#include "generator/cli/gnuplot.hpp"
#include "generator/cli/plot.hpp"
#include "generator/listen/note_impression.hpp"

namespace contactspline {
namespace {

constexpr std::size_t kMostNotes = 6, kMostWithTimes = 3;

// Rows of frequency and of the mean level over time, below the loudest band of the recording.
void add_bands(Data& data, const NoteImpression& impression, double loudest) {
  const std::size_t frames = impression.power.size() / NoteImpression::kBands;
  for (std::size_t b = 0; b < NoteImpression::kBands; ++b) {
    double sum = 0;
    for (std::size_t f = 0; f < frames; ++f) sum += impression.power[f * NoteImpression::kBands + b];
    const double level_db = 10 * std::log10(sum / static_cast<double>(frames) / loudest + 1e-30);
    data.add({impression.band_hz[b], std::max(level_db, NoteImpression::kFloor_db - 20)});
  }
}

// Rows of time and of the level of all bands.
void add_times(Data& data, const NoteImpression& impression, double loudest) {
  const std::size_t frames = impression.power.size() / NoteImpression::kBands;
  for (std::size_t f = 0; f < frames; ++f) {
    double sum = 0;
    for (std::size_t b = 0; b < NoteImpression::kBands; ++b) sum += impression.power[f * NoteImpression::kBands + b];
    data.add({static_cast<double>(f) * impression.frame_s,
              std::max(10 * std::log10(sum / loudest + 1e-30), NoteImpression::kFloor_db - 20)});
  }
}

std::string curves(const std::vector<Data>& all, const std::string& label, bool is_logarithmic) {
  Interval at, level;
  std::string script, plots;
  for (std::size_t i = 0; i < all.size(); ++i) {
    constexpr std::array kNames = {"recorded", "before", "after"};
    script += all[i].text();
    at.include(all[i].range(1));
    level.include(all[i].range(2));
    plots += fmt::format("{} ${} using 1:2 with lines lw {} lc rgb '{}' title '{}'", i == 0 ? "plot" : ",",
                         all[i].name(), i == 0 ? 2.4 : 1.4, kColours[i], kNames[i]);
  }
  script += is_logarithmic ? logarithmic_axis('x', at, label) : linear_axis('x', at, label);
  script += linear_axis('y', level, "level [dB]");
  return script + "set key top right opaque noenhanced font ',12'\n" + plots + "\n" +
         (is_logarithmic ? "unset logscale x\n" : "");
}

}  // namespace

std::string figure_of(const InstrumentFit& fit, const RecordedInstrument& recorded, FigureFormat format) {
  const std::size_t notes = std::min(kMostNotes, fit.notes.size());
  const bool has_times = notes <= kMostWithTimes;  // else there is no room beside the bands
  std::string panels;
  for (std::size_t n = 0; n < notes; ++n) {
    const FittedNote& note = fit.notes[n];
    std::vector<Data> bands, times;
    const double loudest = note.recorded.loudest();
    for (const NoteImpression* impression : {&note.recorded, &note.started, &note.found}) {
      add_bands(bands.emplace_back(fmt::format("bands_{}_{}", n, bands.size())), *impression, loudest);
      add_times(times.emplace_back(fmt::format("times_{}_{}", n, times.size())), *impression, loudest);
    }
    const std::string name = shown(recorded.notes[n].file) + (recorded.notes[n].is_kept ? ", kept" : "");
    panels += fmt::format("set title {} noenhanced\n", in_quotes(name));
    panels += curves(bands, "frequency [Hz]", true) + (has_times ? curves(times, "time [s]", false) : "");
  }
  const std::string layout =
      fmt::format("{},2 margins 0.085,0.985,0.085,0.9 spacing 0.1,0.15", has_times ? notes : (notes + 1) / 2);
  return draw(heading(layout) + panels + "unset multiplot", recorded.file, FigureKind::kFit, format);
}

}  // namespace contactspline
