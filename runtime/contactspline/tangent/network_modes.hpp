// SPDX-License-Identifier: MIT
// The constants of all modes of a network.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
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
  std::vector<T> stiffness, loss, receptance;
  std::vector<T> own_stiffness, own_loss, own_receptance;  // before forms have springs of them

  NetworkModes(const NetworkPlan<T>& plan, double sample_rate_hz) {
    for (const auto& modes : plan.bodies()) {
      for (const Mode& mode : modes) {
        const ModeStep step = step_of(mode, sample_rate_hz);
        stiffness.push_back(static_cast<T>(step.stiffness));
        loss.push_back(static_cast<T>(step.loss));
        receptance.push_back(static_cast<T>(step.receptance));
      }
      begins.push_back(stiffness.size());
    }
    own_stiffness = stiffness, own_loss = loss, own_receptance = receptance;
    for (std::size_t b = 0; b < plan.bodies().size(); ++b)
      for (const StretchForm& form : plan.forms(b))
        if (has_spring(b, form)) give_away_spring(begins[b] + form.linear.mode, spring_of(form));
  }
  [[nodiscard]] std::size_t size() const { return stiffness.size(); }

  /// Has a form of a body the spring of a mode (StretchForm)?
  [[nodiscard]] bool has_spring(std::size_t body, const StretchForm& form) const {
    if (form.linear.factor_per_m == 0) return false;
    const std::size_t i = begins[body] + form.linear.mode;
    return can_give_away_spring(double(own_stiffness[i]), double(own_receptance[i]));
  }
  /// Does a form act at this sample rate?
  [[nodiscard]] bool acts(std::size_t body, const StretchForm& form) const {
    return form.linear.factor_per_m == 0 || has_spring(body, form);
  }
  [[nodiscard]] static T spring_of(const StretchForm& form) {
    return static_cast<T>(form.stiffness_j * form.linear.factor_per_m * form.linear.factor_per_m / 2);
  }
  /// By how much the constants of a mode grow whose spring [N/m] is given away.
  [[nodiscard]] T gain_of(std::size_t i, T spring) const { return 1 / (1 - own_receptance[i] * spring / 2); }

 private:
  // ModalBank::give_away_spring.
  void give_away_spring(std::size_t i, T spring) {
    const T gain = gain_of(i, spring);
    stiffness[i] = (std::max)(gain * (own_stiffness[i] - 2 * own_receptance[i] * spring), T(0));
    loss[i] *= gain;
    receptance[i] *= gain;
  }
};

}  // namespace contactspline::detail
