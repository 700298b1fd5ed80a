// SPDX-License-Identifier: MIT
// The least standard deviation that noise leaves to what is fitted to pulses: the bound of Cramer and Rao.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "fit/measured_impacts.hpp"
#include "generator/fit/impact_model.hpp"

namespace contactspline::testing {

inline ViscoelasticLaw<double> model_of(const TrueMaterial& truth, double reference_m) {
  return {std::log(truth.law.force(reference_m)),
          truth.law.exponent,
          truth.loss_s_per_m,
          truth.weight,
          truth.time_s,
          reference_m};
}

/// The least standard deviations that pulses at known speeds with normal noise allow. Their begins, offsets and
/// drifts are unknown, as they are to a fit. So are loss and memory of a material that has them.
class LeastDeviation {
 public:
  using Change = std::function<void(TrueMaterial&, double)>;

  /// noise: in parts of the largest force of each pulse.
  LeastDeviation(const TrueMaterial& truth, std::span<const Pulse> pulses, double noise) : truth_(truth) {
    changes_ = {[](TrueMaterial& m, double h) { m.law.stiffness *= std::exp(h); },
                [](TrueMaterial& m, double h) { m.law.exponent += h; }};
    if (truth.loss_s_per_m > 0) changes_.emplace_back([](TrueMaterial& m, double h) { m.loss_s_per_m += h; });
    if (truth.weight > 0) {
      changes_.emplace_back([](TrueMaterial& m, double h) { m.weight += h; });
      changes_.emplace_back([](TrueMaterial& m, double h) { m.time_s *= std::exp(h); });
    }
    const auto unknowns = static_cast<Eigen::Index>(changes_.size());
    information_ = Eigen::MatrixXd::Zero(unknowns, unknowns);
    for (const Pulse& pulse : pulses) add(pulse, noise);
  }

  /// That of a number that follows from the material.
  template <typename Number>
  [[nodiscard]] double deviation_of(Number number) const {
    Eigen::VectorXd slopes(information_.rows());
    for (Eigen::Index p = 0; p < slopes.size(); ++p)
      slopes[p] = (number(changed(p, kWidth)) - number(changed(p, -kWidth))) / (2 * kWidth);
    return std::sqrt(slopes.dot(information_.ldlt().solve(slopes)));
  }

 private:
  static constexpr double kWidth = 1e-4;  // of central differences

  [[nodiscard]] TrueMaterial changed(Eigen::Index p, double h) const {
    TrueMaterial material = truth_;
    changes_[static_cast<std::size_t>(p)](material, h);
    return material;
  }

  // What one pulse tells of the material, beside its begin and offset.
  void add(const Pulse& pulse, double noise) {
    const double window = pulse.time_s.back() - pulse.time_s.front();  // the contact, and as long before and after it
    const auto force = [&](const TrueMaterial& material, double begin_s) {
      Eigen::VectorXd forces(static_cast<Eigen::Index>(pulse.time_s.size()));
      EXPECT_TRUE(pulse_force(model_of(material, 1e-3), material.mass_kg, *pulse.speed_m_per_s, begin_s,
                              std::span(pulse.time_s), std::span<double>(forces.data(), pulse.time_s.size())));
      return forces;
    };
    const double begin_s = pulse.time_s.front() + window / 3, width_s = kWidth * window;
    const Eigen::VectorXd at = force(truth_, begin_s);
    Eigen::MatrixXd own(at.size(), 3), shared(at.size(), information_.rows());
    own << (force(truth_, begin_s + width_s) - force(truth_, begin_s - width_s)) / width_s,
        Eigen::VectorXd::Constant(at.size(), at.maxCoeff()),
        at.maxCoeff() * Eigen::VectorXd::LinSpaced(at.size(), -1, 1);
    for (Eigen::Index p = 0; p < shared.cols(); ++p)
      shared.col(p) = (force(changed(p, kWidth), begin_s) - force(changed(p, -kWidth), begin_s)) / (2 * kWidth);
    shared -= own * own.householderQr().solve(shared);
    information_ += shared.transpose() * shared / std::pow(noise * at.maxCoeff(), 2);
  }

  TrueMaterial truth_;
  std::vector<Change> changes_;
  Eigen::MatrixXd information_;
};

}  // namespace contactspline::testing
