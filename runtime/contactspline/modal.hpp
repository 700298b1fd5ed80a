// SPDX-License-Identifier: MIT
// Modal resonators with exact poles, condensed to what a contact needs to know of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <new>
#include <numbers>
#include <span>
#include <vector>

#include "contactspline/kernels.hpp"

namespace contactspline {

/// One mode of a resonator: q'' + 2 decay q' + (angular_frequency^2 + decay^2) q = force / mass.
struct Mode {
  double angular_frequency_rad_per_s;  ///< of the damped oscillation, > 0
  double decay_per_s;                  ///< amplitude falls as exp(-decay t), >= 0
  double mass_kg;                      ///< modal mass for the shapes used, > 0
};

/// The modes of an emitted resonator.
template <typename Resonator>
inline constexpr auto modes_in = [] {
  std::array<Mode, Resonator::modes> modes{};
  for (std::size_t i = 0; i < Resonator::modes; ++i)
    modes[i] = {Resonator::angular_frequencies[i], Resonator::decays[i], Resonator::masses[i]};
  return modes;
}();

namespace detail {

/// Memory that begins on a cache line, so that vectors of any width lie within one.
template <typename T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kLine{64};

  CacheLineAllocator() = default;
  template <typename U>
  constexpr CacheLineAllocator(const CacheLineAllocator<U>&) {}

  [[nodiscard]] T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kLine)); }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, kLine); }
  friend bool operator==(CacheLineAllocator, CacheLineAllocator) { return true; }
};

/// Numbers of modes, followed by zeros up to a whole cache line: what runs over whole vectors needs no rest loop.
template <std::floating_point T>
class ModalArray {
 public:
  ModalArray() = default;
  static constexpr std::size_t kLine = 64 / sizeof(T);

  explicit ModalArray(std::size_t size) : size_(size), values_((size + kLine - 1) / kLine * kLine) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T operator[](std::size_t i) const { return values_[i]; }
  [[nodiscard]] T& operator[](std::size_t i) { return values_[i]; }
  [[nodiscard]] const T* data() const { return values_.data(); }
  [[nodiscard]] T* data() { return values_.data(); }
  void clear() { std::ranges::fill(values_, T(0)); }

 private:
  std::size_t size_ = 0;
  std::vector<T, CacheLineAllocator<T>> values_;
};

}  // namespace detail

/// Shapes of all modes at one place: the displacement there is the sum of shape times modal displacement.
template <std::floating_point T>
class ModeShapes {
 public:
  ModeShapes() = default;
  explicit ModeShapes(std::size_t modes) : values_(modes) {}
  explicit ModeShapes(std::span<const double> values) : values_(values.size()) {
    for (std::size_t i = 0; i < values.size(); ++i) values_[i] = static_cast<T>(values[i]);
  }

  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] T operator[](std::size_t mode) const { return values_[mode]; }
  [[nodiscard]] T& operator[](std::size_t mode) { return values_[mode]; }
  [[nodiscard]] const T* data() const { return values_.data(); }

 private:
  detail::ModalArray<T> values_;
};

namespace detail {

/// Constants of one mode at a sample rate (docs/modal.md). With z = exp((-decay + j w) dt):
struct ModeConstants {
  double stiffness;  ///< |1 - z|^2
  double loss;       ///< 1 - |z|^2
  double give;       ///< dt^2 |1 + z|^2 / (8 m), increment per unit of force [m/N]
};

inline ModeConstants mode_constants(const Mode& mode, double sample_rate_hz) {
  const double dt = 1 / sample_rate_hz;
  const double turn = mode.angular_frequency_rad_per_s * dt / 2;
  const double fall = std::exp(-mode.decay_per_s * dt);
  const double missing = -std::expm1(-mode.decay_per_s * dt);
  const double sine = std::sin(turn), cosine = std::cos(turn);
  return {missing * missing + 4 * fall * sine * sine, -std::expm1(-2 * mode.decay_per_s * dt),
          dt * dt * (missing * missing + 4 * fall * cosine * cosine) / (8 * mode.mass_kg)};
}

/// Sum over i < n of term(i) in eight running sums, which a compiler may keep in vector registers.
template <std::floating_point T, typename Term>
[[nodiscard]] T sum_of(std::size_t n, Term term) {
  constexpr std::size_t kLanes = 8;
  T sums[kLanes] = {};
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += term(i + lane);
  for (; i < n; ++i) sums[i % kLanes] += term(i);
  return ((sums[0] + sums[4]) + (sums[2] + sums[6])) + ((sums[1] + sums[5]) + (sums[3] + sums[7]));
}

}  // namespace detail

/// A bank of modes advanced by the midpoint rule with the stiffness and resistance that give it exactly the poles
/// exp((-decay +- j w) dt): passive, and in tune at any rate. Per sample: predict(), then any number of push(), then
/// commit(). No allocation after construction.
///
/// State per mode: displacement q and what q would change by in the coming sample if no force acted, d. A sample
/// changes q by c = d + give shape f, and leaves d <- 2 c - d - (loss c + stiffness q): the midpoint rule without
/// its velocity (docs/modal.md). All that is added is small, so that single precision keeps 100 dB.
template <std::floating_point T>
class ModalBank {
 public:
  ModalBank(std::span<const Mode> modes, double sample_rate_hz)
      : sample_rate_hz_(sample_rate_hz),
        stiffness_(modes.size()),
        stiffness_rest_(modes.size()),
        loss_(modes.size()),
        give_(modes.size()),
        displacement_(modes.size()),
        free_increment_(modes.size()),
        change_(modes.size()),
        spring_(modes.size()),
        resistance_(modes.size()),
        kinetic_(modes.size()) {
    for (std::size_t i = 0; i < modes.size(); ++i) set(i, modes[i]);
  }

  [[nodiscard]] std::size_t size() const { return displacement_.size(); }

  /// Change of displacement at a place [m] per force [N] at another over one sample: sum of give shape shape.
  [[nodiscard]] T admittance(const ModeShapes<T>& at, const ModeShapes<T>& of_force) const {
    return detail::sum_of<T>(size(), [&](std::size_t i) { return give_[i] * at[i] * of_force[i]; });
  }

  /// Displacement at a place [m].
  [[nodiscard]] T displacement(const ModeShapes<T>& at) const {
    return detail::sum_of<T>(size(), [&](std::size_t i) { return at[i] * displacement_[i]; });
  }

  /// Velocity at a place [m/s].
  [[nodiscard]] T velocity(const ModeShapes<T>& at) const {
    const T way = detail::sum_of<T>(size(), [&](std::size_t i) { return at[i] * static_cast<T>(this->way(i)); });
    return way * static_cast<T>(sample_rate_hz_);
  }

  /// Begins a sample: what each mode would do without force.
  void predict() { predict(0); }

  /// Begins a sample with a damper on all modes alike: each moves 1/(1 + damping) of the way it would, as by a
  /// viscous resistance; damping = extra decay [1/s] times dt, >= 0. Forces pushed in this sample give way by the
  /// same divisor, and so does admittance(): pass forces divided by 1 + damping.
  void predict(T damping) {
    damping_ = damping;
    const T share = 1 / (1 + damping);
    T* __restrict change = change_.data();  // as in push(): nothing else that is read or written lies there
    for (std::size_t i = 0; i < size(); ++i) change[i] = share * free_increment_[i];
  }

  /// Change of displacement at a place over this sample [m], with what has been pushed so far.
  [[nodiscard]] T increment(const ModeShapes<T>& at) const {
    return detail::sum_of<T>(size(), [&](std::size_t i) { return at[i] * change_[i]; });
  }

  /// Displacement at a place in the middle of this sample [m], with what has been pushed so far.
  [[nodiscard]] T middle(const ModeShapes<T>& at) const {
    return detail::sum_of<T>(size(), [&](std::size_t i) { return at[i] * (displacement_[i] + change_[i] / 2); });
  }

  /// Adds a force [N] at a place for this sample.
  void push(const ModeShapes<T>& at, T force) {
    T* __restrict change = change_.data();
    for (std::size_t i = 0; i < size(); ++i) change[i] += give_[i] * at[i] * force;
  }

  /// Ends the sample.
  void commit() {
    commit_all(size(), stiffness_.data(), stiffness_rest_.data(), loss_.data(), change_.data(), displacement_.data(),
               free_increment_.data());
  }

  /// A whole sample without force: predict(damping) and commit().
  void advance(T damping) {
    predict(damping);
    commit();
  }

  /// Kinetic and potential energy [J]; falls by what `loss` dissipates and rises by the work of the forces, exactly.
  [[nodiscard]] double energy() const {
    double energy = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      const double q = displacement_[i], w = way(i);
      energy += (w * w + spring_[i] * q * q) * kinetic_[i];
    }
    return energy;
  }

  /// Energy [J] that the modes' own losses and the damper dissipated in the sample just committed.
  [[nodiscard]] double dissipated() const {
    double energy = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      const double change = change_[i];
      energy += (static_cast<double>(loss_[i]) / 2 + damping_) * resistance_[i] * change * change * kinetic_[i];
    }
    return energy;
  }

  /// How a force at a place, per newton, changes each mode's displacement and free increment at the end of a sample;
  /// and how far, per metre of the latter, a mode at rest then swings there.
  void respond(const ModeShapes<T>& at, detail::ModalArray<T>& displacement, detail::ModalArray<T>& free_increment,
               detail::ModalArray<T>& swing) const {
    for (std::size_t i = 0; i < size(); ++i) {
      displacement[i] = give_[i] * at[i];
      free_increment[i] = displacement[i] * (2 - loss_[i] - stiffness_[i]);
      const double stiffness = static_cast<double>(stiffness_[i]) + static_cast<double>(stiffness_rest_[i]);
      const double pull = (static_cast<double>(loss_[i]) + stiffness) / 2;
      swing[i] = at[i] / static_cast<T>(std::sqrt(std::max(stiffness - pull * pull, 1e-30)));
    }
  }

  /// For the kernels.
  [[nodiscard]] detail::ModalArrays<T> arrays() {
    return {size(),       stiffness_.data(),    stiffness_rest_.data(),
            loss_.data(), displacement_.data(), free_increment_.data()};
  }

  void reset() {
    displacement_.clear();
    free_increment_.clear();
  }

 private:
  // Of mode i: velocity times dt [m], which the free increment lacks: it is w |1 + z|^2/4 - stiffness/2 q.
  [[nodiscard]] double way(std::size_t i) const {
    const double stiffness = static_cast<double>(stiffness_[i]) + stiffness_rest_[i];
    return (free_increment_[i] + stiffness / 2 * displacement_[i]) * resistance_[i] / 4;
  }

  // A function of its own: compilers believe __restrict of parameters.
  static void commit_all(std::size_t modes, const T* __restrict stiffness, const T* __restrict stiffness_rest,
                         const T* __restrict loss, const T* __restrict change, T* __restrict displacement,
                         T* __restrict free_increment) {
    for (std::size_t i = 0; i < modes; ++i) {
      const T moved = displacement[i] + change[i];
      T pull = loss[i] * change[i] + stiffness[i] * moved;
      if constexpr (kRounds) pull += stiffness_rest[i] * moved;
      displacement[i] = moved;
      free_increment[i] = (change[i] - free_increment[i]) + (change[i] - pull);
    }
  }

  void set(std::size_t i, const Mode& mode) {
    const auto [stiffness, loss, give] = detail::mode_constants(mode, sample_rate_hz_);
    // A mode above half the sample rate would sound at another pitch: nothing drives it, as in modal.lib.
    const bool audible = mode.angular_frequency_rad_per_s < std::numbers::pi * sample_rate_hz_;
    stiffness_[i] = static_cast<T>(stiffness);
    stiffness_rest_[i] = static_cast<T>(stiffness - static_cast<double>(stiffness_[i]));
    loss_[i] = static_cast<T>(loss);
    give_[i] = audible ? static_cast<T>(give) : T(0);
    // K dt^2/m = 4 |1 - z|^2/|1 + z|^2, R dt/m = 8 loss/|1 + z|^2, as of a damper 16 damping/|1 + z|^2, energy (w^2
    // + K dt^2/m q^2) m/(2 dt^2).
    const double nearness = 8 * give * mode.mass_kg * sample_rate_hz_ * sample_rate_hz_;  // |1 + z|^2
    spring_[i] = audible ? 4 * stiffness / nearness : 0;
    resistance_[i] = audible ? 16 / nearness : 0;
    kinetic_[i] = mode.mass_kg * sample_rate_hz_ * sample_rate_hz_ / 2;
  }

  // Are the constants rounded to T? Then the rest of the stiffness is kept beside it.
  static constexpr bool kRounds = std::numeric_limits<T>::digits < std::numeric_limits<double>::digits;

  double sample_rate_hz_;
  T damping_ = 0;  // of the sample under way
  detail::ModalArray<T> stiffness_, stiffness_rest_, loss_, give_;
  detail::ModalArray<T> displacement_, free_increment_, change_;
  detail::ModalArray<double> spring_, resistance_, kinetic_;
};

}  // namespace contactspline
