// SPDX-License-Identifier: MIT
// read_recording() by libsndfile.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "generator/fit/recorded_note.hpp"
#include "generator/support/error.hpp"
#include "generator/support/memory_sound.hpp"

namespace contactspline {

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
  while (true) {
    const sf_count_t count = sound.readf(block.data(), 4096);
    if (count <= 0) break;
    for (auto frame = block.begin(); frame != block.begin() + count * sound.channels(); frame += sound.channels())
      recording.samples.push_back(std::accumulate(frame, frame + sound.channels(), 0.0) / sound.channels());
    if (recording.samples.size() > kMaxSamples)
      refuse(file, "samples", fmt::format("there are more than {}", kMaxSamples), "a recording of one note");
  }
  if (!std::ranges::all_of(recording.samples, [](double sample) { return std::isfinite(sample); }))
    refuse(file, "samples", "some of them are no numbers", "finite samples");
  return recording;
}

}  // namespace contactspline
