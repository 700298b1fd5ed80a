// SPDX-License-Identifier: MIT
// Modal bodies and masses joined by any number of contacts, springs and rigid links.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/modal.hpp"
#include "contactspline/modal/string_place.hpp"
#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/linear_algebra.hpp"
#include "contactspline/network/network_plan.hpp"
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
        solver_(plan.connections().size(), sample_rate_hz, max_steps),
        increments_(plan.places().size()) {
    for (const auto& modes : plan.bodies()) bodies_.emplace_back(modes, sample_rate_hz);
    for (const auto& place : plan.places()) {
      places_.emplace_back(place.body, place.shapes);
      if (!place.wavenumbers_per_m.empty()) add_mover(plan, place, sample_rate_hz);
    }
    for (std::size_t p = 0; p < places_.size(); ++p) bodies_[places_[p].body].places.push_back(p);
    for (Body& body : bodies_) body.reserve(body.places.size());
    for (const auto& connection : plan.connections()) connections_.emplace_back(connection);
    for (Connection& c : connections_) {
      if (c.first != kGround) c.first_body = places_[c.first].body;
      if (c.second != kGround) c.second_body = places_[c.second].body;
    }
    for (auto* list : {&awake_, &asleep_, &woken_}) list->reserve(connections_.size());
    for (auto* list : {&pushed_, &last_pushed_}) list->reserve(places_.size());
    mutual_.resize(places_.size() * places_.size());
    couple_bodies();
    couple();  // no body has a damper yet
    measure_roots();
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      install(plan.connections()[k], k);
      solver_.set_memory(k, {plan.connections()[k].memories, sample_rate_hz});
    }
    place_all();
  }

  // Bodies point to the shapes of their places. These do not move when a network is moved.
  ContactNetwork(const ContactNetwork&) = delete;
  ContactNetwork& operator=(const ContactNetwork&) = delete;
  ContactNetwork(ContactNetwork&&) noexcept = default;
  ContactNetwork& operator=(ContactNetwork&&) noexcept = default;
  ~ContactNetwork() = default;

  /// Pushes at a place during the next sample [N], -1000 to 1000. Several pushes add up. Not a number does nothing.
  void push(std::size_t place, T force_n) {
    const T force = held(T(0), force_n, Ranges::force_n);
    if (force == 0) return;
    Place& p = places_[place];
    if (!std::exchange(p.is_pushed, true)) pushed_.push_back(place);
    p.push += force;
  }

  /// Puts a mode between two samples at a displacement [m], -1000 to 1000, with a velocity [m/s], -1000 to 1000. A
  /// free mass is mode 0 of its body. Does nothing if one of them is not a number.
  void set_motion(std::size_t body, T displacement_m, T velocity_m_per_s, std::size_t mode = 0) {
    if (!is_number(displacement_m) || !is_number(velocity_m_per_s)) return;
    bodies_[body].bank.set_motion(mode, held(T(0), displacement_m, Ranges::displacement_m),
                                  held(T(0), velocity_m_per_s, Ranges::speed_m_per_s));
    place_all();
  }

  /// Stops a free mass where it is, between two samples.
  void stop(std::size_t mass) {
    Body& body = bodies_[mass];
    body.bank.set_motion(0, body.bank.displacement(std::size_t{0}), 0);
    body.is_predicted = false;
  }

  /// Extra decay of all modes of a body [1/s], 0 to 1e5.
  void set_damping(std::size_t body, T damping_per_s) {
    Body& b = bodies_[body];
    const T damping = held(b.damping, damping_per_s * time_step_, {0, Ranges::damping_per_s.max * time_step_});
    if (std::exchange(b.damping, damping) != damping) is_coupling_old_ = true;
  }

  /// Changes frequencies and decays of a body between two samples, as ModalBank::retune. Rigid links keep their
  /// stiffness. Does not allocate.
  void retune(std::size_t body, std::span<const Mode> modes) {
    bodies_[body].bank.retune(modes);
    measure(body);
    measure_roots();
    is_coupling_old_ = true;
    place_all();
  }

  /// Moves a place of NetworkPlan::add_moving_place() along its string [m], as fast as the string can follow
  /// (MovingPlace::move_to). The place takes its connections along; what that does is work().
  void move_place(std::size_t place, T place_m) {
    movers_[*places_[place].mover].target_m = place_m;
    is_following_ = true;
  }

  /// Puts such a place elsewhere between two samples [m], without moving there. Its connections are pressed as they
  /// are there.
  void put_place(std::size_t place, T place_m) {
    Mover& mover = movers_[*places_[place].mover];
    mover.motion.put(place_m);
    mover.target_m = mover.motion.place();
    follow(mover);
    place_all();
  }
  /// Shapes of the modes at a place, after the last sample.
  [[nodiscard]] const ModeShapes<T>& shapes(std::size_t place) const {
    const Place& p = places_[place];
    return p.mover ? movers_[*p.mover].motion.after() : p.shapes;
  }

  /// Stiffness ratio and loss of a contact. A stiffness that rises under load does at most 1 W of work.
  void set_contact(std::size_t connection, const ContactControls<T>& controls) {
    Connection& c = connections_[connection];
    c.contact = held(c.contact, controls);
    follow(c);
  }
  void set_contact(ConnectionRange range, const ContactControls<T>& controls) {
    for (std::size_t k = 0; k < range.count; ++k) set_contact(range.first + k, controls);
  }

  /// Stiffness [N/m], 0 to 1e9, and resistance [N s/m], 0 to 1e6, of a spring. A stiffness that rises under load does
  /// at most 1 W of work.
  void set_spring(std::size_t connection, T spring_n_per_m, T resistance_n_s_per_m) {
    Connection& c = connections_[connection];
    c.spring = held(c.spring, spring_n_per_m, Ranges::hand_stiffness_n_per_m);
    c.resistance = held(c.resistance, resistance_n_s_per_m, Ranges::resistance_n_s_per_m);
    follow(c);
  }

  /// Gap of a connection [m], -0.1 to 0.1, which follows at 1 m/s.
  void set_gap(std::size_t connection, T gap_m) {
    Connection& c = connections_[connection];
    c.target_gap = held(c.target_gap, gap_m, Ranges::gap_m);
    follow(c);
  }

  /// Brings all bodies to rest. Controls stay, and places are where they want them. Does not allocate.
  void reset() {
    for (Mover& mover : movers_) {
      mover.motion.put(mover.target_m);
      follow(mover);
    }
    for (Body& body : bodies_) body.bank.reset();
    for (std::size_t k = 0; k < connections_.size(); ++k) solver_[k].memory.reset();
    for (const std::size_t p : pushed_) places_[p].push = 0, places_[p].is_pushed = false;
    pushed_.clear();
    last_pushed_.clear();
    since_interval_ = 0;
    anchor_ = 0;
    place_all();
  }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick() {
    work_of_controls_ = 0;
    follow_controls();
    if (since_interval_ == 0) anchor_next();
    move_places();
    if (std::exchange(is_coupling_old_, false)) couple();
    predict();
    solve();
    put_to_sleep();
    advance();
  }

  [[nodiscard]] const ModalBank<T>& body(std::size_t body) const { return bodies_[body].bank; }
  [[nodiscard]] T displacement(std::size_t place) const {  ///< of a place [m]
    return bodies_[places_[place].body].bank.displacement(shapes(place));
  }
  [[nodiscard]] T velocity(std::size_t place) const {  ///< of a place [m/s]
    return bodies_[places_[place].body].bank.velocity(shapes(place));
  }
  /// Force of a connection over the last sample [N], positive if it pushes its places apart.
  [[nodiscard]] T force(std::size_t connection) const { return solver_[connection].force; }
  [[nodiscard]] T force(ConnectionRange range) const {
    T sum = 0;
    for (std::size_t k = 0; k < range.count; ++k) sum += force(range.first + k);
    return sum;
  }
  [[nodiscard]] T compression(std::size_t connection) const {  ///< [m], negative while apart
    return connections_[connection].is_awake ? solver_[connection].compression : measured(connection);
  }
  [[nodiscard]] T gap(std::size_t connection) const { return connections_[connection].gap; }  ///< that acts [m]
  /// Are gaps, stiffnesses or places still behind their controls?
  [[nodiscard]] bool is_following() const { return is_following_; }
  /// Number of contacts that are too far apart to be looked at.
  [[nodiscard]] std::size_t sleeping() const {
    return static_cast<std::size_t>(std::ranges::count(connections_, false, &Connection::is_awake));
  }
  [[nodiscard]] const CoupledContacts<T>& solver() const { return solver_; }
  /// Motion of a connection over a sample per newton, without damping and wherever its places may be [m/N].
  [[nodiscard]] double largest_admittance(std::size_t connection) const {
    return connections_[connection].own_admittance;
  }

  /// Energy of all bodies and connections [J]. In each sample it changes by work() - dissipated(), up to rounding.
  [[nodiscard]] double energy() const {
    double energy = 0;
    for (const Body& body : bodies_) energy += body.bank.energy();
    for (std::size_t k = 0; k < connections_.size(); ++k) energy += stored(k, compression(k));
    return energy;
  }

  /// Energy that bodies, dampers and contacts dissipated in the last sample [J].
  [[nodiscard]] double dissipated() const {
    double energy = 0;
    for (const Body& body : bodies_) energy += body.bank.dissipated();
    for (const std::size_t k : solver_.active()) energy += lost(k);
    for (std::size_t k = 0; k < connections_.size(); ++k) energy += relaxed(k);
    return energy;
  }

  /// Work of pushes, moving gaps, moving places and stiffness controls in the last sample [J].
  [[nodiscard]] double work() const {
    double work = work_of_controls_;
    for (const std::size_t p : last_pushed_)
      work += double(places_[p].last_push) * double(bodies_[places_[p].body].bank.increment(places_[p].shapes));
    for (const std::size_t k : solver_.active()) work += double(solver_[k].force) * double(connections_[k].lift);
    return work;
  }

 private:
  using Ranges = ControlRanges<T>;
  static constexpr T kGapSpeed_m_per_s = 1;
  // A contact falls asleep if this many samples like the last one would not close it, and wakes before this many
  // might.
  static constexpr T kSleepingSamples = 16, kWakingSamples = 2;
  // Samples from one decision which contacts fall asleep to the next, and from one correction of a compression.
  static constexpr int kInterval = 16;
  // Stiffness of a rigid link times its admittance. Energy is balanced up to rounding of this times what it stores.
  static constexpr T kRigidity = T(1e3);

  struct Body {
    Body(std::span<const Mode> modes, double sample_rate_hz) : bank(modes, sample_rate_hz) {}

    void reserve(std::size_t n) {
      for (auto* list : {&awake, &forced}) list->reserve(n);
      for (auto* list : {&awake_shapes, &forced_shapes}) list->reserve(n);
      for (auto* list : {&forces, &free_increments}) list->resize(n);
    }

    ModalBank<T> bank;
    T damping = 0;  // times dt, as is the gain
    T damping_gain = 1;
    T max_shape = 0;              // of its connections
    double total_admittance = 0;  // of all modes, where their shapes are 1 [m/N]
    // Bounds of the motion without forces of connections [m]: in this sample, and since slacks were last reduced.
    T travel = 0, travelled = 0;
    std::vector<std::size_t> places;
    std::vector<std::size_t> connections;
    std::vector<double> shapes;       // of each connection on this body
    std::vector<double> admittances;  // of each with those up to itself, without damping [m/N]
    detail::IndexList awake;          // places whose increments are computed in each sample
    detail::ReservedList<const T*> awake_shapes;
    T free_travel = 0;               // of the next sample without forces and damper, likewise these: [m]
    std::vector<T> free_increments;  // of the awake places
    bool is_predicted = false;       // do free_travel and free_increments belong to the state?
    detail::IndexList forced;        // places where forces act in this sample
    detail::ReservedList<const T*> forced_shapes;
    std::vector<T> forces;
  };

  struct Place {
    Place(std::size_t of_body, const ModeShapes<T>& of_place) : body(of_body), shapes(of_place) {}

    void measure(const ModalBank<T>& bank) {
      travel_per_force = 0;
      for (std::size_t i = 0; i < shapes.size(); ++i) travel_per_force += std::abs(bank.admittance(i) * shapes[i]);
    }
    // Largest |shape|, also where the place may move to.
    [[nodiscard]] T max_shape() const {
      T max = mover ? T(1) : T(0);
      for (std::size_t i = 0; i < shapes.size(); ++i) max = std::max(max, std::abs(shapes[i]));
      return max;
    }

    std::size_t body;
    ModeShapes<T> shapes;              // in this sample, where the place moves
    std::optional<std::size_t> mover;  // of a place that moves
    T travel_per_force = 0;
    T push = 0, last_push = 0;  // from outside [N]
    T force = 0;                // of this sample [N]
    bool is_awake = false, is_pushed = false, is_forced = false;
  };

  // A place that moves.
  struct Mover {
    std::size_t place;
    MovingPlace<T> motion;
    T target_m;
    T owed = 0;  // of the string's displacement there, so much presses the connections in the next sample only [m]
    bool is_moving = false;
  };

  struct Connection {
    explicit Connection(const typename NetworkPlan<T>::Connection& plan)
        : first(plan.first),
          second(plan.second),
          weight(plan.weight),
          contact(held(ContactControls<T>{}, plan.contact)),
          spring(plan.spring_n_per_m),
          resistance(plan.resistance_n_s_per_m),
          gap(plan.gap_m),
          target_gap(plan.gap_m) {}

    std::size_t first, second;
    std::size_t first_body = 0, second_body = 0;
    T first_max = 0, second_max = 0;  // |shape| on these bodies; if they are one, the first holds that of both
    T weight;
    ContactControls<T> contact;  // targets, which the connection of the solver follows
    T spring, resistance;
    T gap, target_gap;
    T lift = 0;                 // by how much the gap shrinks in this sample [m]
    double own_admittance = 0;  // without damping, which can only make it smaller [m/N]
    T root_admittance = 0;      // of that [sqrt(m/N)]
    T slack = 0;                // of a sleeping contact: the gap that is certainly left [m]
    T before = 0;               // compression at the beginning of the sample [m]
    bool is_awake = true;
    bool is_following = false;
  };

  void add_mover(const NetworkPlan<T>& plan, const typename NetworkPlan<T>::Place& place, double sample_rate_hz) {
    const StringShapes<T> shapes{std::span<const double>(place.wavenumbers_per_m)};
    const T longest_step = shapes.longest_step(plan.bodies()[place.body], sample_rate_hz);
    places_.back().mover = movers_.size();
    movers_.push_back({places_.size() - 1, MovingPlace<T>(shapes, place.place_m, longest_step), place.place_m});
  }

  // Gives a place that moves its shapes in this sample: the mean of those before and after.
  void follow(const Mover& mover) {
    places_[mover.place].shapes = mover.motion.mean();
    measure(places_[mover.place].body, mover.place);
    bodies_[places_[mover.place].body].is_predicted = false;
    is_coupling_old_ = true;
  }

  // Moves places along their strings. Forces act there with the mean of the shapes before and after the sample. The
  // change of the shapes, times the displacements in the middle of the sample, presses the connections like a gap
  // that shrinks. The middle is extrapolated from the last sample, and what that lacked follows in the next one: so
  // the admittances stay symmetric, and the energy balance exact (docs/how-it-works/several-contacts.md).
  void move_places() {
    for (Mover& mover : movers_) {
      mover.is_moving = mover.motion.move_to(mover.target_m);
      if (!mover.is_moving) continue;
      const std::size_t p = mover.place;
      const T half_change = half_increment(mover);
      const T lift = bodies_[places_[p].body].bank.displacement(mover.motion.change()) + half_change +
                     std::exchange(mover.owed, -half_change);
      for (const std::size_t k : bodies_[places_[p].body].connections) {
        Connection& c = connections_[k];
        if (c.first != p && c.second != p) continue;
        c.lift += c.first == p ? lift : -lift;
        if (!c.is_awake) c.slack -= kMargin * std::abs(lift), min_slack_ = std::min(min_slack_, c.slack);
      }
      follow(mover);
      is_following_ = true;  // the lifts end with the sample
    }
  }

  // Half of the last sample's increments, times the change of the shapes.
  [[nodiscard]] T half_increment(const Mover& mover) const {
    return bodies_[places_[mover.place].body].bank.increment(mover.motion.change()) / 2;
  }

  // The connections of each body.
  void couple_bodies() {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      Body& body = bodies_[b];
      for (std::size_t k = 0; k < connections_.size(); ++k)
        if (is_on(connections_[k].first, b) || is_on(connections_[k].second, b)) body.connections.push_back(k);
      body.shapes.resize(body.connections.size() * body.bank.size());
      body.admittances.resize(body.connections.size() * (body.connections.size() + 1) / 2);
      measure(b);
    }
    admittances_.resize(connections_.size() * connections_.size());
  }

  // What a body adds to the admittances of its connections and places, without damping. moved: only what concerns
  // this place; otherwise all of it.
  void measure(std::size_t b, std::optional<std::size_t> moved = {}) {
    Body& body = bodies_[b];
    const std::size_t modes = body.bank.size(), count = body.connections.size();
    const auto concerns = [&](std::size_t i) {
      const Connection& c = connections_[body.connections[i]];
      return !moved || c.first == *moved || c.second == *moved;
    };
    for (std::size_t i = 0; i < count; ++i)
      if (concerns(i)) write_shapes(connections_[body.connections[i]], b, body.shapes.data() + i * modes);
    double* admittance = body.admittances.data();
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j <= i; ++j, ++admittance) {
        if (!concerns(i) && !concerns(j)) continue;
        const double *first = body.shapes.data() + i * modes, *second = body.shapes.data() + j * modes;
        *admittance = 0;
        for (std::size_t n = 0; n < modes; ++n) *admittance += double(body.bank.admittance(n)) * first[n] * second[n];
      }
    for (const std::size_t p : body.places) {
      if (!moved || p == *moved) places_[p].measure(body.bank);
      for (const std::size_t q : body.places)
        if (!moved || p == *moved || q == *moved)
          mutual_[p * places_.size() + q] = body.bank.admittance(places_[p].shapes, places_[q].shapes);
    }
    if (!moved) measure_bounds(b);
  }

  // By how much the modes of a body move its connections at most, wherever their places are.
  void measure_bounds(std::size_t b) {
    Body& body = bodies_[b];
    body.max_shape = 0;
    body.total_admittance = 0;
    for (std::size_t n = 0; n < body.bank.size(); ++n) body.total_admittance += double(body.bank.admittance(n));
    for (std::size_t i = 0; i < body.connections.size(); ++i) {
      Connection& c = connections_[body.connections[i]];
      T& max = is_on(c.first, b) ? c.first_max : c.second_max;
      max = moves_on(c, b) ? max_shape(c.first, b) + max_shape(c.second, b) : T(0);
      const double* shapes = body.shapes.data() + i * body.bank.size();
      for (std::size_t n = 0; n < body.bank.size(); ++n) max = std::max(max, static_cast<T>(std::abs(shapes[n])));
      body.max_shape = std::max(body.max_shape, max);
    }
  }

  [[nodiscard]] bool moves_on(const Connection& c, std::size_t body) const {
    return (is_on(c.first, body) && places_[c.first].mover) || (is_on(c.second, body) && places_[c.second].mover);
  }
  [[nodiscard]] T max_shape(std::size_t place, std::size_t body) const {
    return is_on(place, body) ? places_[place].max_shape() : T(0);
  }

  // Roots of the admittances of the connections without damping, the largest ones where a place moves.
  void measure_roots() {
    for (Connection& c : connections_) c.own_admittance = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Body& body = bodies_[b];
      std::size_t own = 0;  // on the diagonal of its triangle
      for (std::size_t k = 0; k < body.connections.size(); ++k) {
        Connection& c = connections_[body.connections[k]];
        const double max = double(is_on(c.first, b) ? c.first_max : c.second_max);
        c.own_admittance += moves_on(c, b) ? body.total_admittance * max * max : body.admittances[own];
        own += k + 2;
      }
    }
    max_root_admittance_ = 0;
    for (Connection& c : connections_) {
      c.root_admittance = std::sqrt(static_cast<T>(std::max(c.own_admittance, kMinAdmittance)));
      max_root_admittance_ = std::max(max_root_admittance_, c.root_admittance);
    }
  }

  [[nodiscard]] bool is_on(std::size_t place, std::size_t body) const {
    return place != kGround && places_[place].body == body;
  }

  // Shapes of a connection on a body: those of its first place minus those of its second. The admittance of two
  // places that move almost together needs the difference before the sum over the modes, or it loses its digits.
  void write_shapes(const Connection& c, std::size_t body, double* shapes) const {
    for (std::size_t i = 0; i < bodies_[body].bank.size(); ++i) {
      shapes[i] = is_on(c.first, body) ? double(places_[c.first].shapes[i]) : 0;
      if (is_on(c.second, body)) shapes[i] -= double(places_[c.second].shapes[i]);
    }
  }

  // Admittances of all pairs of connections.
  void couple() {
    const std::size_t n = connections_.size();
    std::ranges::fill(admittances_, 0.0);
    for (Body& body : bodies_) {
      body.damping_gain = 1 / (1 + body.damping);
      const double* admittance = body.admittances.data();
      for (const std::size_t k : body.connections)
        for (const std::size_t l : body.connections) {
          if (l > k) break;
          admittances_[k * n + l] += double(body.damping_gain) * *admittance++;
        }
    }
    for (std::size_t k = 0; k < n; ++k) {
      double& own = admittances_[k * n + k];
      own = std::max(own, kMinAdmittance);
      for (std::size_t l = 0; l <= k; ++l) solver_.set_admittance(k, l, admittances_[k * n + l]);
    }
  }

  // Admittance between two places of one body.
  [[nodiscard]] T mutual(std::size_t p, std::size_t q) const {
    return bodies_[places_[p].body].damping_gain * mutual_[p * places_.size() + q];
  }

  void install(const typename NetworkPlan<T>::Connection& plan, std::size_t k) {
    CoupledConnection<T>& c = solver_[k];
    Connection& connection = connections_[k];
    c.table = plan.table;
    if (plan.is_rigid) {
      connection.spring = kRigidity / solver_.admittance(k, k);
      connection.resistance = connection.spring / 2 * time_step_;  // of which its length returns within a sample
    }
    c.contact = {connection.contact.stiffness_ratio * connection.weight, connection.contact.loss_s_per_m};
    c.spring_n_per_m = connection.spring;
    c.resistance = connection.resistance / time_step_;
  }

  // Takes all compressions from the displacements, and wakes all contacts.
  void place_all() {
    for (Mover& mover : movers_) mover.owed = 0;
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      set_compression(k, measured(k));
      solver_[k].force = 0;
      connections_[k].is_awake = true;
    }
    is_list_old_ = true;
    for (Body& body : bodies_) body.is_predicted = false;
  }

  [[nodiscard]] T measured(std::size_t k) const {
    const Connection& c = connections_[k];
    return pressing(c.first) - pressing(c.second) - c.gap;
  }
  [[nodiscard]] T pressing(std::size_t place) const {
    if (place == kGround) return 0;
    const auto& mover = places_[place].mover;
    return displacement(place) - (mover ? movers_[*mover].owed : T(0));
  }

  void set_compression(std::size_t k, T compression) {
    CoupledConnection<T>& c = solver_[k];
    c.compression = compression;
    if (!c.table.empty()) c.segment = segment_index(c.table, compression);
  }

  void follow(Connection& c) { c.is_following = is_following_ = true; }

  void follow_controls() {
    if (!std::exchange(is_following_, false)) return;
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      Connection& c = connections_[k];
      c.lift = 0;
      if (!c.is_following) continue;
      const bool gap_follows = move_gap(c), stiffness_follows = follow_stiffness(k);
      c.is_following = gap_follows || stiffness_follows;
      if (!c.is_awake) c.slack -= kMargin * std::abs(c.lift), min_slack_ = std::min(min_slack_, c.slack);
      // A gap that moved in this sample must be seen at rest in the next one.
      is_following_ = is_following_ || c.is_following || c.lift != 0;
    }
  }

  // Is the gap still moving?
  bool move_gap(Connection& c) {
    const T before = c.gap, max_step = kGapSpeed_m_per_s * time_step_, distance = c.target_gap - c.gap;
    c.gap = std::abs(distance) < max_step ? c.target_gap : c.gap + std::copysign(max_step, distance);
    c.lift = before - c.gap;
    return c.gap != c.target_gap;
  }

  // Is the stiffness still behind its control?
  bool follow_stiffness(std::size_t k) {
    const Connection& c = connections_[k];
    CoupledConnection<T>& acting = solver_[k];
    T& stiffness = acting.table.empty() ? acting.spring_n_per_m : acting.contact.stiffness_ratio;
    const T target = acting.table.empty() ? c.spring : c.contact.stiffness_ratio * c.weight;
    acting.contact.loss_s_per_m = c.contact.loss_s_per_m;
    acting.resistance = c.resistance / time_step_;
    if (stiffness == target) return false;
    const double before = stored(k, acting.compression);
    const T energy_per_stiffness = acting.table.empty() ? acting.compression * acting.compression / 2
                                                        : acting.memory.energy(acting.table, acting.compression);
    stiffness = followed_stiffness(stiffness, target, energy_per_stiffness, time_step_);
    work_of_controls_ += stored(k, acting.compression) - before;
    return stiffness != target;
  }

  // Keeps the rounding errors of the increments from adding up: corrects one compression after the other, at a rate
  // of 1e-4 per sample.
  void anchor_next() {
    if (connections_.empty()) return;
    anchor_ = (anchor_ + 1) % connections_.size();
    if (!connections_[anchor_].is_awake) return;
    CoupledConnection<T>& c = solver_[anchor_];
    const T part = std::min(T(1e-4) * static_cast<T>(connections_.size() * kInterval), T(1));
    // Not the gap of this sample, but the one before it moved.
    const T error = measured(anchor_) - connections_[anchor_].lift - c.compression;
    c.compression += part * error;
    if (!c.table.empty()) c.segment = detail::relocate_segment(c.table, c.segment, c.compression);
  }

  // Increments without forces of connections.
  void predict() {
    if (is_list_old_) list_awake();
    for (Body& body : bodies_) {
      if (!std::exchange(body.is_predicted, true))
        body.free_travel = body.bank.free_increments(body.awake_shapes, body.free_increments.data());
      body.travel = body.damping_gain * body.free_travel;
      for (std::size_t i = 0; i < body.awake.size(); ++i)
        increments_[body.awake[i]] = body.damping_gain * body.free_increments[i];
    }
    std::swap(pushed_, last_pushed_);
    pushed_.clear();
    for (const std::size_t p : last_pushed_) {
      Place& place = places_[p];
      place.is_pushed = false;
      place.last_push = std::exchange(place.push, T(0));
      add_force(p, place.last_push);
      Body& body = bodies_[place.body];
      body.travel += body.damping_gain * place.travel_per_force * std::abs(place.last_push);
      for (const std::size_t q : body.awake) increments_[q] += mutual(p, q) * place.last_push;
    }
    for (Body& body : bodies_) body.travelled += body.travel;
  }

  void add_force(std::size_t p, T force) {
    Place& place = places_[p];
    if (!std::exchange(place.is_forced, true)) {
      place.force = 0;
      bodies_[place.body].forced.push_back(p);
    }
    place.force += force;
  }

  // The connections that are awake, and their places.
  void list_awake() {
    is_list_old_ = false;
    for (auto* list : {&awake_, &asleep_}) list->clear();
    for (Place& place : places_) place.is_awake = false;
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      const Connection& c = connections_[k];
      (c.is_awake ? awake_ : asleep_).push_back(k);
      for (const std::size_t p : {c.first, c.second})
        if (c.is_awake && p != kGround) places_[p].is_awake = true;
    }
    for (Body& body : bodies_) {
      body.is_predicted = false;
      body.awake.clear();
      body.awake_shapes.clear();
      for (const std::size_t p : body.places) {
        if (!places_[p].is_awake) continue;
        body.awake.push_back(p);
        body.awake_shapes.push_back(places_[p].shapes.data());
      }
    }
  }

  void solve() {
    solver_.begin();
    for (const std::size_t k : awake_)
      begin(k, increment_at(connections_[k].first) - increment_at(connections_[k].second));
    do solver_.solve();
    while (wake_reachable());
  }

  [[nodiscard]] T increment_at(std::size_t place) const { return place == kGround ? T(0) : increments_[place]; }
  // The same for a place that is not awake.
  [[nodiscard]] T measured_increment(std::size_t p) const {
    if (p == kGround) return 0;
    const Body& body = bodies_[places_[p].body];
    const T* shapes = places_[p].shapes.data();
    T increment;
    body.bank.free_increments({&shapes, 1}, &increment);
    increment *= body.damping_gain;
    for (const std::size_t q : last_pushed_)
      if (&bodies_[places_[q].body] == &body) increment += mutual(p, q) * places_[q].last_push;
    return increment;
  }

  void begin(std::size_t k, T free_increment) {
    Connection& c = connections_[k];
    solver_[k].free_increment = free_increment + c.lift;
    c.before = solver_[k].compression;
    solver_.add(k);
  }

  // Bound of the motion of a connection by the travel of its bodies and the reach of forces [m].
  [[nodiscard]] T motion(const Connection& c, T Body::*travel, T reach) const {
    return kMargin * (c.first_max * bodies_[c.first_body].*travel + c.second_max * bodies_[c.second_body].*travel +
                      c.root_admittance * reach);
  }

  // Might a sleeping contact have used up its slack, with this reach since slacks were last reduced and so many more
  // samples like this one? A bound for all of them together.
  [[nodiscard]] bool may_touch(T reach, T more_samples) const {
    T motion = max_root_admittance_ * reach;
    for (const Body& body : bodies_) motion += body.max_shape * (body.travelled + more_samples * body.travel);
    return kMargin * motion >= min_slack_;
  }

  // Wakes the sleeping contacts that may have come within reach, by the bound of what moved since they fell asleep.
  // Must solve() run again?
  bool wake_reachable() {
    reach_ = 0;
    for (const std::size_t k : solver_.active())
      reach_ += connections_[k].root_admittance * std::abs(solver_[k].force);
    bool has_woken = false;
    if (!may_touch(reached_ + reach_, 0)) return false;
    for (const std::size_t k : asleep_) {
      Connection& c = connections_[k];
      if (c.is_awake || c.slack > motion(c, &Body::travelled, reached_ + reach_)) continue;
      c.is_awake = is_list_old_ = has_woken = true;
      set_compression(k, measured(k) - c.lift);
      begin(k, measured_increment(c.first) - measured_increment(c.second));
    }
    return has_woken;
  }

  // Moves the compressions, lets contacts fall asleep that cannot touch soon, and wakes those that may.
  void put_to_sleep() {
    solver_.advance();
    reached_ += reach_;
    const bool is_time = ++since_interval_ == kInterval;
    if (is_time || may_touch(reached_ + kWakingSamples * reach_, kWakingSamples)) reduce_slacks();
    if (is_time) {
      since_interval_ = 0;
      for (const std::size_t k : awake_) {
        Connection& c = connections_[k];
        const T y = solver_[k].compression;
        if (y > 0 || solver_[k].force != 0 || solver_[k].table.empty()) continue;
        if (-y <= kSleepingSamples * motion(c, &Body::travel, reach_)) continue;
        c.is_awake = false;
        c.slack = -y;
        min_slack_ = std::min(min_slack_, c.slack);
        is_list_old_ = true;
      }
    }
    if (is_list_old_) list_awake();
  }

  // Takes from the slacks what moved since this was last done. Wakes contacts that may soon touch.
  void reduce_slacks() {
    min_slack_ = std::numeric_limits<T>::max();
    for (const std::size_t k : asleep_) {
      Connection& c = connections_[k];
      if (c.is_awake) continue;
      c.slack -= motion(c, &Body::travelled, reached_);
      if (c.slack > kWakingSamples * motion(c, &Body::travel, reach_)) {
        min_slack_ = std::min(min_slack_, c.slack);
      } else {
        c.is_awake = is_list_old_ = true;
        woken_.push_back(k);
      }
    }
    for (Body& body : bodies_) body.travelled = 0;
    reached_ = 0;
  }

  // Moves the bodies, and predicts the next sample.
  void advance() {
    for (const std::size_t k : solver_.active()) {
      const T force = solver_[k].force;
      if (force == 0) continue;
      if (connections_[k].first != kGround) add_force(connections_[k].first, -force);
      if (connections_[k].second != kGround) add_force(connections_[k].second, force);
    }
    for (Body& body : bodies_) {
      body.forced_shapes.clear();
      for (const std::size_t p : body.forced) {
        places_[p].is_forced = false;
        body.forces[body.forced_shapes.size()] = places_[p].force;
        body.forced_shapes.push_back(places_[p].shapes.data());
      }
      body.forced.clear();
      body.free_travel = body.bank.advance(body.damping, body.forced_shapes, body.forces.data(), body.awake_shapes,
                                           body.free_increments.data());
      body.is_predicted = true;
    }
    for (Mover& mover : movers_)
      if (mover.is_moving) mover.owed += half_increment(mover);
    for (const std::size_t k : woken_) set_compression(k, measured(k));
    woken_.clear();
  }

  [[nodiscard]] double stored(std::size_t k, T compression) const {
    const CoupledConnection<T>& c = solver_[k];
    const double y = double(compression);
    if (c.table.empty()) return double(c.spring_n_per_m) / 2 * y * y;
    return double(c.contact.stiffness_ratio) * double(c.memory.energy(c.table, compression));
  }

  // Energy that connection k dissipated over the last sample [J].
  [[nodiscard]] double lost(std::size_t k) const {
    const CoupledConnection<T>& c = solver_[k];
    const T y0 = connections_[k].before;
    const double x = double(c.compression) - double(y0);
    if (c.table.empty()) return double(c.resistance) * x * x;
    if (!(c.contact.loss_s_per_m > 0)) return 0;
    if (!(c.force > 0))  // all that it held beyond
      return double(c.contact.stiffness_ratio) *
             (double(c.memory.energy_before(c.table, y0)) - double(c.memory.energy_before(c.table, c.compression)));
    return double(c.contact.loss_s_per_m) * double(c.contact.stiffness_ratio) / double(time_step_) *
           double(c.memory.force_before(c.table, y0)) * x * x;
  }

  // Energy that the memory of connection k dissipated when it relaxed last [J].
  [[nodiscard]] double relaxed(std::size_t k) const {
    const CoupledConnection<T>& c = solver_[k];
    if (c.memory.empty()) return 0;
    return double(c.contact.stiffness_ratio) *
           (double(c.memory.energy_before(c.table, c.compression)) - double(c.memory.energy(c.table, c.compression)));
  }

  // [m/N]. Where nothing moves the admittance is 0; a contact needs one > 0.
  static constexpr double kMinAdmittance = 1e-18;
  // Covers the rounding of the bounds.
  static constexpr T kMargin = T(1.001);

  T time_step_;
  CoupledContacts<T> solver_;
  std::vector<Body> bodies_;
  std::vector<Place> places_;
  std::vector<Connection> connections_;
  std::vector<Mover> movers_;
  detail::IndexList awake_, asleep_;        // connections
  detail::IndexList woken_;                 // whose compressions are measured at the end of the sample
  detail::IndexList pushed_, last_pushed_;  // places
  std::vector<double> admittances_;         // of each connection with those up to itself [m/N]
  std::vector<T> mutual_;                   // admittances of all pairs of places, without damping [m/N]
  std::vector<T> increments_;               // of the places that are awake, without connections [m]
  // Sum of force times root of admittance: over the last sample, and since slacks were last reduced.
  T reach_ = 0, reached_ = 0;
  T max_root_admittance_ = 0;
  T min_slack_ = std::numeric_limits<T>::max();  // of the sleeping contacts
  double work_of_controls_ = 0;
  std::size_t anchor_ = 0;
  int since_interval_ = 0;
  bool is_list_old_ = true, is_following_ = false, is_coupling_old_ = false;
};

}  // namespace contactspline
