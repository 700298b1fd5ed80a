// SPDX-License-Identifier: MIT
// A network of bodies, contacts and springs with its derivatives with respect to several parameters, forwards
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

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
#include "contactspline/tangent/mode_tangent.hpp"
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
        equations_(plan.connections().size()),
        increments_(plan.connections().size()),
        solution_(plan.connections().size()) {
    for (std::size_t b = 0; b < plan.bodies().size(); ++b) add_body(b, sample_rate_hz, directions);
    for (std::size_t q = 0; q < plan.places().size(); ++q) add_place(q, sample_rate_hz, directions);
    for (std::size_t k = 0; k < plan.connections().size(); ++k) add_connection(k, sample_rate_hz, directions);
    measure_compressions();
  }

  /// Puts a free mass between two samples at a displacement [m], -1000 to 1000, with a velocity [m/s], -1000 to 1000.
  /// mass: a body of NetworkPlan::add_mass(). A value beyond its range acts as the end of the range, with slopes of
  /// 0. Does nothing if one of them is not a number.
  void set_motion(std::size_t mass, const Number& displacement_m, const Number& velocity_m_per_s) {
    if (!is_number(displacement_m.value) || !is_number(velocity_m_per_s.value)) return;
    model_.set_motion(mass, displacement_m.value, velocity_m_per_s.value);
    bodies_[mass][0].displacement = held(Number(), displacement_m, Ranges::displacement_m);
    bodies_[mass][0].increment = Number(time_step_) * held(Number(), velocity_m_per_s, Ranges::speed_m_per_s);
    for (Mover& mover : movers_) mover.owed = Number();
    measure_compressions();
  }

  /// ContactNetwork::put_place, which also tells how the place follows the parameters [m]. Beyond the ends of the
  /// string it does not.
  void put_place(std::size_t place, const Number& place_m) {
    model_.put_place(place, place_m.value);
    Mover& mover = movers_[*places_[place].mover];
    mover.motion.put(place_m.value);
    mover.target = mover.place = held(mover.place, place_m, mover.range);
    mover.has_turned = false;
    mover.after = places_[place].shapes = shapes_of(mover);
    for (Mover& other : movers_) other.owed = Number();
    measure_compressions();
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
    model_.tick();
    for (Mover& mover : movers_) move(mover);
    respond();
    push_modes();
    solve();
    push_modes();
    for (Place& place : places_) place.push = Number();
    advance_modes();
    for (Mover& mover : movers_)
      if (mover.is_moving) mover.owed = mover.owed + half_increment(mover);
    measure_compressions();
    for (std::size_t k = 0; k < connections_.size(); ++k)
      if (is_contact(k)) connections_[k].contact.relax(connections_[k].compression);
  }

  [[nodiscard]] const ContactNetwork<T>& model() const { return model_; }
  /// Displacement of a place [m].
  [[nodiscard]] Number displacement(std::size_t place) const {
    return sum(places_[place].body, shapes_after(place), &ModeTangent::displacement);
  }
  /// Force of a connection over the last sample [N].
  [[nodiscard]] const Number& force(std::size_t connection) const { return connections_[connection].force; }
  [[nodiscard]] const Number& compression(std::size_t connection) const {  ///< [m], negative while apart
    return connections_[connection].compression;
  }

 private:
  using Ranges = ControlRanges<T>;
  // The constants and the motion of a mode (ModalBank). Only the slopes of the increment count.
  struct ModeTangent {
    Number stiffness, loss, admittance;
    Number displacement, increment, change;
  };
  struct Place {
    std::size_t body;
    std::vector<Number> shapes;  ///< in this sample, where the place moves
    Number push = {}, force = {};
    std::optional<std::size_t> mover = {};
  };
  // What a place that moves has beside its Place, as the network has it. lift: what the move itself adds to the
  // increment of the connections there. has_turned: the slopes of the place changed in the last sample.
  struct Mover {
    std::size_t index, body;
    std::vector<double> wavenumbers;
    ControlRange<T> range;
    MovingPlace<T> motion;
    std::vector<Number> after;  // shapes
    Number place, target;
    std::vector<Number> change = {};
    Number owed = {}, lift = {};
    bool is_moving = false, has_turned = false;
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

  void add_place(std::size_t q, double sample_rate_hz, const Directions& directions) {
    const auto& place = plan_.places()[q];
    places_.push_back({place.body, {}});
    for (std::size_t i = 0; i < place.shapes.size(); ++i) {
      Number shape(place.shapes[i]);
      for (std::size_t p = 0; p < P; ++p)
        if (const auto& all = directions[p].places; !all.empty() && all[q].size() > 0) shape.slopes[p] = all[q][i];
      places_[q].shapes.push_back(shape);
    }
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
                       place.place_m,
                       place.place_m});
    movers_.back().change.resize(place.shapes.size());
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

  // sin(wavenumber place), with the derivatives that follow from those of the place.
  [[nodiscard]] static std::vector<Number> shapes_of(const Mover& mover) {
    std::vector<Number> shapes(mover.wavenumbers.size());
    write_shapes(mover, shapes);
    return shapes;
  }
  static void write_shapes(const Mover& mover, std::vector<Number>& shapes) {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      shapes[i] = mover.motion.after()[i];
      const T slope = std::cos(static_cast<T>(mover.wavenumbers[i]) * mover.motion.place()) *
                      static_cast<T>(mover.wavenumbers[i]);
      for (std::size_t p = 0; p < P; ++p) shapes[i].slopes[p] = slope * mover.place.slopes[p];
    }
  }

  // ContactNetwork::move_places. A place that has reached its target also moves if only the slopes of that change: so
  // do those of the shapes, over one sample.
  void move(Mover& mover) {
    mover.lift = Number();
    const bool moves = mover.motion.move_to(mover.target.value);
    mover.place.value = mover.motion.place();
    const bool turns = mover.place.value == mover.target.value && mover.place.slopes != mover.target.slopes;
    if (turns) mover.place.slopes = mover.target.slopes;
    mover.is_moving = moves || turns || mover.has_turned;
    mover.has_turned = turns;
    if (!mover.is_moving) return;
    std::vector<Number>& mean = places_[mover.index].shapes;
    std::swap(mover.change, mover.after);  // the shapes before
    write_shapes(mover, mover.after);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      mean[i] = Number(T(0.5)) * (mover.change[i] + mover.after[i]);
      mover.change[i] = mover.after[i] - mover.change[i];
    }
    const Number half = half_increment(mover);
    mover.lift = sum(mover.body, mover.change, &ModeTangent::displacement) + half + mover.owed;
    mover.owed = Number(0) - half;
  }
  // Half of the last sample's increments, times the change of the shapes.
  [[nodiscard]] Number half_increment(const Mover& mover) const {
    return Number(T(0.5)) * sum(mover.body, mover.change, &ModeTangent::change);
  }

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

  // Adds to the derivatives of the forces what the increments do.
  void solve() {
    equations_.begin();
    for (std::size_t k = 0; k < connections_.size(); ++k) equations_.add(k, connections_[k].response);
    equations_.factorise(model_.solver());
    const std::span<const std::size_t> acting = equations_.acting();
    for (std::size_t a = 0; a < acting.size(); ++a) increments_[a] = between(acting[a], &NetworkTangent::increment);
    for (std::size_t p = 0; p < P; ++p) {
      for (std::size_t a = 0; a < acting.size(); ++a) solution_[a] = increments_[a].slopes[p];
      equations_.solve(solution_.data());
      for (std::size_t a = 0; a < acting.size(); ++a)
        connections_[acting[a]].force.slopes[p] += equations_.root(a) * solution_[a];
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
      connections_[k].compression = between(k, &NetworkTangent::pressing) - connections_[k].gap;
      connections_[k].compression.value = model_.compression(k);
    }
  }

  [[nodiscard]] Number sum(std::size_t body, const std::vector<Number>& shapes, Number ModeTangent::*member) const {
    Number sum;
    for (std::size_t i = 0; i < shapes.size(); ++i) sum = sum + shapes[i] * bodies_[body][i].*member;
    return sum;
  }
  [[nodiscard]] const std::vector<Number>& shapes_after(std::size_t place) const {
    const Place& p = places_[place];
    return p.mover ? movers_[*p.mover].after : p.shapes;
  }
  // By how much a place moves its connections over the sample, and how far they are pressed after it.
  [[nodiscard]] Number increment(std::size_t place) const {
    const Place& p = places_[place];
    const Number moved = sum(p.body, p.shapes, &ModeTangent::change);
    return p.mover ? moved + movers_[*p.mover].lift : moved;
  }
  [[nodiscard]] Number pressing(std::size_t place) const {
    const Place& p = places_[place];
    return p.mover ? displacement(place) - movers_[*p.mover].owed : displacement(place);
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
  std::vector<std::vector<ModeTangent>> bodies_;
  std::vector<Place> places_;
  std::vector<Mover> movers_;
  std::vector<Connection> connections_;
  detail::ForceEquations<T> equations_;
  std::vector<Number> increments_;  // of the connections that act
  std::vector<T> solution_;
};

}  // namespace contactspline
