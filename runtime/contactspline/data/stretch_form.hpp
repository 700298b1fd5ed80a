// SPDX-License-Identifier: MIT
// How a body stretches where its modes move far.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <cstddef>
#include <vector>

namespace contactspline {

/// A form of a body that stretches. With q the displacements of the modes, s = sum squares_i q_i^2 + 2 sum product
/// q_i q_j is how much it stretches, and stiffness_j s^2/4 the energy that this stores [J]. A string or a membrane
/// whose tension is everywhere the same has one form, without products; a plate has one for each Airy function.
///
/// A mode may stretch the body by itself, as the longitudinal ones of a string do: s gains factor q_mode, and the
/// form is the spring of that mode, of stiffness_j factor^2/2. Such modes are the last of their body, each in one
/// form.
struct StretchForm {
  /// The product of two different modes.
  struct Product {
    std::size_t first, second;
    double factor_per_m2;
  };
  /// A mode that stretches the body by itself.
  struct Linear {
    std::size_t mode = 0;
    double factor_per_m = 0;  ///< 0: none does
  };

  double stiffness_j;                  ///< >= 0
  std::vector<double> squares_per_m2;  ///< of each mode
  std::vector<Product> products = {};  ///< of pairs of modes, each pair once
  Linear linear = {};
};

}  // namespace contactspline
