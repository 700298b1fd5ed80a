// SPDX-License-Identifier: MIT
#include "generator/quality.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "generator/compensation.hpp"
#include "generator/impact.hpp"

namespace contactspline {
namespace {

constexpr int kPointsPerSegment = 64;

// The larger magnitude; infinite where the error is no number.
double worse(double worst, double error) {
  return std::isfinite(error) ? std::max(worst, std::abs(error)) : std::numeric_limits<double>::infinity();
}

/// Worst and root-mean-square of a sequence of errors.
class ErrorSum {
 public:
  void add(double error, double weight) {
    worst_ = worse(worst_, error);
    squares_ += weight * error * error;
    weights_ += weight;
  }
  [[nodiscard]] CurveError relative_to(double scale) const {
    return {worst_ / scale, std::sqrt(squares_ / weights_) / scale};
  }

 private:
  double worst_ = 0;
  double squares_ = 0;
  double weights_ = 0;
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

// Speeds in geometric progression, `steps` of them after the least.
void append_speeds(std::vector<double>& speeds, double least, double most, int steps) {
  for (int i = 1; i <= steps; ++i) speeds.push_back(least * std::pow(most / least, static_cast<double>(i) / steps));
}

// The error has a peak or two a segment: sixteen speeds each miss less than 1 % of the worst. An impact costs one
// step per segment, so that their product is bounded.
std::vector<double> even_speeds(const Spline& spline, const Impact& impact) {
  constexpr std::size_t kLeast = 512, kMostSteps = 1 << 24;
  const std::size_t segments = spline.segments.size();
  const auto count = static_cast<int>(std::max(kLeast, std::min(16 * segments, kMostSteps / segments)));
  std::vector<double> speeds{impact.min_speed_m_per_s};
  append_speeds(speeds, impact.min_speed_m_per_s, impact.max_speed_m_per_s, count - 1);
  return speeds;
}

// Between any two neighbouring speeds that turn at a knot the error is smooth, with a peak or two, the sharper the
// wider the segment: a few thousand speeds in all, 32 there at least, miss less than three thousandths of the worst.
std::vector<double> speeds_by_segment(std::span<const Segment<double>> segments, const Impact& impact, int least,
                                      int in_all) {
  const int steps = std::max(least, in_all / static_cast<int>(segments.size()));
  std::vector<double> speeds{impact.min_speed_m_per_s};
  for (const auto& segment : segments) {
    const double turning = std::sqrt(2 * segment.energy / impact.mass_kg);
    if (turning > speeds.back() && turning < impact.max_speed_m_per_s)
      append_speeds(speeds, speeds.back(), turning, steps);
  }
  append_speeds(speeds, speeds.back(), impact.max_speed_m_per_s, steps);
  return speeds;
}

// Where a layer begins to act the duration bends like a root of the energy beyond: speeds closer and closer to those
// that turn there.
void append_kinks(std::vector<double>& speeds, const Potential& contact, const Impact& impact) {
  if (!std::holds_alternative<PowerSum>(contact.law())) return;
  const auto& [mass_kg, fastest, slowest] = impact;
  for (const double y : contact.breaks()) {
    const double turning = std::sqrt(2 * contact.energy(y) / mass_kg);
    if (turning <= slowest || turning >= fastest) continue;
    speeds.push_back(turning);
    for (double share = 0.5; share > 1e-6; share /= std::numbers::sqrt2)
      for (const double end : {slowest, fastest}) speeds.push_back(turning * std::pow(end / turning, share));
  }
}

// Uniform knots given by number are measured as they always were; and many segments as well as can be afforded.
std::vector<double> measured_speeds(const Spline& spline, const Material& material) {
  constexpr std::size_t kMany = 1024;
  const bool plain = material.spline.knots == Knots::uniform && material.spline.tolerance == 0;
  std::vector<double> speeds = plain || spline.segments.size() > kMany
                                   ? even_speeds(spline, *material.impact)
                                   : speeds_by_segment(spline.segments, *material.impact, 32, 2048);
  append_kinks(speeds, material.contact, *material.impact);
  return speeds;
}

ImpactError worst_impact_error(const Spline& spline, const Material& material) {
  ImpactError worst{0, 0};
  const Potential& contact = material.contact;
  const double mass_kg = material.impact->mass_kg;
  for (const double speed : measured_speeds(spline, material)) {
    const SplineImpact found = impact_on_spline(spline, mass_kg, speed);
    const double duration = contact.contact_duration(mass_kg, speed);
    const double compression = contact.max_compression(mass_kg, speed);
    worst.contact_duration = worse(worst.contact_duration, found.contact_duration_s / duration - 1);
    worst.max_compression = worse(worst.max_compression, found.max_compression_m / compression - 1);
  }
  return worst;
}

// Phases between two samples at which simulated contacts are begun. What they do to the duration falls with the
// fourth power of the number of samples that it lasts.
int phases_of(double samples) {
  return samples < 25 ? 32 : samples < 500 ? 8 : 1;
}

/// Collisions simulated at the rate a spline is compensated for, against its law.
class SimulatedErrors {
 public:
  SimulatedErrors(const Spline& spline, const Material& material)
      : law_(material.contact),
        of_(*material.compensation),
        table_(in_series(segment_table(spline), -of_.compliance_m_per_n)) {}  // a rigid barrier lacks none

  [[nodiscard]] const std::vector<Segment<double>>& table() const { return table_; }
  [[nodiscard]] double samples(double speed) const {
    return law_.contact_duration(of_.mass_kg, speed) * of_.sample_rate_hz;
  }
  [[nodiscard]] ImpactError at(double speed, double phase) const {
    const auto found = simulate_impact(table_, of_.mass_kg, speed, of_.sample_rate_hz, phase - std::floor(phase));
    return {found.contact_duration_s / law_.contact_duration(of_.mass_kg, speed) - 1,
            found.max_compression_m / law_.max_compression(of_.mass_kg, speed) - 1};
  }

 private:
  const Potential& law_;
  Compensation of_;
  std::vector<Segment<double>> table_;
};

/// The worst error of the contact duration at a speed.
struct Peak {
  double speed, phase, error;
};

// Climbs from there, by ever shorter steps of speed (relative) and phase.
double climbed(Peak peak, const SimulatedErrors& errors, const Impact& impact, double speed_step, double phase_step) {
  for (int halved = 0; halved < 8;) {
    const double before = peak.error;
    for (const auto& [faster, later] :
         {std::pair(speed_step, 0.0), {-speed_step, 0.0}, {0.0, phase_step}, {0.0, -phase_step}}) {
      const double speed = std::clamp(peak.speed * (1 + faster), impact.min_speed_m_per_s, impact.max_speed_m_per_s);
      const double error = std::abs(errors.at(speed, peak.phase + later).contact_duration);
      if (error > peak.error) peak = {speed, peak.phase + later, error};
    }
    if (peak.error > before * (1 + 1e-4)) continue;
    ++halved;
    speed_step /= 2;
    phase_step /= 2;
  }
  return peak.error;
}

// Over speeds and phases of the begin, and climbed from the worst of them, for the peaks over both are sharp. The
// mass meets the same energies as that of the material's impacts.
ImpactError worst_simulated_error(const Spline& spline, const Material& material) {
  constexpr std::size_t kClimbed = 32;
  const SimulatedErrors errors(spline, material);
  const double mass_kg = material.compensation->mass_kg, share = std::sqrt(material.impact->mass_kg / mass_kg);
  const Impact impact{mass_kg, material.impact->max_speed_m_per_s * share,
                      material.impact->min_speed_m_per_s * share};
  std::vector<double> speeds = speeds_by_segment(std::span(errors.table()).subspan(1), impact, 12, 768);
  append_kinks(speeds, material.contact, impact);
  ImpactError worst{0, 0};
  std::vector<Peak> peaks;
  double shift = 0.5;  // of the phases, another one at each speed
  for (const double speed : speeds) {
    shift = std::fmod(shift + std::numbers::phi, 1);
    const int phases = phases_of(errors.samples(speed));
    Peak& peak = peaks.emplace_back(Peak{speed, 0, 0});
    for (int i = 0; i < phases; ++i) {
      const double phase = (i + shift) / phases;
      const ImpactError error = errors.at(speed, phase);
      worst.max_compression = worse(worst.max_compression, error.max_compression);
      worst.contact_duration = worse(worst.contact_duration, error.contact_duration);
      if (std::abs(error.contact_duration) > peak.error) peak = {speed, phase, std::abs(error.contact_duration)};
    }
  }
  std::ranges::sort(peaks, std::greater<>(), &Peak::error);
  peaks.resize(std::min(peaks.size(), kClimbed));
  for (const Peak& peak : peaks) {
    const double step =
        std::log(impact.max_speed_m_per_s / impact.min_speed_m_per_s) / static_cast<double>(speeds.size());
    worst.contact_duration = worse(worst.contact_duration,
                                   climbed(peak, errors, impact, step, 0.5 / phases_of(errors.samples(peak.speed))));
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
  const double range = material.spline.max_compression_m, end = std::max(range, spline.end_m);
  for (std::size_t j = 0; j < spline.segments.size(); ++j) {
    const auto& segment = spline.segments[j];
    const double width = (j + 1 < spline.segments.size() ? spline.segments[j + 1].knot : end) - segment.knot;
    for (int i = 1; i <= kPointsPerSegment; ++i) {
      const double y = segment.knot + width * i / kPointsPerSegment;
      force.add(segment.force_at(y) - material.contact.force(y), width);
      energy.add(segment.energy_at(y) - material.contact.energy(y), width);
    }
  }
  Quality quality{
      force.relative_to(material.contact.force(range)), energy.relative_to(material.contact.energy(range)), {}};
  if (material.impact)
    quality.impact =
        material.compensation ? worst_simulated_error(spline, material) : worst_impact_error(spline, material);
  return quality;
}

std::optional<ImpactError> measure_family(const ExponentFamily& family, const Material& material) {
  if (!material.impact) return std::nullopt;
  constexpr int kBlends = 4;  // steps from a member to the next
  const auto& range = *material.live_exponent;
  const double mass_kg = material.impact->mass_kg;
  const int steps = kBlends * (range.members - 1);
  ImpactError worst{0, 0};
  for (int i = 0; i <= steps; ++i) {
    const double exponent = range.least + (range.most - range.least) * i / steps;
    const PowerLaw law = law_of_family(material, exponent);
    const Spline spline{blended(family, range, exponent), 1, 1, {}, {}, {}};
    for (const double speed : speeds_by_segment(spline.segments, *material.impact, 12, 384)) {
      const SplineImpact found = impact_on_spline(spline, mass_kg, speed);
      worst.contact_duration =
          worse(worst.contact_duration, found.contact_duration_s / law.contact_duration(mass_kg, speed) - 1);
      worst.max_compression =
          worse(worst.max_compression, found.max_compression_m / law.max_compression(mass_kg, speed) - 1);
    }
  }
  return worst;
}

}  // namespace contactspline
