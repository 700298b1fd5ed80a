// SPDX-License-Identifier: MIT
// What rounding adds to the energy of a body that stretches.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "contactspline/data/stretch_form.hpp"

namespace contactspline::testing {

// What forms would store at these displacements if their terms had one sign [J].
template <typename T>
double energy_of_terms(std::span<const StretchForm> forms, std::span<const T> displacements) {
  double energy = 0;
  const auto q = [&](std::size_t i) { return std::abs(double(displacements[i])); };
  for (const StretchForm& form : forms) {
    double sum = form.linear.factor_per_m == 0 ? 0 : std::abs(form.linear.factor_per_m) * q(form.linear.mode);
    for (std::size_t i = 0; i < displacements.size(); ++i) sum += std::abs(form.squares_per_m2[i]) * q(i) * q(i);
    for (const auto& [i, j, factor] : form.products) sum += 2 * std::abs(factor) * q(i) * q(j);
    energy += form.stiffness_j / 4 * sum * sum;
  }
  return energy;
}

// Bound of the error of the energy after so many samples, relative to the energy. Rounding moves q, and so by how
// much a form of stiffness c is stretched, by eps times the sum of its terms |A_ij q_i q_j|. The force of the form is
// at most the root of c E, E the energy, so a sample's error is eps times the root of E V, V the energy_of_terms().
// The modes add eps E. Signs are random: six standard deviations. V is larger than E where terms cancel and where
// modes near half the rate move far with little energy.
template <typename T>
double rounding_bound(int samples, double energy_of_terms, double energy) {
  return 6 * std::numeric_limits<T>::epsilon() * std::sqrt(samples * (1 + energy_of_terms / energy));
}

}  // namespace contactspline::testing
