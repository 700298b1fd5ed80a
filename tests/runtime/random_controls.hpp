// SPDX-License-Identifier: MIT
// Controls that jump to random values, models that they drive, and the balance of the models' energy: for
// extremes_test and for soak.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "contactspline/models/fret_string.hpp"
#include "contactspline/models/slide_string.hpp"
#include "strings.hpp"
#include "support/finite.hpp"
#include "support/random.hpp"

namespace contactspline::testing {

/// Draws values of a control: anything within its range, often its ends, and now and then infinity or NaN.
template <typename T>
class RandomControls {
 public:
  /// Draws the same values for so many samples in a row.
  explicit RandomControls(std::size_t held_for = 1, std::uint64_t seed = 3)
      : held_for_(held_for), random_(seed), held_(seed) {}

  /// Begins a sample.
  void next() {
    if (sample_ % held_for_ == 0) held_ = Random(random_.bits());
    ++sample_;
    if (held_for_ > 1) random_ = held_;
  }
  T any(ControlRange<T> range) {
    constexpr T kInfinity = std::numeric_limits<T>::infinity();
    switch (random_.below(8)) {
      case 0:
      case 1:
        return range.min;
      case 2:
      case 3:
        return range.max;
      case 4:
        return std::numeric_limits<T>::quiet_NaN();
      case 5:
        return random_.below(2) == 0 ? kInfinity : -kInfinity;
      case 6:  // as far from 0 as 1e-6 of the larger end, on a logarithmic scale
        return std::clamp(range.max * static_cast<T>(std::exp(-14 * random_.uniform())), range.min, range.max);
      default:
        return range.min + (range.max - range.min) * static_cast<T>(random_.uniform());
    }
  }
  std::size_t below(std::size_t count) { return random_.below(count); }
  bool once_in(std::uint64_t draws) { return random_.once_in(draws); }

 private:
  std::size_t held_for_, sample_ = 0;
  Random random_, held_;  ///< held_: what the samples of one row begin with
};

template <typename T>
ContactControls<T> any_contact(RandomControls<T>& random) {
  return {random.any(ControlRanges<T>::stiffness_ratio), random.any(ControlRanges<T>::loss_s_per_m)};
}

/// Strings and tables of all models, at one rate.
template <typename T>
struct Parts {
  explicit Parts(double rate)
      : rate_hz(rate),
        modes(modes_of({"C4", "", c4().string, {c4().strike_m}, {0.2}, 60}, rate / 2).modes),
        table(table_in<T>(felt_table(c4(), 40))),
        strike(shapes<T>(modes, &ResonatorMode::strike_shape)),
        pickup(shapes<T>(modes, &ResonatorMode::pickup_shape)),
        places(wavenumbers_of(modes)) {}

  double rate_hz;
  std::vector<ResonatorMode> modes;
  std::vector<Segment<T>> table;
  ModeShapes<T> strike, pickup;
  StringShapes<T> places;
};

/// The energy of a model against the work done on it so far. Rounding is a part of what flows to and fro: in single
/// precision 1e-7 of it was enough for 270 million samples of soak, in double precision 1e-13 for 130 million.
template <typename T>
class WorkBooks {
 public:
  explicit WorkBooks(double rate_hz) : rate_hz_(rate_hz) {}
  void close(double work_j, double energy_j) {
    work_ += work_j + 2 / rate_hz_;  // a rise of the contact's stiffness and one of the hand's spring: 1 W each
    flow_ += std::abs(work_j) + energy_j;
    const double excess = energy_j - work_ - (sizeof(T) == sizeof(double) ? 1e-12 : 1e-6) * flow_;
    is_within_ &= is_finite(excess) && excess <= 0;
    peak_ = std::max(peak_, energy_j);
    excess_ = std::max(excess_, energy_j - work_);
  }
  [[nodiscard]] bool is_within() const { return is_within_; }
  [[nodiscard]] double peak() const { return peak_; }
  /// The largest energy beyond the work [J], with what rounding adds.
  [[nodiscard]] double excess() const { return excess_; }

 private:
  double rate_hz_, work_ = 0, flow_ = 0, peak_ = 0, excess_ = 0;
  bool is_within_ = true;
};

/// A slide-string or a fret-string that plays random controls, and moderate ones.
template <typename Model, typename T>
struct RandomContact {
  explicit RandomContact(const Parts<T>& parts)
      : model(parts.table, bare(parts.modes), parts.places, T(0.1), parts.rate_hz) {
    model.place(T(0.3), 0);  // where neither spring nor contact hold energy
  }
  Model model;
  T pluck_force = 0;
};

template <typename T>
struct RandomSlide : RandomContact<SlideString<T>, T> {
  using Base = RandomContact<SlideString<T>, T>;
  using Base::Base, Base::model, Base::pluck_force;

  /// Returns the work on the string and the slide but that of the pluck [J].
  double tick(RandomControls<T>& random) {
    using Ranges = ControlRanges<T>;
    const double before = model.slide();
    model.tick({random.any({0, T(0.62)}), random.any(Ranges::mass_kg), random.any(Ranges::force_n),
                random.any(Ranges::hand_stiffness_n_per_m), random.any(Ranges::resistance_n_s_per_m),
                random.any(Ranges::resistance_n_s_per_m), random.any(Ranges::force_n), any_contact(random)});
    pluck_force = model.controls().pluck_force_n;
    return model.controls().hand_force_n * (static_cast<double>(model.slide()) - before) + model.work_along();
  }
  void place(RandomControls<T>& random) {
    model.place(random.any({0, T(0.62)}), random.any(ControlRanges<T>::height_m));
  }
  void play_moderately() {
    model.tick({.place_m = T(0.3),
                .slide_mass_kg = T(0.02),
                .hand_force_n = 2,
                .hand_stiffness_n_per_m = 100,
                .hand_resistance_n_s_per_m = 5,
                .rest_resistance_n_s_per_m = 2});
  }
};

template <typename T>
struct RandomFret : RandomContact<FretString<T>, T> {
  using Base = RandomContact<FretString<T>, T>;
  using Base::Base, Base::model, Base::pluck_force;

  double tick(RandomControls<T>& random) {
    using Ranges = ControlRanges<T>;
    const T pluck = random.any(Ranges::force_n);
    pluck_force = held(pluck_force, pluck, Ranges::force_n);
    model.tick({random.any({0, T(0.62)}), random.any(Ranges::gap_m), pluck, random.any(Ranges::damping_per_s),
                any_contact(random)});
    return model.work_of_fret();
  }
  void place(RandomControls<T>& random) {
    model.place(random.any({0, T(0.62)}), random.any(ControlRanges<T>::gap_m));
  }
  void play_moderately() { model.tick({.place_m = T(0.3), .gap_m = T(-1e-3), .damping_per_s = 100}); }
};

}  // namespace contactspline::testing
