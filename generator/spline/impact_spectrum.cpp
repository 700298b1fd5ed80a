// SPDX-License-Identifier: MIT
#include "generator/spline/impact_spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace contactspline {
namespace {

// The motion through one segment, about the middle of its time: at the time s from there, the force is
// force cos(phase s/half_time) - quadrature sin(phase s/half_time).
struct Transit {
  double half_time, phase, cosine, sine;  // of the phase w half_time
  double force, quadrature;               // quadrature: w times the speed, for a unit mass
};

// Speeds v0 > v1 and forces f0 < f1 at the ends of a segment of width dy.
Transit transit_of(double dy, double f0, double f1, double v0, double v1) {
  const double w = std::sqrt((f1 - f0) / dy), x = w * dy / (v0 + v1), cosine = 1 / std::hypot(1.0, x);
  const double phase = std::atan(x);
  return {w == 0 ? dy / (v0 + v1) : phase / w, phase, cosine, x * cosine, (f0 + f1) / (2 * cosine),
          w * (v0 + v1) / (2 * cosine)};
}

// The transits from the first touch to the largest compression.
std::vector<Transit> transits(const PiecewiseLinearForce& force, double energy) {
  std::vector<Transit> found;
  double stored = 0, v0 = std::sqrt(2 * energy);
  for (std::size_t j = 0;; ++j) {
    const double width = force.y[j + 1] - force.y[j], f0 = force.f[j], rise = force.f[j + 1] - f0;
    const double left = energy - stored;
    stored += (f0 + rise / 2) * width;
    if (j + 1 == force.segments() || stored >= energy) {
      const double beyond = 2 * left / (f0 + std::sqrt(f0 * f0 + 2 * rise / width * left));
      found.push_back(transit_of(beyond, f0, f0 + rise / width * beyond, v0, 0));
      return found;
    }
    const double v1 = std::sqrt(2 * (energy - stored));
    found.push_back(transit_of(width, f0, f0 + rise, v0, v1));
    v0 = v1;
  }
}

// sin(x)/x for a sine that is known.
double sinc(double x, double sine) {
  return std::abs(x) < 1e-7 ? 1 : sine / x;
}

}  // namespace

std::vector<double> impact_spectrum(const PiecewiseLinearForce& force, double energy, double step, int count) {
  std::vector<double> spectrum(static_cast<std::size_t>(count));
  const std::vector<Transit> motion = transits(force, energy);
  double time = 0;  // before the largest compression
  for (auto at = motion.rbegin(); at != motion.rend(); ++at) {
    const auto& [half_time, phase, cosine, sine, middle, quadrature] = *at;
    time += half_time;
    const std::complex<double> rotation = std::polar(1.0, step * time),
                               half_rotation = std::polar(1.0, step * half_time);
    std::complex<double> middle_angle = 1, half_angle = 1;  // exp(j W time), exp(j W half_time)
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      const double angle = static_cast<double>(k) * step * half_time;
      const double c = half_angle.real(), s = half_angle.imag();
      const double difference = sinc(angle - phase, s * cosine - c * sine);
      const double sum = sinc(angle + phase, s * cosine + c * sine);
      spectrum[k] +=
          2 * half_time *
          (middle * middle_angle.real() * (difference + sum) + quadrature * middle_angle.imag() * (difference - sum));
      middle_angle = {middle_angle.real() * rotation.real() - middle_angle.imag() * rotation.imag(),
                      middle_angle.real() * rotation.imag() + middle_angle.imag() * rotation.real()};
      half_angle = {c * half_rotation.real() - s * half_rotation.imag(),
                    c * half_rotation.imag() + s * half_rotation.real()};
    }
    time += half_time;
  }
  return spectrum;
}

}  // namespace contactspline
