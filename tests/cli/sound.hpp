// SPDX-License-Identifier: MIT
// Sound files as the program writes them.
#pragma once

#include <algorithm>
#include <cmath>
#include <sndfile.hh>
#include <stdexcept>
#include <vector>

#include "sandbox.hpp"

namespace contactspline::testing {

constexpr double kPeak = 0.89;              // -1 dB
constexpr double kLevel = 1.0 / (1 << 23);  // one step of 24 bits

struct Sound {
  int rate, channels, format;
  std::vector<double> samples;  ///< interleaved

  [[nodiscard]] double peak() const {
    double largest = 0;
    for (const double sample : samples) largest = std::max(largest, std::abs(sample));
    return largest;
  }
};

inline Sound read_sound(const fs::path& path) {
  SndfileHandle file(path.string());
  if (file.error() != 0) throw std::runtime_error(path.string() + ": " + file.strError());
  Sound sound{file.samplerate(), file.channels(), file.format(), {}};
  sound.samples.resize(static_cast<std::size_t>(file.frames() * file.channels()));
  if (file.readf(sound.samples.data(), file.frames()) != file.frames()) throw std::runtime_error("short file");
  return sound;
}

}  // namespace contactspline::testing
