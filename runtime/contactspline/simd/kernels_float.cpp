// SPDX-License-Identifier: MIT
// The kernels in single precision.
#include "contactspline/simd/kernels.hpp"

namespace contactspline::detail {
using Sample = float;
}

#include "contactspline/simd/kernels-inl.hpp"
