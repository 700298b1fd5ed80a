// SPDX-License-Identifier: MIT
// Partials in a sound.
#pragma once

#include <cstddef>
#include <span>

namespace contactspline::testing {

/// A peak of the spectrum.
struct Partial {
  double frequency_hz;
  double amplitude;
};

/// The strongest partial between two frequencies, by a Hann window and a parabola through the logarithms of the three
/// highest values: within 0.02 of a bin, 1/length, of a lone partial.
[[nodiscard]] Partial strongest_partial(std::span<const float> sound, double sample_rate_hz, double from_hz,
                                        double to_hz);

/// Root of the mean square.
[[nodiscard]] double rms(std::span<const float> sound);

}  // namespace contactspline::testing
