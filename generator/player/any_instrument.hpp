// SPDX-License-Identifier: MIT
// From a voice of a score to the instrument that plays it.
#pragma once

#include <concepts>
#include <memory>

#include "contactspline/host/any_instrument.hpp"
#include "generator/player/score.hpp"

namespace contactspline {

/// What plays a voice of a model at a sample rate. Throws BadInput where it has no mode below half the rate.
template <std::floating_point T>
[[nodiscard]] std::unique_ptr<AnyInstrument<T>> instrument_of(Model model, const Voice& voice, double sample_rate_hz);

}  // namespace contactspline
