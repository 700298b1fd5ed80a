// SPDX-License-Identifier: MIT
// The kernels in double precision.
#include "contactspline/kernels.hpp"

namespace contactspline::detail {
using Sample = double;
}

#include "simd/kernels-inl.hpp"
