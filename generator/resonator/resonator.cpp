// SPDX-License-Identifier: MIT
#include "generator/resonator/resonator.hpp"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace contactspline {
namespace {

using std::numbers::pi;

// The i-th positive root of J_order, and J_order+1 there.
struct BesselRoot {
  double root, next_order;
};

// Each is found once: the modes of a membrane are asked for again for each place on it.
const BesselRoot& bessel_root(int order, int i) {
  thread_local std::map<std::pair<int, int>, BesselRoot> roots;
  const auto [found, is_new] = roots.try_emplace({order, i});
  if (is_new) {
    const double root = boost::math::cyl_bessel_j_zero(static_cast<double>(order), i);
    found->second = {root, boost::math::cyl_bessel_j(order + 1, root)};
  }
  return found->second;
}

UndampedMode undamped_mode(const Membrane& membrane, int order, int i) {
  const auto [root, ring] = bessel_root(order, i);
  const double beta = root / membrane.radius_m;
  const double area = pi * membrane.radius_m * membrane.radius_m * (order == 0 ? 1.0 : 0.5);
  return {beta * std::sqrt(membrane.tension_n_per_m / membrane.mass_per_area_kg_m2), beta,
          membrane.mass_per_area_kg_m2 * area * ring * ring};
}

UndampedMode undamped_mode(const Plate& plate, int m, int n) {
  const double kx = m * pi / plate.length_m, ky = n * pi / plate.width_m, x = kx * kx, y = ky * ky;
  const auto [along, across, mixed] = bending_stiffness(plate);
  const double mass_per_area = plate.density_kg_m3 * plate.thickness_m;
  return {std::sqrt((along * x * x + 2 * mixed * x * y + across * y * y) / mass_per_area), std::sqrt(x + y),
          mass_per_area * plate.length_m * plate.width_m / 4};
}

// At a node sin() and Bessel functions return a rounding error, which differs between machines, instead of 0.
double without_rounding(double shape) {
  return std::abs(shape) < 1e-12 ? 0.0 : shape;
}

double natural_frequency(const ResonatorMode& mode) {
  return std::hypot(mode.mode.angular_frequency_rad_per_s, mode.mode.decay_per_s);
}

// The modes i = 1, 2, ... with undamped frequencies below the limit, at most max + 1 of them.
template <typename UndampedAt, typename ShapesOf>
std::vector<ResonatorMode> modes_while_below(double limit, std::size_t max, const Losses& losses,
                                             UndampedAt undamped_at, ShapesOf shapes_of) {
  std::vector<ResonatorMode> modes;
  detail::for_sounding_modes(limit, max + 1, losses, undamped_at, [&](const Mode& mode, double beta, int i) {
    const auto [strike, pickup] = shapes_of(beta, i);
    modes.push_back({mode, beta, without_rounding(strike), without_rounding(pickup)});
  });
  return modes;
}

std::size_t max_modes(const Resonator& resonator) {
  return static_cast<std::size_t>(resonator.max_modes);
}

std::vector<ResonatorMode> modes_below(const StiffString& string, const Resonator& resonator, double limit) {
  std::vector<ResonatorMode> modes;
  const auto strings = static_cast<double>(string.detuning_cents.size());
  for (const auto& [mode, beta] : modes_below(string, limit / (2 * pi), max_modes(resonator) + 1))
    modes.push_back({mode, beta, without_rounding(std::sin(beta * resonator.strike.position_m)) / strings,
                     without_rounding(std::sin(beta * resonator.pickup.position_m))});
  return modes;
}

std::vector<ResonatorMode> modes_below(const Bar& bar, const Resonator& resonator, double limit) {
  return modes_while_below(
      limit, max_modes(resonator), bar.losses, [&](int i) { return undamped_mode(bar, i); },
      [&](double beta, int i) {
        return std::pair(shape_at(bar, i, beta, resonator.strike.position_m),
                         shape_at(bar, i, beta, resonator.pickup.position_m));
      });
}

// Sorts by rising frequency and keeps at most max + 1 modes. Returns the limit above which no further mode is needed.
double keep_lowest(std::vector<ResonatorMode>& modes, std::size_t max, double limit) {
  std::ranges::stable_sort(modes, {}, natural_frequency);
  if (modes.size() <= max) return limit;
  modes.resize(max + 1);
  return natural_frequency(modes.back());
}

// J_m(beta r) cos(m angle), or its mean over a disc of radius a: 2 J_1(beta a)/(beta a) for m = 0, otherwise 0.
double shape_at(const Place& at, int order, double beta, double angle) {
  using boost::math::cyl_bessel_j;
  if (at.mean_radius_m == 0) return cyl_bessel_j(order, beta * at.position_m) * std::cos(order * angle);
  const double x = beta * at.mean_radius_m;
  return order == 0 ? 2 * cyl_bessel_j(1, x) / x : 0;
}

// The first zero of J_m rises with m, so the search ends at the first order without a mode below the limit.
std::vector<ResonatorMode> modes_below(const Membrane& membrane, const Resonator& resonator, double limit) {
  const Place& strike = resonator.strike;
  const Place& pickup = resonator.pickup;
  std::vector<ResonatorMode> modes;
  for (int order = 0;; ++order) {
    const auto found = modes_while_below(
        limit, max_modes(resonator), membrane.losses, [&](int i) { return undamped_mode(membrane, order, i); },
        [&](double beta, int) {
          return std::pair(shape_at(strike, order, beta, 0),
                           shape_at(pickup, order, beta, pickup.angle_rad - strike.angle_rad));
        });
    if (found.empty()) return modes;
    modes.insert(modes.end(), found.begin(), found.end());
    limit = keep_lowest(modes, max_modes(resonator), limit);
  }
}

// The first mode of a row rises with m, so the search ends at the first row without a mode below the limit.
std::vector<ResonatorMode> modes_below(const Plate& plate, const Resonator& resonator, double limit) {
  std::vector<ResonatorMode> modes;
  for (int m = 1;; ++m) {
    const double kx = m * pi / plate.length_m;
    const auto found = modes_while_below(
        limit, max_modes(resonator), plate.losses, [&](int n) { return undamped_mode(plate, m, n); },
        [&](double, int n) {
          const double ky = n * pi / plate.width_m;
          const auto shape = [&](const Place& at) {
            return std::sin(kx * at.position_m) * std::sin(ky * at.across_m);
          };
          return std::pair(shape(resonator.strike), shape(resonator.pickup));
        });
    if (found.empty()) return modes;
    modes.insert(modes.end(), found.begin(), found.end());
    limit = keep_lowest(modes, max_modes(resonator), limit);
  }
}

std::vector<ResonatorMode> modes_below(const ModeTable& table, const Resonator&, double limit) {
  std::vector<ResonatorMode> modes;
  for (const auto& [mode, strike_shape, pickup_shape] : table.rows)
    if (mode.angular_frequency_rad_per_s < limit) modes.push_back({mode, 0, strike_shape, pickup_shape});
  return modes;
}

}  // namespace

PlateStiffness bending_stiffness(const Plate& plate) {
  const double other_ratio = plate.poisson_ratio * plate.youngs_modulus_across_pa / plate.youngs_modulus_pa;
  const double cube = std::pow(plate.thickness_m, 3) / 12;
  const double along = plate.youngs_modulus_pa * cube / (1 - plate.poisson_ratio * other_ratio);
  return {along, along * plate.youngs_modulus_across_pa / plate.youngs_modulus_pa,
          other_ratio * along + 2 * plate.shear_modulus_pa * cube};
}

std::string_view name_of(const decltype(Resonator::body)& body) {
  constexpr std::array<std::string_view, std::variant_size_v<decltype(Resonator::body)>> kNames = {
      "string", "bar", "membrane", "plate", "modes"};  // in the order of the variant
  return kNames[body.index()];
}

ModeSet modes_of(const Resonator& resonator, double max_frequency_hz) {
  const double limit = 2 * pi * max_frequency_hz;
  auto modes = std::visit([&](const auto& body) { return modes_below(body, resonator, limit); }, resonator.body);
  keep_lowest(modes, max_modes(resonator), limit);
  const bool cut = modes.size() > max_modes(resonator);
  if (cut) modes.resize(max_modes(resonator));
  return {std::move(modes), cut};
}

}  // namespace contactspline
