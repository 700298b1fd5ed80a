// SPDX-License-Identifier: MIT
// Single strikes to run, and how far rounding may take them apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "material_under_test.hpp"
#include "strike.hpp"

namespace contactspline::testing {

inline constexpr std::size_t kSamplesAfter = 10;
inline constexpr std::size_t kMaxSamples = 20000;

// A mass that reaches the end of the table at 6 m/s.
inline double mass_for(const MaterialUnderTest& material) {
  return 2 * potential(material.in_double.table, material.max_compression_m) / 36;
}

// Until the mass moves back, as the twin in double has it.
inline std::size_t samples_of(const MaterialUnderTest& material, const Strike& strike) {
  MassBarrier<double> model(material.in_double.table, strike.sample_rate_hz);
  model.throw_from(strike.start_m, strike.speed_m_per_s);
  const auto controls = controls_of<double>(strike);
  std::size_t samples = 0;
  do {
    model.tick(controls);
    ++samples;
  } while (samples < kMaxSamples && !(model.displacement() < 0 && model.velocity() < 0));
  return samples + kSamplesAfter;
}

// From slow to beyond the table, from soft to a contact within one sample, without and with loss or gravity.
inline std::vector<Strike> strikes_on(const MaterialUnderTest& material) {
  struct Force {
    double loss_s_per_m, gravity_m_per_s2;
  };
  std::vector<Strike> strikes;
  for (const int rate : {44100, 192000})
    for (const double speed : {0.1, 1.0, 6.0, 12.0})
      for (const double ratio : {0.01, 1.0, 1000.0})
        for (const auto [loss, gravity] : {Force{0, 0}, Force{0.3, 0}, Force{0, 9.81}}) {
          Strike strike{rate, speed, -2.3 * speed / rate, mass_for(material), ratio, loss, gravity, 0};
          strike.samples = samples_of(material, strike);
          strikes.push_back(strike);
        }
  return strikes;
}

struct Difference {
  double displacement = 0, force = 0;
};

inline std::ostream& operator<<(std::ostream& out, const Difference& difference) {
  return out << "displacement " << difference.displacement << ", force " << difference.force;
}

inline void widen(Difference& worst, const Difference& seen) {
  worst = {std::max(worst.displacement, seen.displacement), std::max(worst.force, seen.force)};
}

template <typename A, typename B>
double largest_difference(const std::vector<A>& a, const std::vector<B>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  return largest;
}

template <typename T>
double peak(const std::vector<T>& values) {
  double largest = 0;
  for (const T value : values) largest = std::max(largest, std::abs(static_cast<double>(value)));
  return largest;
}

template <typename A, typename B>
Difference difference(const Motion<A>& a, const Motion<B>& b) {
  return {largest_difference(a.displacement, b.displacement), largest_difference(a.force, b.force)};
}

// What rounding to unit roundoff u can do to a strike of n samples, of which k in contact:
// - every sample rounds displacement and velocity: u n times the path, and that again through the velocity;
// - in contact, rounding the displacement by u q changes the stored energy by V'(q) u q, hence the speed by
//   V'(q) u q/(m v), which the mass flies on with for up to n samples;
// - the force follows the displacement with the stiffness of the table, or 2/xi = 4 m/dt^2 where that is less, and is
//   itself within 16 u m v/dt (the bound of step_test.cpp with x = v dt).
inline Difference rounding_bound(const MaterialUnderTest& material, const Strike& strike,
                                 const Motion<double>& exact) {
  constexpr double kRoundoff = 0x1p-24;
  const auto table = material.in_double.table;
  const double dt = 1.0 / strike.sample_rate_hz;
  const double n = static_cast<double>(strike.samples);
  const double speed = strike.speed_m_per_s + strike.gravity_m_per_s2 * n * dt;
  const double deepest = *std::ranges::max_element(exact.displacement);
  const double k = static_cast<double>(std::ranges::count_if(exact.force, [](double f) { return f > 0; }));
  const double viscous = 1 + strike.loss_s_per_m * speed;
  double stiffness = 0;
  for (std::size_t j = 1; j <= segment_index(table, deepest); ++j)
    stiffness = std::max(stiffness, 2 * table[j].half_curvature * strike.stiffness_ratio * viscous);
  const double impulse = strike.stiffness_ratio * viscous * force(table, deepest) * dt / (strike.mass_kg * speed);
  const double displacement = kRoundoff * n * (4 * n * speed * dt + k * impulse * (deepest + speed * dt));
  const double momentum = strike.mass_kg * speed / dt;
  return {displacement,
          std::min(stiffness, 4 * strike.mass_kg / (dt * dt)) * displacement + 16 * kRoundoff * momentum};
}

/// The bound asked for: rounding in single, twelve digits of the peak in double.
template <std::floating_point T>
Difference bound_in(const MaterialUnderTest& material, const Strike& strike, const Motion<double>& exact) {
  if constexpr (std::same_as<T, double>)
    return {1e-12 * peak(exact.displacement), 1e-12 * peak(exact.force)};
  else
    return rounding_bound(material, strike, exact);
}

/// Relative to the peaks.
inline Difference relative(const Difference& difference, const Motion<double>& exact) {
  return {difference.displacement / peak(exact.displacement), difference.force / peak(exact.force)};
}

}  // namespace contactspline::testing
