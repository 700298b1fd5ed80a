// SPDX-License-Identifier: MIT
// What the keys of an instrument file need of its network: strings and other bodies that are tuned, and a damper.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/instrument_data.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/bend.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/models/hammer_voice.hpp"
#include "contactspline/network/contact_network.hpp"

namespace contactspline::detail {

/// The tuning of the strings of a network, each by a change of its tension that follows its control like any bend.
/// What a bar or another body has in place of a tension is its whole stiffness: its squares are those of its
/// frequencies.
template <std::floating_point T>
class NetworkTuning {
 public:
  NetworkTuning() = default;
  explicit NetworkTuning(const InstrumentData& data)
      : modes_(data.modes()), tuned_(modes_), squares_(data.keyed.tension_squares) {
    const auto& with = data.keyed.tuned_with;
    for (std::size_t b = 0, begin = 0; b < data.body_ends.size(); begin = data.body_ends[b++])
      if (is_tuned(begin, data.body_ends[b]))
        strings_.push_back({b, begin, data.body_ends[b], with.empty() ? b : with[b]});
  }

  [[nodiscard]] bool is_tunable() const { return !strings_.empty(); }
  /// string: a body, for it and those tuned with it, or kAllStrings.
  void tune(double cents, std::size_t string) {
    for (String& tuned : strings_)
      if (string == kAllStrings || string == tuned.with) tuned.target = cents;
  }
  [[nodiscard]] bool has_arrived() const {
    return std::ranges::all_of(strings_, [&](const String& s) { return s.target + shift_ == s.bend.cents(); });
  }
  /// Shifts all strings, beside tune().
  void shift(double cents) { shift_ = cents; }
  /// Calls visit(body, cents) with what tune() has set.
  template <typename Visitor>
  void each(const Visitor& visit) const {
    for (const String& string : strings_) visit(string.body, string.target);
  }
  /// A change that is under way need not wait, as where the network is at rest.
  void follow_now() {
    for (String& string : strings_) string.wait = 0;
  }
  /// The network is new: its strings have the pitch of the file.
  void restart() {
    sample_ = 0;
    for (String& string : strings_) string.bend = {};
    follow_now();
    tuned_ = modes_;
  }

  /// Called before each sample. If frequencies change: the work of that [J].
  std::optional<double> follow(ContactNetwork<T>& network, double sample_rate_hz) {
    ++sample_;
    std::optional<double> work;
    for (String& string : strings_) {
      const double target = string.target + shift_;
      if (string.wait > 0) {
        --string.wait;
        continue;
      }
      if (target == string.bend.cents()) continue;
      string.wait = kStep - 1;
      const double before = network.energy(), now_s = static_cast<double>(sample_) / sample_rate_hz;
      if (!string.bend.follow(target, energy(network, string), now_s)) continue;
      retune(network, string);
      work = work.value_or(0) + network.energy() - before;
    }
    return work;
  }

  /// By how much a mode is stiffer than in the file.
  [[nodiscard]] double stiffness_ratio(std::size_t mode) const {
    return tuned_.empty() ? 1 : stiffness_of(tuned_[mode]) / stiffness_of(modes_[mode]);
  }

 private:
  static constexpr std::size_t kStep = 64;  // samples

  struct String {
    std::size_t body, begin, end;  // modes
    std::size_t with;              // the body whose tuning it has
    Bend bend = {};
    double target = 0;
    std::size_t wait = 0;  // samples until its tension changes again
  };

  [[nodiscard]] bool is_tuned(std::size_t begin, std::size_t end) const {
    return std::ranges::any_of(squares_.subspan(begin, end - begin), [](double square) { return square != 0; });
  }

  // Energy at the tension of the file [J].
  [[nodiscard]] double energy(const ContactNetwork<T>& network, const String& string) const {
    double sum = 0;
    for (std::size_t i = string.begin; i < string.end; ++i) {
      const double q = double(network.body(string.body).displacement(i - string.begin));
      sum += modes_[i].mass_kg * squares_[i] * q * q / 2;
    }
    return sum;
  }

  void retune(ContactNetwork<T>& network, const String& string) {
    const double change = tension_change(string.bend.cents());
    for (std::size_t i = string.begin; i < string.end; ++i) tuned_[i] = retuned_by(modes_[i], change * squares_[i]);
    network.retune(string.body, std::span<const Mode>(tuned_).subspan(string.begin, string.end - string.begin));
  }

  std::vector<Mode> modes_, tuned_;
  std::span<const double> squares_;
  std::vector<String> strings_;
  double shift_ = 0;
  std::size_t sample_ = 0;
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
