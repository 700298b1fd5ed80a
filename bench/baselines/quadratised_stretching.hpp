// SPDX-License-Identifier: MIT
// Modes that stretch their body, with the energy of stretching as V = (psi^2 - gauge)/2 and psi a variable of its own
// (Bilbao, Ducceschi and Zama, J. Comput. Phys. 2023; Ducceschi and Bilbao, J. Sound Vib. 2022, for strings).
#pragma once

#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
#include <vector>

#include "contactspline/data/mode.hpp"
#include "contactspline/data/stretch_form.hpp"
#include "contactspline/modal/modal.hpp"

namespace contactspline::bench {

/// The two-step modes of StretchingBank with one form, whose force is -g (psi+ + psi)/2 with the gradient g of
/// sqrt(2 V + gauge): psi+ = psi + g'(q+ - q-)/2. gauge: 2 J times a constant that keeps the root from 0, >= 0.
template <std::floating_point T>
class QuadratisedStretching {
 public:
  QuadratisedStretching(std::span<const Mode> modes, const StretchForm& form, double gauge_j, double sample_rate_hz)
      : stiffness_j_(static_cast<T>(form.stiffness_j)),
        gauge_(static_cast<T>(gauge_j)),
        psi_(std::sqrt(gauge_)),
        gradient_(modes.size()),
        free_(modes.size()) {
    for (std::size_t i = 0; i < modes.size(); ++i) {
      const auto constants = contactspline::detail::mode_constants(modes[i], sample_rate_hz);
      modes_.push_back({static_cast<T>(constants.stiffness), static_cast<T>(constants.loss),
                        static_cast<T>(constants.receptance), static_cast<T>(form.squares_per_m2[i])});
    }
  }

  /// Advances one sample under a force [N] at a place.
  void tick(std::span<const double> at, T force_n) {
    T stretch = 0, receptance = 0, moved = 0;
    for (std::size_t i = 0; i < modes_.size(); ++i) {
      const ModeState& mode = modes_[i];
      gradient_[i] = mode.square * mode.displacement;
      stretch += gradient_[i] * mode.displacement;
    }
    const T root = std::sqrt(stiffness_j_ * stretch * stretch / 2 + gauge_);
    const T scale = root > 0 ? stiffness_j_ * stretch / root : std::sqrt(2 * stiffness_j_);
    for (std::size_t i = 0; i < modes_.size(); ++i) {
      const ModeState& mode = modes_[i];
      gradient_[i] *= scale;
      free_[i] = mode.change - (mode.loss * mode.change + mode.stiffness * mode.displacement) +
                 2 * mode.receptance * static_cast<T>(at[i]) * force_n;
      receptance += gradient_[i] * mode.receptance * gradient_[i];
      moved += gradient_[i] * (free_[i] + mode.change);
    }
    const T mean = (psi_ + moved / 4) / (1 + receptance / 2);  // (psi+ + psi)/2
    psi_ = 2 * mean - psi_;
    for (std::size_t i = 0; i < modes_.size(); ++i) {
      ModeState& mode = modes_[i];
      mode.change = free_[i] - 2 * mode.receptance * gradient_[i] * mean;
      mode.displacement += mode.change;
    }
  }

  [[nodiscard]] T displacement(std::size_t mode) const { return modes_[mode].displacement; }  ///< [m]
  [[nodiscard]] T psi() const { return psi_; }  ///< between the last two displacements [sqrt(J)]

 private:
  struct ModeState {
    T stiffness, loss, receptance, square;
    T displacement = 0, change = 0;
  };

  T stiffness_j_, gauge_, psi_;
  std::vector<ModeState> modes_;
  std::vector<T> gradient_, free_;
};

}  // namespace contactspline::bench
