// SPDX-License-Identifier: MIT
// Networks in which a body stretches: all forces act over two samples.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/network_parts.hpp"

namespace contactspline::detail {

/// One step ends at even samples, the next one at odd ones, so each connection is there twice: the one that acts is
/// in the solver, the other one rests here. Each has a compression of its own, and half of the energy.
///
/// Over two samples a form is a spring between the ground and a place whose shapes are its gradient (StretchForms),
/// so the solver knows it as one, after the connections of the network. No allocation after construction.
template <std::floating_point T>
class TwoSteps {
 public:
  TwoSteps(const NetworkParts<T>& parts, const CoupledContacts<T>& solver) {
    for (std::size_t k = 0; k < parts.connections.size(); ++k) resting_.push_back(solver[k]);
    forces_.resize(solver.size() - resting_.size());
  }

  /// What does not act in this sample.
  [[nodiscard]] std::span<CoupledConnection<T>> resting() { return resting_; }

  /// Takes the compressions from the displacements of the bodies: what rests ended its step a sample before.
  void place(const NetworkParts<T>& parts) {
    const auto change = [&](std::size_t p) {
      return p == kGround ? T(0) : parts.body_of(p).motion->last_change(parts.places[p].shapes.data());
    };
    for (std::size_t k = 0; k < resting_.size(); ++k) {
      const NetworkConnection<T>& c = parts.connections[k];
      CoupledConnection<T>& resting = resting_[k];
      resting.compression = parts.measured(k) - (change(c.first) - change(c.second) + c.lift);
      if (!resting.table.empty()) resting.segment = segment_index(resting.table, resting.compression);
      resting.force = 0;
    }
  }
  /// Displacements have jumped.
  void jump() {
    for (CoupledConnection<T>& resting : resting_) resting.memory.set_last_increment(0);
  }
  /// Energy of what rests, half of which counts [J].
  [[nodiscard]] double energy() const {
    double energy = 0;
    for (const CoupledConnection<T>& resting : resting_) energy += resting.energy_at(resting.compression);
    return energy;
  }

  /// Begins a sample: what rested acts.
  void begin(NetworkParts<T>& parts, CoupledContacts<T>& solver) {
    for (std::size_t k = 0; k < resting_.size(); ++k) exchange(resting_[k], solver[k]);
    for (NetworkBody<T>& body : parts.bodies) body.motion->begin(body.bank, body.damping);
  }

  /// Pushes at a place in this sample [N].
  static void push(NetworkParts<T>& parts, std::size_t p, T force) {
    NetworkBody<T>& body = parts.body_of(p);
    body.motion->push(body.bank, parts.places[p].shapes.data(), force);
  }

  /// Adds the forms to a sample which the bodies have begun, with the pushes of this sample.
  void add_forms(NetworkParts<T>& parts, CoupledContacts<T>& solver) const {
    std::size_t i = resting_.size();
    for (NetworkBody<T>& body : parts.bodies) {
      const std::size_t first = i;
      const StretchForms<T>& forms = body.motion->forms();
      for (std::size_t k = 0; k < forms.size(); ++k, ++i) {
        solver[i].spring_n_per_m = static_cast<T>(forms[k].stiffness());
        solver[i].compression = static_cast<T>(body.motion->stretch_before(k));
        solver[i].free_increment = static_cast<T>(body.motion->stretch_increment(k));
        for (std::size_t l = 0; l <= k; ++l)
          solver.set_receptance(i, first + l, body.motion->gain() * forms.coupling(k, l));
        couple(body, forms[k], i, solver);
        solver.add(i);
      }
    }
  }

  /// Ends the sample: moves the bodies under the forces of the connections and of the forms.
  void advance(NetworkParts<T>& parts, const CoupledContacts<T>& solver) {
    for (std::size_t k = 0; k < resting_.size(); ++k) {
      push_with_forms(parts, parts.connections[k].first, -solver[k].force);
      push_with_forms(parts, parts.connections[k].second, solver[k].force);
    }
    for (std::size_t f = 0; f < forces_.size(); ++f) forces_[f] = double(solver[resting_.size() + f].force);
    std::span<const double> forces(forces_);
    for (NetworkBody<T>& body : parts.bodies) {
      const std::size_t count = body.motion->forms().size();
      body.motion->end(body.bank, forces.first(count));
      forces = forces.subspan(count);
    }
  }

 private:
  // What differs between the two of a connection.
  static void exchange(CoupledConnection<T>& a, CoupledConnection<T>& b) {
    std::swap(a.compression, b.compression);
    std::swap(a.segment, b.segment);
    std::swap(a.force, b.force);
    std::swap(a.contact, b.contact);
    std::swap(a.spring_n_per_m, b.spring_n_per_m);
    if (!a.table.empty()) std::swap(a.memory, b.memory);
  }

  static void push_with_forms(NetworkParts<T>& parts, std::size_t p, T force) {
    if (p == kGround || force == 0) return;
    NetworkBody<T>& body = parts.body_of(p);
    body.motion->push_with_forms(body.bank, parts.places[p].shapes.data(), force);
  }

  // Receptances of a form of a body, which is connection i of the solver, with the connections on this body.
  static void couple(NetworkBody<T>& body, const StretchingForm<T>& form, std::size_t i, CoupledContacts<T>& solver) {
    const std::size_t modes = body.bank.size();
    for (std::size_t n = 0; n < modes; ++n) body.pushed[n] = double(form.motion()[n]);
    for (std::size_t k = 0; k < body.connections.size(); ++k)
      solver.set_receptance(
          i, body.connections[k],
          body.motion->gain() * inner_product<double>(modes, body.pushed.data(), body.shapes[k].data()));
  }

  std::vector<CoupledConnection<T>> resting_;
  std::vector<double> forces_;  // of the forms
};

}  // namespace contactspline::detail
