// SPDX-License-Identifier: MIT
// Modal resonators with exact poles, and their response at the places where a contact acts.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <type_traits>
#include <vector>

#include "contactspline/modal/mode.hpp"
#include "contactspline/simd/kernels.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// A bank of modes, advanced by the midpoint rule. Its mass, stiffness and resistance are chosen so that the poles
/// are exactly exp((-decay +- j w) dt) and the static compliance is that of the mode: the bank is passive, in tune
/// and exactly as compliant at every sample rate. For each sample call predict(), then push() for each force, then
/// commit(). No allocation after construction.
///
/// The state of a mode is its displacement q and its free increment d: the change of q over the next sample if no
/// force acts. A sample changes q by c = d + receptance shape f, and d becomes 2 c - d - (loss c + stiffness q). This
/// is the midpoint rule with the velocity eliminated (docs/how-it-works/modal.md). Only small numbers are added, so
/// single precision keeps 100 dB.
///
/// Modes: their number, if it is known at compile time: then the bank needs no heap, and g++ can construct it at
/// compile time (docs/how-to/microcontrollers.md).
template <std::floating_point T, std::size_t Modes = std::dynamic_extent>
class ModalBank {
 public:
  using Shapes = ModeShapes<T, Modes>;

  constexpr ModalBank(std::span<const Mode, Modes> modes, double sample_rate_hz)
      : sample_rate_hz_(sample_rate_hz),
        stiffness_(modes.size()),
        stiffness_rest_(modes.size()),
        loss_(modes.size()),
        receptance_(modes.size()),
        displacement_(modes.size()),
        free_increment_(modes.size()),
        change_(modes.size()) {
    if constexpr (Modes == std::dynamic_extent) constants_.resize(modes.size());
    for (std::size_t i = 0; i < modes.size(); ++i) set(i, modes[i]);
  }

  [[nodiscard]] constexpr std::size_t size() const { return displacement_.size(); }

  /// Change of displacement over one sample at place `at` per newton at place `of_force` [m/N]: the sum of
  /// receptance shape shape.
  [[nodiscard]] constexpr T receptance(const Shapes& at, const Shapes& of_force) const {
    return detail::sum_of<T>(size(), [&](std::size_t i) { return receptance_[i] * at[i] * of_force[i]; });
  }

  /// Change of displacement of one mode over one sample per newton [m/N].
  [[nodiscard]] constexpr T receptance(std::size_t mode) const { return receptance_[mode]; }

  /// Displacement at a place [m].
  [[nodiscard]] constexpr T displacement(const Shapes& at) const { return product(at, displacement_); }

  /// Velocity at a place [m/s]: that of the free motion of the modes, exact at every frequency. Modes that decay by
  /// more than a tenth per sample do not sound and are left out.
  [[nodiscard]] T velocity(const Shapes& at) const {
    return detail::sum_of<T>(size(), [&](std::size_t i) { return at[i] * static_cast<T>(velocity_of(i)); });
  }

  /// A place for velocity() in T: what a metre of each mode and of its free increment add [1/s].
  struct VelocityShapes {
    Shapes of_displacement, of_free_increment;
  };
  [[nodiscard]] VelocityShapes velocity_shapes(const Shapes& at) const {
    VelocityShapes shapes{Shapes(size()), Shapes(size())};
    write_velocity_shapes(at, shapes);
    return shapes;
  }
  /// The same without allocation; `shapes` has this size.
  void write_velocity_shapes(const Shapes& at, VelocityShapes& shapes) const {
    for (std::size_t i = 0; i < size(); ++i) {
      const auto [of_displacement, of_free_increment] = velocity_gains(constants_[i]);
      shapes.of_displacement[i] = static_cast<T>(double(at[i]) * of_displacement);
      shapes.of_free_increment[i] = static_cast<T>(double(at[i]) * of_free_increment);
    }
  }

  /// velocity() at a place that does not move, many times as fast.
  [[nodiscard]] T velocity(const VelocityShapes& at) const {
    return product(at.of_displacement, displacement_) + product(at.of_free_increment, free_increment_);
  }

  /// Shapes of a pickup for sound: each shape divided by what averaging takes away from its mode. A force that is
  /// constant over each sample excites a mode |1 - z|/|p dt| times as strongly as an impulse, and the contact force
  /// is itself an average over the sample, which takes away the same factor again. Use these shapes for sound.
  /// Do not use them for displacements that act back, nor for energies: the state itself needs no correction.
  [[nodiscard]] constexpr Shapes sound_pickup(const Shapes& pickup) const {
    Shapes shapes(size());
    for (std::size_t i = 0; i < size(); ++i) shapes[i] = sound_shape(i, pickup[i]);
    return shapes;
  }
  /// The same of one mode.
  [[nodiscard]] constexpr T sound_shape(std::size_t mode, T shape) const {
    constexpr double kMin = 0.40528473456935109;  // (2/pi)^2, the factor at half the sample rate
    return static_cast<T>(double(shape) / (std::max)(constants_[mode].averaging_factor, kMin));
  }
  [[nodiscard]] constexpr Shapes sound_pickup(std::span<const double, Modes> pickup) const {
    return sound_pickup(Shapes(pickup));
  }

  /// Begins a sample: the change of each mode is its free increment.
  void predict() { predict(0); }

  /// Begins a sample with a damper that acts on all modes equally. It is a viscous resistance, which multiplies each
  /// increment by the damping gain 1/(1 + damping); damping = extra decay [1/s] times dt, 0 to 1e5, and the last one
  /// if it is not a number. push() and receptance() do not apply this gain: multiply the forces of this sample and
  /// the receptances by it.
  void predict(T damping) {
    damping_ = held(damping_, damping, ControlRanges<T>::damping);
    const T damping_gain = 1 / (1 + damping_);
    T* __restrict change = change_.data();  // here and in push(): no other array of the loop overlaps this one
    for (std::size_t i = 0; i < size(); ++i) change[i] = damping_gain * free_increment_[i];
  }

  /// Change of displacement at a place over this sample [m], with the forces pushed so far.
  [[nodiscard]] T increment(const Shapes& at) const {
    return detail::sum_of<T>(size(), [&](std::size_t i) { return at[i] * change_[i]; });
  }

  /// Displacement at a place in the middle of this sample [m], with the forces pushed so far.
  [[nodiscard]] T middle(const Shapes& at) const {
    return detail::sum_of<T>(size(), [&](std::size_t i) { return at[i] * (displacement_[i] + change_[i] / 2); });
  }

  /// Adds a force [N] at a place for this sample.
  void push(const Shapes& at, T force) {
    T* __restrict change = change_.data();
    for (std::size_t i = 0; i < size(); ++i) change[i] += receptance_[i] * at[i] * force;
  }

  /// Free increments over the next sample at several places [m], each an array of ModeShapes::data(), without damper.
  /// Returns the sum of |free increment| over the modes: a place moves by at most this times its largest |shape|.
  T free_increments(std::span<const T* const> at, T* increments) const requires(Modes == std::dynamic_extent) {
    if (calls_kernel_for(size()))
      return detail::kernels<T>.sum_free_increments(size(), free_increment_.data(), at, increments);
    return detail::portable::sum_free_increments<T>(size(), free_increment_.data(), at, increments);
  }

  /// One whole sample with a damper, as in predict(), under forces [N] at several places. Then free_increments().
  /// `pushed` and `at`: arrays of ModeShapes::data().
  T advance(T damping, std::span<const T* const> pushed, const T* forces, std::span<const T* const> at,
            T* increments) requires(Modes == std::dynamic_extent) {
    damping_ = held(damping_, damping, ControlRanges<T>::damping);
    const T damping_gain = 1 / (1 + damping_);
    if (calls_kernel_for(size()))
      return detail::kernels<T>.advance_under_forces(arrays(), damping_gain, pushed, forces, at, increments);
    return detail::portable::advance_under_forces<T>(arrays(), damping_gain, pushed, forces, at, increments);
  }

  /// Sets the motion of a mode between two samples: its displacement [m] and its velocity in free motion [m/s].
  void set_motion(std::size_t mode, T displacement_m, T velocity_m_per_s) {
    const detail::ModeConstants& c = constants_[mode];
    const double one_minus_real = (c.loss + c.stiffness) / 2;  // 1 - Re z
    displacement_[mode] = displacement_m;
    const double q = double(displacement_m);
    free_increment_[mode] =
        static_cast<T>((double(velocity_m_per_s) + c.decay_per_s * q) / c.velocity_gain - one_minus_real * q);
  }

  /// Lets a mode follow its place of rest, which has moved by change_m over a sample and which shift() has not
  /// moved yet: it moves as fast, and is half a sample behind.
  void follow(std::size_t mode, T change_m) {
    displacement_[mode] = change_m / 2;
    free_increment_[mode] = change_m * (1 - stiffness_[mode] / 2);
  }
  [[nodiscard]] T displacement(std::size_t mode) const { return displacement_[mode]; }
  /// Displacement of each mode, and its change over the last sample [m].
  [[nodiscard]] constexpr std::span<const T> displacements() const { return {displacement_.data(), size()}; }
  [[nodiscard]] constexpr std::span<const T> changes() const { return {change_.data(), size()}; }
  /// Change of each mode over the next sample if no force and no damper acts [m].
  [[nodiscard]] constexpr std::span<const T> free_increments() const { return {free_increment_.data(), size()}; }

  /// Does a mode move, or is one displaced?
  [[nodiscard]] bool moves() const {
    for (std::size_t i = 0; i < size(); ++i)
      if (displacement_[i] != 0 || free_increment_[i] != 0) return true;
    return false;
  }

  /// Displacement of a mode per static force [m/N].
  [[nodiscard]] double compliance(std::size_t mode) const {
    const detail::ModeConstants& constants = constants_[mode];
    return constants.stiffness > 0 ? 2 * constants.receptance / constants.stiffness : 0;
  }

  /// Moves the places from which the modes count their displacements by rest times `by_m`, as the end of a string
  /// that moves does. The modes themselves stay.
  void shift(const Shapes& rest, T by_m) {
    for (std::size_t i = 0; i < size(); ++i) {
      const T by = rest[i] * by_m;
      displacement_[i] -= by;
      free_increment_[i] += stiffness_[i] * by;
    }
  }

  /// A mode that somebody else holds back by a spring [N/m] that pulls over two samples, at (q+ + 2 q + q-)/4, as a
  /// form does by which a body stretches (StretchForm): together they have the poles and the compliance of the mode.
  /// The spring is that of the mode, or weaker. Precondition: can_give_away_spring.
  void give_away_spring(std::size_t mode, double spring_n_per_m) {
    detail::ModeConstants constants = constants_[mode];
    const double gain = 1 / (1 - constants.receptance * spring_n_per_m / 2);
    constants.stiffness = (std::max)(gain * (constants.stiffness - 2 * constants.receptance * spring_n_per_m), 0.0);
    for (double* constant : {&constants.loss, &constants.receptance, &constants.one_plus_z_square}) *constant *= gain;
    take(mode, constants);
  }

  /// Changes frequencies and decays of the first modes between two samples, as a change of tension does. Masses,
  /// shapes and the number of modes stay. Each mode keeps its displacement and velocity, so energy() changes by the
  /// work of what changes the stiffness, m (w^2 + decay^2) q^2/2. Modes at half the sample rate and above come to
  /// rest. A change by more than a few cents at once can be noticed. Does nothing if a number is not finite. Does not
  /// allocate.
  void retune(std::span<const Mode, Modes> modes) {
    for (const auto& [w, decay, mass] : modes)
      if (const double values[] = {w, decay, mass}; !all_finite(std::span<const double>(values))) return;
    if constexpr (Modes == std::dynamic_extent)
      if (moves()) {
        for (std::size_t begin = 0; begin < modes.size(); begin += detail::RetunedModes::kMax)
          retune_some(begin, (std::min)(modes.size() - begin, detail::RetunedModes::kMax), modes.data() + begin);
        return;
      }
    for (std::size_t i = 0; i < modes.size(); ++i) retune_alone(i, modes[i]);
  }

  /// Ends the sample: updates displacements and free increments.
  void commit() {
    detail::commit_modes(size(), stiffness_.data(), stiffness_rest_.data(), loss_.data(), change_.data(),
                         displacement_.data(), free_increment_.data());
  }

  /// Advances one sample without force: predict(damping) and commit().
  void advance(T damping) {
    predict(damping);
    commit();
  }

  /// Kinetic plus potential energy [J]. In each sample it changes by the work of the forces minus dissipated(), exact
  /// up to rounding. The potential energy is that of the continuous mode, m (w^2 + decay^2) q^2/2.
  [[nodiscard]] double energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i) sum += energy(i);
    return sum;
  }

  /// The same of one mode [J].
  [[nodiscard]] double energy(std::size_t i) const {
    const detail::ModeConstants& mode = constants_[i];
    if (mode.receptance == 0) return 0;
    const double q = double(displacement_[i]);
    return kinetic_energy(i) + mode.stiffness / 4 * q * q / mode.receptance;
  }

  /// The kinetic part of energy() [J]: 0 at rest, also under a load that bends the modes.
  [[nodiscard]] double kinetic_energy() const {
    double sum = 0;
    for (std::size_t i = 0; i < size(); ++i)
      if (constants_[i].receptance > 0) sum += kinetic_energy(i);
    return sum;
  }

  /// Energy [J] that the losses of the modes and the damper dissipated in the last committed sample.
  [[nodiscard]] double dissipated() const {
    double energy = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      if (constants_[i].receptance == 0) continue;
      const double change = double(change_[i]);
      energy += (double(loss_[i]) / 2 + double(damping_)) * change * change / constants_[i].receptance;
    }
    return energy;
  }

  /// Response of each mode to a force at a place. Per newton during one sample, its displacement rises by receptance
  /// [m/N] and its free increment by free_increment_gain [m/N] at the end of the sample. amplitude_gain: amplitude of
  /// the oscillation at the place per metre of free increment, for a mode with displacement 0: shape / Im z.
  void respond(const Shapes& at, detail::ModalArray<T>& receptance, detail::ModalArray<T>& free_increment_gain,
               detail::ModalArray<T>& amplitude_gain) const {
    for (std::size_t i = 0; i < size(); ++i) {
      receptance[i] = receptance_[i] * at[i];
      free_increment_gain[i] = receptance[i] * (2 - loss_[i] - stiffness_[i]);
      const double stiffness = constants_[i].stiffness;
      const double one_minus_real = (constants_[i].loss + stiffness) / 2;           // 1 - Re z
      const double imaginary_square = stiffness - one_minus_real * one_minus_real;  // (Im z)^2
      amplitude_gain[i] = at[i] / static_cast<T>(std::sqrt((std::max)(imaginary_square, 1e-30)));
    }
  }

  /// The constants of a mode at the sample rate.
  [[nodiscard]] const detail::ModeConstants& constants(std::size_t mode) const { return constants_[mode]; }

  /// Pointers to the state and the constants, for the kernels.
  [[nodiscard]] detail::ModalArrays<T> arrays() {
    return {size(),
            stiffness_.data(),
            stiffness_rest_.data(),
            loss_.data(),
            receptance_.data(),
            displacement_.data(),
            free_increment_.data(),
            change_.data()};
  }

  /// Brings all modes to rest. Does not allocate.
  void reset() {
    displacement_.clear();
    free_increment_.clear();
    change_.clear();
  }

 private:
  // A call by the table takes longer than a loop over few modes, and than portable loops, which the compiler puts in
  // place.
  static bool calls_kernel_for(std::size_t modes) {
    constexpr std::size_t kFewModes = 4;
    return modes > kFewModes && detail::kernels<T>.are_vectorised();
  }

  static constexpr T product(const Shapes& weights, const detail::ModalArray<T, Modes>& state) {
    if constexpr (Modes == std::dynamic_extent)
      if (calls_kernel_for(weights.size()))
        return detail::kernels<T>.inner_product(weights.size(), weights.data(), state.data());
    return detail::sum_of<T>(weights.size(), [&](std::size_t i) { return weights[i] * state[i]; });
  }

  [[nodiscard]] double kinetic_energy(std::size_t i) const {
    const detail::ModeConstants& mode = constants_[i];
    const double weighted_step = double(free_increment_[i]) + mode.stiffness / 2 * double(displacement_[i]);
    return weighted_step * weighted_step / mode.one_plus_z_square / mode.receptance;
  }

  // Velocity of mode i at a pickup [m/s].
  [[nodiscard]] double velocity_of(std::size_t i) const {
    const auto [of_displacement, of_free_increment] = velocity_gains(constants_[i]);
    return of_free_increment * double(free_increment_[i]) + of_displacement * double(displacement_[i]);
  }

  struct VelocityGains {
    double of_displacement, of_free_increment;  // [1/s]
  };
  static VelocityGains velocity_gains(const detail::ModeConstants& mode) {
    constexpr double kMaxLoss = 0.19;  // 1 - 0.9^2: modes that decay faster have no velocity
    return mode.loss > kMaxLoss ? VelocityGains{0, 0} : exact_velocity_gains(mode);
  }
  static VelocityGains exact_velocity_gains(const detail::ModeConstants& mode) {
    const double one_minus_real = (mode.loss + mode.stiffness) / 2;  // 1 - Re z
    return {mode.velocity_gain * one_minus_real - mode.decay_per_s, mode.velocity_gain};
  }

  // A kernel retunes some together while they move. Where a decay changes, or takes so much that 1 - loss has lost
  // digits, each mode has exponential functions of its own; and where all rest, so that its constants are those of a
  // new bank.
  void retune_some(std::size_t begin, std::size_t count, const Mode* modes) {
    constexpr double kMaxLoss = 0.5;
    detail::RetunedModes retuned;
    retuned.time_step_s = 1 / sample_rate_hz_;
    retuned.modes = count;
    bool are_kept = true;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = begin + k;
      const detail::ModeConstants& before = constants_[i];
      are_kept = are_kept && before.decay_per_s == modes[k].decay_per_s && before.loss < kMaxLoss;
      retuned.angular_frequency_rad_per_s[k] = modes[k].angular_frequency_rad_per_s;
      retuned.decay_per_s[k] = modes[k].decay_per_s;
      retuned.mass_kg[k] = modes[k].mass_kg;
      retuned.loss[k] = before.loss;
      retuned.stiffness[k] = before.stiffness;
      retuned.velocity_gain[k] = before.velocity_gain;
      retuned.displacement[k] = double(displacement_[i]);
      retuned.free_increment[k] = double(free_increment_[i]);
    }
    for (std::size_t k = count; k < detail::in_whole_lines<double>(count); ++k) {
      retuned.angular_frequency_rad_per_s[k] = retuned.decay_per_s[k] = retuned.loss[k] = retuned.stiffness[k] = 0;
      retuned.mass_kg[k] = retuned.velocity_gain[k] = 1;
      retuned.displacement[k] = retuned.free_increment[k] = 0;
    }
    if (!are_kept) {
      for (std::size_t k = 0; k < count; ++k) retune_alone(begin + k, modes[k]);
      return;
    }
    detail::kernels<T>.retune(retuned);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = begin + k;
      take(i, modes[k],
           {.stiffness = retuned.stiffness[k],
            .loss = retuned.loss[k],
            .receptance = retuned.receptance[k],
            .averaging_factor = retuned.averaging_factor[k],
            .one_plus_z_square = retuned.one_plus_z_square[k],
            .velocity_gain = retuned.velocity_gain[k],
            .decay_per_s = modes[k].decay_per_s});
      free_increment_[i] = static_cast<T>(retuned.free_increment[k]);
      if (!(constants_[i].receptance > 0)) set_motion(i, 0, 0);
    }
  }

  void retune_alone(std::size_t i, const Mode& mode) {
    const T q = displacement_[i];
    const auto [of_displacement, of_free_increment] = exact_velocity_gains(constants_[i]);
    const auto velocity =
        static_cast<T>(of_free_increment * double(free_increment_[i]) + of_displacement * double(q));
    set(i, mode);
    const bool sounds = constants_[i].receptance > 0;
    set_motion(i, sounds ? q : T(0), sounds ? velocity : T(0));
  }

  constexpr void set(std::size_t i, const Mode& mode) {
    take(i, mode, detail::mode_constants(mode, sample_rate_hz_));
  }
  constexpr void take(std::size_t i, const Mode& mode, detail::ModeConstants constants) {
    // A mode above half the sample rate would sound at a wrong pitch. As in contactspline_modal.lib, no force drives
    // it.
    if (!(mode.angular_frequency_rad_per_s < std::numbers::pi * sample_rate_hz_)) constants.receptance = 0;
    take(i, constants);
  }
  constexpr void take(std::size_t i, const detail::ModeConstants& constants) {
    constants_[i] = constants;
    stiffness_[i] = static_cast<T>(constants.stiffness);
    stiffness_rest_[i] = static_cast<T>(constants.stiffness - static_cast<double>(stiffness_[i]));
    loss_[i] = static_cast<T>(constants.loss);
    receptance_[i] = static_cast<T>(constants.receptance);
  }

  double sample_rate_hz_;
  T damping_ = 0;  // of the current sample
  detail::ModalArray<T, Modes> stiffness_, stiffness_rest_, loss_, receptance_;
  detail::ModalArray<T, Modes> displacement_, free_increment_, change_;
  std::conditional_t<Modes == std::dynamic_extent, std::vector<detail::ModeConstants>,
                     std::array<detail::ModeConstants, Modes>>
      constants_{};
};

}  // namespace contactspline
