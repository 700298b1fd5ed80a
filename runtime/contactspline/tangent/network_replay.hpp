// SPDX-License-Identifier: MIT
// The modes of a network again, under the forces of a record (docs/how-it-works/gradients.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <vector>

#include "contactspline/tangent/moving_places_backwards.hpp"
#include "contactspline/tangent/network_adjoints.hpp"
#include "contactspline/tangent/network_modes.hpp"
#include "contactspline/tangent/network_record.hpp"

namespace contactspline::detail {

/// Plays the modes of a block of samples, without solving anything.
template <std::floating_point T>
class NetworkReplay {
 public:
  using Record = NetworkRecord<T>;
  using Ends = typename Record::Ends;

  NetworkReplay(const Record& record, const NetworkModes<T>& modes, PlacesBackwards<T>& places,
                MovingPlaces<T>& movers)
      : record_(record),
        modes_(modes),
        places_(places),
        movers_(movers),
        changes_(Record::kBlock * modes.size()),
        displacements_(changes_.size()) {}

  void play(std::size_t block, std::size_t count) {
    const std::size_t modes = modes_.size(), first = block * Record::kBlock;
    const T* state = record_.states.data() + block * record_.state_size(modes);
    std::vector<T> displacement(state, state + modes), increment(state + modes, state + 2 * modes);
    last_ = state + 2 * modes;
    movers_.begin(first, state + 3 * modes);
    for (std::size_t n = 0; n < count; ++n) {
      for (const auto& motion : record_.in_sample(record_.motions, &Ends::motions, first + n)) {
        displacement[modes_.begins[motion.body]] = motion.displacement;
        increment[modes_.begins[motion.body]] = motion.increment;
      }
      places_.list(record_, first + n);
      movers_.play(first + n);
      T* change = changes_.data() + n * modes;
      std::ranges::copy(increment, change);
      for (const std::size_t p : places_.forced()) {
        const auto& place = places_[p];
        add_push(place.modes(), place.force, modes_.receptance.data() + place.begin, place.acting,
                 change + place.begin);
      }
      advance(modes, modes_.stiffness.data(), modes_.loss.data(), change, displacement.data(), increment.data(),
              displacements_.data() + n * modes);
    }
  }

  /// The changes of all modes over a sample of the block, and their displacements after it.
  [[nodiscard]] const T* change(std::size_t row) const { return changes_.data() + row * modes_.size(); }
  [[nodiscard]] const T* displacement(std::size_t row) const { return displacements_.data() + row * modes_.size(); }
  /// The changes over the sample before it, if the network has places that move.
  [[nodiscard]] const T* last_change(std::size_t row) const { return row > 0 ? change(row - 1) : last_; }

 private:
  // Separate functions, because compilers respect __restrict on parameters.
  static void add_push(std::size_t modes, T force, const T* __restrict receptance, const T* __restrict shapes,
                       T* __restrict change) {
    for (std::size_t i = 0; i < modes; ++i) change[i] += receptance[i] * shapes[i] * force;
  }
  static void advance(std::size_t modes, const T* __restrict stiffness, const T* __restrict loss,
                      const T* __restrict change, T* __restrict displacement, T* __restrict increment,
                      T* __restrict after) {
    for (std::size_t i = 0; i < modes; ++i) {
      after[i] = displacement[i] += change[i];
      const T pull = loss[i] * change[i] + stiffness[i] * displacement[i];
      increment[i] = (change[i] - increment[i]) + (change[i] - pull);
    }
  }

  const Record& record_;
  const NetworkModes<T>& modes_;
  PlacesBackwards<T>& places_;
  MovingPlaces<T>& movers_;
  std::vector<T> changes_, displacements_;  // for each sample of a block and mode
  const T* last_ = nullptr;
};

}  // namespace contactspline::detail
