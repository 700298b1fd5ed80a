// SPDX-License-Identifier: MIT
// A network of bodies, contacts and springs with its derivatives with respect to several parameters, forwards
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
#include "contactspline/tangent/bodies_tangent.hpp"
#include "contactspline/tangent/contact_tangent.hpp"
#include "contactspline/tangent/force_equations.hpp"
#include "contactspline/tangent/friction_tangent.hpp"
#include "contactspline/tangent/network_numbers.hpp"

namespace contactspline {

/// A ContactNetwork with its derivatives with respect to P parameters. Controls of contacts and springs stay as the
/// plan says, rigid links keep their stiffness. Once put_place() or move_place() has moved a place or its slopes, the
/// shapes there change with the place alone, not by what the directions say of them. No body of the plan stretches
/// (StretchingTangent), no contact is rough, and no friction is at a place that moves along a string.
template <std::floating_point T, std::size_t P>
class NetworkTangent {
 public:
  using Number = Dual<T, P>;

  /// The plan must outlive this. directions: one for each parameter.
  NetworkTangent(const NetworkPlan<T>& plan, double sample_rate_hz,
                 const std::array<NetworkNumbers<T>, P>& directions)
      : plan_(plan),
        model_(plan, sample_rate_hz),
        time_step_(static_cast<T>(1 / sample_rate_hz)),
        bodies_(plan, sample_rate_hz, directions),
        equations_(plan.connections().size()),
        increments_(plan.connections().size()),
        solution_(plan.connections().size()) {
    friction_of_.resize(plan.connections().size());
    for (std::size_t k = 0; k < plan.connections().size(); ++k) add_connection(k, sample_rate_hz, directions);
    listed_.reserve(plan.connections().size());
  }

  /// Puts a free mass between two samples at a displacement [m], -1000 to 1000, with a velocity [m/s], -1000 to 1000.
  /// mass: a body of NetworkPlan::add_mass(). A value beyond its range acts as the end of the range, with slopes of
  /// 0. Does nothing if one of them is not a number.
  void set_motion(std::size_t mass, const Number& displacement_m, const Number& velocity_m_per_s) {
    if (!is_number(displacement_m.value) || !is_number(velocity_m_per_s.value)) return;
    model_.set_motion(mass, displacement_m.value, velocity_m_per_s.value);
    bodies_.set_motion(mass, held(Number(), displacement_m, Ranges::displacement_m),
                       Number(time_step_) * held(Number(), velocity_m_per_s, Ranges::speed_m_per_s));
    place_all();
  }

  /// ContactNetwork::put_place, which also tells how the place follows the parameters [m]. Beyond the ends of the
  /// string it does not. place: of NetworkPlan::add_moving_place().
  void put_place(std::size_t place, const Number& place_m) {
    model_.put_place(place, place_m.value);
    bodies_.put_place(place, place_m);
    place_all();
  }

  /// ContactNetwork::move_place. A place that is slower than its target does not follow the parameters, but keeps the
  /// derivatives that it has.
  void move_place(std::size_t place, const Number& place_m) {
    model_.move_place(place, place_m.value);
    bodies_.move_place(place, place_m);
  }

  /// Pushes at a place during the next sample [N], -1000 to 1000, with the rules of set_motion(). Several pushes add
  /// up.
  void push(std::size_t place, const Number& force_n) {
    model_.push(place, force_n.value);
    bodies_.push(place, held(Number(), force_n, Ranges::force_n));
  }

  /// ContactNetwork::set_normal_force and set_surface_speed of a friction, with the rules of set_motion(). At 0 N
  /// nothing follows the normal force.
  void set_normal_force(std::size_t friction, const Number& force_n) {
    model_.set_normal_force(friction, force_n.value);
    Number& normal = frictions_[friction_of_[friction]].normal;
    normal = held(normal, force_n, Ranges::normal_force_n);
  }
  void set_surface_speed(std::size_t friction, const Number& speed_m_per_s) {
    model_.set_surface_speed(friction, speed_m_per_s.value);
    Number& speed = frictions_[friction_of_[friction]].surface_speed;
    speed = held(speed, speed_m_per_s, Ranges::speed_m_per_s);
  }

  /// Advances one sample. Does not allocate.
  void tick() {
    press();
    measure_followed();
    bodies_.move_places(model_);
    model_.tick();
    list_connections();
    bodies_.push(model_);
    respond();
    solve();
    for (const std::size_t k : listed_) {
      const auto& plan = plan_.connections()[k];
      if (plan.first != kGround) bodies_.drive(plan.first, -1, connections_[k].force);
      if (plan.second != kGround) bodies_.drive(plan.second, 1, connections_[k].force);
    }
    bodies_.advance(model_);
    for (const std::size_t k : listed_)
      if (is_contact(k)) connections_[k].contact.relax(connections_[k].before, connections_[k].compression);
    for (Rubbing& rubbing : frictions_) end_friction(rubbing);
  }

  [[nodiscard]] const ContactNetwork<T>& model() const { return model_; }
  /// Displacement of a place [m].
  [[nodiscard]] Number displacement(std::size_t place) const {
    return {model_.displacement(place), bodies_.displacement(place, model_).slopes};
  }
  /// Force of a connection over the last sample [N].
  [[nodiscard]] const Number& force(std::size_t connection) const { return connections_[connection].force; }
  /// [m], negative while apart; of friction the strain of its bristles.
  [[nodiscard]] Number compression(std::size_t connection) const {
    const Connection& c = connections_[connection];
    if (is_friction(connection)) return frictions_[friction_of_[connection]].kept.strain;
    return {model_.compression(connection), (c.is_measured ? c.compression : measured(connection)).slopes};
  }

 private:
  using Ranges = ControlRanges<T>;
  using Directions = std::array<NetworkNumbers<T>, P>;
  using Friction = detail::FrictionSample<T, P>;
  // Compressions follow by increments. Their slopes are measured anew after so many samples, so that their roundings
  // do not add up.
  static constexpr std::size_t kMeasured = 64;

  // response: the derivative of the force with respect to the increment [N/m]. free: slopes of the increment without
  // forces. is_followed: is its compression followed in each sample, or only where it acts?
  struct Connection {
    ContactTangent<T, P> contact;
    ContactControls<T> controls;
    Number gap, spring, resistance;
    bool is_followed, is_measured = false;
    Number before = {}, compression = {}, force = {}, free = {};
    T response = 0;
  };
  // normal: by its control; pressed: in all, held to the range.
  struct Rubbing {
    std::size_t connection;
    typename Friction::Numbers material;
    Number normal = {}, pressed = {}, surface_speed = {};
    detail::FrictionState<Number> kept = {};
  };

  void add_connection(std::size_t k, double sample_rate_hz, const Directions& directions) {
    const auto& plan = plan_.connections()[k];
    const CoupledConnection<T>& acting = model_.solver()[k];
    std::array<ContactNumbers<T>, P> contacts;
    std::array<FrictionNumbers<T>, P> frictions;
    Number gap(plan.gap_m), spring(acting.spring_n_per_m), resistance(acting.resistance);
    for (std::size_t p = 0; p < P; ++p) {
      if (k >= directions[p].connections.size()) continue;
      const ConnectionNumbers<T>& direction = directions[p].connections[k];
      contacts[p] = direction.contact;
      frictions[p] = direction.friction;
      contacts[p].stiffness_ratio *= plan.weight;
      gap.slopes[p] = direction.gap_m;
      spring.slopes[p] = direction.spring_n_per_m;
      resistance.slopes[p] = direction.resistance_n_s_per_m / time_step_;
    }
    connections_.push_back({{plan.table, plan.memories, sample_rate_hz, std::move(contacts)},
                            acting.contact,
                            gap,
                            spring,
                            resistance,
                            plan.table.empty() || moves(plan.first) || moves(plan.second)});
    if (!plan.friction) return;
    friction_of_[k] = frictions_.size();
    frictions_.push_back(
        {k, detail::with_slopes<T, P>(FrictionNumbers<T>::of(*plan.friction, plan.friction_width_m), frictions)});
  }

  [[nodiscard]] bool moves(std::size_t place) const { return place != kGround && bodies_.moves(place); }
  [[nodiscard]] bool is_contact(std::size_t k) const { return !plan_.connections()[k].table.empty(); }
  [[nodiscard]] bool is_friction(std::size_t k) const { return plan_.connections()[k].friction.has_value(); }
  [[nodiscard]] Friction friction(const Rubbing& rubbing) const {
    return {rubbing.material, 1 / double(time_step_), rubbing.kept, rubbing.pressed};
  }

  // What presses friction in this sample: its control, and the force of the sample before of what presses it.
  void press() {
    for (Rubbing& rubbing : frictions_) {
      rubbing.pressed = rubbing.normal;
      const std::size_t by = plan_.connections()[rubbing.connection].pressed_by;
      if (by != kNoConnection && connections_[by].force.value > 0)
        rubbing.pressed = held(Number(), rubbing.pressed + connections_[by].force, Ranges::normal_force_n);
    }
  }
  // The values are the model's: of what is kept, too, so that roundings do not add up.
  void end_friction(Rubbing& rubbing) {
    const CoupledConnection<T>& played = model_.solver()[rubbing.connection];
    rubbing.kept =
        friction(rubbing).advance({played.friction_step.increment, connections_[rubbing.connection].free.slopes});
    rubbing.kept.strain.value = played.friction.strain();
    rubbing.kept.temperature.value = model_.temperature(rubbing.connection);
  }

  // Lets all compressions be measured anew, as the network does: they may jump.
  void place_all() {
    bodies_.place_all();
    for (Connection& c : connections_) {
      c.is_measured = false;
      c.force = Number();
      c.contact.jump();
    }
  }
  // value(place): at the first place of a connection less that at the second.
  template <typename Value>
  [[nodiscard]] Number between(std::size_t k, Value value) const {
    const std::size_t first = plan_.connections()[k].first, second = plan_.connections()[k].second;
    const Number at_first = first == kGround ? Number() : Number(value(first));
    return second == kGround ? at_first : at_first - value(second);
  }
  // Slopes of a compression between two samples.
  [[nodiscard]] Number measured(std::size_t k) const {
    return between(k, [&](std::size_t q) { return bodies_.pressing(q, model_); }) - connections_[k].gap;
  }
  void measure_followed() {
    if (++samples_ % kMeasured == 0)
      for (Connection& c : connections_) c.is_measured = false;
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      Connection& c = connections_[k];
      if (!c.is_followed || std::exchange(c.is_measured, true)) continue;
      c.compression = measured(k);
    }
  }
  // Lists the connections whose compressions are followed in this sample, which the model has played. Contacts that
  // act only now are measured as they were before it.
  void list_connections() {
    listed_.clear();
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      Connection& c = connections_[k];
      c.force = Number(model_.force(k));
      c.response = 0;
      const bool acts = c.is_followed || c.force.value > 0 || c.contact.remembers() ||
                        (is_contact(k) && model_.solver()[k].compression > 0);
      if (acts) listed_.push_back(k);
      if (std::exchange(c.is_measured, acts) || !acts) continue;
      c.compression = between(k, [&](std::size_t q) { return bodies_.pressing_before(q, model_); }) - c.gap;
    }
  }

  // How the forces respond to the compressions before the sample and to parameters, at constant increments.
  void respond() {
    for (const std::size_t k : listed_) {
      Connection& c = connections_[k];
      const T force = model_.force(k), before = model_.compression_before(k);
      const T after = model_.solver()[k].compression;
      c.before = {before, c.compression.slopes};
      if (is_contact(k)) {
        if (force > 0) {
          const auto response = c.contact.respond(c.controls, c.before, force, after);
          c.force = response.force;
          c.response = response.stiffness;
        }
      } else if (is_friction(k)) {
        const auto response =
            friction(frictions_[friction_of_[k]]).respond(model_.solver()[k].friction_step.increment);
        c.force = {force, response.force.slopes};
        c.response = response.stiffness;
      } else {
        const T change = after - before, middle = before + change / 2;
        for (std::size_t p = 0; p < P; ++p)
          c.force.slopes[p] = c.spring.slopes[p] * middle + c.spring.value * c.compression.slopes[p] +
                              c.resistance.slopes[p] * change;
        c.response = c.spring.value / 2 + c.resistance.value;
      }
      c.compression.value = after;
    }
  }

  // Adds to the derivatives of the forces what the increments do, and moves the compressions.
  void solve() {
    equations_.begin();
    for (const std::size_t k : listed_) {
      Connection& c = connections_[k];
      c.free = between(k, [&](std::size_t q) -> const Number& { return bodies_.moved(q, model_); });
      if (is_friction(k)) c.free = c.free + Number(time_step_) * frictions_[friction_of_[k]].surface_speed;
      equations_.add(k, connections_[k].response);
    }
    equations_.factorise(model_.solver());
    const std::span<const std::size_t> acting = equations_.acting();
    for (std::size_t a = 0; a < acting.size(); ++a) increments_[a] = increment(acting[a]);
    for (std::size_t p = 0; p < P; ++p) {
      for (std::size_t a = 0; a < acting.size(); ++a) solution_[a] = increments_[a].slopes[p];
      equations_.solve(solution_.data());
      for (std::size_t a = 0; a < acting.size(); ++a) {
        connections_[acting[a]].force.slopes[p] += equations_.response(a) * solution_[a];
        connections_[acting[a]].compression.slopes[p] += solution_[a];
      }
    }
    for (const std::size_t k : listed_) {
      if (connections_[k].response > 0) continue;
      const Number moved = increment(k);
      for (std::size_t p = 0; p < P; ++p) connections_[k].compression.slopes[p] += moved.slopes[p];
    }
    for (const Rubbing& rubbing : frictions_) connections_[rubbing.connection].free = increment(rubbing.connection);
  }
  // Slopes of the increment of a connection, under the slopes that the forces have by now.
  [[nodiscard]] Number increment(std::size_t k) const {
    Number sum = connections_[k].free;
    for (const std::size_t l : listed_) {
      const T receptance = model_.solver().receptance(k, l);
      for (std::size_t p = 0; p < P; ++p) sum.slopes[p] -= receptance * connections_[l].force.slopes[p];
    }
    return sum;
  }

  const NetworkPlan<T>& plan_;
  ContactNetwork<T> model_;
  T time_step_;
  detail::BodiesTangent<T, P> bodies_;
  std::vector<Connection> connections_;
  std::vector<Rubbing> frictions_;
  std::vector<std::size_t> friction_of_;  // of each connection that is friction
  std::vector<std::size_t> listed_;       // connections whose compression is followed in this sample
  detail::ForceEquations<T> equations_;
  std::vector<Number> increments_;  // for the connections that respond
  std::vector<T> solution_;
  std::size_t samples_ = 0;
};

}  // namespace contactspline
