// SPDX-License-Identifier: MIT
// read_recording() by libsndfile.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "generator/fit/recorded_note.hpp"
#include "generator/support/error.hpp"
#include "generator/support/memory_sound.hpp"

namespace contactspline {
namespace {

/// Tells whether the mean of channels is far softer than the loudest of them.
class Channels {
 public:
  explicit Channels(std::size_t count) : powers_(count) {}

  /// Returns the mean of a frame.
  double add(std::span<const double> frame) {
    const double mean = std::accumulate(frame.begin(), frame.end(), 0.0) / static_cast<double>(frame.size());
    for (std::size_t i = 0; i < frame.size(); ++i) powers_[i] += frame[i] * frame[i];
    of_mean_ += mean * mean;
    return mean;
  }

  [[nodiscard]] bool cancel() const {
    constexpr double kLeast = 0.01;  // -20 dB
    return of_mean_ < kLeast * std::ranges::max(powers_);
  }

 private:
  std::vector<double> powers_;
  double of_mean_ = 0;
};

}  // namespace

RecordedSound read_recording(std::string_view bytes, const std::string& file, int max_channels) {
  const std::string allowed = fmt::format("a sound file of one {}channel{}, such as .wav or .flac",
                                          max_channels > 1 ? "or two " : "", max_channels > 1 ? "s" : "");
  constexpr std::size_t kMaxSamples = 1 << 24;  // a small file may hold many equal ones
  MemorySound memory{std::string(bytes)};
  SF_VIRTUAL_IO io = MemorySound::calls();
  SndfileHandle sound(io, &memory);
  if (sound.error() != 0) refuse(file, "file", "is no sound that can be read", allowed);
  const auto channels = static_cast<std::size_t>(sound.channels());
  if (sound.channels() > max_channels) refuse(file, "channels", fmt::format("has {}", channels), allowed);
  RecordedSound recording{static_cast<double>(sound.samplerate()), {}};
  std::vector<double> block(4096 * channels);
  Channels sums(channels);
  while (true) {
    const sf_count_t count = sound.readf(block.data(), 4096);
    if (count <= 0) break;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      recording.samples.push_back(sums.add(std::span(block).subspan(i * channels, channels)));
    if (recording.samples.size() > kMaxSamples)
      refuse(file, "samples", fmt::format("there are more than {}", kMaxSamples), "a recording of one note");
  }
  if (!std::ranges::all_of(recording.samples, [](double sample) { return std::isfinite(sample); }))
    refuse(file, "samples", "some of them are no numbers", "finite samples");
  if (sums.cancel())
    refuse(file, "channels", "they cancel: their mean, which counts, is 20 dB or more softer than one of them",
           "one of the channels");
  return recording;
}

}  // namespace contactspline
