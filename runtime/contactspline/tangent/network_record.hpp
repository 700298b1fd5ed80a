// SPDX-License-Identifier: MIT
// What a network has played, for its gradient (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "contactspline/tangent/contact_gradient.hpp"
#include "contactspline/tangent/friction_tangent.hpp"

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
  // Friction in a sample: what it kept before, what pressed it, and its increment. follows: not where the normal
  // force is at an end of its range; is_pressed: by the connection of the plan, too.
  struct Rubbing {
    std::size_t connection;
    FrictionState<T> before;
    T normal_force, increment;
    bool follows, is_pressed;
  };
  // A normal force or a surface speed that was set before a sample.
  struct RubbingCall {
    std::size_t sample, connection;
    bool is_speed, follows;
  };
  // A place that moves, in a sample over which it moves or in the next one; or one that is put elsewhere before a
  // sample. call: which call of RecordedNetwork said so; kAsBefore: none, so that the place follows where it was.
  static constexpr std::size_t kAsBefore = (std::numeric_limits<std::size_t>::max)();
  struct Move {
    std::size_t sample, mover, call;
    T place_m;  // after the sample
    bool is_put;
  };
  /// How many there are up to the end of a sample.
  struct Ends {
    std::size_t acting = 0, pushes = 0, motions = 0, rubbing = 0;
  };

  std::vector<Acting> acting;  // springs, and contacts that press, are compressed or remember
  std::vector<Push> pushes;
  std::vector<Motion> motions;
  std::vector<Rubbing> rubbing;  // all friction, in each sample
  std::vector<RubbingCall> rubbing_calls;
  std::vector<Ends> ends;  // one for each sample
  std::vector<Move> moves;
  std::vector<char> calls_follow;   // does each call that moved a place follow? Not if it was beyond its range
  std::vector<std::size_t> movers;  // places that move along strings
  // Before each block: displacements and free increments of all modes; if there are movers also the changes of all
  // modes over the last sample, and where the movers are.
  std::vector<T> states;

  /// Numbers of a state.
  [[nodiscard]] std::size_t state_size(std::size_t modes) const {
    return movers.empty() ? 2 * modes : 3 * modes + movers.size();
  }

  /// The part of a list that belongs to sample n.
  template <typename Element>
  [[nodiscard]] std::span<const Element> in_sample(const std::vector<Element>& list, std::size_t Ends::*end,
                                                   std::size_t n) const {
    const std::size_t from = n > 0 ? ends[n - 1].*end : 0;
    return std::span<const Element>(list).subspan(from, ends[n].*end - from);
  }
};

}  // namespace detail

}  // namespace contactspline
