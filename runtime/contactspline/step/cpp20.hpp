// SPDX-License-Identifier: MIT
// Every public header includes this one first: a compiler in an older mode says what is wrong, and stops.
#pragma once

#if __cplusplus < 202002L && (!defined(_MSVC_LANG) || _MSVC_LANG < 202002L)
#error "Contact Spline needs C++20: compile with -std=c++20"
#include "contactspline/needs_cpp20.hpp"  // does not exist: the compiler stops here, before errors of no use
#endif
