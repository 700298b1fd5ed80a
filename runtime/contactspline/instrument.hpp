// SPDX-License-Identifier: MIT
// An instrument that a file describes: a network of bodies and contacts with numbered controls, strikes and outputs.
#pragma once

#include "contactspline/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "contactspline/contact.hpp"
#include "contactspline/contact_network.hpp"
#include "contactspline/controls.hpp"
#include "contactspline/modal.hpp"
#include "contactspline/version.hpp"

namespace contactspline {

enum class ConnectionKind { kContact, kSpring, kLink };

/// A connection between two places, kGround for one that does not move.
struct InstrumentConnection {
  ConnectionKind kind;
  std::size_t first, second;
  std::size_t table = 0;  ///< of a contact
  double gap_m = 0;
  double weight = 1, loss_s_per_m = 0;                     ///< of a contact
  double stiffness_n_per_m = 0, resistance_n_s_per_m = 0;  ///< of a spring
};

/// What a control sets, with the objects it is for.
enum class ControlQuantity {
  kForce,           ///< on places [N]
  kDamping,         ///< extra decay of bodies [1/s]
  kStiffnessRatio,  ///< of contacts
  kLoss,            ///< of contacts [s/m]
  kGapShift,        ///< of connections: is added to their gaps [m]; the sum is moved into -0.1 to 0.1
  kStiffness,       ///< of springs [N/m]
  kResistance       ///< of springs [N s/m]
};

/// The values that a control of this quantity may take.
template <std::floating_point T>
[[nodiscard]] constexpr ControlRange<T> control_range(ControlQuantity quantity) {
  using Ranges = ControlRanges<T>;
  constexpr ControlRange<T> kRanges[] = {Ranges::force_n,
                                         Ranges::damping_per_s,
                                         Ranges::stiffness_ratio,
                                         Ranges::loss_s_per_m,
                                         Ranges::gap_m,
                                         Ranges::hand_stiffness_n_per_m,
                                         Ranges::resistance_n_s_per_m};  // in the order of ControlQuantity
  return kRanges[static_cast<std::size_t>(quantity)];
}

/// A control of the objects targets[first_target] to targets[first_target + count - 1].
struct InstrumentControl {
  ControlQuantity quantity;
  std::size_t first_target, count;
  double initial;
  double min = std::numeric_limits<double>::lowest(), max = std::numeric_limits<double>::max();
  double release_n = 0;  ///< of a force that plucks: what it rises to; 0 for a control without a pluck
};

/// The values that this control may take: those between its min and max that its quantity allows.
template <std::floating_point T>
[[nodiscard]] constexpr ControlRange<T> control_range(const InstrumentControl& control) {
  const auto [min, max] = control_range<double>(control.quantity);
  return {static_cast<T>(std::max(min, control.min)), static_cast<T>(std::min(max, control.max))};
}

enum class OutputQuantity { kDisplacement, kVelocity, kForce };

/// The sum of displacements or velocities of places, or of forces of connections, over such targets.
struct InstrumentOutput {
  OutputQuantity quantity;
  std::size_t first_target, count;
  double full_scale = 1;  ///< the value that plug-ins play as 1
};

/// What an instrument is made of, as views of arrays that must outlive the instrument. body_ends[b]: number of modes
/// of the bodies 0 to b. place_bodies: the body of each place. shapes: one place after the other; a place has one
/// shape for each mode of its body. table_ends[t]: number of segments of the tables 0 to t. strikes: for each strike
/// the body that it throws, a free mass.
struct InstrumentData {
  std::span<const double> angular_frequencies, decays, masses;
  std::span<const std::size_t> body_ends;
  std::span<const std::size_t> place_bodies;
  std::span<const double> shapes;
  std::span<const double> knots, energies, forces, half_curvatures;
  std::span<const std::size_t> table_ends;
  std::span<const InstrumentConnection> connections;
  std::span<const InstrumentControl> controls;
  std::span<const std::size_t> targets;
  std::span<const std::size_t> strikes;
  std::span<const InstrumentOutput> outputs;
};

/// Plays what InstrumentData describes. `contactspline generate` emits a class on top of it, with names for controls,
/// strikes and outputs (docs/instruments.md). No allocation after construction.
template <std::floating_point T>
class NetworkInstrument {
 public:
  using value_type = T;

  NetworkInstrument(const InstrumentData& data, double sample_rate_hz)
      : data_(data), parts_(data), network_(parts_.plan(data), sample_rate_hz) {
    for (const InstrumentControl& control : data.controls) {
      values_.push_back(first_value(control));
      if (control.quantity == ControlQuantity::kDamping) apply(control, values_.back());
    }
    pickups_.resize(data.targets.size());
    for (const InstrumentOutput& output : data.outputs)
      for (std::size_t i = 0; output.quantity != OutputQuantity::kForce && i < output.count; ++i) {
        const std::size_t place = data.targets[output.first_target + i];
        const ModalBank<T>& body = network_.body(data.place_bodies[place]);
        Pickup& pickup = pickups_[output.first_target + i];
        pickup.displacement = body.sound_pickup(Parts::shapes_of(data, place));
        if (output.quantity == OutputQuantity::kVelocity) pickup.velocity = body.velocity_shapes(pickup.displacement);
      }
  }
  NetworkInstrument(const NetworkInstrument&) = delete;
  NetworkInstrument& operator=(const NetworkInstrument&) = delete;

  /// Sets a control, 0 to the number of controls - 1, in the unit of its quantity. The value is moved into its
  /// control_range; one that is not a number does nothing.
  void set_control(std::size_t control, T value) {
    const T next = held(values_[control], value, control_range<T>(data_.controls[control]));
    if (next == values_[control]) return;
    values_[control] = next;
    apply(data_.controls[control], next);
  }
  /// The value of a control, 0 to the number of controls - 1, within its control_range.
  [[nodiscard]] T control(std::size_t control) const { return values_[control]; }

  /// Puts the mass of a strike, 0 to the number of strikes - 1, back to displacement 0, with a velocity [m/s], which
  /// is moved into -1000 to 1000. A velocity that is not a number does nothing.
  void strike(std::size_t strike, T speed_m_per_s) {
    const double before = network_.energy();
    network_.set_motion(data_.strikes[strike], 0, speed_m_per_s);
    work_of_strikes_ += network_.energy() - before;
  }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick() {
    last_work_of_strikes_ = work_of_strikes_;
    work_of_strikes_ = 0;
    for (std::size_t i = 0; i < data_.controls.size(); ++i) {
      const InstrumentControl& control = data_.controls[i];
      if (control.quantity != ControlQuantity::kForce || values_[i] == 0) continue;
      for (const std::size_t place : targets_of(control)) network_.push(place, values_[i]);
    }
    network_.tick();
  }

  /// Advances samples.size() samples and writes one output of each. output: 0 to the number of outputs - 1.
  void process(std::span<T> samples, std::size_t output = 0) {
    for (T& sample : samples) {
      tick();
      sample = this->output(output);
    }
  }

  /// An output over the last sample [m], [m/s] or [N]. output: 0 to the number of outputs - 1.
  [[nodiscard]] T output(std::size_t output) const {
    const InstrumentOutput& of = data_.outputs[output];
    T sum = 0;
    for (std::size_t i = of.first_target; i < of.first_target + of.count; ++i) sum += output_of(of.quantity, i);
    return sum;
  }

  /// Sum of the forces of all contacts over the last sample [N].
  [[nodiscard]] T contact_force() const {
    T sum = 0;
    for (std::size_t k = 0; k < data_.connections.size(); ++k)
      if (data_.connections[k].kind == ConnectionKind::kContact) sum += network_.force(k);
    return sum;
  }

  /// Brings all bodies to rest. Controls stay. Does not allocate.
  void reset() {
    network_.reset();
    work_of_strikes_ = last_work_of_strikes_ = 0;
  }

  /// Energy of all bodies and connections [J]. Over a sample, with the strikes before it, it changes by work() -
  /// dissipated(), up to rounding.
  [[nodiscard]] double energy() const { return network_.energy(); }
  /// Work of forces, moving gaps, stiffness controls and strikes: in the last sample, and of the strikes before it
  /// [J].
  [[nodiscard]] double work() const { return network_.work() + last_work_of_strikes_; }
  /// Energy that bodies, dampers, contacts and springs dissipated in the last sample [J].
  [[nodiscard]] double dissipated() const { return network_.dissipated(); }
  [[nodiscard]] const ContactNetwork<T>& network() const { return network_; }

 private:
  static T first_value(const InstrumentControl& control) {
    return held(T(0), static_cast<T>(control.initial), control_range<T>(control));
  }

  // What the network is built of, and what its controls have set so far.
  struct Parts {
    explicit Parts(const InstrumentData& data) : connections(data.connections.begin(), data.connections.end()) {
      for (std::size_t t = 0, j = 0; t < data.table_ends.size(); ++t) {
        std::vector<Segment<T>>& table = tables.emplace_back(1);
        for (; j < data.table_ends[t]; ++j)
          table.push_back({static_cast<T>(data.knots[j]), static_cast<T>(data.energies[j]),
                           static_cast<T>(data.forces[j]), static_cast<T>(data.half_curvatures[j])});
      }
      for (const InstrumentConnection& connection : connections) {
        gaps_m.push_back(static_cast<T>(connection.gap_m));
        ratios.push_back(1);
      }
      for (const InstrumentControl& control : data.controls)
        for (const std::size_t target : data.targets.subspan(control.first_target, control.count))
          set(control.quantity, target, first_value(control));
    }

    // Keeps a control of a connection.
    void set(ControlQuantity quantity, std::size_t target, T value) {
      switch (quantity) {
        case ControlQuantity::kStiffnessRatio:
          ratios[target] = value;
          break;
        case ControlQuantity::kLoss:
          connections[target].loss_s_per_m = double(value);
          break;
        case ControlQuantity::kGapShift:
          gaps_m[target] =
              held(gaps_m[target], static_cast<T>(connections[target].gap_m) + value, ControlRanges<T>::gap_m);
          break;
        case ControlQuantity::kStiffness:
          connections[target].stiffness_n_per_m = double(value);
          break;
        case ControlQuantity::kResistance:
          connections[target].resistance_n_s_per_m = double(value);
          break;
        case ControlQuantity::kForce:
        case ControlQuantity::kDamping:
          break;
      }
    }

    [[nodiscard]] ContactControls<T> contact(std::size_t k) const {
      return {ratios[k], static_cast<T>(connections[k].loss_s_per_m)};
    }

    static std::span<const double> shapes_of(const InstrumentData& data, std::size_t place) {
      std::size_t begin = 0;
      for (std::size_t p = 0; p < place; ++p) begin += modes_of(data, data.place_bodies[p]);
      return data.shapes.subspan(begin, modes_of(data, data.place_bodies[place]));
    }

    static std::size_t modes_of(const InstrumentData& data, std::size_t body) {
      return data.body_ends[body] - (body == 0 ? 0 : data.body_ends[body - 1]);
    }

    [[nodiscard]] NetworkPlan<T> plan(const InstrumentData& data) const {
      NetworkPlan<T> plan;
      std::vector<Mode> modes;
      for (std::size_t b = 0, i = 0; b < data.body_ends.size(); ++b) {
        modes.clear();
        for (; i < data.body_ends[b]; ++i)
          modes.push_back({data.angular_frequencies[i], data.decays[i], data.masses[i]});
        plan.add_body(modes);
      }
      for (std::size_t p = 0; p < data.place_bodies.size(); ++p)
        plan.add_place(data.place_bodies[p], shapes_of(data, p));
      for (std::size_t k = 0; k < connections.size(); ++k) {
        const InstrumentConnection& c = connections[k];
        if (c.kind == ConnectionKind::kContact)
          plan.add_contact(c.first, c.second, tables[c.table], gaps_m[k], contact(k), static_cast<T>(c.weight));
        else if (c.kind == ConnectionKind::kSpring)
          plan.add_spring(c.first, c.second, static_cast<T>(c.stiffness_n_per_m),
                          static_cast<T>(c.resistance_n_s_per_m), gaps_m[k]);
        else
          plan.add_rigid_link(c.first, c.second, gaps_m[k]);
      }
      return plan;
    }

    std::vector<InstrumentConnection> connections;
    std::vector<T> gaps_m, ratios;
    std::vector<std::vector<Segment<T>>> tables;
  };

  struct Pickup {
    ModeShapes<T> displacement;
    typename ModalBank<T>::VelocityShapes velocity;  // of velocity outputs only
  };

  [[nodiscard]] std::span<const std::size_t> targets_of(const InstrumentControl& control) const {
    return data_.targets.subspan(control.first_target, control.count);
  }

  [[nodiscard]] T output_of(OutputQuantity quantity, std::size_t target) const {
    const std::size_t k = data_.targets[target];
    if (quantity == OutputQuantity::kForce) return network_.force(k);
    const ModalBank<T>& body = network_.body(data_.place_bodies[k]);
    return quantity == OutputQuantity::kVelocity ? body.velocity(pickups_[target].velocity)
                                                 : body.displacement(pickups_[target].displacement);
  }

  void apply(const InstrumentControl& control, T value) {
    for (const std::size_t k : targets_of(control)) {
      parts_.set(control.quantity, k, value);
      switch (control.quantity) {
        case ControlQuantity::kForce:
          break;  // pushes in each sample
        case ControlQuantity::kDamping:
          network_.set_damping(k, value);
          break;
        case ControlQuantity::kStiffnessRatio:
        case ControlQuantity::kLoss:
          network_.set_contact(k, parts_.contact(k));
          break;
        case ControlQuantity::kGapShift:
          network_.set_gap(k, parts_.gaps_m[k]);
          break;
        case ControlQuantity::kStiffness:
        case ControlQuantity::kResistance:
          network_.set_spring(k, static_cast<T>(parts_.connections[k].stiffness_n_per_m),
                              static_cast<T>(parts_.connections[k].resistance_n_s_per_m));
          break;
      }
    }
  }

  InstrumentData data_;
  Parts parts_;
  ContactNetwork<T> network_;
  std::vector<T> values_;        // of the controls
  std::vector<Pickup> pickups_;  // of the targets of outputs
  double work_of_strikes_ = 0, last_work_of_strikes_ = 0;
};

}  // namespace contactspline
