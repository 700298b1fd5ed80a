// SPDX-License-Identifier: MIT
// All instruments that ship, and those in examples/, as the engine has compiled them: for every_instrument_test.
#pragma once

#include <array>

#include "contactspline/host/engine.hpp"
#include "instrument/instrument_lists.hpp"

namespace contactspline::testing {

using Precisions = ::testing::Types<double, float>;

template <typename... I>
constexpr auto compiled_list(::testing::Types<I...> /*instruments*/) {
  return std::array{&compiled<I>...};
}

template <typename T>
constexpr auto kInstruments = compiled_list(Joined<ModelsByHand<T>, InstrumentsOfFiles<T>>());

}  // namespace contactspline::testing
