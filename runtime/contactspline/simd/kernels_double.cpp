// SPDX-License-Identifier: MIT
// The kernels in double precision.
#include "contactspline/simd/kernels.hpp"

namespace contactspline::detail {
using Sample = double;
}

#include "contactspline/simd/kernels-inl.hpp"
