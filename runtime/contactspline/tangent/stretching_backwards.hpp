// SPDX-License-Identifier: MIT
// The samples of a network in which bodies stretch backwards, for its gradient (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/contact_gradient.hpp"
#include "contactspline/tangent/force_equations.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/stretching_adjoints.hpp"
#include "contactspline/tangent/stretching_record.hpp"

namespace contactspline::detail {

/// The samples of a StretchingRecord backwards. The adjoint of a value is the derivative of the sum with respect to
/// it.
template <std::floating_point T>
class StretchingBackwards {
 public:
  using Record = StretchingRecord<T>;

  StretchingBackwards(const NetworkPlan<T>& plan, double sample_rate_hz, const CoupledContacts<T>& solver,
                      const Record& record, const NetworkWeights<T>& weights)
      : plan_(plan),
        rate_(sample_rate_hz),
        record_(record),
        weights_(weights),
        at_(plan, sample_rate_hz),
        solver_(solver.size(), sample_rate_hz / 2),
        equations_(solver.size()),
        right_(solver.size()) {
    const std::size_t connections = plan.connections().size();
    for (std::size_t k = 0; k < connections; ++k)
      for (std::size_t l = 0; l <= k; ++l) solver_.set_receptance(k, l, double(solver.receptance(k, l)));
    for (const auto& place : plan.places()) of_shapes_.emplace_back(place.shapes.size());
    for (std::size_t k = 0; k < connections; ++k) add_connection(k, solver[k]);
    for (FormBackwards<T>& form : at_.forms)
      forces_.push_back({{{form.begin, form.modes, form.gradient.data(), form.adjoint.data(), 1}}});
    gradient_.motions.resize(record.motions.size());
    gradient_.pushes.resize(record.pushes.size());
  }

  [[nodiscard]] NetworkGradient<T> gradient() {
    for (std::size_t n = record_.ends.size(); n-- > 0;) step(n);
    finish();
    return gradient_;
  }

 private:
  using Ends = typename Record::Ends;

  // Of a connection, or after these of a form, in a sample. slopes: of the force by the compressions.
  struct Force {
    std::vector<StretchingArm<T>> arms;
    T value = 0, adjoint = 0, gap = 0;
    ContactSlopes<T> slopes = {};
  };
  struct Connection {
    std::array<ContactBackwards<T>, 2> contacts;  // of even samples and of odd ones
    T spring_n_per_m, resistance;
    T spring = 0, of_resistance = 0;  // adjoints
  };

  void add_connection(std::size_t k, const CoupledConnection<T>& acting) {
    const auto& plan = plan_.connections()[k];
    const ContactBackwards<T> contact(plan.table, plan.memories, acting.contact, rate_ / 2);
    connections_.push_back({{contact, contact}, acting.spring_n_per_m, acting.resistance});
    Force& force = forces_.emplace_back();
    for (const auto& [place, sign] : {std::pair(plan.first, T(1)), std::pair(plan.second, T(-1))})
      if (place != kGround) {
        const auto& at = plan_.places()[place];
        force.arms.push_back(
            {at_.modes.begins[at.body], at.shapes.size(), at.shapes.data(), of_shapes_[place].data(), sign});
      }
  }

  // Where sample n begins: q.
  void take_start(std::size_t n) {
    if (n == 0)
      std::ranges::fill(at_.q, T(0));
    else
      std::copy_n(record_.states.begin() + std::ptrdiff_t((n - 1) * at_.q.size()), at_.q.size(), at_.q.begin());
    for (const auto& motion : motions_before(n)) at_.q[mode_of(motion)] = motion.displacement;
  }
  [[nodiscard]] std::span<const typename Record::Motion> motions_before(std::size_t n) const {
    return record_.in_sample(record_.motions, &Ends::motions, n);
  }
  [[nodiscard]] const typename Record::Setting& setting_of(const typename Record::Motion& motion) const {
    return record_.settings[static_cast<std::size_t>(&motion - record_.motions.data())];
  }
  [[nodiscard]] std::size_t mode_of(const typename Record::Motion& motion) const {
    return at_.modes.begins[motion.body] + setting_of(motion).mode;
  }
  // The change of all modes over sample n.
  void take_change(std::size_t n, std::vector<T>& change) {
    take_start(n);
    for (std::size_t i = 0; i < change.size(); ++i) change[i] = record_.states[n * change.size() + i] - at_.q[i];
  }
  void take(std::size_t n) {
    if (n > 0)
      take_change(n - 1, at_.last_c);
    else
      std::ranges::fill(at_.last_c, T(0));
    for (const auto& motion : motions_before(n))
      std::ranges::copy(setting_of(motion).changes,
                        at_.last_c.begin() + std::ptrdiff_t(at_.modes.begins[motion.body]));
    take_change(n, at_.c);
    at_.take_forms();
  }

  void step(std::size_t n) {
    take(n);
    add_weights(n);
    at_.begin();
    linearise(n);
    solve(n);
    respond(n);
    for (const Force& force : forces_)
      if (force.value != 0)
        for (const StretchingArm<T>& arm : force.arms) at_.drive(arm, -force.value);
    add_pushes(n);
    at_.end();
    add_motions(n);
  }

  void add_weights(std::size_t n) {
    for (std::size_t p = 0; p < (std::min)(weights_.displacements.size(), of_shapes_.size()); ++p) {
      const T weight = weight_of(weights_.displacements, p, n);
      if (weight == 0) continue;
      const auto& place = plan_.places()[p];
      for (std::size_t i = 0; i < place.shapes.size(); ++i) {
        const std::size_t m = at_.modes.begins[place.body] + i;
        at_.of_q[m] += weight * place.shapes[i];
        of_shapes_[p][i] += weight * (at_.q[m] + at_.c[m]);
      }
    }
  }

  // Adds to the adjoints of the compressions before and after the sample.
  void press(Force& force, T before, T after) {
    force.gap -= before + after;
    at_.press_before(force.arms, before);
    at_.press_after(force.arms, after);
  }

  // Last increments and memories back, and the slopes of all forces.
  void linearise(std::size_t n) {
    steps_.clear();
    for (Force& force : forces_) force.value = force.adjoint = 0, force.slopes = {};
    for (const auto& [k, sample] : record_.in_sample(record_.acting, &Ends::acting, n)) {
      Force& force = forces_[k];
      force.value = sample.force;
      steps_.push_back({});
      if (is_contact(k)) {
        ContactBackwards<T>& contact = connections_[k].contacts[n % 2];
        const auto relaxed = contact.relax(sample);
        press(force, relaxed.before, relaxed.after);
        steps_.back() = contact.linearise(sample, T(0));
        force.slopes = steps_.back().slopes;
      } else {
        const T half = connections_[k].spring_n_per_m / 2;
        force.slopes.before = half - connections_[k].resistance;
        force.slopes.after = half + connections_[k].resistance;
      }
    }
    for (std::size_t f = 0; f < at_.forms.size(); ++f) {
      Force& force = forces_[connections_.size() + f];
      force.value = record_.form_forces[n * at_.forms.size() + f];
      force.slopes.before = force.slopes.after = at_.forms[f].stiffness() / 2;
    }
  }

  // The adjoints of all forces together.
  void solve(std::size_t n) {
    equations_.begin();
    for (std::size_t j = 0; j < forces_.size(); ++j) {
      Force& force = forces_[j];
      if (j < connections_.size()) force.adjoint = weight_of(weights_.forces, j, n);
      for (const StretchingArm<T>& arm : force.arms) force.adjoint -= at_.pushed(arm);
      equations_.add(j, force.slopes.after);
    }
    const std::span<const std::size_t> acting = equations_.acting();
    if (acting.empty()) return;
    for (std::size_t j = connections_.size(); j < forces_.size(); ++j)
      for (std::size_t l = 0; l <= j; ++l)
        solver_.set_receptance(j, l, double(at_.coupling(forces_[j].arms, forces_[l].arms)));
    equations_.factorise(solver_);
    for (std::size_t a = 0; a < acting.size(); ++a) right_[a] = forces_[acting[a]].adjoint;
    equations_.solve(right_.data());
    for (std::size_t a = 0; a < acting.size(); ++a) {
      forces_[acting[a]].adjoint = right_[a];
      right_[a] *= equations_.response(a);
    }
    for (std::size_t j = 0; j < forces_.size(); ++j)  // springs and forms of no stiffness have an adjoint, too
      for (std::size_t a = 0; a < acting.size() && !(forces_[j].slopes.after > 0); ++a)
        forces_[j].adjoint -= solver_.receptance(j, acting[a]) * right_[a];
  }

  // What the adjoints of the forces do to compressions and numbers.
  void respond(std::size_t n) {
    for (Force& force : forces_) {
      if (force.adjoint == 0) continue;
      press(force, force.slopes.before * force.adjoint, force.slopes.after * force.adjoint);
    }
    const auto acting = record_.in_sample(record_.acting, &Ends::acting, n);
    for (std::size_t a = 0; a < acting.size(); ++a) {
      const auto& [k, sample] = acting[a];
      Connection& c = connections_[k];
      const T adjoint = forces_[k].adjoint;
      if (is_contact(k)) {
        c.contacts[n % 2].push(sample, steps_[a], adjoint);
      } else {
        c.spring += (sample.before + sample.after) / 2 * adjoint;
        c.of_resistance += (sample.after - sample.before) * adjoint;
      }
    }
    for (std::size_t f = 0; f < at_.forms.size(); ++f) {
      FormBackwards<T>& form = at_.forms[f];
      const Force& force = forces_[connections_.size() + f];
      if (!form.acts) continue;
      const T middle =
          form.stretch(at_.q) + form.beside_gradient(at_.q) + (form.stretch(at_.c) - form.stretch(at_.last_c)) / 2;
      form.sum.stiffness_j += double(middle * force.adjoint);
      form.add_beside_gradient((force.slopes.before + force.slopes.after) * force.adjoint, at_.q, at_.of_q);
    }
  }

  void add_pushes(std::size_t n) {
    const auto pushes = record_.in_sample(record_.pushes, &Ends::pushes, n);
    for (std::size_t i = 0; i < pushes.size(); ++i) {
      const auto& place = plan_.places()[pushes[i].place];
      const StretchingArm<T> arm{at_.modes.begins[place.body], place.shapes.size(), place.shapes.data(),
                                 of_shapes_[pushes[i].place].data(), 1};
      if (pushes[i].follows) gradient_.pushes[record_.ends[n].pushes - pushes.size() + i] = at_.pushed(arm);
      at_.drive(arm, pushes[i].force);
    }
  }

  // The motions that were set before sample n back, the last one first.
  void add_motions(std::size_t n) {
    const auto motions = motions_before(n);
    if (motions.empty()) return;
    for (Connection& c : connections_)
      for (ContactBackwards<T>& contact : c.contacts) contact.jump();
    take_start(n);
    for (std::size_t i = motions.size(); i-- > 0;) {
      const auto& motion = motions[i];
      const auto& setting = setting_of(motion);
      at_.take_forms();
      at_.settle(motion.body, setting.changes);
      at_.pull(motion.body, T(1));
      const auto start = at_.leave_start(motion.body, setting.mode, motion.displacement, motion.increment);
      auto& gradient = gradient_.motions[record_.ends[n].motions - motions.size() + i];
      if (motion.displacement_follows) gradient.displacement_m = start.displacement;
      if (motion.velocity_follows) gradient.velocity_m_per_s = start.velocity;
      at_.q[mode_of(motion)] = setting.displacement_before;
      at_.take_forms();
      at_.pull(motion.body, T(-1));
    }
  }

  void finish() {
    at_.give_springs_back();
    NetworkNumbers<T>& numbers = gradient_.numbers;
    for (const std::vector<T>& shapes : of_shapes_) {
      numbers.places.emplace_back(shapes.size());
      for (std::size_t i = 0; i < shapes.size(); ++i) numbers.places.back()[i] = shapes[i];
    }
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b) {
      numbers.bodies.emplace_back();
      for (std::size_t i = 0; i < plan_.bodies()[b].size(); ++i) numbers.bodies[b].push_back(at_.mode_numbers(b, i));
    }
    numbers.forms.resize(plan_.bodies().size());
    for (const FormBackwards<T>& form : at_.forms) numbers.forms[form.body].push_back(form.sum);
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      const Connection& c = connections_[k];
      ContactNumbers<T> contact = c.contacts[0].gradient();
      add(contact, c.contacts[1].gradient());
      contact.stiffness_ratio *= plan_.connections()[k].weight;
      numbers.connections.push_back(
          {std::move(contact), forces_[k].gap, c.spring, c.of_resistance * static_cast<T>(rate_ / 2)});
    }
  }
  static void add(ContactNumbers<T>& sum, const ContactNumbers<T>& numbers) {
    sum.stiffness_ratio += numbers.stiffness_ratio;
    sum.loss_s_per_m += numbers.loss_s_per_m;
    for (std::size_t j = 0; j < sum.table.size(); ++j) {
      sum.table[j].force += numbers.table[j].force;
      sum.table[j].half_curvature += numbers.table[j].half_curvature;
    }
    for (std::size_t i = 0; i < sum.memories.size(); ++i) {
      sum.memories[i].weight += numbers.memories[i].weight;
      sum.memories[i].time_s += numbers.memories[i].time_s;
    }
  }

  [[nodiscard]] bool is_contact(std::size_t k) const { return !plan_.connections()[k].table.empty(); }
  [[nodiscard]] static T weight_of(const std::vector<std::vector<T>>& weights, std::size_t i, std::size_t n) {
    return i < weights.size() && n < weights[i].size() ? weights[i][n] : T(0);
  }

  const NetworkPlan<T>& plan_;
  double rate_;
  const Record& record_;
  const NetworkWeights<T>& weights_;
  TwoStepAdjoints<T> at_;
  CoupledContacts<T> solver_;  // its receptances are those of the sample
  ForceEquations<T> equations_;
  std::vector<T> right_;
  std::vector<std::vector<T>> of_shapes_;  // of each place
  std::vector<Connection> connections_;
  std::vector<Force> forces_;                              // of the connections, then of the forms
  std::vector<typename ContactBackwards<T>::Step> steps_;  // of each connection in the record of the sample
  NetworkGradient<T> gradient_;
};

}  // namespace contactspline::detail
