// SPDX-License-Identifier: MIT
#include "generator/quality.hpp"

#include <algorithm>
#include <cmath>

namespace contactspline {
namespace {

constexpr int kPointsPerSegment = 64;

// The error has a peak or two a segment: sixteen speeds each miss less than 1 % of the worst. An impact costs one
// step per segment, so that their product is bounded.
int speeds_for(std::size_t segments) {
  constexpr std::size_t kLeast = 512, kMostSteps = 1 << 24;
  return static_cast<int>(std::max(kLeast, std::min(16 * segments, kMostSteps / segments)));
}

/// Worst and root-mean-square of a sequence of errors.
class ErrorSum {
 public:
  void add(double error) {
    worst_ = std::max(worst_, std::abs(error));
    squares_ += error * error;
    ++count_;
  }
  [[nodiscard]] CurveError relative_to(double scale) const {
    return {worst_ / scale, std::sqrt(squares_ / count_) / scale};
  }

 private:
  double worst_ = 0;
  double squares_ = 0;
  int count_ = 0;
};

// Compression beyond the left knot at which the segment has taken up `energy_j`: root of c t^2 + F t = energy.
double reach(const Segment<double>& segment, double energy_j) {
  const double f = segment.force;
  return 2 * energy_j / (f + std::sqrt(f * f + 4 * segment.half_curvature * energy_j));
}

// Time to go dy through a segment of constant stiffness, entering and leaving at speeds v0 and v1.
double transit_time(double half_curvature, double mass_kg, double dy, double v0, double v1) {
  const double angular_frequency = std::sqrt(2 * half_curvature / mass_kg);
  if (angular_frequency == 0) return 2 * dy / (v0 + v1);
  return 2 / angular_frequency * std::atan(angular_frequency * dy / (v0 + v1));
}

ImpactError worst_impact_error(const Spline& spline, const Potential& contact, const Impact& impact) {
  ImpactError worst{0, 0};
  const double ratio = impact.max_speed_m_per_s / impact.min_speed_m_per_s;
  const int speeds = speeds_for(spline.segments.size());
  for (int i = 0; i < speeds; ++i) {
    const double speed = impact.min_speed_m_per_s * std::pow(ratio, i / (speeds - 1.0));
    const SplineImpact found = impact_on_spline(spline, impact.mass_kg, speed);
    const double duration = contact.contact_duration(impact.mass_kg, speed);
    const double compression = contact.max_compression(impact.mass_kg, speed);
    worst.contact_duration = std::max(worst.contact_duration, std::abs(found.contact_duration_s / duration - 1));
    worst.max_compression = std::max(worst.max_compression, std::abs(found.max_compression_m / compression - 1));
  }
  return worst;
}

}  // namespace

SplineImpact impact_on_spline(const Spline& spline, double mass_kg, double speed_m_per_s) {
  const double energy = mass_kg * speed_m_per_s * speed_m_per_s / 2;
  const auto speed_at = [&](double stored) { return std::sqrt(std::max(0.0, 2 * (energy - stored) / mass_kg)); };
  double half_duration = 0;
  double speed = speed_m_per_s;
  for (std::size_t j = 0;; ++j) {
    const auto& segment = spline.segments[j];
    if (j + 1 == spline.segments.size() || spline.segments[j + 1].energy >= energy) {
      const double beyond = reach(segment, energy - segment.energy);
      half_duration += transit_time(segment.half_curvature, mass_kg, beyond, speed, 0);
      return {segment.knot + beyond, 2 * half_duration};
    }
    const auto& next = spline.segments[j + 1];
    const double next_speed = speed_at(next.energy);
    half_duration += transit_time(segment.half_curvature, mass_kg, next.knot - segment.knot, speed, next_speed);
    speed = next_speed;
  }
}

Quality measure_quality(const Spline& spline, const Material& material) {
  ErrorSum force, energy;
  for (const auto& segment : spline.segments)
    for (int i = 1; i <= kPointsPerSegment; ++i) {
      const double y = segment.knot + spline.segment_width_m * i / kPointsPerSegment;
      force.add(segment.force_at(y) - material.contact.force(y));
      energy.add(segment.energy_at(y) - material.contact.energy(y));
    }
  const double range = material.spline.max_compression_m;
  Quality quality{
      force.relative_to(material.contact.force(range)), energy.relative_to(material.contact.energy(range)), {}};
  if (material.impact) quality.impact = worst_impact_error(spline, material.contact, *material.impact);
  return quality;
}

}  // namespace contactspline
