// SPDX-License-Identifier: MIT
// Audio files.
#pragma once

#include <span>
#include <string>

namespace contactspline {

/// The bytes of a WAV file with 24-bit samples: the interleaved samples times `scale`, clipped to [-1, 1].
[[nodiscard]] std::string wav_bytes(std::span<const double> samples, double scale, int channels, int sample_rate_hz);
[[nodiscard]] std::string wav_bytes(std::span<const float> samples, double scale, int channels, int sample_rate_hz);

}  // namespace contactspline
