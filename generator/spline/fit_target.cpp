// SPDX-License-Identifier: MIT
#include "generator/spline/fit_target.hpp"

#include <algorithm>
#include <boost/math/interpolators/cardinal_cubic_b_spline.hpp>
#include <cmath>
#include <memory>
#include <utility>

#include "generator/contact/barrier_impact.hpp"

namespace contactspline {
namespace {

/// A positive function of the energy, interpolated in double-logarithmic scale. Above a break the function changes
/// like the square root of the energy difference. So each range between two breaks has its own table, over that
/// square root.
class EnergyTable {
 public:
  EnergyTable(const FitTarget& target, const std::function<double(double)>& exact)
      : starts_{std::log(target.min_energy)}, end_(std::log(target.max_energy)) {
    for (const Break& at : target.breaks)
      if (at.energy > target.min_energy && at.energy < target.max_energy) starts_.push_back(std::log(at.energy));
    const std::size_t points = starts_.size() > 1 ? 500 : 1000;
    for (std::size_t i = 0; i < starts_.size(); ++i) {
      const double next = i + 1 < starts_.size() ? starts_[i + 1] : end_;
      const double step = std::sqrt(next - starts_[i]) / static_cast<double>(points - 1);
      std::vector<double> logarithms;
      for (std::size_t k = 0; k < points; ++k) {
        const double root = step * static_cast<double>(k);
        logarithms.push_back(std::log(exact(std::exp(std::min(next, starts_[i] + root * root)))));
      }
      pieces_.emplace_back(logarithms.data(), points, 0.0, step);
      roots_.push_back(step * static_cast<double>(points - 1));
    }
  }

  double operator()(double energy) const {
    const double at = std::clamp(std::log(energy), starts_.front(), end_);
    const auto i = static_cast<std::size_t>(std::ranges::upper_bound(starts_, at) - starts_.begin()) - 1;
    return std::exp(pieces_[i](std::min(std::sqrt(at - starts_[i]), roots_[i])));
  }

 private:
  std::vector<double> starts_, roots_;
  double end_;
  std::vector<boost::math::interpolators::cardinal_cubic_b_spline<double>> pieces_;
};

std::function<double(double)> table_of(const FitTarget& target, const std::function<double(double)>& exact) {
  return [table = std::make_shared<const EnergyTable>(target, exact)](double energy) { return (*table)(energy); };
}

}  // namespace

std::function<double(double)> extrapolated(std::function<double(double)> force) {
  constexpr double kStep = 1e-4;
  const double exponent = (1 - force(1 - kStep)) / kStep;
  return [=, force = std::move(force)](double y) { return y <= 1 ? force(y) : std::pow(y, exponent); };
}

FitTarget tabulated(FitTarget target) {
  target.compression = table_of(target, target.compression);
  target.half_duration = table_of(target, target.half_duration);
  return target;
}

FitTarget fit_target(const Material& material) {
  const ContactLaw& contact = material.contact;
  const Impact impact = elastic_impact(material);
  const double range = material.spline.max_compression_m, max_force = contact.force(range);
  const double energy_unit = range * max_force, time_unit = std::sqrt(impact.mass_kg * range / max_force);
  const double slowest = std::min(impact.min_speed_m_per_s, impact.max_speed_m_per_s / 2);
  const auto energy_of = [&](double speed) { return impact.mass_kg * speed * speed / 2 / energy_unit; };
  const auto speed_of = [=, mass = impact.mass_kg](double energy) {
    return std::sqrt(2 * energy * energy_unit / mass);
  };
  FitTarget target{
      [=](double y) { return contact.force(y * range) / max_force; },
      [=, mass = impact.mass_kg](double energy) { return max_compression(contact, mass, speed_of(energy)) / range; },
      [=, mass = impact.mass_kg](double energy) {
        return contact_duration(contact, mass, speed_of(energy)) / (2 * time_unit);
      },
      max_compression(contact, impact.mass_kg, slowest) / range,
      energy_of(slowest),
      energy_of(impact.max_speed_m_per_s),
      {},
      time_unit};
  if (contact.power_law() != nullptr) return target;
  target.force = extrapolated(std::move(target.force));
  const bool layers = std::holds_alternative<PowerSum>(contact.law());
  for (const double y : contact.breaks())
    if (y < range) target.breaks.push_back({y / range, contact.energy(y) / energy_unit, layers});
  return tabulated(std::move(target));
}

}  // namespace contactspline
