// SPDX-License-Identifier: MIT
// A network of bodies, contacts and springs with its derivatives with respect to several parameters, forwards
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <utility>
#include <vector>

#include "contactspline/network/contact_network.hpp"
#include "contactspline/tangent/contact_tangent.hpp"
#include "contactspline/tangent/mode_tangent.hpp"

namespace contactspline {

/// One value for each number of a connection, as in ContactNumbers.
template <std::floating_point T>
struct ConnectionNumbers {
  ContactNumbers<T> contact = {};
  T gap_m = 0, spring_n_per_m = 0, resistance_n_s_per_m = 0;
};

/// One value for each number of a network, in the order of its plan. An empty vector is 0; others are as long as in
/// the plan, each body as its modes.
template <std::floating_point T>
struct NetworkNumbers {
  std::vector<std::vector<Mode>> bodies = {};
  std::vector<ModeShapes<T>> places = {};
  std::vector<ConnectionNumbers<T>> connections = {};
};

/// A ContactNetwork with its derivatives with respect to P parameters. Controls stay as the plan says, places do not
/// move along strings, rigid links keep their stiffness.
template <std::floating_point T, std::size_t P>
class NetworkTangent {
 public:
  using Number = Dual<T, P>;

  /// The plan must outlive this. directions: one for each parameter.
  NetworkTangent(const NetworkPlan<T>& plan, double sample_rate_hz,
                 const std::array<NetworkNumbers<T>, P>& directions)
      : plan_(plan), model_(plan, sample_rate_hz), time_step_(static_cast<T>(1 / sample_rate_hz)) {
    for (std::size_t b = 0; b < plan.bodies().size(); ++b) add_body(b, sample_rate_hz, directions);
    for (std::size_t q = 0; q < plan.places().size(); ++q) add_place(q, directions);
    for (std::size_t k = 0; k < plan.connections().size(); ++k) add_connection(k, sample_rate_hz, directions);
    matrix_.resize(connections_.size() * connections_.size());
    solution_.resize(connections_.size());
    acting_.reserve(connections_.size());
    measure_compressions();
  }

  /// Puts a free mass between two samples at a displacement [m] with a velocity [m/s].
  void set_motion(std::size_t mass, const Number& displacement_m, const Number& velocity_m_per_s) {
    model_.set_motion(mass, displacement_m.value, velocity_m_per_s.value);
    bodies_[mass][0].displacement = displacement_m;
    bodies_[mass][0].increment = Number(time_step_) * velocity_m_per_s;
    measure_compressions();
  }

  /// Pushes at a place during the next sample [N]. Several pushes add up.
  void push(std::size_t place, const Number& force_n) {
    model_.push(place, force_n.value);
    places_[place].push = places_[place].push + force_n;
  }

  /// Advances one sample. Does not allocate.
  void tick() {
    model_.tick();
    respond();
    push_modes();
    solve();
    push_modes();
    for (Place& place : places_) place.push = Number();
    advance_modes();
    measure_compressions();
    for (std::size_t k = 0; k < connections_.size(); ++k)
      if (is_contact(k)) connections_[k].contact.relax(connections_[k].compression);
  }

  [[nodiscard]] const ContactNetwork<T>& model() const { return model_; }
  /// Displacement of a place [m].
  [[nodiscard]] Number displacement(std::size_t place) const { return at(place, &ModeTangent::displacement); }
  /// Force of a connection over the last sample [N].
  [[nodiscard]] const Number& force(std::size_t connection) const { return connections_[connection].force; }
  [[nodiscard]] const Number& compression(std::size_t connection) const {  ///< [m], negative while apart
    return connections_[connection].compression;
  }

 private:
  // The constants and the motion of a mode (ModalBank). Only the slopes of the increment count.
  struct ModeTangent {
    Number stiffness, loss, admittance;
    Number displacement, increment, change;
  };
  struct Place {
    std::size_t body;
    std::vector<Number> shapes;
    Number push, force;
  };
  // response: the derivative of the force with respect to the increment [N/m].
  struct Connection {
    ContactTangent<T, P> contact;
    ContactControls<T> controls;
    Number gap, spring, resistance, compression, force;
    T response = 0;
  };
  using Directions = std::array<NetworkNumbers<T>, P>;

  void add_body(std::size_t b, double sample_rate_hz, const Directions& directions) {
    bodies_.emplace_back();
    for (std::size_t i = 0; i < plan_.bodies()[b].size(); ++i) {
      const Mode& mode = plan_.bodies()[b][i];
      const auto number = [&](double detail::ModeStep::*member) {
        Number result(static_cast<T>(detail::step_of(mode, sample_rate_hz).*member));
        for (std::size_t p = 0; p < P; ++p)
          if (const auto& all = directions[p].bodies; !all.empty() && !all[b].empty())
            result.slopes[p] = static_cast<T>(detail::step_tangent(mode, all[b][i], sample_rate_hz).*member);
        return result;
      };
      using detail::ModeStep;
      bodies_[b].push_back(
          {number(&ModeStep::stiffness), number(&ModeStep::loss), number(&ModeStep::admittance), {}, {}, {}});
    }
  }

  void add_place(std::size_t q, const Directions& directions) {
    const auto& place = plan_.places()[q];
    places_.push_back({place.body, {}, {}, {}});
    for (std::size_t i = 0; i < place.shapes.size(); ++i) {
      Number shape(place.shapes[i]);
      for (std::size_t p = 0; p < P; ++p)
        if (const auto& all = directions[p].places; !all.empty() && all[q].size() > 0) shape.slopes[p] = all[q][i];
      places_[q].shapes.push_back(shape);
    }
  }

  void add_connection(std::size_t k, double sample_rate_hz, const Directions& directions) {
    const auto& plan = plan_.connections()[k];
    const CoupledConnection<T>& acting = model_.solver()[k];
    std::array<ContactNumbers<T>, P> contacts;
    Number gap(plan.gap_m), spring(acting.spring_n_per_m), resistance(acting.resistance);
    for (std::size_t p = 0; p < P; ++p) {
      if (directions[p].connections.empty()) continue;
      const ConnectionNumbers<T>& direction = directions[p].connections[k];
      contacts[p] = direction.contact;
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
                            {},
                            {},
                            0});
  }

  [[nodiscard]] bool is_contact(std::size_t k) const { return !plan_.connections()[k].table.empty(); }

  // The forces of the sample that the model has played, and how they respond to the compressions before it and to
  // parameters at constant increments.
  void respond() {
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      Connection& c = connections_[k];
      const T force = model_.force(k), before = c.compression.value, after = model_.compression(k);
      if (is_contact(k)) {
        const auto response = c.contact.respond(c.controls, c.compression, force, after);
        c.force = response.force;
        c.response = response.stiffness;
        continue;
      }
      const Number change(after - before);
      c.force = c.spring * (c.compression + Number(T(0.5)) * change) + c.resistance * change;
      c.force.value = force;
      c.response = c.spring.value / 2 + c.resistance.value;
    }
  }

  // How the modes change over the sample under these forces.
  void push_modes() {
    for (Place& place : places_) place.force = place.push;
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      const std::size_t first = plan_.connections()[k].first, second = plan_.connections()[k].second;
      if (first != kGround) places_[first].force = places_[first].force - connections_[k].force;
      if (second != kGround) places_[second].force = places_[second].force + connections_[k].force;
    }
    for (auto& body : bodies_)
      for (ModeTangent& mode : body) mode.change = mode.increment;
    for (const Place& place : places_)
      for (std::size_t i = 0; i < place.shapes.size(); ++i) {
        ModeTangent& mode = bodies_[place.body][i];
        mode.change = mode.change + mode.admittance * place.shapes[i] * place.force;
      }
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (std::size_t i = 0; i < bodies_[b].size(); ++i) bodies_[b][i].change.value = model_.body(b).changes()[i];
  }

  // Adds to the derivatives of the forces what the increments do. With r = force' at constant increments and x0' =
  // increment' under the forces r: force' = r + g, (1 + response Xi) g = response x0'. Newton's matrix of the
  // network, whose eigenvalues are 1 or more.
  void solve() {
    acting_.clear();
    for (std::size_t k = 0; k < connections_.size(); ++k)
      if (connections_[k].response > 0) acting_.push_back(k);
    const std::size_t n = acting_.size();
    for (std::size_t a = 0; a < n; ++a) {
      const T response = connections_[acting_[a]].response;
      solution_[a] = Number(response) * between(acting_[a], &ModeTangent::change);
      for (std::size_t b = 0; b < n; ++b)
        matrix_[a * n + b] = T(a == b) + response * model_.solver().admittance(acting_[a], acting_[b]);
    }
    eliminate(n);
    for (std::size_t a = n; a-- > 0;) {
      Number& g = solution_[a];
      for (std::size_t b = a + 1; b < n; ++b) g = g - Number(matrix_[a * n + b]) * solution_[b];
      g = Number(1 / matrix_[a * n + a]) * g;
      for (std::size_t p = 0; p < P; ++p) connections_[acting_[a]].force.slopes[p] += g.slopes[p];
    }
  }

  // Gauss's elimination by the largest number of each column.
  void eliminate(std::size_t n) {
    for (std::size_t column = 0; column < n; ++column) {
      std::size_t largest = column;
      for (std::size_t a = column + 1; a < n; ++a)
        if (std::abs(matrix_[a * n + column]) > std::abs(matrix_[largest * n + column])) largest = a;
      if (largest != column) {
        std::swap_ranges(&matrix_[largest * n], &matrix_[largest * n] + n, &matrix_[column * n]);
        std::swap(solution_[largest], solution_[column]);
        std::swap(acting_[largest], acting_[column]);
      }
      for (std::size_t a = column + 1; a < n; ++a) {
        const T factor = matrix_[a * n + column] / matrix_[column * n + column];
        if (factor == 0) continue;
        for (std::size_t b = column; b < n; ++b) matrix_[a * n + b] -= factor * matrix_[column * n + b];
        solution_[a] = solution_[a] - Number(factor) * solution_[column];
      }
    }
  }

  void advance_modes() {
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      for (std::size_t i = 0; i < bodies_[b].size(); ++i) {
        ModeTangent& mode = bodies_[b][i];
        mode.displacement = mode.displacement + mode.change;
        mode.displacement.value = model_.body(b).displacement(i);
        mode.increment = (Number(2) - mode.loss) * mode.change - mode.increment - mode.stiffness * mode.displacement;
      }
  }

  void measure_compressions() {
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      connections_[k].compression = between(k, &ModeTangent::displacement) - connections_[k].gap;
      connections_[k].compression.value = model_.compression(k);
    }
  }

  [[nodiscard]] Number at(std::size_t place, Number ModeTangent::*member) const {
    Number sum;
    const Place& p = places_[place];
    for (std::size_t i = 0; i < p.shapes.size(); ++i) sum = sum + p.shapes[i] * bodies_[p.body][i].*member;
    return sum;
  }
  // A value at the first place of a connection less that at the second.
  [[nodiscard]] Number between(std::size_t k, Number ModeTangent::*member) const {
    const auto& plan = plan_.connections()[k];
    const Number first = plan.first == kGround ? Number() : at(plan.first, member);
    return plan.second == kGround ? first : first - at(plan.second, member);
  }

  const NetworkPlan<T>& plan_;
  ContactNetwork<T> model_;
  T time_step_;
  std::vector<std::vector<ModeTangent>> bodies_;
  std::vector<Place> places_;
  std::vector<Connection> connections_;
  std::vector<std::size_t> acting_;  // connections whose forces respond to increments
  std::vector<Number> solution_;     // of each of them
  std::vector<T> matrix_;
};

}  // namespace contactspline
