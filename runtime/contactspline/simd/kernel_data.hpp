// SPDX-License-Identifier: MIT
// The data of the kernels: plain pointers, so that one compiled library serves every machine
// (docs/how-it-works/kernels.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <limits>
#include <span>

#include "contactspline/step/contact.hpp"

namespace contactspline::detail {

/// The arrays of a modal bank: `modes` numbers each, padded with zeros to a whole cache line, which they begin.
template <std::floating_point T>
struct ModalArrays {
  std::size_t modes;
  const T* stiffness;
  const T* stiffness_rest;
  const T* loss;
  const T* receptance;
  T* displacement;
  T* free_increment;
  T* change;  ///< of the displacement over the last sample, where the modes are advanced one sample at a time
};

/// A form by which modes stretch their body, without products of two modes (StretchForm).
template <std::floating_point T>
struct SquareForm {
  const T* squares;
  T* gradient;  ///< squares times displacement, which a kernel may leave as it is
  T* motion;    ///< receptance times gradient
  T moved_by;   ///< by how much of the motion the form changes the displacements in a sample
};

/// Largest number of rows of a FormRows.
inline constexpr std::size_t kRowsTogether = 8;

/// Rows of a sparse matrix, one after the other, that have numbers in the same columns.
struct FormRows {
  std::size_t first, count;  ///< at most kRowsTogether
  std::size_t runs;          ///< of columns
};

/// Columns, one after the other.
struct FormColumns {
  std::size_t first, count;
};

/// The matrix of a form of a body that stretches (StretchForm), rows after rows. For each of their columns there are
/// kRowsTogether factors, 0 beyond the rows.
template <std::floating_point T>
struct FormBlocks {
  std::span<const FormRows> rows;
  const FormColumns* runs;
  const T* factors;
};

/// Strings that end at a bridge.
template <std::floating_point T>
struct StringsOnBridge {
  ModalArrays<T> modes;
  const T* shape;  ///< force of each mode on the bridge per displacement [N/m]
  const T* rest;   ///< displacement of each mode at rest per displacement of the bridge
  T damping_gain;  ///< as in StrikeConstants
  T output = 1;    ///< weight of these strings in BridgeForces::output
};

/// Sum of the forces of strings on a bridge, and of the same by their weights [N].
template <std::floating_point T>
struct BridgeForces {
  T all, output;
};

/// Numbers in a cache line.
template <std::floating_point T>
inline constexpr std::size_t kLineSize = 64 / sizeof(T);

/// n rounded up to whole cache lines of numbers.
template <std::floating_point T>
[[nodiscard]] constexpr std::size_t in_whole_lines(std::size_t n) {
  return (n + kLineSize<T> - 1) / kLineSize<T> * kLineSize<T>;
}

/// Number of knots in a block of a ContactTable.
inline constexpr std::size_t kKnotsPerBlock = 32;

/// Number of knots that a kernel judges at once: they fill a cache line.
template <std::floating_point T>
inline constexpr std::size_t kKnotsPerWindow = kLineSize<T>;

/// Number of knots beyond the first one crossed that a kernel of several voices judges at once.
inline constexpr int kKnotsAhead = 16;

/// Sentinel knot on both sides of a table's knots [m]. Its square is infinite, so that no step crosses it.
template <std::floating_point T>
inline constexpr T kSentinelKnot = (std::numeric_limits<T>::max)() / 4;

/// A SegmentTable column by column, with its products with the receptance. Entry k of a column is entry k of the
/// table, except knots[0]. Sentinel segments without force stand on both sides: kKnotsAhead + 1 and more before entry
/// 1 and after entry N.
template <std::floating_point T>
struct ContactTable {
  std::size_t segments;  ///< N
  const T* knots;        ///< knots + 1 begins a cache line
  const T* energies;     ///< at the knots; likewise
  const T* forces;       ///< at the knots
  const T* half_curvatures;
  const T* block_first_knots;     ///< padded like the knots, on cache lines
  const T* block_first_energies;  ///< there
  std::size_t blocks;             ///< from entry 1 on
  const Segment<T>* rows;         ///< the same table by segments
  // Products with xi, the receptance times the stiffness ratio:
  T* prepared_xi;          ///< the xi that the products hold [m/N], -1 at first
  T* force_displacements;  ///< xi times the force at each knot [m]
  T* stiffnesses;          ///< xi c of each segment
  T* inverse_slopes;       ///< 1/(1 + xi c) of each segment
};

/// Everything that is constant while a hammer is in flight: the string, where it is struck, and by what.
template <std::floating_point T>
struct StrikeConstants {
  ModalArrays<T> modes;
  ContactTable<T> table;
  SegmentTable<T> segments;  ///< the same table by segments
  const T* shape;            ///< of the modes at the place of the strike
  // Changes of each mode by a force at that place, per newton:
  const T* receptance;           ///< of the displacement after the sample
  const T* free_increment_gain;  ///< of the free increment after the sample
  const T* amplitude_gain;       ///< shape/sqrt(stiffness - (loss + stiffness)^2 / 4)
  const T* unit;                 ///< unit of a mode's state under load: its receptance, so that a force is just added
  const T* per_unit;             ///< 1/unit
  T receptance_of_string;        ///< sum of shape times receptance [m/N]
  T free_receptance;             ///< sum of shape times free_increment_gain [m/N]
  T* workspace;                  ///< the rows of ModeRow, line by line; the constants are already there
  // Of the call:
  T time_step_s;
  T damping_gain;  ///< 1/(1 + damping): the part of its motion that the damper leaves each mode
  const T* pickup;
};

/// Rows of a mode under load, a cache line each: two of state and six of constants, in the mode's unit.
struct ModeRow {
  enum : std::size_t { displacement, free_increment, free_increment_gain, stiffness, rest, loss, shape, pickup };
};
/// Cache lines for each line of modes. One more than there are rows: else every eighth would lie at the same offset
/// of a page.
inline constexpr std::size_t kRowsPerLine = 9;

/// Some modes whose frequencies change between two samples, in double precision; names as in Mode and ModeConstants.
/// What is behind the last one, to the end of a cache line, is any number.
struct RetunedModes {
  static constexpr std::size_t kMax = 64;
  using Array = double[kMax];

  double time_step_s;
  std::size_t modes;
  // What they have from now on.
  alignas(64) Array angular_frequency_rad_per_s, decay_per_s, mass_kg, loss;
  // What they had before, and have then: displacement, velocity, decay and loss stay.
  alignas(64) Array stiffness, velocity_gain, displacement, free_increment;
  // What they have then.
  alignas(64) Array receptance, averaging_factor, one_plus_z_square;
};

/// State of a hammer from its throw until it is stopped.
template <std::floating_point T>
struct HammerState {
  T mass_kg = 1;
  ContactControls<T> felt = {};
  T compression_m = 0;
  T last_increment_m = 0;  ///< of the compression over the last sample, with loss and in reach: for the kernels
  T velocity_m_per_s = 0;
  std::size_t segment = 0;         ///< that holds the compression
  T force_n = 0;                   ///< over the last sample
  std::ptrdiff_t crossed[2] = {};  ///< segments crossed in the last sample and in the one before
};

/// A hammer this far behind the string is stopped. Only a new throw brings it back.
template <std::floating_point T>
inline constexpr T kHammerStop_m = T(-0.05);

/// A string with a hammer in flight. Whatever it points to must outlive the call.
template <std::floating_point T>
struct StruckVoice {
  StrikeConstants<T> strike;
  HammerState<T>* hammer;
  std::span<T> out;         ///< displacement at the pickup [m]
  T* force;                 ///< destination of the contact forces, or null
  std::size_t written = 0;  ///< number of samples written
};

}  // namespace contactspline::detail
