// SPDX-License-Identifier: MIT
// The kernels for samples of type Sample, which the including file has defined: compiled once for each instruction
// set. The best one is chosen at run time.
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "contactspline/simd/kernels.hpp"
#include "contactspline/step/flush_denormals.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contactspline/simd/kernels-inl.hpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// After the one that it needs.
#include <hwy/contrib/math/math-inl.h>

// NOLINTBEGIN(misc-definitions-in-headers): each including file defines these for a Sample of its own.
HWY_BEFORE_NAMESPACE();
namespace contactspline::detail {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The parts of the kernels stand here, in the namespace of the instruction set. A part may use those above it.
// clang-format off
#include "contactspline/simd/modes-inl.hpp"
#include "contactspline/simd/struck_modes-inl.hpp"
#include "contactspline/simd/contact-inl.hpp"
#include "contactspline/simd/group-inl.hpp"
#include "contactspline/simd/process-inl.hpp"
// clang-format on

// All but the two that play blocks, which turn denormals off first.
Kernels<Sample> kernels_here() {
  return {.advance_on_bridge = advance_on_bridge_here,
          .inner_product = inner_product_here,
          .sum_shifted_products = sum_shifted_products_here,
          .solve_positive_definite = solve_positive_definite_here,
          .sum_free_increments = sum_free_increments_here,
          .advance_under_forces = advance_under_forces_here,
          .advance_stretching = advance_stretching_here,
          .multiply_form = multiply_form_here,
          .retune = retune_here};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace contactspline::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace contactspline::detail {

HWY_EXPORT(kernels_here);
HWY_EXPORT(process_free_here);
HWY_EXPORT(process_struck_here);

static void process_free_flushed(const ModalArrays<Sample>& modes, Sample damping_gain, const Sample* pickup,
                                 std::span<Sample> out) {
  const FlushDenormals flushed;
  HWY_DYNAMIC_DISPATCH(process_free_here)(modes, damping_gain, pickup, out);
}
static void process_struck_flushed(std::span<StruckVoice<Sample>> voices) {
  const FlushDenormals flushed;
  HWY_DYNAMIC_DISPATCH(process_struck_here)(voices);
}

template <>
bool take_vectorised_kernels<Sample>() {
  kernels<Sample> = HWY_DYNAMIC_DISPATCH(kernels_here)();
  kernels<Sample>.process_free = process_free_flushed;
  kernels<Sample>.process_struck = process_struck_flushed;
  return true;
}

}  // namespace contactspline::detail
#endif
// NOLINTEND(misc-definitions-in-headers)
