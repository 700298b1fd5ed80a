// SPDX-License-Identifier: MIT
// Which free masses a strike throws together, and which it puts back.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/network/network_plan.hpp"

namespace contactspline {

/// A free mass and all masses that move with it: those that springs and rigid links join, through masses only.
struct Assembly {
  std::vector<std::size_t> masses;  ///< bodies
  bool is_held = false;             ///< does a spring or link join one of them to the ground or a resonator?
};

/// What a strike moves. `thrown` gets its speed. `returned` are the masses that it may meet through contacts and that
/// nothing holds: they are put back, at rest. `contacts` join what is thrown to others.
struct Throw {
  Assembly thrown;
  std::vector<std::size_t> returned;
  struct Contact {
    std::size_t connection;
    bool is_first;  ///< is the thrown mass the first place of the contact?
  };
  std::vector<Contact> contacts;
};

namespace detail {

/// The bodies at both ends of connection k of a plan; kGround for the ground.
template <typename T>
struct BodiesOf {
  std::size_t first, second;

  BodiesOf(const NetworkPlan<T>& plan, std::size_t k)
      : first(body(plan, plan.connections()[k].first)), second(body(plan, plan.connections()[k].second)) {}

  static std::size_t body(const NetworkPlan<T>& plan, std::size_t place) {
    return place == kGround ? kGround : plan.places()[place].body;
  }
};

template <typename T>
bool is_free_mass(const NetworkPlan<T>& plan, std::size_t body) {
  if (body == kGround || plan.bodies()[body].size() != 1) return false;
  const Mode& mode = plan.bodies()[body].front();
  return mode.angular_frequency_rad_per_s == 0 && mode.decay_per_s == 0;
}

inline bool contains(const std::vector<std::size_t>& list, std::size_t element) {
  return std::ranges::find(list, element) != list.end();
}

template <typename T>
Assembly assembly_of(const NetworkPlan<T>& plan, std::size_t mass) {
  Assembly assembly{{mass}};
  for (std::size_t i = 0; i < assembly.masses.size(); ++i)
    for (std::size_t k = 0; k < plan.connections().size(); ++k) {
      const BodiesOf<T> ends(plan, k);
      const std::size_t here = assembly.masses[i];
      if (!plan.connections()[k].table.empty() || plan.connections()[k].friction ||
          (ends.first != here && ends.second != here))
        continue;
      const std::size_t other = ends.first == here ? ends.second : ends.first;
      if (!is_free_mass(plan, other))
        assembly.is_held = true;
      else if (!contains(assembly.masses, other))
        assembly.masses.push_back(other);
    }
  return assembly;
}

}  // namespace detail

/// What a strike of a free mass moves.
template <typename T>
[[nodiscard]] Throw throw_of(const NetworkPlan<T>& plan, std::size_t mass) {
  Throw found{detail::assembly_of(plan, mass), {}, {}};
  std::vector<std::size_t> moved = found.thrown.masses;
  for (std::size_t i = 0; i < moved.size(); ++i)
    for (std::size_t k = 0; k < plan.connections().size(); ++k) {
      const detail::BodiesOf<T> ends(plan, k);
      const bool is_first = ends.first == moved[i];
      if (plan.connections()[k].table.empty() || (!is_first && ends.second != moved[i])) continue;
      const std::size_t other = is_first ? ends.second : ends.first;
      if (detail::contains(found.thrown.masses, moved[i])) found.contacts.push_back({k, is_first});
      if (!detail::is_free_mass(plan, other) || detail::contains(moved, other)) continue;
      const Assembly met = detail::assembly_of(plan, other);
      if (met.is_held) continue;
      for (const std::size_t body : met.masses)
        if (!detail::contains(moved, body)) {
          moved.push_back(body);
          found.returned.push_back(body);
        }
    }
  return found;
}

}  // namespace contactspline
