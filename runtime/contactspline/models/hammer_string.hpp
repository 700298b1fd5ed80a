// SPDX-License-Identifier: MIT
// A felt hammer thrown at a string, or at any other modal resonator.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "contactspline/modal/modal.hpp"
#include "contactspline/models/strike_constants.hpp"
#include "contactspline/simd/kernels.hpp"
#include "contactspline/step/contact.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/memory.hpp"

namespace contactspline {

/// Live controls of the hammer-string model. The hammer's mass and felt are taken at the throw and hold until the
/// next one: a felt that hardens during contact, or a hammer that becomes heavier, would add energy. Their ranges are
/// those of ControlRanges (docs/reference/controls.md).
template <std::floating_point T>
struct HammerStringControls {
  T hammer_mass_kg;
  ContactControls<T> felt = {};  ///< stiffness ratio and loss
  T damping_per_s = 0;           ///< of the damper, at any time: extra decay of every mode
};

/// Strings at their bridge: what each mode adds to the force on it per displacement [N/m], and the displacement at
/// which the mode rests per displacement of the bridge: shape times compliance.
template <std::floating_point T, std::size_t Modes = std::dynamic_extent>
struct BridgeShapes {
  ModeShapes<T, Modes> shapes, rests;
};

/// A hammer in free flight in front of a resonator, which it strikes at one place. Several strings under one hammer
/// are one resonator: their modes side by side, each shape divided by the number of strings.
///
/// Modes: their number, if it is known at compile time: then the model needs no heap
/// (docs/how-to/microcontrollers.md), and process() is the loop of tick().
template <std::floating_point T, std::size_t Extent = std::dynamic_extent, std::size_t Modes = std::dynamic_extent>
class HammerString {
 public:
  using Shapes = ModeShapes<T, Modes>;

  /// memories: of the felt, as memories_of tells them. With memories process() is the loop of tick().
  constexpr HammerString(SegmentTable<T, Extent> felt, std::type_identity_t<std::span<const Mode, Modes>> modes,
                         Shapes strike, double sample_rate_hz, std::span<const Memory> memories = {})
      : felt_(felt),
        string_(modes, sample_rate_hz),
        strike_(modes.size()),
        next_strike_(std::move(strike)),
        constants_(felt, modes.size()),
        time_step_(T(1 / sample_rate_hz)),
        memory_(memories, sample_rate_hz) {}

  /// Moves the place of the strike, from the next throw on. Does nothing if a shape is not finite.
  void strike_at(const Shapes& strike) {
    if (!all_finite(std::span<const T>(strike.data(), strike.size()))) return;
    next_strike_ = strike;
    has_moved_ = true;
  }

  /// Changes frequencies and decays of the sounding string (ModalBank::retune), also in contact. What bridge()
  /// returned before no longer holds. Does not allocate.
  void retune(std::type_identity_t<std::span<const Mode, Modes>> modes) {
    string_.retune(modes);
    if (is_flying_)
      constants_.strike_at(string_, strike_);
    else
      has_moved_ = true;
  }

  /// Takes other memories of the felt from the next strike on. Does not allocate.
  void set_memories(std::span<const Memory> memories, double sample_rate_hz) {
    memory_ = ContactMemory<T>(memories, sample_rate_hz);
  }

  /// Throws the hammer at the string from a distance [m], 0 to 0.05, with a velocity [m/s], -1000 to 1000. The string
  /// may be sounding, and the felt remembers no blow. A hammer without velocity is stopped. Does nothing if one of
  /// them is not a number.
  void strike(T velocity_m_per_s, T distance_m) {
    if (!is_number(velocity_m_per_s) || !is_number(distance_m)) return;
    if (std::exchange(has_moved_, false)) {
      strike_ = next_strike_;
      constants_.strike_at(string_, strike_);
    }
    hammer_.compression_m = -held(T(0), distance_m, Ranges::throw_distance_m);
    hammer_.segment = segment_index(felt_, hammer_.compression_m);
    hammer_.velocity_m_per_s = held(T(0), velocity_m_per_s, Ranges::speed_m_per_s);
    std::ranges::fill(hammer_.crossed, 0);
    memory_.reset();
    is_thrown_ = is_flying_ = hammer_.velocity_m_per_s != 0;  // one without speed would hover for ever
  }

  /// Brings the string to rest and stops the hammer. Places and the last controls stay. Does not allocate.
  void reset() {
    string_.reset();
    hammer_ = {.mass_kg = hammer_.mass_kg, .felt = hammer_.felt};
    memory_.reset();
    is_thrown_ = is_flying_ = false;
  }

  /// Advances one sample. Safe in an audio thread: no allocation, no lock, bounded time.
  void tick(const HammerStringControls<T>& controls) {
    const T damping = take_damping(controls), damping_gain = 1 / (1 + damping);
    string_.predict(damping);
    hammer_.force_n = 0;
    if (is_flying_) {
      take(controls);
      collide(damping_gain);
    }
    string_.commit();
  }

  /// The same on a bridge, whose displacement changes by change_m, as Body::change() tells. The modes count
  /// their displacements from where the bridge would hold them at rest. Returns what Body::tick() takes [N]: the sum
  /// of shape times modal displacement. With ContactSpline::simd, string().dissipated() is not known after this, and
  /// the caller turns denormals off (FlushDenormals). Safe in an audio thread.
  T tick(const HammerStringControls<T>& controls, const BridgeShapes<T, Modes>& bridge, T change_m) {
    const T change = held(T(0), change_m, Ranges::displacement_m);
    if constexpr (Modes == std::dynamic_extent) {
      if (detail::kernels<T>.are_vectorised() && !is_flying_) {
        hammer_.force_n = 0;
        const auto strings = on_bridge(bridge, string_.size(), 1 / (1 + take_damping(controls)));
        return detail::kernels<T>.advance_on_bridge(std::span(&strings, 1), change).all;
      }
    }
    string_.shift(bridge.rests, change / 2);
    tick(controls);
    string_.shift(bridge.rests, change / 2);
    return string_.displacement(bridge.shapes);
  }

  /// The arrays for tick() on a bridge, from bridge_shape() of each mode [N/m].
  [[nodiscard]] BridgeShapes<T, Modes> bridge(const Shapes& shapes) const {
    BridgeShapes<T, Modes> bridge{shapes, Shapes(shapes.size())};
    for (std::size_t i = 0; i < shapes.size(); ++i)
      bridge.rests[i] = static_cast<T>(string_.compliance(i) * double(shapes[i]));
    return bridge;
  }

  /// The lowest `modes` modes on a bridge, for the kernel that advances many strings; while no hammer flies.
  [[nodiscard]] detail::StringsOnBridge<T> on_bridge(const BridgeShapes<T, Modes>& bridge, std::size_t modes,
                                                     T damping_gain, T weight = 1) {
    detail::ModalArrays<T> arrays = string_.arrays();
    arrays.modes = modes;
    return {arrays, bridge.shapes.data(), bridge.rests.data(), damping_gain, weight};
  }

  /// Lets modes first to last - 1 follow a bridge as strings without mass would, so that they bring no energy but
  /// that of their motion. change_m: Body::change(). Returns the stiffness that they add [N/m], for Body::join().
  double follow(const BridgeShapes<T, Modes>& bridge, std::size_t first, std::size_t last, T change_m) {
    for (std::size_t i = first; i < last; ++i) string_.follow(i, bridge.rests[i] * change_m);
    return stiffness_on(bridge, first, last);
  }

  /// Stiffness that modes first to last - 1 add to a bridge [N/m], for Body::leave(): the sum of shape^2/stiffness.
  [[nodiscard]] double stiffness_on(const BridgeShapes<T, Modes>& bridge, std::size_t first, std::size_t last) const {
    double sum = 0;
    for (std::size_t i = first; i < last; ++i) sum += double(bridge.shapes[i]) * double(bridge.rests[i]);
    return sum;
  }

  /// Force of modes first to last - 1 on a bridge [N], for Body::leave().
  [[nodiscard]] T bridge_force(const BridgeShapes<T, Modes>& bridge, std::size_t first, std::size_t last) const {
    T sum = 0;
    for (std::size_t i = first; i < last; ++i) sum += bridge.shapes[i] * string_.displacement(i);
    return sum;
  }

  /// Advances out.size() samples, writes the displacement at the pickup [m] after each and, unless `forces` is null,
  /// the contact forces [N]. Equals as many calls of tick(), but is many times as fast if ContactSpline::simd is
  /// linked. Safe in an audio thread.
  void process(const HammerStringControls<T>& controls, const Shapes& pickup, std::span<T> out, T* forces = nullptr) {
    if constexpr (Modes == std::dynamic_extent) {
      const Part part{this, &controls, &pickup, out, forces};
      if (detail::kernels<T>.are_vectorised() && memory_.empty()) return process_in_kernels({&part, 1});
    }
    for (T& sample : out) {
      tick(controls);
      sample = string_.displacement(pickup);
      if (forces != nullptr) *forces++ = force();
    }
  }

  /// A model and the arguments of its process().
  struct Part {
    HammerString* model;
    const HammerStringControls<T>* controls;
    const Shapes* pickup;
    std::span<T> out;
    T* forces = nullptr;
  };

  /// process() of several models, which must be different ones. ContactSpline::simd computes up to kMaxTogether side
  /// by side.
  static constexpr std::size_t kMaxTogether = detail::kMaxTogether;
  static void process_together(std::span<const Part> parts) {
    if constexpr (Modes == std::dynamic_extent) {
      const auto remembers = [](const Part& part) { return !part.model->memory_.empty(); };
      if (detail::kernels<T>.are_vectorised() && std::ranges::none_of(parts, remembers)) {
        for (; parts.size() > kMaxTogether; parts = parts.subspan(kMaxTogether))
          process_in_kernels(parts.first(kMaxTogether));
        return process_in_kernels(parts);
      }
    }
    for (const auto& [model, controls, pickup, out, forces] : parts) model->process(*controls, *pickup, out, forces);
  }

  /// Contact force over the last sample [N].
  [[nodiscard]] T force() const { return hammer_.force_n; }
  /// Compression of the felt [m], negative while apart.
  [[nodiscard]] T compression() const { return hammer_.compression_m; }
  /// Velocity of the hammer towards the string [m/s].
  [[nodiscard]] T hammer_velocity() const { return hammer_.velocity_m_per_s; }
  /// What the felt remembers of the blow.
  [[nodiscard]] const ContactMemory<T>& memory() const { return memory_; }
  /// True from a throw until the hammer is stopped.
  [[nodiscard]] bool is_hammer_flying() const { return is_flying_; }
  [[nodiscard]] const ModalBank<T, Modes>& string() const { return string_; }
  /// Energy of string, hammer and felt [J], with the controls of the next sample: a hammer takes them at its throw.
  /// One that is stopped has none.
  [[nodiscard]] double energy(const HammerStringControls<T>& controls) const {
    return string_.energy() + hammer_energy(controls);
  }
  /// The same of hammer and felt alone [J].
  [[nodiscard]] double hammer_energy(const HammerStringControls<T>& controls) const {
    if (!is_flying_) return 0;
    const double mass_kg =
        double(is_thrown_ ? held(hammer_.mass_kg, controls.hammer_mass_kg, Ranges::mass_kg) : hammer_.mass_kg);
    const double ratio =
        double(is_thrown_ ? held(hammer_.felt, controls.felt).stiffness_ratio : hammer_.felt.stiffness_ratio);
    const double velocity = double(hammer_.velocity_m_per_s);
    return mass_kg * velocity * velocity / 2 + ratio * double(memory_.energy(felt_, hammer_.compression_m));
  }

 private:
  using Ranges = ControlRanges<T>;

  void take(const HammerStringControls<T>& controls) {
    if (!std::exchange(is_thrown_, false)) return;
    hammer_.mass_kg = held(hammer_.mass_kg, controls.hammer_mass_kg, Ranges::mass_kg);
    hammer_.felt = held(hammer_.felt, controls.felt);
  }

  // The damping times dt.
  T take_damping(const HammerStringControls<T>& controls) {
    damping_per_s_ = held(damping_per_s_, controls.damping_per_s, Ranges::damping_per_s);
    return damping_per_s_ * time_step_;
  }

  // Up to kMaxTogether parts, none of which remembers.
  static void process_in_kernels(std::span<const Part> parts) requires(Modes == std::dynamic_extent) {
    detail::StruckVoice<T> struck[kMaxTogether];
    std::size_t count = 0;
    for (const Part& part : parts)
      if (part.model->is_flying_ && !part.out.empty()) struck[count++] = part.model->struck_voice(part);
    if (count > 0) detail::kernels<T>.process_struck(std::span(struck, count));
    const detail::StruckVoice<T>* voice = struck;
    for (const Part& part : parts)
      if (!part.out.empty()) part.model->process_rest(part, part.model->is_flying_ ? (voice++)->written : 0);
  }

  detail::StruckVoice<T> struck_voice(const Part& part) requires(Modes == std::dynamic_extent) {
    take(*part.controls);
    constants_.follow(felt_);
    const T damping_gain = 1 / (1 + take_damping(*part.controls));
    hammer_.last_increment_m = memory_.last_increment();
    return {constants_.view(string_.arrays(), felt_, strike_, time_step_, damping_gain, *part.pickup), &hammer_,
            part.out, part.forces};
  }

  // The samples after the first `written`, which the kernel of struck voices has computed: the string alone.
  void process_rest(const Part& part, std::size_t written) requires(Modes == std::dynamic_extent) {
    if (written > 0) memory_.set_last_increment(hammer_.last_increment_m);
    is_flying_ = is_flying_ && hammer_.compression_m > detail::kHammerStop_m<T>;
    const auto out = part.out.subspan(written);
    if (out.empty()) return;
    hammer_.force_n = 0;
    if (part.forces != nullptr) std::fill_n(part.forces + written, out.size(), T(0));
    detail::kernels<T>.process_free(string_.arrays(), 1 / (1 + take_damping(*part.controls)), part.pickup->data(),
                                    out);
  }

  // One sample of the contact between predict() and commit() of the string.
  void collide(T damping_gain) {
    const T velocity_per_force = time_step_ / hammer_.mass_kg;
    const T free_increment = time_step_ * hammer_.velocity_m_per_s - string_.increment(strike_);
    const T receptance = time_step_ * velocity_per_force / 2 + damping_gain * constants_.receptance_of_string();
    const Approach<T> approach{hammer_.compression_m, free_increment, receptance};
    const auto step = memory_.advance(felt_, hammer_.felt, time_step_, approach, hammer_.segment);
    string_.push(strike_, damping_gain * step.force);
    hammer_.force_n = step.force;
    hammer_.compression_m = step.compression;
    hammer_.segment = step.segment;
    hammer_.velocity_m_per_s -= velocity_per_force * step.force;
    is_flying_ = hammer_.compression_m > detail::kHammerStop_m<T>;
  }

  SegmentTable<T, Extent> felt_;
  ModalBank<T, Modes> string_;
  Shapes strike_, next_strike_;
  std::conditional_t<Modes == std::dynamic_extent, detail::StrikeConstantsStorage<T>,
                     detail::StrikeReceptance<T, Modes>>
      constants_;
  T time_step_;
  detail::HammerState<T> hammer_;
  ContactMemory<T> memory_;
  T damping_per_s_ = 0;
  bool has_moved_ = true;   // the place of the strike, or the tuning, since the last throw
  bool is_thrown_ = false;  // by strike(); the next sample takes the hammer's controls
  bool is_flying_ = false;
};

}  // namespace contactspline
