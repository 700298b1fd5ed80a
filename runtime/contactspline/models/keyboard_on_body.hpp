// SPDX-License-Identifier: MIT
// A whole keyboard on its body: all strings end at one bridge and sound through it.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/modal/stiff_string.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/key_on_body.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/flush_denormals.hpp"
#include "contactspline/step/high_pass.hpp"
#include "contactspline/step/splice.hpp"

namespace contactspline {

/// The body of a KeyboardOnBody: its modes, with shapes at the bridge, at both ears and, unless it is empty, where
/// keys knock at the body.
struct BoardOfKeyboard {
  std::span<const Mode> modes;
  std::span<const double> bridge, left, right;
  Listening listening = {};
  std::span<const double> knock = {};
};

/// Struck strings on one body, with dampers and pedals; the output is a velocity for each ear [m/s] (Listening).
/// A key sleeps until it is struck, pressed, or lifted by the pedal while something sounds: then its strings join the
/// bridge, in sympathy with their modes below kSympathy_hz only. Modes that ring no more leave
/// (docs/how-it-works/keyboards.md). All functions but the constructor are safe on an audio thread: no allocation, no
/// lock, bounded time.
template <std::floating_point T>
class KeyboardOnBody {
 public:
  static constexpr double kSympathy_hz = detail::SoundingKey<T>::kSympathy_hz;

  /// The lowest `max_modes` modes below half the sample rate of each string. Allocates.
  KeyboardOnBody(std::span<const KeyOnBody<T>> keys, const BoardOfKeyboard& board, double sample_rate_hz,
                 std::size_t max_modes = 4096)
      : time_step_s_(1 / sample_rate_hz),
        body_(board.modes, ModeShapes<T>(board.bridge), stiffness_at_rest(keys), sample_rate_hz,
              ModeShapes<T>(board.knock)),
        left_(ear(board.left, board.listening.pickup_ratio)),
        right_(ear(board.right, board.listening.pickup_ratio)),
        mobility_(static_cast<T>(board.listening.mobility_m_per_n_s)),
        bridge_force_(kSplice_s, sample_rate_hz),
        high_pass_(board.listening.above_hz, sample_rate_hz, board.listening.quality) {
    keys_.reserve(keys.size());
    for (const KeyOnBody<T>& key : keys) keys_.emplace_back(key, sample_rate_hz, max_modes);
    awake_.reserve(keys.size());
    joined_.reserve(2 * keys.size());
    resting_.reserve(keys.size());
    struck_.reserve(keys.size());
  }

  /// Throws the hammer of a key, 0 to keys() - 1, at a speed [m/s], -1000 to 1000, and lifts its damper; at speed 0
  /// it is pressed without a blow. Other keys and speeds that are not a number do nothing.
  void strike(std::size_t key, T speed_m_per_s) {
    if (key >= keys_.size() || !is_number(speed_m_per_s)) return;
    if (speed_m_per_s == 0) return press(key);
    Key& struck = keys_[key];
    press(key);
    set_modes(key, struck.model.string().size());
    struck.prepare_strike(una_corda_, soft_ratio_, hammer_mass_ratio_, felt_);
    struck.model.strike(speed_m_per_s, HammerVoice<T>::kThrowDistance_m);
    body_.knock(knock_ratio_ * struck.controls.hammer_mass_kg * speed_m_per_s);
    struck.is_struck = sounds_ = true;
    wake_lifted();
  }

  /// Lifts the damper of a key, as a key does that is pressed without a sound.
  void press(std::size_t key) {
    if (key >= keys_.size()) return;
    keys_[key].is_down = true;
    move_damper(keys_[key]);
    wake_lifted();
  }

  /// Lowers the damper of a key, as far as the pedals allow.
  void release(std::size_t key) {
    if (key >= keys_.size()) return;
    keys_[key].is_down = false;
    move_damper(keys_[key]);
  }

  /// The sustain pedal: 0 up to 1 down, clamped. In between, the dampers damp with the fraction 1 - position.
  void sustain(double position) {
    sustain_ = held(sustain_, position, kPedal);
    for (Key& key : keys_) move_damper(key);
    wake_lifted();
  }

  /// The sostenuto pedal: while it is down, the dampers of the keys that were down when it went down stay up.
  void sostenuto(bool is_down) {
    if (is_down == std::exchange(is_sostenuto_, is_down)) return;
    for (Key& key : keys_) {
      key.is_held = is_down && key.is_down;
      move_damper(key);
    }
  }

  /// The soft pedal: 0 up to 1 down, clamped, from the next strikes on. It moves the hammers away from the last
  /// string of keys that have several, and to a softer part of the felts: their stiffness is multiplied by 1 +
  /// position (soft_ratio - 1).
  void una_corda(double position) { una_corda_ = held(una_corda_, position, kPedal); }

  /// Stiffness of the felts under the soft pedal, as a ratio, 1e-3 to 1, clamped; at first 1.
  void set_soft_ratio(double ratio) { soft_ratio_ = held(soft_ratio_, ratio, {1e-3, 1}); }

  /// Hammers and felts of all keys, from the next strikes on: mass as a ratio, stiffness as a ratio, loss [s/m].
  void set_hammers(T mass_ratio, const ContactControls<T>& felt) {
    hammer_mass_ratio_ = held(hammer_mass_ratio_, mass_ratio, {T(1e-6), T(1e6)});
    felt_ = held(felt_, felt);
  }

  /// The knock of key and action on the body, from the next strike on: its impulse as a ratio of the hammer's, 0 to
  /// 1000, clamped; at first 1.
  void set_knock(T ratio) { knock_ratio_ = held(knock_ratio_, ratio, {T(0), T(1000)}); }

  /// Moves the place at which a key's hammer strikes, from the end that does not move [m], from the next strike on;
  /// clamped to the string.
  void strike_at(std::size_t key, double position_m) {
    if (key < keys_.size()) keys_[key].strike_at(position_m);
  }

  /// Damping of a key's strings beside the damper's: extra decay of every mode [1/s], 0 to 1e5, clamped.
  void damp(std::size_t key, T damping_per_s) {
    if (key >= keys_.size()) return;
    T& extra = keys_[key].extra_damping_per_s;
    extra = held(extra, damping_per_s, ControlRanges<T>::damping_per_s);
  }

  /// Bends a key's strings, also while they sound, by a change of their tension: so many cents above their own pitch,
  /// -1200 to 1200, clamped. The bridge feels the new tension. A tension that rises does at most 1 W of work (saved
  /// up for 10 ms), so that strings that swing far follow later. A bend by more than a few cents at once can be
  /// noticed.
  void bend(std::size_t key, double cents) {
    if (key >= keys_.size()) return;
    keys_[key].cents = held(keys_[key].cents, cents, {-1200, 1200});
    follow_bend(keys_[key]);
  }

  /// Brings everything to rest and lets all keys go; the pedals stay.
  void reset() {
    for (Key& key : keys_) {
      key.rest();
      move_damper(key);
      key.damper.finish();
    }
    awake_.clear();
    joined_.clear();
    clock_ = next_check_ = 0;
    reset_body();
    for (Key& key : keys_) follow_bend(key);  // at once: nothing sounds
  }

  /// Advances left.size() samples and writes what each ear hears [m/s]; both spans must have the same size. The sound
  /// does not depend on where blocks are cut. force: unless it is empty, the largest contact force of any key [N].
  void process(std::span<T> left, std::span<T> right, std::span<T> force = {}) {
    const FlushDenormals flushed;
    for (std::size_t done = 0; done < left.size();) {
      const std::size_t samples = std::min(left.size() - done, kCheckInterval - clock_);
      process_steady(left.subspan(done, samples), right.subspan(done, samples),
                     force.empty() ? force : force.subspan(done, samples));
      done += samples;
    }
  }
  /// The same in mono: the mean of both.
  void process(std::span<T> out) {
    const FlushDenormals flushed;
    std::array<T, kCheckInterval> other;
    for (std::size_t done = 0; done < out.size();) {
      const std::size_t samples = std::min(out.size() - done, kCheckInterval - clock_);
      const auto left = out.subspan(done, samples), right = std::span(other).first(samples);
      process_steady(left, right, {});
      for (std::size_t n = 0; n < samples; ++n) left[n] = (left[n] + right[n]) / 2;
      done += samples;
    }
  }

  [[nodiscard]] std::size_t keys() const { return keys_.size(); }
  /// Number of keys that are computed, and of their modes.
  [[nodiscard]] std::size_t awake() const { return awake_.size(); }
  [[nodiscard]] std::size_t modes_awake() const {
    std::size_t modes = 0;
    for (const std::size_t key : awake_) modes += keys_[key].modes;
    return modes;
  }
  /// Contact force of a key's hammer over the last sample [N].
  [[nodiscard]] T force(std::size_t key) const { return keys_[key].model.force(); }
  [[nodiscard]] bool is_hammer_flying() const {
    return std::ranges::any_of(awake_, [&](std::size_t key) { return keys_[key].model.is_hammer_flying(); });
  }

  /// Energy of strings, bridge and body [J], without the hammers.
  [[nodiscard]] double energy() const {
    double energy = body_.energy();
    for (const std::size_t key : awake_)
      for (std::size_t i = 0; i < keys_[key].modes; ++i) energy += keys_[key].model.string().energy(i);
    return energy;
  }
  /// Number of contacts that have begun.
  [[nodiscard]] std::size_t contacts() const { return contacts_; }
  [[nodiscard]] const Body<T>& body() const { return body_; }
  /// How often it came to rest because body or strings were not finite.
  [[nodiscard]] std::size_t failures() const { return failures_; }

 private:
  using Key = detail::SoundingKey<T>;
  static constexpr std::size_t kLine = Key::kLine;
  static constexpr ControlRange<double> kPedal{0, 1};
  static constexpr std::size_t kCheckInterval = 32;  // samples, after each of which one key is checked
  static constexpr double kSilence_j = 1e-17;        // 130 dB below the blow of a C4 hammer at 0.4 m/s
  // What may leave, as a fraction of all energy: of a key that is damped, and of one that rings.
  static constexpr double kDampedFraction = 1e-7, kRingingFraction = 1e-12;
  static constexpr double kBodySilence_j = 1e-17;
  static constexpr double kSplice_s = 0.01;  // shorter than the ear tells two sounds apart

  static BridgeStiffness stiffness_at_rest(std::span<const KeyOnBody<T>> keys) {
    BridgeStiffness stiffness;
    for (const KeyOnBody<T>& key : keys) stiffness += {Key::ends_of(key), 0};
    return stiffness;
  }

  struct Joined {
    std::size_t key, first_mode, modes;
  };

  [[nodiscard]] bool is_lifted(const Key& key) const {
    return !key.has_damper || key.is_down || key.is_held || sustain_ > 0;
  }
  void move_damper(Key& key) { key.damper.move_to(key.is_down || key.is_held ? 0 : 1 - sustain_); }

  // Whatever has no damper on it rings in sympathy.
  void wake_lifted() {
    if (!sounds_) return;
    for (std::size_t key = 0; key < keys_.size(); ++key)
      if (is_lifted(keys_[key])) {
        keys_[key].checks = 0;
        if (keys_[key].modes < keys_[key].sympathetic) set_modes(key, keys_[key].sympathetic);
      }
  }

  void follow_bend(Key& key) {
    const double before = key.bend.cents(), w = double(body_.displacement());
    if (key.cents == before) return;
    const double energy =
        detail::tension_energy(key.string, std::span<const typename Key::Row>(key.rows).first(key.modes),
                               key.model.string()) +
        key.ends_n_per_m * w * w / 2;
    if (!key.bend.follow(key.cents, energy, static_cast<double>(samples_) * time_step_s_)) return;
    const double change = std::exp2(key.bend.cents() / 600) - std::exp2(before / 600);
    body_.retune({key.ends_n_per_m * change, 0}, 0);
    if (key.modes > 0) retune(key);
  }

  void retune(Key& key) {
    const double stiffness = key.stiffness_of(key.modes);
    const T force = key.model.bridge_force(key.bridge, 0, key.modes);
    key.retune();
    body_.retune({0, key.stiffness_of(key.modes) - stiffness},
                 key.model.bridge_force(key.bridge, 0, key.modes) - force);
  }

  void set_modes(std::size_t key, std::size_t modes) {
    Key& changed = keys_[key];
    if (changed.modes == 0) changed.retune();
    const std::size_t before = std::exchange(changed.modes, modes);
    if (modes > before) {
      (void)changed.model.follow(changed.bridge, before, modes, body_.change());
      body_.join(changed.stiffness_of(modes) - changed.stiffness_of(before));
      joined_.push_back({key, before, modes});  // does not allocate: at most twice for a key
      if (before == 0) awake_.insert(std::ranges::lower_bound(awake_, key), key);  // does not allocate
    } else if (modes < before) {
      const T force = changed.model.bridge_force(changed.bridge, modes, before);
      body_.leave(changed.stiffness_of(before) - changed.stiffness_of(modes), force);
      bridge_force_.ended(changed.output * force);
      if (modes == 0) std::erase(awake_, key);
    }
  }

  // A block in which no key joins or leaves.
  void process_steady(std::span<T> left, std::span<T> right, std::span<T> force) {
    if (!sounds_) {
      std::ranges::fill(left, T(0));
      std::ranges::fill(right, T(0));
      std::ranges::fill(force, T(0));
      return;
    }
    clock_ += left.size();
    samples_ += left.size();
    while (!left.empty()) {
      std::size_t samples = left.size();
      for (const std::size_t key : awake_) samples = std::min(samples, keys_[key].damper.samples());
      process_damped(left.first(samples), right.first(samples), force.empty() ? force : force.first(samples));
      for (const std::size_t key : awake_) keys_[key].damper.advance(samples);
      left = left.subspan(samples);
      right = right.subspan(samples);
      if (!force.empty()) force = force.subspan(samples);
    }
    if (clock_ == kCheckInterval) {
      clock_ = 0;
      for (const std::size_t key : awake_) keys_[key].is_struck = keys_[key].model.is_hammer_flying();
      for (Key& key : keys_) follow_bend(key);
      check();
    }
  }

  // A block in which no damper moves.
  void process_damped(std::span<T> left, std::span<T> right, std::span<T> forces) {
    resting_.clear();
    struck_.clear();
    for (const std::size_t k : awake_) {
      Key& key = keys_[k];
      key.controls.damping_per_s = static_cast<T>(key.damper.value()) + key.extra_damping_per_s;
      if (key.is_struck) {
        struck_.push_back(k);
      } else {
        resting_.push_back(key.model.on_bridge(
            key.bridge, key.modes, 1 / (1 + key.controls.damping_per_s * static_cast<T>(time_step_s_)), key.output));
      }
    }
    for (std::size_t n = 0; n < left.size(); ++n) {
      const T change = body_.change();
      detail::BridgeForces<T> forces_n =
          detail::advance_strings<T>(std::span<const detail::StringsOnBridge<T>>(resting_), change);
      T largest = 0;
      for (const std::size_t k : struck_) {
        Key& key = keys_[k];
        const T force = key.model.tick(key.controls, key.bridge, change);
        forces_n.all += force;
        forces_n.output += key.output * force;
        const bool touches = key.model.force() > 0;
        contacts_ += touches && !std::exchange(key.touches, touches);
        key.touches = touches;
        largest = std::max(largest, key.model.force());
      }
      if (!forces.empty()) forces[n] = largest;
      body_.tick(forces_n.all);
      begin_joined();
      const T direct = mobility_ * high_pass_.tick(bridge_force_.tick(forces_n.output));
      left[n] = direct + body_.modes().velocity(left_);
      right[n] = direct + body_.modes().velocity(right_);
    }
  }

  // Strings that have joined load the bridge with their mass from the first sample on. This step of their force does
  // not sound.
  void begin_joined() {
    for (const Joined& joined : joined_) {
      const Key& key = keys_[joined.key];
      bridge_force_.begins(key.output * key.model.bridge_force(key.bridge, joined.first_mode, joined.modes));
    }
    joined_.clear();
  }

  [[nodiscard]] typename ModalBank<T>::VelocityShapes ear(std::span<const double> place, double ratio) const {
    ModeShapes<T> shapes = body_.modes().sound_pickup(place);
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i] *= static_cast<T>(ratio);
    return body_.modes().velocity_shapes(shapes);
  }

  // Looks at one key, and at the body after all keys: what rings no more leaves.
  void check() {
    if (next_check_ == keys_.size()) {
      next_check_ = 0;
      const std::array<T, 1> w = {body_.displacement()};
      if (!all_finite(std::span<const T>(w))) return fail();
      body_j_ = body_.modes().energy();
      if (awake_.empty() && body_j_ < kBodySilence_j) reset_body();
      return;
    }
    const std::size_t k = next_check_++;
    Key& key = keys_[k];
    if (key.modes == 0 || key.is_struck || key.checks++ == 0) return;
    const double limit =
        std::max(kSilence_j, (is_lifted(key) ? kRingingFraction : kDampedFraction) * (body_j_ + stored_j_));
    double leaving = 0;
    std::size_t modes = key.modes;
    while (modes > 0) {
      const std::size_t first = (modes - 1) / kLine * kLine;
      double energy = 0;
      for (std::size_t i = first; i < modes; ++i) energy += key.model.string().energy(i);
      if (!(leaving + energy < limit)) break;
      leaving += energy;
      modes = first;
    }
    double energy = 0;
    for (std::size_t i = 0; i < modes; ++i) energy += key.model.string().energy(i);
    if (!all_finite(std::span<const double>(&energy, 1))) return fail();
    stored_j_ += energy - std::exchange(key.energy_j, energy);
    set_modes(k, modes);
  }

  void fail() {
    ++failures_;
    reset();
  }

  void reset_body() {
    body_.reset();
    bridge_force_.reset();
    high_pass_.reset();
    sounds_ = false;
    stored_j_ = body_j_ = 0;
  }

  double time_step_s_;
  Body<T> body_;
  typename ModalBank<T>::VelocityShapes left_, right_;
  T mobility_;
  Splice<T> bridge_force_;  // force of the strings, of which some join and leave
  HighPass<T> high_pass_;
  std::vector<Key> keys_;
  std::vector<std::size_t> awake_;   // numbers of the keys at the bridge, rising
  std::vector<std::size_t> struck_;  // of those with a hammer in flight
  std::vector<detail::StringsOnBridge<T>> resting_;
  std::vector<Joined> joined_;  // since the last sample
  std::size_t clock_ = 0, next_check_ = 0, failures_ = 0, contacts_ = 0;
  std::uint64_t samples_ = 0;
  double sustain_ = 0, una_corda_ = 0, soft_ratio_ = 1;
  T hammer_mass_ratio_ = 1, knock_ratio_ = 1;
  ContactControls<T> felt_ = {};
  bool is_sostenuto_ = false;
  bool sounds_ = false;
  double body_j_ = 0, stored_j_ = 0;  // of the body and of all keys, at their last checks
};

}  // namespace contactspline
