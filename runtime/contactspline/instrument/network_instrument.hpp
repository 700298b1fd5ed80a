// SPDX-License-Identifier: MIT
// An instrument that a file describes: a network of bodies and contacts with numbered controls, strikes and outputs.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/network_tuning.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/instrument/pluck.hpp"
#include "contactspline/instrument/string_outputs.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/network/assembly.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/version.hpp"

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
  kResistance,      ///< of springs [N s/m]
  kPlace,           ///< where places are on their strings [m]
  kMass             ///< of free masses, from their next throw on [kg]
};

/// The values that a control of this quantity may take.
template <std::floating_point T>
[[nodiscard]] constexpr ControlRange<T> control_range(ControlQuantity quantity) {
  using Ranges = ControlRanges<T>;
  constexpr ControlRange<T> kRanges[] = {
      Ranges::force_n, Ranges::damping_per_s,          Ranges::stiffness_ratio,      Ranges::loss_s_per_m,
      Ranges::gap_m,   Ranges::hand_stiffness_n_per_m, Ranges::resistance_n_s_per_m, Ranges::place_m,
      Ranges::mass_kg};  // in the order of ControlQuantity
  return kRanges[static_cast<std::size_t>(quantity)];
}

/// A control of the objects targets[first_target] to targets[first_target + count - 1].
struct InstrumentControl {
  ControlQuantity quantity;
  std::size_t first_target, count;
};

enum class OutputQuantity { kDisplacement, kVelocity, kForce };

/// The sum of displacements or velocities of places, or of forces of connections, over such targets.
struct InstrumentOutput {
  OutputQuantity quantity;
  std::size_t first_target, count;
};

/// What an instrument is made of, as views of arrays that must outlive the instrument. body_ends[b]: number of modes
/// of the bodies 0 to b. place_bodies: the body of each place. shapes: one place after the other; a place has one
/// shape for each mode of its body. table_ends[t]: number of segments of the tables 0 to t. strikes: for each strike
/// the body that it throws, a free mass. plucks: for each pluck the control of its force. parameters: one for each
/// control, then the speed of each strike, then the force of each pluck, then sustain and bend where keys have them.
/// preset_values: for each preset a value for each parameter. wavenumbers: of the modes, 0 where the body is no
/// string [rad/m]; empty where no place moves. memory_ends[t]: number of memories of the tables 0 to t; empty if no
/// contact has a memory. license: SPDX identifier.
struct InstrumentData {
  const char *name, *description, *license;
  std::span<const double> angular_frequencies, decays, masses;
  std::span<const std::size_t> body_ends;
  std::span<const std::size_t> place_bodies;
  std::span<const double> shapes;
  std::span<const double> knots, energies, forces, half_curvatures;
  std::span<const std::size_t> table_ends;
  std::span<const InstrumentConnection> connections;
  std::span<const InstrumentControl> controls;
  std::span<const std::size_t> targets;
  std::span<const std::size_t> strikes, plucks;
  std::span<const InstrumentOutput> sources;
  std::span<const Parameter> parameters;
  std::span<const Event> events;
  std::span<const Output> outputs;
  KeyedData keyed = {};
  std::span<const char* const> preset_names = {};
  std::span<const double> preset_values = {};
  std::span<const double> wavenumbers = {};
  std::span<const Memory> memories = {};
  std::span<const std::size_t> memory_ends = {};
};

/// Plays what InstrumentData describes. `contactspline generate` emits a class on top of it, with names for controls,
/// strikes and outputs (docs/reference/instruments.md). Meets Instrument. In single precision an instrument with
/// connections that are too stiff for it is computed in double precision (docs/how-it-works/several-contacts.md).
template <std::floating_point T>
class NetworkInstrument : public PlayedByEvents<NetworkInstrument<T>> {
 public:
  using value_type = T;

  explicit NetworkInstrument(const InstrumentData& data) : data_(data), parts_(data), plucks_(data.plucks.size()) {
    for (const Parameter& parameter : data.parameters) values_.push_back(parameter.initial);
    for (std::size_t c = 0; c < data.controls.size(); ++c) values_[c] = first_value(data, c);
    for (std::size_t i = 0; i < data.preset_names.size(); ++i) {
      const auto values = data.preset_values.subspan(i * values_.size(), values_.size());
      presets_.push_back({data.preset_names[i], {values.begin(), values.end()}});
    }
    if (!data.keyed.tension_squares.empty()) tuning_ = {all_modes(data), data.keyed.tension_squares, data.body_ends};
    is_waiting_.resize(data.controls.size());
    for (std::size_t s = 0; s < data.strikes.size(); ++s) sides_.push_back(side_of(data, data.strikes[s]));
  }
  NetworkInstrument(const InstrumentData& data, double sample_rate_hz) : NetworkInstrument(data) {
    prepare(sample_rate_hz);
  }
  NetworkInstrument(const NetworkInstrument&) = delete;
  NetworkInstrument& operator=(const NetworkInstrument&) = delete;

  [[nodiscard]] const char* name() const { return data_.name; }
  [[nodiscard]] const char* description() const { return data_.description; }
  [[nodiscard]] const char* license() const { return data_.license; }
  [[nodiscard]] std::span<const Parameter> parameters() const { return data_.parameters; }
  [[nodiscard]] std::span<const Event> events() const { return data_.events; }
  [[nodiscard]] std::span<const Output> outputs() const { return data_.outputs; }
  [[nodiscard]] std::span<const Preset> presets() const { return presets_; }
  [[nodiscard]] const KeyedData& keyed() const { return data_.keyed; }

  /// Brings all bodies to rest at a sample rate; allocates. All below is safe on an audio thread.
  void prepare(double sample_rate_hz) {
    sample_rate_hz_ = sample_rate_hz;
    const NetworkPlan<T> plan = parts_.plan(data_);
    network_.emplace(plan, sample_rate_hz);
    throws_.clear();
    for (const std::size_t mass : data_.strikes) throws_.push_back(throw_of(plan, mass));
    is_flying_.assign(throws_.size(), 0);
    std::ranges::fill(is_waiting_, 0);
    damper_.emplace(data_.keyed.damped, data_.keyed.damper_per_s, data_.body_ends.size(), sample_rate_hz);
    tuning_.restart();
    for (std::size_t c = 0; c < data_.controls.size(); ++c)
      if (data_.controls[c].quantity == ControlQuantity::kDamping)
        apply(data_.controls[c], static_cast<T>(values_[c]));
    pickups_.assign(data_.targets.size(), {});
    for (const InstrumentOutput& source : data_.sources)
      for (std::size_t i = 0; source.quantity != OutputQuantity::kForce && i < source.count; ++i) {
        const std::size_t modes = Parts::modes_of(data_, data_.place_bodies[data_.targets[source.first_target + i]]);
        Pickup& pickup = pickups_[source.first_target + i];
        pickup.displacement = ModeShapes<T>(modes);
        if (source.quantity == OutputQuantity::kVelocity)
          pickup.velocity = {ModeShapes<T>(modes), ModeShapes<T>(modes)};
      }
    measure_pickups();
    if constexpr (kRounds) prepare_in_double(sample_rate_hz);
    reset();
  }

  /// Sets a parameter: a control in the unit of its quantity, the speed of a strike or the force of a pluck. The
  /// value is moved into its range; one that is not a number does nothing. Where it acts at the next note, it waits
  /// for a strike or pluck: a mass for its own next throw.
  void set(std::size_t parameter, double value) {
    const double next = held(values_[parameter], value, range_of(parameter));
    if (next == values_[parameter]) return;
    values_[parameter] = next;
    if (in_double_) in_double_->set(parameter, next);
    if (parameter == data_.keyed.bend) tune(key_cents_);
    if (parameter == data_.keyed.sustain && next < 0.5 && damper_) damper_->end_sustain();
    if (parameter >= data_.controls.size()) return;
    const InstrumentControl& control = data_.controls[parameter];
    keep(control, static_cast<T>(next));
    if (!network_ || in_double_) return;
    is_waiting_[parameter] = data_.parameters[parameter].acts == Acts::kAtNextNote;
    if (!is_waiting_[parameter]) apply(control, static_cast<T>(next));
  }
  [[nodiscard]] double value(std::size_t parameter) const { return values_[parameter]; }

  /// Throws the mass of a strike, 0 to the number of strikes - 1, from displacement 0, with all masses that springs
  /// and rigid links join to it. The velocity [m/s] is moved into -1000 to 1000; one that is not a number does
  /// nothing. Masses that it may meet and that nothing holds are put back, at rest. If something stands in the way at
  /// displacement 0, the throw begins where they touch.
  void strike(std::size_t strike, T speed_m_per_s) {
    if (in_double_) return in_double_->strike(strike, double(speed_m_per_s));
    if (strike >= throws_.size() || !is_number(speed_m_per_s)) return;
    const Throw& moved = throws_[strike];
    apply_waiting(moved.thrown.masses);
    const double before = network_->energy();
    for (const std::size_t mass : moved.returned) network_->set_motion(mass, 0, 0);
    for (const std::size_t mass : moved.thrown.masses) network_->set_motion(mass, 0, speed_m_per_s);
    if (const T start = free_start(moved); start != 0)
      for (const std::size_t mass : moved.thrown.masses) network_->set_motion(mass, start, speed_m_per_s);
    work_of_strikes_ += network_->energy() - before;
    is_flying_[strike] = !moved.thrown.is_held;
    damper_->lift();
  }
  /// Lowers the damper of the file's keys, unless the pedal holds it up.
  void release(std::size_t strike) {
    if (in_double_) return in_double_->release(strike);
    damper_->release(data_.keyed.sustain != kNoParameter && values_[data_.keyed.sustain] >= 0.5);
  }

  /// Plucks: adds a force that rises within rise_s and lets go to the control of the pluck, 0 to the number of plucks
  /// - 1.
  void pluck(std::size_t pluck, T force_n, double rise_s = kPluckRise_s) {
    if (in_double_) return in_double_->pluck(pluck, double(force_n), rise_s);
    if (pluck >= plucks_.size() || !is_number(force_n)) return;
    apply_waiting({});
    plucks_[pluck].begin(double(force_n), rise_s, sample_rate_hz_);
    damper_->lift();
  }

  /// Tunes all strings by a change of tension, beside the bend. One that rises under load does at most 1 W of work.
  void tune(double cents) {
    if (in_double_) in_double_->tune(cents);
    key_cents_ = cents;
    tuning_.tune(cents + (data_.keyed.bend == kNoParameter ? 0 : values_[data_.keyed.bend]));
  }

  /// Advances one sample. Safe on an audio thread: no allocation, no lock, bounded time.
  void tick() {
    if (in_double_) return in_double_->tick();
    stop_the_distant();
    if (tuning_.is_tunable()) follow_tuning();
    damper_->follow(*network_);
    last_work_of_strikes_ = work_of_strikes_;
    work_of_strikes_ = 0;
    for (std::size_t i = 0; i < data_.controls.size(); ++i)
      if (data_.controls[i].quantity == ControlQuantity::kForce) push(i);
    network_->tick();
  }

  /// Advances a block and writes the outputs, each over its sample [m], [m/s] or [N]; `force`: contact_force().
  void process(Outputs<T> outputs, std::span<T> force = {}) {
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (std::size_t n = 0; n < length; ++n) {
      tick();
      for (std::size_t o = 0; o < outputs.size(); ++o)
        if (!outputs[o].empty()) outputs[o][n] = output(o);
      if (!force.empty()) force[n] = contact_force();
    }
  }

  /// Advances samples.size() samples and writes one output. output: 0 to the number of outputs - 1.
  void process(std::span<T> samples, std::size_t output = 0) {
    for (T& sample : samples) {
      tick();
      sample = this->output(output);
    }
  }

  /// An output over the last sample [m], [m/s] or [N]. output: 0 to the number of outputs - 1.
  [[nodiscard]] T output(std::size_t output) const {
    if (in_double_) return static_cast<T>(in_double_->output(output));
    const InstrumentOutput& source = data_.sources[output];
    T sum = 0;
    for (std::size_t i = source.first_target; i < source.first_target + source.count; ++i)
      sum += output_of(source.quantity, i);
    return sum;
  }

  /// Sum of the forces of all contacts over the last sample [N].
  [[nodiscard]] T contact_force() const {
    if (in_double_) return static_cast<T>(in_double_->contact_force());
    T sum = 0;
    for (std::size_t k = 0; k < data_.connections.size(); ++k)
      if (data_.connections[k].kind == ConnectionKind::kContact) sum += network_->force(k);
    return sum;
  }

  /// Brings all bodies to rest. Controls stay. Does not allocate.
  void reset() {
    if (in_double_) in_double_->reset();
    network_->reset();
    tuning_.rest();
    std::ranges::fill(is_flying_, 0);
    for (Pluck& pluck : plucks_) pluck.stop();
    this->let_keys_go();
    damper_->lift();
    work_of_strikes_ = last_work_of_strikes_ = 0;
  }
  /// Does no pluck or control push, and is the energy below a limit [J], without masses that fly away for ever?
  [[nodiscard]] bool is_silent(double limit_j) const {
    if (in_double_) return in_double_->is_silent(limit_j);
    for (const Pluck& pluck : plucks_)
      if (pluck.is_active()) return false;
    for (std::size_t c = 0; c < data_.controls.size(); ++c)
      if (data_.controls[c].quantity == ControlQuantity::kForce && values_[c] != 0) return false;
    double energy_j = energy();
    for (std::size_t s = 0; s < sides_.size(); ++s)
      if (is_leaving(s)) energy_j -= network_->body(data_.strikes[s]).energy();
    return !network_->is_following() && energy_j < limit_j;
  }

  /// Energy of all bodies and connections [J]. Over a sample, with the strikes before it, it changes by work() -
  /// dissipated(), up to rounding.
  [[nodiscard]] double energy() const { return in_double_ ? in_double_->energy() : network_->energy(); }
  /// Work of forces, moving gaps, stiffness controls and strikes: in the last sample, and of the strikes before it
  /// [J].
  [[nodiscard]] double work() const {
    return in_double_ ? in_double_->work() : network_->work() + last_work_of_strikes_;
  }
  /// Energy that bodies, dampers, contacts and springs dissipated in the last sample [J].
  [[nodiscard]] double dissipated() const { return in_double_ ? in_double_->dissipated() : network_->dissipated(); }
  /// Is a single-precision instrument computed in double precision? Then network() rests.
  [[nodiscard]] bool is_in_double() const { return in_double_ != nullptr; }
  [[nodiscard]] const ContactNetwork<T>& network() const { return *network_; }

 private:
  static constexpr double kWholeMass[] = {1};
  static constexpr bool kRounds = std::numeric_limits<T>::digits < std::numeric_limits<double>::digits;
  // Largest slope of a force times admittance, of springs and of contacts, that single precision is trusted with.
  static constexpr double kMaxSpring = 100, kMaxContact = 1000;
  // A struck mass that nothing holds stops at this distance.
  static constexpr T kFarAway_m = 10;

  void prepare_in_double(double sample_rate_hz) {
    in_double_.reset();
    if (!is_too_stiff(sample_rate_hz)) return;
    in_double_ = std::make_unique<NetworkInstrument<double>>(data_);
    for (std::size_t p = 0; p < values_.size(); ++p) in_double_->set(p, values_[p]);
    in_double_->tune(key_cents_);
    in_double_->prepare(sample_rate_hz);
  }

  // The largest value that a quantity of connection k may have.
  [[nodiscard]] double largest(ControlQuantity quantity, std::size_t k, double in_file) const {
    for (std::size_t c = 0; c < data_.controls.size(); ++c)
      for (const std::size_t target : targets_of(data_.controls[c]))
        if (data_.controls[c].quantity == quantity && target == k) in_file = std::max(in_file, range_of(c).max);
    return in_file;
  }

  [[nodiscard]] bool is_too_stiff(double sample_rate_hz) const {
    for (std::size_t k = 0; k < data_.connections.size(); ++k) {
      const InstrumentConnection& c = data_.connections[k];
      const double admittance = network_->largest_admittance(k) + lightest(c, sample_rate_hz);
      if (c.kind == ConnectionKind::kSpring) {
        const double stiffness = largest(ControlQuantity::kStiffness, k, c.stiffness_n_per_m);
        const double resistance = largest(ControlQuantity::kResistance, k, c.resistance_n_s_per_m);
        if (admittance * (stiffness / 2 + resistance * sample_rate_hz) > kMaxSpring) return true;
      } else if (c.kind == ConnectionKind::kContact) {
        double half_curvature = 0;
        for (const Segment<T>& segment : parts_.tables[c.table])
          half_curvature = std::max(half_curvature, double(segment.half_curvature));
        const double ratio = c.weight * largest(ControlQuantity::kStiffnessRatio, k, 1);
        if (admittance * ratio * half_curvature > kMaxContact) return true;
      }
    }
    return false;
  }

  // What controls of masses may add to the admittance of a connection.
  [[nodiscard]] double lightest(const InstrumentConnection& connection, double sample_rate_hz) const {
    double added = 0;
    for (std::size_t c = 0; c < data_.controls.size(); ++c)
      for (const std::size_t mass : targets_of(data_.controls[c]))
        for (const std::size_t place : {connection.first, connection.second})
          if (data_.controls[c].quantity == ControlQuantity::kMass && place != kGround &&
              data_.place_bodies[place] == mass)
            added += (1 / range_of(c).min - 1 / *parts_.masses_kg[mass]) / (2 * sample_rate_hz * sample_rate_hz);
    return added;
  }

  // Displacement of thrown masses at which no contact is pressed further than at rest; 0 if there is none.
  [[nodiscard]] T free_start(const Throw& moved) const {
    T back = 0, forth = 0;
    for (const Throw::Contact& contact : moved.contacts) {
      const T pressed =
          network_->compression(contact.connection) - std::max(T(0), -network_->gap(contact.connection));
      (contact.is_first ? back : forth) = std::max(contact.is_first ? back : forth, pressed);
    }
    return back > 0 && forth > 0 ? T(0) : forth - back;
  }

  // Stops the masses that a strike has thrown and that have flown away.
  void stop_the_distant() {
    for (std::size_t s = 0; s < throws_.size(); ++s) {
      if (!is_flying_[s]) continue;
      const std::vector<std::size_t>& masses = throws_[s].thrown.masses;
      if (!(std::abs(network_->body(masses.front()).displacement(std::size_t{0})) > kFarAway_m)) continue;
      const double before = network_->energy();
      for (const std::size_t mass : masses) network_->stop(mass);
      work_of_strikes_ += network_->energy() - before;
      is_flying_[s] = 0;
    }
  }

  // The values that a parameter may take: those of its list that its quantity allows.
  [[nodiscard]] ControlRange<double> range_of(std::size_t parameter) const { return range_of(data_, parameter); }
  static ControlRange<double> range_of(const InstrumentData& data, std::size_t parameter) {
    const ControlRange<double>& listed = data.parameters[parameter].allowed;
    if (parameter >= data.controls.size()) return listed;
    const auto [min, max] = control_range<double>(data.controls[parameter].quantity);
    return {std::max(min, listed.min), std::min(max, listed.max)};
  }
  static double first_value(const InstrumentData& data, std::size_t control) {
    return held(0.0, data.parameters[control].initial, range_of(data, control));
  }

  static std::vector<Mode> all_modes(const InstrumentData& data) {
    std::vector<Mode> modes;
    for (std::size_t i = 0; i < data.masses.size(); ++i)
      modes.push_back({data.angular_frequencies[i], data.decays[i], data.masses[i]});
    return modes;
  }

  // 1 or -1: a mass touches others where it moves to this side only. 0: to both, or it is held.
  static int side_of(const InstrumentData& data, std::size_t mass) {
    bool touches[2] = {};
    for (const InstrumentConnection& c : data.connections)
      for (const std::size_t place : {c.first, c.second}) {
        if (place == kGround || data.place_bodies[place] != mass) continue;
        if (c.kind != ConnectionKind::kContact) return 0;
        touches[place == c.first ? 0 : 1] = true;
      }
    return touches[0] == touches[1] ? 0 : touches[0] ? 1 : -1;
  }

  // Does the mass of a strike move away from all that it could touch?
  [[nodiscard]] bool is_leaving(std::size_t strike) const {
    return static_cast<T>(sides_[strike]) * network_->body(data_.strikes[strike]).velocity(whole_mass_) < 0;
  }

  void follow_tuning() {
    const auto work = tuning_.follow(*network_, sample_rate_hz_);
    if (!work) return;
    work_of_strikes_ += *work;
    measure_pickups();
  }

  // Does not allocate.
  void measure_pickups() {
    for (const InstrumentOutput& source : data_.sources)
      for (std::size_t i = 0; source.quantity != OutputQuantity::kForce && i < source.count; ++i)
        measure_pickup(source.quantity, source.first_target + i);
  }
  // At the far end of a string a displacement is a force, which rises with the tension.
  void measure_pickup(OutputQuantity quantity, std::size_t target) {
    const std::size_t place = data_.targets[target], body = data_.place_bodies[place];
    const std::span<const double> shapes = Parts::shapes_of(data_, place);
    const bool is_force = place >= data_.place_bodies.size() - data_.keyed.far_ends;
    const std::size_t first_mode = data_.body_ends[body] - shapes.size();
    const ModalBank<T>& bank = network_->body(body);
    Pickup& pickup = pickups_[target];
    for (std::size_t i = 0; i < shapes.size(); ++i)
      pickup.displacement[i] = bank.sound_shape(
          i, static_cast<T>(is_force ? shapes[i] * tuning_.stiffness_ratio(first_mode + i) : shapes[i]));
    if (quantity == OutputQuantity::kVelocity) bank.write_velocity_shapes(pickup.displacement, pickup.velocity);
  }

  // Pushes by the force of a control and of its plucks.
  void push(std::size_t control) {
    double force_n = values_[control];
    for (std::size_t p = 0; p < plucks_.size(); ++p)
      if (data_.plucks[p] == control && plucks_[p].is_active())
        force_n = held(force_n, force_n + plucks_[p].next(), range_of(control));
    if (force_n == 0) return;
    for (const std::size_t place : targets_of(data_.controls[control]))
      network_->push(place, static_cast<T>(force_n));
  }

  void keep(const InstrumentControl& control, T value) {
    for (const std::size_t k : targets_of(control)) parts_.set(control.quantity, k, value);
  }

  // Applies the controls that wait for a note; those of masses only to masses that are thrown now. The work counts as
  // that of a strike.
  void apply_waiting(std::span<const std::size_t> thrown) {
    const double before = network_->energy();
    bool has_changed = false;
    for (std::size_t c = 0; c < data_.controls.size(); ++c) {
      const InstrumentControl& control = data_.controls[c];
      const auto is_thrown = [&](std::size_t mass) { return std::ranges::find(thrown, mass) != thrown.end(); };
      if (!is_waiting_[c]) continue;
      if (control.quantity == ControlQuantity::kMass && !std::ranges::all_of(targets_of(control), is_thrown))
        continue;
      is_waiting_[c] = false;
      has_changed = true;
      if (control.quantity == ControlQuantity::kPlace)
        for (const std::size_t place : targets_of(control)) network_->put_place(place, static_cast<T>(values_[c]));
      else
        apply(control, static_cast<T>(values_[c]));
    }
    if (has_changed) work_of_strikes_ += network_->energy() - before;
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
      places_m.resize(data.place_bodies.size());
      masses_kg.resize(data.body_ends.size());
      for (std::size_t c = 0; c < data.controls.size(); ++c)
        for (const std::size_t target : data.targets.subspan(data.controls[c].first_target, data.controls[c].count))
          set(data.controls[c].quantity, target, static_cast<T>(first_value(data, c)));
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
        case ControlQuantity::kPlace:
          places_m[target] = value;
          break;
        case ControlQuantity::kMass:
          masses_kg[target] = double(value);
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

    // Those of the numbers of all modes that belong to a body.
    static std::span<const double> part_of(const InstrumentData& data, std::span<const double> numbers,
                                           std::size_t body) {
      return numbers.subspan(data.body_ends[body] - modes_of(data, body), modes_of(data, body));
    }

    static std::size_t modes_of(const InstrumentData& data, std::size_t body) {
      return data.body_ends[body] - (body == 0 ? 0 : data.body_ends[body - 1]);
    }

    static std::span<const Memory> memories_of_table(const InstrumentData& data, std::size_t table) {
      if (data.memory_ends.empty()) return {};
      const std::size_t begin = table == 0 ? 0 : data.memory_ends[table - 1];
      return data.memories.subspan(begin, data.memory_ends[table] - begin);
    }

    [[nodiscard]] NetworkPlan<T> plan(const InstrumentData& data) const {
      NetworkPlan<T> plan;
      std::vector<Mode> modes;
      for (std::size_t b = 0, i = 0; b < data.body_ends.size(); ++b) {
        modes.clear();
        for (; i < data.body_ends[b]; ++i)
          modes.push_back({data.angular_frequencies[i], data.decays[i], data.masses[i]});
        if (masses_kg[b]) modes.front().mass_kg = *masses_kg[b];
        plan.add_body(modes);
      }
      for (std::size_t p = 0; p < data.place_bodies.size(); ++p) {
        const std::size_t body = data.place_bodies[p];
        if (places_m[p])
          plan.add_moving_place(body, part_of(data, data.wavenumbers, body), *places_m[p]);
        else
          plan.add_place(body, shapes_of(data, p));
      }
      for (std::size_t k = 0; k < connections.size(); ++k) {
        const InstrumentConnection& c = connections[k];
        if (c.kind == ConnectionKind::kContact)
          plan.add_contact(c.first, c.second, tables[c.table], gaps_m[k], contact(k), static_cast<T>(c.weight),
                           memories_of_table(data, c.table));
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
    std::vector<std::optional<T>> places_m;        // of the places that a control moves
    std::vector<std::optional<double>> masses_kg;  // of the bodies, where a control sets it
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
    if (quantity == OutputQuantity::kForce) return network_->force(k);
    const ModalBank<T>& body = network_->body(data_.place_bodies[k]);
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
          damper_->set(*network_, k, value);
          break;
        case ControlQuantity::kStiffnessRatio:
        case ControlQuantity::kLoss:
          network_->set_contact(k, parts_.contact(k));
          break;
        case ControlQuantity::kGapShift:
          network_->set_gap(k, parts_.gaps_m[k]);
          break;
        case ControlQuantity::kStiffness:
        case ControlQuantity::kResistance:
          network_->set_spring(k, static_cast<T>(parts_.connections[k].stiffness_n_per_m),
                               static_cast<T>(parts_.connections[k].resistance_n_s_per_m));
          break;
        case ControlQuantity::kPlace:
          network_->move_place(k, value);
          break;
        case ControlQuantity::kMass: {
          const Mode mass{0, 0, double(value)};
          network_->retune(k, {&mass, 1});
          break;
        }
      }
    }
  }

  InstrumentData data_;
  Parts parts_;
  double sample_rate_hz_ = 0;
  std::optional<ContactNetwork<T>> network_;
  std::vector<double> values_;  // of the parameters
  std::vector<Pluck> plucks_;
  std::vector<Pickup> pickups_;  // of the targets of outputs
  std::vector<Preset> presets_;
  detail::NetworkTuning<T> tuning_;
  std::optional<detail::NetworkDamper<T>> damper_;
  std::vector<int> sides_;  // of the strikes
  ModeShapes<T> whole_mass_{std::span<const double>(kWholeMass)};
  double key_cents_ = 0;          // of the key that is played
  std::vector<Throw> throws_;     // of the strikes
  std::vector<char> is_flying_;   // may what a strike has thrown still fly away?
  std::vector<char> is_waiting_;  // of the controls: for the next note
  double work_of_strikes_ = 0, last_work_of_strikes_ = 0;
  std::unique_ptr<NetworkInstrument<double>> in_double_;
};

}  // namespace contactspline
