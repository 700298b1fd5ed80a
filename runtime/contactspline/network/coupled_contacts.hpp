// SPDX-License-Identifier: MIT
// The coupled step: one sample of several contacts and springs that move each other.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/network/contact_group.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/newton.hpp"
#include "contactspline/network/sample_law.hpp"
#include "contactspline/network/spring_elimination.hpp"
#include "contactspline/step/contact.hpp"

namespace contactspline {

/// Solves the connections of a model together, sample by sample. Over one sample
///
///     x = free increment - Xi force(x)
///
/// Xi is the matrix of receptances: by how much a newton in connection j reduces the increment of connection i. Each
/// force is the discrete gradient of its contact, so the stored energy changes by force x, exactly. A contact that
/// does not touch costs a comparison and a dot product with the forces that act. Groups without receptance between
/// them are solved apart. Springs are linear: they are eliminated, and each contact meets bodies and springs
/// together. A contact that is alone in its group is contact_step; friction stands among the contacts, and touches
/// while there is a normal force. No allocation after construction.
/// (docs/how-it-works/several-contacts.md)
template <std::floating_point T>
class CoupledContacts {
 public:
  /// Newton steps that a group may take in a sample. After these, the bounding law computes its forces.
  static constexpr int kMaxSteps = 64;

  /// Steps in a row that need not halve the residual. After these, each step must lower the convex merit.
  static constexpr int kPatience = 8;

  /// max_steps: in place of kMaxSteps, 0 or more. patience: in place of kPatience; -1: all steps lower the merit.
  CoupledContacts(std::size_t connections, double sample_rate_hz, int max_steps = kMaxSteps, int patience = kPatience)
      : time_step_(T(1 / sample_rate_hz)),
        connections_(connections),
        ends_(connections),
        is_active_(connections),
        is_grouped_(connections),
        exact_receptance_(connections),
        receptance_(connections),
        increments_(connections),
        force_displacements_(connections),
        springs_(connections),
        group_(connections),
        newton_(connections, sample_rate_hz, max_steps, patience) {
    for (auto* list : {&contacts_, &active_, &touching_, &grouped_, &remembering_}) list->reserve(connections);
  }

  [[nodiscard]] std::size_t size() const { return connections_.size(); }

  /// Connection i. Set its free increment before each sample, and at first its compression; read its force after it.
  [[nodiscard]] CoupledConnection<T>& operator[](std::size_t i) { return connections_[i]; }
  [[nodiscard]] const CoupledConnection<T>& operator[](std::size_t i) const { return connections_[i]; }

  /// Sets the receptance between connections i and j [m/N]. The matrix must be positive semidefinite, and the
  /// receptance of a connection with itself above 0.
  void set_receptance(std::size_t i, std::size_t j, double receptance) {
    exact_receptance_(i, j) = exact_receptance_(j, i) = receptance;
    receptance_(i, j) = receptance_(j, i) = static_cast<T>(receptance);
    group_.forget();
    springs_.forget();
  }
  /// Gives contact i, once, a memory, which relaxes in each advance(), whether the contact was added or not.
  void set_memory(std::size_t i, const ContactMemory<T>& memory) {
    connections_[i].memory = memory;
    if (!memory.empty()) remembering_.push_back(i);
  }
  [[nodiscard]] T receptance(std::size_t i, std::size_t j) const { return receptance_(i, j); }

  /// Begins a sample without connections.
  void begin() {
    for (auto* list : {&active_, &contacts_, &touching_}) list->clear();
    springs_.clear();
    newton_.begin();
    is_first_pass_ = true;
  }

  /// Adds connection i to this sample.
  void add(std::size_t i) {
    CoupledConnection<T>& c = connections_[i];
    if (c.is_friction && !(c.friction.normal_force() > 0)) {
      c.force = 0;
      c.friction_step = {};
      active_.push_back(i);
    } else if (c.table.empty() && !c.is_friction) {
      active_.push_back(i);
      springs_.add(i);
    } else {
      is_active_[i] = false;
      contacts_.push_back(i);
    }
  }

  /// Computes the forces. May be called again after further calls of add().
  void solve() {
    std::size_t solved = touching_.size();
    if (!springs_.empty() && springs_.predict(connections_, exact_receptance_)) group_.forget();
    for (const std::size_t i : contacts_) {
      if (is_active_[i]) continue;
      CoupledConnection<T>& c = connections_[i];
      if (!springs_.empty()) springs_.take(i, exact_receptance_);
      increments_[i] = springs_.increment(i, c.free_increment);
      if (c.is_friction || c.compression > 0 || c.compression + increments_[i] > 0)
        activate(i);
      else
        c.force = 0;
    }
    do {
      if (touching_.size() > solved) solve_groups();
      solved = touching_.size();
      displace_by_contacts();
      if (!springs_.empty()) springs_.solve(connections_, receptance_, touching_, ends_);
      is_first_pass_ = false;
    } while (activate_touching());
  }

  /// Ends the sample: moves the compressions of the connections that were added, and lets memories relax.
  void advance() {
    for (const std::size_t i : active_) {
      CoupledConnection<T>& c = connections_[i];
      if (c.is_friction) {
        c.friction.advance(c.friction_step);
        ends_[i] = {c.friction_step.strain, 0};
      }
      c.memory.move_by(ends_[i].compression - c.compression);
      c.compression = ends_[i].compression;
      c.segment = ends_[i].segment;
    }
    for (const std::size_t i : contacts_) {
      if (is_active_[i]) continue;
      CoupledConnection<T>& c = connections_[i];
      const T increment = increments_[i] - force_displacements_[i];
      c.memory.move_by(increment);
      c.compression += increment;
      c.segment = c.compression < 0 ? 0 : detail::relocate_segment(c.table, 0, c.compression);
    }
    for (const std::size_t i : remembering_) {
      CoupledConnection<T>& c = connections_[i];
      c.memory.relax(c.table, c.compression, c.segment);
    }
  }

  /// Connections whose force solve() computed.
  [[nodiscard]] std::span<const std::size_t> active() const { return active_; }
  /// Newton steps of the last sample, of all groups of contacts.
  [[nodiscard]] int steps() const { return newton_.steps(); }
  /// In how many samples a group took the bounding law, since construction.
  [[nodiscard]] std::size_t bounded() const { return newton_.bounded(); }

 private:
  // By how much the forces of the contacts reduce the increments of all, with the springs.
  void displace_by_contacts() {
    if (contacts_.empty()) return;
    const std::size_t padded = receptance_.padded(size());
    const detail::ColumnMatrix<T>& receptance = acting_receptance();
    std::fill_n(force_displacements_.data(), padded, T(0));
    for (const std::size_t j : touching_)
      if (const T force = connections_[j].force; force != 0)
        detail::add_scaled(0, padded, force, receptance.column(j), force_displacements_.data());
  }

  void activate(std::size_t i) {
    is_active_[i] = true;
    active_.push_back(i);
    touching_.push_back(i);
  }

  // Lets the contacts act that the forces of others close. Are there any?
  bool activate_touching() {
    const std::size_t before = active_.size();
    if (before == 0) return false;
    for (const std::size_t i : contacts_) {
      const CoupledConnection<T>& c = connections_[i];
      if (!is_active_[i] && c.compression + (increments_[i] - force_displacements_[i]) > 0) activate(i);
    }
    return active_.size() > before;
  }

  // The receptances that contacts meet.
  [[nodiscard]] const detail::ColumnMatrix<T>& acting_receptance() const {
    return springs_.empty() ? receptance_ : springs_.receptance();
  }

  void solve_groups() {
    for (const std::size_t i : touching_) is_grouped_[i] = false;
    for (const std::size_t i : touching_)
      if (!is_grouped_[i]) solve_group_of(i);
  }

  void solve_group_of(std::size_t seed) {
    collect_group(seed);
    if (grouped_.size() == 1) return solve_alone(seed);
    group_.gather(grouped_, connections_, acting_receptance(), increments_, time_step_);
    const auto& found = newton_.solve(group_, is_first_pass_);
    for (std::size_t a = 0; a < grouped_.size(); ++a) {
      const std::size_t i = grouped_[a];
      CoupledConnection<T>& c = connections_[i];
      c.force = found.force[a];
      if (c.is_friction)
        c.friction_step = group_.law(a).friction_step(found.increment[a], c.force);
      else
        ends_[i] = group_.law(a).end_of(found.increment[a], found.segment[a]);
    }
  }

  void solve_alone(std::size_t i) {
    CoupledConnection<T>& c = connections_[i];
    const Approach<T> approach{c.compression, increments_[i], acting_receptance()(i, i)};
    if (c.is_friction) {
      c.friction_step = c.friction.law().step(approach.free_increment, approach.receptance);
      c.force = c.friction_step.force;
      return;
    }
    const auto step = c.memory.step(c.table, c.contact, time_step_, approach, c.segment);
    c.force = step.force;
    ends_[i] = {step.compression, step.segment};
  }

  // The contacts that touch and are coupled with this one, directly or through others.
  void collect_group(std::size_t seed) {
    grouped_.clear();
    grouped_.push_back(seed);
    is_grouped_[seed] = true;
    for (std::size_t a = 0; a < grouped_.size() && grouped_.size() < touching_.size(); ++a) {
      const T* column = acting_receptance().column(grouped_[a]);
      for (const std::size_t j : touching_) {
        if (is_grouped_[j] || column[j] == 0) continue;
        is_grouped_[j] = true;
        grouped_.push_back(j);
      }
    }
  }

  T time_step_;
  std::vector<CoupledConnection<T>> connections_;
  std::vector<detail::EndOfSample<T>> ends_;
  std::vector<char> is_active_, is_grouped_;
  detail::IndexList contacts_;           // that were added
  detail::IndexList active_, touching_;  // all that act, and the contacts of these
  detail::IndexList grouped_;            // contacts of the group that is being solved
  detail::IndexList remembering_;        // contacts with a memory
  detail::ColumnMatrix<double> exact_receptance_;
  detail::ColumnMatrix<T> receptance_;  // rounded
  detail::ModalArray<T> increments_;    // of the contacts that were added, with springs, without forces of contacts
  detail::ModalArray<T> force_displacements_;
  detail::SpringElimination<T> springs_;
  detail::ContactGroup<T> group_;
  detail::NewtonSolver<T> newton_;
  bool is_first_pass_ = true;  // of solve() in this sample
};

}  // namespace contactspline
