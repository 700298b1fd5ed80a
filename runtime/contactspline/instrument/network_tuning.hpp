// SPDX-License-Identifier: MIT
// What the keys of an instrument file need of its network: strings that are tuned, and a damper.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/network/contact_network.hpp"

namespace contactspline::detail {

/// The tuning of all strings of a network by one change of tension, which follows its control like any bend.
template <std::floating_point T>
class NetworkTuning {
 public:
  NetworkTuning() = default;
  /// One Mode and one square for each mode of the network, body after body.
  NetworkTuning(std::vector<Mode> modes, std::span<const double> squares, std::span<const std::size_t> body_ends)
      : modes_(std::move(modes)), tuned_(modes_), squares_(squares), body_ends_(body_ends) {}

  [[nodiscard]] bool is_tunable() const { return !squares_.empty(); }
  void tune(double cents) {
    if (std::exchange(target_, cents) != cents) wait_ = 0;
  }
  [[nodiscard]] bool has_arrived() const { return !is_tunable() || target_ == bend_.cents(); }
  /// The network is at rest: a change that is under way need not wait.
  void rest() { wait_ = 0; }
  /// The network is new: its strings have the pitch of the file.
  void restart() {
    bend_ = {};
    sample_ = wait_ = 0;
    tuned_ = modes_;
  }

  /// Called before each sample. If frequencies change: the work of that [J].
  std::optional<double> follow(ContactNetwork<T>& network, double sample_rate_hz) {
    ++sample_;
    if (target_ == bend_.cents()) return {};
    if (wait_ > 0) return --wait_, std::nullopt;
    wait_ = kStep - 1;
    const double before = network.energy(), now_s = static_cast<double>(sample_) / sample_rate_hz;
    if (!bend_.follow(target_, energy(network), now_s)) return {};
    for (std::size_t b = 0, begin = 0; b < body_ends_.size(); begin = body_ends_[b++])
      if (is_tuned(begin, body_ends_[b])) retune(network, b, begin);
    return network.energy() - before;
  }

  /// By how much a mode is stiffer than in the file.
  [[nodiscard]] double stiffness_ratio(std::size_t mode) const {
    return tuned_.empty() ? 1 : stiffness_of(tuned_[mode]) / stiffness_of(modes_[mode]);
  }

 private:
  static constexpr std::size_t kStep = 16;  // samples

  [[nodiscard]] bool is_tuned(std::size_t begin, std::size_t end) const {
    for (std::size_t i = begin; i < end; ++i)
      if (squares_[i] != 0) return true;
    return false;
  }

  // Energy at the tension of the file [J].
  [[nodiscard]] double energy(const ContactNetwork<T>& network) const {
    double sum = 0;
    for (std::size_t b = 0, i = 0; b < body_ends_.size(); ++b)
      for (std::size_t mode = 0; i < body_ends_[b]; ++i, ++mode) {
        if (squares_[i] == 0) continue;
        const double q = double(network.body(b).displacement(mode));
        sum += modes_[i].mass_kg * squares_[i] * q * q / 2;
      }
    return sum;
  }

  void retune(ContactNetwork<T>& network, std::size_t body, std::size_t begin) {
    for (std::size_t i = begin; i < body_ends_[body]; ++i) tuned_[i] = retuned(modes_[i], squares_[i], bend_.cents());
    network.retune(body, std::span<const Mode>(tuned_).subspan(begin, body_ends_[body] - begin));
  }

  std::vector<Mode> modes_, tuned_;
  std::span<const double> squares_;
  std::span<const std::size_t> body_ends_;
  Bend bend_;
  double target_ = 0;
  std::size_t sample_ = 0;
  std::size_t wait_ = 0;  // samples until the tension changes again
};

/// The damper of some bodies. It is up until release(), and adds to the damping of the controls.
template <std::floating_point T>
class NetworkDamper {
 public:
  NetworkDamper(std::span<const std::size_t> bodies, double damping_per_s, std::size_t all_bodies,
                double sample_rate_hz)
      : bodies_(bodies), own_per_s_(all_bodies), decay_factor_({.damping_per_s = damping_per_s}, sample_rate_hz) {}

  void lift() {
    is_released_ = false;
    move_to(0);
  }
  /// Falls as soon as nothing sustains it.
  void release(bool is_sustained) {
    is_released_ = true;
    if (!is_sustained) move_to(1);
  }
  void end_sustain() {
    if (is_released_) move_to(1);
  }

  /// Sets the damping of a body by its control [1/s].
  void set(ContactNetwork<T>& network, std::size_t body, T damping_per_s) {
    own_per_s_[body] = damping_per_s;
    network.set_damping(body, damping_per_s);
    has_moved_ = true;
  }

  /// Called before each sample.
  void follow(ContactNetwork<T>& network) {
    const bool is_falling = decay_factor_.samples() != (std::numeric_limits<std::size_t>::max)();
    if (!is_falling && !std::exchange(has_moved_, false)) return;
    for (const std::size_t body : bodies_)
      network.set_damping(body, own_per_s_[body] + static_cast<T>(decay_factor_.value()));
    decay_factor_.advance(1);
    has_moved_ = is_falling;
  }

 private:
  void move_to(double position) {
    decay_factor_.move_to(position);
    has_moved_ = true;
  }

  std::span<const std::size_t> bodies_;
  std::vector<T> own_per_s_;  // by controls
  FallingDamper decay_factor_;
  bool is_released_ = false;
  bool has_moved_ = false;  // since the last sample
};

}  // namespace contactspline::detail
