// SPDX-License-Identifier: MIT
// 113-bit arithmetic in software: the same digits on every machine, whatever its pow() and its long double.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace contactspline {

using Quad = boost::multiprecision::cpp_bin_float_quad;

}  // namespace contactspline
