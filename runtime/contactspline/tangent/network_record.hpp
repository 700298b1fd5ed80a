// SPDX-License-Identifier: MIT
// What a network has played, for its gradient (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/modal/mode.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/contact_gradient.hpp"
#include "contactspline/tangent/mode_tangent.hpp"

namespace contactspline {

namespace detail {

/// What a network has played, as far as its gradient needs it. The motion of the modes follows again from the forces.
template <std::floating_point T>
struct NetworkRecord {
  static constexpr std::size_t kBlock = 128;  // samples
  struct Acting {
    std::size_t connection;
    ContactSample<T> sample;
  };
  // follows: not if the value that was given is beyond its range.
  struct Push {
    std::size_t place;
    T force;
    bool follows;
  };
  struct Motion {  // set before a sample
    std::size_t body;
    T displacement, increment;
    bool displacement_follows, velocity_follows;
  };
  /// How many there are up to the end of a sample.
  struct Ends {
    std::size_t acting = 0, pushes = 0, motions = 0;
  };

  std::vector<Acting> acting;  // springs, and contacts that press or remember; others have no derivatives
  std::vector<Push> pushes;
  std::vector<Motion> motions;
  std::vector<Ends> ends;  // one for each sample
  std::vector<T> states;   // before each block: displacements, then free increments of all modes

  /// Those of a list that belong to sample n.
  template <typename Element>
  [[nodiscard]] std::span<const Element> in_sample(const std::vector<Element>& list, std::size_t Ends::*end,
                                                   std::size_t n) const {
    const std::size_t from = n > 0 ? ends[n - 1].*end : 0;
    return std::span<const Element>(list).subspan(from, ends[n].*end - from);
  }
};

/// The constants of all modes of a plan, one body after the other.
template <std::floating_point T>
struct NetworkModes {
  std::vector<std::size_t> begins = {0};  // of each body, and the number of all
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

}  // namespace detail

}  // namespace contactspline
