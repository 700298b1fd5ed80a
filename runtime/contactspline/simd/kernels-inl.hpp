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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace contactspline::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace contactspline::detail {

HWY_EXPORT(process_free_here);
HWY_EXPORT(advance_on_bridge_here);
HWY_EXPORT(inner_product_here);
HWY_EXPORT(sum_shifted_products_here);
HWY_EXPORT(solve_positive_definite_here);
HWY_EXPORT(sum_free_increments_here);
HWY_EXPORT(advance_under_forces_here);
HWY_EXPORT(process_struck_here);

void process_free(const ModalArrays<Sample>& modes, Sample damping_gain, const Sample* pickup,
                  std::span<Sample> out) {
  const FlushDenormals flushed;
  HWY_DYNAMIC_DISPATCH(process_free_here)(modes, damping_gain, pickup, out);
}
BridgeForces<Sample> advance_on_bridge(std::span<const StringsOnBridge<Sample>> strings, Sample change_m) {
  return HWY_DYNAMIC_DISPATCH(advance_on_bridge_here)(strings, change_m);
}
Sample inner_product(std::size_t modes, const Sample* a, const Sample* b) {
  return HWY_DYNAMIC_DISPATCH(inner_product_here)(modes, a, b);
}
void sum_shifted_products(std::size_t count, const Sample* factors, const Sample* values, Sample* products,
                          std::size_t shift, std::span<Sample> sums) {
  HWY_DYNAMIC_DISPATCH(sum_shifted_products_here)(count, factors, values, products, shift, sums);
}
void solve_positive_definite(std::size_t size, Sample* matrix, std::size_t stride, Sample* right) {
  HWY_DYNAMIC_DISPATCH(solve_positive_definite_here)(size, matrix, stride, right);
}
Sample sum_free_increments(std::size_t modes, const Sample* free_increment, std::span<const Sample* const> at,
                           Sample* increments) {
  return HWY_DYNAMIC_DISPATCH(sum_free_increments_here)(modes, free_increment, at, increments);
}
Sample advance_under_forces(const ModalArrays<Sample>& modes, Sample damping_gain,
                            std::span<const Sample* const> pushed, const Sample* forces,
                            std::span<const Sample* const> at, Sample* increments) {
  return HWY_DYNAMIC_DISPATCH(advance_under_forces_here)(modes, damping_gain, pushed, forces, at, increments);
}
void process_struck(std::span<StruckVoice<Sample>> voices) {
  const FlushDenormals flushed;
  HWY_DYNAMIC_DISPATCH(process_struck_here)(voices);
}

}  // namespace contactspline::detail
#endif
// NOLINTEND(misc-definitions-in-headers)
