// SPDX-License-Identifier: MIT
// How keys play an instrument without keys of its own.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <bitset>
#include <concepts>
#include <cstddef>
#include <optional>
#include <span>

#include "contactspline/data/parameter.hpp"

namespace contactspline {

/// Plays an event by its value: a speed [m/s], a force [N] or an acceleration [m/s^2].
template <typename I>
void play_event(I& instrument, const Event& event, double value) {
  const auto x = static_cast<typename I::value_type>(value);
  switch (event.kind) {
    case EventKind::kStrike:
      return instrument.strike(event.number, x);
    case EventKind::kPluck:
      return instrument.pluck(event.number, x);
    case EventKind::kBow:
      if constexpr (requires { instrument.bow(event.number, x); }) instrument.bow(event.number, x);
  }
}

/// note_on() and note_off() of an instrument: each key plays its event where it has only one; else the keys from 60
/// on play one event each. The velocity multiplies the parameter of the event. Presets, strikes, releases and plucks
/// that an instrument does not define are none.
template <typename Derived>
class PlayedByEvents {
 public:
  static std::span<const Preset> presets() { return {}; }
  template <std::floating_point T>
  void strike(std::size_t, T) {}
  void release(std::size_t) {}
  template <std::floating_point T>
  void pluck(std::size_t, T, double = 0) {}

  /// key: of MIDI, others do nothing; velocity: 0 to 1, clamped; one that is not a number does nothing.
  void note_on(int key, double velocity) {
    const auto number = event_of(key);
    if (!number || !is_number(velocity)) return;
    const Event& event = self().events()[*number];
    const double value = std::clamp(velocity, 0.0, 1.0) * self().value(event.parameter);
    if (event.kind == EventKind::kBow && !(value > 0)) return;  // which would lift the bow
    down_.set(static_cast<std::size_t>(key));
    play_event(self(), event, value);
  }

  void note_off(int key) {
    const auto number = event_of(key);
    if (!number) return;
    down_.reset(static_cast<std::size_t>(key));
    const Event& event = self().events()[*number];
    if (!has_keys() && down_.any()) return;
    if (event.kind == EventKind::kStrike) self().release(event.number);
    if (event.kind == EventKind::kBow) play_event(self(), event, 0);
  }

  /// The event that a key plays, if it plays one.
  [[nodiscard]] std::optional<std::size_t> event_of(int key) const {
    const std::span<const Event> events = self().events();
    if (key < 0 || key > 127 || events.empty()) return {};
    if (!has_keys()) return 0;
    const int event = key - kFirstKey;
    if (event < 0 || event >= static_cast<int>(events.size())) return {};
    return static_cast<std::size_t>(event);
  }

 protected:
  void let_keys_go() { down_.reset(); }

 private:
  static constexpr int kFirstKey = 60;

  [[nodiscard]] Derived& self() { return static_cast<Derived&>(*this); }
  [[nodiscard]] const Derived& self() const { return static_cast<const Derived&>(*this); }
  [[nodiscard]] bool has_keys() const { return self().events().size() > 1; }

  std::bitset<128> down_;
};

}  // namespace contactspline
