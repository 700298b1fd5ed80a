// SPDX-License-Identifier: MIT
#include "generator/material/friction_reader.hpp"

#include <cmath>
#include <limits>

namespace contactspline {
namespace {

constexpr Range kBristleDamping{0, 100};
constexpr Range kSoftening{0.1, 1e4}, kCapacity{1e-12, 1e3}, kConduction{0, 1e3}, kRenewal{0, 1e6};
constexpr double kDefaultWidth_m = 0.01;

Bristles read_bristles(const JsonObject& friction) {
  const JsonObject bristles = friction.object("bristles", {"stiffness_per_m", "damping_s_per_m"});
  return {bristles.number("stiffness_per_m", kBristleStiffness_per_m),
          bristles.has("damping_s_per_m") ? bristles.number("damping_s_per_m", kBristleDamping) : 0};
}

FrictionHeat read_heat(const JsonObject& friction) {
  const JsonObject heat =
      friction.object("heat", {"cold_coefficient", "hot_coefficient", "softening_k", "capacity_j_per_n_k",
                               "conduction_w_per_n_k", "renewal_w_per_m_k2"});
  const double cold = heat.number("cold_coefficient", kFrictionCoefficient);
  return {.cold_coefficient = cold,
          .hot_coefficient = heat.number("hot_coefficient", {kFrictionCoefficient.min, cold}),
          .softening_k = heat.number("softening_k", kSoftening),
          .capacity_j_per_n_k = heat.number("capacity_j_per_n_k", kCapacity),
          .conduction_w_per_n_k = heat.number("conduction_w_per_n_k", kConduction),
          .renewal_w_per_m_k2 = heat.number("renewal_w_per_m_k2", kRenewal)};
}

}  // namespace

RubbingSurfaces parse_friction(std::string_view text, std::string_view file) {
  const JsonObject friction =
      parse_json(text, file, "friction", {"name", "description", "bristles", "coefficient", "heat", "width_m"});
  RubbingSurfaces read{read_local_name(friction), read_description(friction), {}, kDefaultWidth_m};
  const Bristles bristles = read_bristles(friction);
  if (one_of_keys(friction, {"coefficient", "heat"}, "laws") == "heat") {
    read.friction = {bristles, read_heat(friction)};
    if (friction.has("width_m")) read.width_m = friction.number("width_m", kRubbingWidth_m);
  } else {
    read.friction = coulomb_friction(friction.number("coefficient", kFrictionCoefficient), bristles);
    if (friction.has("width_m")) friction.fail("width_m", "stands beside coefficient", "beside heat");
  }
  return read;
}

double coefficient_at(const RubbingSurfaces& surfaces, double temperature_k) {
  const FrictionHeat& heat = surfaces.friction.heat;
  const double ratio = temperature_k / heat.softening_k;
  return heat.hot_coefficient + (heat.cold_coefficient - heat.hot_coefficient) / (1 + ratio * ratio);
}

Sliding steady_sliding(const RubbingSurfaces& surfaces, double speed_m_per_s, double normal_force_n) {
  const FrictionHeat& heat = surfaces.friction.heat;
  if (!surfaces.warms()) return {heat.cold_coefficient, 0};
  const double power_w = normal_force_n * speed_m_per_s;  // for a coefficient of 1
  const double cooling_w_per_k =
      std::sqrt(heat.renewal_w_per_m_k2 * surfaces.width_m * power_w) + heat.conduction_w_per_n_k * normal_force_n;
  if (cooling_w_per_k == 0) return {heat.hot_coefficient, std::numeric_limits<double>::infinity()};
  double low = 0, high = heat.cold_coefficient * power_w / cooling_w_per_k;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (coefficient_at(surfaces, middle) * power_w > cooling_w_per_k * middle ? low : high) = middle;
  }
  return {coefficient_at(surfaces, low), low};
}

}  // namespace contactspline
