// SPDX-License-Identifier: MIT
// The kernels in single precision.
#include "contactspline/kernels.hpp"

namespace contactspline::detail {
using Sample = float;
}

#include "simd/kernels-inl.hpp"
