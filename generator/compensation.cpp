// SPDX-License-Identifier: MIT
#include "generator/compensation.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "generator/design.hpp"
#include "generator/energy_table.hpp"

namespace contactspline {
namespace {

/// The bent law in a material's pure numbers, tabulated by the compression of the law itself.
class BentLaw {
 public:
  explicit BentLaw(const Material& material) : law_(material.contact), range_(material.spline.max_compression_m) {
    const Compensation& compensation = *material.compensation;
    const double second = std::sqrt(compensation.mass_kg * range_ / law_.force(range_));
    half_step_ = 1 / (2 * compensation.sample_rate_hz * second);
    constexpr int kPoints = 4000;
    constexpr double kDecades = 4, kBeyond = 0.2;  // from 1e-4 to 1.6 of the largest compression
    for (const double y : law_.breaks())
      if (y < range_) breaks_.push_back(y / range_);
    std::vector<double> places = breaks_;
    for (int i = 0; i <= kPoints; ++i) places.push_back(std::pow(10, (kDecades + kBeyond) * i / kPoints - kDecades));
    std::ranges::sort(places);
    for (const double y : places) {
      q_.push_back(q_.back() + (y - y_.back()) * shrinking((y + y_.back()) / 2));
      y_.push_back(y);
      f_.push_back(force(y) / shrinking(y));
    }
  }

  [[nodiscard]] double bent_compression(double y) const { return between(y_, q_, y); }
  [[nodiscard]] double bent_force(double q) const { return between(q_, f_, q); }

  // By which half a contact of that energy and largest compression is shorter: the integral of (1 - dq/dy) dy/v, with
  // y = largest sin^2 to smooth both ends.
  [[nodiscard]] double gain(double energy, double largest) const {
    const auto integrand = [&](double angle) {
      const double y = largest * std::sin(angle) * std::sin(angle);
      // No less than force times way, which does not cancel where the turning point is near.
      const double least = force(y) * largest * std::cos(angle) * std::cos(angle);
      const double left = std::max(energy - law_.energy(y * range_) / (range_ * law_.force(range_)), least);
      return (1 - shrinking(y)) * largest * std::sin(2 * angle) / std::sqrt(2 * left);
    };
    double sum = 0, from = 0;
    const auto add = [&](double to) {
      sum += boost::math::quadrature::gauss<double, 40>::integrate(integrand, from, to);
      from = to;
    };
    for (const double y : breaks_)
      if (y < largest) add(std::asin(std::sqrt(y / largest)));
    add(std::numbers::pi / 2);
    return sum;
  }

  [[nodiscard]] double half_angle(double y) const {
    constexpr double kStep = 1e-4;
    const double stiffness = (force(y * (1 + kStep)) - force(y * (1 - kStep))) / (2 * kStep * y);
    return half_step_ * std::sqrt(std::max(0.0, stiffness));
  }

 private:
  [[nodiscard]] double force(double y) const { return law_.force(y * range_) / law_.force(range_); }

  // dq/dy
  [[nodiscard]] double shrinking(double y) const {
    const double theta = std::min(half_angle(y), kMostHalfAngle);
    return theta < 1e-6 ? 1 : theta / std::tan(theta);
  }

  static double between(const std::vector<double>& x, const std::vector<double>& values, double at) {
    const auto above = std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(x, at) - x.begin(), 1, std::ssize(x) - 1);
    const auto i = static_cast<std::size_t>(above);
    return std::lerp(values[i - 1], values[i], (at - x[i - 1]) / (x[i] - x[i - 1]));
  }

  Potential law_;
  double range_, half_step_;
  std::vector<double> breaks_{}, y_{0}, q_{0}, f_{0};
};

}  // namespace

double largest_half_angle(const Material& material) {
  return BentLaw(material).half_angle(1);
}

CompensatedTarget compensated_target(const Material& material) {
  const auto bent = std::make_shared<const BentLaw>(material);
  const FitTarget law = fit_target(material);
  const double end = bent->bent_compression(1);
  FitTarget target{
      [=](double y) { return end * bent->bent_force(end * y); },
      [=](double energy) { return bent->bent_compression(law.compression(energy)) / end; },
      [=](double energy) { return (law.half_duration(energy) - bent->gain(energy, law.compression(energy))) / end; },
      bent->bent_compression(law.least_compression) / end,
      law.least_energy,
      law.most_energy};
  if (material.contact.power_law() == nullptr) target.force = continued(std::move(target.force));
  for (const Break& at : law.breaks)
    target.breaks.push_back({bent->bent_compression(at.compression) / end, at.energy, at.kink});
  return {tabulated(std::move(target)), end};
}

double missing_compliance(std::span<const ResonatorMode> modes, double sample_rate_hz) {
  double compliance = 0;
  for (const auto& [mode, wavenumber, strike, pickup] : modes) {
    const double theta = mode.angular_frequency_rad_per_s / (2 * sample_rate_hz);
    const double lacking = 1 / (theta * theta) - 1 / (std::tan(theta) * std::tan(theta));
    compliance += strike * strike / mode.mass_kg * lacking / (4 * sample_rate_hz * sample_rate_hz);
  }
  return compliance;
}

std::vector<Segment<double>> in_series(std::vector<Segment<double>> table, double compliance_m_per_n) {
  for (auto& segment : table) {
    segment.knot += compliance_m_per_n * segment.force;
    segment.energy += compliance_m_per_n * segment.force * segment.force / 2;
    segment.half_curvature /= 1 + 2 * compliance_m_per_n * segment.half_curvature;
  }
  return table;
}

}  // namespace contactspline
