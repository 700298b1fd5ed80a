// SPDX-License-Identifier: MIT
#include "generator/fit/fit_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace contactspline {
namespace {

void note_low_pass(Fit& fit, const FitValues& values) {
  if (fit.low_pass_hz)
    fit.notes.push_back(
        fmt::format("the pulses look as if a low-pass of order {} at {:.4g} Hz were before them: if there is one, "
                    "state its low_pass_hz",
                    values.low_pass_order, fit.low_pass_hz->value));
}

void note_means(Fit& fit, const Measurements& measured) {
  std::size_t files = 0, recorded = 0, kept = 0;
  for (const Pulse& pulse : measured.pulses)
    if (pulse.recorded > 0) ++files, recorded += pulse.recorded, kept += pulse.time_s.size();
  if (files > 0)
    fit.notes.push_back(fmt::format("{} samples of {} files are many: the means of neighbours were fitted, {} in all",
                                    recorded, files, kept));
}

// The scatter of data of a quantity that is usual in a fit: the lower of two in the middle.
double usual_scatter(const Fit& fit, const std::string& quantity) {
  std::vector<double> all;
  for (const FitQuality& quality : fit.qualities)
    if (quality.quantity == quantity) all.push_back(quality.scatter);
  std::ranges::sort(all);
  return all[(all.size() - 1) / 2];
}

// Is what the model leaves of a pulse no noise, but alike in neighbours, and worth mentioning?
bool hangs_together(const FitQuality& quality, const Pulse& pulse, double together) {
  constexpr double kTogether = 4, kWorth = 0.003, kTimesNoise = 1.5;
  const double noise = white_noise_of(pulse.force_n) / std::ranges::max(pulse.force_n);
  return together > kTogether && quality.scatter > std::max(kWorth, kTimesNoise * noise);
}

void note_poor_files(Fit& fit, const Measurements& measured, const FitValues& values) {
  constexpr double kManyTimes = 5, kPoor = 0.1, kWorth = 0.003, kWorth_db = 0.1;
  for (std::size_t s = 0; s < fit.qualities.size(); ++s) {
    const FitQuality& quality = fit.qualities[s];
    const std::string what = fmt::format("{}, {}: ", quality.file, quality.quantity);
    const double usual = usual_scatter(fit, quality.quantity), worth = quality.is_level() ? kWorth_db : kWorth;
    if (quality.scatter > kManyTimes * std::max(usual, worth))
      fit.notes.push_back(
          what + fmt::format("scatters {:.3g} times as much as others: look at the figure", quality.scatter / usual));
    else if (!quality.is_level() && quality.scatter > kPoor)
      fit.notes.push_back(what +
                          fmt::format("scatters by {:.3g} %: the model describes it poorly", 100 * quality.scatter));
    else if (s < measured.pulses.size() && hangs_together(quality, measured.pulses[s], values.together[s]))
      fit.notes.push_back(what +
                          fmt::format("what the model leaves is no noise: it hangs together over {:.0f} samples",
                                      values.together[s]));
  }
}

// Possible, but unlikely.
void note_proportions(Fit& fit, const Measurements& measured) {
  constexpr Range kStiffness{100, 1e9}, kSpeed{0.01, 30};
  const double y = fit.max_compression_m;
  const double force = std::exp(fit.model.log_force) * impact_model::shape(fit.model, y);
  const auto has_no_speed = [](const Pulse& pulse) { return !pulse.speed_m_per_s; };
  const bool is_likely = force / y >= kStiffness.min && force / y <= kStiffness.max;
  const bool has_likely_speeds = fit.min_speed_m_per_s >= kSpeed.min && fit.max_speed_m_per_s <= kSpeed.max;
  if (is_likely && (has_likely_speeds || std::ranges::none_of(measured.pulses, has_no_speed))) return;
  fit.notes.push_back(fmt::format(
      "{:.3g} N at {:.3g} m, at {:.3g} to {:.3g} m/s, is out of proportion: is a unit wrong, or are volts "
      "called newtons?",
      force, y, fit.min_speed_m_per_s, fit.max_speed_m_per_s));
}

}  // namespace

void add_notes(Fit& fit, const Measurements& measured, const FitValues& values) {
  note_low_pass(fit, values);
  note_means(fit, measured);
  note_poor_files(fit, measured, values);
  note_proportions(fit, measured);
}

}  // namespace contactspline
