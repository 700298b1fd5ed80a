// SPDX-License-Identifier: MIT
// The models by hand, compiled by the test and not by the engine: for every_instrument_test with -ffast-math.
#pragma once

#include <array>

#include "contactspline/host/any_instrument.hpp"
#include "instrument/instrument_lists.hpp"

namespace contactspline::testing {

using Precisions = ::testing::Types<double>;

template <typename T, typename... I>
constexpr std::array<Handle<T> (*)(), sizeof...(I)> handles_of(::testing::Types<I...> /*models*/) {
  return {&handle_of<I>...};
}

template <typename T>
constexpr auto kInstruments = handles_of<T>(ModelsByHand<T>());

}  // namespace contactspline::testing
