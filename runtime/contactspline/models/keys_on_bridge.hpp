// SPDX-License-Identifier: MIT
// The keys of a keyboard at the places of a body's bridge: those that sound join it, those that sleep leave it.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "contactspline/modal/bend.hpp"
#include "contactspline/models/body.hpp"
#include "contactspline/models/key_on_body.hpp"
#include "contactspline/models/keyboard_sound.hpp"
#include "contactspline/simd/kernels.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

namespace detail {

/// Keys on a body, of which some are awake: at the bridge, with a number of their modes. No allocation after
/// construction.
template <std::floating_point T>
class KeysOnBridge {
 public:
  using Key = SoundingKey<T>;

  /// The lowest `max_modes` modes below half the sample rate of each string. Allocates.
  KeysOnBridge(std::span<const KeyOnBody<T>> keys, const BoardOfKeyboard& board, double sample_rate_hz,
               std::size_t max_modes)
      : time_step_s_(1 / sample_rate_hz),
        body_(board.modes, bridge_of(board), ends_of(keys, board.places()), sample_rate_hz,
              ModeShapes<T>(board.knock)),
        sound_(body_, board, sample_rate_hz) {
    keys_.reserve(keys.size());
    for (const KeyOnBody<T>& key : keys) keys_.emplace_back(key, sample_rate_hz, max_modes);
    awake_.reserve(keys.size());
    joined_.reserve(2 * keys.size());
    resting_.reserve(keys.size());
    groups_.reserve(body_.places());
    struck_.reserve(keys.size());
    longitudinal_.reserve(keys.size());
  }

  [[nodiscard]] std::span<Key> keys() { return keys_; }
  [[nodiscard]] std::span<const Key> keys() const { return keys_; }
  [[nodiscard]] Key& key(std::size_t number) { return keys_[number]; }
  [[nodiscard]] const Key& key(std::size_t number) const { return keys_[number]; }
  /// Numbers of the keys at the bridge, place by place, rising.
  [[nodiscard]] std::span<const std::size_t> awake() const { return awake_; }
  [[nodiscard]] Body<T>& body() { return body_; }
  [[nodiscard]] const Body<T>& body() const { return body_; }
  /// Number of contacts that have begun.
  [[nodiscard]] std::size_t contacts() const { return contacts_; }

  /// Puts the lowest `modes` modes of a key at the bridge, and only these.
  void set_modes(std::size_t key, std::size_t modes) {
    Key& changed = keys_[key];
    if (changed.modes == 0) changed.retune();
    const std::size_t before = std::exchange(changed.modes, modes);
    if (modes > before) {
      (void)changed.model.follow(changed.bridge, before, modes, body_.change(changed.bridge_place));
      body_.join(changed.stiffness_of(modes) - changed.stiffness_of(before), changed.bridge_place);
      joined_.push_back({key, before, modes});  // does not allocate: at most twice for a key
      if (before == 0) wake(key);
    } else if (modes < before) {
      const T force = changed.model.bridge_force(changed.bridge, modes, before);
      body_.leave(changed.stiffness_of(before) - changed.stiffness_of(modes), force, changed.bridge_place);
      sound_.ended(changed.output * force);
      if (modes > 0) return;
      sound_.ended(changed.rest_longitudinally());
      std::erase(awake_, key);
    }
  }

  /// Lets the strings of a key that is awake move along themselves, until it sleeps.
  void move_longitudinally(std::size_t key) { sound_.begins(keys_[key].move_longitudinally()); }

  /// Lets the tension of a key's strings follow its bend, as far as it may at the time now_s.
  void follow_bend(Key& key, double now_s) {
    const double before = key.bend.cents(), w = double(body_.displacement(key.bridge_place));
    if (key.cents == before) return;
    const double energy = key.tension_energy() + key.ends_n_per_m * w * w / 2;
    if (!key.bend.follow(key.cents, energy, now_s)) return;
    const double change = std::exp2(key.bend.cents() / 600) - std::exp2(before / 600);
    body_.retune({key.ends_n_per_m * change, 0}, 0, key.bridge_place);
    if (key.modes > 0) retune(key);
  }

  /// Advances left.size() samples, in which no damper moves, and writes what each ear hears. forces: unless it
  /// is empty, the largest contact force of any key [N]. input: a force on the bridge (Body::push), or empty.
  void process(std::span<T> left, std::span<T> right, std::span<T> forces, std::span<const T> input) {
    sort_out();
    for (std::size_t n = 0; n < left.size(); ++n) {
      T forces_n[Body<T>::kMaxPlaces] = {};
      T output = input.empty() ? T(0) : held(T(0), input[n], ControlRanges<T>::force_n);
      body_.push(output);
      for (const auto& [place, first, count] : groups_) {
        const auto strings = std::span<const StringsOnBridge<T>>(resting_).subspan(first, count);
        const BridgeForces<T> sum = kernels<T>.advance_on_bridge(strings, body_.change(place));
        forces_n[place] = sum.all;
        output += sum.output;
      }
      const T largest = advance_struck(forces_n, output);
      for (const std::size_t k : longitudinal_) output += keys_[k].tick_longitudinally();
      if (!forces.empty()) forces[n] = largest;
      body_.tick(std::span<const T>(forces_n, body_.places()));
      begin_joined();
      sound_.tick(output, body_, left[n], right[n]);
    }
  }

  /// Energy of strings, bridge, body, hammers and felts [J].
  [[nodiscard]] double energy() const {
    double energy = body_.energy();
    for (const std::size_t k : awake_) {
      const Key& key = keys_[k];
      for (std::size_t i = 0; i < key.modes; ++i) energy += key.model.string().energy(i);
      energy += key.model.hammer_energy(key.controls);
    }
    return energy;
  }

  /// Brings body and sound to rest; no key is at the bridge.
  void reset_body() {
    body_.reset();
    sound_.reset();
  }
  /// Brings all keys to rest, away from the bridge.
  void rest() {
    for (Key& key : keys_) key.rest();
    awake_.clear();
    joined_.clear();
  }

 private:
  struct Joined {
    std::size_t key, first_mode, modes;
  };
  struct Group {
    std::size_t place, first, count;  // of resting_
  };

  static std::vector<ModeShapes<T>> bridge_of(const BoardOfKeyboard& board) {
    std::vector<ModeShapes<T>> places;
    for (std::size_t p = 0; p < board.places(); ++p)
      places.emplace_back(board.bridge.subspan(p * board.modes.size(), board.modes.size()));
    return places;
  }
  static std::vector<BridgeStiffness> ends_of(std::span<const KeyOnBody<T>> keys, std::size_t places) {
    std::vector<BridgeStiffness> stiffness(places);
    for (const KeyOnBody<T>& key : keys) stiffness[key.bridge_place] += {Key::ends_of(key), 0};
    return stiffness;
  }

  void wake(std::size_t key) {
    const auto order = [&](std::size_t k) { return std::tuple(keys_[k].bridge_place, k); };
    awake_.insert(std::ranges::lower_bound(awake_, order(key), {}, order), key);  // does not allocate
  }

  void retune(Key& key) {
    const double stiffness = key.stiffness_of(key.modes);
    const T force = key.model.bridge_force(key.bridge, 0, key.modes);
    key.retune();
    body_.retune({0, key.stiffness_of(key.modes) - stiffness},
                 key.model.bridge_force(key.bridge, 0, key.modes) - force, key.bridge_place);
  }

  // Who has a hammer in flight, and who has none, place by place; and whose strings move along themselves.
  void sort_out() {
    resting_.clear();
    groups_.clear();
    struck_.clear();
    longitudinal_.clear();
    for (const std::size_t k : awake_) {
      Key& key = keys_[k];
      key.controls.damping_per_s = static_cast<T>(key.damper.value()) + key.extra_damping_per_s;
      if (key.is_longitudinal) longitudinal_.push_back(k);
      if (key.is_struck) {
        struck_.push_back(k);
        continue;
      }
      if (groups_.empty() || groups_.back().place != key.bridge_place)
        groups_.push_back({key.bridge_place, resting_.size(), 0});
      ++groups_.back().count;
      resting_.push_back(key.model.on_bridge(
          key.bridge, key.modes, 1 / (1 + key.controls.damping_per_s * static_cast<T>(time_step_s_)), key.output));
    }
  }

  // Advances the struck keys one sample, adds their forces on the bridge, and returns the largest contact force.
  T advance_struck(T* forces_n, T& output) {
    T largest = 0;
    for (const std::size_t k : struck_) {
      Key& key = keys_[k];
      const T force = key.model.tick(key.controls, key.bridge, body_.change(key.bridge_place));
      forces_n[key.bridge_place] += force;
      output += key.output * force;
      const bool touches = key.model.force() > 0;
      contacts_ += touches && !std::exchange(key.touches, touches);
      key.touches = touches;
      largest = (std::max)(largest, key.model.force());
    }
    return largest;
  }

  // Strings that have joined load the bridge with their mass from the first sample on. This step of their force does
  // not sound.
  void begin_joined() {
    for (const Joined& joined : joined_) {
      const Key& key = keys_[joined.key];
      sound_.begins(key.output * key.model.bridge_force(key.bridge, joined.first_mode, joined.modes));
    }
    joined_.clear();
  }

  double time_step_s_;
  Body<T> body_;
  KeyboardSound<T> sound_;
  std::vector<Key> keys_;
  std::vector<std::size_t> awake_;
  // Those of awake_ with a hammer in flight, and those whose strings move along themselves.
  std::vector<std::size_t> struck_, longitudinal_;
  std::vector<StringsOnBridge<T>> resting_;
  std::vector<Group> groups_;
  std::vector<Joined> joined_;  // since the last sample
  std::size_t contacts_ = 0;
};

}  // namespace detail

}  // namespace contactspline
