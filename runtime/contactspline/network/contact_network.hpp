// SPDX-License-Identifier: MIT
// Modal bodies and masses joined by any number of contacts, springs and rigid links.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/following_controls.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_parts.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/network/network_receptances.hpp"
#include "contactspline/network/sleeping_contacts.hpp"
#include "contactspline/network/two_steps.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// A network of bodies, played sample by sample. All forces of a sample are computed together, so the energy balance
/// is exact up to rounding for any number of contacts (docs/how-it-works/several-contacts.md). No allocation after
/// construction. Controls may be set before any sample; their ranges are those of ControlRanges
/// (docs/reference/controls.md).
template <std::floating_point T>
class ContactNetwork {
 public:
  /// max_steps: of the solver in a sample.
  ContactNetwork(const NetworkPlan<T>& plan, double sample_rate_hz, int max_steps = CoupledContacts<T>::kMaxSteps)
      : time_step_(T(1 / sample_rate_hz)),
        step_(T(plan.samples_of_step() / sample_rate_hz)),
        solver_(plan.connections().size() + plan.forms(), sample_rate_hz / plan.samples_of_step(), max_steps),
        parts_(plan, sample_rate_hz),
        receptances_(parts_),
        sleeping_(plan.connections().size()),
        controls_(sample_rate_hz, plan.samples_of_step()),
        increments_(plan.places().size()) {
    for (auto* list : {&pushed_, &last_pushed_}) list->reserve(parts_.places.size());
    receptances_.couple(parts_, solver_);  // no body has a damper yet
    receptances_.measure_own(parts_);
    for (std::size_t k = 0; k < plan.connections().size(); ++k) {
      install(plan.connections()[k], k);
      solver_.set_memory(k, {plan.connections()[k].memories, sample_rate_hz / plan.samples_of_step()});
    }
    if (plan.forms() > 0) two_steps_.emplace(parts_, solver_);
    place_all();
    hold_memories();
  }

  // Bodies point to the shapes of their places. These do not move when a network is moved.
  ContactNetwork(const ContactNetwork&) = delete;
  ContactNetwork& operator=(const ContactNetwork&) = delete;
  ContactNetwork(ContactNetwork&&) noexcept = default;
  ContactNetwork& operator=(ContactNetwork&&) noexcept = default;
  ~ContactNetwork() = default;

  /// Pushes at a place during the next sample [N], -1000 to 1000. Several pushes add up. Not a number does nothing.
  void push(std::size_t place, T force_n) { hold(place, held(T(0), force_n, Ranges::force_n)); }

  /// The same for any finite force: one that holds a body at rest.
  void hold(std::size_t place, T force_n) {
    if (force_n == 0) return;
    Place& p = parts_.places[place];
    if (!std::exchange(p.is_pushed, true)) pushed_.push_back(place);
    p.push += force_n;
  }

  /// Puts a mode between two samples at a displacement [m], -1000 to 1000, with a velocity [m/s], -1000 to 1000. A
  /// free mass is mode 0 of its body. Does nothing if one of them is not a number.
  void set_motion(std::size_t body, T displacement_m, T velocity_m_per_s, std::size_t mode = 0) {
    if (!is_number(displacement_m) || !is_number(velocity_m_per_s)) return;
    parts_.bodies[body].bank.set_motion(mode, held(T(0), displacement_m, Ranges::displacement_m),
                                        held(T(0), velocity_m_per_s, Ranges::speed_m_per_s));
    parts_.bodies[body].take_motion();
    jump();
  }

  /// Stops a free mass where it is, between two samples.
  void stop(std::size_t mass) {
    Body& body = parts_.bodies[mass];
    body.bank.set_motion(0, body.bank.displacement(std::size_t{0}), 0);
    body.take_motion();
    if (two_steps_) two_steps_->place(parts_);
    body.is_predicted = false;
  }

  /// Extra decay of all modes of a body [1/s], 0 to 1e5.
  void set_damping(std::size_t body, T damping_per_s) {
    Body& b = parts_.bodies[body];
    const T damping = held(b.damping, damping_per_s * time_step_, {0, Ranges::damping_per_s.max * time_step_});
    if (std::exchange(b.damping, damping) != damping) is_coupling_old_ = true;
  }

  /// Changes frequencies and decays of a body between two samples, as ModalBank::retune. Rigid links keep their
  /// stiffness. Does not allocate.
  void retune(std::size_t body, std::span<const Mode> modes) {
    const bool moves = parts_.bodies[body].bank.moves();
    parts_.bodies[body].retune(modes);
    // At rest all is as in a new network.
    moves ? receptances_.measure_frequencies(parts_, body) : receptances_.measure(parts_, body);
    receptances_.measure_own(parts_);
    is_coupling_old_ = true;
    place_all();
  }

  /// Moves a place of NetworkPlan::add_moving_place() along its string [m], as fast as the string can follow
  /// (MovingPlace::move_to). The place takes its connections along; what that does is work(). Under nothing but
  /// friction that is lifted it waits, and is put there once that is pressed.
  void move_place(std::size_t place, T place_m) {
    parts_.movers[*parts_.places[place].mover].target_m = place_m;
    controls_.note_moving_place();
  }

  /// Puts such a place elsewhere between two samples [m], without moving there. Its connections are pressed as they
  /// are there.
  void put_place(std::size_t place, T place_m) {
    Mover& mover = parts_.movers[*parts_.places[place].mover];
    mover.motion.put(place_m);
    mover.target_m = mover.motion.place();
    follow(mover);
    receptances_.measure_moved(parts_);
    jump();
  }
  /// Where such a place is, after the last sample [m].
  [[nodiscard]] T place_m(std::size_t place) const {
    return parts_.movers[*parts_.places[place].mover].motion.place();
  }
  /// Shapes of the modes at a place, after the last sample.
  [[nodiscard]] const ModeShapes<T>& shapes(std::size_t place) const { return parts_.shapes(place); }

  /// Stiffness ratio and loss of a contact. A stiffness that rises under load does at most 1 W of work.
  void set_contact(std::size_t connection, const ContactControls<T>& controls) {
    Connection& c = parts_.connections[connection];
    c.contact = held(c.contact, controls);
    controls_.follow(c);
  }
  void set_contact(ConnectionRange range, const ContactControls<T>& controls) {
    for (std::size_t k = 0; k < range.count; ++k) set_contact(range.first + k, controls);
  }

  /// Stiffness [N/m], 0 to 1e9, and resistance [N s/m], 0 to 1e6, of a spring. A stiffness that rises under load does
  /// at most 1 W of work.
  void set_spring(std::size_t connection, T spring_n_per_m, T resistance_n_s_per_m) {
    Connection& c = parts_.connections[connection];
    c.spring = held(c.spring, spring_n_per_m, Ranges::hand_stiffness_n_per_m);
    c.resistance = held(c.resistance, resistance_n_s_per_m, Ranges::resistance_n_s_per_m);
    controls_.follow(c);
    if (c.is_awake || (c.spring == 0 && c.resistance == 0)) return;
    set_compression(connection, parts_.measured(connection));
    sleeping_.wake(c);
  }

  /// Normal force of friction [N], 0 to 1000. It may jump.
  void set_normal_force(std::size_t connection, T force_n) {
    Connection& c = parts_.connections[connection];
    c.normal_force = held(c.normal_force, force_n, Ranges::normal_force_n);
  }

  /// Speed at which the surface of friction moves by itself beside its first place, as a bow does, or that of a rough
  /// contact slides along it [m/s], -1000 to 1000. It may jump; what it does is work().
  void set_surface_speed(std::size_t connection, T speed_m_per_s) {
    Connection& c = parts_.connections[connection];
    const T longest = Ranges::speed_m_per_s.max * time_step_;
    T& carried = solver_[connection].is_friction ? c.carried : c.slide;
    carried = held(carried, speed_m_per_s * time_step_, {-longest, longest});
    if (!solver_[connection].is_friction) controls_.follow(c);
  }

  /// Gap of a contact, spring or link [m], -0.1 to 0.1, which follows at 1 m/s.
  void set_gap(std::size_t connection, T gap_m) {
    Connection& c = parts_.connections[connection];
    c.target_gap = held(c.target_gap, gap_m, Ranges::gap_m);
    controls_.follow(c);
  }

  /// Brings all bodies to rest. Controls stay, and places are where they want them. Does not allocate.
  void reset() {
    for (Mover& mover : parts_.movers) {
      mover.motion.put(mover.target_m);
      follow(mover);
    }
    receptances_.measure_moved(parts_);
    for (Body& body : parts_.bodies) {
      body.bank.reset();
      body.take_motion();
    }
    for (std::size_t k = 0; k < parts_.connections.size(); ++k) {
      solver_[k].friction.reset();
      parts_.connections[k].temperature.reset();
      Connection& c = parts_.connections[k];
      if (!c.surface.is_rough()) continue;
      c.surface.reset();
      c.gap = c.target_gap;
      c.lift = c.lift_before = 0;
    }
    for (const std::size_t p : pushed_) parts_.places[p].push = 0, parts_.places[p].is_pushed = false;
    pushed_.clear();
    last_pushed_.clear();
    sleeping_.restart();
    anchor_ = 0;
    jump();
    hold_memories();
  }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick() {
    controls_.advance(parts_, solver_, two_steps_ ? two_steps_->resting() : std::span<CoupledConnection<T>>(),
                      sleeping_);
    if (sleeping_.is_interval_over()) anchor_next();
    if (two_steps_) return tick_over_two_samples();
    move_places();
    if (std::exchange(is_coupling_old_, false)) receptances_.couple(parts_, solver_);
    predict();
    solve();
    solver_.advance();
    sleeping_.end_sample(parts_, solver_);
    advance();
  }

  [[nodiscard]] const ModalBank<T>& body(std::size_t body) const { return parts_.bodies[body].bank; }
  [[nodiscard]] T displacement(std::size_t place) const {  ///< of a place [m]
    return parts_.body_of(place).bank.displacement(shapes(place));
  }
  [[nodiscard]] T velocity(std::size_t place) const {  ///< of a place [m/s]
    return parts_.body_of(place).bank.velocity(shapes(place));
  }
  /// By how much a form stretches a body now: s of StretchForm.
  [[nodiscard]] double stretch(std::size_t body, std::size_t form) const {
    return parts_.bodies[body].motion->forms().stretch(form);
  }
  /// Force of a connection over the last sample [N], positive if it pushes its places apart.
  [[nodiscard]] T force(std::size_t connection) const { return solver_[connection].force; }
  [[nodiscard]] T force(ConnectionRange range) const {
    T sum = 0;
    for (std::size_t k = 0; k < range.count; ++k) sum += force(range.first + k);
    return sum;
  }
  /// Force on a place over the last sample [N], of its connections and pushes.
  [[nodiscard]] T force_at(std::size_t place) const {
    T sum = std::ranges::find(last_pushed_, place) == last_pushed_.end() ? T(0) : parts_.places[place].last_push;
    for (const std::size_t k : parts_.body_of(place).connections) {
      if (parts_.connections[k].first == place) sum -= force(k);
      if (parts_.connections[k].second == place) sum += force(k);
    }
    return sum;
  }
  [[nodiscard]] T compression(std::size_t connection) const {  ///< [m], negative while apart
    return parts_.connections[connection].is_awake ? solver_[connection].compression : parts_.measured(connection);
  }
  /// The same at the beginning of the last sample, of a connection that acted in it [m].
  [[nodiscard]] T compression_before(std::size_t connection) const { return parts_.connections[connection].before; }
  /// Temperature of the surfaces of friction, above ambient [K].
  [[nodiscard]] T temperature(std::size_t connection) const {
    return parts_.connections[connection].temperature.temperature();
  }
  /// By how much friction slipped in the last sample [m].
  [[nodiscard]] T slip(std::size_t connection) const { return solver_[connection].friction_step.slip; }
  [[nodiscard]] T gap(std::size_t connection) const { return parts_.connections[connection].gap; }  ///< that acts [m]
  /// Are gaps, stiffnesses or places still behind their controls? Not a surface that slides on and on.
  [[nodiscard]] bool is_following() const { return controls_.is_following(); }
  /// From now on springs without stiffness and resistance cost nothing, and are not in solver().active().
  void let_springs_sleep() { sleeping_.let_springs_sleep(); }
  /// Is it a contact too far apart to be looked at, or a spring without stiffness and resistance?
  [[nodiscard]] bool is_sleeping(std::size_t connection) const { return !parts_.connections[connection].is_awake; }
  /// How many of them there are.
  [[nodiscard]] std::size_t sleeping() const {
    return static_cast<std::size_t>(std::ranges::count(parts_.connections, false, &Connection::is_awake));
  }
  [[nodiscard]] const CoupledContacts<T>& solver() const { return solver_; }
  /// Motion of a connection over a sample per newton, without damping and wherever its places may be [m/N].
  [[nodiscard]] double largest_receptance(std::size_t connection) const {
    return parts_.connections[connection].own_receptance;
  }

  /// Energy of all bodies and connections [J]. In each sample it changes by work() - dissipated(), up to rounding.
  [[nodiscard]] double energy() const {
    double energy = 0;
    for (const Body& body : parts_.bodies) energy += body.energy();
    for (std::size_t k = 0; k < parts_.connections.size(); ++k)
      energy += solver_[k].energy_at(compression(k)) / parts_.samples_of_step;
    if (two_steps_) energy += two_steps_->energy() / parts_.samples_of_step;
    return energy;
  }

  /// What it counts of one body [J].
  [[nodiscard]] double energy(std::size_t body) const { return parts_.bodies[body].energy(); }

  /// The kinetic part of it [J]: 0 at rest, also where connections press or pull.
  [[nodiscard]] double kinetic_energy() const {
    double energy = 0;
    for (const Body& body : parts_.bodies) energy += body.kinetic_energy();
    return energy;
  }

  /// Energy that bodies, dampers and contacts dissipated in the last sample [J].
  [[nodiscard]] double dissipated() const {
    double energy = 0;
    for (const Body& body : parts_.bodies) energy += body.dissipated();
    for (const std::size_t k : solver_.active())
      if (is_connection(k))
        energy += solver_[k].dissipated_since(parts_.connections[k].before, step_) / parts_.samples_of_step;
    for (std::size_t k = 0; k < parts_.connections.size(); ++k)
      energy += solver_[k].dissipated_by_memory() / parts_.samples_of_step;
    return energy;
  }

  /// Work of pushes, moving gaps, places and surfaces, and stiffness controls in the last sample [J].
  [[nodiscard]] double work() const {
    double work = controls_.work();
    for (const std::size_t p : last_pushed_)
      work += double(parts_.places[p].last_push) * double(parts_.body_of(p).increment(parts_.places[p].shapes)) /
              parts_.samples_of_step;
    for (const std::size_t k : solver_.active())
      if (is_connection(k))
        work += double(solver_[k].force) *
                (double(parts_.connections[k].lift_of_step()) + double(parts_.connections[k].carried)) /
                parts_.samples_of_step;
    return work;
  }

 private:
  using Ranges = ControlRanges<T>;
  using Body = detail::NetworkBody<T>;
  using Place = detail::NetworkPlace<T>;
  using Mover = detail::NetworkMover<T>;
  using Connection = detail::NetworkConnection<T>;
  // Stiffness of a rigid link times its receptance. Energy is balanced up to rounding of this times what it stores.
  static constexpr T kRigidity = T(1e3);

  // Is it a form, of which the solver alone knows, or not?
  [[nodiscard]] bool is_connection(std::size_t k) const { return k < parts_.connections.size(); }

  // Gives a place that moves its shapes in this sample: the mean of those before and after.
  void follow(Mover& mover) {
    parts_.places[mover.place].shapes = mover.motion.mean();
    parts_.body_of(mover.place).is_predicted = false;
    mover.is_new = is_coupling_old_ = true;
  }

  // Does a place move under nothing but friction that is lifted? Then it is put elsewhere once that is pressed.
  [[nodiscard]] bool is_lifted(const Mover& mover) const {
    if (!mover.is_moving && mover.motion.place() == mover.target_m) return false;
    if (parts_.places[mover.place].is_pushed) return false;
    bool is_rubbed = false;
    for (const std::size_t k : parts_.body_of(mover.place).connections) {
      const Connection& c = parts_.connections[k];
      if (c.first != mover.place && c.second != mover.place) continue;
      if (!solver_[k].is_friction || normal_force(c) > 0 || solver_[k].friction.normal_force() > 0) return false;
      is_rubbed = true;
    }
    return is_rubbed;
  }

  // Moves places along their strings. Forces act there with the mean of the shapes before and after the sample. The
  // change of the shapes, times the displacements in the middle of the sample, presses the connections like a gap
  // that shrinks. Friction meets other parts of the string there, and its bristles keep their strain. The middle is
  // extrapolated from the last sample, and what that lacked follows in the next one: so the receptances stay
  // symmetric, and the energy balance exact (docs/how-it-works/several-contacts.md).
  void move_places() {
    for (Mover& mover : parts_.movers) {
      if (is_lifted(mover)) {
        mover.waits = true;
        mover.is_moving = false;
        continue;
      }
      if (std::exchange(mover.waits, false)) {
        mover.motion.put(mover.target_m);
        follow(mover);
      }
      const T from = mover.motion.place();
      mover.is_moving = mover.motion.move_to(mover.target_m);
      if (!mover.is_moving) continue;
      const std::size_t p = mover.place;
      const T half_change = half_increment(mover);
      const T lift = parts_.body_of(p).bank.displacement(mover.motion.change()) + half_change +
                     std::exchange(mover.owed, -half_change);
      for (const std::size_t k : parts_.body_of(p).connections) {
        Connection& c = parts_.connections[k];
        if (solver_[k].is_friction || (c.first != p && c.second != p)) continue;
        c.lift += c.first == p ? lift : -lift;
        sleeping_.shrink(parts_, c, lift);
        if (!c.surface.is_rough()) continue;
        c.surface.go(c.first == p ? mover.motion.place() - from : from - mover.motion.place());
        controls_.follow(c);  // the height there acts in the next sample
      }
      follow(mover);
      controls_.note_moving_place();
    }
    if (is_coupling_old_) receptances_.measure_moved(parts_);
  }

  // Half of the last sample's increments, times the change of the shapes.
  [[nodiscard]] T half_increment(const Mover& mover) const {
    return parts_.body_of(mover.place).bank.increment(mover.motion.change()) / 2;
  }

  void install(const typename NetworkPlan<T>::Connection& plan, std::size_t k) {
    CoupledConnection<T>& c = solver_[k];
    Connection& connection = parts_.connections[k];
    c.table = plan.table;
    if (plan.is_rigid) {
      connection.spring = kRigidity / solver_.receptance(k, k);
      connection.resistance = connection.spring / 2 * step_;  // damps the link within a step
    }
    c.contact = {connection.contact.stiffness_ratio * connection.weight, connection.contact.loss_s_per_m};
    c.spring_n_per_m = connection.spring;
    c.resistance = connection.resistance / step_;
    if (!plan.friction) return;
    c.is_friction = true;
    c.friction = Friction<T>(plan.friction->bristles, 1 / double(time_step_));
    connection.temperature =
        FrictionTemperature<T>(plan.friction->heat, plan.friction_width_m, 1 / double(time_step_));
  }

  // Takes all compressions from the displacements, and wakes all contacts.
  void place_all() {
    for (Mover& mover : parts_.movers) mover.owed = 0;
    for (std::size_t k = 0; k < parts_.connections.size(); ++k) {
      set_compression(k, parts_.measured(k));
      solver_[k].force = 0;
    }
    if (two_steps_) two_steps_->place(parts_);
    sleeping_.wake_all(parts_);
    for (Body& body : parts_.bodies) body.is_predicted = false;
  }

  // The same where displacements have jumped: no contact knows how it goes on.
  void jump() {
    for (std::size_t k = 0; k < parts_.connections.size(); ++k) solver_[k].memory.set_last_increment(0);
    if (two_steps_) two_steps_->jump();
    place_all();
  }

  // Contacts that are pressed at rest have been for ever.
  void hold_memories() {
    const auto hold = [](CoupledConnection<T>& c) {
      if (!c.memory.empty()) c.memory.hold(contactspline::force(c.table, c.compression));
    };
    for (std::size_t k = 0; k < parts_.connections.size(); ++k) hold(solver_[k]);
    if (!two_steps_) return;
    for (CoupledConnection<T>& c : two_steps_->resting()) hold(c);
  }

  void set_compression(std::size_t k, T compression) {
    CoupledConnection<T>& c = solver_[k];
    c.compression = c.is_friction ? c.friction.strain() : compression;
    if (!c.table.empty()) c.segment = segment_index(c.table, compression);
  }

  // Keeps the rounding errors of the increments from adding up: corrects one compression after the other, at a rate
  // of 1e-4 per sample.
  void anchor_next() {
    if (parts_.connections.empty()) return;
    anchor_ = (anchor_ + 1) % parts_.connections.size();
    CoupledConnection<T>& c = solver_[anchor_];
    if (!parts_.connections[anchor_].is_awake || c.is_friction) return;
    const T part = (std::min)(T(1e-4) * static_cast<T>(parts_.connections.size() * sleeping_.kInterval), T(1));
    // Not the gap of this sample, but the one before it moved.
    const T error = parts_.measured(anchor_) - parts_.connections[anchor_].lift - c.compression;
    c.compression += part * error;
    if (!c.table.empty()) c.segment = detail::relocate_segment(c.table, c.segment, c.compression);
  }

  // Increments without forces of connections.
  void predict() {
    sleeping_.list_awake(parts_);
    for (Body& body : parts_.bodies) {
      if (!std::exchange(body.is_predicted, true))
        body.free_travel = body.bank.free_increments(body.awake_shapes, body.free_increments.data());
      body.reach = body.travel = body.damping_gain * body.free_travel;
      for (std::size_t i = 0; i < body.awake.size(); ++i)
        increments_[body.awake[i]] = body.damping_gain * body.free_increments[i];
    }
    std::swap(pushed_, last_pushed_);
    pushed_.clear();
    for (const std::size_t p : last_pushed_) {
      Place& place = parts_.places[p];
      add_force(p, take_push(p));
      Body& body = parts_.bodies[place.body];
      body.reach = body.travel += body.damping_gain * place.travel_per_force * std::abs(place.last_push);
      for (const std::size_t q : body.awake) increments_[q] += receptances_.mutual(parts_, p, q) * place.last_push;
    }
  }

  void add_force(std::size_t p, T force) {
    Place& place = parts_.places[p];
    if (!std::exchange(place.is_forced, true)) {
      place.force = 0;
      parts_.bodies[place.body].forced.push_back(p);
    }
    place.force += force;
  }

  void solve() {
    solver_.begin();
    for (const std::size_t k : sleeping_.awake())
      begin(k, increment_at(parts_.connections[k].first) - increment_at(parts_.connections[k].second));
    const auto wake = [&](std::size_t k) {
      const Connection& c = parts_.connections[k];
      set_compression(k, parts_.measured(k) - c.lift);
      begin(k, measured_increment(c.first) - measured_increment(c.second));
    };
    do solver_.solve();
    while (sleeping_.wake_reachable(parts_, solver_, wake));
  }

  void tick_over_two_samples() {
    if (std::exchange(is_coupling_old_, false)) receptances_.couple(parts_, solver_);
    sleeping_.list_awake(parts_);  // all are
    two_steps_->begin(parts_, solver_);
    std::swap(pushed_, last_pushed_);
    pushed_.clear();
    for (const std::size_t p : last_pushed_) two_steps_->push(parts_, p, take_push(p));
    for (const Body& body : parts_.bodies)
      for (const std::size_t p : body.awake) increments_[p] = body.increment(parts_.places[p].shapes);
    solver_.begin();
    for (const std::size_t k : sleeping_.awake())
      begin(k, increment_at(parts_.connections[k].first) - increment_at(parts_.connections[k].second));
    two_steps_->add_forms(parts_, solver_);
    solver_.solve();
    solver_.advance();
    two_steps_->advance(parts_, solver_);
    sleeping_.stay_awake();
  }

  // The push at a place in this sample.
  T take_push(std::size_t p) {
    Place& place = parts_.places[p];
    place.is_pushed = false;
    return place.last_push = std::exchange(place.push, T(0));
  }

  [[nodiscard]] T increment_at(std::size_t place) const { return place == kGround ? T(0) : increments_[place]; }
  // The same for a place that is not awake.
  [[nodiscard]] T measured_increment(std::size_t p) const {
    if (p == kGround) return 0;
    const Body& body = parts_.body_of(p);
    const T* shapes = parts_.places[p].shapes.data();
    T increment;
    body.bank.free_increments({&shapes, 1}, &increment);
    increment *= body.damping_gain;
    for (const std::size_t q : last_pushed_)
      if (&parts_.body_of(q) == &body) increment += receptances_.mutual(parts_, p, q) * parts_.places[q].last_push;
    return increment;
  }

  void begin(std::size_t k, T free_increment) {
    Connection& c = parts_.connections[k];
    solver_[k].free_increment = free_increment + c.lift_of_step() + c.carried;
    c.before = solver_[k].compression;
    if (solver_[k].is_friction) solver_[k].friction.press({normal_force(c), c.temperature.coefficient()});
    solver_.add(k);
  }

  [[nodiscard]] T normal_force(const Connection& c) const {
    return c.pressed_by == kNoConnection ? c.normal_force : c.normal_force + (std::max)(force(c.pressed_by), T(0));
  }

  void warm(std::size_t k) {
    const CoupledConnection<T>& c = solver_[k];
    parts_.connections[k].temperature.advance(c.friction.normal_force(), c.friction_step.increment,
                                              static_cast<T>(c.friction.slip_heat()));
  }

  // Moves the bodies, and predicts the next sample.
  void advance() {
    for (const std::size_t k : solver_.active()) {
      if (solver_[k].is_friction) warm(k);
      const T force = solver_[k].force;
      if (force == 0) continue;
      if (parts_.connections[k].first != kGround) add_force(parts_.connections[k].first, -force);
      if (parts_.connections[k].second != kGround) add_force(parts_.connections[k].second, force);
    }
    for (Body& body : parts_.bodies) {
      body.forced_shapes.clear();
      for (const std::size_t p : body.forced) {
        parts_.places[p].is_forced = false;
        body.forces[body.forced_shapes.size()] = parts_.places[p].force;
        body.forced_shapes.push_back(parts_.places[p].shapes.data());
      }
      body.forced.clear();
      body.free_travel = body.bank.advance(body.damping, body.forced_shapes, body.forces.data(), body.awake_shapes,
                                           body.free_increments.data());
      body.is_predicted = true;
    }
    for (Mover& mover : parts_.movers)
      if (mover.is_moving) mover.owed += half_increment(mover);
  }

  T time_step_, step_;  // of a sample, and of those on which a force acts
  CoupledContacts<T> solver_;
  detail::NetworkParts<T> parts_;
  detail::NetworkReceptances<T> receptances_;
  detail::SleepingContacts<T> sleeping_;
  detail::FollowingControls<T> controls_;
  std::optional<detail::TwoSteps<T>> two_steps_;  // where a body stretches
  detail::IndexList pushed_, last_pushed_;        // places
  std::vector<T> increments_;                     // of the places that are awake, without connections [m]
  std::size_t anchor_ = 0;
  bool is_coupling_old_ = false;
};

}  // namespace contactspline
