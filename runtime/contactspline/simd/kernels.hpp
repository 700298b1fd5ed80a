// SPDX-License-Identifier: MIT
// The table by which the models call kernels: where ContactSpline::simd is linked, those of the best instruction set
// of the machine, else portable ones (docs/how-it-works/kernels.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>
#include <cstddef>
#include <span>

#include "contactspline/simd/kernel_data.hpp"
#include "contactspline/simd/portable_kernels.hpp"

// Each program and each shared library has a table of its own, so that two of them in one process may differ.
#ifdef _WIN32  // where that is so by itself
#define CONTACTSPLINE_OWN
#else
#define CONTACTSPLINE_OWN [[gnu::visibility("hidden")]]
#endif

namespace contactspline::detail {

/// Largest number of voices that a kernel advances side by side.
inline constexpr std::size_t kMaxTogether = 16;

/// Functions of modes, strings and systems of equations. Arrays are padded as in ModalArrays.
template <std::floating_point T>
struct Kernels {
  /// Advances the modes by out.size() samples without force and writes the displacement at the pickup after each.
  /// damping_gain: as in StrikeConstants.
  void (*process_free)(const ModalArrays<T>& modes, T damping_gain, const T* pickup, std::span<T> out) = nullptr;

  /// The same with a hammer in flight, for several voices: each until its hammer is stopped or its `out` is full.
  void (*process_struck)(std::span<StruckVoice<T>> voices) = nullptr;

  /// Advances all strings by one sample on a bridge that has moved by change_m, and returns the sums of shape times
  /// displacement.
  BridgeForces<T> (*advance_on_bridge)(std::span<const StringsOnBridge<T>> strings, T change_m);

  /// The sum of a[i] b[i] over arrays of that number of modes.
  T (*inner_product)(std::size_t modes, const T* a, const T* b) = nullptr;

  /// Writes factors[i] times values[i] to products[i] for i < count, and to sums[k] the sum of products[i] products[i
  /// + k shift]. All three arrays begin on a cache line. The factors are followed by zeros to the end of their line,
  /// the products by zeros to the end of theirs and as many as the largest k shift. The values are readable and
  /// finite to the end of their line.
  void (*sum_shifted_products)(std::size_t count, const T* factors, const T* values, T* products, std::size_t shift,
                               std::span<T> sums);

  /// Solves matrix x = right, the matrix I plus a positive semidefinite one; right becomes x. Column j of the matrix
  /// begins at matrix + j stride, a cache line; its lower triangle counts, and what follows row `size` in a line is
  /// 0. Overwrites the matrix.
  void (*solve_positive_definite)(std::size_t size, T* matrix, std::size_t stride, T* right);

  /// Sums of shape times free increment for several shapes. Returns the sum of |free increment|.
  T(*sum_free_increments)
  (std::size_t modes, const T* free_increment, std::span<const T* const> at, T* increments) = nullptr;

  /// Advances the modes by one sample under damping_gain times the forces at the places `pushed`. Then
  /// sum_free_increments().
  T(*advance_under_forces)
  (const ModalArrays<T>& modes, T damping_gain, std::span<const T* const> pushed, const T* forces,
   std::span<const T* const> at, T* increments) = nullptr;

  /// Ends a sample of a body that stretches by one form without products (StretchForms). Adds form.moved_by times
  /// form.motion to the changes of the modes, applies these to the displacements, and writes the changes of the next
  /// sample to modes.free_increment. Then the form's motion, and sums[0] to sums[3]: its gradient times displacement,
  /// free increment, change and motion.
  void (*advance_stretching)(const ModalArrays<T>& modes, const SquareForm<T>& form, T* sums);

  /// product = matrix q, of the modes of a form that has products of two modes.
  void (*multiply_form)(const FormBlocks<T>& matrix, const T* q, T* product);

  /// The constants and the motion of modes whose frequencies change.
  void (*retune)(RetunedModes& modes);

  /// Are these the kernels of ContactSpline::simd?
  [[nodiscard]] bool are_vectorised() const { return process_struck != nullptr; }
};

/// What the models call by the table without vectors, too. The others are null: strings then play by tick(), and
/// ModalBank calls the loops of portable_kernels.hpp itself.
template <std::floating_point T>
inline constexpr Kernels<T> kPortableKernels = {.advance_on_bridge = portable::advance_on_bridge<T>,
                                                .sum_shifted_products = portable::sum_shifted_products<T>,
                                                .solve_positive_definite = portable::solve_positive_definite<T>,
                                                .advance_stretching = portable::advance_stretching<T>,
                                                .multiply_form = portable::multiply_form<T>,
                                                .retune = portable::retune};

/// The kernels of this program or shared library, whichever of its files calls them. They change before main()
/// begins, or never.
template <std::floating_point T>
CONTACTSPLINE_OWN inline constinit Kernels<T> kernels = kPortableKernels<T>;

/// The sum of a[i] b[i] over arrays of that number of modes, padded as in ModalArrays. A call by the table takes
/// longer than a loop over few modes.
template <std::floating_point T>
[[nodiscard]] T inner_product(std::size_t modes, const T* a, const T* b) {
  constexpr std::size_t kFewModes = 4;
  if (modes > kFewModes && kernels<T>.are_vectorised()) return kernels<T>.inner_product(modes, a, b);
  return portable::inner_product<T>(modes, a, b);
}

/// Fills the table with the kernels of ContactSpline::simd for the best instruction set of this machine. Returns
/// true.
template <std::floating_point T>
bool take_vectorised_kernels() = delete;
template <>
bool take_vectorised_kernels<float>();
template <>
bool take_vectorised_kernels<double>();

// The library defines no more than these functions. To call them where it is linked also makes the linker take them
// out of its archive.
#ifdef CONTACTSPLINE_SIMD
CONTACTSPLINE_OWN inline const bool kHasVectorisedKernels =
    take_vectorised_kernels<float>() && take_vectorised_kernels<double>();
#endif

}  // namespace contactspline::detail

#undef CONTACTSPLINE_OWN
