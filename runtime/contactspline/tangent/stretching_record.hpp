// SPDX-License-Identifier: MIT
// What a network in which bodies stretch has played, for its gradient (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <vector>

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/tangent/network_record.hpp"

namespace contactspline::detail {

/// What a network in which bodies stretch has played: `states` are the displacements of all modes after each sample,
/// `motions` have velocities in place of increments.
template <std::floating_point T>
struct StretchingRecord : NetworkRecord<T> {
  // Of each motion: the mode, where it was before, and the last changes of the modes of its body after it.
  struct Setting {
    std::size_t mode;
    T displacement_before;
    std::vector<T> changes;
  };
  std::vector<Setting> settings;
  std::vector<T> form_forces;  // of all forms in each sample [N]
};

/// to += A from, for the matrix A [1/m^2] of a form.
template <std::floating_point T>
void add_form_product(const StretchForm& form, const T* from, T* to) {
  for (std::size_t i = 0; i < form.squares_per_m2.size(); ++i)
    to[i] += static_cast<T>(form.squares_per_m2[i]) * from[i];
  for (const auto& [first, second, factor] : form.products) {
    to[first] += static_cast<T>(factor) * from[second];
    to[second] += static_cast<T>(factor) * from[first];
  }
}

/// The gradient of a form at displacements q of its modes: A q, and half of what is linear.
template <std::floating_point T>
void take_form_gradient(const StretchForm& form, const T* q, std::vector<T>& gradient) {
  std::ranges::fill(gradient, T(0));
  add_form_product(form, q, gradient.data());
  if (form.linear.factor_per_m != 0) gradient[form.linear.mode] += static_cast<T>(form.linear.factor_per_m / 2);
}
/// What of the stretch stands in no product with the gradient.
template <std::floating_point T>
[[nodiscard]] T stretch_beside_gradient(const StretchForm& form, const T* q) {
  if (form.linear.factor_per_m == 0) return 0;
  return static_cast<T>(form.linear.factor_per_m / 2) * q[form.linear.mode];
}

}  // namespace contactspline::detail
