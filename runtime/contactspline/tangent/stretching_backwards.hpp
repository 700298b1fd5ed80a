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

#include "contactspline/data/stretch_form.hpp"
#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/contact_gradient.hpp"
#include "contactspline/tangent/force_equations.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/network_record.hpp"
#include "contactspline/tangent/stretching_body_tangent.hpp"

namespace contactspline::detail {

/// What a network in which bodies stretch has played: `states` are the displacements of all modes after each sample,
/// `motions` have velocities in place of increments.
template <std::floating_point T>
struct StretchingRecord : NetworkRecord<T> {
  // Of each motion: the mode, where it was before, and the last changes of the modes of its body after it.
  struct Setting {
    std::size_t mode;
    T displacement_before;
    std::vector<T> changes;
  };
  std::vector<Setting> settings;
  std::vector<T> form_forces;  // of all forms in each sample [N]
};

/// to += A from, for the matrix A [1/m^2] of a form.
template <std::floating_point T>
void add_form_product(const StretchForm& form, const T* from, T* to) {
  for (std::size_t i = 0; i < form.squares_per_m2.size(); ++i)
    to[i] += static_cast<T>(form.squares_per_m2[i]) * from[i];
  for (const auto& [first, second, factor] : form.products) {
    to[first] += static_cast<T>(factor) * from[second];
    to[second] += static_cast<T>(factor) * from[first];
  }
}

/// A form of a body at displacements of its modes, backwards. The adjoint of a value is the derivative of the sum
/// with respect to it.
template <std::floating_point T>
struct FormBackwards {
  const StretchForm& form;
  std::size_t begin, modes;          ///< of its body
  std::vector<T> gradient, adjoint;  ///< A q, and its adjoint
  StretchForm sum;                   ///< adjoints of the numbers of the form

  FormBackwards(const StretchForm& of_form, std::size_t first_mode, std::size_t count)
      : form(of_form),
        begin(first_mode),
        modes(count),
        gradient(count),
        adjoint(count),
        sum{0, std::vector<double>(count), of_form.products} {
    for (auto& product : sum.products) product.factor_per_m2 = 0;
  }

  [[nodiscard]] T stiffness() const { return static_cast<T>(form.stiffness_j); }
  /// displacements: of all modes of the network.
  void take(const std::vector<T>& displacements) {
    std::ranges::fill(gradient, T(0));
    add_form_product(form, displacements.data() + begin, gradient.data());
  }
  /// The adjoint of the gradient becomes that of the displacements and the form.
  void finish(const std::vector<T>& displacements, std::vector<T>& of_displacements) {
    const T* q = displacements.data() + begin;
    add_form_product(form, adjoint.data(), of_displacements.data() + begin);
    for (std::size_t i = 0; i < modes; ++i) sum.squares_per_m2[i] += double(adjoint[i]) * double(q[i]);
    for (auto& [first, second, factor] : sum.products)
      factor += double(adjoint[first]) * double(q[second]) + double(adjoint[second]) * double(q[first]);
    std::ranges::fill(adjoint, T(0));
  }
};

/// The samples of a StretchingRecord backwards. Names as in TwoStepMotion: q, c and d.
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
        modes_(plan, sample_rate_hz),
        solver_(solver.size(), sample_rate_hz / 2),
        equations_(solver.size()),
        right_(solver.size()) {
    for (auto* values : {&q_, &c_, &last_c_, &of_q_, &of_c_, &of_last_c_, &of_d_, &of_stiffness_, &of_loss_,
                         &of_admittance_, &of_decay_, &of_travel_})
      values->resize(modes_.size());
    const std::size_t connections = plan.connections().size();
    for (std::size_t k = 0; k < connections; ++k)
      for (std::size_t l = 0; l <= k; ++l) solver_.set_admittance(k, l, double(solver.admittance(k, l)));
    for (const auto& place : plan.places()) of_shapes_.emplace_back(place.shapes.size());
    for (std::size_t b = 0; b < plan.bodies().size(); ++b)
      for (const StretchForm& form : plan.forms(b))
        forms_.emplace_back(form, modes_.begins[b], plan.bodies()[b].size());
    for (std::size_t k = 0; k < connections; ++k) add_connection(k, solver[k]);
    for (FormBackwards<T>& form : forms_)
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

  // A place on which a force acts, by its sign: the modes from `begin` on, their shapes there and the adjoints of
  // these.
  struct Arm {
    std::size_t begin, modes;
    const T* shapes;
    T* of_shapes;
    T sign;
  };
  // Of a connection, or after these of a form, in a sample. slopes: of the force by the compressions.
  struct Force {
    std::vector<Arm> arms;
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
            {modes_.begins[at.body], at.shapes.size(), at.shapes.data(), of_shapes_[place].data(), sign});
      }
  }

  // Where sample n begins: q, without the motions that were set before it if there are any.
  void take_start(std::size_t n, bool with_motions) {
    if (n == 0)
      std::ranges::fill(q_, T(0));
    else
      std::copy_n(record_.states.begin() + std::ptrdiff_t((n - 1) * q_.size()), q_.size(), q_.begin());
    if (!with_motions) return;
    for (const auto& motion : motions_before(n)) q_[mode_of(motion)] = motion.displacement;
  }
  [[nodiscard]] std::span<const typename Record::Motion> motions_before(std::size_t n) const {
    return record_.in_sample(record_.motions, &Ends::motions, n);
  }
  [[nodiscard]] const typename Record::Setting& setting_of(const typename Record::Motion& motion) const {
    return record_.settings[static_cast<std::size_t>(&motion - record_.motions.data())];
  }
  [[nodiscard]] std::size_t mode_of(const typename Record::Motion& motion) const {
    return modes_.begins[motion.body] + setting_of(motion).mode;
  }
  // The change of all modes over sample n.
  void take_change(std::size_t n, std::vector<T>& change) {
    take_start(n, true);
    for (std::size_t i = 0; i < change.size(); ++i) change[i] = record_.states[n * change.size() + i] - q_[i];
  }
  void take(std::size_t n) {
    if (n > 0)
      take_change(n - 1, last_c_);
    else
      std::ranges::fill(last_c_, T(0));
    for (const auto& motion : motions_before(n))
      std::ranges::copy(setting_of(motion).changes, last_c_.begin() + std::ptrdiff_t(modes_.begins[motion.body]));
    take_change(n, c_);
    take_forms();
  }
  void take_forms() {
    for (FormBackwards<T>& form : forms_) form.take(q_);
  }

  void step(std::size_t n) {
    take(n);
    add_weights(n);
    for (std::size_t i = 0; i < q_.size(); ++i) {
      of_c_[i] += (1 - modes_.loss[i]) * of_d_[i];
      of_loss_[i] -= c_[i] * of_d_[i];
      of_q_[i] -= modes_.stiffness[i] * of_d_[i];
      of_stiffness_[i] -= (q_[i] + c_[i]) * of_d_[i];
      of_c_[i] += of_q_[i];
      of_last_c_[i] = 0;
    }
    linearise(n);
    solve(n);
    respond(n);
    for (const Force& force : forces_)
      if (force.value != 0)
        for (const Arm& arm : force.arms) drive(arm, -force.value);
    add_pushes(n);
    for (FormBackwards<T>& form : forms_) form.finish(q_, of_q_);
    std::swap(of_d_, of_c_);       // d before the sample
    std::swap(of_c_, of_last_c_);  // c over the sample before
    add_motions(n);
  }

  void add_weights(std::size_t n) {
    for (std::size_t p = 0; p < (std::min)(weights_.displacements.size(), of_shapes_.size()); ++p) {
      const T weight = weight_of(weights_.displacements, p, n);
      if (weight == 0) continue;
      const auto& place = plan_.places()[p];
      for (std::size_t i = 0; i < place.shapes.size(); ++i) {
        const std::size_t m = modes_.begins[place.body] + i;
        of_q_[m] += weight * place.shapes[i];
        of_shapes_[p][i] += weight * (q_[m] + c_[m]);
      }
    }
  }

  // Adds to the adjoint of a compression after the sample, S(q + c) - gap, or before it, S(q - c-) - gap.
  void press_after(Force& force, T adjoint) {
    force.gap -= adjoint;
    for (const Arm& arm : force.arms)
      for (std::size_t i = 0; i < arm.modes; ++i) {
        const std::size_t m = arm.begin + i;
        const T by_mode = arm.sign * arm.shapes[i] * adjoint;
        of_q_[m] += by_mode;
        of_c_[m] += by_mode;
        arm.of_shapes[i] += arm.sign * adjoint * (q_[m] + c_[m]);
      }
  }
  void press_before(Force& force, T adjoint) {
    force.gap -= adjoint;
    for (const Arm& arm : force.arms)
      for (std::size_t i = 0; i < arm.modes; ++i) {
        const std::size_t m = arm.begin + i;
        const T by_mode = arm.sign * arm.shapes[i] * adjoint;
        of_q_[m] += by_mode;
        of_last_c_[m] -= by_mode;
        arm.of_shapes[i] += arm.sign * adjoint * (q_[m] - last_c_[m]);
      }
  }
  // The adjoint of a force on an arm: c = ... + 2 admittance S f.
  [[nodiscard]] T pushed(const Arm& arm) const {
    T sum = 0;
    for (std::size_t i = 0; i < arm.modes; ++i)
      sum += arm.shapes[i] * modes_.admittance[arm.begin + i] * of_c_[arm.begin + i];
    return 2 * arm.sign * sum;
  }
  // What a force did through admittances and shapes.
  void drive(const Arm& arm, T force) {
    for (std::size_t i = 0; i < arm.modes; ++i) {
      const std::size_t m = arm.begin + i;
      const T twice = 2 * arm.sign * force * of_c_[m];
      of_admittance_[m] += arm.shapes[i] * twice;
      arm.of_shapes[i] += modes_.admittance[m] * twice;
    }
  }
  [[nodiscard]] T stretch(const FormBackwards<T>& form, const std::vector<T>& values) const {
    T sum = 0;
    for (std::size_t i = 0; i < form.modes; ++i) sum += form.gradient[i] * values[form.begin + i];
    return sum;
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
        press_after(force, relaxed.after);
        press_before(force, relaxed.before);
        steps_.back() = contact.linearise(sample, T(0));
        force.slopes = steps_.back().slopes;
      } else {
        const T half = connections_[k].spring_n_per_m / 2;
        force.slopes.before = half - connections_[k].resistance;
        force.slopes.after = half + connections_[k].resistance;
      }
    }
    for (std::size_t f = 0; f < forms_.size(); ++f) {
      Force& force = forces_[connections_.size() + f];
      force.value = record_.form_forces[n * forms_.size() + f];
      force.slopes.before = force.slopes.after = forms_[f].stiffness() / 2;
    }
  }

  // The adjoints of all forces together.
  void solve(std::size_t n) {
    equations_.begin();
    for (std::size_t j = 0; j < forces_.size(); ++j) {
      Force& force = forces_[j];
      if (j < connections_.size()) force.adjoint = weight_of(weights_.forces, j, n);
      for (const Arm& arm : force.arms) force.adjoint -= pushed(arm);
      equations_.add(j, force.slopes.after);
    }
    const std::span<const std::size_t> acting = equations_.acting();
    if (acting.empty()) return;
    for (std::size_t j = connections_.size(); j < forces_.size(); ++j)
      for (std::size_t l = 0; l <= j; ++l) solver_.set_admittance(j, l, double(coupling(forces_[j], forces_[l])));
    equations_.factorise(solver_);
    for (std::size_t a = 0; a < acting.size(); ++a) right_[a] = forces_[acting[a]].adjoint;
    equations_.solve(right_.data());
    for (std::size_t a = 0; a < acting.size(); ++a) {
      forces_[acting[a]].adjoint = right_[a];
      right_[a] *= equations_.response(a);
    }
    for (std::size_t j = 0; j < forces_.size(); ++j)  // springs and forms of no stiffness have an adjoint, too
      for (std::size_t a = 0; a < acting.size() && !(forces_[j].slopes.after > 0); ++a)
        forces_[j].adjoint -= solver_.admittance(j, acting[a]) * right_[a];
  }
  // The change of the increment of a per newton of b [m/N].
  [[nodiscard]] T coupling(const Force& a, const Force& b) const {
    T sum = 0;
    for (const Arm& x : a.arms)
      for (const Arm& y : b.arms)
        for (std::size_t i = 0; x.begin == y.begin && i < x.modes; ++i)
          sum += 2 * x.sign * y.sign * x.shapes[i] * y.shapes[i] * modes_.admittance[x.begin + i];
    return sum;
  }

  // What the adjoints of the forces do to compressions and numbers.
  void respond(std::size_t n) {
    for (Force& force : forces_) {
      if (force.adjoint == 0) continue;
      press_after(force, force.slopes.after * force.adjoint);
      press_before(force, force.slopes.before * force.adjoint);
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
    for (std::size_t f = 0; f < forms_.size(); ++f) {
      const T middle = stretch(forms_[f], q_) + (stretch(forms_[f], c_) - stretch(forms_[f], last_c_)) / 2;
      forms_[f].sum.stiffness_j += double(middle * forces_[connections_.size() + f].adjoint);
    }
  }

  void add_pushes(std::size_t n) {
    const auto pushes = record_.in_sample(record_.pushes, &Ends::pushes, n);
    for (std::size_t i = 0; i < pushes.size(); ++i) {
      const auto& place = plan_.places()[pushes[i].place];
      const Arm arm{modes_.begins[place.body], place.shapes.size(), place.shapes.data(),
                    of_shapes_[pushes[i].place].data(), 1};
      if (pushes[i].follows) gradient_.pushes[record_.ends[n].pushes - pushes.size() + i] = pushed(arm);
      drive(arm, pushes[i].force);
    }
  }

  // The motions that were set before sample n back, the last one first.
  void add_motions(std::size_t n) {
    const auto motions = motions_before(n);
    if (motions.empty()) return;
    for (Connection& c : connections_)
      for (ContactBackwards<T>& contact : c.contacts) contact.jump();
    take_start(n, true);
    for (std::size_t i = motions.size(); i-- > 0;) {
      const auto& motion = motions[i];
      const std::size_t mode = mode_of(motion);
      take_forms();
      settle(motion);
      pull(motion.body, T(1));
      auto& gradient = gradient_.motions[record_.ends[n].motions - motions.size() + i];
      leave_start(mode, motion, gradient);
      q_[mode] = setting_of(motion).displacement_before;
      take_forms();
      pull(motion.body, T(-1));
    }
  }
  // c and d of a body from its free increments, as TwoStepMotion::take_motion finds them, back.
  void settle(const typename Record::Motion& motion) {
    const std::vector<T>& changes = setting_of(motion).changes;
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const std::size_t m = modes_.begins[motion.body] + i;
      if (double(modes_.loss[m]) > kMaxLoss) {
        of_q_[m] -= modes_.stiffness[m] * of_d_[m];
        of_stiffness_[m] -= q_[m] * of_d_[m];
        of_d_[m] = of_c_[m] = 0;
        continue;
      }
      const T adjoint = std::exchange(of_c_[m], T(0)) / (1 - modes_.loss[m]);
      of_d_[m] += adjoint;
      of_q_[m] += modes_.stiffness[m] * adjoint;
      of_stiffness_[m] += q_[m] * adjoint;
      of_loss_[m] += changes[i] * adjoint;
    }
  }
  // What the forms add to d, times a factor, back.
  void pull(std::size_t body, T factor) {
    for (FormBackwards<T>& form : forms_) {
      if (form.begin != modes_.begins[body]) continue;
      const T stretched = stretch(form, q_);
      T sum = 0;
      for (std::size_t i = 0; i < form.modes; ++i) {
        const std::size_t m = form.begin + i;
        const T by_motion = factor * form.stiffness() * stretched * of_d_[m];
        sum += factor * of_d_[m] * modes_.admittance[m] * form.gradient[i];
        of_admittance_[m] += by_motion * form.gradient[i];
        form.adjoint[i] += by_motion * modes_.admittance[m];
      }
      form.sum.stiffness_j += double(stretched * sum);
      for (std::size_t i = 0; i < form.modes; ++i) {
        form.adjoint[i] += form.stiffness() * sum * q_[form.begin + i];
        of_q_[form.begin + i] += form.stiffness() * sum * form.gradient[i];
      }
      form.finish(q_, of_q_);
    }
  }
  // The mode that was set: its free increment is (v + decay q) travel - (loss + stiffness)/2 q.
  void leave_start(std::size_t m, const typename Record::Motion& motion,
                   typename NetworkGradient<T>::Motion& gradient) {
    const Mode& mode = plan_.bodies()[motion.body][setting_of(motion).mode];
    const T travel = static_cast<T>(travel_of(mode, rate_)), decay = static_cast<T>(mode.decay_per_s);
    const T of_d = std::exchange(of_d_[m], T(0)), of_q = std::exchange(of_q_[m], T(0)), q = motion.displacement;
    if (modes_.admittance[m] == 0) return;
    of_travel_[m] += (motion.increment + decay * q) * of_d;
    of_decay_[m] += q * travel * of_d;
    of_loss_[m] -= q / 2 * of_d;
    of_stiffness_[m] -= q / 2 * of_d;
    if (motion.velocity_follows) gradient.velocity_m_per_s = travel * of_d;
    if (motion.displacement_follows)
      gradient.displacement_m = of_q + (decay * travel - (modes_.loss[m] + modes_.stiffness[m]) / 2) * of_d;
  }

  void finish() {
    NetworkNumbers<T>& numbers = gradient_.numbers;
    for (const std::vector<T>& shapes : of_shapes_) {
      numbers.places.emplace_back(shapes.size());
      for (std::size_t i = 0; i < shapes.size(); ++i) numbers.places.back()[i] = shapes[i];
    }
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b) {
      numbers.bodies.emplace_back();
      for (std::size_t i = 0; i < plan_.bodies()[b].size(); ++i) numbers.bodies[b].push_back(mode_numbers(b, i));
    }
    numbers.forms.resize(plan_.bodies().size());
    for (const FormBackwards<T>& form : forms_) {
      const auto body = std::ranges::find(modes_.begins, form.begin) - modes_.begins.begin();
      numbers.forms[std::size_t(body)].push_back(form.sum);
    }
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
  [[nodiscard]] Mode mode_numbers(std::size_t b, std::size_t i) const {
    const std::size_t m = modes_.begins[b] + i;
    const Mode& mode = plan_.bodies()[b][i];
    const auto by = [&](const Mode& direction) {
      const ModeStep step = step_tangent(mode, direction, rate_);
      return double(of_stiffness_[m]) * step.stiffness + double(of_loss_[m]) * step.loss +
             double(of_admittance_[m]) * step.admittance + double(of_decay_[m]) * direction.decay_per_s +
             double(of_travel_[m]) * travel_tangent(mode, direction, rate_);
    };
    return {by({1, 0, 0}), by({0, 1, 0}), by({0, 0, 1})};
  }

  [[nodiscard]] bool is_contact(std::size_t k) const { return !plan_.connections()[k].table.empty(); }
  [[nodiscard]] static T weight_of(const std::vector<std::vector<T>>& weights, std::size_t i, std::size_t n) {
    return i < weights.size() && n < weights[i].size() ? weights[i][n] : T(0);
  }

  const NetworkPlan<T>& plan_;
  double rate_;
  const Record& record_;
  const NetworkWeights<T>& weights_;
  NetworkModes<T> modes_;
  CoupledContacts<T> solver_;  // its admittances are those of the sample
  ForceEquations<T> equations_;
  std::vector<T> right_;
  std::vector<T> q_, c_, last_c_;                  // of a sample: at its middle, after and before it
  std::vector<T> of_q_, of_c_, of_last_c_, of_d_;  // their adjoints
  std::vector<T> of_stiffness_, of_loss_, of_admittance_, of_decay_, of_travel_;
  std::vector<std::vector<T>> of_shapes_;  // of each place
  std::vector<Connection> connections_;
  std::vector<FormBackwards<T>> forms_;
  std::vector<Force> forces_;                              // of the connections, then of the forms
  std::vector<typename ContactBackwards<T>::Step> steps_;  // of each connection in the record of the sample
  NetworkGradient<T> gradient_;
};

}  // namespace contactspline::detail
