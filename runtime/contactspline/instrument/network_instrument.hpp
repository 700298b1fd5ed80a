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

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/data/pluck.hpp"
#include "contactspline/data/stroke.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/instrument/instrument_parts.hpp"
#include "contactspline/instrument/network_pickups.hpp"
#include "contactspline/instrument/network_strikes.hpp"
#include "contactspline/instrument/network_tuning.hpp"
#include "contactspline/instrument/played_by_events.hpp"
#include "contactspline/network/contact_network.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/version.hpp"

namespace contactspline {

/// Plays what InstrumentData describes. `contactspline generate` emits a class on top of it, with names for controls,
/// strikes and outputs (docs/reference/instruments.md). Meets Instrument. In single precision an instrument with
/// connections that are too stiff for it, or strained at rest, is computed in double precision
/// (docs/how-it-works/several-contacts.md).
template <std::floating_point T>
class NetworkInstrument : public PlayedByEvents<NetworkInstrument<T>> {
 public:
  using value_type = T;

  explicit NetworkInstrument(const InstrumentData& data)
      : data_(data), parts_(data), strikes_(data), plucks_(data.plucks.size()), strokes_(data.bows.size()) {
    for (const Parameter& parameter : data.parameters) values_.push_back(parameter.initial);
    for (std::size_t c = 0; c < data.controls.size(); ++c) {
      values_[c] = data.first_value(c);
      if (data.controls[c].quantity == ControlQuantity::kForce) pushing_.push_back(c);
    }
    for (std::size_t i = 0; i < data.preset_names.size(); ++i) {
      const auto values = data.preset_values.subspan(i * values_.size(), values_.size());
      presets_.push_back({data.preset_names[i], {values.begin(), values.end()}});
    }
    if (!data.keyed.tension_squares.empty()) tuning_ = detail::NetworkTuning<T>(data);
    is_waiting_.resize(data.controls.size());
    for (std::size_t k = 0; k < data.connections.size(); ++k)
      if (data.connections[k].roughness.height_m > 0 ||
          (data.connections[k].kind == ConnectionKind::kFriction && !is_of_bow(k)))
        rubbing_.push_back(k);
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
  [[nodiscard]] double input_scale_n() const { return data_.input_scale_n; }
  [[nodiscard]] const KeyedData& keyed() const { return data_.keyed; }

  /// Brings all bodies to rest at a sample rate; allocates. All below is safe on an audio thread.
  void prepare(double sample_rate_hz) {
    sample_rate_hz_ = sample_rate_hz;
    const NetworkPlan<T> plan = parts_.plan(data_);
    network_.emplace(plan, sample_rate_hz);
    network_->let_springs_sleep();
    for (const std::size_t k : rubbing_) rub(k);
    for (Stroke& stroke : strokes_) stroke.prepare(sample_rate_hz);
    strikes_.prepare(plan);
    std::ranges::fill(is_waiting_, 0);
    damper_.emplace(data_.keyed.damped, data_.keyed.damper_per_s, data_.body_ends.size(), sample_rate_hz);
    tuning_.restart();
    for (std::size_t c = 0; c < data_.controls.size(); ++c)
      if (data_.controls[c].quantity == ControlQuantity::kDamping)
        apply(data_.controls[c], static_cast<T>(values_[c]));
    pickups_.prepare(data_, *network_, sample_rate_hz);
    pickups_.measure(data_, *network_, tuning_);
    if constexpr (kRounds) prepare_in_double(sample_rate_hz);
    reset();
  }

  /// Sets a parameter: a control in the unit of its quantity, the speed of a strike or the force of a pluck. The
  /// value is moved into its range; one that is not a number does nothing. Where it acts at the next note, it waits
  /// for a strike, pluck or bow: a mass for its own next throw.
  void set(std::size_t parameter, double value) {
    const double next = held(values_[parameter], value, data_.range_of(parameter));
    if (next == values_[parameter]) return;
    values_[parameter] = next;
    if (in_double_) in_double_->set(parameter, next);
    if (parameter == data_.keyed.bend) tuning_.shift(next);
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
    if (strike >= strikes_.size() || !is_number(speed_m_per_s)) return;
    apply_waiting(strikes_.thrown(strike));
    work_of_strikes_ += strikes_.strike(*network_, strike, speed_m_per_s);
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

  /// Begins a stroke of a bow, 0 to the number of bows - 1, with an acceleration [m/s^2]: its friction is pressed by
  /// its normal force, and its surface comes up to its speed, in the other direction than the stroke before. While
  /// the bow is down the stroke goes on. 0 or less lifts the bow; one that is not a number does nothing.
  void bow(std::size_t bow, T acceleration_m_per_s2) {
    if (in_double_) return in_double_->bow(bow, double(acceleration_m_per_s2));
    if (bow >= strokes_.size() || !is_number(acceleration_m_per_s2)) return;
    if (!(acceleration_m_per_s2 > 0)) return strokes_[bow].lift();
    apply_waiting({});
    strokes_[bow].begin(double(acceleration_m_per_s2));
    damper_->lift();
  }

  /// Tunes a string, which is a body, with those tuned with it, or all strings by a change of tension, beside the
  /// bend. One that rises under load does at most 1 W of work.
  void tune(double cents, std::size_t string = kAllStrings) {
    if (in_double_) in_double_->tune(cents, string);
    tuning_.tune(cents, string);
  }

  /// Advances one sample, in which an input pushes its places [N], -1000 to 1000; not a number: it does not. Safe on
  /// an audio thread: no allocation, no lock, bounded time.
  void tick(T input_n = 0) {
    if (in_double_) return in_double_->tick(double(input_n));
    work_of_strikes_ += strikes_.stop_the_distant(*network_);
    if (tuning_.is_tunable()) follow_tuning();
    damper_->follow(*network_);
    last_work_of_strikes_ = work_of_strikes_;
    work_of_strikes_ = 0;
    for (const auto& [place, force_n] : data_.holds) network_->hold(place, static_cast<T>(force_n));
    for (const std::size_t control : pushing_) push(control);
    for (const std::size_t place : data_.input_places) network_->push(place, input_n);
    for (std::size_t b = 0; b < strokes_.size(); ++b)
      if (strokes_[b].is_active()) stroke(b);
    network_->tick();
    pickups_.follow(*network_);
  }

  /// Advances a block and writes the outputs, each over its sample [m], [m/s], [N] or [Pa]; `force`: contact_force();
  /// `input`: of tick(), or empty.
  void process(Outputs<T> outputs, std::span<T> force = {}, std::span<const T> input = {}) {
    const std::size_t length = detail::block_length<T>(outputs, force);
    for (std::size_t n = 0; n < length; ++n) {
      tick(input.empty() ? T(0) : input[n]);
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

  /// An output over the last sample [m], [m/s], [N] or [Pa]. output: 0 to the number of outputs - 1.
  [[nodiscard]] T output(std::size_t output) const {
    if (in_double_) return static_cast<T>(in_double_->output(output));
    return pickups_.output(data_, *network_, output);
  }

  /// Sum of the forces of all contacts over the last sample [N].
  [[nodiscard]] T contact_force() const {
    if (in_double_) return static_cast<T>(in_double_->contact_force());
    T sum = 0;
    for (std::size_t k = 0; k < data_.connections.size(); ++k)
      if (data_.connections[k].kind == ConnectionKind::kContact) sum += network_->force(k);
    return sum;
  }

  /// Brings all bodies to rest, where the first values of the controls hold them. Controls stay: those that are not
  /// at their first value move the bodies from there. Does not allocate.
  void reset() {
    if (in_double_) in_double_->reset();
    network_->reset();
    pickups_.reset();
    tuning_.follow_now();
    strikes_.reset();
    for (Pluck& pluck : plucks_) pluck.stop();
    for (std::size_t b = 0; b < strokes_.size(); ++b) {
      strokes_[b].stop();
      move_bow(b, {0, 0});
    }
    this->let_keys_go();
    damper_->lift();
    work_of_strikes_ = last_work_of_strikes_ = 0;
  }
  /// Does no pluck, control or bow push, and is the energy below a limit [J], without masses that fly away for ever?
  [[nodiscard]] bool is_silent(double limit_j) const {
    if (in_double_) return in_double_->is_silent(limit_j);
    if (std::ranges::any_of(pushing_, [&](std::size_t control) { return pushes(control); })) return false;
    return !is_bowed() && have_controls_arrived() && energy() - strikes_.leaving_energy(*network_) < limit_j;
  }
  /// Does no pluck or bow push, and do loads hold all still, but for a kinetic energy below a limit [J], without such
  /// masses?
  [[nodiscard]] bool is_at_rest(double limit_j) const {
    if (in_double_) return in_double_->is_at_rest(limit_j);
    const double leaving_j = strikes_.leaving_energy(*network_), kinetic_j = network_->kinetic_energy() - leaving_j;
    return !is_bowed() && have_controls_arrived() && tuning_.has_arrived() && kinetic_j < limit_j &&
           is_held_by_loads(kinetic_j, energy() - leaving_j);
  }

  /// Energy of all bodies and connections [J]. Over a sample, with the strikes before it, it changes by work() -
  /// dissipated(), up to rounding.
  [[nodiscard]] double energy() const { return in_double_ ? in_double_->energy() : network_->energy(); }
  /// Work of forces, bows, moving gaps, stiffness controls and strikes: in the last sample, and of the strikes before
  /// it [J].
  [[nodiscard]] double work() const {
    return in_double_ ? in_double_->work() : network_->work() + last_work_of_strikes_;
  }
  /// Energy that bodies, dampers, contacts and springs dissipated in the last sample [J].
  [[nodiscard]] double dissipated() const { return in_double_ ? in_double_->dissipated() : network_->dissipated(); }
  /// Is a single-precision instrument computed in double precision? Then network() rests.
  [[nodiscard]] bool is_in_double() const { return in_double_ != nullptr; }
  [[nodiscard]] const ContactNetwork<T>& network() const { return *network_; }

 private:
  static constexpr bool kRounds = std::numeric_limits<T>::digits < std::numeric_limits<double>::digits;

  void prepare_in_double(double sample_rate_hz) {
    in_double_.reset();
    if (!parts_.needs_double(data_, *network_, sample_rate_hz)) return;
    in_double_ = std::make_unique<NetworkInstrument<double>>(data_);
    for (std::size_t p = 0; p < values_.size(); ++p) in_double_->set(p, values_[p]);
    tuning_.each([&](std::size_t string, double cents) { in_double_->tune(cents, string); });
    in_double_->prepare(sample_rate_hz);
  }

  // Has every pluck ended, and have gaps, places and stiffnesses arrived?
  [[nodiscard]] bool have_controls_arrived() const {
    return std::ranges::none_of(plucks_, &Pluck::is_active) && !network_->is_following();
  }

  void follow_tuning() {
    const auto work = tuning_.follow(*network_, sample_rate_hz_);
    if (!work) return;
    work_of_strikes_ += *work;
    pickups_.measure(data_, *network_, tuning_);
  }

  // Does a control push with another force than the one that holds its place at rest?
  [[nodiscard]] bool pushes(std::size_t control) const {
    return std::ranges::any_of(data_.targets_of(data_.controls[control]), [&](std::size_t place) {
      const auto hold = std::ranges::find(data_.holds, place, &HoldingForce::place);
      return values_[control] + (hold == data_.holds.end() ? 0 : hold->force_n) != 0;
    });
  }

  // Pushes by the force of a control and of its plucks.
  void push(std::size_t control) {
    double force_n = values_[control];
    for (std::size_t p = 0; p < plucks_.size(); ++p)
      if (data_.plucks[p] == control && plucks_[p].is_active())
        force_n = held(force_n, force_n + plucks_[p].next(), data_.range_of(control));
    if (force_n == 0) return;
    for (const std::size_t place : data_.targets_of(data_.controls[control]))
      network_->push(place, static_cast<T>(force_n));
  }

  [[nodiscard]] bool is_of_bow(std::size_t k) const {
    return std::ranges::any_of(data_.bows,
                               [k](const InstrumentBow& bow) { return bow.first <= k && k < bow.first + bow.count; });
  }
  // Is a bow on its string, or does another surface move that is pressed?
  [[nodiscard]] bool is_bowed() const {
    return std::ranges::any_of(strokes_, &Stroke::is_active) ||
           std::ranges::any_of(rubbing_, [this](std::size_t k) { return is_rubbed(k); });
  }
  [[nodiscard]] bool is_rubbed(std::size_t k) const {
    const InstrumentFriction& friction = parts_.connections[k].friction;
    const std::size_t contact = parts_.connections[k].roughness.height_m > 0 ? k : friction.pressed_by;
    const bool is_pressed =
        friction.normal_force_n != 0 || (contact != kNoConnection && network_->force(contact) > 0);
    return is_pressed && friction.surface_speed_m_per_s != 0;
  }

  // Moves a bow that is down or on its way up.
  void stroke(std::size_t b) {
    const InstrumentBow& bow = data_.bows[b];
    const InstrumentFriction& friction = parts_.connections[bow.first].friction;
    const double assistance = data_.assistance == kNoParameter ? 0 : values_[data_.assistance];
    const auto points = static_cast<double>(bow.count);
    auto motion =
        strokes_[b].next(points * friction.normal_force_n, friction.surface_speed_m_per_s, bow.limits, assistance);
    motion.force_n /= points;
    move_bow(b, motion);
  }
  void move_bow(std::size_t b, const Stroke::Motion& motion) {
    for (std::size_t k = data_.bows[b].first; k < data_.bows[b].first + data_.bows[b].count; ++k) {
      network_->set_normal_force(k, static_cast<T>(motion.force_n));
      network_->set_surface_speed(k, static_cast<T>(motion.speed_m_per_s));
    }
  }

  // Presses and moves the surfaces of a friction that is no bow, and moves that of a rough contact.
  void rub(std::size_t k) {
    const InstrumentFriction& friction = parts_.connections[k].friction;
    network_->set_normal_force(k, static_cast<T>(friction.normal_force_n));
    network_->set_surface_speed(k, static_cast<T>(friction.surface_speed_m_per_s));
  }

  void keep(const InstrumentControl& control, T value) {
    for (const std::size_t k : data_.targets_of(control)) parts_.set(control.quantity, k, value);
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
      if (control.quantity == ControlQuantity::kMass && !std::ranges::all_of(data_.targets_of(control), is_thrown))
        continue;
      is_waiting_[c] = false;
      has_changed = true;
      if (control.quantity == ControlQuantity::kPlace)
        for (const std::size_t place : data_.targets_of(control)) network_->put_place(place, *parts_.places_m[place]);
      else
        apply(control, static_cast<T>(values_[c]));
    }
    if (has_changed) work_of_strikes_ += network_->energy() - before;
  }

  void apply(const InstrumentControl& control, T value) {
    for (const std::size_t k : data_.targets_of(control)) {
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
          network_->move_place(k, *parts_.places_m[k]);
          break;
        case ControlQuantity::kMass: {
          const Mode mass{0, 0, double(value)};
          network_->retune(k, {&mass, 1});
          break;
        }
        case ControlQuantity::kNormalForce:
        case ControlQuantity::kSurfaceSpeed:
          if (!is_of_bow(k)) rub(k);
          break;
      }
    }
  }

  InstrumentData data_;
  detail::InstrumentParts<T> parts_;
  detail::NetworkStrikes<T> strikes_;
  detail::NetworkPickups<T> pickups_;
  double sample_rate_hz_ = 0;
  std::optional<ContactNetwork<T>> network_;
  std::vector<double> values_;        // of the parameters
  std::vector<std::size_t> pushing_;  // controls of forces
  std::vector<Pluck> plucks_;
  std::vector<Stroke> strokes_;       // of the bows
  std::vector<std::size_t> rubbing_;  // frictions that are no bows, and rough contacts
  std::vector<Preset> presets_;
  detail::NetworkTuning<T> tuning_;
  std::optional<detail::NetworkDamper<T>> damper_;
  std::vector<char> is_waiting_;  // of the controls: for the next note
  double work_of_strikes_ = 0, last_work_of_strikes_ = 0;
  std::unique_ptr<NetworkInstrument<double>> in_double_;
};

}  // namespace contactspline
