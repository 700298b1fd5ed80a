// SPDX-License-Identifier: MIT
// Audio files.
#pragma once

#include <span>
#include <string>

namespace contactspline {

/// A WAV file of 24-bit samples as bytes: `scale` times the interleaved samples; what lies outside [-1, 1] is
/// clipped. rate: whole hertz.
[[nodiscard]] std::string wav_bytes(std::span<const double> samples, double scale, int channels, int sample_rate_hz);
[[nodiscard]] std::string wav_bytes(std::span<const float> samples, double scale, int channels, int sample_rate_hz);

}  // namespace contactspline
