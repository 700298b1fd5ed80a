// SPDX-License-Identifier: MIT
// What the vectorised kernels of ContactSpline::simd work on: plain pointers, so that one compiled library serves
// every machine.
#pragma once

#include <span>

#include "contactspline/contact.hpp"

namespace contactspline::detail {

/// Arrays of a modal bank: `modes` numbers each, followed by zeros up to a whole cache line, which they begin.
template <std::floating_point T>
struct ModalArrays {
  std::size_t modes;
  const T* stiffness;
  const T* stiffness_rest;
  const T* loss;
  T* displacement;
  T* free_increment;
};

/// How a force on a hammer's strings changes, per newton, what the modes are and will do.
template <std::floating_point T>
struct StrikeArrays {
  const T* shape;           ///< at the place of the strike
  const T* give;            ///< displacement after the sample
  const T* free_give;       ///< free increment after the sample
  T free_admittance;        ///< sum of shape times free_give
  const T* knots;           ///< of the felt, 1 to N, padded to whole blocks with what nothing reaches
  const T* energies;        ///< there
  const T* pivots;          ///< the first knot of each block, padded as the knots
  const T* pivot_energies;  ///< there
  std::size_t blocks;
  T* workspace;  ///< kStruckLines cache lines for each line of modes
};

/// What a struck mode is made of: two of state and seven of constants.
inline constexpr std::size_t kStruckLines = 9;

/// A hammer on its way.
template <std::floating_point T>
struct HammerFlight {
  T mass_kg = 1;
  ContactControls<T> felt = {};
  T compression_m = 0;
  T velocity_m_per_s = 0;
  std::size_t segment = 0;  ///< that holds the compression
  T force_n = 0;            ///< over the last sample
};

/// A hammer this far back is caught; only a new throw brings it back.
template <std::floating_point T>
inline constexpr T kCaught_m = T(-0.05);

/// Knots a block of StrikeArrays holds.
inline constexpr std::size_t kKnotsInABlock = 32;

/// Knots further than anything, which fill the last block [m].
template <std::floating_point T>
inline constexpr T kOutOfReach_m = T(1e15);

/// Advances the modes by out.size() samples without force, a damper leaving them `share` of their way; writes the
/// displacement at the pickup after each.
void play_free(const ModalArrays<float>& string, float share, const float* pickup, std::span<float> out);
void play_free(const ModalArrays<double>& string, double share, const double* pickup, std::span<double> out);

/// The same with a hammer in flight, until it is caught or `out` is full; returns the samples written. force: where
/// the contact forces go, or null.
std::size_t play_struck(const ModalArrays<float>& string, const StrikeArrays<float>& strike, SegmentTable<float> felt,
                        float time_step_s, float share, float string_admittance, HammerFlight<float>& hammer,
                        const float* pickup, std::span<float> out, float* force);
std::size_t play_struck(const ModalArrays<double>& string, const StrikeArrays<double>& strike,
                        SegmentTable<double> felt, double time_step_s, double share, double string_admittance,
                        HammerFlight<double>& hammer, const double* pickup, std::span<double> out, double* force);

}  // namespace contactspline::detail
