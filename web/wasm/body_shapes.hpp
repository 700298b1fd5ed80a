// SPDX-License-Identifier: MIT
// Membranes, circular plates and bars, found among the bodies of an instrument, and their displacement anywhere.
#pragma once

#include <math.h>  // jn() of POSIX, which <cmath> need not have

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/modal/modal.hpp"
#include "generator/resonator/bar.hpp"
#include "generator/resonator/round_plate.hpp"

namespace contactspline::web {

/// A mode of a body, with its undamped frequency and its mass over those of the lowest one.
struct RelativeMode {
  std::size_t number;
  double frequency, mass;
};

/// By rising frequency.
[[nodiscard]] inline std::vector<RelativeMode> relative_modes(const InstrumentData& data, std::size_t body) {
  const auto w = data.part_of(data.angular_frequencies, body), decays = data.part_of(data.decays, body);
  const auto masses = data.part_of(data.masses, body);
  std::vector<RelativeMode> modes;
  for (std::size_t k = 0; k < w.size(); ++k) modes.push_back({k, std::hypot(w[k], decays[k]), masses[k]});
  std::ranges::sort(modes, {}, &RelativeMode::frequency);
  const RelativeMode lowest = modes.front();
  for (RelativeMode& mode : modes) mode.frequency /= lowest.frequency, mode.mass /= lowest.mass;
  return modes;
}

inline constexpr double kWithin = 1e-7;  // emitted numbers have 13 digits

[[nodiscard]] inline bool is_near(double x, double expected) {
  return std::abs(x / expected - 1) < kWithin;
}

/// A membrane with a fixed rim, or a circular plate, in parts of its radius. Mode k has the shape J_m(x r) cos(m
/// angle) with a zero x of J_m, or that of RoundPlate.
class DiscShapes {
 public:
  /// Nothing where a body of an instrument is neither: frequencies and masses of all modes must be those of zeros or
  /// roots.
  static std::optional<DiscShapes> of(const InstrumentData& data, std::size_t body) {
    const std::vector<RelativeMode> modes = relative_modes(data, body);
    if (modes.size() < 10) return {};
    if (auto membrane = membrane_of(modes)) return membrane;
    if (auto clamped = plate_of(modes, plate(PlateRim::kClamped, 0))) return clamped;
    return plate_of(modes, plate(PlateRim::kFree, poisson_ratio_of(modes[1].frequency)));
  }

  [[nodiscard]] bool is_plate() const { return plate_.has_value(); }
  [[nodiscard]] bool has_free_rim() const { return plate_ && plate_->rim == PlateRim::kFree; }

  [[nodiscard]] ModeShapes<double> at(double r, double angle) const {
    ModeShapes<double> shapes(modes_.size());
    for (std::size_t k = 0; k < modes_.size(); ++k) shapes[k] = radial(k, r) * std::cos(modes_[k].order * angle);
    return shapes;
  }

  /// Where a place with these shapes is on the diameter through the strike, -1 to 1.
  [[nodiscard]] double along_diameter(std::span<const double> shapes) const {
    const auto of_order = [&](int m) {
      return static_cast<std::size_t>(std::ranges::find(modes_, m, &Numbered::order) - modes_.begin());
    };
    const std::size_t round = of_order(0), tilted = of_order(1);
    if (round == modes_.size()) return 0;
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (radial(round, middle) > shapes[round] ? low : high) = middle;
    }
    return tilted == modes_.size() ? low : std::copysign(low, shapes[tilted] * radial(tilted, low));
  }

 private:
  struct Numbered {
    int order;
    double root;
  };
  static constexpr double kFirstZero = 2.404825557695773;  // of J_0

  [[nodiscard]] double radial(std::size_t k, double r) const {
    const auto& [order, root] = modes_[k];
    return plate_ ? radial_shape(*plate_, order, root, r) : jn(order, root * r);
  }

  using Modes = std::span<const RelativeMode>;

  static std::optional<DiscShapes> membrane_of(Modes modes) {
    DiscShapes found;
    found.modes_.resize(modes.size());
    for (const auto& [number, frequency, mass] : modes) {
      const double x = kFirstZero * frequency;
      const auto order = order_of(x, mass);
      if (!order) return {};
      found.modes_[number] = {*order, x};
    }
    return found;
  }

  // The modal mass is the area's, half of it for m > 0, times J_{m+1}(x)^2.
  static std::optional<int> order_of(double x, double mass_ratio) {
    const double first = std::pow(jn(1, kFirstZero), 2);
    for (int m = 0; m <= x; ++m) {
      const double expected = (m == 0 ? 1 : 0.5) * std::pow(jn(m + 1, x), 2) / first;
      if (std::abs(jn(m, x)) < kWithin && is_near(mass_ratio, expected)) return m;
    }
    return {};
  }

  // Of radius 1; the ratios of its frequencies and masses depend on nothing else.
  static RoundPlate plate(PlateRim rim, double poisson_ratio) {
    return {.radius_m = 1,
            .thickness_m = 1,
            .density_kg_m3 = 1,
            .youngs_modulus_pa = 1,
            .poisson_ratio = poisson_ratio,
            .losses = {},
            .rim = rim};
  }

  // Of a free rim, whose lowest modes have two nodal diameters, and none: the ratio of their frequencies rises with
  // it.
  static double poisson_ratio_of(double second_frequency) {
    double low = 0, high = 0.499;
    for (int i = 0; i < 50; ++i) {
      const RoundPlate tried = plate(PlateRim::kFree, (low + high) / 2);
      const double ratio = root(tried, 0, 1) / root(tried, 2, 1);
      (ratio * ratio < second_frequency ? low : high) = tried.poisson_ratio;
    }
    return (low + high) / 2;
  }

  static double root(const RoundPlate& plate, int order, int i) {
    return undamped_mode(plate, order, i).wavenumber_per_m;
  }

  static std::optional<DiscShapes> plate_of(Modes modes, const RoundPlate& plate) {
    const bool is_free = plate.rim == PlateRim::kFree;
    const double first = root(plate, is_free ? 2 : 0, 1);
    if (!is_near(modes[1].frequency, std::pow(root(plate, is_free ? 0 : 1, 1) / first, 2))) return {};
    const double highest = 1.001 * first * std::sqrt(modes.back().frequency);
    std::vector<std::pair<double, Numbered>> all;  // with their masses
    for (int m = 0; m < 2 || root(plate, m, 1) < highest; ++m)
      for (int i = 1; root(plate, m, i) < highest; ++i) {
        const UndampedMode mode = undamped_mode(plate, m, i);
        all.push_back({mode.mass_kg, {m, mode.wavenumber_per_m}});
      }
    std::ranges::sort(all, {}, [](const auto& one) { return one.second.root; });
    if (all.size() < modes.size()) return {};
    DiscShapes found;
    found.plate_ = plate;
    found.modes_.resize(modes.size());
    for (std::size_t k = 0; k < modes.size(); ++k) {
      const auto& [mass, numbered] = all[k];
      if (!is_near(modes[k].frequency, std::pow(numbered.root / first, 2))) return {};
      if (!is_near(modes[k].mass, mass / all[0].first)) return {};
      found.modes_[modes[k].number] = numbered;
    }
    return found;
  }

  std::vector<Numbered> modes_;
  std::optional<RoundPlate> plate_;
};

/// The points of a disc that are drawn: the middle, then so many rings of equal distance, within a fixed rim or up to
/// a free one, each with so many points from the angle 0 to pi. Below is the same: all shapes are even.
inline constexpr std::size_t kRings = 7, kRingPoints = 13;

inline std::vector<ModeShapes<double>> disc_points(const DiscShapes& disc) {
  std::vector<ModeShapes<double>> points = {disc.at(0, 0)};
  const double rings = disc.has_free_rim() ? kRings : kRings + 1;
  for (std::size_t ring = 1; ring <= kRings; ++ring)
    for (std::size_t p = 0; p < kRingPoints; ++p)
      points.push_back(
          disc.at(static_cast<double>(ring) / rings, std::numbers::pi * static_cast<double>(p) / (kRingPoints - 1)));
  return points;
}

/// A bar with two free ends, in parts of its length.
class BarShapes {
 public:
  /// Nothing where a body of an instrument is no such bar.
  static std::optional<BarShapes> of(const InstrumentData& data, std::size_t body) {
    const std::vector<RelativeMode> modes = relative_modes(data, body);
    if (modes.size() < 3) return {};
    for (const auto& [number, frequency, mass] : modes) {
      const double ratio =
          wavenumber_times_length(kBar, static_cast<int>(number) + 1) / wavenumber_times_length(kBar, 1);
      if (!is_near(frequency, ratio * ratio) || !is_near(mass, 1)) return {};
    }
    BarShapes found;
    found.modes_ = modes.size();
    return found;
  }

  [[nodiscard]] ModeShapes<double> at(double x) const {
    ModeShapes<double> shapes(modes_);
    for (std::size_t k = 0; k < modes_; ++k) {
      const int i = static_cast<int>(k) + 1;
      shapes[k] = shape_at(kBar, i, wavenumber_times_length(kBar, i), x);
    }
    return shapes;
  }

  /// Where a place with these shapes is, within a thousandth.
  [[nodiscard]] double along(std::span<const double> shapes) const {
    constexpr int kTried = 1000;
    double best = 0, least = HUGE_VAL;
    for (int i = 0; i <= kTried; ++i) {
      const double x = static_cast<double>(i) / kTried;
      const ModeShapes<double> tried = at(x);
      double apart = 0;
      for (std::size_t k = 0; k < modes_; ++k) apart += std::pow(tried[k] - shapes[k], 2);
      if (apart < least) least = apart, best = x;
    }
    return best;
  }

 private:
  static inline const Bar kBar{.length_m = 1, .mass_kg = 1, .bending_stiffness_n_m2 = 1, .losses = {}};
  std::size_t modes_ = 0;
};

}  // namespace contactspline::web
