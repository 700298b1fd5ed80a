// SPDX-License-Identifier: MIT
#include "generator/spline/simulated_impact.hpp"

#include <algorithm>

#include "contactspline/models/mass_barrier.hpp"

namespace contactspline {
namespace {

// Distance from the last sample to the turning point, with the acceleration constant between two samples as in the
// midpoint rule.
double turning_distance(double velocity, double next_velocity, double time_step) {
  return velocity * velocity * time_step / (2 * (velocity - next_velocity));
}

/// The largest value of a signal between samples: of the parabola through its largest sample and the neighbours.
class PeakFollower {
 public:
  void add(double value) {
    if (middle_ >= left_ && middle_ >= value) peak_ = std::max(peak_, parabola_peak(left_, middle_, value));
    left_ = middle_;
    middle_ = value;
  }
  [[nodiscard]] double peak() const { return std::max(peak_, middle_); }

 private:
  static double parabola_peak(double left, double middle, double right) {
    const double curvature = 2 * middle - left - right;
    return curvature > 0 ? middle + (right - left) * (right - left) / (8 * curvature) : middle;
  }

  double left_ = 0, middle_ = 0, peak_ = 0;
};

/// When a body leaves the surface of a felt with memory: where the line through its depth at two samples crosses 0.
class SurfaceFollower {
 public:
  void add(double depth, double samples) {
    if (last_ > 0 && depth <= 0) exit_samples_ = samples - 1 + last_ / (last_ - depth);
    last_ = depth;
  }
  [[nodiscard]] double exit_samples() const { return exit_samples_; }

 private:
  double last_ = 0, exit_samples_ = 0;
};

}  // namespace

SimulatedImpact simulate_impact(std::span<const Segment<double>> table, double mass_kg, double speed_m_per_s,
                                double sample_rate_hz, double phase, double loss_s_per_m,
                                std::span<const Memory> memories, std::vector<ImpactMoment>* motion) {
  MassBarrier<double> model(table, sample_rate_hz, memories);
  const MassBarrierControls<double> controls{.mass_kg = mass_kg, .contact = {.loss_s_per_m = loss_s_per_m}};
  model.throw_from(-phase * speed_m_per_s / sample_rate_hz, speed_m_per_s);
  double samples = 0;
  double max_compression = 0;
  PeakFollower force;
  SurfaceFollower surface;
  do {
    const double displacement = model.displacement();
    const double velocity = model.velocity();
    model.tick(controls);
    force.add(model.force());
    if (velocity > 0 && model.velocity() <= 0)
      max_compression = displacement + turning_distance(velocity, model.velocity(), 1 / sample_rate_hz);
    if (motion != nullptr)
      motion->push_back(
          {(samples + 0.5 - phase) / sample_rate_hz, (displacement + model.displacement()) / 2, model.force()});
    ++samples;
    surface.add(model.displacement() - model.memory().surface(table), samples);
  } while (model.displacement() > 0 || model.velocity() > 0);
  const double entry_s = phase / sample_rate_hz;
  const double exit_s = memories.empty() ? samples / sample_rate_hz - model.displacement() / model.velocity()
                                         : surface.exit_samples() / sample_rate_hz;
  return {exit_s - entry_s, max_compression, -model.velocity(), force.peak()};
}

}  // namespace contactspline
