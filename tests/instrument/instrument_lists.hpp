// SPDX-License-Identifier: MIT
// The classes of all instruments that ship, and of those in examples/, for the tests over the concept.
#pragma once

#include <gtest/gtest.h>

#include <tuple>

#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "frame_drum.hpp"
#include "fret_under_string.hpp"
#include "hammer_on_string.hpp"
#include "hosts/named_models.hpp"
#include "shipped_instruments.hpp"
#include "slide_on_string.hpp"

namespace contactspline::testing {

template <typename... Lists>
struct JoinedLists;
template <typename... A>
struct JoinedLists<::testing::Types<A...>> {
  using Type = ::testing::Types<A...>;
};
template <typename... A, typename... B, typename... Others>
struct JoinedLists<::testing::Types<A...>, ::testing::Types<B...>, Others...>
    : JoinedLists<::testing::Types<A..., B...>, Others...> {};
/// The types of several lists, in this order.
template <typename... Lists>
using Joined = typename JoinedLists<Lists...>::Type;

template <typename Tuple>
struct TypesOfTuple;
template <typename... Members>
struct TypesOfTuple<std::tuple<Members...>> {
  using Type = ::testing::Types<Members...>;
};

/// Models that programs and libraries know by name.
template <typename T>
using NamedModelTypes = typename TypesOfTuple<contactspline::NamedModels<T>>::Type;

template <typename T>
using ModelsByHand =
    Joined<NamedModelTypes<T>, ::testing::Types<EnsembleOf<materials::felt_c4, resonators::string_c4, T>>>;

template <typename T>
using InstrumentsOfFiles =
    Joined<ShippedInstruments<T>,
           ::testing::Types<instruments::frame_drum<T>, instruments::fret_under_string<T>,
                            instruments::hammer_on_string<T>, instruments::slide_on_string<T>>>;

/// What a test calls an instrument.
struct InstrumentNames {
  template <typename I>
  static std::string GetName(int) {
    return std::string(I().name()) + (sizeof(typename I::value_type) == sizeof(float) ? "_single" : "_double");
  }
};

}  // namespace contactspline::testing
