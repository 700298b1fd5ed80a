// SPDX-License-Identifier: MIT
// The receptances of a network whose places move, in any of its samples.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <utility>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/network_parts.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/network/network_receptances.hpp"

namespace contactspline::detail {

/// Computes the receptances between connections as ContactNetwork does, for given shapes of the places that move.
template <std::floating_point T>
class MovedReceptances {
 public:
  MovedReceptances(const NetworkPlan<T>& plan, double sample_rate_hz)
      : parts_(plan, sample_rate_hz), receptances_(parts_), solver_(plan.connections().size(), sample_rate_hz) {}

  /// shapes: with which forces act at a place.
  void move(std::size_t place, const T* shapes) {
    ModeShapes<T>& of_place = parts_.places[place].shapes;
    for (std::size_t i = 0; i < of_place.size(); ++i) of_place[i] = shapes[i];
    parts_.movers[*parts_.places[place].mover].is_new = is_old_ = true;
  }
  /// Its receptances are those of the shapes; nothing else of it counts.
  [[nodiscard]] const CoupledContacts<T>& solver() {
    if (std::exchange(is_old_, false)) {
      receptances_.measure_moved(parts_);
      receptances_.couple(parts_, solver_);
    }
    return solver_;
  }

 private:
  NetworkParts<T> parts_;
  NetworkReceptances<T> receptances_;
  CoupledContacts<T> solver_;
  bool is_old_ = true;
};

}  // namespace contactspline::detail
