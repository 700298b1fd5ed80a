// SPDX-License-Identifier: MIT
// 113-bit arithmetic in software. Unlike pow() and long double it gives the same digits on every machine.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace contactspline {

using Quad = boost::multiprecision::cpp_bin_float_quad;

// Boost fills the constants of its functions at their first use, without a lock: two threads that take their first
// logarithm at once get wrong digits. This one is taken before main(), where there is one thread.
inline const Quad kFirstLogarithm = log(Quad(3));

}  // namespace contactspline
