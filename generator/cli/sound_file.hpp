// SPDX-License-Identifier: MIT
// Sound files. The ending of the name chooses the format: .wav, .flac, .aiff, .aif, or .ogg (Vorbis).
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

namespace contactspline {

/// The largest magnitude; 0 if there are no samples.
template <typename T>
[[nodiscard]] double peak_of(std::span<const T> samples) {
  double peak = 0;
  for (const T sample : samples) peak = std::max(peak, std::abs(static_cast<double>(sample)));
  return peak;
}

inline constexpr int kUsualBits = 24, kFloatBits = 32;

/// Throws BadInput if the name has another ending, or if its format cannot have these channels at this rate, or
/// samples of so many bits.
void require_sound_format(const std::string& file, int channels, int sample_rate_hz, int bits = kUsualBits);

/// The bytes of a sound file of this name: the interleaved samples times `scale`. 16 or 24 bits clip them to [-1, 1];
/// 32 are those of single precision. T: float or double.
template <typename T>
[[nodiscard]] std::string sound_bytes(const std::string& name, std::span<const T> samples, double scale, int channels,
                                      int sample_rate_hz, int bits = kUsualBits);

}  // namespace contactspline
