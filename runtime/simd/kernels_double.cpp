// SPDX-License-Identifier: MIT
// The kernels in double precision, compiled once for each instruction set. The best one is chosen at run time.
#include "contactspline/flush_denormals.hpp"
#include "contactspline/kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/kernels_double.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/process-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace contactspline::detail {
namespace HWY_NAMESPACE {
namespace {

void ProcessFree(const ModalArrays<double>& modes, double damping_gain, const double* pickup, std::span<double> out) {
  process_free_block(modes, damping_gain, pickup, out);
}
double AdvanceOnBridge(const ModalArrays<double>& modes, const double* shape, const double* admittance,
                       double damping_gain, double displacement_m) {
  return advance_on_bridge_as(modes, shape, admittance, damping_gain, displacement_m);
}
HWY_FLATTEN std::size_t ProcessStruck(const StrikeConstants<double>& strike, HammerState<double>& hammer,
                                      std::span<double> out, double* force) {
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

void process_free(const ModalArrays<double>& modes, double damping_gain, const double* pickup,
                  std::span<double> out) {
  const FlushDenormals flushed;
  HWY_DYNAMIC_DISPATCH(ProcessFree)(modes, damping_gain, pickup, out);
}
double advance_on_bridge(const ModalArrays<double>& modes, const double* shape, const double* admittance,
                         double damping_gain, double displacement_m) {
  return HWY_DYNAMIC_DISPATCH(AdvanceOnBridge)(modes, shape, admittance, damping_gain, displacement_m);
}
std::size_t process_struck(const StrikeConstants<double>& strike, HammerState<double>& hammer, std::span<double> out,
                           double* force) {
  const FlushDenormals flushed;
  return HWY_DYNAMIC_DISPATCH(ProcessStruck)(strike, hammer, out, force);
}

}  // namespace contactspline::detail
#endif
