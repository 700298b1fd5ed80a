// SPDX-License-Identifier: MIT
// One value for each number of a network: directions and gradients. One for each sample: weights.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <vector>

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/mode.hpp"
#include "contactspline/tangent/contact_gradient.hpp"
#include "contactspline/tangent/friction_tangent.hpp"

namespace contactspline {

/// One value for each number of a connection, as in ContactNumbers and FrictionNumbers.
template <std::floating_point T>
struct ConnectionNumbers {
  ContactNumbers<T> contact = {};
  T gap_m = 0, spring_n_per_m = 0, resistance_n_s_per_m = 0;
  FrictionNumbers<T> friction = {};
};

/// One value for each number of a network, in the order of its plan. What is missing at the end of a vector is 0, and
/// what is too much does not count; only a table of a contact is empty or as long as the contact's.
template <std::floating_point T>
struct NetworkNumbers {
  std::vector<std::vector<Mode>> bodies = {};
  std::vector<ModeShapes<T>> places = {};
  std::vector<ConnectionNumbers<T>> connections = {};
  std::vector<std::vector<StretchForm>> forms = {};  ///< of each body; products in the order of the form's
};

namespace detail {

[[nodiscard]] inline double product(const StretchForm& a, const StretchForm& b) {
  using Product = StretchForm::Product;
  return a.stiffness_j * b.stiffness_j + a.linear.factor_per_m * b.linear.factor_per_m +
         sum_over(a.squares_per_m2, b.squares_per_m2, [](double x, double y) { return x * y; }) +
         sum_over(a.products, b.products,
                  [](const Product& x, const Product& y) { return x.factor_per_m2 * y.factor_per_m2; });
}

}  // namespace detail

/// The derivatives of a sum with respect to the samples of a network: of the displacement of each place and the force
/// of each connection, one value for each sample. What is missing at the end of any list is 0, and what is too much
/// does not count.
template <std::floating_point T>
struct NetworkWeights {
  std::vector<std::vector<T>> displacements = {}, forces = {};
};

/// The gradient of a sum: with respect to the numbers of a network, and to what RecordedNetwork::set_motion(),
/// push(), set_normal_force(), set_surface_speed(), and put_place() together with move_place() were given, in the
/// order of the calls. Of a place that moves
/// along a string, `numbers` has the shapes where it begins, until it moves.
template <std::floating_point T>
struct NetworkGradient {
  struct Motion {
    T displacement_m = 0, velocity_m_per_s = 0;
  };
  NetworkNumbers<T> numbers;
  std::vector<Motion> motions;
  std::vector<T> pushes;
  std::vector<T> normal_forces, surface_speeds;
  std::vector<T> moves;   ///< [1/m]
  std::vector<T> starts;  ///< for each place, if it moves: by where it begins, through its shapes and all later moves
};

/// The derivative in a direction of the sum whose gradient is given: the sum of all products.
template <std::floating_point T>
[[nodiscard]] T derivative(const NetworkNumbers<T>& gradient, const NetworkNumbers<T>& direction) {
  using Modes = std::vector<Mode>;
  using Connection = ConnectionNumbers<T>;
  const double bodies = detail::sum_over(gradient.bodies, direction.bodies,
                                         [](const Modes& a, const Modes& b) { return detail::product(a, b); });
  const T places =
      detail::sum_over(gradient.places, direction.places,
                       [](const ModeShapes<T>& a, const ModeShapes<T>& b) { return detail::product(a, b); });
  const T connections =
      detail::sum_over(gradient.connections, direction.connections, [](const Connection& a, const Connection& b) {
        return derivative(a.contact, b.contact) + a.gap_m * b.gap_m + a.spring_n_per_m * b.spring_n_per_m +
               a.resistance_n_s_per_m * b.resistance_n_s_per_m + derivative(a.friction, b.friction);
      });
  using Forms = std::vector<StretchForm>;
  const double forms = detail::sum_over(gradient.forms, direction.forms, [](const Forms& a, const Forms& b) {
    return detail::sum_over(a, b, [](const StretchForm& x, const StretchForm& y) { return detail::product(x, y); });
  });
  return static_cast<T>(bodies + forms) + places + connections;
}

}  // namespace contactspline
