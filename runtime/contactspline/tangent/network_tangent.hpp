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
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/string_place.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/tangent/contact_tangent.hpp"
#include "contactspline/tangent/force_equations.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_numbers.hpp"

namespace contactspline {

/// A ContactNetwork with its derivatives with respect to P parameters. Controls stay as the plan says, rigid links
/// keep their stiffness. Once put_place() or move_place() has moved a place or its slopes, the shapes there change
/// with the place alone, not by what the directions say of them.
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
        modes_(plan, sample_rate_hz, directions),
        equations_(plan.connections().size()),
        increments_(plan.connections().size()),
        solution_(plan.connections().size()) {
    for (std::size_t q = 0; q < plan.places().size(); ++q) add_place(q, sample_rate_hz, directions);
    for (std::size_t k = 0; k < plan.connections().size(); ++k) add_connection(k, sample_rate_hz, directions);
    for (Place& place : places_)
      if (place.is_joined && !place.mover && place.shapes.is_constant)
        place.watched = modes_.watch(place.body, place.shapes.values);
    measure();
  }

  /// Puts a free mass between two samples at a displacement [m], -1000 to 1000, with a velocity [m/s], -1000 to 1000.
  /// mass: a body of NetworkPlan::add_mass(). A value beyond its range acts as the end of the range, with slopes of
  /// 0. Does nothing if one of them is not a number.
  void set_motion(std::size_t mass, const Number& displacement_m, const Number& velocity_m_per_s) {
    if (!is_number(displacement_m.value) || !is_number(velocity_m_per_s.value)) return;
    model_.set_motion(mass, displacement_m.value, velocity_m_per_s.value);
    modes_.set_motion(mass, held(Number(), displacement_m, Ranges::displacement_m),
                      held(Number(), velocity_m_per_s, Ranges::speed_m_per_s));
    restart();
  }

  /// ContactNetwork::put_place, which also tells how the place follows the parameters [m]. Beyond the ends of the
  /// string it does not.
  void put_place(std::size_t place, const Number& place_m) {
    model_.put_place(place, place_m.value);
    Mover& mover = movers_[*places_[place].mover];
    mover.motion.put(place_m.value);
    mover.target = mover.place = held(mover.place, place_m, mover.range);
    mover.has_turned = false;
    write_shapes(mover, mover.after);
    places_[place].shapes = mover.after;
    restart();
  }

  /// ContactNetwork::move_place. A place that is slower than its target does not follow the parameters, but keeps the
  /// derivatives that it has.
  void move_place(std::size_t place, const Number& place_m) {
    model_.move_place(place, place_m.value);
    Mover& mover = movers_[*places_[place].mover];
    mover.target = held(mover.place, place_m, mover.range);
  }

  /// Pushes at a place during the next sample [N], -1000 to 1000, with the rules of set_motion(). Several pushes add
  /// up.
  void push(std::size_t place, const Number& force_n) {
    model_.push(place, force_n.value);
    places_[place].push = places_[place].push + held(Number(), force_n, Ranges::force_n);
  }

  /// Advances one sample. Does not allocate.
  void tick() {
    for (Mover& mover : movers_) move(mover);
    model_.tick();
    respond();
    push();
    solve();
    push_slopes();
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b)
      modes_.advance(b, model_.body(b).displacements(), model_.body(b).changes());
    for (Mover& mover : movers_)
      if (mover.is_moving) mover.owed = mover.owed + half_increment(mover);
    measure();
    for (std::size_t k = 0; k < connections_.size(); ++k)
      if (connections_[k].contact.remembers() || (has_memory(k) && model_.compression(k) > 0))
        connections_[k].contact.relax(compression(k));
  }

  [[nodiscard]] const ContactNetwork<T>& model() const { return model_; }
  /// Displacement of a place [m].
  [[nodiscard]] Number displacement(std::size_t place) const {
    return {model_.displacement(place), displacement_slopes(place)};
  }
  /// Force of a connection over the last sample [N].
  [[nodiscard]] const Number& force(std::size_t connection) const { return connections_[connection].force; }
  [[nodiscard]] Number compression(std::size_t connection) const {  ///< [m], negative while apart
    const Number pressed = between(connection, &NetworkTangent::pressing) - connections_[connection].gap;
    return {model_.compression(connection), pressed.slopes};
  }

 private:
  using Ranges = ControlRanges<T>;
  using Shapes = detail::ShapeSlopes<T, P>;
  struct Place {
    std::size_t body;
    Shapes shapes;  ///< in this sample, where the place moves
    Number push = {}, force = {};
    std::optional<std::size_t> mover = {}, watched = {};
    bool is_joined = false;  ///< by a connection
  };
  // What a place that moves has beside its Place, as the network has it. lift: what the move itself adds to the
  // increment of the connections there; of it and of what is owed only the slopes count. has_turned: the slopes of
  // the place changed in the last sample.
  struct Mover {
    std::size_t index, body;
    std::vector<double> wavenumbers;
    ControlRange<T> range;
    MovingPlace<T> motion;
    Shapes after, change, before;  // shapes
    Number place, target;
    Number owed = {}, lift = {};
    bool is_moving = false, has_turned = false;
  };
  // response: the derivative of the force with respect to the increment [N/m]. Where shapes follow parameters, the
  // compression is measured after each sample, from the displacements then. Elsewhere it is known after a sample in
  // which the connection responded, or it is measured when it is needed, now and then in any case: rounding adds up.
  struct Connection {
    ContactTangent<T, P> contact;
    ContactControls<T> controls;
    Number gap, spring, resistance, force = {}, measured = {};
    T response = 0;
    bool is_measured = false, is_known = false;
  };
  static constexpr std::size_t kMeasured = 64;  // samples
  using Directions = std::array<NetworkNumbers<T>, P>;

  void add_place(std::size_t q, double sample_rate_hz, const Directions& directions) {
    const auto& place = plan_.places()[q];
    Shapes shapes_here(place.shapes);
    for (std::size_t p = 0; p < P; ++p) {
      const auto& all = directions[p].places;
      if (all.empty() || all[q].size() == 0) continue;
      shapes_here.slopes[p] = all[q];
      shapes_here.is_constant = false;
    }
    places_.push_back({place.body, std::move(shapes_here)});
    if (place.wavenumbers_per_m.empty()) return;
    const StringShapes<T> shapes{std::span<const double>(place.wavenumbers_per_m)};
    const T longest_step = shapes.longest_step(plan_.bodies()[place.body], sample_rate_hz);
    places_[q].mover = movers_.size();
    movers_.push_back({q,
                       place.body,
                       place.wavenumbers_per_m,
                       {0, shapes.length()},
                       {shapes, place.place_m, longest_step},
                       places_[q].shapes,
                       places_[q].shapes,
                       places_[q].shapes,
                       place.place_m,
                       place.place_m});
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
    connections_.push_back(
        {{plan.table, plan.memories, sample_rate_hz, std::move(contacts)}, acting.contact, gap, spring, resistance});
    for (const std::size_t place : {plan.first, plan.second}) {
      if (place == kGround) continue;
      places_[place].is_joined = true;
      connections_[k].is_measured |= places_[place].mover || !places_[place].shapes.is_constant;
    }
  }

  [[nodiscard]] bool is_contact(std::size_t k) const { return !plan_.connections()[k].table.empty(); }

  [[nodiscard]] bool has_memory(std::size_t k) const { return !plan_.connections()[k].memories.empty(); }

  // sin(wavenumber place), with the derivatives that follow from those of the place.
  static void write_shapes(const Mover& mover, Shapes& shapes) {
    shapes.values = mover.motion.after();
    for (std::size_t i = 0; i < shapes.values.size(); ++i) {
      const T slope = std::cos(static_cast<T>(mover.wavenumbers[i]) * mover.motion.place()) *
                      static_cast<T>(mover.wavenumbers[i]);
      for (std::size_t p = 0; p < P; ++p) shapes.slopes[p][i] = slope * mover.place.slopes[p];
    }
    shapes.is_constant = mover.place.slopes == std::array<T, P>{};
  }

  // ContactNetwork::move_places, before the model plays the sample. A place that has reached its target also moves if
  // only the slopes of that change: so do those of the shapes, over one sample.
  void move(Mover& mover) {
    mover.lift = Number();
    const bool moves = mover.motion.move_to(mover.target.value);
    mover.place.value = mover.motion.place();
    const bool turns = mover.place.value == mover.target.value && mover.place.slopes != mover.target.slopes;
    if (turns) mover.place.slopes = mover.target.slopes;
    mover.is_moving = moves || turns || mover.has_turned;
    mover.has_turned = turns;
    if (!mover.is_moving) return;
    std::swap(mover.before, mover.after);
    write_shapes(mover, mover.after);
    places_[mover.index].shapes.combine(T(0.5), mover.before, T(0.5), mover.after);
    mover.change.combine(1, mover.after, -1, mover.before);
    const Number half = half_increment(mover);
    const Number moved(0, modes_.displacement(mover.body, mover.change, model_.body(mover.body).displacements()));
    mover.lift = moved + half + mover.owed;
    mover.owed = Number(0) - half;
  }
  // Half of the last sample's increments, times the change of the shapes.
  [[nodiscard]] Number half_increment(const Mover& mover) const {
    return Number(T(0.5)) * Number(0, modes_.change(mover.body, mover.change, model_.body(mover.body).changes()));
  }

  // The forces of the sample that the model has played, and how they respond to the compressions before it and to
  // parameters at constant increments. A contact that neither presses nor remembers does not respond.
  void respond() {
    const bool is_time = samples_++ % kMeasured == 0;
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      Connection& c = connections_[k];
      c.is_known = c.response > 0 && !is_time;
      const T force = model_.force(k);
      c.force = Number();
      c.response = 0;
      if (is_contact(k) && force == 0 && !c.contact.remembers()) continue;
      if (!c.is_measured && !c.is_known) c.measured = compression(k);
      const Number before(model_.compression_before(k), c.measured.slopes);
      const T after = model_.compression(k);
      if (is_contact(k)) {
        const auto response = c.contact.respond(c.controls, before, force, after);
        c.force = response.force;
        c.response = response.stiffness;
        continue;
      }
      const Number change(after - before.value);
      c.force = c.spring * (before + Number(T(0.5)) * change) + c.resistance * change;
      c.force.value = force;
      c.response = c.spring.value / 2 + c.resistance.value;
    }
  }

  // What the forces without their derivatives, and pushes, do to the modes.
  void push() {
    for (Place& place : places_) place.force = std::exchange(place.push, Number());
    for (std::size_t k = 0; k < connections_.size(); ++k) add_to_places(k, Number(connections_[k].force.value));
    for (const Place& place : places_) modes_.push(place.body, place.shapes, place.force);
  }

  // Adds to the derivatives of the forces what the increments do, which these forces reduce, too.
  void solve() {
    equations_.begin();
    for (std::size_t k = 0; k < connections_.size(); ++k) equations_.add(k, connections_[k].response);
    equations_.factorise(model_.solver());
    const std::span<const std::size_t> acting = equations_.acting();
    for (std::size_t a = 0; a < acting.size(); ++a) increments_[a] = between(acting[a], &NetworkTangent::increment);
    for (std::size_t k = 0; k < connections_.size(); ++k) {
      const std::array<T, P>& slopes = connections_[k].force.slopes;
      if (slopes == std::array<T, P>{}) continue;
      for (std::size_t a = 0; a < acting.size(); ++a)
        for (std::size_t p = 0; p < P; ++p)
          increments_[a].slopes[p] -= model_.solver().admittance(acting[a], k) * slopes[p];
    }
    for (std::size_t p = 0; p < P; ++p) {
      for (std::size_t a = 0; a < acting.size(); ++a) solution_[a] = increments_[a].slopes[p];
      equations_.solve(solution_.data());
      for (std::size_t a = 0; a < acting.size(); ++a) {
        Connection& c = connections_[acting[a]];
        c.force.slopes[p] += equations_.root(a) * solution_[a];
        c.measured.slopes[p] += solution_[a] / equations_.root(a);
      }
    }
  }

  // What the derivatives of the forces do to the modes.
  void push_slopes() {
    for (Place& place : places_) place.force = Number();
    for (std::size_t k = 0; k < connections_.size(); ++k) add_to_places(k, Number(0, connections_[k].force.slopes));
    for (const Place& place : places_) modes_.push_slopes(place.body, place.shapes, place.force.slopes);
  }

  void add_to_places(std::size_t k, const Number& force) {
    const std::size_t first = plan_.connections()[k].first, second = plan_.connections()[k].second;
    if (first != kGround) places_[first].force = places_[first].force - force;
    if (second != kGround) places_[second].force = places_[second].force + force;
  }

  // After what moves bodies or places between two samples.
  void restart() {
    for (Mover& mover : movers_) mover.owed = Number();
    for (Connection& c : connections_) c.response = 0;
    measure();
  }

  void measure() {
    for (std::size_t k = 0; k < connections_.size(); ++k)
      if (connections_[k].is_measured) connections_[k].measured = compression(k);
  }

  [[nodiscard]] std::array<T, P> displacement_slopes(std::size_t place) const {
    const Place& p = places_[place];
    return modes_.displacement(p.body, p.mover ? movers_[*p.mover].after : p.shapes,
                               model_.body(p.body).displacements());
  }
  // By how much a place moves its connections over the sample, and how far they are pressed after it. Only the slopes
  // count.
  [[nodiscard]] Number increment(std::size_t place) const {
    const Place& p = places_[place];
    if (p.watched) return {0, modes_.free_increment(p.body, p.shapes, *p.watched)};
    const Number moved(0, modes_.free_increment(p.body, p.shapes, model_.body(p.body).changes()));
    return p.mover ? moved + movers_[*p.mover].lift : moved;
  }
  [[nodiscard]] Number pressing(std::size_t place) const {
    const Place& p = places_[place];
    const Number displaced(0, displacement_slopes(place));
    return p.mover ? displaced - movers_[*p.mover].owed : displaced;
  }
  // A value at the first place of a connection less that at the second.
  [[nodiscard]] Number between(std::size_t k, Number (NetworkTangent::*value)(std::size_t) const) const {
    const auto& plan = plan_.connections()[k];
    const Number first = plan.first == kGround ? Number() : (this->*value)(plan.first);
    return plan.second == kGround ? first : first - (this->*value)(plan.second);
  }

  const NetworkPlan<T>& plan_;
  ContactNetwork<T> model_;
  T time_step_;
  detail::ModeSlopes<T, P> modes_;
  std::vector<Place> places_;
  std::vector<Mover> movers_;
  std::vector<Connection> connections_;
  detail::ForceEquations<T> equations_;
  std::size_t samples_ = 0;
  std::vector<Number> increments_;  // of the connections that act
  std::vector<T> solution_;
};

}  // namespace contactspline
