// SPDX-License-Identifier: MIT
// The samples of a network backwards, for its gradient (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/contact_gradient.hpp"
#include "contactspline/tangent/force_equations.hpp"
#include "contactspline/tangent/friction_backwards.hpp"
#include "contactspline/tangent/mode_tangent.hpp"
#include "contactspline/tangent/moving_places_backwards.hpp"
#include "contactspline/tangent/network_adjoints.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/network_record.hpp"
#include "contactspline/tangent/network_replay.hpp"

namespace contactspline {

namespace detail {

/// The samples of a record backwards, a block at a time. The adjoint of a value is the derivative of the sum with
/// respect to it.
template <std::floating_point T>
class NetworkBackwards {
 public:
  using Record = NetworkRecord<T>;

  NetworkBackwards(const NetworkPlan<T>& plan, double sample_rate_hz, const CoupledContacts<T>& solver,
                   const Record& record, const NetworkWeights<T>& weights)
      : plan_(plan),
        rate_(sample_rate_hz),
        solver_(solver),
        record_(record),
        weights_(weights),
        modes_(plan, sample_rate_hz),
        adjoints_(modes_.size()),
        places_(plan, modes_),
        movers_(plan, sample_rate_hz, record, modes_, places_, adjoints_),
        replay_(record, modes_, places_, movers_),
        equations_(plan.connections().size()),
        right_(plan.connections().size()) {
    for (std::size_t k = 0; k < plan.connections().size(); ++k) {
      const auto& connection = plan.connections()[k];
      connections_.push_back({{connection.table, connection.memories, solver[k].contact, sample_rate_hz}});
    }
    gradient_.motions.resize(record.motions.size());
    gradient_.pushes.resize(record.pushes.size());
    friction_of_.resize(plan.connections().size());
    for (std::size_t k = 0; k < plan.connections().size(); ++k)
      if (plan.connections()[k].friction) friction_of_[k] = frictions_.size(), frictions_.emplace_back();
    calls_ = record.rubbing_calls.size();
    gradient_.moves.resize(record.calls_follow.size());
    gradient_.starts.resize(plan.places().size());
  }

  [[nodiscard]] NetworkGradient<T> gradient() {
    const std::size_t samples = record_.ends.size();
    for (std::size_t block = (samples + Record::kBlock - 1) / Record::kBlock; block-- > 0;) {
      const std::size_t first = block * Record::kBlock, count = (std::min)(Record::kBlock, samples - first);
      replay_.play(block, count);
      for (std::size_t n = count; n-- > 0;) step(first + n, n);
    }
    movers_.finish(gradient_.starts);
    gradient_.normal_forces.resize(count_calls(false));
    gradient_.surface_speeds.resize(count_calls(true));
    std::ranges::reverse(gradient_.normal_forces);
    std::ranges::reverse(gradient_.surface_speeds);
    finish_bodies();
    for (std::size_t k = 0; k < connections_.size(); ++k) finish_connection(k);
    return gradient_;
  }

 private:
  using Acting = typename Record::Acting;
  using Ends = typename Record::Ends;
  using ContactStepBack = typename ContactBackwards<T>::Step;

  using Place = PlaceAdjoints<T>;

  struct Connection {
    ContactBackwards<T> contact;
    T gap = 0, spring = 0, resistance = 0, force = 0;
    T pressing = 0;  // adjoint of its force by the friction that it presses in the next sample
  };

  // Sample n back, which is this row of its block.
  void step(std::size_t n, std::size_t row) {
    const T *change = replay_.change(row), *displacement = replay_.displacement(row);
    const std::span<const Acting> acting = record_.in_sample(record_.acting, &Ends::acting, n);
    for (const auto& rubbing : record_.in_sample(record_.rubbing, &Ends::rubbing, n))
      friction(rubbing.connection).linearise(plan_.connections()[rubbing.connection], rate_, rubbing);
    places_.list(record_, n);
    movers_.enter(n);
    for (std::size_t p = 0; p < (std::min)(weights_.displacements.size(), places_.size()); ++p)
      if (const T weight = weight_of(weights_.displacements, p, n); weight != 0)
        places_.touch(p).by_weights += weight;
    linearise(acting);
    for (const std::size_t p : places_.touched())
      if (const Place& place = places_[p]; place.after + place.by_weights != 0)
        add_scaled(0, place.modes(), place.after + place.by_weights, place.seen,
                   adjoints_.displacement.data() + place.begin);
    retract(modes_.size(), modes_.stiffness.data(), modes_.loss.data(), change, displacement,
            adjoints_.increment.data(), adjoints_.displacement.data(), adjoints_.change.data(),
            adjoints_.stiffness.data(), adjoints_.loss.data());
    movers_.retract(change, replay_.last_change(row));
    measure_pushes();
    solve(acting, n);
    push_connections(acting);
    respond();
    movers_.respond(replay_.last_change(row));
    add_to_places(change, displacement);
    movers_.add_shapes(change, displacement);
    add_pushes(n);
    add_rubbing_calls(n);
    if (movers_.leave(n, add_motions(n), gradient_))
      for (Connection& c : connections_) c.contact.jump();
  }

  // The modes back over a sample, but for what the forces respond to: first, with what they did, over the next one.
  static void retract(std::size_t modes, const T* __restrict stiffness, const T* __restrict loss,
                      const T* __restrict change, const T* __restrict displacement, T* __restrict of_increment,
                      T* __restrict of_displacement, T* __restrict of_change, T* __restrict of_stiffness,
                      T* __restrict of_loss) {
    for (std::size_t i = 0; i < modes; ++i) {
      const T next = of_increment[i] = of_change[i] - of_increment[i];
      of_stiffness[i] -= displacement[i] * next;
      of_loss[i] -= change[i] * next;
      of_displacement[i] -= stiffness[i] * next;
      of_change[i] = of_displacement[i] + (2 - loss[i]) * next;
    }
  }

  // What forces that respond to displacements do to the modes.
  void respond() {
    for (const std::size_t p : places_.forced()) {
      const Place& place = places_[p];
      if (place.is_moving) continue;
      add_responses(place.modes(), place.by_forces, place.before, place.acting, adjoints_.change.data() + place.begin,
                    adjoints_.displacement.data() + place.begin);
    }
  }
  static void add_responses(std::size_t modes, T by_forces, T before, const T* __restrict shapes,
                            T* __restrict of_change, T* __restrict of_displacement) {
    for (std::size_t i = 0; i < modes; ++i) {
      of_change[i] += by_forces * shapes[i];
      of_displacement[i] += (by_forces + before) * shapes[i];
    }
  }

  // Last increments and memories back, and the slopes of all forces.
  void linearise(std::span<const Acting> acting) {
    steps_.clear();
    for (const Acting& a : acting) {
      Connection& c = connections_[a.connection];
      if (plan_.connections()[a.connection].friction) {
        const FrictionBackwards<T>& rubbing = friction(a.connection);
        press(a.connection, rubbing.of_increment(), &Place::after);
        press(a.connection, -rubbing.of_increment(), &Place::before);
        ContactSlopes<T> slopes;
        slopes.before = -rubbing.response();
        slopes.after = rubbing.response();
        steps_.push_back({{}, slopes});
        continue;
      }
      if (plan_.connections()[a.connection].table.empty()) {
        const T half = solver_[a.connection].spring_n_per_m / 2, resistance = solver_[a.connection].resistance;
        ContactSlopes<T> slopes;
        slopes.before = half - resistance;
        slopes.after = half + resistance;
        steps_.push_back({{}, slopes});
        continue;
      }
      const auto relaxed = c.contact.relax(a.sample);
      press(a.connection, relaxed.after, &Place::after);
      press(a.connection, relaxed.before, &Place::before);
      steps_.push_back(c.contact.linearise(a.sample, T(0)));
    }
  }

  [[nodiscard]] FrictionBackwards<T>& friction(std::size_t k) { return frictions_[friction_of_[k]]; }

  // Adds to the adjoint of a compression, and so to those of the displacements of its places.
  void press(std::size_t k, T adjoint, T Place::*member) {
    const auto& connection = plan_.connections()[k];
    if (connection.first != kGround) places_[connection.first].*member += adjoint;
    if (connection.second != kGround) places_[connection.second].*member -= adjoint;
    connections_[k].gap -= adjoint;
  }

  // The adjoint of a force at each place, by the adjoints of the changes of the modes.
  void measure_pushes() {
    for (const std::size_t p : places_.forced()) {
      const T *shape = places_[p].acting, *receptance = modes_.receptance.data() + places_[p].begin;
      const T* adjoint = adjoints_.change.data() + places_[p].begin;
      places_[p].pushed =
          sum_of<T>(places_[p].modes(), [&](std::size_t i) { return shape[i] * receptance[i] * adjoint[i]; });
    }
  }

  // The adjoints of all forces together.
  void solve(std::span<const Acting> acting, std::size_t n) {
    equations_.begin();
    for (std::size_t a = 0; a < acting.size(); ++a) {
      const auto& connection = plan_.connections()[acting[a].connection];
      T& force = connections_[acting[a].connection].force =
          weight_of(weights_.forces, acting[a].connection, n) +
          std::exchange(connections_[acting[a].connection].pressing, T(0));
      if (connection.first != kGround) force -= places_[connection.first].pushed;
      if (connection.second != kGround) force += places_[connection.second].pushed;
      equations_.add(acting[a].connection, steps_[a].slopes.after);
    }
    const std::span<const std::size_t> responding = equations_.acting();
    if (responding.empty()) return;
    const CoupledContacts<T>& solver = movers_.solver(solver_);
    equations_.factorise(solver);
    for (std::size_t a = 0; a < responding.size(); ++a) right_[a] = connections_[responding[a]].force;
    equations_.solve(right_.data());
    for (std::size_t a = 0; a < responding.size(); ++a) {
      connections_[responding[a]].force = right_[a];
      right_[a] *= equations_.response(a);
    }
    for (std::size_t b = 0; b < acting.size(); ++b) {  // springs of no stiffness have an adjoint, too
      if (steps_[b].slopes.after > 0) continue;
      for (std::size_t a = 0; a < responding.size(); ++a)
        connections_[acting[b].connection].force -=
            solver.receptance(acting[b].connection, responding[a]) * right_[a];
    }
  }

  // What the adjoints of the forces do to compressions and numbers.
  void push_connections(std::span<const Acting> acting) {
    for (std::size_t a = 0; a < acting.size(); ++a) {
      const auto& [k, sample] = acting[a];
      const ContactSlopes<T>& slopes = steps_[a].slopes;
      Connection& c = connections_[k];
      press(k, slopes.after * c.force, &Place::by_forces);
      press(k, slopes.before * c.force, &Place::before);
      if (!plan_.connections()[k].table.empty()) {
        c.contact.push(sample, steps_[a], c.force);
        continue;
      }
      if (plan_.connections()[k].friction) {
        const T pressing = friction(k).push(c.force);
        if (pressing != 0) connections_[plan_.connections()[k].pressed_by].pressing += pressing;
        continue;
      }
      c.spring += (sample.before + sample.after) / 2 * c.force;
      c.resistance += (sample.after - sample.before) * c.force;
    }
  }

  // The adjoints of the shapes of a place on which forces act.
  static void add_to_shapes(std::size_t modes, T sum, T before, T force, const T* __restrict displacement,
                            const T* __restrict change, const T* __restrict of_change, T* __restrict of_shapes,
                            T* __restrict forced) {
    for (std::size_t i = 0; i < modes; ++i) {
      of_shapes[i] += sum * displacement[i] - before * change[i];
      forced[i] += force * of_change[i];
    }
  }
  void add_to_places(const T* change, const T* displacement) {
    const std::size_t forced = places_.forced().size();
    const std::span<const std::size_t> touched = places_.touched();
    for (std::size_t i = 0; i < touched.size(); ++i) {
      Place& place = places_[touched[i]];
      if (place.is_moving) continue;
      const std::size_t modes = place.modes(), begin = place.begin;
      const T after = place.after + place.by_weights;
      if (i < forced)
        add_to_shapes(modes, after + place.by_forces + place.before, place.before, place.force, displacement + begin,
                      change + begin, adjoints_.change.data() + begin, place.shapes.data(), place.forced.data());
      else
        add_scaled(0, modes, after, displacement + begin, place.shapes.data());
    }
  }

  void add_pushes(std::size_t n) {
    const auto pushes = record_.in_sample(record_.pushes, &Ends::pushes, n);
    if (pushes.empty()) return;
    measure_pushes();
    for (std::size_t i = 0; i < pushes.size(); ++i)
      if (pushes[i].follows)
        gradient_.pushes[record_.ends[n].pushes - pushes.size() + i] = places_[pushes[i].place].pushed;
  }

  // What was set before the sample acts in all that follow, until it is set again.
  void add_rubbing_calls(std::size_t n) {
    for (; calls_ > 0 && record_.rubbing_calls[calls_ - 1].sample >= n; --calls_) {
      const auto& call = record_.rubbing_calls[calls_ - 1];
      const T adjoint = call.sample > n ? T(0) : friction(call.connection).take(call.is_speed);
      (call.is_speed ? gradient_.surface_speeds : gradient_.normal_forces).push_back(call.follows ? adjoint : T(0));
    }
  }

  [[nodiscard]] std::size_t count_calls(bool of_speed) const {
    return static_cast<std::size_t>(
        std::ranges::count(record_.rubbing_calls, of_speed, &Record::RubbingCall::is_speed));
  }

  // Before the sample: the motion of a mass that was set there does not depend on what was before. Were there any?
  bool add_motions(std::size_t n) {
    const auto motions = record_.in_sample(record_.motions, &Ends::motions, n);
    for (std::size_t i = motions.size(); i-- > 0;) {
      const std::size_t mode = modes_.begins[motions[i].body];
      auto& gradient = gradient_.motions[record_.ends[n].motions - motions.size() + i];
      if (motions[i].displacement_follows) gradient.displacement_m = adjoints_.displacement[mode];
      if (motions[i].velocity_follows)
        gradient.velocity_m_per_s = (adjoints_.change[mode] - adjoints_.increment[mode]) * static_cast<T>(1 / rate_);
      adjoints_.displacement[mode] = adjoints_.change[mode] = adjoints_.increment[mode] = 0;
    }
    return !motions.empty();
  }

  void finish_bodies() {
    std::vector<T>& receptance = adjoints_.receptance;
    NetworkNumbers<T>& numbers = gradient_.numbers;
    for (std::size_t p = 0; p < places_.size(); ++p) {
      const Place& place = places_[p];
      numbers.places.emplace_back(place.modes());
      for (std::size_t i = 0; i < place.modes(); ++i) {
        numbers.places[p][i] = place.shapes[i] + modes_.receptance[place.begin + i] * place.forced[i];
        receptance[place.begin + i] += place.acting[i] * place.forced[i];
      }
    }
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b) {
      numbers.bodies.emplace_back();
      for (std::size_t i = 0; i < plan_.bodies()[b].size(); ++i) {
        const std::size_t m = modes_.begins[b] + i;
        const auto by = [&](const Mode& direction) {
          const ModeStep step = step_tangent(plan_.bodies()[b][i], direction, rate_);
          return double(adjoints_.stiffness[m]) * step.stiffness + double(adjoints_.loss[m]) * step.loss +
                 double(receptance[m]) * step.receptance;
        };
        numbers.bodies[b].push_back({by({1, 0, 0}), by({0, 1, 0}), by({0, 0, 1})});
      }
    }
  }

  void finish_connection(std::size_t k) {
    const Connection& c = connections_[k];
    ConnectionNumbers<T> numbers{c.contact.gradient(), c.gap, c.spring, c.resistance * static_cast<T>(rate_)};
    if (plan_.connections()[k].friction) numbers.friction = friction(k).numbers();
    numbers.contact.stiffness_ratio *= plan_.connections()[k].weight;
    gradient_.numbers.connections.push_back(std::move(numbers));
  }

  [[nodiscard]] static T weight_of(const std::vector<std::vector<T>>& weights, std::size_t i, std::size_t n) {
    return i < weights.size() && n < weights[i].size() ? weights[i][n] : T(0);
  }

  const NetworkPlan<T>& plan_;
  double rate_;
  const CoupledContacts<T>& solver_;
  const Record& record_;
  const NetworkWeights<T>& weights_;
  NetworkModes<T> modes_;
  ModeAdjoints<T> adjoints_;
  PlacesBackwards<T> places_;
  MovingPlaces<T> movers_;
  NetworkReplay<T> replay_;
  std::vector<Connection> connections_;
  std::vector<FrictionBackwards<T>> frictions_;
  std::vector<std::size_t> friction_of_;  // of each connection that is friction
  std::size_t calls_ = 0;                 // of normal forces and surface speeds, from here back
  std::vector<ContactStepBack> steps_;    // of each connection that acts
  ForceEquations<T> equations_;
  std::vector<T> right_;
  NetworkGradient<T> gradient_;
};

}  // namespace detail

}  // namespace contactspline
