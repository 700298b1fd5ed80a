// SPDX-License-Identifier: MIT
// The equations of a group of contacts that move each other over one sample.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/sample_law.hpp"
#include "contactspline/network/spring_elimination.hpp"

namespace contactspline::detail {

/// Forces of a group of contacts with what follows from them. Index: position in the group.
template <std::floating_point T>
struct GroupState {
  explicit GroupState(std::size_t size) : force(size), increment(size), residual(size), slope(size), segment(size) {}

  ModalArray<T> force, increment;
  ModalArray<T> residual;            // law(increment) - force [N]
  ModalArray<T> slope;               // of the law
  std::vector<std::size_t> segment;  // where the contacts end
  T norm = 0;                        // of the residual, in roots of joules
  bool is_found = false;             // are all residuals rounding?
};

/// Contacts 0 to size() - 1 of a group: their laws, their increments without forces and the receptances between them.
template <std::floating_point T>
class ContactGroup {
 public:
  using State = GroupState<T>;

  explicit ContactGroup(std::size_t max_contacts)
      : connections_(max_contacts),
        laws_(max_contacts),
        coupling_(max_contacts),
        root_receptance_(max_contacts),
        free_(max_contacts) {
    members_.reserve(max_contacts);
  }

  /// The receptances have changed.
  void forget() { members_.clear(); }

  /// Begins a sample with these contacts. increments: of all contacts, without forces of contacts.
  void gather(const IndexList& contacts, std::span<const CoupledConnection<T>> connections,
              const ColumnMatrix<T>& receptance, const ModalArray<T>& increments, T time_step) {
    const std::size_t n = contacts.size();
    if (contacts != members_) {
      members_ = contacts;
      for (std::size_t b = 0; b < n; ++b) {
        const T* from = receptance.column(contacts[b]);
        T* to = coupling_.column(b);
        for (std::size_t a = 0; a < n; ++a) to[a] = from[contacts[a]];
        std::fill(to + n, to + coupling_.padded(n), T(0));
        root_receptance_[b] = std::sqrt(to[b]);
      }
    }
    for (std::size_t a = 0; a < n; ++a) {
      connections_[a] = &connections[contacts[a]];
      laws_[a] = ConnectionLaw<T>(*connections_[a], time_step);
      free_[a] = increments[contacts[a]];
    }
    std::fill(free_.data() + n, free_.data() + coupling_.padded(n), T(0));
  }

  [[nodiscard]] std::size_t size() const { return members_.size(); }
  [[nodiscard]] const CoupledConnection<T>& connection(std::size_t a) const { return *connections_[a]; }
  [[nodiscard]] const ConnectionLaw<T>& law(std::size_t a) const { return laws_[a]; }
  [[nodiscard]] T free_increment(std::size_t a) const { return free_[a]; }
  [[nodiscard]] const ColumnMatrix<T>& coupling() const { return coupling_; }

  /// The increments under the forces of a state.
  [[gnu::always_inline]] void displace(State& state) const {
    const std::size_t n = size(), padded = coupling_.padded(n);
    std::copy_n(free_.data(), padded, state.increment.data());
    for (std::size_t b = 0; b < n; ++b)
      if (state.force[b] != 0) add_scaled(0, padded, -state.force[b], coupling_.column(b), state.increment.data());
  }

  /// Fills in a state from its forces.
  void evaluate(State& state) const {
    displace(state);
    const std::size_t n = size();
    const T* x = state.increment.data();
    state.norm = 0;
    state.is_found = true;
    for (std::size_t a = 0; a < n; ++a) {
      const auto law = laws_[a].at(x[a], state.segment[a]);
      const T residual = law.force - state.force[a];
      state.residual[a] = residual;
      state.slope[a] = law.slope;
      if (residual == 0) continue;
      // Where forces cancel each other, rounding is larger: then the search ends without progress.
      const T xi = coupling_(a, a),
              displacements = std::abs(free_[a]) + std::abs(x[a]) + xi * std::abs(state.force[a]);
      const T forces = std::abs(law.force) + std::abs(laws_[a].force_at_rest());
      // Beside a law that is 0 here and not there: what moves the contact by less than rounding.
      const T slope = law.force == 0 ? (std::max)(law.slope, 1 / xi) : law.slope;
      const T rounding = kRounding * (2 * forces + slope * displacements) + slope * kTinyMotion<T>;
      state.norm = (std::max)(state.norm, root_receptance_[a] * std::abs(residual));
      state.is_found &= std::abs(residual) <= rounding;
    }
  }

  /// May the residual be rounding of forces that cancel each other?
  [[nodiscard]] bool is_rounding(const State& state) const {
    T reach = 0;
    for (std::size_t a = 0; a < size(); ++a) reach += root_receptance_[a] * std::abs(state.force[a]);
    for (std::size_t a = 0; a < size(); ++a) {
      const T root = root_receptance_[a], forces = std::abs(state.force[a]) + std::abs(laws_[a].force_at_rest());
      const T slope = state.slope[a] + 1 / (root * root);
      const T rounding = kRounding * (forces + slope * (std::abs(free_[a]) + root * reach)) + slope * kTinyMotion<T>;
      if (!(std::abs(state.residual[a]) <= 16 * rounding)) return false;
    }
    return true;
  }

 private:
  static constexpr T kRounding = std::numeric_limits<T>::epsilon();

  std::vector<const CoupledConnection<T>*> connections_;
  std::vector<ConnectionLaw<T>> laws_;
  IndexList members_;  // whose receptances coupling_ holds
  ColumnMatrix<T> coupling_;
  ModalArray<T> root_receptance_, free_;
};

}  // namespace contactspline::detail
