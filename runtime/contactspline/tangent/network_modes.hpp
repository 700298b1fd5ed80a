// SPDX-License-Identifier: MIT
// The constants of all modes of a network.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <vector>

#include "contactspline/modal/mode.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/mode_tangent.hpp"

namespace contactspline::detail {

/// The constants of all modes of a plan, one body after the other.
template <std::floating_point T>
struct NetworkModes {
  std::vector<std::size_t> begins = {0};  // first mode of each body, and the number of all
  std::vector<T> stiffness, loss, admittance;

  NetworkModes(const NetworkPlan<T>& plan, double sample_rate_hz) {
    for (const auto& modes : plan.bodies()) {
      for (const Mode& mode : modes) {
        const ModeStep step = step_of(mode, sample_rate_hz);
        stiffness.push_back(static_cast<T>(step.stiffness));
        loss.push_back(static_cast<T>(step.loss));
        admittance.push_back(static_cast<T>(step.admittance));
      }
      begins.push_back(stiffness.size());
    }
  }
  [[nodiscard]] std::size_t size() const { return stiffness.size(); }
};

}  // namespace contactspline::detail
