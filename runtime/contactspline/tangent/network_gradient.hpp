// SPDX-License-Identifier: MIT
// The gradient of anything that is computed from the samples of a network, with respect to all its numbers at once:
// backwards (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/string_place.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/memory.hpp"
#include "contactspline/tangent/network_backwards.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/network_record.hpp"

namespace contactspline {

/// A ContactNetwork that keeps what its gradient needs: in each sample 4 numbers, 9 for each spring and each contact
/// that touches or remembers, 16 for each friction, and 1/64 of a number for each mode. Play it as the network,
/// compute the derivatives of any function with respect to its samples, and call gradient(). Controls of contacts and
/// springs stay as the plan says, rigid links keep their stiffness.
template <std::floating_point T>
class RecordedNetwork {
 public:
  /// The plan must outlive this. None of its bodies stretches (RecordedStretching), none of its contacts is rough,
  /// and none of its friction is at a place that moves along a string.
  RecordedNetwork(const NetworkPlan<T>& plan, double sample_rate_hz)
      : plan_(plan), rate_(sample_rate_hz), model_(plan, sample_rate_hz) {
    for (std::size_t k = 0; k < plan.connections().size(); ++k)
      if (!plan.connections()[k].memories.empty()) remembering_.push_back(k);
    for (std::size_t k = 0; k < plan.connections().size(); ++k)
      if (plan.connections()[k].friction) frictions_.emplace_back().connection = k;
    remembered_.resize(remembering_.size());
    last_increments_.resize(plan.connections().size());
    controls_n_.resize(plan.connections().size());
    mover_of_.resize(plan.places().size());
    for (std::size_t p = 0; p < plan.places().size(); ++p)
      if (!plan.places()[p].wavenumbers_per_m.empty()) add_mover(p);
  }

  /// Puts a free mass between two samples at a displacement [m], -1000 to 1000, with a velocity [m/s], -1000 to 1000.
  /// mass: a body of NetworkPlan::add_mass(). A value beyond its range acts as the end of the range: its derivative
  /// is 0. If one of them is not a number the call does nothing, and the gradient leaves it out.
  void set_motion(std::size_t mass, T displacement_m, T velocity_m_per_s) {
    if (!is_number(displacement_m) || !is_number(velocity_m_per_s)) return;
    model_.set_motion(mass, displacement_m, velocity_m_per_s);
    std::ranges::fill(last_increments_, T(0));
    const ModalBank<T>& body = model_.body(mass);
    record_.motions.push_back({mass, body.displacement(std::size_t{0}), body.free_increments()[0],
                               is_within(displacement_m, Ranges::displacement_m),
                               is_within(velocity_m_per_s, Ranges::speed_m_per_s)});
  }

  /// Pushes at a place during the next sample [N], -1000 to 1000, with the same rules. Several pushes add up.
  void push(std::size_t place, T force_n) {
    if (!is_number(force_n)) return;
    model_.push(place, force_n);
    record_.pushes.push_back({place, held(T(0), force_n, Ranges::force_n), is_within(force_n, Ranges::force_n)});
  }

  /// ContactNetwork::set_normal_force and set_surface_speed, with the same rules.
  void set_normal_force(std::size_t connection, T force_n) {
    if (!is_number(force_n)) return;
    model_.set_normal_force(connection, force_n);
    controls_n_[connection] = held(T(0), force_n, Ranges::normal_force_n);
    record_.rubbing_calls.push_back({samples(), connection, false, is_within(force_n, Ranges::normal_force_n)});
  }
  void set_surface_speed(std::size_t connection, T speed_m_per_s) {
    if (!is_number(speed_m_per_s)) return;
    model_.set_surface_speed(connection, speed_m_per_s);
    record_.rubbing_calls.push_back({samples(), connection, true, is_within(speed_m_per_s, Ranges::speed_m_per_s)});
  }

  /// ContactNetwork::put_place, with the same rules: beyond the ends of the string its derivative is 0, and if it is
  /// not a number the gradient leaves it out.
  void put_place(std::size_t place, T place_m) {
    model_.put_place(place, place_m);
    std::ranges::fill(last_increments_, T(0));
    Mover& mover = movers_[mover_of_[place]];
    mover.call = call_of(mover, place_m);
    mover.at_m = mover.target_m = model_.place_m(place);
    mover.has_moved = mover.is_called = false;
    record_.moves.push_back({samples(), mover_of_[place], mover.call, mover.at_m, true});
  }

  /// ContactNetwork::move_place, with the same rules. The derivative with respect to each position that the place
  /// reaches; a place that is slower than its target does not follow it, but moves from where it is. Each call costs
  /// a sample in which the place moves, even if its target stays.
  void move_place(std::size_t place, T place_m) {
    model_.move_place(place, place_m);
    Mover& mover = movers_[mover_of_[place]];
    mover.call = call_of(mover, place_m);
    mover.target_m = held(mover.at_m, place_m, mover.range);
    mover.is_called = true;
  }

  /// Advances one sample. Allocates now and then: the record grows with time, in double by 32 bytes a sample, 72 for
  /// each spring and each contact that touches or remembers, 128 for each friction, 24 for each push, 40 for each
  /// place that moves and 1/8 for each mode, 3/16 if the plan has places that may move.
  void tick() {
    if (record_.ends.size() % detail::NetworkRecord<T>::kBlock == 0) keep_state();
    for (std::size_t i = 0; i < remembering_.size(); ++i)
      remembered_[i] = model_.solver()[remembering_[i]].memory.remembered();
    for (Rubbing& rubbing : frictions_) begin_friction(rubbing);
    model_.tick();
    for (Rubbing& rubbing : frictions_) keep_friction(rubbing);
    for (const std::size_t k : model_.solver().active()) {
      const auto& connection = plan_.connections()[k];
      if (connection.memories.empty() && (connection.table.empty() || touches(k))) keep(k, {});
    }
    for (std::size_t i = 0; i < remembering_.size(); ++i) {
      if (remembered_[i].line() > 0 || touches(remembering_[i])) keep(remembering_[i], remembered_[i].values());
    }
    for (std::size_t m = 0; m < movers_.size(); ++m) keep_move(m);
    record_.ends.push_back(
        {record_.acting.size(), record_.pushes.size(), record_.motions.size(), record_.rubbing.size()});
  }

  [[nodiscard]] const ContactNetwork<T>& model() const { return model_; }
  [[nodiscard]] std::size_t samples() const { return record_.ends.size(); }  ///< that were played

  /// The gradient of sum(weights times samples). It plays the modes once more, without contacts, and goes back once
  /// through everything.
  [[nodiscard]] NetworkGradient<T> gradient(const NetworkWeights<T>& weights) const {
    return detail::NetworkBackwards<T>(plan_, rate_, model_.solver(), record_, weights).gradient();
  }

 private:
  using Ranges = ControlRanges<T>;

  // A place that moves. call: which one said where it is sent, and did the last sample begin with it?
  struct Mover {
    ControlRange<T> range;
    T at_m, target_m;
    std::size_t call = detail::NetworkRecord<T>::kAsBefore;
    bool is_called = false, has_moved = false;
  };

  using Rubbing = typename detail::NetworkRecord<T>::Rubbing;

  // What friction keeps before a sample, and whether another connection presses it.
  void begin_friction(Rubbing& rubbing) {
    const Friction<T>& friction = model_.solver()[rubbing.connection].friction;
    rubbing.before = {friction.strain(), model_.temperature(rubbing.connection), friction.normal_force()};
    const std::size_t by = plan_.connections()[rubbing.connection].pressed_by;
    rubbing.is_pressed = by != kNoConnection && model_.force(by) > 0;
    const T sum = controls_n_[rubbing.connection] + (rubbing.is_pressed ? model_.force(by) : T(0));
    rubbing.follows = is_within(sum, Ranges::normal_force_n);
  }
  void keep_friction(Rubbing& rubbing) {
    const auto& connection = model_.solver()[rubbing.connection];
    rubbing.normal_force = connection.friction.normal_force();
    rubbing.increment = connection.friction_step.increment;
    record_.rubbing.push_back(rubbing);
  }

  void add_mover(std::size_t p) {
    const auto& place = plan_.places()[p];
    const StringShapes<T> shapes{std::span<const double>(place.wavenumbers_per_m)};
    mover_of_[p] = movers_.size();
    movers_.push_back({{0, shapes.length()}, place.place_m, place.place_m});
    record_.movers.push_back(p);
  }
  // Counts a call that sends a place somewhere.
  [[nodiscard]] std::size_t call_of(const Mover& mover, T place_m) {
    if (!is_number(place_m)) return detail::NetworkRecord<T>::kAsBefore;
    record_.calls_follow.push_back(is_within(place_m, mover.range) ? 1 : 0);
    return record_.calls_follow.size() - 1;
  }
  // A place at rest whose target follows a parameter moves by nothing, but its derivatives do. The next sample ends
  // the move.
  void keep_move(std::size_t m) {
    Mover& mover = movers_[m];
    const T at_m = model_.place_m(record_.movers[m]);
    const bool arrives = mover.call != detail::NetworkRecord<T>::kAsBefore && at_m == mover.target_m;
    const bool moves = at_m != mover.at_m || (arrives && mover.is_called);
    if (moves || mover.has_moved)
      record_.moves.push_back(
          {samples(), m, arrives ? mover.call : detail::NetworkRecord<T>::kAsBefore, at_m, false});
    mover.at_m = at_m;
    mover.has_moved = moves;
    mover.is_called = false;
  }
  [[nodiscard]] static bool is_within(T value, ControlRange<T> range) { return held(T(0), value, range) == value; }
  // Does a contact press, or may its loss in the next sample follow this one?
  [[nodiscard]] bool touches(std::size_t k) const {
    return model_.force(k) > 0 || model_.solver()[k].compression > 0;
  }
  void keep(std::size_t k, const std::array<T, kMaxMemories>& remembered) {
    const T before = model_.compression_before(k), after = model_.solver()[k].compression;
    record_.acting.push_back({k, {before, after, model_.force(k), last_increments_[k], remembered}});
    last_increments_[k] = after - before;
  }
  void keep_state() {
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b)
      std::ranges::copy(model_.body(b).displacements(), std::back_inserter(record_.states));
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b)
      std::ranges::copy(model_.body(b).free_increments(), std::back_inserter(record_.states));
    if (movers_.empty()) return;
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b)
      std::ranges::copy(model_.body(b).changes(), std::back_inserter(record_.states));
    for (const Mover& mover : movers_) record_.states.push_back(mover.at_m);
  }

  const NetworkPlan<T>& plan_;
  double rate_;
  ContactNetwork<T> model_;
  detail::NetworkRecord<T> record_;
  std::vector<std::size_t> remembering_;                 // contacts with a memory
  std::vector<detail::RememberedForces<T>> remembered_;  // by them before a sample
  std::vector<Rubbing> frictions_;                       // in the sample that plays
  // Of each connection, over the sample before. Where it did not touch then it is older, and its loss is 0.
  std::vector<T> last_increments_;
  std::vector<T> controls_n_;  // normal forces of friction, by control
  std::vector<Mover> movers_;
  std::vector<std::size_t> mover_of_;  // each place, if it moves
};

}  // namespace contactspline
