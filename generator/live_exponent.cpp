// SPDX-License-Identifier: MIT
#include "generator/live_exponent.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generator/literal.hpp"

namespace contactspline {
namespace {

constexpr int kDigits = 13;               // of pow()
constexpr double kMostBelow = 0.5;        // of a force
constexpr double kSpeedRatioElse = 50;    // of a material without an impact
constexpr double kBelowTheSlowest = 0.5;  // first knot, in compressions of the slowest impact

// Compression by an impact at a speed, in parts of max_compression_m: ((a + 1) c)^(1/(a + 1)), c the energy in parts
// of largest force times compression.
double compression_at(const Material& material, double speed, double exponent) {
  const double range = material.spline.max_compression_m;
  const double c = material.impact->mass_kg * speed * speed / 2 / (material.contact.force(range) * range);
  return std::pow((exponent + 1) * c, 1 / (exponent + 1));
}

// The largest of the fastest impact: over a it has one maximum, at (a + 1) c = e.
double largest_compression(const Material& material) {
  if (!material.impact) return 1;
  const auto [least, most, members] = *material.live_exponent;
  const double range = material.spline.max_compression_m, speed = material.impact->max_speed_m_per_s;
  const double c = material.impact->mass_kg * speed * speed / 2 / (material.contact.force(range) * range);
  const double softest = std::clamp(std::numbers::e / c - 1, least, most);
  return std::max(1.0, rounded_to(compression_at(material, speed, softest), kDigits));
}

// Knots from 0 to the largest compression, in parts of max_compression_m: `segments` + 1 of them. Power laws with one
// force there are compressed least by the slowest impact at the least exponent.
std::vector<double> knots_of(const Material& material, int segments) {
  const double least = material.live_exponent->least, last = largest_compression(material);
  const double slowest = material.impact ? compression_at(material, material.impact->min_speed_m_per_s, least)
                                         : std::pow(kSpeedRatioElse, -2 / (least + 1));
  const double first = kBelowTheSlowest * std::min(1.0, slowest);
  std::vector<double> knots = {0};
  for (int j = 1; j <= segments; ++j)
    knots.push_back(
        j == segments
            ? last
            : rounded_to(last * std::pow(first / last, static_cast<double>(segments - j) / (segments - 1)), kDigits));
  return knots;
}

// Force at knot j of y^a, below it by h^2 F''/12 where it has neighbours on both sides; so far that it still rises.
double force_at(const std::vector<double>& knots, std::size_t j, double exponent) {
  if (j == 0) return 0;
  const double y = knots[j];
  const double right = j + 1 < knots.size() ? knots[j + 1] - y : y - knots[j - 1];
  const double squared_width = (y - knots[j - 1]) * right / (y * y);
  const double below = j == 1 ? 0 : std::min(exponent * (exponent - 1) * squared_width / 12, kMostBelow);
  return rounded_to(std::pow(y, exponent) * (1 - below), kDigits);
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
  const auto [least, most, members] = *material.live_exponent;
  const double max_compression = material.spline.max_compression_m;
  const double max_force = rounded_to(material.contact.force(max_compression), kDigits);
  const auto knots = knots_of(material, segments);
  ExponentFamily family{};
  for (int i = 0; i < members; ++i)
    family.members.push_back(member(knots, least + (most - least) * i / (members - 1), max_compression, max_force));
  for (const Segment<double>& segment : family.members.front()) family.knots_m.push_back(segment.knot);
  family.max_compression_m = knots.back() * max_compression;
  return family;
}

PowerLaw law_of_family(const Material& material, double exponent) {
  const double range = material.spline.max_compression_m;
  return {material.contact.force(range) / std::pow(range, exponent), exponent};
}

std::vector<Segment<double>> blended(const ExponentFamily& family, const LiveExponents& range, double exponent) {
  const double place = (exponent - range.least) / (range.most - range.least) * (range.members - 1);
  const auto below = std::min(static_cast<std::size_t>(std::max(0.0, place)), family.members.size() - 2);
  const double part = place - static_cast<double>(below);
  std::vector<Segment<double>> segments;
  for (std::size_t j = 0; j < family.knots_m.size(); ++j) {
    const auto &low = family.members[below][j], &high = family.members[below + 1][j];
    segments.push_back({low.knot, std::lerp(low.energy, high.energy, part), std::lerp(low.force, high.force, part),
                        std::lerp(low.half_curvature, high.half_curvature, part)});
  }
  return segments;
}

}  // namespace contactspline
