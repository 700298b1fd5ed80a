// SPDX-License-Identifier: MIT
#include "generator/energy_table.hpp"

#include <algorithm>
#include <boost/math/interpolators/cardinal_cubic_b_spline.hpp>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

namespace contactspline {
namespace {

/// Logarithms of a positive function over those of the energy. From a break on it departs like the root of the energy
/// beyond, so there is a table from each break to the next, by that root.
class Table {
 public:
  Table(const FitTarget& target, const std::function<double(double)>& exact)
      : starts_{std::log(target.least_energy)}, end_(std::log(target.most_energy)) {
    for (const Break& at : target.breaks)
      if (at.energy > target.least_energy && at.energy < target.most_energy) starts_.push_back(std::log(at.energy));
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
  return [table = std::make_shared<const Table>(target, exact)](double energy) { return (*table)(energy); };
}

}  // namespace

FitTarget tabulated(FitTarget target) {
  target.compression = table_of(target, target.compression);
  target.half_duration = table_of(target, target.half_duration);
  return target;
}

}  // namespace contactspline
