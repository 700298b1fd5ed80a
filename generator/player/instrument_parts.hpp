// SPDX-License-Identifier: MIT
// What the engine builds instruments of, from the voices of a score.
#pragma once

#include <memory>

#include "contactspline/data/keyboard_parts.hpp"
#include "contactspline/data/string_parts.hpp"
#include "generator/player/score.hpp"

namespace contactspline {

/// The resonator of a voice: its modes below half the sample rate. Throws BadInput where it has none.
[[nodiscard]] ResonatorParts resonator_parts(const Voice& voice, double sample_rate_hz);

[[nodiscard]] HammerStringParts hammer_string_parts(const Voice& voice, double sample_rate_hz);
/// The arrays of an instrument file. Throws BadInput where a body has no mode below half the sample rate.
[[nodiscard]] InstrumentArrays instrument_arrays(const InstrumentModel& model, double sample_rate_hz);

/// The body of a score, with its modes below half the sample rate. Throws BadInput where it has none.
[[nodiscard]] BodyArrays body_arrays(const Score& score, double sample_rate_hz);

/// The keyboard of a score on its body, with all modes of each string. A key that no voice plays has the felt of
/// another: nothing is struck there. The score must outlive it.
[[nodiscard]] KeyboardParts keyboard_parts(const Score& score);

/// A keyboard as hosts play it, with a score that has a voice for each key, and a body.
[[nodiscard]] KeyboardParts keyboard_parts(const Keyboard& keyboard, std::shared_ptr<const Score> score);

}  // namespace contactspline
