// SPDX-License-Identifier: MIT
// A soundboard or another body that strings drive through their bridge, and that moves their ends.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/data/stiff_string.hpp"
#include "contactspline/modal/modal.hpp"
#include "contactspline/models/bridge_load.hpp"
#include "contactspline/step/controls.hpp"

namespace contactspline {

/// A body that strings drive at one place or several along its bridge. Strings and body take turns, half a sample
/// apart: the strings advance one sample while the bridge stands still, then the body advances one sample while the
/// strings stand still, tick(). The strings count the displacements of their modes from where the bridge would hold
/// them at rest, so they follow its change(). Each side sees a constant force, so nothing is solved together but the
/// few places of the bridge (BridgeLoad), and yet the energy of strings, bridge and body is balanced to rounding
/// (docs/how-it-works/body.md). No allocation after construction.
template <std::floating_point T>
class Body {
 public:
  static constexpr std::size_t kMaxPlaces = kMaxBridgePlaces;

  /// `bridge`: shapes of the body's modes at the bridge, one for each mode. `stiffness`: the sum of
  /// bridge_stiffness() of all strings that are there from the beginning. `knock`: shapes where knock() acts, or
  /// none.
  Body(std::span<const Mode> modes, ModeShapes<T> bridge, const BridgeStiffness& stiffness, double sample_rate_hz,
       ModeShapes<T> knock = ModeShapes<T>(0))
      : Body(modes, std::vector<ModeShapes<T>>(1, std::move(bridge)), std::span(&stiffness, 1), sample_rate_hz,
             std::move(knock)) {}

  /// The same with 1 to kMaxPlaces places: shapes and stiffness of each.
  Body(std::span<const Mode> modes, std::vector<ModeShapes<T>> bridge, std::span<const BridgeStiffness> stiffness,
       double sample_rate_hz, ModeShapes<T> knock = ModeShapes<T>(0))
      : bank_(modes, sample_rate_hz),
        knock_(std::move(knock)),
        sample_rate_hz_(static_cast<T>(sample_rate_hz)),
        load_(bridge.size()) {
    for (std::size_t p = 0; p < bridge.size(); ++p) {
      const T knocked = knock_.size() > 0 ? bank_.receptance(bridge[p], knock_) : T(0);
      places_.push_back({std::move(bridge[p]), stiffness[p], stiffness[p].modes, knocked});
      for (std::size_t q = 0; q <= p; ++q)
        load_.set_receptance(p, q, bank_.receptance(places_[p].shapes, places_[q].shapes));
    }
  }

  [[nodiscard]] std::size_t places() const { return places_.size(); }

  /// Displacement of the bridge at a place [m], and its change over the last sample, which the strings follow in the
  /// next one.
  [[nodiscard]] T displacement(std::size_t place = 0) const { return places_[place].displacement; }
  [[nodiscard]] T change(std::size_t place = 0) const { return places_[place].change; }
  /// What acted on the body at a place over the last sample [N]: pushes, and the strings' force less that of their
  /// stiffness.
  [[nodiscard]] T force(std::size_t place = 0) const { return places_[place].acted_n; }

  /// Modes of strings join between two samples: the stiffness that they add [N/m] (HammerString::follow), whose ends
  /// have been there all the time.
  void join(double stiffness_n_per_m, std::size_t place = 0) {
    add({0, stiffness_n_per_m}, static_cast<T>(stiffness_n_per_m / 2) * places_[place].change, place);
  }
  /// Modes of strings leave, with their energy: their stiffness, and their force on the bridge
  /// (HammerString::bridge_force).
  void leave(double stiffness_n_per_m, T force_n, std::size_t place = 0) {
    add({0, -stiffness_n_per_m}, -force_n, place);
  }

  /// Strings at the bridge change their tension: what their stiffness gains, and their force on the bridge [N].
  void retune(const BridgeStiffness& gain, T force_gain_n, std::size_t place = 0) { add(gain, force_gain_n, place); }

  /// An impulse [N s] on the body during the next sample, -1e3 to 1e3, at the place `knock` of the constructor. One
  /// that is not a number does nothing.
  void knock(T impulse_n_s) {
    if (knock_.size() > 0) knock_n_ += sample_rate_hz_ * held(T(0), impulse_n_s, {T(-1e3), T(1e3)});
  }

  /// A force that pushes the bridge during the next sample, as well as the strings [N], -1000 to 1000, by equal parts
  /// at all its places. Several add up. One that is not a number does nothing.
  void push(T force_n) { push_n_ += held(T(0), force_n, ControlRanges<T>::force_n) / static_cast<T>(places_.size()); }

  /// Advances one sample under the force of the strings on the bridge [N], taken after their sample: the sum of shape
  /// times modal displacement, -1e6 to 1e6. A force that is not a number counts as the last one. Of a body of one
  /// place. Safe in an audio thread.
  void tick(T force_n) { tick(std::span<const T>(&force_n, 1)); }

  /// The same with a force for each place.
  void tick(std::span<const T> forces_n) {
    if (!std::exchange(is_factored_, true)) factor();
    const T knock_n = std::exchange(knock_n_, T(0)), push_n = std::exchange(push_n_, T(0));
    const std::size_t places = places_.size();
    // The forces are pull - half change, where the change is the free one plus receptance times the forces.
    T forces[kMaxPlaces + 1], changes[kMaxPlaces];
    for (std::size_t p = 0; p < places; ++p) {
      Place& place = places_[p];
      place.force_n = held(place.force_n, forces_n[p], ControlRanges<T>::bridge_force_n);
      const T pull = place.force_n + push_n - static_cast<T>(place.stiffness.ends) * place.displacement;
      changes[p] = free_increments_[p] + place.knock_receptance * knock_n;
      forces[p] = pull - place.half_n_per_m * changes[p];
    }
    load_.solve(forces);
    load_.add_response(forces, changes);
    forces[places] = knock_n;
    advance(forces, knock_n != 0);
    for (std::size_t p = 0; p < places; ++p) {
      places_[p].acted_n = forces[p];
      places_[p].change = changes[p];
      places_[p].displacement += changes[p];
    }
    // Each place by turns is where its modes are, so that rounding does not add up.
    places_[next_].displacement = bank_.displacement(places_[next_].shapes);
    next_ = next_ + 1 == places ? 0 : next_ + 1;
  }

  /// Energy [J] of the body, of the tension of the strings at its bridge, and of the change that the strings have not
  /// followed yet; the sum with the strings' own energy changes by the work of other forces minus dissipated() of
  /// all.
  [[nodiscard]] double energy() const {
    double energy = bank_.energy();
    for (const Place& place : places_) {
      const double w = double(place.displacement), change = double(place.change);
      energy += place.stiffness.ends / 2 * w * w;
      energy += (place.stiffness.modes / 2 * change - double(place.force_n)) * change;
    }
    return energy;
  }

  /// The modes, for pickups and dissipated().
  [[nodiscard]] const ModalBank<T>& modes() const { return bank_; }

  /// Brings the body to rest, with the strings that were there at the beginning: all others leave. Does not allocate.
  void reset() {
    bank_.reset();
    for (Place& place : places_) {
      place.stiffness.modes = place.first_modes;
      place.displacement = place.change = place.force_n = place.acted_n = 0;
    }
    free_increments_ = {};
    knock_n_ = push_n_ = 0;
    next_ = 0;
    is_factored_ = false;
  }

 private:
  struct Place {
    ModeShapes<T> shapes;
    BridgeStiffness stiffness;
    double first_modes;  // stiffness of the modes at the beginning [N/m]
    T knock_receptance;  // change of displacement by the knock per newton [m/N]
    T half_n_per_m = 0;  // half the stiffness that is factored
    T displacement = 0, change = 0, force_n = 0, acted_n = 0;
  };

  void add(const BridgeStiffness& gain, T force_gain_n, std::size_t place) {
    places_[place].stiffness += gain;
    places_[place].force_n += force_gain_n;
    is_factored_ = false;
  }

  void factor() {
    T half_n_per_m[kMaxPlaces];
    for (std::size_t p = 0; p < places_.size(); ++p) {
      const BridgeStiffness& stiffness = places_[p].stiffness;
      half_n_per_m[p] = places_[p].half_n_per_m = static_cast<T>((stiffness.ends + stiffness.modes) / 2);
    }
    load_.factor(half_n_per_m);
  }

  void advance(const T* forces_n, bool knocks) {
    const T* shapes[kMaxPlaces + 1];
    for (std::size_t p = 0; p < places_.size(); ++p) shapes[p] = places_[p].shapes.data();
    shapes[places_.size()] = knock_.data();
    const std::span<const T* const> bridge(shapes, places_.size());
    bank_.advance(T(0), std::span(shapes, places_.size() + (knocks ? 1 : 0)), forces_n, bridge,
                  free_increments_.data());
  }

  ModalBank<T> bank_;
  ModeShapes<T> knock_;
  T sample_rate_hz_;
  detail::BridgeLoad<T> load_;
  std::vector<Place> places_;
  std::array<T, kMaxPlaces> free_increments_{};  // of the bridge at each place, over the next sample
  T knock_n_ = 0, push_n_ = 0;                   // in the next sample, the push at each place
  std::size_t next_ = 0;                         // place that takes its displacement from the modes
  bool is_factored_ = false;                     // does load_ hold the stiffness of all places?
};

}  // namespace contactspline
