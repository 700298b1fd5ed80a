// SPDX-License-Identifier: MIT
// A whole keyboard on its body: all strings end at its bridge and sound through it.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "contactspline/models/body.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/models/key_on_body.hpp"
#include "contactspline/models/keys_on_bridge.hpp"
#include "contactspline/step/controls.hpp"
#include "contactspline/step/first_push.hpp"
#include "contactspline/step/flush_denormals.hpp"

namespace contactspline {

/// Struck strings on one body, with dampers and pedals; the output is a velocity for each ear [m/s] (Listening), or a
/// pressure [Pa] (BodyPressure).
/// A key sleeps until it is struck, pressed, or lifted by the pedal while something sounds: then its strings join the
/// bridge, in sympathy with their modes below kSympathy_hz only. Modes that ring no more leave
/// (docs/reference/keyboard.md). All functions but the constructor are safe on an audio thread: no allocation, no
/// lock, bounded time.
template <std::floating_point T>
class KeyboardOnBody {
 public:
  static constexpr double kSympathy_hz = detail::SoundingKey<T>::kSympathy_hz;

  /// The lowest `max_modes` modes below half the sample rate of each string. Allocates.
  KeyboardOnBody(std::span<const KeyOnBody<T>> keys, const BoardOfKeyboard& board, double sample_rate_hz,
                 std::size_t max_modes = 4096)
      : time_step_s_(1 / sample_rate_hz), bridge_(keys, board, sample_rate_hz, max_modes) {}

  /// Throws the hammer of a key, 0 to keys() - 1, at a speed [m/s], -1000 to 1000, and lifts its damper; at speed 0
  /// it is pressed without a blow. Other keys and speeds that are not a number do nothing.
  void strike(std::size_t key, T speed_m_per_s) {
    if (key >= keys() || !is_number(speed_m_per_s)) return;
    if (speed_m_per_s == 0) return press(key);
    Key& struck = bridge_.key(key);
    press(key);
    bridge_.set_modes(key, struck.model.string().size());
    bridge_.move_longitudinally(key);
    struck.prepare_strike(una_corda_, soft_ratio_, hammer_mass_ratio_, felt_);
    struck.model.strike(speed_m_per_s, HammerVoice<T>::kThrowDistance_m);
    bridge_.body().knock(knock_ratio_ * struck.controls.hammer_mass_kg * speed_m_per_s);
    struck.is_struck = sounds_ = true;
    wake_lifted();
  }

  /// Lifts the damper of a key, as a key does that is pressed without a sound.
  void press(std::size_t key) {
    if (key >= keys()) return;
    bridge_.key(key).is_down = true;
    move_damper(bridge_.key(key));
    wake_lifted();
  }

  /// Lowers the damper of a key, as far as the pedals allow, so many times as fast as by itself, 0.1 to 10.
  void release(std::size_t key, double pace = 1) {
    if (key >= keys()) return;
    bridge_.key(key).is_down = false;
    move_damper(bridge_.key(key), pace);
  }

  /// The sustain pedal: 0 up to 1 down, clamped. In between, the dampers damp with the fraction 1 - position.
  void sustain(double position) {
    sustain_ = held(sustain_, position, kPedal);
    for (Key& key : bridge_.keys()) move_damper(key);
    wake_lifted();
  }

  /// The sostenuto pedal: while it is down, the dampers of the keys that were down when it went down stay up.
  void sostenuto(bool is_down) {
    if (is_down == std::exchange(is_sostenuto_, is_down)) return;
    for (Key& key : bridge_.keys()) {
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
    if (key < keys()) bridge_.key(key).strike_at(position_m);
  }

  /// Damping of a key's strings beside the damper's: extra decay of every mode [1/s], 0 to 1e5, clamped.
  void damp(std::size_t key, T damping_per_s) {
    if (key >= keys()) return;
    T& extra = bridge_.key(key).extra_damping_per_s;
    extra = held(extra, damping_per_s, ControlRanges<T>::damping_per_s);
  }

  /// Bends a key's strings, also while they sound, by a change of their tension: so many cents above their own pitch,
  /// -4800 to 4800, clamped. The bridge feels the new tension. A tension that rises does at most 1 W of work (saved
  /// up for 10 ms), so that strings that swing far follow later. A bend by more than a few cents at once can be
  /// noticed.
  void bend(std::size_t key, double cents) {
    if (key >= keys()) return;
    bridge_.key(key).cents = held(bridge_.key(key).cents, cents, ControlRanges<double>::bend_cents);
    follow_bend(bridge_.key(key));
  }

  /// Brings everything to rest and lets all keys go; the pedals stay.
  void reset() {
    bridge_.rest();
    for (Key& key : bridge_.keys()) {
      move_damper(key);
      key.damper.finish();
    }
    clock_ = next_check_ = 0;
    checks_since_push_ = kLongAgo;
    reset_body();
    for (Key& key : bridge_.keys()) follow_bend(key);  // at once: nothing sounds
  }

  /// Advances left.size() samples and writes what each ear hears; both spans must have the same size. The sound
  /// does not depend on where blocks are cut. force: unless it is empty, the largest contact force of any key [N].
  /// input: unless it is empty, a force on the bridge [N], -1000 to 1000, in equal parts at all its places. Strings
  /// without a damper on them follow it from the first push on.
  void process(std::span<T> left, std::span<T> right, std::span<T> force = {}, std::span<const T> input = {}) {
    const FlushDenormals flushed;
    for (std::size_t done = 0; done < left.size();) {
      std::size_t samples = (std::min)(left.size() - done, kCheckInterval - clock_);
      if (const std::size_t faint = faint_samples(input, done, samples); faint > 0)
        samples = faint;
      else
        begin_push();
      process_steady(left.subspan(done, samples), right.subspan(done, samples),
                     force.empty() ? force : force.subspan(done, samples),
                     input.empty() ? input : input.subspan(done, samples));
      done += samples;
    }
  }
  /// The same in mono: the mean of both.
  void process(std::span<T> out) {
    const FlushDenormals flushed;
    std::array<T, kCheckInterval> other;
    for (std::size_t done = 0; done < out.size();) {
      const std::size_t samples = (std::min)(out.size() - done, kCheckInterval - clock_);
      const auto left = out.subspan(done, samples), right = std::span(other).first(samples);
      process_steady(left, right, {}, {});
      for (std::size_t n = 0; n < samples; ++n) left[n] = (left[n] + right[n]) / 2;
      done += samples;
    }
  }

  [[nodiscard]] std::size_t keys() const { return bridge_.keys().size(); }
  /// Number of keys that are computed, and of their modes.
  [[nodiscard]] std::size_t awake() const { return bridge_.awake().size(); }
  [[nodiscard]] std::size_t modes_awake() const {
    std::size_t modes = 0;
    for (const std::size_t key : bridge_.awake()) modes += bridge_.key(key).modes;
    return modes;
  }
  /// Contact force of a key's hammer over the last sample [N].
  [[nodiscard]] T force(std::size_t key) const { return bridge_.key(key).model.force(); }
  [[nodiscard]] bool is_hammer_flying() const {
    return std::ranges::any_of(bridge_.awake(),
                               [&](std::size_t key) { return bridge_.key(key).model.is_hammer_flying(); });
  }

  /// Energy of strings, bridge, body, hammers and felts [J]; a hammer that is stopped has none.
  [[nodiscard]] double energy() const { return bridge_.energy(); }
  /// Number of contacts that have begun.
  [[nodiscard]] std::size_t contacts() const { return bridge_.contacts(); }
  [[nodiscard]] const Body<T>& body() const { return bridge_.body(); }
  /// How often it came to rest because body or strings were not finite.
  [[nodiscard]] std::size_t failures() const { return failures_; }

 private:
  using Key = detail::SoundingKey<T>;
  static constexpr std::size_t kLine = Key::kLine;
  static constexpr ControlRange<double> kPedal{0, 1};
  static constexpr std::size_t kCheckInterval = 32;  // samples, after each of which one key is checked
  static constexpr std::size_t kChecksOfBends = 2;   // after which strings follow what is left of their bends
  static constexpr double kSilence_j = 1e-17;        // 130 dB below the blow of a C4 hammer at 0.4 m/s
  // What may leave, as a fraction of all energy: of a key that is damped, and of one that rings.
  static constexpr double kDampedFraction = 1e-7, kRingingFraction = 1e-12;
  static constexpr double kBodySilence_j = 1e-17;
  static constexpr std::size_t kLongAgo = ~std::size_t(0);

  [[nodiscard]] bool is_lifted(const Key& key) const {
    return !key.has_damper || key.is_down || key.is_held || sustain_ > 0;
  }
  void move_damper(Key& key, double pace = 1) {
    key.damper.move_to(key.is_down || key.is_held ? 0 : 1 - sustain_, pace);
  }

  // Samples of a part of an input before it pushes; all where there is none.
  static std::size_t faint_samples(std::span<const T> input, std::size_t begin, std::size_t samples) {
    return input.empty() ? samples : first_push(input.subspan(begin, samples));
  }

  // Has the input pushed since the last round of checks? Until then strings without a damper stay at the bridge.
  [[nodiscard]] bool is_pushed() const { return checks_since_push_ <= keys(); }
  void begin_push() {
    const bool wakes = !sounds_ || !is_pushed();
    checks_since_push_ = 0;
    sounds_ = true;
    if (wakes) wake_lifted();
  }

  // Whatever has no damper on it rings in sympathy.
  void wake_lifted() {
    if (!sounds_) return;
    for (std::size_t key = 0; key < keys(); ++key)
      if (is_lifted(bridge_.key(key))) {
        bridge_.key(key).checks = 0;
        if (bridge_.key(key).modes < bridge_.key(key).sympathetic)
          bridge_.set_modes(key, bridge_.key(key).sympathetic);
      }
  }

  void follow_bend(Key& key) { bridge_.follow_bend(key, static_cast<double>(samples_) * time_step_s_); }

  // A block in which no key joins or leaves.
  void process_steady(std::span<T> left, std::span<T> right, std::span<T> force, std::span<const T> input) {
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
      for (const std::size_t key : bridge_.awake()) samples = (std::min)(samples, bridge_.key(key).damper.samples());
      bridge_.process(left.first(samples), right.first(samples), force.empty() ? force : force.first(samples),
                      input.empty() ? input : input.first(samples));
      for (const std::size_t key : bridge_.awake()) bridge_.key(key).damper.advance(samples);
      left = left.subspan(samples);
      right = right.subspan(samples);
      if (!force.empty()) force = force.subspan(samples);
      if (!input.empty()) input = input.subspan(samples);
    }
    if (clock_ == kCheckInterval) {
      clock_ = 0;
      checks_since_push_ += is_pushed();
      for (const std::size_t key : bridge_.awake())
        bridge_.key(key).is_struck = bridge_.key(key).model.is_hammer_flying();
      if (++checks_since_bends_ == kChecksOfBends) {
        checks_since_bends_ = 0;
        for (Key& key : bridge_.keys()) follow_bend(key);
      }
      check();
    }
  }

  // Looks at one key, and at the body after all keys: what rings no more leaves.
  void check() {
    if (next_check_ == keys()) {
      next_check_ = 0;
      for (std::size_t place = 0; place < body().places(); ++place)
        if (const T w = body().displacement(place); !all_finite(std::span<const T>(&w, 1))) return fail();
      body_j_ = body().modes().energy();
      if (bridge_.awake().empty() && body_j_ < kBodySilence_j) reset_body();
      return;
    }
    const std::size_t k = next_check_++;
    Key& key = bridge_.key(k);
    if (key.modes == 0 || key.is_struck || key.checks++ == 0) return;
    const double limit =
        (std::max)(kSilence_j, (is_lifted(key) ? kRingingFraction : kDampedFraction) * (body_j_ + stored_j_));
    double leaving = 0;
    std::size_t modes = key.modes;
    const std::size_t least = is_pushed() && is_lifted(key) ? (std::min)(modes, key.sympathetic) : 0;
    while (modes > least) {
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
    bridge_.set_modes(k, modes);
  }

  void fail() {
    ++failures_;
    reset();
  }

  void reset_body() {
    bridge_.reset_body();
    sounds_ = false;
    stored_j_ = body_j_ = 0;
  }

  double time_step_s_;
  detail::KeysOnBridge<T> bridge_;
  std::size_t clock_ = 0, next_check_ = 0, checks_since_bends_ = 0, failures_ = 0;
  std::size_t checks_since_push_ = kLongAgo;
  std::uint64_t samples_ = 0;
  double sustain_ = 0, una_corda_ = 0, soft_ratio_ = 1;
  T hammer_mass_ratio_ = 1, knock_ratio_ = 1;
  ContactControls<T> felt_ = {};
  bool is_sostenuto_ = false;
  bool sounds_ = false;
  double body_j_ = 0, stored_j_ = 0;  // of the body and of all keys, at their last checks
};

}  // namespace contactspline
