// SPDX-License-Identifier: MIT
#include "generator/spline/spline_error.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "generator/spline/compensation.hpp"
#include "generator/spline/simulated_impact.hpp"

namespace contactspline {
namespace {

// Appends `steps` speeds in geometric progression from min (not included) to max (included).
void append_speeds(std::vector<double>& speeds, double min, double max, int steps) {
  for (int i = 1; i <= steps; ++i) speeds.push_back(min * std::pow(max / min, static_cast<double>(i) / steps));
}

constexpr int kPointsPerSegment = 64;

/// Worst and root-mean-square value of weighted errors.
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

// Distance from the left knot at which the segment has stored `energy_j`: the root t of c t^2 + F t = energy.
double distance_storing(const Segment<double>& segment, double energy_j) {
  const double f = segment.force;
  return 2 * energy_j / (f + std::sqrt(f * f + 4 * segment.half_curvature * energy_j));
}

// Time to move by dy within a segment, from speed v0 to speed v1. The stiffness of a segment is constant.
double transit_time(double half_curvature, double mass_kg, double dy, double v0, double v1) {
  const double angular_frequency = std::sqrt(2 * half_curvature / mass_kg);
  if (angular_frequency == 0) return 2 * dy / (v0 + v1);
  return 2 / angular_frequency * std::atan(angular_frequency * dy / (v0 + v1));
}

// The error has one or two peaks per segment; with 16 speeds per segment the worst is found to within 1 %. Each
// impact takes one step per segment, so the product of both numbers is bounded.
std::vector<double> even_speeds(const Spline& spline, const Impact& impact) {
  constexpr std::size_t kMin = 512, kMaxSteps = 1 << 24;
  const std::size_t segments = spline.segments.size();
  const auto count = static_cast<int>(std::max(kMin, std::min(16 * segments, kMaxSteps / segments)));
  std::vector<double> speeds{impact.min_speed_m_per_s};
  append_speeds(speeds, impact.min_speed_m_per_s, impact.max_speed_m_per_s, count - 1);
  return speeds;
}

// Appends speeds ever closer to those with a turning point where a layer begins to act. There the duration changes
// like the square root of the energy difference.
void append_kinks(std::vector<double>& speeds, const ContactLaw& contact, const Impact& impact) {
  if (!std::holds_alternative<PowerSum>(contact.law())) return;
  const auto& [mass_kg, fastest, slowest] = impact;
  for (const double y : contact.breaks()) {
    const double turning = std::sqrt(2 * contact.energy(y) / mass_kg);
    if (turning <= slowest || turning >= fastest) continue;
    speeds.push_back(turning);
    for (double power = 0.5; power > 1e-6; power /= std::numbers::sqrt2)
      for (const double end : {slowest, fastest}) speeds.push_back(turning * std::pow(end / turning, power));
  }
}

// Even speeds for uniform knots given by number, and for very many segments, where more speeds would take too long.
std::vector<double> measured_speeds(const Spline& spline, const Material& material) {
  constexpr std::size_t kMany = 1024;
  const bool plain = material.spline.knots == Knots::uniform && material.spline.tolerance == 0;
  const Impact impact = elastic_impact(material);
  std::vector<double> speeds = plain || spline.segments.size() > kMany
                                   ? even_speeds(spline, impact)
                                   : speeds_by_segment(spline.segments, impact, 32, 2048);
  append_kinks(speeds, material.contact, impact);
  return speeds;
}

// At every `stride`-th speed.
ImpactError worst_impact_error(const Spline& spline, const Material& material, std::size_t stride = 1) {
  ImpactError worst{0, 0};
  const ContactLaw& contact = material.contact;
  const double mass_kg = elastic_impact(material).mass_kg;
  const std::vector<double> speeds = measured_speeds(spline, material);
  for (std::size_t i = 0; i < speeds.size(); i += stride) {
    const double speed = speeds[i];
    const SplineImpact found = impact_on_spline(spline, mass_kg, speed);
    const double duration = contact_duration(contact, mass_kg, speed);
    const double compression = max_compression(contact, mass_kg, speed);
    worst.contact_duration = worse(worst.contact_duration, found.contact_duration_s / duration - 1);
    worst.max_compression = worse(worst.max_compression, found.max_compression_m / compression - 1);
  }
  return worst;
}

// Number of phases between two samples at which simulated contacts begin. Their effect on the duration falls with the
// fourth power of its number of samples.
int phases_of(double samples) {
  return samples < 25 ? 32 : samples < 500 ? 8 : 1;
}

/// Errors of impacts simulated at the sample rate for which a spline is compensated, against its law.
class SimulatedErrors {
 public:
  SimulatedErrors(const Spline& spline, const Material& material)
      : law_(material.contact), compensation_(*material.compensation), table_(segment_table(spline)) {}

  [[nodiscard]] const std::vector<Segment<double>>& table() const { return table_; }
  [[nodiscard]] double samples(double speed) const {
    return contact_duration(law_, compensation_.mass_kg, speed) * compensation_.sample_rate_hz;
  }
  [[nodiscard]] ImpactError at(double speed, double phase) const {
    const auto found = simulate_impact(table_, compensation_.mass_kg, speed, compensation_.sample_rate_hz,
                                       phase - std::floor(phase));
    return {found.contact_duration_s / contact_duration(law_, compensation_.mass_kg, speed) - 1,
            found.max_compression_m / max_compression(law_, compensation_.mass_kg, speed) - 1};
  }

 private:
  const ContactLaw& law_;
  Compensation compensation_;
  std::vector<Segment<double>> table_;
};

/// An error of the contact duration, with the speed and the phase at which it occurs.
struct WorstCase {
  double speed, phase, error;
};

// Local search for the worst error from a starting point, with ever smaller steps of speed (relative) and phase.
double climbed(WorstCase at, const SimulatedErrors& errors, const Impact& impact, double speed_step,
               double phase_step) {
  for (int halved = 0; halved < 8;) {
    const double before = at.error;
    for (const auto& [faster, later] :
         {std::pair(speed_step, 0.0), {-speed_step, 0.0}, {0.0, phase_step}, {0.0, -phase_step}}) {
      const double speed = std::clamp(at.speed * (1 + faster), impact.min_speed_m_per_s, impact.max_speed_m_per_s);
      const double error = std::abs(errors.at(speed, at.phase + later).contact_duration);
      if (error > at.error) at = {speed, at.phase + later, error};
    }
    if (at.error > before * (1 + 1e-4)) continue;
    ++halved;
    speed_step /= 2;
    phase_step /= 2;
  }
  return at.error;
}

// The impacts of the compensated mass that have the same energies as those of the material.
Impact simulated_impacts(const Material& material) {
  const double mass_kg = material.compensation->mass_kg, ratio = std::sqrt(material.impact->mass_kg / mass_kg);
  return {mass_kg, material.impact->max_speed_m_per_s * ratio, material.impact->min_speed_m_per_s * ratio};
}

// Widens `worst` by the errors at one speed, over the phases shifted by `shift` of their distance. Returns the worst
// error of the contact duration among them.
WorstCase worst_phase(const SimulatedErrors& errors, double speed, double shift, ImpactError& worst) {
  const int phases = phases_of(errors.samples(speed));
  WorstCase at_speed{speed, 0, 0};
  for (int i = 0; i < phases; ++i) {
    const double phase = (i + shift) / phases;
    const ImpactError error = errors.at(speed, phase);
    worst.max_compression = worse(worst.max_compression, error.max_compression);
    worst.contact_duration = worse(worst.contact_duration, error.contact_duration);
    if (std::abs(error.contact_duration) > at_speed.error)
      at_speed = {speed, phase, std::abs(error.contact_duration)};
  }
  return at_speed;
}

// Searches a grid of speeds and phases, then climbs from the worst points, because the peaks over both are sharp.
ImpactError worst_simulated_error(const Spline& spline, const Material& material) {
  constexpr std::size_t kClimbed = 32;
  const SimulatedErrors errors(spline, material);
  const Impact impact = simulated_impacts(material);
  std::vector<double> speeds = speeds_by_segment(std::span(errors.table()).subspan(1), impact, 12, 768);
  append_kinks(speeds, material.contact, impact);
  ImpactError worst{0, 0};
  std::vector<WorstCase> cases;
  double shift = 0.5;  // shift of the phases, different at each speed
  for (const double speed : speeds) {
    shift = std::fmod(shift + std::numbers::phi, 1);
    cases.push_back(worst_phase(errors, speed, shift, worst));
  }
  std::ranges::sort(cases, std::greater<>(), &WorstCase::error);
  cases.resize(std::min(cases.size(), kClimbed));
  const double speed_step =
      std::log(impact.max_speed_m_per_s / impact.min_speed_m_per_s) / static_cast<double>(speeds.size());
  for (const WorstCase& at : cases) {
    const double phase_step = 0.5 / phases_of(errors.samples(at.speed));
    worst.contact_duration = worse(worst.contact_duration, climbed(at, errors, impact, speed_step, phase_step));
  }
  return worst;
}

}  // namespace

double worse(double worst, double error) {
  return std::isfinite(error) ? std::max(worst, std::abs(error)) : std::numeric_limits<double>::infinity();
}

std::vector<double> speeds_by_segment(std::span<const Segment<double>> segments, const Impact& impact, int min_steps,
                                      int total) {
  const int steps = std::max(min_steps, total / static_cast<int>(segments.size()));
  std::vector<double> speeds{impact.min_speed_m_per_s};
  for (const auto& segment : segments) {
    const double turning = std::sqrt(2 * segment.energy / impact.mass_kg);
    if (turning > speeds.back() && turning < impact.max_speed_m_per_s)
      append_speeds(speeds, speeds.back(), turning, steps);
  }
  append_speeds(speeds, speeds.back(), impact.max_speed_m_per_s, steps);
  return speeds;
}

SplineImpact impact_on_spline(const Spline& spline, double mass_kg, double speed_m_per_s) {
  const double energy = mass_kg * speed_m_per_s * speed_m_per_s / 2;
  const auto speed_at = [&](double stored) { return std::sqrt(std::max(0.0, 2 * (energy - stored) / mass_kg)); };
  double half_duration = 0;
  double speed = speed_m_per_s;
  for (std::size_t j = 0;; ++j) {
    const auto& segment = spline.segments[j];
    if (j + 1 == spline.segments.size() || spline.segments[j + 1].energy >= energy) {
      const double beyond = distance_storing(segment, energy - segment.energy);
      half_duration += transit_time(segment.half_curvature, mass_kg, beyond, speed, 0);
      return {segment.knot + beyond, 2 * half_duration};
    }
    const auto& next = spline.segments[j + 1];
    const double next_speed = speed_at(next.energy);
    half_duration += transit_time(segment.half_curvature, mass_kg, next.knot - segment.knot, speed, next_speed);
    speed = next_speed;
  }
}

double min_duration_error(const Spline& spline, const Material& material) {
  constexpr std::size_t kStride = 8;
  return material.compensation ? 0 : worst_impact_error(spline, material, kStride).contact_duration;
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

}  // namespace contactspline
