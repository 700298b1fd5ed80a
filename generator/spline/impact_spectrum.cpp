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
  double half_time, phase, cosine, sine;  // cosine and sine of the phase w half_time
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

// The product of two complex numbers that are finite.
std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// The Fourier integral over a transit and its mirror image, at one angular frequency W after the other.
class RotatingTransit {
 public:
  RotatingTransit(const Transit& transit, double time, double step)
      : transit_(transit),
        angle_step_(step * transit.half_time),
        rotation_(std::polar(1.0, step * time)),
        half_rotation_(std::polar(1.0, angle_step_)) {}

  /// The integral at the present W; then W grows by the step.
  double integral_and_turn() {
    const auto& [half_time, phase, cosine, sine, middle, quadrature] = transit_;
    const double c = half_angle_.real(), s = half_angle_.imag();
    const double difference = sinc(angle_ - phase, s * cosine - c * sine);
    const double sum = sinc(angle_ + phase, s * cosine + c * sine);
    const double integral =
        2 * half_time *
        (middle * middle_angle_.real() * (difference + sum) + quadrature * middle_angle_.imag() * (difference - sum));
    middle_angle_ = product(middle_angle_, rotation_);
    half_angle_ = product(half_angle_, half_rotation_);
    angle_ += angle_step_;
    return integral;
  }

 private:
  Transit transit_;
  double angle_step_, angle_ = 0;                           // W half_time
  std::complex<double> rotation_, half_rotation_;           // over one step
  std::complex<double> middle_angle_ = 1, half_angle_ = 1;  // exp(j W time), exp(j W half_time)
};

}  // namespace

std::vector<double> impact_spectrum(const PiecewiseLinearForce& force, double energy, double step, int count) {
  std::vector<RotatingTransit> motion;
  double time = 0;  // middle of a transit, before the largest compression
  std::vector<Transit> found = transits(force, energy);
  std::ranges::reverse(found);
  for (const Transit& transit : found) {
    time += transit.half_time;
    motion.emplace_back(transit, time, step);
    time += transit.half_time;
  }
  std::vector<double> spectrum;
  for (int k = 0; k < count; ++k) {
    double sum = 0;
    for (RotatingTransit& transit : motion) sum += transit.integral_and_turn();
    spectrum.push_back(sum);
  }
  return spectrum;
}

}  // namespace contactspline
