// SPDX-License-Identifier: MIT
// The models of the runtime that hosts know by name.
#pragma once

#include <concepts>
#include <tuple>

#include "contactspline/instrument/instruments_of.hpp"
#include "contactspline/instrument/keyboard_instrument.hpp"
#include "contactspline/keyboards/piano.hpp"
#include "contactspline/materials/felt_c4.hpp"
#include "contactspline/resonators/string_c4.hpp"

namespace contactspline {

/// Classes that meet Instrument, are made without arguments and have a static name(). Material and resonator are
/// those of the plug-in of that name, where there is one (cmake/ContactSplinePlugin.cmake). A new model is one line
/// here: the libraries for C, Python, Csound, Pd and SuperCollider offer it by its name(), and every test over the
/// concept plays it.
template <std::floating_point T>
using NamedModels =
    std::tuple<KeyboardInstrument<keyboards::piano, T>, HammerStringOf<materials::felt_c4, resonators::string_c4, T>,
               MassBarrierOf<materials::felt_c4, T>>;

}  // namespace contactspline
