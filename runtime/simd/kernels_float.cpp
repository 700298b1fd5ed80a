// SPDX-License-Identifier: MIT
// The kernels in single precision, compiled once for each instruction set. The best one is chosen at run time.
#include "contactspline/flush_denormals.hpp"
#include "contactspline/kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/kernels_float.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/process-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace contactspline::detail {
namespace HWY_NAMESPACE {
namespace {

void ProcessFree(const ModalArrays<float>& modes, float damping_gain, const float* pickup, std::span<float> out) {
  process_free_block(modes, damping_gain, pickup, out);
}
float AdvanceOnBridge(const ModalArrays<float>& modes, const float* shape, const float* admittance,
                      float damping_gain, float displacement_m) {
  return advance_on_bridge_as(modes, shape, admittance, damping_gain, displacement_m);
}
HWY_FLATTEN std::size_t ProcessStruck(const StrikeConstants<float>& strike, HammerState<float>& hammer,
                                      std::span<float> out, float* force) {
  return process_struck_block(strike, hammer, out, force);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace contactspline::detail
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace contactspline::detail {

HWY_EXPORT(ProcessFree);
HWY_EXPORT(ProcessStruck);
HWY_EXPORT(AdvanceOnBridge);

void process_free(const ModalArrays<float>& modes, float damping_gain, const float* pickup, std::span<float> out) {
  const FlushDenormals flushed;
  HWY_DYNAMIC_DISPATCH(ProcessFree)(modes, damping_gain, pickup, out);
}
float advance_on_bridge(const ModalArrays<float>& modes, const float* shape, const float* admittance,
                        float damping_gain, float displacement_m) {
  return HWY_DYNAMIC_DISPATCH(AdvanceOnBridge)(modes, shape, admittance, damping_gain, displacement_m);
}
std::size_t process_struck(const StrikeConstants<float>& strike, HammerState<float>& hammer, std::span<float> out,
                           float* force) {
  const FlushDenormals flushed;
  return HWY_DYNAMIC_DISPATCH(ProcessStruck)(strike, hammer, out, force);
}

}  // namespace contactspline::detail
#endif
