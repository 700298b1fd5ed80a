// SPDX-License-Identifier: MIT
// What a network keeps of its bodies, places and connections.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/string_place.hpp"
#include "contactspline/modal/two_step_motion.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/friction_heat.hpp"
#include "contactspline/step/roughness.hpp"

namespace contactspline::detail {

/// A body of a network: its modes, its connections, and what is known of its motion before forces act.
template <std::floating_point T>
struct NetworkBody {
  NetworkBody(std::span<const Mode> modes, double sample_rate_hz) : bank(modes, sample_rate_hz) {}

  /// As ModalBank::retune. Modes that stretch the body by themselves stay.
  void retune(std::span<const Mode> modes) {
    bank.retune(motion ? modes.first(motion->own_springs()) : modes);
    take_motion();
  }
  /// Takes a motion of the modes that was set between two samples.
  void take_motion() {
    if (motion) motion->take_motion(bank);
  }
  [[nodiscard]] double energy() const { return motion ? motion->energy(bank) : bank.energy(); }
  [[nodiscard]] double kinetic_energy() const {
    return motion ? motion->kinetic_energy(bank) : bank.kinetic_energy();
  }
  [[nodiscard]] double dissipated() const { return motion ? motion->dissipated(bank) : bank.dissipated(); }
  /// Change of displacement at a place over the samples that the last forces acted on [m].
  [[nodiscard]] T increment(const ModeShapes<T>& at) const {
    return motion ? motion->increment_without_forms(at.data()) : bank.increment(at);
  }

  void reserve(std::size_t n) {
    for (auto* list : {&awake, &forced}) list->reserve(n);
    for (auto* list : {&awake_shapes, &forced_shapes}) list->reserve(n);
    for (auto* list : {&forces, &free_increments}) list->resize(n);
  }

  ModalBank<T> bank;
  std::optional<TwoStepMotion<T>> motion;  // of a network in which a body stretches
  T damping = 0;                           // times dt, as is the gain
  T damping_gain = 1;
  double total_receptance = 0;  // of all modes, where their shapes are 1 [m/N]
  // Bounds of the motion [m]: in this sample without forces of connections, and with them; since slacks were last
  // reduced; and how far that may go.
  T travel = 0, reach = 0;
  double travelled = 0, mark = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> places;
  std::vector<std::size_t> connections;
  std::vector<ModeShapes<double>> shapes;  // of each connection on this body
  ModeShapes<double> pushed;               // by how much a newton in one of them, or of a form, moves each mode [m/N]
  ModeShapes<T> pushed_by_place;           // the same of a newton at a place
  std::vector<double> receptances;         // of each with those up to itself, without damping [m/N]
  IndexList awake;                         // places whose increments are computed in each sample
  ReservedList<const T*> awake_shapes;
  T free_travel = 0;               // travel in the next sample without forces and damper [m]
  std::vector<T> free_increments;  // of the awake places in the next sample, without forces and damper [m]
  bool is_predicted = false;       // do free_travel and free_increments belong to the state?
  IndexList forced;                // places where forces act in this sample
  ReservedList<const T*> forced_shapes;
  std::vector<T> forces;
};

/// A place of a network, where connections and pushes act on a body.
template <std::floating_point T>
struct NetworkPlace {
  NetworkPlace(std::size_t of_body, const ModeShapes<T>& of_place) : body(of_body), shapes(of_place) {}

  // Largest |shape|, also where the place may move to.
  [[nodiscard]] T max_shape() const {
    T max = mover ? T(1) : T(0);
    for (std::size_t i = 0; i < shapes.size(); ++i) max = (std::max)(max, std::abs(shapes[i]));
    return max;
  }

  std::size_t body;
  ModeShapes<T> shapes;              // in this sample, where the place moves
  std::optional<std::size_t> mover;  // of a place that moves
  T travel_per_force = 0;            // sum over the modes of how far a newton here moves each [m/N]
  T push = 0, last_push = 0;         // from outside [N]
  T force = 0;                       // of this sample [N]
  bool is_awake = false, is_pushed = false, is_forced = false;
};

/// What a place that moves has beside its NetworkPlace.
template <std::floating_point T>
struct NetworkMover {
  std::size_t place;
  MovingPlace<T> motion;
  T target_m;
  T owed = 0;  // of the string's displacement there, so much presses the connections in the next sample only [m]
  bool is_moving = false;
  bool waits = false;  // under friction that is lifted: to be put where its control is
  bool is_new = true;  // has it moved since its receptances were measured?
};

/// What a network knows of a connection, beside the CoupledConnection of the solver.
template <std::floating_point T>
struct NetworkConnection {
  explicit NetworkConnection(const typename NetworkPlan<T>::Connection& plan)
      : first(plan.first),
        second(plan.second),
        weight(plan.weight),
        contact(held(ContactControls<T>{}, plan.contact)),
        spring(plan.spring_n_per_m),
        resistance(plan.resistance_n_s_per_m),
        gap(plan.gap_m),
        target_gap(plan.gap_m),
        pressed_by(plan.pressed_by) {}

  /// By how much the gap shrinks over the samples on which a force acts [m].
  [[nodiscard]] T lift_of_step() const { return lift + lift_before; }

  std::size_t first, second;
  std::size_t first_body = 0, second_body = 0;
  T first_max = 0, second_max = 0;  // |shape| on these bodies; if they are one, the first holds that of both
  T weight;
  ContactControls<T> contact;  // targets, which the connection of the solver follows
  T spring, resistance;
  T gap, target_gap;
  T lift = 0;                                // by how much the gap shrinks in this sample [m]
  T lift_before = 0;                         // and in the one before, where forces act on both [m]
  double own_receptance = 0;                 // without damping, which can only make it smaller [m/N]
  double first_slack = 0, second_slack = 0;  // of a sleeping contact: how far these bodies may still move it [m]
  T before = 0;                              // compression at the beginning of the sample [m]
  bool is_awake = true;
  bool is_following = false;
  RoughSurface<T> surface;  // of a contact
  T slide = 0;              // by how much it slides by itself in a sample [m]
  // Of friction.
  T normal_force = 0;  // target, without that of another connection [N]
  std::size_t pressed_by;
  T carried = 0;  // by how much the surface of the first place moves by itself in a sample [m]
  FrictionTemperature<T> temperature;
};

/// The bodies of a network, the places on them and the connections between these. Indices are those of the plan.
template <std::floating_point T>
struct NetworkParts {
  NetworkParts(const NetworkPlan<T>& plan, double sample_rate_hz) : samples_of_step(plan.samples_of_step()) {
    for (std::size_t b = 0; b < plan.bodies().size(); ++b) {
      bodies.emplace_back(plan.bodies()[b], sample_rate_hz);
      if (samples_of_step == 2) bodies[b].motion.emplace(plan.forms(b), bodies[b].bank);
    }
    for (const auto& place : plan.places()) {
      places.emplace_back(place.body, place.shapes);
      if (!place.wavenumbers_per_m.empty()) add_mover(plan, place, sample_rate_hz);
    }
    for (std::size_t p = 0; p < places.size(); ++p) bodies[places[p].body].places.push_back(p);
    for (NetworkBody<T>& body : bodies) body.reserve(body.places.size());
    for (const auto& connection : plan.connections()) {
      connections.emplace_back(connection);
      if (connection.roughness.height_m > 0)
        connections.back().surface = {connection.roughness, static_cast<std::uint32_t>(connections.size())};
    }
    for (NetworkConnection<T>& c : connections) {
      if (c.first != kGround) c.first_body = places[c.first].body;
      if (c.second != kGround) c.second_body = places[c.second].body;
    }
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (std::size_t k = 0; k < connections.size(); ++k)
        if (is_on(connections[k].first, b) || is_on(connections[k].second, b)) bodies[b].connections.push_back(k);
  }

  [[nodiscard]] bool is_on(std::size_t place, std::size_t body) const {
    return place != kGround && places[place].body == body;
  }
  [[nodiscard]] NetworkBody<T>& body_of(std::size_t place) { return bodies[places[place].body]; }
  [[nodiscard]] const NetworkBody<T>& body_of(std::size_t place) const { return bodies[places[place].body]; }

  /// Shapes of the modes at a place, after the last sample.
  [[nodiscard]] const ModeShapes<T>& shapes(std::size_t place) const {
    const auto& mover = places[place].mover;
    return mover ? movers[*mover].motion.after() : places[place].shapes;
  }

  /// Compression of a connection by the displacements of its places [m].
  [[nodiscard]] T measured(std::size_t connection) const {
    const NetworkConnection<T>& c = connections[connection];
    return pressing(c.first) - pressing(c.second) - c.gap;
  }

  int samples_of_step;  // on which a force acts: 2 where a body stretches
  std::vector<NetworkBody<T>> bodies;
  std::vector<NetworkPlace<T>> places;
  std::vector<NetworkMover<T>> movers;
  std::vector<NetworkConnection<T>> connections;

 private:
  void add_mover(const NetworkPlan<T>& plan, const typename NetworkPlan<T>::Place& place, double sample_rate_hz) {
    const StringShapes<T> of_string{std::span<const double>(place.wavenumbers_per_m)};
    const T longest_step = of_string.longest_step(plan.bodies()[place.body], sample_rate_hz);
    places.back().mover = movers.size();
    movers.push_back({places.size() - 1, MovingPlace<T>(of_string, place.place_m, longest_step), place.place_m});
  }

  [[nodiscard]] T pressing(std::size_t place) const {
    if (place == kGround) return 0;
    const auto& mover = places[place].mover;
    return body_of(place).bank.displacement(shapes(place)) - (mover ? movers[*mover].owed : T(0));
  }
};

}  // namespace contactspline::detail
