// SPDX-License-Identifier: MIT
// A test that is linked with ContactSpline::simd plays with the portable kernels if CONTACTSPLINE_TEST_KERNELS is
// `portable` in the environment.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "contactspline/simd/kernels.hpp"

namespace contactspline::testing {
namespace {

[[maybe_unused]] const bool kIsPortable = [] {
  const char* const asked = std::getenv("CONTACTSPLINE_TEST_KERNELS");
  if (asked == nullptr) return false;
  if (asked != std::string_view("portable")) {
    std::fprintf(stderr, "CONTACTSPLINE_TEST_KERNELS: %s is not allowed; allowed: portable\n", asked);
    std::exit(2);
  }
  detail::kernels<float> = detail::kPortableKernels<float>;
  detail::kernels<double> = detail::kPortableKernels<double>;
  return true;
}();

}  // namespace
}  // namespace contactspline::testing
