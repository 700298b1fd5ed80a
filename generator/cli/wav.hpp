// SPDX-License-Identifier: MIT
// Audio files.
#pragma once

#include <span>
#include <string>

namespace contactspline {

/// A mono WAV file of 24-bit samples as bytes. Samples outside [-1, 1] are clipped. rate: whole hertz.
[[nodiscard]] std::string wav_bytes(std::span<const double> samples, int sample_rate_hz);

}  // namespace contactspline
