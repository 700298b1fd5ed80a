// SPDX-License-Identifier: MIT
// A model of a user's own in a shared library, which `contactspline render SCORE --instrument FILE.so` plays. The
// CMake function contactspline_model makes such a library of a class (docs/how-to/model.md).
#pragma once

#include "contactspline/step/cpp20.hpp"

#include <concepts>

#include "contactspline/host/any_instrument.hpp"
#include "contactspline/instrument/instrument.hpp"
#include "contactspline/step/version.hpp"

namespace contactspline {

/// The layout of AnyInstrument and of the lists. Raise it with every change of theirs.
inline constexpr int kModelModuleLayout = 3;

/// What such a library gives. The first three say what it was built with. One of the two functions is not null: the
/// one in the precision of the class.
struct ModelModule {
  int version[3] = {kVersionMajor, kVersionMinor, kVersionPatch};
  int layout = kModelModuleLayout;
  const char* compiler = __VERSION__;
  Handle<float> (*make_single)() = nullptr;
  Handle<double> (*make_double)() = nullptr;
};

/// The type of contactspline_handle() of the library for C: an AnyInstrument<double> or, with precision 1, <float> of
/// the text of an instrument file, with its modes for a rate [Hz], not prepared. The caller deletes it, who must be
/// built with the same as the library. Null where it fails: contactspline_last_error() says why.
using GetHandle = void*(const char* text, const char* file, double sample_rate_hz, int precision,
                        const ModelModule& caller);

/// The name and the type of the one function of the library.
inline constexpr const char* kModelModuleSymbol = "contactspline_model_module";
using GetModelModule = const ModelModule*();

/// The module of a class that is built without arguments.
template <Instrument I>
[[nodiscard]] ModelModule model_module() {
  using T = typename I::value_type;
  ModelModule module;
  const auto make = [] { return handle_of<I>(); };
  if constexpr (std::same_as<T, float>)
    module.make_single = make;
  else
    module.make_double = make;
  return module;
}

}  // namespace contactspline
