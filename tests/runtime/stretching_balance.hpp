// SPDX-License-Identifier: MIT
// The balance of energy of a body that stretches.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "contactspline/modal/stretching_bank.hpp"
#include "stretch_terms.hpp"
#include "support/finite.hpp"

namespace contactspline::testing {

// What a run without forces shows of the energy, relative to its first value.
struct Balance {
  double error = 0;       // largest |energy + dissipated - energy at first|
  double risen = 0;       // largest rise over a sample
  double stretching = 0;  // largest part of the energy in stretching
  double bound = 0;       // rounding_bound()
};

// damping: of each sample, times dt.
template <typename T, typename Damping>
Balance balance_of(StretchingBank<T>& bank, std::span<const StretchForm> forms, int samples, Damping damping) {
  const double first = bank.energy();
  long double dissipated = 0;
  double before = first, terms = 0;
  Balance balance;
  for (int n = 0; n < samples; ++n) {
    bank.predict(damping(n));
    bank.commit();
    dissipated += bank.dissipated();
    const double energy = bank.energy(), error = std::abs(static_cast<double>(energy + dissipated - first)) / first;
    balance.error = is_finite(error) ? std::max(balance.error, error) : std::numeric_limits<double>::infinity();
    balance.risen = std::max(balance.risen, (energy - before) / first);
    balance.stretching = std::max(balance.stretching, bank.stretching_energy() / energy);
    before = energy;
    terms = std::max(terms, energy_of_terms<T>(forms, bank.bank().displacements()));
  }
  balance.bound = rounding_bound<T>(samples, terms, first);
  return balance;
}

}  // namespace contactspline::testing
