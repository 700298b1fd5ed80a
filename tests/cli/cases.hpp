// SPDX-License-Identifier: MIT
// A parametrised suite over a list of cases that print their names.
#pragma once

#include <gtest/gtest.h>

/// Runs the TEST_Ps of a suite for each element of a list, under the name that the element prints.
#define CONTACTSPLINE_CASES(Name, Suite, list) \
  INSTANTIATE_TEST_SUITE_P(Name, Suite, ::testing::ValuesIn(list), ::testing::PrintToStringParamName())
