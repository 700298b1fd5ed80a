// SPDX-License-Identifier: MIT
// Tests that run in single and in double precision.
#pragma once

#include <gtest/gtest.h>

namespace contactspline::testing {

using Precisions = ::testing::Types<double, float>;

}  // namespace contactspline::testing

/// Declares a suite of TYPED_TESTs; TypeParam is the precision.
#define CONTACTSPLINE_EACH_PRECISION(Suite) \
  template <typename T>                     \
  class Suite : public ::testing::Test {};  \
  TYPED_TEST_SUITE(Suite, ::contactspline::testing::Precisions)
