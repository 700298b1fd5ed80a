// SPDX-License-Identifier: MIT
// The bodies of a network and the places on them, with the derivatives of their motion
// (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/network/contact_network.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/tangent/mode_slopes.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/place_tangent.hpp"

namespace contactspline::detail {

/// Bodies and places beside those of a ContactNetwork, `model`. For each sample call move_places(), let the model
/// advance, then call push(), moved() and drive() for the places of all connections, and advance(). Of a Number that
/// it returns only the slopes count.
template <std::floating_point T, std::size_t P>
class BodiesTangent {
 public:
  using Number = Dual<T, P>;
  using Model = ContactNetwork<T>;

  BodiesTangent(const NetworkPlan<T>& plan, double sample_rate_hz, const std::array<NetworkNumbers<T>, P>& directions)
      : plan_(plan),
        modes_(plan, sample_rate_hz),
        before_(modes_.size()),
        loads_(modes_.size()),
        asked_on_(plan.bodies().size()) {
    for (std::size_t p = 0; p < P; ++p) {
      slopes_.emplace_back(plan, modes_, sample_rate_hz, directions[p].bodies);
      has_loads_ = has_loads_ || std::ranges::count(slopes_[p].has_constants, 1) > 0;
    }
    for (std::size_t q = 0; q < plan.places().size(); ++q) add_place(q, sample_rate_hz, directions);
    for (auto& asked : asked_on_) asked.reserve(places_.size());
    pushed_.reserve(places_.size());
    forces_.reserve(places_.size());
  }

  /// The slopes of displacement and free increment of a free mass [m].
  void set_motion(std::size_t mass, const Number& displacement, const Number& increment) {
    for (std::size_t p = 0; p < P; ++p) {
      slopes_[p].displacement[modes_.begins[mass]] = displacement.slopes[p];
      slopes_[p].increment[modes_.begins[mass]] = increment.slopes[p];
    }
  }
  /// place: of NetworkPlan::add_moving_place(), as in move_place().
  void put_place(std::size_t place, const Number& place_m) {
    Place& p = places_[place];
    Mover& mover = movers_[*p.mover];
    mover.put(place_m);
    p.acting_slopes = mover.after;
    p.acting = p.seen = mover.motion.after().data();
    p.measure_drive(modes_.receptance);
  }
  void move_place(std::size_t place, const Number& place_m) {
    Mover& mover = movers_[*places_[place].mover];
    mover.target = held(mover.place, place_m, mover.range);
  }
  /// Nothing is owed any more.
  void place_all() {
    for (Mover& mover : movers_) mover.owed = Number();
  }
  void push(std::size_t place, const Number& force) {
    Place& p = places_[place];
    if (!std::exchange(p.is_pushed, true)) pushed_.push_back(place);
    p.push = p.push + force;
  }
  [[nodiscard]] bool moves(std::size_t place) const { return places_[place].mover.has_value(); }

  /// ContactNetwork::move_places, before the model's sample.
  void move_places(const Model& model) {
    for (Mover& mover : movers_) {
      Place& place = places_[mover.index];
      if (!mover.move(place.acting_slopes)) continue;
      place.seen = mover.motion.after().data();
      place.acting = mover.motion.mean().data();
      place.measure_drive(modes_.receptance);
      const Number half = half_increment(mover, model);
      mover.lift = along(place, mover.motion.change().data(), &Modes::displacement, mover.change,
                         model.body(place.body).displacements().data()) +
                   half + mover.owed;
      mover.owed = Number(0) - half;
    }
  }

  /// What pushes do, and what forces do through the slopes of receptances and shapes.
  void push(const Model& model) {
    for (const std::size_t q : pushed_)
      for (std::size_t p = 0; p < P; ++p)
        if (const T force = places_[q].push.slopes[p]; force != 0)
          Modes::add_scaled(places_[q].modes, force, places_[q].drive.data(),
                            slopes_[p].push(modes_, places_[q].body));
    if (has_loads_) push_by_loads(model);
    for (const std::size_t q : pushed_) {
      places_[q].push = Number();
      places_[q].is_pushed = false;
    }
    pushed_.clear();
  }
  /// By how much a place moves its connections over the sample without their forces.
  [[nodiscard]] const Number& moved(std::size_t q, const Model& model) {
    Place& place = places_[q];
    if (std::exchange(place.is_asked, true)) return place.moved;
    asked_on_[place.body].push_back(q);
    place.driven = Number();
    for (std::size_t p = 0; p < P; ++p) {
      place.moved.slopes[p] = Modes::dot(place.modes, place.acting, slopes_[p].free(modes_, place.body));
      if (place.acting_slopes.any[p])
        place.moved.slopes[p] +=
            Modes::dot(place.modes, place.acting_slopes.of[p].data(), model.body(place.body).changes().data());
    }
    if (place.mover && movers_[*place.mover].is_moving) place.moved = place.moved + movers_[*place.mover].lift;
    return place.moved;
  }
  /// Adds to the force on a place that has moved() [N].
  void drive(std::size_t q, T sign, const Number& force) {
    for (std::size_t p = 0; p < P; ++p) places_[q].driven.slopes[p] += sign * force.slopes[p];
  }
  void advance(const Model& model) {
    for (std::size_t b = 0; b < asked_on_.size(); ++b) advance_body(b, model);
    for (Mover& mover : movers_)
      if (mover.is_moving) mover.owed = mover.owed + half_increment(mover, model);
  }

  /// The displacement of a place, after the model's sample or between two.
  [[nodiscard]] Number displacement(std::size_t q, const Model& model) const {
    return displacement_at(q, model.body(places_[q].body).displacements().data());
  }
  /// What presses the connections of a place then.
  [[nodiscard]] Number pressing(std::size_t q, const Model& model) const {
    const Number at = displacement(q, model);
    return moves(q) ? at - movers_[*places_[q].mover].owed : at;
  }
  /// The same of a place at rest, where the model is a sample ahead.
  [[nodiscard]] Number pressing_before(std::size_t q, const Model& model) {
    const Place& place = places_[q];
    if (std::ranges::count(place.acting_slopes.any, true) > 0)
      for (std::size_t i = 0; i < place.modes; ++i)
        before_[place.begin + i] = model.body(place.body).displacements()[i] - model.body(place.body).changes()[i];
    return displacement_at(q, before_.data() + place.begin);
  }

 private:
  using Place = PlaceTangent<T, P>;
  using Mover = MoverTangent<T, P>;
  using Modes = ModeSlopes<T>;

  void add_place(std::size_t q, double sample_rate_hz, const std::array<NetworkNumbers<T>, P>& directions) {
    const auto& place = plan_.places()[q];
    const std::size_t modes = place.shapes.size();
    places_.push_back({place.body, modes_.begins[place.body], modes, place.shapes.data(), place.shapes.data(),
                       ShapeSlopes<T, P>(modes)});
    Place& added = places_.back();
    for (std::size_t p = 0; p < P; ++p) {
      const auto& all = directions[p].places;
      if (q >= all.size() || all[q].size() == 0) continue;
      added.acting_slopes.any[p] = has_loads_ = true;
      for (std::size_t i = 0; i < (std::min)(modes, all[q].size()); ++i) added.acting_slopes.of[p][i] = all[q][i];
    }
    added.measure_drive(modes_.receptance);
    if (place.wavenumbers_per_m.empty()) return;
    has_loads_ = true;
    added.mover = movers_.size();
    movers_.emplace_back(q, plan_, sample_rate_hz);
    movers_.back().after = added.acting_slopes;
  }

  // Half of the last sample's increments, times the change of the shapes.
  [[nodiscard]] Number half_increment(const Mover& mover, const Model& model) const {
    const Place& place = places_[mover.index];
    return Number(T(0.5)) * along(place, mover.motion.change().data(), &Modes::change, mover.change,
                                  model.body(place.body).changes().data());
  }
  // A sum over the modes of a place: of shapes times what `slopes` are those of, by values.
  [[nodiscard]] Number along(const Place& place, const T* shapes, std::vector<T> Modes::*slopes,
                             const ShapeSlopes<T, P>& of_shapes, const T* values) const {
    Number sum;
    for (std::size_t p = 0; p < P; ++p) {
      sum.slopes[p] = Modes::dot(place.modes, shapes, (slopes_[p].*slopes).data() + place.begin);
      if (of_shapes.any[p]) sum.slopes[p] += Modes::dot(place.modes, of_shapes.of[p].data(), values);
    }
    return sum;
  }
  // The displacement of a place whose modes have these displacements.
  [[nodiscard]] Number displacement_at(std::size_t q, const T* displacements) const {
    const Place& place = places_[q];
    return along(place, place.seen, &Modes::displacement,
                 place.mover ? movers_[*place.mover].after : place.acting_slopes, displacements);
  }

  void push_by_loads(const Model& model) {
    for (Place& place : places_) place.load = place.push.value;
    for (std::size_t k = 0; k < plan_.connections().size(); ++k) {
      const std::size_t first = plan_.connections()[k].first, second = plan_.connections()[k].second;
      if (first != kGround) places_[first].load -= model.force(k);
      if (second != kGround) places_[second].load += model.force(k);
    }
    for (std::size_t b = 0; b < plan_.bodies().size(); ++b) load_modes(b);
    for (const Place& place : places_)
      for (std::size_t p = 0; p < P; ++p)
        if (place.load != 0 && place.acting_slopes.any[p])
          Modes::add_product(place.modes, place.load, modes_.receptance.data() + place.begin,
                             place.acting_slopes.of[p].data(), slopes_[p].push(modes_, place.body));
  }
  // What the loads do through the slopes of the receptances of a body.
  void load_modes(std::size_t b) {
    const auto has_constants = [&](const Modes& slopes) { return slopes.has_constants[b] != 0; };
    if (std::ranges::none_of(slopes_, has_constants)) return;
    std::ranges::fill(loads_, T(0));
    for (const Place& place : places_)
      if (place.body == b && place.load != 0) Modes::add_scaled(place.modes, place.load, place.acting, loads_.data());
    for (Modes& slopes : slopes_)
      if (has_constants(slopes)) slopes.push_loads(modes_, b, loads_.data());
  }
  void advance_body(std::size_t b, const Model& model) {
    for (Modes& slopes : slopes_) {
      const auto p = static_cast<std::size_t>(&slopes - slopes_.data());
      forces_.clear();
      for (const std::size_t q : asked_on_[b])
        if (const T force = places_[q].driven.slopes[p]; force != 0)
          forces_.push_back({places_[q].drive.data(), force});
      slopes.advance(modes_, b, forces_, !movers_.empty());
      if (slopes.has_constants[b] != 0)
        slopes.bend(modes_.begins[b], model.body(b).changes(), model.body(b).displacements());
    }
    for (const std::size_t q : asked_on_[b]) places_[q].is_asked = false;
    asked_on_[b].clear();
  }

  const NetworkPlan<T>& plan_;
  NetworkModes<T> modes_;
  std::vector<Modes> slopes_;  // by each parameter
  std::vector<T> before_;      // displacements of modes
  std::vector<T> loads_;       // forces on the modes of a body [N]
  std::vector<Place> places_;
  std::vector<Mover> movers_;
  std::vector<std::size_t> pushed_;                 // places
  std::vector<std::vector<std::size_t>> asked_on_;  // each body: places of connections that are followed
  std::vector<DrivingForce<T>> forces_;
  bool has_loads_ = false;  // do slopes of receptances or shapes count?
};

}  // namespace contactspline::detail
