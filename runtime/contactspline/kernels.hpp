// SPDX-License-Identifier: MIT
// What the vectorised kernels of ContactSpline::simd work on: plain pointers, so that one compiled library serves
// every machine.
#pragma once

#include <limits>
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

/// Knots a block of FeltArrays holds.
inline constexpr std::size_t kKnotsInABlock = 32;

/// Knots that the kernels look at at once: as many as fill a cache line.
template <std::floating_point T>
inline constexpr std::size_t kKnotsInAWindow = 64 / sizeof(T);

/// Knots further than anything, which surround those of a felt [m]: their square is infinite, so that none is ever
/// passed.
template <std::floating_point T>
inline constexpr T kOutOfReach_m = std::numeric_limits<T>::max() / 4;

/// A SegmentTable column by column: entry k of each is entry k of the table, but for knots[0]. Before entry 0 and
/// after entry N stand segments without force, out of reach as entry 0 is: one or more, kKnotsInAWindow or more.
template <std::floating_point T>
struct FeltArrays {
  std::size_t segments;  ///< N
  const T* knots;        ///< knots + 1 begins a cache line
  const T* energies;     ///< there, likewise
  const T* forces;       ///< there
  const T* half_curvatures;
  const T* pivots;          ///< the first knot of each block, padded as the knots, on cache lines
  const T* pivot_energies;  ///< there
  std::size_t blocks;       ///< from entry 1 on
  // What follows from them and xi, an admittance times a stiffness ratio:
  T* prepared_xi;     ///< [m/N], -1 at first
  T* gives;           ///< xi times the force at each knot [m]
  T* stiffnesses;     ///< xi c of each segment
  T* inverse_slopes;  ///< 1/(1 + xi c) of each segment
};

/// How a force on a hammer's strings changes, per newton, what the modes are and will do.
template <std::floating_point T>
struct StrikeArrays {
  const T* shape;      ///< at the place of the strike
  const T* give;       ///< displacement after the sample
  const T* free_give;  ///< free increment after the sample
  T free_admittance;   ///< sum of shape times free_give
  const T* swing;      ///< shape/sqrt(stiffness - (loss + stiffness)^2 / 4)
  const T* unit;       ///< in which a struck mode's state is counted: give, so that a force just adds to it
  const T* per_unit;   ///< 1/unit
  FeltArrays<T> felt;
  T* workspace;  ///< the StruckRows of each line of modes; the constants are there
};

/// What a struck mode is made of, a cache line each: two of state and six of constants, in its unit.
struct StruckRow {
  enum : std::size_t { displacement, free_increment, free_give, stiffness, rest, loss, shape, pickup };
};
/// So many lines for each: one more, or every eighth would lie at the same place of a page.
inline constexpr std::size_t kStruckLines = 9;

/// A hammer on its way.
template <std::floating_point T>
struct HammerFlight {
  T mass_kg = 1;
  ContactControls<T> felt = {};
  T compression_m = 0;
  T velocity_m_per_s = 0;
  std::size_t segment = 0;       ///< that holds the compression
  T force_n = 0;                 ///< over the last sample
  std::ptrdiff_t moved[2] = {};  ///< segments over the last sample and the one before
};

/// A hammer this far back is caught; only a new throw brings it back.
template <std::floating_point T>
inline constexpr T kCaught_m = T(-0.05);

/// Advances the modes by out.size() samples without force, a damper leaving them `share` of their way; writes the
/// displacement at the pickup after each.
void play_free(const ModalArrays<float>& string, float share, const float* pickup, std::span<float> out);
void play_free(const ModalArrays<double>& string, double share, const double* pickup, std::span<double> out);

/// What is struck, where, and by what.
template <std::floating_point T>
struct Strike {
  ModalArrays<T> string;
  StrikeArrays<T> place;
  SegmentTable<T> felt;
  T time_step_s;
  T share;              ///< as in play_free
  T string_admittance;  ///< at the place, of a sample [m/N]
  const T* pickup;
};

/// The same with a hammer in flight, until it is caught or `out` is full; returns the samples written. force: where
/// the contact forces go, or null.
std::size_t play_struck(const Strike<float>& strike, HammerFlight<float>& hammer, std::span<float> out, float* force);
std::size_t play_struck(const Strike<double>& strike, HammerFlight<double>& hammer, std::span<double> out,
                        double* force);

}  // namespace contactspline::detail
