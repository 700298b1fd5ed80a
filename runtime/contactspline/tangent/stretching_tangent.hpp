// SPDX-License-Identifier: MIT
// A network in which bodies stretch, with its derivatives with respect to several parameters, forwards
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/network/contact_network.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/tangent/contact_tangent.hpp"
#include "contactspline/tangent/force_equations.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/stretching_body_tangent.hpp"

namespace contactspline {

/// A ContactNetwork in which a body stretches, with its derivatives with respect to P parameters: beside what
/// NetworkTangent has also by the numbers of the forms. Controls and places stay as the plan says, rigid links keep
/// their stiffness, contacts with a memory begin apart. At least one body of the plan stretches.
template <std::floating_point T, std::size_t P>
class StretchingTangent {
 public:
  using Number = Dual<T, P>;

  /// The plan must outlive this. directions: one for each parameter.
  StretchingTangent(const NetworkPlan<T>& plan, double sample_rate_hz,
                    const std::array<NetworkNumbers<T>, P>& directions)
      : plan_(plan),
        model_(plan, sample_rate_hz),
        pushes_(plan.places().size()),
        forces_(plan.connections().size() + plan.forms()),
        equations_(forces_.size()),
        solution_(forces_.size()),
        increments_(forces_.size()) {
    for (std::size_t b = 0; b < plan.bodies().size(); ++b) add_body(b, sample_rate_hz, directions);
    for (std::size_t q = 0; q < plan.places().size(); ++q) add_place(q, directions);
    for (std::size_t k = 0; k < plan.connections().size(); ++k) add_connection(k, sample_rate_hz, directions);
  }

  /// ContactNetwork::set_motion with slopes: puts a mode between two samples at a displacement [m], -1000 to 1000,
  /// with a velocity [m/s], -1000 to 1000. A value beyond its range acts as the end of the range, with slopes of 0.
  /// Does nothing if one of them is not a number.
  void set_motion(std::size_t body, const Number& displacement_m, const Number& velocity_m_per_s,
                  std::size_t mode = 0) {
    if (!is_number(displacement_m.value) || !is_number(velocity_m_per_s.value)) return;
    model_.set_motion(body, displacement_m.value, velocity_m_per_s.value, mode);
    bodies_[body].set_motion(mode, held(Number(), displacement_m, Ranges::displacement_m),
                             held(Number(), velocity_m_per_s, Ranges::speed_m_per_s));
    for (Connection& c : connections_)
      for (auto& contact : c.contacts) contact.jump();
  }

  /// Pushes at a place during the next sample [N], -1000 to 1000, with the rules of set_motion(). Several pushes add
  /// up.
  void push(std::size_t place, const Number& force_n) {
    model_.push(place, force_n.value);
    pushes_[place] = pushes_[place] + held(Number(), force_n, Ranges::force_n);
  }

  /// Advances one sample. Does not allocate.
  void tick() {
    model_.tick();
    for (Body& body : bodies_) body.begin();
    for (std::size_t q = 0; q < pushes_.size(); ++q) body_of(q).push(shapes_[q], std::exchange(pushes_[q], Number()));
    for (std::size_t k = 0; k < connections_.size(); ++k) respond(k);
    for (std::size_t i = 0; i < stretching_.size(); ++i) respond_by_form(i);
    solve();
    for (std::size_t b = 0; b < bodies_.size(); ++b) bodies_[b].end(model_.body(b).displacements());
    for (std::size_t k = 0; k < connections_.size(); ++k)
      if (is_contact(k)) acting(k).relax(connections_[k].before, compression(k));
    is_odd_ = !is_odd_;
  }

  [[nodiscard]] const ContactNetwork<T>& model() const { return model_; }
  /// Displacement of a place [m].
  [[nodiscard]] Number displacement(std::size_t place) const {
    return {model_.displacement(place), body_of(place).displacement(shapes_[place]).slopes};
  }
  /// Force of a connection over the last sample [N].
  [[nodiscard]] const Number& force(std::size_t connection) const { return forces_[connection].force; }
  /// After a sample [m], negative while apart.
  [[nodiscard]] Number compression(std::size_t connection) const {
    const Number measured = between(connection, [&](std::size_t q) { return body_of(q).displacement(shapes_[q]); });
    return {model_.compression(connection), (measured - connections_[connection].gap).slopes};
  }

 private:
  using Ranges = ControlRanges<T>;
  using Directions = std::array<NetworkNumbers<T>, P>;
  using Body = detail::StretchingBodyTangent<T, P>;

  // The contact of even samples and that of odd ones have memories and last increments of their own.
  struct Connection {
    std::array<ContactTangent<T, P>, 2> contacts;
    ContactControls<T> controls;
    Number gap, spring, resistance;
    Number before = {};  // compression at the beginning of the last step
  };
  // Of a connection, or after these of a form. response: the derivative with respect to the increment [N/m].
  struct Force {
    Number force = {};
    T response = 0;
  };
  struct FormOfBody {
    std::size_t body, form;
  };

  void add_body(std::size_t b, double sample_rate_hz, const Directions& directions) {
    const std::vector<Mode>& modes = plan_.bodies()[b];
    std::array<std::vector<Mode>, P> of_modes;
    for (std::size_t p = 0; p < P; ++p) {
      if (b < directions[p].bodies.size()) of_modes[p] = directions[p].bodies[b];
      of_modes[p].resize(modes.size());
    }
    std::vector<detail::FormTangent<T, P>> forms;
    for (std::size_t f = 0; f < plan_.forms(b).size(); ++f) {
      std::array<StretchForm, P> of_form{};
      for (std::size_t p = 0; p < P; ++p)
        if (const auto& all = directions[p].forms; b < all.size() && f < all[b].size()) of_form[p] = all[b][f];
      forms.emplace_back(plan_.forms(b)[f], modes.size(), of_form);
      stretching_.push_back({b, f});
    }
    bodies_.emplace_back(modes, sample_rate_hz, of_modes, std::move(forms));
  }

  void add_place(std::size_t q, const Directions& directions) {
    const ModeShapes<T>& shapes = plan_.places()[q].shapes;
    auto& added = shapes_.emplace_back(shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      added[i].value = shapes[i];
      for (std::size_t p = 0; p < P; ++p)
        if (const auto& all = directions[p].places; q < all.size() && i < all[q].size())
          added[i].slopes[p] = all[q][i];
    }
  }

  void add_connection(std::size_t k, double sample_rate_hz, const Directions& directions) {
    const auto& plan = plan_.connections()[k];
    const CoupledConnection<T>& acting = model_.solver()[k];
    const double step_rate_hz = sample_rate_hz / 2;
    std::array<ContactNumbers<T>, P> contacts;
    Number gap(plan.gap_m), spring(acting.spring_n_per_m), resistance(acting.resistance);
    for (std::size_t p = 0; p < P; ++p) {
      if (k >= directions[p].connections.size()) continue;
      const ConnectionNumbers<T>& direction = directions[p].connections[k];
      contacts[p] = direction.contact;
      contacts[p].stiffness_ratio *= plan.weight;
      gap.slopes[p] = direction.gap_m;
      spring.slopes[p] = direction.spring_n_per_m;
      resistance.slopes[p] = direction.resistance_n_s_per_m * static_cast<T>(step_rate_hz);
    }
    const ContactTangent<T, P> contact(plan.table, plan.memories, step_rate_hz, std::move(contacts));
    connections_.push_back({{contact, contact}, acting.contact, gap, spring, resistance});
  }

  [[nodiscard]] bool is_contact(std::size_t k) const { return !plan_.connections()[k].table.empty(); }
  [[nodiscard]] ContactTangent<T, P>& acting(std::size_t k) { return connections_[k].contacts[is_odd_ ? 1 : 0]; }
  [[nodiscard]] Body& body_of(std::size_t place) { return bodies_[plan_.places()[place].body]; }
  [[nodiscard]] const Body& body_of(std::size_t place) const { return bodies_[plan_.places()[place].body]; }

  // value(place): at the first place of a connection less that at the second.
  template <typename Value>
  [[nodiscard]] Number between(std::size_t k, Value value) const {
    const std::size_t first = plan_.connections()[k].first, second = plan_.connections()[k].second;
    const Number at_first = first == kGround ? Number() : value(first);
    return second == kGround ? at_first : at_first - value(second);
  }

  // How the forces respond to the compressions before the step and to parameters, at constant increments.
  void respond(std::size_t k) {
    Connection& c = connections_[k];
    const T force = model_.force(k), before = model_.compression_before(k), after = model_.solver()[k].compression;
    c.before = between(k, [&](std::size_t q) { return body_of(q).displacement_before(shapes_[q]); }) - c.gap;
    c.before.value = before;
    forces_[k] = {Number(force), 0};
    if (!is_contact(k)) {
      const Number change(after - before), middle = c.before + Number(T(0.5)) * change;
      forces_[k] = {{force, (c.spring * middle + c.resistance * change).slopes},
                    c.spring.value / 2 + c.resistance.value};
    } else if (force > 0) {
      const auto response = acting(k).respond(c.controls, c.before, force, after);
      forces_[k] = {response.force, response.stiffness};
    }
  }
  // A form is a spring at a place whose shapes are its gradient.
  void respond_by_form(std::size_t i) {
    const auto& [b, f] = stretching_[i];
    const auto& form = bodies_[b].forms()[f];
    const CoupledConnection<T>& acting = model_.solver()[connections_.size() + i];
    const Number before = bodies_[b].stretch_before(form);
    const Number middle = before + Number(T(0.5) * (acting.compression - before.value));
    forces_[connections_.size() + i] = {{acting.force, (form.stiffness() * middle).slopes},
                                        form.stiffness().value / 2};
  }

  // Moves the bodies by the forces, and adds to the derivatives of these what the increments do.
  void solve() {
    equations_.begin();
    for (std::size_t i = 0; i < forces_.size(); ++i) {
      drive(i, forces_[i].force);
      equations_.add(i, forces_[i].response);
    }
    equations_.factorise(model_.solver());
    const std::span<const std::size_t> acting = equations_.acting();
    for (std::size_t a = 0; a < acting.size(); ++a) increments_[a] = increment(acting[a]);
    for (std::size_t p = 0; p < P; ++p) {
      for (std::size_t a = 0; a < acting.size(); ++a) solution_[a] = increments_[a].slopes[p];
      equations_.solve(solution_.data());
      for (std::size_t a = 0; a < acting.size(); ++a)
        increments_[a].slopes[p] = equations_.response(a) * solution_[a];
    }
    for (std::size_t a = 0; a < acting.size(); ++a) {
      const Number change(T(0), increments_[a].slopes);
      forces_[acting[a]].force = forces_[acting[a]].force + change;
      drive(acting[a], change);
    }
  }
  // Lets the force of a connection or form act on the bodies.
  void drive(std::size_t i, const Number& force) {
    if (i >= connections_.size()) {
      const auto& [b, f] = stretching_[i - connections_.size()];
      return bodies_[b].push(bodies_[b].forms()[f].gradient(), Number() - force);
    }
    const std::size_t first = plan_.connections()[i].first, second = plan_.connections()[i].second;
    if (first != kGround) body_of(first).push(shapes_[first], Number() - force);
    if (second != kGround) body_of(second).push(shapes_[second], force);
  }
  [[nodiscard]] Number increment(std::size_t i) const {
    if (i < connections_.size()) return between(i, [&](std::size_t q) { return body_of(q).increment(shapes_[q]); });
    const auto& [b, f] = stretching_[i - connections_.size()];
    return bodies_[b].increment(bodies_[b].forms()[f].gradient());
  }

  const NetworkPlan<T>& plan_;
  ContactNetwork<T> model_;
  std::vector<Body> bodies_;
  std::vector<std::vector<Number>> shapes_;  // of each place
  std::vector<Number> pushes_;               // at each place in the next sample
  std::vector<Connection> connections_;
  std::vector<FormOfBody> stretching_;  // forms of all bodies
  std::vector<Force> forces_;           // of the connections, then of the forms
  detail::ForceEquations<T> equations_;
  std::vector<T> solution_;
  std::vector<Number> increments_;  // of those that respond
  bool is_odd_ = false;
};

}  // namespace contactspline
