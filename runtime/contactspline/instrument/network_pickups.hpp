// SPDX-License-Identifier: MIT
// What the outputs of an instrument file hear of its network.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/instrument/network_pressure.hpp"
#include "contactspline/instrument/network_tuning.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/network/contact_network.hpp"

namespace contactspline::detail {

/// The shapes through which outputs hear displacements and velocities of places, and what they hear of forces at
/// once.
template <std::floating_point T>
class NetworkPickups {
 public:
  /// Allocates.
  void prepare(const InstrumentData& data, const ContactNetwork<T>& network, double sample_rate_hz) {
    pickups_.assign(data.targets.size(), {});
    for_each_place(data, [&](OutputQuantity quantity, std::size_t target) {
      const std::size_t place = data.targets[target], modes = data.modes_of(data.place_bodies[place]);
      pickups_[target].displacement = ModeShapes<T>(modes);
      if (quantity == OutputQuantity::kVelocity)
        pickups_[target].velocity = {ModeShapes<T>(modes), ModeShapes<T>(modes)};
      if (!is_far_end(data, place)) return;
      pickups_[target].tension = Tension(data, data.place_bodies[place]);
      if (!pickups_[target].tension.empty()) pickups_[target].per_tension = shapes_per_tension(data, network, place);
    });
    for (const InstrumentOutput& source : data.sources)
      for (std::size_t i = 0; source.quantity == OutputQuantity::kTension && i < source.count; ++i)
        pickups_[source.first_target + i].tension = Tension(data, data.targets[source.first_target + i]);
    pressure_.prepare(data, sample_rate_hz);
  }
  void reset() { pressure_.reset(); }
  /// After each sample.
  void follow(const ContactNetwork<T>& network) { pressure_.follow(network); }

  /// Takes the shapes from the network as it is tuned now. Does not allocate.
  void measure(const InstrumentData& data, const ContactNetwork<T>& network, const NetworkTuning<T>& tuning) {
    for_each_place(data, [&](OutputQuantity quantity, std::size_t target) {
      const std::size_t place = data.targets[target], body = data.place_bodies[place];
      const std::span<const double> shapes = data.shapes_of(place);
      const std::size_t first_mode = data.body_ends[body] - shapes.size();
      const bool is_force = is_far_end(data, place);
      const ModalBank<T>& bank = network.body(body);
      Pickup& pickup = pickups_[target];
      for (std::size_t i = 0; i < shapes.size(); ++i)
        pickup.displacement[i] = bank.sound_shape(
            i, static_cast<T>(is_force ? shapes[i] * tuning.stiffness_ratio(first_mode + i) : shapes[i]));
      if (quantity == OutputQuantity::kVelocity) bank.write_velocity_shapes(pickup.displacement, pickup.velocity);
      if (quantity == OutputQuantity::kPressure)
        for (std::size_t i = 0; i < shapes.size(); ++i)
          pickups_[target - 1].velocity.of_displacement[i] += pickup.displacement[i];
    });
  }

  /// An output over the last sample [m], [m/s], [N] or [Pa].
  [[nodiscard]] T output(const InstrumentData& data, const ContactNetwork<T>& network, std::size_t output) const {
    const InstrumentOutput& source = data.sources[output];
    if (source.quantity == OutputQuantity::kPressure) {
      const std::size_t first = source.first_target;
      return network.body(data.place_bodies[data.targets[first]]).velocity(pickups_[first].velocity) +
             pressure_.output(output);
    }
    T sum = 0 - static_cast<T>(source.at_rest_n);
    for (std::size_t i = source.first_target; i < source.first_target + source.count; ++i) {
      const std::size_t k = data.targets[i];
      if (source.quantity == OutputQuantity::kForce)
        sum += network.force(k);
      else if (source.quantity == OutputQuantity::kTension)
        sum += pickups_[i].tension.rise(network, k);
      else if (const ModalBank<T>& body = network.body(data.place_bodies[k]);
               source.quantity == OutputQuantity::kVelocity)
        sum += body.velocity(pickups_[i].velocity);
      else
        sum += body.displacement(pickups_[i].displacement) + risen(network, data.place_bodies[k], pickups_[i]);
    }
    return sum;
  }

 private:
  // By how much the tension at the far end of a string has risen.
  class Tension {
   public:
    Tension() = default;
    Tension(const InstrumentData& data, std::size_t body) {
      for (const InstrumentForm& form : data.stretch_forms)
        if (form.body == body) of_forms_n_.push_back(form.end_tension_n);
    }
    [[nodiscard]] bool empty() const { return of_forms_n_.empty(); }
    [[nodiscard]] T rise(const ContactNetwork<T>& network, std::size_t body) const {
      double sum_n = 0;
      for (std::size_t k = 0; k < of_forms_n_.size(); ++k) sum_n += of_forms_n_[k] * network.stretch(body, k);
      return static_cast<T>(sum_n);
    }

   private:
    std::vector<double> of_forms_n_;
  };
  struct Pickup {
    ModeShapes<T> displacement;
    typename ModalBank<T>::VelocityShapes velocity;  // of velocities and pressures only
    ModeShapes<T> per_tension;                       // of far ends only: force by displacement and tension [1/m]
    Tension tension;                                 // of far ends and tensions only
  };

  // There a displacement is a force, which rises with the tension.
  [[nodiscard]] static bool is_far_end(const InstrumentData& data, std::size_t place) {
    return place >= data.place_bodies.size() - data.keyed.far_ends;
  }

  // What the tension that has risen adds to the force at a far end.
  [[nodiscard]] static T risen(const ContactNetwork<T>& network, std::size_t body, const Pickup& pickup) {
    if (pickup.tension.empty()) return 0;
    return pickup.tension.rise(network, body) * network.body(body).displacement(pickup.per_tension);
  }

  // Where the tension rises evenly, by the one form of stiffness c and squares a_i, the stiffness of mode i rises by
  // c a_i s, and the force at the far end as much.
  [[nodiscard]] static ModeShapes<T> shapes_per_tension(const InstrumentData& data, const ContactNetwork<T>& network,
                                                        std::size_t place) {
    const std::size_t body = data.place_bodies[place];
    const auto shapes = data.shapes_of(place);
    ModeShapes<T> per_tension(shapes.size());
    const auto even = std::ranges::find(data.stretch_forms, body, &InstrumentForm::body);
    const std::vector<double> squares = data.forms_of(body).front().squares_per_m2;
    const auto frequencies = data.part_of(data.angular_frequencies, body);
    const auto decays = data.part_of(data.decays, body), masses = data.part_of(data.masses, body);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const double ratio = even->stiffness_j * squares[i] / stiffness_of({frequencies[i], decays[i], masses[i]});
      per_tension[i] = network.body(body).sound_shape(i, static_cast<T>(ratio * shapes[i] / even->end_tension_n));
    }
    return per_tension;
  }

  [[nodiscard]] static bool is_of_places(OutputQuantity quantity) {
    return quantity != OutputQuantity::kForce && quantity != OutputQuantity::kTension;
  }
  // use(quantity, target): for each target of an output that is a place. The first of a pressure is a velocity.
  template <typename Use>
  static void for_each_place(const InstrumentData& data, Use use) {
    for (const InstrumentOutput& source : data.sources)
      for (std::size_t i = 0; is_of_places(source.quantity) && i < source.count; ++i)
        use(source.quantity == OutputQuantity::kPressure && i == 0 ? OutputQuantity::kVelocity : source.quantity,
            source.first_target + i);
  }

  std::vector<Pickup> pickups_;  // of the targets of outputs
  NetworkPressure<T> pressure_;
};

}  // namespace contactspline::detail
