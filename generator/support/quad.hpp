// SPDX-License-Identifier: MIT
// 113-bit arithmetic in software. Unlike pow() and long double it gives the same digits on every machine.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace contactspline {

using Quad = boost::multiprecision::cpp_bin_float_quad;

}  // namespace contactspline
