// SPDX-License-Identifier: MIT
#include "generator/live_exponent.hpp"

#include <algorithm>
#include <cmath>

#include "generator/literal.hpp"

namespace contactspline {
namespace {

constexpr int kDigits = 13;               // of pow()
constexpr double kSpeedRatioElse = 50;    // of a material without an impact
constexpr double kBelowTheSlowest = 0.5;  // first knot, in compressions of the slowest impact

// Knots from 0 to the largest compression, 1: `segments` + 1 of them. Of power laws with one force at 1, that of the
// least exponent is compressed least by the slowest impact: by (v_min/v_max)^(2/(a + 1)).
std::vector<double> knots_of(const Material& material, int segments) {
  const double ratio =
      material.impact ? material.impact->max_speed_m_per_s / material.impact->min_speed_m_per_s : kSpeedRatioElse;
  const double first =
      segments == 1
          ? 1
          : std::min(kBelowTheSlowest, kBelowTheSlowest * std::pow(ratio, -2 / (material.live_exponent->least + 1)));
  std::vector<double> knots = {0};
  for (int j = 1; j <= segments; ++j)
    knots.push_back(
        j == segments ? 1 : rounded_to(std::pow(first, static_cast<double>(segments - j) / (segments - 1)), kDigits));
  return knots;
}

// Force at knot j of y^a, below it by h^2 F''/12 where it has neighbours on both sides.
double force_at(const std::vector<double>& knots, std::size_t j, double exponent) {
  if (j == 0) return 0;
  const double y = knots[j];
  const double right = j + 1 < knots.size() ? knots[j + 1] - y : y - knots[j - 1];
  const double squared_width = (y - knots[j - 1]) * right / (y * y);
  const double below = j == 1 ? 0 : exponent * (exponent - 1) * squared_width / 12;
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
  ExponentFamily family;
  for (int i = 0; i < members; ++i)
    family.members.push_back(member(knots, least + (most - least) * i / (members - 1), max_compression, max_force));
  for (const Segment<double>& segment : family.members.front()) family.knots_m.push_back(segment.knot);
  return family;
}

}  // namespace contactspline
