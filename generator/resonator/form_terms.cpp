// SPDX-License-Identifier: MIT
#include "generator/resonator/form_terms.hpp"

#include <algorithm>
#include <cmath>

namespace contactspline {

void round_terms(StretchForm& form, int digits) {
  double largest = 0;
  for (const double square : form.squares_per_m2) largest = std::max(largest, std::abs(square));
  for (const auto& product : form.products) largest = std::max(largest, std::abs(product.factor_per_m2));
  if (largest == 0) return;
  const double step = std::pow(10.0, std::floor(std::log10(largest)) + 1 - digits);
  for (double& square : form.squares_per_m2) square = std::round(square / step) * step;
  for (auto& product : form.products) product.factor_per_m2 = std::round(product.factor_per_m2 / step) * step;
  std::erase_if(form.products, [](const auto& product) { return product.factor_per_m2 == 0; });
}

double least_share(std::span<const StretchForm> forms, std::size_t count) {
  double least = 1;
  for (std::size_t i = 0; i < forms.front().squares_per_m2.size(); ++i) {
    double kept = 0, all = 0;
    for (std::size_t k = 0; k < forms.size(); ++k) {
      all += forms[k].stiffness_j * std::pow(forms[k].squares_per_m2[i], 2);
      if (k + 1 == count) kept = all;
    }
    if (count < forms.size()) least = std::min(least, kept / all);
  }
  return least;
}

}  // namespace contactspline
