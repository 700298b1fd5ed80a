// SPDX-License-Identifier: MIT
// What the outputs of an instrument file hear of its network.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
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
  void prepare(const InstrumentData& data, double sample_rate_hz) {
    pickups_.assign(data.targets.size(), {});
    for_each_place(data, [&](OutputQuantity quantity, std::size_t target) {
      const std::size_t modes = data.modes_of(data.place_bodies[data.targets[target]]);
      pickups_[target].displacement = ModeShapes<T>(modes);
      if (quantity == OutputQuantity::kVelocity)
        pickups_[target].velocity = {ModeShapes<T>(modes), ModeShapes<T>(modes)};
    });
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
      // At the far end of a string a displacement is a force, which rises with the tension.
      const bool is_force = place >= data.place_bodies.size() - data.keyed.far_ends;
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
      else if (const ModalBank<T>& body = network.body(data.place_bodies[k]);
               source.quantity == OutputQuantity::kVelocity)
        sum += body.velocity(pickups_[i].velocity);
      else
        sum += body.displacement(pickups_[i].displacement);
    }
    return sum;
  }

 private:
  struct Pickup {
    ModeShapes<T> displacement;
    typename ModalBank<T>::VelocityShapes velocity;  // of velocities and pressures only
  };

  // use(quantity, target): for each target of an output that is a place. The first of a pressure is a velocity.
  template <typename Use>
  static void for_each_place(const InstrumentData& data, Use use) {
    for (const InstrumentOutput& source : data.sources)
      for (std::size_t i = 0; source.quantity != OutputQuantity::kForce && i < source.count; ++i)
        use(source.quantity == OutputQuantity::kPressure && i == 0 ? OutputQuantity::kVelocity : source.quantity,
            source.first_target + i);
  }

  std::vector<Pickup> pickups_;  // of the targets of outputs
  NetworkPressure<T> pressure_;
};

}  // namespace contactspline::detail
