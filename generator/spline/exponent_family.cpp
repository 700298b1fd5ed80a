// SPDX-License-Identifier: MIT
#include "generator/spline/exponent_family.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/support/number_literal.hpp"

namespace contactspline {
namespace {

constexpr int kDigits = 13;                // digits to which pow() agrees on all machines
constexpr double kMaxLowering = 0.5;       // largest fraction that a force is lowered by
constexpr double kDefaultSpeedRatio = 50;  // fastest over slowest impact, if the material has no impact
constexpr double kFirstKnot = 0.5;         // in compressions of the slowest impact

// Largest compression of an impact at a speed, relative to max_compression_m: ((a + 1) c)^(1/(a + 1)), where c is the
// energy relative to the largest force times max_compression_m.
double compression_at(const Material& material, double speed, double exponent) {
  const double range = material.spline.max_compression_m;
  const double c = material.impact->mass_kg * speed * speed / 2 / (material.contact.force(range) * range);
  return std::pow((exponent + 1) * c, 1 / (exponent + 1));
}

// Largest compression of the fastest impact at any exponent, relative to max_compression_m, and at least 1. As a
// function of a it has one maximum, at (a + 1) c = e.
double largest_compression(const Material& material) {
  if (!material.impact) return 1;
  const auto [min, max, members] = *material.live_exponent;
  const double range = material.spline.max_compression_m, speed = material.impact->max_speed_m_per_s;
  const double c = material.impact->mass_kg * speed * speed / 2 / (material.contact.force(range) * range);
  const double softest = std::clamp(std::numbers::e / c - 1, min, max);
  return std::max(1.0, rounded_to(compression_at(material, speed, softest), kDigits));
}

// The `segments` + 1 knots from 0 to the largest compression, relative to max_compression_m. The laws have the same
// force at max_compression_m, so the slowest impact compresses the law with the smallest exponent least.
std::vector<double> knots_of(const Material& material, int segments) {
  const double min = material.live_exponent->min, last = largest_compression(material);
  const double slowest = material.impact ? compression_at(material, material.impact->min_speed_m_per_s, min)
                                         : std::pow(kDefaultSpeedRatio, -2 / (min + 1));
  const double first = kFirstKnot * std::min(1.0, slowest);
  std::vector<double> knots = {0};
  for (int j = 1; j <= segments; ++j)
    knots.push_back(
        j == segments
            ? last
            : rounded_to(last * std::pow(first / last, static_cast<double>(segments - j) / (segments - 1)), kDigits));
  return knots;
}

// Force at knot j for the law y^a, lowered by h^2 F''/12 from the second knot on, but at most by half so that it
// still rises.
double force_at(const std::vector<double>& knots, std::size_t j, double exponent) {
  if (j == 0) return 0;
  const double y = knots[j];
  const double right = j + 1 < knots.size() ? knots[j + 1] - y : y - knots[j - 1];
  const double squared_width = (y - knots[j - 1]) * right / (y * y);
  const double lowering = j == 1 ? 0 : std::min(exponent * (exponent - 1) * squared_width / 12, kMaxLowering);
  return rounded_to(std::pow(y, exponent) * (1 - lowering), kDigits);
}

std::vector<Segment<double>> member(const std::vector<double>& knots, double exponent, double max_compression_m,
                                    double max_force_n) {
  std::vector<Segment<double>> segments;
  double energy = 0;
  for (std::size_t j = 0; j + 1 < knots.size(); ++j) {
    const double knot = knots[j] * max_compression_m;
    const double width = knots[j + 1] * max_compression_m - knot;
    const double force = force_at(knots, j, exponent) * max_force_n;
    const double next = force_at(knots, j + 1, exponent) * max_force_n;
    segments.push_back({knot, energy, force, (next - force) / (2 * width)});
    energy += (force + next) / 2 * width;
  }
  return segments;
}

}  // namespace

ExponentFamily exponent_family(const Material& material, int segments) {
  const auto [min, max, members] = *material.live_exponent;
  const double max_compression = material.spline.max_compression_m;
  const double max_force = rounded_to(material.contact.force(max_compression), kDigits);
  const auto knots = knots_of(material, segments);
  ExponentFamily family{};
  for (int i = 0; i < members; ++i)
    family.members.push_back(member(knots, min + (max - min) * i / (members - 1), max_compression, max_force));
  for (const Segment<double>& segment : family.members.front()) family.knots_m.push_back(segment.knot);
  family.max_compression_m = knots.back() * max_compression;
  return family;
}

PowerLaw law_of_family(const Material& material, double exponent) {
  const double range = material.spline.max_compression_m;
  return {material.contact.force(range) / std::pow(range, exponent), exponent};
}

std::vector<Segment<double>> blended(const ExponentFamily& family, const LiveExponents& range, double exponent) {
  const double position = (exponent - range.min) / (range.max - range.min) * (range.members - 1);
  const auto below = std::min(static_cast<std::size_t>(std::max(0.0, position)), family.members.size() - 2);
  const double t = position - static_cast<double>(below);
  std::vector<Segment<double>> segments;
  for (std::size_t j = 0; j < family.knots_m.size(); ++j) {
    const auto &low = family.members[below][j], &high = family.members[below + 1][j];
    segments.push_back({low.knot, std::lerp(low.energy, high.energy, t), std::lerp(low.force, high.force, t),
                        std::lerp(low.half_curvature, high.half_curvature, t)});
  }
  return segments;
}

std::optional<ImpactError> measure_family(const ExponentFamily& family, const Material& material) {
  if (!material.impact) return std::nullopt;
  constexpr int kBlends = 4;  // steps between two members
  const auto& range = *material.live_exponent;
  const double mass_kg = material.impact->mass_kg;
  const int steps = kBlends * (range.members - 1);
  ImpactError worst{0, 0};
  for (int i = 0; i <= steps; ++i) {
    const double exponent = range.min + (range.max - range.min) * i / steps;
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
