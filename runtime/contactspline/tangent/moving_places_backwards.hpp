// SPDX-License-Identifier: MIT
// The places of a network that move along strings, for its gradient (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "contactspline/network/coupled_contacts.hpp"
#include "contactspline/network/network_plan.hpp"
#include "contactspline/tangent/moved_receptances.hpp"
#include "contactspline/tangent/network_adjoints.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_numbers.hpp"
#include "contactspline/tangent/network_record.hpp"
#include "contactspline/tangent/shapes_history.hpp"

namespace contactspline::detail {

/// The places that move: forwards through a block for the motion of its modes, then back for their adjoints. Let phi
/// be the shapes of a place after a sample in which it moves, q the displacements of the modes, c their changes over
/// the sample, and _ mark the values one sample earlier. The forces there change c by receptance (phi_ + phi)/2, and
/// what presses the connections is
///
///     before    phi_ q_ - owed_
///     after     phi q_ + (phi_ + phi)/2 c + (phi - phi_) c_/2 = phi q - owed
///     owed      (phi - phi_) (c - c_)/2
template <std::floating_point T>
class MovingPlaces {
 public:
  using Record = NetworkRecord<T>;
  using Place = PlaceAdjoints<T>;

  MovingPlaces(const NetworkPlan<T>& plan, double sample_rate_hz, const Record& record, const NetworkModes<T>& modes,
               PlacesBackwards<T>& places, ModeAdjoints<T>& adjoints)
      : plan_(plan),
        record_(record),
        modes_(modes),
        places_(places),
        adjoints_(adjoints),
        next_(record.moves.size()) {
    for (const std::size_t p : record.movers) movers_.emplace_back(p, plan.places()[p].wavenumbers_per_m);
    while (next_ > 0 && record.moves[next_ - 1].sample >= record.ends.size()) --next_;
    if (!movers_.empty()) receptances_.emplace(plan, sample_rate_hz);
  }

  /// Begins a block at its first sample, with the places where they are then [m]. Blocks go from the last to the
  /// first.
  void begin(std::size_t sample, const T* places_m) {
    if (movers_.empty()) return;
    while (next_ > 0 && record_.moves[next_ - 1].sample >= sample) --next_;
    for (std::size_t m = 0; m < movers_.size(); ++m) {
      movers_[m].history.begin(places_m[m]);
      rest(movers_[m]);
    }
  }
  /// Moves the places over sample n, which has its list of places.
  void play(std::size_t n) {
    if (movers_.empty()) return;
    rest_all();
    for (; next_ < record_.moves.size() && record_.moves[next_].sample == n; ++next_) {
      const auto& move = record_.moves[next_];
      Mover& mover = movers_[move.mover];
      mover.history.push(move.place_m);
      rest(mover);
      if (!move.is_put) act(mover);
    }
  }

  /// Goes back into sample n, which has its list of places.
  void enter(std::size_t n) {
    if (movers_.empty()) return;
    rest_all();
    for (std::size_t i = next_; i > 0 && record_.moves[i - 1].sample == n && !record_.moves[i - 1].is_put; --i) {
      Mover& mover = movers_[record_.moves[i - 1].mover];
      add_forced(mover);
      act(mover);
    }
  }
  /// The receptances of the sample: those of the network as it is, if no place of it moves.
  [[nodiscard]] const CoupledContacts<T>& solver(const CoupledContacts<T>& of_network) {
    if (movers_.empty()) return of_network;
    for (Mover& mover : movers_) {
      const ShapesHistory<T>& history = mover.history;
      const std::pair<T, T> between{places_[mover.place].is_moving ? history.place_before_m() : history.place_m(),
                                    history.place_m()};
      if (mover.measured == between) continue;
      mover.measured = between;
      receptances_->move(mover.place, places_[mover.place].acting);
    }
    return receptances_->solver();
  }

  /// The adjoints of the changes, after those of the modes alone. change, last: over the sample, and the one before.
  void retract(const T* change, const T* last) {
    for (Mover& mover : movers_) {
      const Place& place = places_[mover.place];
      if (std::exchange(mover.has_last, false)) take(mover.last, adjoints_.change.data() + place.begin);
      const T owed = std::exchange(mover.owed, T(0)) - place.after;
      if (!place.is_moving) continue;
      mover.has_last = true;
      add_owed(place.modes(), owed / 2, mover.change.data(), change + place.begin, last + place.begin,
               adjoints_.change.data() + place.begin, mover.last.data(), mover.of_change.data());
    }
  }
  /// What forces that respond to displacements do to the modes.
  void respond(const T* last) {
    for (const std::size_t m : moving_) {
      Mover& mover = movers_[m];
      const Place& place = places_[mover.place];
      mover.owed = -place.before;
      add_responses(place.modes(), place.by_forces, place.before, mover, last + place.begin,
                    adjoints_.change.data() + place.begin, adjoints_.displacement.data() + place.begin);
    }
  }
  /// The adjoints of shapes and positions, after those of the modes.
  void add_shapes(const T* change, const T* displacement) {
    for (const std::size_t m : moving_) {
      Mover& mover = movers_[m];
      Place& place = places_[mover.place];
      add_to_shapes(place, mover, modes_.receptance.data() + place.begin, change + place.begin,
                    displacement + place.begin, adjoints_.change.data() + place.begin,
                    adjoints_.receptance.data() + place.begin);
      mover.at += mover.history.of_place(mover.history.place_m(), place.shapes);
      std::swap(place.shapes, mover.of_before);
    }
  }
  /// Leaves sample n, after motions that were set before it: has_motions. Did all compressions jump then?
  [[nodiscard]] bool leave(std::size_t n, bool has_motions, NetworkGradient<T>& gradient) {
    bool is_placed = has_motions;
    for (; next_ > 0 && record_.moves[next_ - 1].sample == n; --next_) {
      const auto& move = record_.moves[next_ - 1];
      Mover& mover = movers_[move.mover];
      if (move.is_put) {
        is_placed = true;
        add_forced(mover);
        std::vector<T>& of_shapes = places_[mover.place].shapes;
        mover.at += mover.history.of_place(move.place_m, of_shapes);
        of_shapes.assign(of_shapes.size(), T(0));
      }
      if (move.call != Record::kAsBefore) {
        const T at = std::exchange(mover.at, T(0));
        if (record_.calls_follow[move.call] != 0) gradient.moves[move.call] += at;
      }
      mover.history.pop();
      rest(mover);
    }
    if (is_placed)
      for (Mover& mover : movers_) mover.owed = 0;
    return is_placed;
  }

  /// After the first sample: the derivatives by where the places begin. Without a sample they are 0.
  void finish(std::vector<T>& starts) {
    if (record_.ends.empty()) return;
    for (Mover& mover : movers_) {
      add_forced(mover);
      starts[mover.place] =
          mover.at + mover.history.of_place(plan_.places()[mover.place].place_m, places_[mover.place].shapes);
    }
  }

 private:
  struct Mover {
    std::size_t place;
    ShapesHistory<T> history;
    std::vector<T> mean, change;                // mean and change of the shapes, where it moves
    std::vector<T> of_change, of_before, last;  // adjoints: of `change`, of the shapes before, and of c_
    T owed = 0, at = 0;                         // adjoints, the second of the position
    std::pair<T, T> measured = {T(-1), T(-1)};  // positions before and after, for the receptances
    bool has_last = false;

    Mover(std::size_t p, const std::vector<double>& wavenumbers_per_m)
        : place(p),
          history(wavenumbers_per_m),
          mean(wavenumbers_per_m.size()),
          change(mean.size()),
          of_change(mean.size()),
          of_before(mean.size()),
          last(mean.size()) {}
  };

  void rest(Mover& mover) { places_[mover.place].acting = places_[mover.place].seen = mover.history.shapes(); }
  void rest_all() {
    for (const std::size_t m : moving_) {
      places_[movers_[m].place].is_moving = false;
      rest(movers_[m]);
    }
    moving_.clear();
  }
  // Lets forces act with the mean of the shapes before and after the sample.
  void act(Mover& mover) {
    moving_.push_back(static_cast<std::size_t>(&mover - movers_.data()));
    places_.list_moving(mover.place);
    const T *before = mover.history.shapes_before(), *after = mover.history.shapes();
    for (std::size_t i = 0; i < mover.mean.size(); ++i) {
      mover.mean[i] = (before[i] + after[i]) / 2;
      mover.change[i] = after[i] - before[i];
    }
    places_[mover.place].acting = mover.mean.data();
  }
  // What forces at the place did to its shapes and to the receptances of the modes, while it was at rest.
  void add_forced(Mover& mover) {
    Place& place = places_[mover.place];
    const T *shapes = mover.history.shapes(), *receptance = modes_.receptance.data() + place.begin;
    T* of_receptance = adjoints_.receptance.data() + place.begin;
    for (std::size_t i = 0; i < place.modes(); ++i) {
      const T forced = std::exchange(place.forced[i], T(0));
      place.shapes[i] += receptance[i] * forced;
      of_receptance[i] += shapes[i] * forced;
    }
  }

  // Separate functions, because compilers respect __restrict on parameters.
  static void take(std::vector<T>& last, T* __restrict of_change) {
    for (std::size_t i = 0; i < last.size(); ++i) of_change[i] += std::exchange(last[i], T(0));
  }
  static void add_owed(std::size_t modes, T half_owed, const T* __restrict moved, const T* __restrict change,
                       const T* __restrict last, T* __restrict of_change, T* __restrict of_last,
                       T* __restrict of_moved) {
    for (std::size_t i = 0; i < modes; ++i) {
      of_change[i] += half_owed * moved[i];
      of_last[i] = -half_owed * moved[i];
      of_moved[i] = half_owed * (change[i] - last[i]);
    }
  }
  static void add_responses(std::size_t modes, T by_forces, T before, Mover& mover, const T* __restrict last,
                            T* __restrict of_change, T* __restrict of_displacement) {
    const T* __restrict shapes_before = mover.history.shapes_before(), * __restrict shapes = mover.history.shapes();
    const T half = by_forces / 2;
    for (std::size_t i = 0; i < modes; ++i) {
      of_change[i] += by_forces * mover.mean[i];
      of_displacement[i] += by_forces * shapes[i] + before * shapes_before[i];
      mover.last[i] += half * mover.change[i];
      mover.of_change[i] += half * last[i];
    }
  }
  static void add_to_shapes(Place& place, Mover& mover, const T* __restrict receptance, const T* __restrict change,
                            const T* __restrict displacement, const T* __restrict of_change,
                            T* __restrict of_receptance) {
    const T seen = place.after + place.by_weights;
    for (std::size_t i = 0; i < place.modes(); ++i) {
      const T before = displacement[i] - change[i], force = place.force * of_change[i];
      const T half_mean = (receptance[i] * force + place.by_forces * change[i]) / 2;
      of_receptance[i] += mover.mean[i] * force;
      place.shapes[i] += seen * displacement[i] + place.by_forces * before + half_mean + mover.of_change[i];
      mover.of_before[i] = place.before * before + half_mean - mover.of_change[i];
    }
  }

  const NetworkPlan<T>& plan_;
  const Record& record_;
  const NetworkModes<T>& modes_;
  PlacesBackwards<T>& places_;
  ModeAdjoints<T>& adjoints_;
  std::size_t next_;  // move of the record
  std::vector<Mover> movers_;
  std::vector<std::size_t> moving_;  // movers, in this sample
  std::optional<MovedReceptances<T>> receptances_;
};

}  // namespace contactspline::detail
