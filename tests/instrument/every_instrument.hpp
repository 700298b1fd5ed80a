// SPDX-License-Identifier: MIT
// The list of all instruments that ship, and of those in examples/. Tests over the concept take it; a new model is
// one line here.
#pragma once

#include <gtest/gtest.h>

#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/materials/steel_on_steel.hpp"
#include "contactspline/resonators/guitar_d3.hpp"
#include "contactspline/resonators/guitar_g3.hpp"
#include "contactspline/resonators/string_c4.hpp"
#include "frame_drum.hpp"
#include "fret_under_string.hpp"
#include "hammer_on_string.hpp"
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

/// Models that programs and libraries know by name.
template <typename T>
using NamedModels = ::testing::Types<
    MassBarrierOf<materials::felt_c4, T>, HammerStringOf<materials::felt_c4, resonators::string_c4, T>,
    SlideStringOf<materials::steel_on_steel, resonators::guitar_g3, T>,
    FretStringOf<materials::steel_on_steel, resonators::guitar_d3, T>, KeyboardInstrument<keyboards::piano, T>>;

template <typename T>
using ModelsByHand =
    Joined<NamedModels<T>, ::testing::Types<EnsembleOf<materials::felt_c4, resonators::string_c4, T>>>;

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
