// SPDX-License-Identifier: MIT
// Measurements of known materials, by a simulation of their own in long double.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "generator/contact/barrier_impact.hpp"
#include "generator/fit/models.hpp"
#include "generator/fit/pulse_window.hpp"
#include "support/random.hpp"

namespace contactspline::testing {

/// A felt or a ball: F = k y^a (1 + loss v) - weight M, time dM/dt = k y^a - M, and its mass.
struct TrueMaterial {
  PowerLaw law;
  double loss_s_per_m, mass_kg, weight = 0, time_s = 1;
};

/// A material whose contact without loss lasts `duration_s` at 2 m/s.
inline TrueMaterial lasting(double duration_s, double exponent, double loss, double mass_kg) {
  const double ratio = PowerLaw{1, exponent}.contact_duration(mass_kg, 2) / duration_s;
  return {{std::pow(ratio, exponent + 1), exponent}, loss, mass_kg};
}

/// A normal number, by Box and Muller.
inline double normal(Random& random) {
  const double radius = std::sqrt(-2 * std::log(1 - random.uniform()));
  return radius * std::cos(2 * std::numbers::pi * random.uniform());
}

/// The force at times of an impact that begins at `begin_s`: the midpoint rule with 64 steps a sample.
inline std::vector<double> force_at(const TrueMaterial& material, double speed, double begin_s,
                                    const std::vector<double>& times) {
  constexpr int kSteps = 64;
  const auto elastic = [&](long double y) {
    return y > 0 ? static_cast<long double>(material.law.stiffness) *
                       std::pow(y, static_cast<long double>(material.law.exponent))
                 : 0.0L;
  };
  struct {
    long double y, v, memory;
  } at{0, speed, 0};
  const auto force = [&](const auto& state, long double spring) {
    return std::max(0.0L, spring * (1 + material.loss_s_per_m * state.v) - material.weight * state.memory);
  };
  const auto moved = [&](const auto& slope_at, long double step) {
    const long double spring = elastic(slope_at.y);
    auto to = at;
    to.y += step * slope_at.v;
    to.v -= step * force(slope_at, spring) / material.mass_kg;
    to.memory += step * (spring - slope_at.memory) / material.time_s;
    return to;
  };
  long double now = begin_s;
  std::vector<double> forces;
  for (const double time : times) {
    const long double step = (time - now) / kSteps;
    for (int i = 0; time > begin_s && i < kSteps; ++i) at = moved(moved(at, step / 2), step);
    if (time > begin_s) now = time;
    forces.push_back(static_cast<double>(time > begin_s ? force(at, elastic(at.y)) : 0.0L));
  }
  return forces;
}

/// A pulse at 44.1 kHz, with noise in parts of its largest force.
inline Pulse pulse_of(const TrueMaterial& material, double speed, double noise, Random& random,
                      double rate_hz = 44100) {
  const double duration = material.law.contact_duration(material.mass_kg, speed);
  Pulse pulse{"pulse", {}, {}, speed};
  for (double time = 0; time < 5 * duration; time = static_cast<double>(pulse.time_s.size()) / rate_hz)
    pulse.time_s.push_back(time);
  pulse.force_n = force_at(material, speed, duration * random.between(1.4, 1.6), pulse.time_s);
  const double deviation = noise * std::ranges::max(pulse.force_n);
  for (double& force : pulse.force_n) force += deviation * normal(random);
  return contact_window(pulse, std::vector<std::size_t>(pulse.time_s.size()), material.mass_kg);
}

/// `count` pulses at speeds of equal ratios.
inline std::vector<Pulse> pulses_of(const TrueMaterial& material, int count, double slowest, double fastest,
                                    double noise, Random& random) {
  std::vector<Pulse> pulses;
  for (int i = 0; i < count; ++i)
    pulses.push_back(pulse_of(material, slowest * std::pow(fastest / slowest, i / (count - 1.0)), noise, random));
  return pulses;
}

inline Measurements measurements_of(const TrueMaterial& material) {
  return {"probe", "", material.mass_kg, {}, {}, {}, names_of_laws(), names_of_losses(), {}};
}

}  // namespace contactspline::testing
