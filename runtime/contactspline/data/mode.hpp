// SPDX-License-Identifier: MIT
// A mode of a resonator.
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <array>
#include <cstddef>

#include "contactspline/step/version.hpp"

namespace contactspline {

/// One mode of a resonator: q'' + 2 decay q' + (angular_frequency^2 + decay^2) q = force / mass.
struct Mode {
  double angular_frequency_rad_per_s;  ///< of the damped oscillation, >= 0; 0 without decay is a free mass
  double decay_per_s;                  ///< the amplitude decays as exp(-decay t), >= 0
  double mass_kg;                      ///< modal mass that belongs to the mode shapes, > 0
};

/// The modes of an emitted resonator, a compile-time constant.
template <typename Resonator>
inline constexpr auto modes_in = [] {
  static_assert(fits_runtime<Resonator>, "generated for another version: run `contactspline generate` again");
  std::array<Mode, Resonator::modes> modes{};
  for (std::size_t i = 0; i < Resonator::modes; ++i)
    modes[i] = {Resonator::angular_frequencies[i], Resonator::decays[i], Resonator::masses[i]};
  return modes;
}();

}  // namespace contactspline
