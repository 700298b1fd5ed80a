// SPDX-License-Identifier: MIT
#include "generator/spline/compensation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "generator/contact/barrier_impact.hpp"
#include "generator/support/error.hpp"
#include "generator/support/interpolation.hpp"

namespace contactspline {
namespace {

/// The law corrected for the time step, tabulated over the compression y of the exact law. Compression and force are
/// relative to max_compression_m and to the force there.
class TimeStepCorrectedLaw {
 public:
  explicit TimeStepCorrectedLaw(const Material& material)
      : law_(material.contact), range_(material.spline.max_compression_m) {
    const Compensation& compensation = *material.compensation;
    const double time_unit = std::sqrt(compensation.mass_kg * range_ / law_.force(range_));
    half_step_ = 1 / (2 * compensation.sample_rate_hz * time_unit);
    constexpr int kPoints = 4000;
    constexpr double kDecades = 4, kBeyond = 0.2;  // from 1e-4 to 1.6 of the largest compression
    for (const double y : law_.breaks())
      if (y < range_) breaks_.push_back(y / range_);
    std::vector<double> points = breaks_;
    for (int i = 0; i <= kPoints; ++i) points.push_back(std::pow(10, (kDecades + kBeyond) * i / kPoints - kDecades));
    std::ranges::sort(points);
    for (const double y : points) {
      q_.push_back(q_.back() + (y - y_.back()) * slope((y + y_.back()) / 2));
      y_.push_back(y);
      f_.push_back(force(y) / slope(y));
    }
  }

  [[nodiscard]] double corrected_compression(double y) const { return interpolated(y_, q_, y); }
  [[nodiscard]] double corrected_force(double q) const { return interpolated(q_, f_, q); }

  // Reduction of half the contact duration, for an impact with that energy and largest compression: the integral of
  // (1 - dq/dy) dy/v. The substitution y = largest sin^2(angle) removes the singularities at both ends.
  [[nodiscard]] double duration_reduction(double energy, double largest) const {
    const auto integrand = [&](double angle) {
      const double y = largest * std::sin(angle) * std::sin(angle);
      // Force times remaining distance is a lower bound; unlike the difference it does not cancel near the turning
      // point.
      const double bound = force(y) * largest * std::cos(angle) * std::cos(angle);
      const double kinetic = std::max(energy - law_.energy(y * range_) / (range_ * law_.force(range_)), bound);
      return (1 - slope(y)) * largest * std::sin(2 * angle) / std::sqrt(2 * kinetic);
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

  // dt/2 sqrt(F'/m) at a compression
  [[nodiscard]] double half_angle(double y) const {
    constexpr double kStep = 1e-4;
    const double stiffness = (force(y * (1 + kStep)) - force(y * (1 - kStep))) / (2 * kStep * y);
    return half_step_ * std::sqrt(std::max(0.0, stiffness));
  }

 private:
  [[nodiscard]] double force(double y) const { return law_.force(y * range_) / law_.force(range_); }

  // dq/dy = theta/tan(theta)
  [[nodiscard]] double slope(double y) const {
    const double theta = std::min(half_angle(y), kMaxHalfAngle);
    return theta < 1e-6 ? 1 : theta / std::tan(theta);
  }

  ContactLaw law_;
  double range_, half_step_;
  std::vector<double> breaks_{}, y_{0}, q_{0}, f_{0};
};

}  // namespace

void require_compensable(const Material& material, std::string_view file) {
  if (material.spline.knots == Knots::uniform)
    refuse(file, "compensation", "does not work with uniform knots", "with graded or optimal knots");
  if (material.spline.minimise != ErrorOf::contact_duration)
    refuse(file, "compensation",
           fmt::format("corrects the contact duration, not the {}", name_of(material.spline.minimise)),
           "with minimise contact_duration");
  const double rate = material.compensation->sample_rate_hz, mass_kg = material.compensation->mass_kg;
  constexpr double kMaxSamples = 1e4;
  const double slowest = material.impact->min_speed_m_per_s * std::sqrt(material.impact->mass_kg / mass_kg);
  const double samples = contact_duration(material.contact, mass_kg, slowest) * rate;
  const double min_rate = rate * largest_half_angle(material) / kMaxHalfAngle;
  if (min_rate > rate)
    refuse(file, "compensation.sample_rate_hz",
           fmt::format("{} is too low for the fastest impact of {} kg", rate, mass_kg),
           fmt::format("at least {:.0f}", std::ceil(min_rate)));
  if (!(samples <= kMaxSamples))
    refuse(file, "compensation.sample_rate_hz",
           fmt::format("{} makes the slowest impact of {} kg last {:.3g} samples, too many to need compensation",
                       rate, mass_kg, samples),
           fmt::format("a rate at which it lasts at most {:g}", kMaxSamples));
}

double largest_half_angle(const Material& material) {
  return TimeStepCorrectedLaw(material).half_angle(1);
}

CompensatedTarget compensated_target(const Material& material) {
  const auto corrected = std::make_shared<const TimeStepCorrectedLaw>(material);
  const FitTarget law = fit_target(material);
  const double end = corrected->corrected_compression(1);
  FitTarget target{
      [=](double y) { return end * corrected->corrected_force(end * y); },
      [=](double energy) { return corrected->corrected_compression(law.compression(energy)) / end; },
      [=](double energy) {
        return (law.half_duration(energy) - corrected->duration_reduction(energy, law.compression(energy))) / end;
      },
      corrected->corrected_compression(law.min_compression) / end,
      law.min_energy,
      law.max_energy,
      {},
      law.time_unit_s * end};
  if (material.contact.power_law() == nullptr) target.force = extrapolated(std::move(target.force));
  for (const Break& at : law.breaks)
    target.breaks.push_back({corrected->corrected_compression(at.compression) / end, at.energy, at.kink});
  return {tabulated(std::move(target)), end};
}

}  // namespace contactspline
