// SPDX-License-Identifier: MIT
#include "generator/spline/spectrum_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "generator/contact/barrier_impact.hpp"
#include "generator/spline/graded_knots.hpp"
#include "generator/spline/impact_spectrum.hpp"

namespace contactspline {
namespace {

constexpr int kPerZero = 4;            // frequencies between two zeros of a spectrum
constexpr int kBeyond = 2 * kPerZero;  // frequencies above the last one compared, for its envelope
constexpr int kFewZeros = 9;           // by then the spectrum of a power law has fallen by 60 dB if a >= 1.5
constexpr int kMaxZeros = 36;          // the same for a >= 0.6; spectra that fall more slowly are compared up to here

// The largest magnitude at each frequency or a higher one.
std::vector<double> envelope_of(const std::vector<double>& spectrum) {
  std::vector<double> envelope(spectrum.size());
  double largest = 0;
  for (std::size_t k = spectrum.size(); k-- > 0;) envelope[k] = largest = std::max(largest, std::abs(spectrum[k]));
  return envelope;
}

double decibels(double relative) {
  return std::isfinite(relative) ? 20 * std::log10(1 + relative) : std::numeric_limits<double>::infinity();
}

// The force of a spline, in units of `range` and of `max_force`.
PiecewiseLinearForce force_of(const Spline& spline, double range, double max_force) {
  PiecewiseLinearForce force{{}, {}};
  for (const auto& segment : spline.segments) {
    force.y.push_back(segment.knot / range);
    force.f.push_back(segment.force / max_force);
  }
  const auto& last = spline.segments.back();
  force.y.push_back(last.knot / range + 1);
  force.f.push_back(last.force_at(last.knot + range) / max_force);
  return force;
}

}  // namespace

// Few zeros of the spectrum are computed first: most spectra have fallen to the lowest level by then.
ExactSpectra::Impact ExactSpectra::compared_part(const PiecewiseLinearForce& exact, double energy, double step,
                                                 double highest) {
  for (int zeros = kFewZeros;; zeros *= 2) {
    const double all = highest / step;
    const int count = static_cast<int>(std::min<double>(all, zeros * kPerZero));
    Impact impact{energy, step, impact_spectrum(exact, energy, step, 1 + count + kBeyond), {}};
    impact.envelope = envelope_of(impact.spectrum);
    const double lowest = impact.spectrum.front() * std::pow(10, kMinSpectrumLevel_db / 20);
    const auto first = impact.envelope.begin() + 1, last = first + count;
    const auto end = std::partition_point(first, last, [=](double level) { return level >= lowest; });
    impact.spectrum.resize(static_cast<std::size_t>(end - impact.envelope.begin()));
    if (end != last || count < zeros * kPerZero || zeros == kMaxZeros) return impact;
  }
}

ExactSpectra::ExactSpectra(const FitTarget& target, int speeds, int segments) {
  const PiecewiseLinearForce exact = graded_knots(segments, target);
  const double highest = 2 * std::numbers::pi * kMaxSpectrumFrequency_hz * target.time_unit_s;
  for (int i = 0; i < speeds; ++i) {
    const double energy = target.min_energy * std::pow(target.max_energy / target.min_energy, i / (speeds - 1.0));
    const double step = std::numbers::pi / (kPerZero * target.half_duration(energy));
    impacts_.push_back(compared_part(exact, energy, step, highest));
  }
}

std::vector<double> ExactSpectra::differences(const PiecewiseLinearForce& force) const {
  std::vector<double> relative;
  for (const Impact& impact : impacts_) {
    const std::vector<double> found =
        impact_spectrum(force, impact.energy, impact.step, static_cast<int>(impact.spectrum.size()));
    for (std::size_t k = 1; k < found.size(); ++k)
      relative.push_back(std::abs(found[k] - impact.spectrum[k]) / impact.envelope[k]);
  }
  return relative;
}

bool ExactSpectra::is_empty() const {
  return std::ranges::all_of(impacts_, [](const Impact& impact) { return impact.spectrum.size() < 2; });
}

std::optional<SpectrumError> ExactSpectra::error_of(const PiecewiseLinearForce& force) const {
  if (is_empty()) return {};
  SpectrumError error{0, 0};
  const std::vector<double> relative = differences(force);
  for (const double difference : relative) {
    const double level = decibels(difference);
    error.mean_db += level / static_cast<double>(relative.size());
    error.worst_db = std::max(error.worst_db, level);
  }
  return error;
}

double ExactSpectra::rms_error_of(const PiecewiseLinearForce& force) const {
  double squares = 0;
  const std::vector<double> relative = differences(force);
  for (const double difference : relative) squares += difference * difference;
  const double rms = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(relative.size(), 1)));
  return std::isfinite(rms) ? rms : std::numeric_limits<double>::infinity();
}

bool has_spectrum(const Material& material) {
  constexpr int kFewSpeeds = 8;
  return !ExactSpectra(fit_target(material), kFewSpeeds).is_empty();
}

std::optional<SpectrumError> measure_spectrum(const Spline& spline, const Material& material) {
  if (!material.impact || material.compensation) return {};
  Material over_impacts = material;
  const Impact impact = elastic_impact(material);
  const double range = max_compression(material.contact, impact.mass_kg, impact.max_speed_m_per_s);
  over_impacts.spline.max_compression_m = range;
  // With 256 speeds the worst error is found to within a few per cent. Fewer only if they take too long.
  constexpr std::size_t kMin = 8, kMax = 256, kMaxSteps = 1 << 18;
  const std::size_t speeds = std::clamp(kMaxSteps / spline.segments.size(), kMin, kMax);
  return ExactSpectra(fit_target(over_impacts), static_cast<int>(speeds))
      .error_of(force_of(spline, range, material.contact.force(range)));
}

}  // namespace contactspline
