// SPDX-License-Identifier: MIT
// Weights at random for the samples of a network.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <vector>

#include "contactspline/tangent/network_numbers.hpp"
#include "support/random.hpp"

namespace contactspline::testing {

/// Displacements of some places get weights of -1 to 1, forces of all connections, which are large numbers, of -1e-6
/// to 1e-6.
inline NetworkWeights<double> random_weights(const NetworkPlan<double>& plan,
                                             std::initializer_list<std::size_t> places, std::size_t samples,
                                             Random random) {
  const auto any = [&](double size) {
    std::vector<double> weights(samples);
    for (double& weight : weights) weight = random.between(-size, size);
    return weights;
  };
  NetworkWeights<double> weights;
  weights.displacements.resize(plan.places().size());
  for (const std::size_t place : places) weights.displacements[place] = any(1);
  for (std::size_t k = 0; k < plan.connections().size(); ++k) weights.forces.push_back(any(1e-6));
  return weights;
}

/// The weight of number i of a list that has, for each sample, the displacement of a place and the forces of all
/// connections.
inline double weight_of(const NetworkWeights<double>& weights, std::size_t place, std::size_t i) {
  const std::size_t outputs = 1 + weights.forces.size(), n = i / outputs, k = i % outputs;
  return k == 0 ? weights.displacements[place][n] : weights.forces[k - 1][n];
}

}  // namespace contactspline::testing
